"""Spectra of a user beside those of a scenario: resolution, direction, sunlight, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

import seaglint as sg
from seaglint.base.errors import DataError
from seaglint.optics.band import triangular_average
from seaglint.optics.blackbody import planck_wavenumber
from seaglint.radiance.mean_radiance import mean_radiance
from seaglint.studies.build import scenario_physics
from seaglint.studies.measured.compare_spectrum import scene_spectrum
from seaglint.studies.measured.measured_numbers import shipped

NIGHT = {"sun": {"zenith_deg": 120, "azimuth_deg": 200}, "sensor": {"height_m": 30, "azimuth_deg": 200}}
DAY = NIGHT | {"sun": {"zenith_deg": 60, "azimuth_deg": 200}}


def ours_as_measured(scenario, nu, **direction):
    """Our own spectrum at a resolution of 20 cm-1, as a user would give it."""
    any_light = {"wavenumber_cm": nu, "brightness_temperature_k": np.full(nu.size, 280.0), "resolution_cm": 20.0}
    result = sg.compare_spectrum(any_light, scenario, **direction)
    return {"wavenumber_cm": result.wavenumber_cm, "radiance_w_m2_sr_cm": result.ours, "resolution_cm": 20.0}


@pytest.mark.parametrize("direction", [{"zenith_deg": 45.0}, {"depression_deg": 20.0}])
def test_our_own_spectrum_differs_by_nothing(direction) -> None:
    scene = sg.load(NIGHT)
    own = ours_as_measured(scene, np.arange(800.0, 1255.0, 5.0), **direction)
    result = sg.compare_spectrum(own, scene, **direction)
    assert {row.band_um for row in result.bands} >= {(8.0, 9.2), (10.0, 12.0), (8.0, 12.0)}
    assert max(abs(row.difference_k) for row in result.bands) < 1e-9
    assert result.notes == ()


def test_a_warmer_sea_is_that_much_warmer() -> None:
    """A blackbody of 300 K at 20 cm-1: the table has its temperature in every band."""
    nu = np.arange(800.0, 1255.0, 5.0)
    light = {"wavenumber_cm": nu, "radiance_mw_m2_sr_cm": 1e3 * planck_wavenumber(nu, 300.0), "resolution_cm": 20.0}
    result = sg.compare_spectrum(light, sg.load(NIGHT), depression_deg=45.0)
    for row in result.bands:
        assert row.measured_k == pytest.approx(300.0, abs=0.01)
        assert row.difference_k == pytest.approx(row.ours_k - 300.0, abs=0.01)
        assert 280.0 < row.ours_k < 290.0


def test_a_finer_spectrum_is_averaged() -> None:
    nu = np.arange(850.0, 1150.1, 0.5)
    comb = planck_wavenumber(nu, np.where(np.arange(nu.size) % 2 == 0, 270.0, 290.0))
    columns = {"wavenumber_cm": nu, "radiance_w_m2_sr_cm": comb}
    result = sg.compare_spectrum(columns, sg.load(NIGHT), resolution_cm=0.5, zenith_deg=0.0)
    mean = 0.5 * (planck_wavenumber(result.wavenumber_cm, 270.0) + planck_wavenumber(result.wavenumber_cm, 290.0))
    np.testing.assert_allclose(result.measured, mean, rtol=2e-3)
    assert result.resolution_cm == 20.0
    assert "averaged from 0.5 to 20 cm-1" in result.notes[0]


def test_of_a_coarser_spectrum_ours_is_averaged() -> None:
    """A triangle of 100 cm-1 is what is left of 20 cm-1 averaged by one of the root of 100**2 - 20**2."""
    scene, nu = sg.load(NIGHT), np.arange(800.0, 1255.0, 5.0)
    light = {"wavenumber_cm": nu, "brightness_temperature_k": np.full(nu.size, 280.0)}
    fine = sg.compare_spectrum(light, scene, resolution_cm=20.0, zenith_deg=30.0)
    coarse = sg.compare_spectrum(light, scene, resolution_cm=100.0, zenith_deg=30.0)
    middle = slice(25, -25)
    expected = triangular_average(nu, fine.ours, nu, np.sqrt(100.0**2 - 20.0**2))
    np.testing.assert_allclose(coarse.ours[middle], expected[middle], rtol=5e-5)  # rays differ by the band that they are splined in
    assert "ours is averaged from 20 to its 100 cm-1" in coarse.notes[0]


def test_the_direction_is_the_camera_s_unless_one_is_given() -> None:
    scene = sg.load(NIGHT | {"sensor": {"height_m": 30, "elevation_deg": -25.0}})
    nu = np.arange(900.0, 1105.0, 5.0)
    light = {"wavenumber_cm": nu, "brightness_temperature_k": np.full(nu.size, 280.0), "resolution_cm": 20.0}
    axis, given = sg.compare_spectrum(light, scene), sg.compare_spectrum(light, scene, depression_deg=25.0)
    np.testing.assert_array_equal(axis.ours, given.ours)
    assert axis.elevation_deg == pytest.approx(-25.0)


@pytest.mark.parametrize("elevation", [-15.0, 25.0])
@pytest.mark.parametrize("conditions", [NIGHT, DAY], ids=["night", "day"])
def test_spectra_add_up_to_the_mean_radiance(conditions, elevation: float) -> None:
    """Over the whole band, which the parts with sunlight divide evenly: the mean model's own sum, within its splines."""
    view = scenario_physics.view(sg.load(conditions | {"band": {"min_um": 3.7, "max_um": 4.1}}))
    angles = np.radians([elevation, 200.0])
    spectrum = scene_spectrum(view, *angles.tolist())
    expected = float(mean_radiance(view, *angles).total[0, 0])
    # the grid reaches a little beyond the band, and a part's shape of sunlight is not exact at its ends
    assert float(spectrum @ view.band.weights(view.atmosphere.wavenumber_cm)) == pytest.approx(expected, rel=2e-3)


def test_aeri_s_sky_through_the_command_s_way(tmp_path) -> None:
    """The sounding as a scenario's: within 0.3 K of the comparison without one, whose lowest level is that of the site."""
    levels, held = shipped("aeri_sounding").columns, shipped("aeri").columns
    rows = np.stack(list(levels.values()), axis=1)
    rows[:, 0] -= rows[0, 0]
    text = "\n".join(",".join(f"{value:.6g}" for value in row) for row in rows)
    (tmp_path / "sgp.csv").write_text(",".join(levels) + "\n" + text + "\n")
    air = {"source": "lowtran", "sounding": str(tmp_path / "sgp.csv"), "haze": "none"}
    scene = sg.load({"sensor": {"height_m": 1.0}, "atmosphere": air})
    result = sg.compare_spectrum({**held, "resolution_cm": 20.0}, scene, zenith_deg=0.0, spectroscopy="lowtran7")
    bands = {row.band_um: row.difference_k for row in result.bands}
    assert bands[8.0, 9.2] == pytest.approx(-0.26, abs=0.3)
    assert bands[10.0, 12.0] == pytest.approx(-2.76, abs=0.3)


def test_parts_with_a_gap_are_compared_apart() -> None:
    nu = np.concatenate([np.arange(850.0, 1000.0, 5.0), np.arange(2100.0, 2200.0, 5.0)])
    light = {"wavenumber_cm": nu, "brightness_temperature_k": np.full(nu.size, 280.0), "resolution_cm": 20.0}
    result = sg.compare_spectrum(light, sg.load(NIGHT), zenith_deg=0.0)
    np.testing.assert_array_equal(result.wavenumber_cm, nu)
    assert len([row for row in result.bands if row.band_um[0] < 5.0 < row.band_um[1]]) == 0


def test_what_lies_beyond_the_band_laws_is_left_out_and_named() -> None:
    nu = np.arange(550.0, 905.0, 5.0)
    light = {"wavenumber_cm": nu, "brightness_temperature_k": np.full(nu.size, 280.0), "resolution_cm": 20.0}
    result = sg.compare_spectrum(light, sg.load(NIGHT), zenith_deg=0.0)
    assert result.wavenumber_cm[0] == 685.0
    assert "only what lies within 0.7-14.7 um is compared" in result.notes[0]


NU = np.arange(900.0, 1105.0, 5.0)
LIGHT = {"wavenumber_cm": NU, "brightness_temperature_k": np.full(NU.size, 280.0), "resolution_cm": 20.0}
SPARSE = {"wavenumber_cm": NU[::8], "brightness_temperature_k": np.full(NU[::8].size, 280.0), "resolution_cm": 1.0}


@pytest.mark.parametrize(
    ("light", "options", "match"),
    [
        (LIGHT, {"resolution_cm": 500.0}, "more than half of the spectrum's 200 cm-1"),
        (LIGHT, {"resolution_cm": -1.0}, "resolution_cm = -1 is not a width above 0"),
        (LIGHT, {"zenith_deg": 100.0}, "outside 0-90"),
        (LIGHT, {"depression_deg": 0.0}, "does not meet the sea"),
        (LIGHT, {"depression_deg": 5.0, "zenith_deg": 5.0}, "are both given"),
        (LIGHT, {"spectroscopy": "hitran"}, "'hitran' is not one of"),
        (LIGHT | {"wavenumber_cm": 0.5 * NU}, {}, r"outside the 0\.7-14\.7 um"),
        (SPARSE, {}, "leave nothing to compare"),
    ],
)
def test_what_cannot_be_compared_is_refused(light, options, match: str) -> None:
    with pytest.raises(DataError, match=match):
        sg.compare_spectrum(light, sg.load(NIGHT), **options)
