"""Measured spectra, other models and a buoy beside ours: differences within stated bounds, and shipped tables as their tool makes them."""

from __future__ import annotations

import csv
import io

import numpy as np
import pytest

import build_measured_data
from seaglint.air.profile.air_profile import GASES, model_profile
from seaglint.base.errors import DomainError
from seaglint.studies.measured.against_measurements import (
    ABSENT,
    BANDS_CM,
    SCENES,
    TABLES,
    TITLE,
    against_measurements,
    buoy_rows,
    homogeneous_air,
    modtran_path_rows,
    modtran_sky_rows,
    path_rows,
    scene_rows,
    sky_rows,
)
from seaglint.studies.measured.measured_numbers import SPECTROSCOPIES, chosen_spectroscopies, shipped, with_gas

BOUNDS_K = {
    ("aeri", "8-9.2 um"): 0.6,
    ("aeri", "8-12 um"): 0.8,
    ("aeri", "10-12 um"): 1.0,
    ("aeri", "13-14 um"): 0.7,
    ("his", "10.5-12.5 um"): 0.5,
    ("his", "13-14 um"): 1.0,
    ("iris", "8-9.2 um"): 0.6,
}
"""Published bounds of the numbers refitted to today's line-by-line models [K]."""

LOWTRAN_K = {
    ("aeri", "8-9.2 um"): (-0.26, 0.1),
    ("aeri", "8-12 um"): (-1.79, 0.1),
    ("aeri", "10-12 um"): (-2.76, 0.1),
    ("aeri", "13-14 um"): (0.08, 0.25),
    ("his", "10.5-12.5 um"): (-0.26, 0.1),
    ("his", "13-14 um"): (-4.8, 0.5),
    ("iris", "8-9.2 um"): (0.13, 0.15),
    ("iris", "10-12 um"): (2.1, 0.2),
    ("iris", "13-14 um"): (-2.0, 0.5),
}
"""Differences of LOWTRAN7's laws [K], found apart from this code on the fine spectra, and how far averages over 20 cm-1 may be off them."""


def differences(spectroscopy):
    """Differences of temperature of the measured scenes [K] by name and band."""
    names = {scene.title: scene.name for scene in SCENES}
    return {(names[row.case], row.quantity): row.difference_k for row in scene_rows((spectroscopy,))[0]}


def test_lowtran7_differs_from_measurements_as_its_laws_do() -> None:
    found = differences("lowtran7")
    assert found.keys() == LOWTRAN_K.keys()
    for key, (expected, within) in LOWTRAN_K.items():
        assert found[key] == pytest.approx(expected, abs=within), key


def test_refitted_numbers_lie_within_the_published_bounds() -> None:
    found = differences("lblrtm")
    assert {key: found[key] for key, bound in BOUNDS_K.items() if abs(found[key]) > bound} == {}


def test_refitted_numbers_follow_paths_and_skies_more_closely() -> None:
    for compute in (path_rows, sky_rows):
        rms = {name: np.mean([row.rms for row in compute((name,))]) for name in ("lblrtm", "lowtran7")}
        assert rms["lblrtm"] < 0.7 * rms["lowtran7"]


@pytest.mark.parametrize(
    ("compute", "quantity", "percent"),
    [
        (modtran_path_rows, "3.5-4.15 um", -19.0),
        (modtran_path_rows, "3.5-5 um", -18.0),
        (modtran_path_rows, "8-12 um", -0.7),
        (modtran_path_rows, "10-12 um", 20.0),
        (modtran_sky_rows, "3.6-4 um", 69.0),
    ],
)
def test_lowtran7_differs_from_modtran_4_as_found_apart(compute, quantity: str, percent: float) -> None:
    """The expected numbers are of the unaveraged files; those of the sky are for its radiance."""
    (row,) = (row for row in compute(("lowtran7",))[0] if row.quantity == quantity)
    assert row.difference_percent == pytest.approx(percent, abs=1.5)


def test_lowtran7_differs_from_rrtmgp_as_found_apart() -> None:
    """Mean bias by band of 400 other paths: within 0.015 for the 60 here, whose water differs."""
    bias = {"10.2-12.2 um": 0.0, "8.47-9.26 um": -0.009, "4.81-5.56 um": -0.019, "3.73-4.18 um": -0.027, "3.08-3.73 um": -0.024}
    rows = {row.quantity: row for row in path_rows(("lowtran7",)) if row.case.endswith("400-1030 hPa")}
    assert len(rows) == len(BANDS_CM)
    for quantity, expected in bias.items():
        row = rows[quantity]
        assert row.ours - row.measured == pytest.approx(expected, abs=0.015)


def test_a_homogeneous_path_is_of_the_gases_that_its_row_states() -> None:
    held = shipped("rrtmgp_paths").columns
    path = {name: float(values[3]) for name, values in held.items()}
    air = homogeneous_air(path)
    dry = 1.0 - path["vapour_pressure_hpa"] / path["pressure_hpa"]
    assert air.gas[GASES.index("CO2"), 0] == pytest.approx(path["co2_ppmv_dry"] * dry)
    assert air.gas[GASES.index("HNO3"), 0] == 0.0
    # the ideal gas law at the vapour's pressure, apart from the constants of the code
    assert float(air.vapour[0]) == pytest.approx(216.7 * path["vapour_pressure_hpa"] / path["temperature_k"], rel=1e-3)
    assert set(ABSENT) <= set(BANDS_CM)


def test_the_buoy_s_waves_are_those_of_its_displacements() -> None:
    """Bounds are three standard errors of the displacements' energies, and 4 deg where waves have a direction."""
    rows = {row.quantity: row for row in buoy_rows()}
    assert {row.case for row in rows.values()} == {TITLE}
    bands = shipped("cdip_bands").columns
    for low, high, energy, error, spread in zip(
        *(bands[name] for name in ("low_hz", "high_hz", "energy_m2", "energy_error_m2", "spread_deg")), strict=True
    ):
        row = rows[f"energy, {low:g}-{high:g} Hz"]
        assert abs(row.ours - energy) < 3.0 * error
        turned = rows[f"direction, {low:g}-{high:g} Hz"]
        assert abs(turned.ours - turned.measured) < (4.0 if spread < 70.0 else 10.0)
    assert rows["significant height"].ours == pytest.approx(rows["significant height"].measured, rel=0.02)


def test_the_table_holds_every_row_with_its_sentence() -> None:
    result = against_measurements("lowtran7")
    body = [line for line in result.csv().splitlines() if not line.startswith("#")]
    rows = list(csv.DictReader(io.StringIO("\n".join(body))))
    assert len(rows) == len(result.rows)
    assert all(row["reason"] and row["ours"] and row["measured"] for row in rows)
    text = "\n".join(result.lines())
    for row in result.rows:
        assert row.reason in text
        assert row.case in text
    assert [scene.wavenumber_cm.size == scene.measured.size for scene in result.spectra] == [True] * 5


def test_every_table_names_its_source_and_terms() -> None:
    for name in (*TABLES, *(f"{scene.name}_sounding" for scene in SCENES)):
        assert {"source", "terms", "processing", "made from"} <= shipped(name).facts.keys()


def test_shipped_tables_are_what_their_tool_makes(reference_dir, tmp_path, monkeypatch) -> None:
    if not (reference_dir / "measured_air").is_dir():
        pytest.skip("the reference folder has no measured air")
    monkeypatch.setattr(build_measured_data, "OUT", tmp_path)
    monkeypatch.setattr(build_measured_data, "SEA_OUT", tmp_path / "sea")
    monkeypatch.setattr("sys.argv", ["build", str(reference_dir)])
    shipped_folder = build_measured_data.Path(shipped.__wrapped__.__code__.co_filename).parents[1] / "data"
    build_measured_data.main()
    made = {path.name: path for path in tmp_path.glob("*.csv")}
    assert made.keys() == {path.name for path in shipped_folder.glob("measured_*.csv")}
    seas = shipped_folder.parents[1] / "sea" / "data"
    pairs = [(path, shipped_folder / name) for name, path in made.items()]
    pairs += [(path, seas / path.name) for path in (tmp_path / "sea").iterdir()]
    for pair in pairs:
        both = [[line for line in file.read_text().splitlines() if line[0].isdigit() or line[0] == "-"] for file in pair]
        # six digits are written
        np.testing.assert_allclose(*(np.loadtxt(lines, delimiter=",") for lines in both), rtol=2e-5, atol=1e-9)


def test_gases_are_scaled_to_their_lowest_level() -> None:
    profile = with_gas(model_profile("tropical"), "CO2", 425.0)
    assert profile.gas[GASES.index("CO2"), 0] == pytest.approx(425.0)
    np.testing.assert_array_equal(profile.gas[GASES.index("O3")], model_profile("tropical").gas[GASES.index("O3")])


def test_other_words_name_no_spectroscopy() -> None:
    assert chosen_spectroscopies("both") == SPECTROSCOPIES
    with pytest.raises(DomainError, match=r"spectroscopy = 'hitran' is not one of .*both"):
        chosen_spectroscopies("hitran")
