"""The evaluate commands: columns, order, refusals, and the numbers against LOWTRAN7, Wu and Smith, and the command 'mean'."""

import csv
import json
import os
import stat

import numpy as np
import pytest

import seaglint as sg
from seaglint.air.lowtran_table import table_models
from seaglint.base.errors import DataError
from seaglint.cli.terminal.progress import PATIENCE, ProgressMode, patient_progress
from seaglint.studies.mean.evaluate_cases import evaluate_mean, groups_of, parse_bands

QUANTITIES = ("tau_mean", "path_radiance_W_m2_sr", "sun_normal_irradiance_W_m2", "sun_times_tau_W_m2", "sky_radiance_W_m2_sr")
AIR = "atmosphere,wind_speed_m_s,sensor_height_m,depression_deg,solar_zenith_deg,sky_zenith_deg"
MEAN = "atmosphere,wind_speed_m_s,sensor_height_m,depression_deg,solar_zenith_deg,relative_azimuth_deg,sea_temperature_k,ifov_mrad"

# LOWTRAN7 revision 4.2 in double precision (MODEL 2 and 6, IHAZE=3, ICSTL=3, VIS=0, WSS=WHH=wind, day 93), rows of the reference
# table: inputs, then the five quantities of 3-5 um and of 8-12 um.
LOWTRAN = [
    (
        "us-standard-1976,8.6,7,4.58,17.8,80.68",
        (0.831048, 0.238603, 10.2005, 9.55496, 0.852088),
        (0.97278, 0.748186, 0.788937, 0.76674, 16.145),
    ),
    (
        "midlatitude-summer,9.67,40.5,2.808,20.71,71.8",
        (0.533876, 0.742354, 7.92999, 5.85065, 1.12475),
        (0.759967, 8.07096, 0.616108, 0.470711, 22.5977),
    ),
]


def one_line(text):
    return text.count("\n") == 1 and "Traceback" not in text


def table(path):
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


@pytest.fixture
def cases(tmp_path):
    def write(*lines):
        path = tmp_path / "cases.csv"
        path.write_text("\n".join(lines) + "\n")
        return path

    return write


def test_atmosphere_against_lowtran_in_order_with_other_columns_kept(seaglint, cases, tmp_path):
    source = cases(f"id,{AIR},sun_times_tau_W_m2[3.0-5.0],tau_mean[3-4]", *(f"{i:03d},{LOWTRAN[i % 2][0]},9,x" for i in range(5)))
    output = tmp_path / "out.csv"
    answer = seaglint("evaluate", "atmosphere", source, "--band", "3.0-5.0", "--band", "8-12.00", "-o", output)
    assert (answer.code, answer.out) == (0, "")
    assert "5 rows" in answer.err
    assert "sun_times_tau_W_m2[3.0-5.0]" in answer.err
    rows = table(output)
    new = [f"{q}[{b}]" for b in ("3.0-5.0", "8-12.00") for q in QUANTITIES if (q, b) != ("sun_times_tau_W_m2", "3.0-5.0")]
    assert list(rows[0]) == ["id", *AIR.split(","), "sun_times_tau_W_m2[3.0-5.0]", "tau_mean[3-4]", *new]
    assert [row["id"] for row in rows] == ["000", "001", "002", "003", "004"]
    for i, row in enumerate(rows):
        given, *expected = LOWTRAN[i % 2]
        assert ",".join(row[name] for name in AIR.split(",")) == given
        assert row["tau_mean[3-4]"] == "x"
        for band, values in zip(("3.0-5.0", "8-12.00"), expected, strict=True):
            # 0.2 % is the table's median error, 1 % its 95th percentile; the rows at hand are ordinary ones.
            np.testing.assert_allclose([float(row[f"{q}[{band}]"]) for q in QUANTITIES], values, rtol=2e-3)


@pytest.mark.validation
def test_all_reference_cases(seaglint, reference_dir, tmp_path):
    """Median error at most 0.2 %, 95th percentile 1 % of the value or 5e-4 of the column's maximum, each quantity and band."""
    theirs = [row for row in table(reference_dir / "lowtran7_slant_paths.csv") if row["atmosphere"] in table_models()]
    assert len(theirs) >= 50
    source, output = tmp_path / "cases.csv", tmp_path / "out.csv"
    with source.open("w", newline="") as file:
        writer = csv.DictWriter(file, AIR.split(","), extrasaction="ignore")
        writer.writeheader()
        writer.writerows(theirs)
    bands = ("3.0-5.0", "3.5-5.0", "8.0-12.0")
    assert seaglint("evaluate", "atmosphere", source, *(part for b in bands for part in ("--band", b)), "-o", output).code == 0
    names = [f"{q}[{b}]" for b in bands for q in QUANTITIES]
    ours, known = (np.array([[float(row[name]) for name in names] for row in rows]) for rows in (table(output), theirs))
    absolute = np.abs(ours - known)
    error = np.where(absolute < 5e-4 * known.max(axis=0), 0.0, absolute / known)
    assert np.all(np.median(absolute / known, axis=0) < 2e-3)
    assert np.all(np.percentile(error, 95.0, axis=0) < 1e-2)


# Wu and Smith 1997 (CRTM's Wu-Smith coefficients): wavelength, wind, zenith, emissivity.
WU_SMITH = [(3.4, 1, 15, 0.96898), (3.4, 3, 45, 0.95848), (3.4, 0, 60, 0.92269), (3.4, 3, 65, 0.89198)]


def test_emissivity_against_wu_and_smith(seaglint, cases, tmp_path):
    source = cases("zenith_deg;wavelength_um;wind_speed_m_s", *(f"{z};{um};{w}" for um, w, z, _ in WU_SMITH))
    assert seaglint("evaluate", "emissivity", source, "-o", tmp_path / "out.csv").code == 0
    found = [float(line.split(";")[-1]) for line in (tmp_path / "out.csv").read_text().splitlines()[1:]]
    np.testing.assert_allclose(found, [row[-1] for row in WU_SMITH], atol=1e-3)  # what the table is good for


@pytest.mark.validation
def test_emissivity_against_all_of_wu_and_smith(seaglint, reference_dir, tmp_path):
    """Within 0.001 to 65 degrees, every wavelength and wind of the table."""
    with (reference_dir / "emissivity_wu_smith.csv").open() as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    known = [
        (row["wavelength_um"], row["wind_m/s"], zenith, float(row[f"e_{zenith}"]))
        for row in rows
        for zenith in (15, 30, 40, 45, 50, 55, 60, 65)
        if row["table"] == "WuSmith_CM_HQS" and row[f"e_{zenith}"]
    ]
    assert len(known) >= 200
    source, output = tmp_path / "cases.csv", tmp_path / "out.csv"
    source.write_text("\n".join(["wavelength_um,wind_speed_m_s,zenith_deg", *(f"{um},{w},{z}" for um, w, z, _ in known)]))
    assert seaglint("evaluate", "emissivity", source, "-o", output).code == 0
    np.testing.assert_allclose([float(row["emissivity"]) for row in table(output)], [row[-1] for row in known], atol=1e-3)


def test_emissivity_reaches_the_horizon_and_marks_winds_beyond_the_fit(seaglint, cases, tmp_path):
    source, output = cases("wavelength_um,wind_speed_m_s,zenith_deg", "4,5,90", "11,25,60", "4,5,0"), tmp_path / "out.csv"
    assert "row 2 (line 3), column wind_speed_m_s: 25" in seaglint("evaluate", "emissivity", source, "-o", output).err
    assert seaglint("evaluate", "emissivity", source, "-o", output, "--extrapolate").code == 0
    rows = table(output)
    assert [row["extrapolated"] for row in rows] == ["", "wind_speed_m_s", ""]
    horizon, _, nadir = (float(row["emissivity"]) for row in rows)
    assert 0.3 < horizon < nadir < 1.0


def test_mean_is_that_of_the_command_mean(cases):
    """Another way through the program: a map of one pixel, with directions from north and a wind that has one."""
    from seaglint.formats.tables.input_tables import read_cases
    from seaglint.scenario.load import parse_scenario
    from seaglint.studies.mean.mean_map import mean

    degrees = 0.03
    scenario = parse_scenario(
        {
            "band": {"min_um": 3.5, "max_um": 5.0},
            "wind": {"speed_m_s": 7.0},
            "sun": {"zenith_deg": 76, "azimuth_deg": 240},
            "sensor": {"height_m": 30, "azimuth_deg": 243, "elevation_deg": -2.5, "fov_deg": [degrees, degrees], "pixels": [1, 1]},
            "sea": {"temperature_k": 289.0, "slopes": {"kind": "cox-munk-isotropic"}},
        }
    )
    expected = mean(scenario)
    rows = read_cases(cases(MEAN, f"{scenario.atmosphere.model},7,30,2.5,76,3,289,{1e3 * np.radians(degrees)}"))
    found = evaluate_mean(rows, parse_bands(["3.5-5"]))
    # The pixel averages over its height; its middle is within 1e-4 of that. Maps are single precision.
    for name, quantity in (
        ("radiance", "radiance_W_m2_sr"),
        ("apparent_temperature", "apparent_temperature_K"),
        ("glint_std", "std_W_m2_sr"),
    ):
        assert found[f"{quantity}[3.5-5]"] == pytest.approx(float(expected[name][0, 0]), rel=5e-4)


def test_mean_with_a_wind_that_has_a_direction(cases):
    """Wind from 100 deg clockwise of the Sun, against a map; from across it gives another glint."""
    from seaglint.formats.tables.input_tables import read_cases
    from seaglint.scenario.load import parse_scenario
    from seaglint.studies.mean.mean_map import mean

    degrees = 0.03
    scenario = parse_scenario(
        {
            "band": {"min_um": 3.5, "max_um": 5.0},
            "wind": {"speed_m_s": 9.0, "from_deg": 340},
            "sun": {"zenith_deg": 60, "azimuth_deg": 240},
            "sensor": {"height_m": 30, "azimuth_deg": 250, "elevation_deg": -6, "fov_deg": [degrees, degrees], "pixels": [1, 1]},
            "sea": {"temperature_k": 289.0, "slopes": {"kind": "cox-munk-anisotropic"}},
        }
    )
    expected = mean(scenario)
    # a map's pixel is narrower than its step of azimuth by the cosine of its elevation
    row = f"{scenario.atmosphere.model},9,30,6,60,10,289,{1e3 * np.radians(degrees) * np.sqrt(np.cos(np.radians(6)))}"
    rows = read_cases(cases(f"{MEAN},wind_from_deg", f"{row},100", f"{row},-260", f"{row},10"))
    found = evaluate_mean(rows, parse_bands(["3.5-5"]))
    for name, quantity in (("radiance", "radiance_W_m2_sr"), ("glint_std", "std_W_m2_sr")):
        values = found[f"{quantity}[3.5-5]"]
        assert values[0] == pytest.approx(float(expected[name][0, 0]), rel=5e-4)
        assert values[1] == pytest.approx(values[0], rel=1e-9)
        assert abs(values[2] / values[0] - 1.0) > 0.01


@pytest.mark.validation
def test_slopes_of_a_row_are_those_of_the_scenarios_model(cases):
    """Gram and Charlier's series tells upwind from downwind, Gaussian slopes do not; one row has no direction."""
    from seaglint.formats.tables.input_tables import read_cases
    from seaglint.scenario.load import parse_scenario
    from seaglint.studies.mean.mean_map import mean

    def expected(kind, wind_from):
        degrees = 0.03
        sensor = {"height_m": 30, "azimuth_deg": 190, "elevation_deg": -6, "fov_deg": [degrees, degrees], "pixels": [1, 1]}
        raw = {"wind": {"speed_m_s": 9.0, "from_deg": wind_from}, "sun": {"zenith_deg": 60, "azimuth_deg": 180}, "sensor": sensor}
        return float(mean(parse_scenario(raw | {"sea": {"temperature_k": 289.0, "slopes": {"kind": kind}}})).radiance[0, 0])

    air = parse_scenario({}).atmosphere.model
    kinds = [(kind, side) for kind in ("cox-munk-gram-charlier", "cox-munk-anisotropic", "cox-munk-isotropic") for side in (30, 210)]
    rows = read_cases(cases(f"{MEAN},wind_from_deg,slopes", *(f"{air},9,30,6,60,10,289,1,{side},{kind}" for kind, side in kinds)))
    found = evaluate_mean(rows, parse_bands(["3.5-5"]))["radiance_W_m2_sr[3.5-5]"]
    # A wind's direction counts from the Sun's azimuth, 180 deg. Maps average over the pixel's height: 1e-4.
    np.testing.assert_allclose(found, [expected(kind, (180 + side) % 360) for kind, side in kinds], rtol=5e-4)
    assert abs(found[0] / found[1] - 1.0) > 0.02
    assert found[2] == pytest.approx(found[3], rel=1e-9)
    with pytest.raises(DataError, match=r"column slopes: 'cox-munk-gram-charlier' depends on the wind's direction; add a column wind_from"):
        evaluate_mean(read_cases(cases(f"{MEAN},slopes", f"{air},9,30,6,60,10,289,1,cox-munk-gram-charlier")), parse_bands(["3.5-5"]))


def test_mean_rows_stand_for_themselves(seaglint, cases, tmp_path):
    """Rows that share air or view give what each gives alone; left and right of the Sun are the same; away from it there is no glint."""
    lines = [
        "midlatitude-summer,7,30,2,76,5,290,1",
        "us-standard-1976,3,1000,10,50,10,285,0.3",
        "midlatitude-summer,7,30,2,76,-5,290,1",
        "midlatitude-summer,7,30,4,76,5,292,2",
        "midlatitude-summer,7,30,2,76,180,290,1",
        "midlatitude-summer,7,30,2,120,5,290,1",
    ]
    output = tmp_path / "out.csv"
    names = [f"{q}[3.5-5.0]" for q in ("radiance_W_m2_sr", "apparent_temperature_K", "std_W_m2_sr")]

    def run(*rows):
        assert seaglint("evaluate", "mean", cases(MEAN, *rows), "--band", "3.5-5.0", "-o", output, "--overwrite").code == 0
        return np.array([[float(row[name]) for name in names] for row in table(output)])

    together = run(*lines)
    alone = np.concatenate([run(lines[i]) for i in (0, 3)])
    np.testing.assert_allclose(together[[0, 3]], alone, rtol=2e-6)  # six digits are written
    np.testing.assert_array_equal(together[0], together[2])
    assert together[0, 0] > together[4, 0] > 0.0
    assert together[0, 2] > 0.0
    assert together[4, 2] < 1e-6 * together[0, 2]
    assert together[5, 2] == 0.0


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("mars,5,10,5,40,40", "row 2 (line 3), column atmosphere: 'mars' is not one of "),
        ("us-standard-1976,25,10,5,40,40", "row 2 (line 3), column wind_speed_m_s: 25 is outside the range allowed: 0 to 20 m/s"),
        ("us-standard-1976,5,20000,15,40,40", "column sensor_height_m: 20000 is outside the range allowed: 2 to 10000 m"),
        ("us-standard-1976,5,100,0.1,40,40", "column depression_deg: 0.1 deg misses the sea, whose horizon lies at 0."),
        ("us-standard-1976,5,100,-3,40,40", "column depression_deg: -3 deg misses the sea"),
        ("us-standard-1976,5,100,3,181,40", "column solar_zenith_deg: 181"),
        ("us-standard-1976,5,100,3,40,91", "column sky_zenith_deg: 91"),
        ("us-standard-1976,five,100,3,40,40", "column wind_speed_m_s: 'five' is not a number"),
        ("us-standard-1976,5,100,3,40", "line 3: 5 cells under 6 headings"),
    ],
)
def test_bad_rows_are_one_line_and_leave_nothing(seaglint, cases, tmp_path, line, told):
    source = cases(AIR, LOWTRAN[0][0], line)
    answer = seaglint("evaluate", "atmosphere", source, "--band", "3.0-5.0", "-o", tmp_path / "out.csv")
    assert answer.code == 2
    assert one_line(answer.err)
    assert str(source) in answer.err
    assert told in answer.err
    assert [path.name for path in tmp_path.iterdir()] == ["cases.csv"]


@pytest.mark.parametrize(
    ("bands", "told"),
    [
        ([], "give at least one band, such as 3.0-5.0"),
        (["5-3"], "'5-3'"),
        (["3.0um-5.0um"], "write it as 3.0-5.0"),
        (["3-5", "3-5"], "twice"),
        (["5-8"], "beyond the tables of"),
        (["20-25"], "beyond the tables of"),
    ],
)
@pytest.mark.parametrize("command", ["atmosphere", "mean"])
def test_bands_that_are_refused(seaglint, cases, tmp_path, command, bands, told):
    row = {"atmosphere": LOWTRAN[0][0], "mean": "us-standard-1976,5,10,5,40,0,290,1"}[command]
    source = cases({"atmosphere": AIR, "mean": MEAN}[command], row)
    options = [part for band in bands for part in ("--band", band)]
    answer = seaglint("evaluate", command, source, *options, "-o", tmp_path / "out.csv")
    assert (answer.code, one_line(answer.err)) == (2, True)
    assert told in answer.err
    assert [path.name for path in tmp_path.iterdir()] == ["cases.csv"]


@pytest.mark.parametrize(
    ("content", "told"),
    [
        ("", "line 1: the file is empty"),
        (AIR, "holds no cases"),
        ("atmosphere,depression_deg\na,1", "columns wind_speed_m_s, sensor_height_m"),
    ],
)
def test_files_without_cases_or_columns(seaglint, cases, tmp_path, content, told):
    answer = seaglint("evaluate", "atmosphere", cases(content), "--band", "3-5", "-o", tmp_path / "out.csv")
    assert (answer.code, one_line(answer.err)) == (2, True)
    assert told in answer.err


def test_extrapolated_rows_are_marked(seaglint, cases, tmp_path):
    source = cases(
        AIR, LOWTRAN[0][0], "us-standard-1976,25,10,5,40,40", "us-standard-1976,20,10,5,40,40", "us-standard-1976,25,12000,15,40,40"
    )
    output = tmp_path / "out.csv"
    assert seaglint("evaluate", "atmosphere", source, "--band", "3-5", "-o", output, "--extrapolate").code == 0
    rows = table(output)
    assert [row["extrapolated"] for row in rows] == ["", "wind_speed_m_s", "", "wind_speed_m_s sensor_height_m"]
    assert all(0.0 < float(row["tau_mean[3-5]"]) < 1.0 for row in rows)


def test_an_output_that_is_there_is_kept_without_overwrite(seaglint, cases, tmp_path):
    source, output = cases(AIR, LOWTRAN[0][0]), tmp_path / "out.csv"
    output.write_text("mine")
    answer = seaglint("evaluate", "atmosphere", source, "--band", "3-5", "-o", output)
    assert (answer.code, one_line(answer.err), output.read_text()) == (2, True, "mine")
    assert seaglint("evaluate", "atmosphere", source, "--band", "3-5", "-o", source, "--overwrite").code == 0
    assert "tau_mean[3-5]" in source.read_text()


def test_groups_keep_rows_apart():
    assert [(key, rows.tolist()) for key, rows in groups_of([(1, 2), (1, 3), (1, 2)])] == [((1, 2), [0, 2]), ((1, 3), [1])]


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="named pipes are a matter of Unix")
def test_a_pipe_is_no_place_for_the_rows(seaglint, tmp_path):
    (tmp_path / "angles.csv").write_text("wavelength_um,wind_speed_m_s,zenith_deg\n4,5,60\n")
    os.mkfifo(tmp_path / "pipe")
    answer = seaglint("evaluate", "emissivity", tmp_path / "angles.csv", "-o", tmp_path / "pipe", "--overwrite")
    assert answer.code == 2
    assert len(answer.err.strip().splitlines()) == 1
    assert "pipe: is a device, pipe or socket" in answer.err
    assert stat.S_ISFIFO((tmp_path / "pipe").stat().st_mode)


def test_progress_shows_only_work_that_lasts(capsys):
    now = [0.0]
    with patient_progress(ProgressMode.LOG, "rows", lambda: now[0]) as report:
        report(0, 10)
        now[0] = 0.9 * PATIENCE
        report(5, 10)
        assert capsys.readouterr().err == ""
        now[0] = 1.1 * PATIENCE
        report(6, 10)
        report(10, 10)
        shown = capsys.readouterr().err
    # The rate is that after the first piece, in which things are prepared; the whole began 2.2 s ago, and none of it by an earlier run.
    assert shown.splitlines() == ["rows: 6/10, 2.5 per s, 2 s left", "rows: 10/10 in 2 s, 4.55 per s"]
    with patient_progress(ProgressMode.LOG, "rows", lambda: now[0]) as report:
        report(2, 10)  # an earlier run's
        now[0] += 2.0 * PATIENCE
        report(4, 10)
        assert capsys.readouterr().err == "rows: 4/10\n"  # one piece says nothing of the pace
    with patient_progress(ProgressMode.LOG, "rows", lambda: now[0]) as report:
        now[0] += 2.0 * PATIENCE
        report(10, 10)  # done when it would appear
    assert capsys.readouterr().err == ""


SCATTERED = "kind,atmosphere,wind_speed_m_s,sensor_height_m,elevation_deg,azimuth_from_sun_deg,solar_zenith_deg"

# LOWTRAN7 as in tests/air/test_scattered_against_lowtran.py: inputs, then scattered and thermal radiance in 3.5-5 um.
SCATTERED_ROWS = [
    ("sky,subarctic-summer,15.36,39.3,23.739,123.104,24.385", 0.0320464, 0.745034),
    ("path,us-standard-1976,12.05,1024.4,-16.773,69.596,40.243", 0.00783819, 0.603991),
    ("sky,midlatitude-winter,8.59,3.3,52.873,171.351,59.267", 0.00651364, 0.295303),
]


def test_scattered_against_lowtran(seaglint, cases, tmp_path):
    source, output = cases(SCATTERED, *(given for given, *_ in SCATTERED_ROWS)), tmp_path / "out.csv"
    answer = seaglint("evaluate", "scattered", source, "--band", "3.5-5.0", "--band", "8-12", "-o", output)
    assert (answer.code, answer.out) == (0, "")
    rows = table(output)
    quantities = ("scattered_W_m2_sr", "thermal_W_m2_sr")
    assert list(rows[0]) == [*SCATTERED.split(","), *(f"{q}[{band}]" for band in ("3.5-5.0", "8-12") for q in quantities)]
    for row, (given, *expected) in zip(rows, SCATTERED_ROWS, strict=True):
        assert ",".join(row[name] for name in SCATTERED.split(",")) == given
        # largest error of thermal paths among all reference cases, just above a level; scattered light is within 1e-3 here
        np.testing.assert_allclose([float(row[f"{q}[3.5-5.0]"]) for q in quantities], expected, rtol=4e-3)
        assert float(row["scattered_W_m2_sr[8-12]"]) == 0.0
        assert float(row["thermal_W_m2_sr[8-12]"]) > 1.0


@pytest.mark.parametrize(
    ("row", "told"),
    [
        ("ray,tropical,7,30,-5,0,60", "'ray' is not one of path, sky"),
        ("path,tropical,7,30,5,0,60", "misses the sea"),
        ("sky,tropical,7,30,-5,0,60", "say kind = path"),
        ("path,tropical,7,0,-5,0,60", "the lowest of paths"),
        ("sky,tropical,25,30,5,0,60", "--extrapolate"),
        ("sky,tropical,7,30,5,0,200", "solar_zenith_deg"),
    ],
)
def test_scattered_cases_that_cannot_be_used(seaglint, cases, tmp_path, row, told):
    answer = seaglint("evaluate", "scattered", cases(SCATTERED, row), "--band", "3.5-5.0", "-o", tmp_path / "out.csv")
    assert answer.code != 0
    assert told in answer.err
    assert one_line(answer.err)
    assert "row 1 (line 2)" in answer.err


def test_scattered_beyond_the_tables_is_marked(seaglint, cases, tmp_path):
    output = tmp_path / "out.csv"
    source = cases(SCATTERED, "path,tropical,25,30,-5,0,60", "path,tropical,20,30,-5,0,60")
    assert seaglint("evaluate", "scattered", source, "--band", "3.5-5.0", "--extrapolate", "-o", output).code == 0
    one, other = table(output)
    assert (one["extrapolated"], other["extrapolated"]) == ("wind_speed_m_s", "")
    assert float(one["scattered_W_m2_sr[3.5-5.0]"]) == pytest.approx(float(other["scattered_W_m2_sr[3.5-5.0]"]), rel=1e-9)


def test_continuous_air_is_that_of_pictures(seaglint, cases, tmp_path):
    """The table's layers by default, continuous air where asked for: paths differ by per cents, sunlight by rounding."""
    path = cases(
        "atmosphere,wind_speed_m_s,sensor_height_m,depression_deg,solar_zenith_deg,sky_zenith_deg",
        "midlatitude-summer,7,30,2,50,70",
        "subarctic-winter,12,900,1.5,80,10",
    )
    found = {}
    for levels in ("lowtran", "continuous"):
        output = tmp_path / f"{levels}.csv"
        assert seaglint("evaluate", "atmosphere", path, "-o", output, "--band", "3.5-5.0", "--levels", levels).code == 0
        found[levels] = np.genfromtxt(output, delimiter=",", names=True, dtype=None, encoding="utf-8")
    layers, continuous = found["lowtran"], found["continuous"]
    for name in layers.dtype.names[-5:]:
        close = 0.06 if "path" in name or "sky" in name else 3e-3
        np.testing.assert_allclose(continuous[name], layers[name], rtol=close, err_msg=name)
    assert not np.allclose(continuous["sky_radiance_W_m2_sr3550"], layers["sky_radiance_W_m2_sr3550"], rtol=5e-3)


def test_scattered_sunlight_in_layers_and_without(seaglint, cases, tmp_path):
    """A level line from 20 m stays in LOWTRAN7's lowest layer and has half as much sunlight again there; steeper ones hardly differ."""
    path = cases(SCATTERED, "sky,midlatitude-summer,7,20,0.1,10,60", "path,midlatitude-summer,7,20,-5,10,60", "sky,tropical,12,0,20,90,30")
    found = {}
    for levels in ("lowtran", "continuous"):
        output = tmp_path / f"{levels}.csv"
        assert seaglint("evaluate", "scattered", path, "-o", output, "--band", "3.5-5.0", "--levels", levels).code == 0
        found[levels] = [np.array([float(row[f"{name}_W_m2_sr[3.5-5.0]"]) for row in table(output)]) for name in ("scattered", "thermal")]
    light, warmth = (found["lowtran"][i] / found["continuous"][i] for i in (0, 1))
    assert 1.3 < light[0] < 1.7
    assert np.all(np.abs(light[1:] - 1.0) < 0.2)
    assert np.all((warmth > 0.9) & (warmth < 1.01))


def test_slopes_of_a_scenario_by_band(seaglint, tmp_path):
    """The bands as a table and as JSON have the numbers of the function in Python; reports go to the other stream."""
    (tmp_path / "sea.toml").write_text('wind.speed_m_s = 7.0\nsea.spectrum.kind = "radyo-2008"\nsea.shortest_wave_m = 0.1\n')
    answer = seaglint("evaluate", "slopes", tmp_path / "sea.toml", "--bands", "5,20,100,1000", "--json")
    assert answer.code == 0
    result = json.loads(answer.out)
    data = sg.evaluate.slopes(tmp_path / "sea.toml", bands=[5, 20, 100, 1000])
    for name in ("k_min_rad_m", "k_max_rad_m", "drawn_up", "drawn_cross", "facets_up", "facets_cross", "spectrum_up", "spectrum_cross"):
        assert [band[name] for band in result["bands"]] == pytest.approx(data[name].values.tolist(), rel=1e-12)
    assert result["whole"]["facets_up"] == data.attrs["whole_facets_up"]
    text = seaglint("evaluate", "slopes", tmp_path / "sea.toml")
    assert [line.split()[0] for line in text.out.splitlines()[2:4]] == ["1-5", "5-10"]
    assert text.out.splitlines()[-1].startswith("     whole sea")


@pytest.mark.parametrize(
    ("options", "table", "text"),
    [
        (("--bands", "20,5"), "", "bands = 20,5 are no bands of wavenumbers; give two or more ascending edges"),
        (("--bands", "5"), "", "bands = 5 are no bands"),
        (
            (),
            'wind.speed_m_s = 1.0\nsea.spectrum.kind = "radyo-2008"',
            "wind.speed_m_s: a wind of 1 m/s is outside the 1.73 to 9.24 m/s of radyo-2008",
        ),
        ((), 'sea.spectrum = {kind = "wavenumber-file", path = "k.csv"}', "column 'k' has no unit that is known; name it wavenumber_rad_m"),
        ((), 'sea.spectrum = {kind = "wavenumber-file", path = "asit-2019"}', "set kind = 'asit-2019' and leave path out"),
    ],
)
def test_seas_and_bands_that_cannot_be_are_one_line(seaglint, tmp_path, options, table, text):
    """Exit code 2 and one line with the remedy."""
    (tmp_path / "sea.toml").write_text(table + "\n")
    (tmp_path / "k.csv").write_text("k,saturation\n5,0.01\n50,0.01\n500,0.01\n")
    answer = seaglint("evaluate", "slopes", tmp_path / "sea.toml", *options)
    assert answer.code == 2
    assert answer.out == ""
    assert one_line(answer.err)
    assert text in answer.err
