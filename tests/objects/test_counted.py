"""Objects as a detector of photons counts them, against the tests' own spectral integrals."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest
from edwards_bands import BANDS, spectrum
from scipy import constants
from scipy.integrate import quad

from seaglint.imaging.camera.imager import Attitude, Imager
from seaglint.imaging.camera.pose import Pose
from seaglint.instrument.photons import Photons
from seaglint.objects import solids
from seaglint.objects.body import Body, GasPlume, Placement, PointSource
from seaglint.objects.drawing.compose import point_intensity, point_light
from seaglint.objects.drawing.draw import Drawer, PixelPatch, Stage
from seaglint.objects.drawing.light import Counting, Surroundings
from seaglint.objects.drawing.sample_sums import COUNTED, COVER, EMITTED, MIRRORED, PATH, SUN
from seaglint.objects.solids import solid
from seaglint.optics.band import Band
from seaglint.scenario.load import parse_scenario
from seaglint.studies.sequence.render_sequence import prepare_sequence
from seaglint.studies.sequence.sensed_sequence import prepare_sensed

EYE = 10.0
BANDS_UM = [(3.0, 5.0), (8.0, 12.0)]
SEA = 288.15


@dataclass
class Still:
    """Where it always is."""

    position: tuple[float, float, float]

    def at(self, time: float) -> Placement:
        return Placement(np.array(self.position), np.eye(3))


@cache
def view_of(band, air="table", sun=60.0):
    sources = {
        "table": {},
        "none": {"atmosphere": {"source": "none"}},
        "isothermal": {"atmosphere": {"source": "isothermal", "temperature_k": SEA, "extinction_per_km": 0.3}},
    }
    tables = {
        "band": {"min_um": band[0], "max_um": band[1]},
        "sensor": {"pixels": [4, 4], "fov_deg": [0.2, 0.2], "elevation_deg": 0.0, "azimuth_deg": 0.0, "height_m": EYE},
        "sun": {"zenith_deg": sun, "azimuth_deg": 180.0},
        "sea": {"resolve_waves": False, "temperature_k": SEA},
        **sources[air],
    }
    return prepare_sequence(parse_scenario(tables)).scene.view


def stage_of(view, degrees=0.2) -> Stage:
    imager = Imager("pinhole", math.radians(degrees), math.radians(degrees), 9, 9)
    return Stage(imager, Pose(0.0, 0.0, EYE, Attitude(0.0, 0.0)), view, None, (0, 9), (0, 9))


def drawn(part, distance: float, view, counted: Counting | None) -> PixelPatch:
    """A part before the camera, which it fills."""
    drawer = Drawer.of((Body("it", (part,), Still((0.0, distance, EYE))),), counted)
    (patch,) = drawer.picture(stage_of(view), 0.0).patches
    return patch


def planck_um(um: float, kelvin: float) -> float:
    """Blackbody [W m-2 sr-1 um-1]."""
    metre = 1e-6 * um
    return 2e-6 * constants.h * constants.c**2 / metre**5 / math.expm1(constants.h * constants.c / (metre * constants.k * kelvin))


def per_band(kelvin: float, band, power: int) -> float:
    """Integral of a blackbody over wavelengths, times a power of them."""
    return quad(lambda um: planck_um(um, kelvin) * um**power, *band, epsabs=0.0, epsrel=1e-10)[0]


def reference(band) -> float:
    """Mean wavelength by which a blackbody of 300 K counts [um]."""
    return per_band(300.0, band, 1) / per_band(300.0, band, 0)


def wall(kelvin: float, emissivity: float = 1.0, size: float = 20.0):
    return solid(solids.box((size, 1e-3, size)), kelvin, emissivity)


TEMPERATURES = [230.0, 400.0, 600.0, 1000.0, 1500.0]


@pytest.mark.parametrize("kelvin", TEMPERATURES)
@pytest.mark.parametrize("band", BANDS_UM)
def test_electrons_of_a_body_in_vacuum_are_its_spectrum(band, kelvin):
    view = view_of(band, "none")
    patch = drawn(wall(kelvin), 400.0, view, Photons(view.band).counted)
    expected = per_band(kelvin, band, 1) / reference(band)
    assert patch.planes[COVER].min() == pytest.approx(1.0)
    np.testing.assert_allclose(patch.counted, expected, rtol=5e-4)
    energy = patch.planes[[PATH, EMITTED, MIRRORED, SUN]].sum(axis=0)
    np.testing.assert_allclose(energy, per_band(kelvin, band, 0), rtol=5e-4)
    # one spectrum for all light missed by much more than this test's tolerance
    if kelvin >= 400.0 and band == BANDS_UM[0]:
        assert np.median(energy) / expected > 1.03


@pytest.mark.parametrize("kelvin", TEMPERATURES)
@pytest.mark.parametrize("distance", [100.0, 3000.0])
@pytest.mark.parametrize("band", BANDS_UM)
def test_electrons_of_a_body_through_air_are_its_spectrum(band, distance, kelvin):
    view = view_of(band)
    air = view.atmosphere
    # a small wall above the sea: between the corners of a body light is linear in range and height
    small = wall(kelvin, size=min(0.02 * distance, 18.0))
    patch = drawn(small, distance, view, Photons(view.band).counted)
    nu = np.linspace(1e4 / band[1], 1e4 / band[0], 20_001)
    tau = np.interp(nu, air.wavenumber_cm, air.transmittance(EYE, distance, EYE))
    path = np.interp(nu, air.wavenumber_cm, air.path_radiance(EYE, distance, EYE))
    um = 1e4 / nu
    body = np.array([planck_um(x, kelvin) for x in um]) * um**2 / 1e4  # per cm-1
    thermal = np.trapezoid((tau * body + path) * um, nu) / reference(band)
    # sunlight scattered into the path is no part of path_radiance
    dark = drawn(small, distance, replace(view, scattering=False), Photons(view.band).counted)
    np.testing.assert_allclose(dark.counted[4, 4], thermal, rtol=2e-3)
    assert patch.counted[4, 4] >= dark.counted[4, 4] * (1.0 - 1e-6)


@pytest.mark.parametrize(("sun", "air"), [(70.0, "table"), (110.0, "table"), (70.0, "none")])
def test_counting_half_of_a_band_is_seeing_half_of_it(sun, air):
    """All kinds of light: a weight that is the response of another band gives the radiance in that band."""
    whole = view_of((3.0, 5.0), air, sun)
    half = Band.from_response([3.0, 3.8, 4.6, 5.0], [0.0, 1.0, 0.3, 0.0])
    part = solid(solids.ellipsoid((9.0, 9.0, 9.0)), np.linspace(280.0, 500.0, 1002), 0.4)
    counted = drawn(part, 900.0, replace(whole, scattering=False), half.response_at)
    seen = drawn(part, 900.0, replace(whole, band=half, scattering=False), None)
    total = seen.planes[[PATH, EMITTED, MIRRORED, SUN]].sum(axis=0)
    np.testing.assert_allclose(counted.counted, total, rtol=2e-3)
    np.testing.assert_allclose(seen.counted, total, rtol=1e-12)
    if sun < 90.0:
        assert seen.planes[SUN].max() > 0.0
    # sunlight scattered into the path has the spectrum of the Sun through the air
    both = (drawn(part, 900.0, whole, half.response_at).counted, drawn(part, 900.0, replace(whole, band=half), None).counted)
    np.testing.assert_allclose(*both, rtol=1e-2)


@pytest.mark.parametrize("band", BANDS_UM)
@pytest.mark.parametrize("emissivity", [1.0, 0.5])
def test_what_has_the_temperature_of_all_about_it_counts_as_the_sea_that_it_hides(band, emissivity):
    view = replace(view_of(band, "isothermal"), solar_zenith=math.pi)
    counted = Photons(view.band).counted
    light = Surroundings.of(view, counted)
    sea = float(view.band.radiance(SEA, view.atmosphere.wavenumber_cm))
    gases = GasPlume((0.0, 0.0, 0.0), (9.0, 3.0, 9.0), SEA, None, 0.1, 0.1)
    for part in (wall(SEA, emissivity), gases, replace(gases, emissivity=0.5)):
        patch = drawn(part, 500.0, view, counted)
        change = patch.counted - patch.planes[COVER] * sea * light.sea_counted
        energy = patch.planes[[PATH, EMITTED, MIRRORED, SUN]].sum(axis=0) - patch.planes[COVER] * sea
        np.testing.assert_allclose(change, 0.0, atol=1e-3 * sea)
        np.testing.assert_allclose(energy, 0.0, atol=1e-3 * sea)


def test_sea_counts_by_its_own_temperature():
    for band in BANDS_UM:
        view = view_of(band)
        found = Surroundings.of(view, Photons(view.band).counted).sea_counted
        assert found == pytest.approx(per_band(SEA, band, 1) / per_band(SEA, band, 0) / reference(band), rel=1e-4)
        assert Surroundings.of(view).sea_counted == pytest.approx(1.0, rel=1e-12)


def own_plume(view, kelvin: float, share: float, length: float, distance: float, mean_um: float) -> tuple[float, ...]:
    """Emission of carbon dioxide through the air, the sea's light that it absorbs and all of it: each as radiance and as counted."""
    air = view.atmosphere
    nu = np.arange(2000.125, 3333.0, 0.25)
    tau = np.interp(nu, air.wavenumber_cm, air.transmittance(EYE, distance, EYE))
    absorbed = 1.0 - np.prod([1.0 - spectrum(name, nu, kelvin, share, length) for name in BANDS if name.startswith("co2")], axis=0)
    um = 1e4 / nu

    def planck(t: float) -> np.ndarray:
        return np.array([planck_um(x, t) for x in um]) * um**2 / 1e4

    sums = []
    for light in (absorbed * tau * planck(kelvin), absorbed * tau * planck(SEA), tau * planck(SEA)):
        sums += [0.25 * float(light.sum()), 0.25 * float((light * um).sum()) / mean_um]
    return tuple(sums)


@pytest.mark.parametrize("distance", [1.0, 100.0, 2000.0])
@pytest.mark.parametrize(("kelvin", "share"), [(1200.0, 0.1), (700.0, 0.03), (400.0, 0.3)])
def test_the_band_of_a_plume_is_seen_through_the_band_of_the_air(distance, kelvin, share):
    """Its emission is what wavenumbers between the opaque middle of the cold band and the wings of the hot one let through."""
    view = replace(view_of((3.0, 5.0)), scattering=False)
    deep, side = min(0.5 * distance, 5.0), 0.01 * distance
    plume = GasPlume((0.0, 0.0, 0.0), (side, deep / 2.0, side), kelvin, None, share, 0.0)
    middle = distance + deep / 2.0
    patch = drawn(plume, middle, view, Photons(view.band).counted)
    emitted, counted, hidden, hidden_counted, behind, _ = own_plume(view, kelvin, share, deep, middle, reference((3.0, 5.0)))
    cover, path = patch.planes[COVER][4, 4], patch.planes[PATH][4, 4]
    assert cover == pytest.approx(hidden / behind, rel=1e-2)
    # emission less what it takes of the light behind, as the image of the sea changes where the sea is seen through the same air
    energy = patch.planes[EMITTED][4, 4] - cover * behind
    assert energy == pytest.approx(emitted - hidden, rel=1e-2)
    light = Surroundings.of(view, Photons(view.band).counted)
    as_counted = patch.counted[4, 4] - cover * (path / cover + behind) * light.sea_counted
    # the path and the sea are nearly of one spectrum; what is not is small beside hot gas
    assert as_counted == pytest.approx(counted - hidden_counted, rel=1e-2, abs=2e-3)
    if distance == 2000.0 and kelvin == 1200.0:
        grey = emitted / own_plume(view, kelvin, share, deep, 0.01, 4.0)[0]
        flat = np.interp(np.arange(2000.0, 3333.0), view.atmosphere.wavenumber_cm, view.atmosphere.transmittance(EYE, middle, EYE)).mean()
        assert grey < 0.5 * flat  # a flat transmittance would let much more through


def test_gas_before_a_body_takes_its_share():
    view = view_of((3.0, 5.0), "none")
    part = wall(500.0)
    plume = GasPlume((0.0, 0.0, 0.0), (40.0, 2.0, 40.0), 900.0, None, 0.1, 0.1)
    drawer = Drawer.of((Body("wall", (part,), Still((0.0, 500.0, EYE))), Body("gas", (plume,), Still((0.0, 400.0, EYE)))))
    patches = {patch.placed.part.body: patch for patch in drawer.picture(stage_of(view), 0.0).patches}
    alone = drawn(part, 500.0, view, None)
    assert patches[0].planes[COVER][4, 4] == pytest.approx(alone.planes[COVER][4, 4] * (1.0 - patches[1].planes[COVER][4, 4]), rel=1e-3)
    assert 0.05 < patches[1].planes[COVER][4, 4] < 0.95


@pytest.mark.parametrize("kelvin", [250.0, 700.0, 2200.0])
@pytest.mark.parametrize("band", BANDS_UM)
def test_a_point_with_a_temperature_counts_by_its_spectrum(band, kelvin):
    view = view_of(band)
    light = Surroundings.of(view, Photons(view.band).counted)
    air, distance = view.atmosphere, 1500.0
    patch = drawn(PointSource(40.0, temperature=kelvin), distance, view, Photons(view.band).counted)
    nu = np.linspace(1e4 / band[1], 1e4 / band[0], 20_001)
    um = 1e4 / nu
    body = np.array([planck_um(x, kelvin) for x in um]) * um**2
    tau = np.interp(nu, air.wavenumber_cm, air.transmittance(EYE, distance, EYE))
    intensity, counted = point_intensity(patch, 1.0, light)
    assert intensity == 40.0
    assert patch.clear == pytest.approx(np.trapezoid(tau * body, nu) / np.trapezoid(body, nu), rel=2e-3)
    assert counted == pytest.approx(40.0 * np.trapezoid(tau * body * um, nu) / np.trapezoid(tau * body, nu) / reference(band), rel=2e-3)
    solid_angle = np.array([[1e-6]])
    expected = patch.clear * counted / (float(patch.placed.place @ patch.placed.place) * 1e-6)
    assert point_light(patch, solid_angle, 1.0, light)[0].item() == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("difference", [-20.0, 5.0, 600.0])
def test_a_point_warmer_than_its_background_is_the_difference_of_two_blackbodies(difference):
    band = (3.0, 5.0)
    view = view_of(band, "none")
    light = Surroundings.of(view, Photons(view.band).counted)
    patch = drawn(PointSource(None, difference, 3.0), 1500.0, view, Photons(view.band).counted)
    behind = per_band(285.0, band, 0)
    intensity, counted = point_intensity(patch, behind, light)
    energy, photons = (per_band(285.0 + difference, band, power) - per_band(285.0, band, power) for power in (0, 1))
    assert intensity == pytest.approx(3.0 * energy, rel=1e-3)
    assert counted == pytest.approx(3.0 * photons / reference(band), rel=1e-3)


def test_a_point_without_a_spectrum_counts_as_the_chain_converts():
    view = view_of((3.0, 5.0))
    light = Surroundings.of(view, Photons(view.band).counted)
    patch = drawn(PointSource(40.0), 1500.0, view, Photons(view.band).counted)
    assert point_intensity(patch, 1.0, light) == (40.0, 40.0)


def test_the_image_does_not_depend_on_counting():
    run = prepare_sequence(
        parse_scenario(
            {
                "sensor": {"pixels": [16, 12], "fov_deg": [2.0, 1.5], "elevation_deg": -0.5, "azimuth_deg": 0.0, "height_m": 20.0},
                "sea": {"resolve_waves": False},
                "objects": [
                    {
                        "name": "hot",
                        "shape": {"kind": "sphere", "radius_m": 4.0},
                        "temperature_k": 700.0,
                        "north_m": 900.0,
                        "height_m": 10.0,
                    },
                    {
                        "name": "smoke",
                        "shape": {"kind": "plume", "semi_axes_m": [5, 5, 5], "co2_share": 0.1, "h2o_share": 0.1, "temperature_k": 800.0},
                        "north_m": 700.0,
                        "height_m": 14.0,
                    },
                ],
            }
        )
    )
    before, after = run.at(0.0), run.counting(Photons(run.scene.view.band).counted).at(0.0)
    np.testing.assert_array_equal(before.radiance, after.radiance)
    assert run.objects is not None
    drawer = run.counting(Photons(run.scene.view.band).counted).objects.drawer
    picture = drawer.picture(Stage(run.scene.pixels, run.scene.pose, run.scene.view, None, (0, 16), (0, 12)), 0.0)
    hot = next(patch for patch in picture.patches if patch.placed.part.name == "hot")
    energy, seen = hot.planes[[PATH, EMITTED, MIRRORED, SUN]].sum(axis=0), hot.planes[COVER] > 0.1
    assert (hot.planes[COUNTED][seen] < energy[seen]).all()  # hot light has fewer photons


@pytest.mark.parametrize("kind", ["photon", "thermal"])
def test_photons_are_counted_and_heat_is_not(kind):
    detector = {"pitch_um": 15.0} if kind == "photon" else {"kind": "thermal", "pitch_um": 17.0, "netd_k": 0.05}
    ball = {"name": "ball", "shape": {"kind": "sphere", "radius_m": 2.0}, "temperature_k": 600.0, "north_m": 900.0, "height_m": 10.0}
    sensor = {"pixels": [8, 4], "optics": {"aperture_m": 0.02, "f_number": 1.0}, "detector": detector}
    scenario = parse_scenario({"sensor": sensor, "sea": {"resolve_waves": False}, "objects": [ball]})
    fine = prepare_sensed(scenario).fine
    other = scenario.model_copy(update={"seed": 5})
    for sequence in (fine, fine.reseeded(4), fine.with_sea_of(other)):
        assert sequence.objects is not None
        weights = sequence.objects.drawer.light(sequence.scene.view).counted
        nu = sequence.scene.view.in_band.wavenumber_cm
        if kind == "thermal":
            np.testing.assert_array_equal(weights, 1.0)
        else:  # electrons per joule are as the wavelength
            np.testing.assert_allclose(weights * nu, weights[0] * nu[0], rtol=1e-12)
            assert weights[0] > 1.0 > weights[-1]
