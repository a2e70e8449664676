"""Physics of a scenario: band, air, sea, view, camera and track, in SI units.

Names in the scenario's tables select models. A sensor on a floating platform rides on the waves. Refraction is standard, or follows the
profile of the air (``bending``).
"""

from __future__ import annotations

import json
import logging
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import Final, NamedTuple, assert_never

import numpy as np

from seaglint.air.isothermal import IsothermalAtmosphere
from seaglint.air.profile.profile_atmosphere import ProfileAtmosphere
from seaglint.air.protocol import Atmosphere, wavenumber_grid
from seaglint.air.vacuum import VacuumAtmosphere
from seaglint.base.conventions import FloatArray, surface_range
from seaglint.base.errors import DomainError, Mistake, ScenarioError
from seaglint.base.free_form import Attributes, JsonObject
from seaglint.base.limits import LOWTRAN_HEIGHTS, PROFILE_HEIGHTS
from seaglint.facet.foam import FoamCover
from seaglint.facet.legs import VIEWER, Shadowing
from seaglint.facet.sea_view import LOWER_LIMB, LightDisc, Moonlight, SeaView
from seaglint.formats.tables.input_tables import COLUMNS, read_track
from seaglint.formats.tables.spectra import read_response
from seaglint.imaging.camera.imager import Attitude, Camera, Imager
from seaglint.imaging.camera.pose import Track
from seaglint.imaging.refraction import Bending
from seaglint.imaging.scene import Accuracy
from seaglint.imaging.sparkle_settings import Sparkles
from seaglint.objects.floating import MOST_SAMPLES, FloatingTrack, Swell
from seaglint.optics import sea_water
from seaglint.optics.band import Band
from seaglint.optics.moonlight import moon_to_sun
from seaglint.optics.sea_water import WaterIndex
from seaglint.radiance.lit_variance import WaveGlint
from seaglint.radiance.variance import capillary_length, correlation_length
from seaglint.scenario.model import Scenario
from seaglint.scenario.moon import moon_position
from seaglint.scenario.records import atmosphere_table as requested_air
from seaglint.scenario.records import sea_tables as requested_sea
from seaglint.scenario.records.object_tables import Object
from seaglint.scenario.records.sensor_table import HIGHEST_SENSOR
from seaglint.scenario.records.small_tables import Platform
from seaglint.scenario.sun import SunPosition, sun_position
from seaglint.sea.foam.breaking_crests import BreakingCrests
from seaglint.sea.foam.coverage_laws import coverage
from seaglint.sea.foam.foam_field import FoamField
from seaglint.sea.second_order import bound_limit, bound_skewness
from seaglint.sea.slopes.cox_munk import WIND_HEIGHT, cox_munk_isotropic
from seaglint.sea.slopes.slope_statistics import SlopeStatistics, flat
from seaglint.sea.tiles import RESOLVED_SHARE, longest_wave_number, plan_tiles, resolve_limit
from seaglint.sea.wave_field import WaveField
from seaglint.studies.build.measured_waves import Waves
from seaglint.studies.build.profile_air import ComputedAir, profile_atmosphere, program_sounding
from seaglint.studies.build.waves_and_slopes import drawn_sea_facts, slopes, waves

log = logging.getLogger(__name__)


def afloat(scenario: Scenario, floating: Track, waves: WaveField | None, where: str) -> Track:
    """Return the track, on the waves where the platform floats.

    Raises
    ------
    ScenarioError
        Heights that leave the atmosphere's; ``where`` begins the text.
    """
    platform, sensor = scenario.platform, scenario.sensor
    if platform is not None and platform.floats and waves is not None:
        width, length = platform.waterline_m
        heading = None if platform.heading_deg is None else float(np.radians(platform.heading_deg))
        times = np.linspace(0.0, (sensor.frames - 1) / sensor.frame_rate_hz, min(sensor.frames, MOST_SAMPLES))
        floating = FloatingTrack.create(floating, Swell.of(waves, (0.5 * width, 0.5 * length)), (width, length), heading, times)
    # Waves may lift a sensor out of the heights of the air, so the track is checked after it floats.
    covered = {"table": PROFILE_HEIGHTS, "lowtran": PROFILE_HEIGHTS, "lowtran-fortran": LOWTRAN_HEIGHTS}
    lowest, highest = covered.get(scenario.atmosphere.source, (0.0, HIGHEST_SENSOR))
    if floating.lowest < lowest or floating.highest > highest:
        raise ScenarioError(
            f"{where}heights of {floating.lowest:g} to {floating.highest:g} m leave those of "
            f"atmosphere.source = '{scenario.atmosphere.source}'; allowed: {lowest:g} to {highest:g} m"
        )
    return floating


ANGLES = ("azimuth", "elevation", "roll")  #: Angles of the sensor, by the names of its keys without their unit.


@dataclass(frozen=True)
class PreparedSea:
    """Resolved waves, and the decisions behind them."""

    waves: WaveField | None
    report: JsonObject  #: For the provenance: cut wavenumber and why, tiles, resolved and remaining slope variances.
    reason: str = ""  #: Reason why no waves are resolved although the scenario requests them.


def band(scenario: Scenario) -> Band:
    """Return the spectral response."""
    if scenario.band.response is not None:
        return read_response(scenario.band.response)
    assert scenario.band.min_um is not None  # the model fills both edges where no file is given
    assert scenario.band.max_um is not None
    return Band.rectangular(scenario.band.min_um, scenario.band.max_um)


def atmosphere(scenario: Scenario, over: Band) -> Atmosphere:
    """Return the air, sampled over a band."""
    match scenario.atmosphere:
        case requested_air.TableAtmosphereSettings() | requested_air.LowtranAtmosphere() as requested:
            return profile_atmosphere(requested, scenario, over)
        case requested_air.LowtranFortranAtmosphere() as requested:
            return _lowtran(scenario, requested, over)
        case requested_air.FileAtmosphere(path=path):
            from seaglint.formats.air_file import read_atmosphere

            air, arcs_in_view = read_atmosphere(path, scenario.sensor.height_m), sea_in_view(scenario)
            if air.scattered is not None:
                air.scattered.require_sun(sun_position(scenario).zenith, str(path))
            return air if arcs_in_view is None else air.seen_between(*arcs_in_view)
        case requested_air.IsothermalAtmosphereSettings(temperature_k=temperature, extinction_per_km=extinction):
            return IsothermalAtmosphere(temperature, wavenumber_grid(over.min_um, over.max_um), extinction * 1e-3)
        case requested_air.NoAtmosphere():
            return VacuumAtmosphere(wavenumber_grid(over.min_um, over.max_um))
        case other:
            assert_never(other)


def sea_in_view(scenario: Scenario) -> tuple[float, float | None] | None:
    """Return arcs along the sea of the nearest and farthest pixel [m], the latter None with the horizon in view; None if it moves."""
    if scenario.platform is not None:
        return None
    pose, pixels = track(scenario).at(0.0), imager(scenario)
    # The extremes lie on the border or at the nadir: a grid of at most 129 x 129 pixels comes close enough to both.
    across, down = (np.linspace(0.5, n - 0.5, min(n, 129)) for n in (pixels.columns, pixels.rows))
    # The grid has pixel centres of the border rows and columns at its edges.
    sight = pixels.directions(pose.attitude, across, down[:, None])
    arc = surface_range(pose.height, -np.arcsin(np.clip(sight[..., 2], -1.0, 1.0)))
    sea = np.isfinite(arc)
    return (float(arc[sea].min()), float(arc.max()) if sea.all() else None) if sea.any() else None


def _lowtran(scenario: Scenario, source: requested_air.LowtranFortranAtmosphere, over: Band) -> Atmosphere:
    """Return LOWTRAN7's runs for this sensor height, band and wind, from the cache if it has them."""
    from seaglint.formats.lowtran.deck import Aerosol
    from seaglint.formats.lowtran.lowtran_sample import lowtran_atmosphere

    wind, longer = scenario.wind.speed_m_s, source.wind_24h_m_s
    return lowtran_atmosphere(
        source.model,
        Aerosol(source.haze, source.visibility_km, source.air_mass_character, wind, wind if longer is None else longer),
        scenario.sensor.height_m,
        (over.min_um, over.max_um),
        levels=program_sounding(source, scenario, over),
        name=f"LOWTRAN7 ({source.model if source.sounding is None else source.sounding})",
    )


def water(scenario: Scenario) -> WaterIndex:
    """Return the refractive index of the sea."""
    match scenario.sea.water:
        case "hale-querry-sea":
            return sea_water.hale_querry_sea()
        case "segelstein":
            return sea_water.segelstein()
        case "article":
            return sea_water.article()
        case other:
            assert_never(other)


def foam_coverage(scenario: Scenario) -> float:
    """Return the share of the sea that is foam, by the law of ``sea.foam``; 0 without that table."""
    foam = scenario.sea.foam
    return 0.0 if foam is None else coverage(foam.law, scenario.wind.speed_m_s, extrapolate=foam.extrapolate)


def breaking_crests(scenario: Scenario) -> BreakingCrests | None:
    """Return the breaking crests whose foam has the coverage of the law; None for a sea without foam."""
    foam, share = scenario.sea.foam, foam_coverage(scenario)
    return None if foam is None or share == 0.0 else BreakingCrests.create(share, scenario.wind.speed_m_s, foam.crests)


def glint_correlation(scenario: Scenario) -> float | WaveGlint:
    """Return the correlation length of glint on the sea [m], or the waves from which its fluctuation follows."""
    glint, cut = scenario.sea.glint, scenario.sea.shortest_wave_m
    # the article's mode has its own cells
    if glint.correlation == "time" or scenario.mean.mode == "article":
        return glint_length(scenario)
    return WaveGlint(waves(scenario).spectrum, cut if scenario.sea.resolve_waves else math.inf)


def glint_length(scenario: Scenario) -> float:
    """Return the length of the cells of glint on the sea from its correlation time [m]."""
    glint = scenario.sea.glint
    if glint.cell_m is not None:
        return glint.cell_m
    match glint.dispersion:
        case "full":
            return correlation_length(glint.correlation_time_s)
        case "article":
            return capillary_length(glint.correlation_time_s)
        case other:
            assert_never(other)


def sparkles(scenario: Scenario) -> Sparkles:
    """Return the sparkles below a pixel; ``auto`` draws none in the mean picture, without resolved waves."""
    mode = scenario.render.subpixel_glint
    # Without resolved waves the picture is the mean over all slopes.
    mode = "off" if mode == "auto" and not scenario.sea.resolve_waves else mode
    correlation = glint_correlation(scenario)
    by_waves = correlation if isinstance(correlation, WaveGlint) else None
    return Sparkles(scenario.seed, glint_length(scenario), scenario.sea.glint.correlation_time_s, mode, by_waves)


def view_at(scenario: Scenario) -> Callable[[float], SeaView]:
    """Return a function of the sensor's height [m] that gives sea, air and Sun from there; parts without height are made once."""
    first = view(scenario)

    def at(height: float) -> SeaView:
        if height == first.sensor_height:
            return first
        match scenario.atmosphere:
            # The program's air is computed for one height, so each height is another run.
            case requested_air.LowtranFortranAtmosphere():
                return view(scenario.model_copy(update={"sensor": scenario.sensor.model_copy(update={"height_m": height})}))
            case requested_air.FileAtmosphere():
                raise ScenarioError(
                    f"platform: the sensor's height changes (sensor.height_m = {first.sensor_height:g}, platform {height:g} m), and "
                    "atmosphere.source = 'file' is made for one height; keep the height, or use another atmosphere"
                )
            case _:
                return replace(first, sensor_height=height)

    return at


def standing_view(scenario: Scenario, height: float) -> SeaView:
    """Return sea, air and Sun for a sensor at rest at a height [m] of its track, as of a scenario without platform."""
    if scenario.platform is None or isinstance(scenario.atmosphere, requested_air.FileAtmosphere):
        return view_at(scenario)(height)
    sensor = scenario.sensor.model_copy(update={"height_m": height})
    return view(scenario.model_copy(update={"sensor": sensor, "platform": None}))


def imager(scenario: Scenario) -> Imager:
    """Return the camera's pixels, without an attitude."""
    sensor = scenario.sensor
    width, height = (float(np.radians(angle)) for angle in sensor.fov_deg)
    return Imager(sensor.projection, width, height, *sensor.pixels)


def keyframe_columns(moving: Platform | Object, allowed: Sequence[str]) -> tuple[dict[str, FloatArray], list[str]]:
    """Return the columns of a track's file or of keyframes by their keys, and the names of the keyframes in messages."""
    if moving.track is not None:
        return read_track(moving.track, allowed)
    keyframes = moving.keyframes or ()
    # All keyframes have the keys of the first, which the records check.
    given = [name for name in type(keyframes[0]).model_fields if getattr(keyframes[0], name) is not None] if keyframes else []
    # Angles and lengths stay in the units of their keys; callers convert them.
    columns = {name: np.array([getattr(keyframe, name) for keyframe in keyframes]) for name in given}
    return columns, [f"keyframes[{i}]" for i in range(len(keyframes))]


def track(scenario: Scenario, waves: WaveField | None = None) -> Track:
    """Return position and attitude of the sensor over the time of the scenario's frames; a platform that floats rides on ``waves``.

    Raises
    ------
    ScenarioError
        Keyframes that overlap, jump, are not finite, leave the atmosphere's heights, or do not reach the last frame.
    """
    sensor, platform = scenario.sensor, scenario.platform
    rest = {"east_m": 0.0, "north_m": 0.0, "height_m": sensor.height_m, "azimuth_deg": sensor.azimuth_deg}
    rest |= {"elevation_deg": sensor.elevation_deg, "roll_deg": sensor.roll_deg}
    if platform is None or (platform.track is None and platform.keyframes is None):
        still = Track.standing(sensor.height_m, Attitude(*(float(np.radians(rest[f"{name}_deg"])) for name in ANGLES)))
        return still if platform is None else afloat(scenario, still, waves, "platform: ")
    columns, names = keyframe_columns(platform, COLUMNS)
    where = "platform: " if platform.track is None else f"{platform.track}: "
    size = len(names)
    filled = {name: columns.get(name, np.full(size, value)) for name, value in ({"time_s": 0.0} | rest).items()}
    values = {name.rsplit("_", 1)[0]: np.radians(v) if name.endswith("_deg") else v for name, v in filled.items()}
    try:
        keyframed = Track.create(values, names)
        # Both ends of the sequence must be inside the keyframes.
        keyframed.at(0.0)
        keyframed.at((sensor.frames - 1) / sensor.frame_rate_hz)
    except DomainError as error:
        mistake = Mistake("platform", error.value, error.allowed, f"{where}{error}")
        raise ScenarioError(mistake.text, mistakes=(mistake,)) from error
    return afloat(scenario, keyframed, waves, where)


def scatters(scenario: Scenario) -> bool:
    """Return True where sunlight scattered by the air is included."""
    return scenario.atmosphere.scattered_sunlight


class Lights(NamedTuple):
    """Sun and Moon over a scene."""

    sun: SunPosition
    moon: Moonlight | None  #: None without a table ``[moon]``.


def lights(scenario: Scenario, step: int = 0) -> Lights:
    """Return Sun and Moon at the first frame, or at the beginning of a later step (``seaglint.scenario.sun.sun_step``)."""
    sun, moon = sun_position(scenario, step), moon_position(scenario, step)
    if moon is None:
        return Lights(sun, None)
    ratio = partial(moon_to_sun, phase=moon.phase, distance_m=moon.distance_m, sun_distance_au=moon.sun_distance_au)
    limb = LOWER_LIMB if moon.bright_limb is None else moon.bright_limb
    return Lights(sun, Moonlight(moon.zenith, moon.azimuth, LightDisc(moon.radius, ratio, moon.phase, limb)))


def view(scenario: Scenario) -> SeaView:
    """Return sea, air, Sun and Moon for the scenario's sensor height."""
    over = band(scenario)
    sun, moon = lights(scenario)
    return SeaView(
        atmosphere=atmosphere(scenario, over),
        band=over,
        water=water(scenario),
        slopes=slopes(scenario),
        sea_temperature=scenario.sea.temperature_k,
        sensor_height=scenario.sensor.height_m,
        solar_zenith=sun.zenith,
        solar_azimuth=sun.azimuth,
        sun_distance_factor=sun.irradiance_factor,
        shadowing=Shadowing.of(scenario.mean.shadowing or "nested"),
        scattering=scatters(scenario),
        foam=None if scenario.sea.foam is None else FoamCover(foam_coverage(scenario)),
        moon=moon,
    )


def under(view: SeaView, lights: Lights) -> SeaView:
    """Return a view with other lights over the same sea and air."""
    sun, moon = lights
    return replace(view, solar_zenith=sun.zenith, solar_azimuth=sun.azimuth, sun_distance_factor=sun.irradiance_factor, moon=moon)


def light_attributes(scenario: Scenario) -> dict[str, float]:
    """Return the directions of Sun and Moon at time 0 [deg], for the provenance; the Moon's phase with it, if there is one."""
    sun, moon = lights(scenario)
    given = {"solar_zenith_deg": sun.zenith, "solar_azimuth_deg": sun.azimuth}
    if moon is not None:
        given |= {"moon_zenith_deg": moon.zenith, "moon_azimuth_deg": moon.azimuth, "moon_phase_deg": moon.disc.phase}
        given |= {"moon_bright_limb_deg": moon.disc.bright_limb, "moon_radius_deg": moon.disc.radius}
    return {name: math.degrees(angle) for name, angle in given.items()}


def article_view(scenario: Scenario, seen: SeaView | None = None) -> SeaView:
    """Return a view, by default the scenario's, in the source article's mode.

    This mode has isotropic slopes at the unchanged wind, one blackbody for sea and sky, and one shadowed leg. The water is the scenario's;
    ``sea.water = "article"`` is the article's. A flat sea remains flat. A scenario in this mode has no Moon and no foam.
    """
    kind = scenario.sea.slopes
    isotropic = (
        flat()
        if isinstance(kind, requested_sea.FlatSlopes)
        else cox_munk_isotropic(
            scenario.wind.speed_m_s, height=WIND_HEIGHT, extrapolate=not isinstance(kind, requested_sea.SpectrumSlopes) and kind.extrapolate
        )
    )
    return replace(seen or view(scenario), slopes=isotropic, shadowing=VIEWER, background="blackbody")


def upright_camera(scenario: Scenario) -> Camera | None:
    """Return the image grid of an upright sensor at rest with equal steps of azimuth and elevation; None for any other sensor."""
    if scenario.platform is not None:
        return None
    pose = track(scenario).at(0.0)
    return imager(scenario).camera(pose.height, pose.attitude)


def gliding_camera(scenario: Scenario) -> Camera | None:
    """Return the image grid of an upright scanner at one height, whose columns may have separate places.

    It is None for a scanner that turns or rises on its platform, or is rolled.

    Raises
    ------
    ScenarioError
        A plane picture: columns of a scanner are equal steps of azimuth.
    """
    if scenario.sensor.projection != "equal-angle":
        raise ScenarioError(
            f"sensor.projection = '{scenario.sensor.projection}': the columns of a scanner (sensor.scan) are equal steps of azimuth; set "
            "sensor.projection = 'equal-angle'"
        )
    return _level_camera(scenario)


def swept_camera(scenario: Scenario) -> Camera | None:
    """Return the image grid of a sensor that is drawn without turning its picture; None for any other.

    Such a sensor is upright with equal steps of angle at one height, at rest or on a platform that neither turns nor rises.
    """
    return _level_camera(scenario) if scenario.sensor.projection == "equal-angle" else None


def _level_camera(scenario: Scenario) -> Camera | None:
    path = track(scenario)
    pose = path.at(float(path.time[0]))
    floats = scenario.platform is not None and scenario.platform.floats
    return None if floats or path.turns or path.highest > path.lowest else imager(scenario).camera(pose.height, pose.attitude)


def camera(scenario: Scenario) -> Camera:
    """Return the image grid of an upright sensor at rest; refuse any other sensor.

    Raises
    ------
    ScenarioError
        For any other sensor.
    """
    upright = upright_camera(scenario)
    if upright is None:
        raise ScenarioError(
            "sensor.projection, sensor.roll_deg or [platform] leave no grid of equal steps of azimuth and elevation, which is wanted here; "
            "leave them out"
        )
    return upright


def accuracy(scenario: Scenario) -> Accuracy:
    """Return the accuracy with which images are drawn."""
    settings = scenario.render
    return Accuracy(
        step=settings.step_m,
        lines_per_column=settings.lines_per_column,
        shortest_wave_columns=settings.shortest_wave_columns,
        variance_error=settings.variance_error,
    )


def sea(scenario: Scenario, statistics: SlopeStatistics) -> PreparedSea:
    """Return the waves that are geometry: as short as requested, with at most the slope variance that the energy rule allows.

    Raises
    ------
    DomainError
        If waves are to be resolved on a mirror, or the tiles cannot hold them.
    """
    resolved = waves(scenario) if scenario.sea.resolve_waves else Waves(None)
    spectral = resolved.spectrum
    if scenario.sea.nonlinear == "second-order":
        _report_no_bound_waves(scenario.sea.resolve_waves, scenario.sea.spectrum.kind)
    facts: JsonObject = {"facet_density": facet_density(statistics), **drawn_sea_facts(scenario)}
    if resolved.sources:
        facts["wave_spectra"] = json.dumps(resolved.sources)  # NetCDF has no lists of tables
    none = {
        "resolved_mss_up": 0.0,
        "resolved_mss_cross": 0.0,
        "facet_mss_up": statistics.mss_up,
        "facet_mss_cross": statistics.mss_cross,
        **facts,
    }
    if spectral is None:
        return PreparedSea(None, {"waves": "none", **none})
    if statistics.is_flat:
        raise DomainError(
            'sea.slopes.kind = "flat" leaves no slopes for waves; set sea.spectrum.kind = "flat" or sea.resolve_waves = false'
        )
    requested = 2.0 * np.pi / scenario.sea.shortest_wave_m
    # The shortest geometric wave: as requested, as the energy rule allows, and as the spectrum has.
    cut = min(requested, resolve_limit(spectral, statistics), spectral.wavenumber_range[1])
    if cut <= longest_wave_number(spectral):
        reason = f"all waves are facets: the longest already carry {100 * RESOLVED_SHARE:g} % of a direction's slope variance"
        return PreparedSea(None, {"waves": reason, **none}, reason)
    nonlinear = scenario.sea.nonlinear == "second-order"
    bound = bound_limit(spectral) if nonlinear else 0.0
    tiles = plan_tiles(spectral, 2.0 * np.pi / cut, scenario.render.tile_size, bound=bound)
    field = WaveField.create(spectral, tiles, scenario.seed, wander=True, bound=bound)
    if nonlinear:
        bound = min(bound, tiles[0].k_max)
        facts |= {
            "bound_waves_up_to_rad_m": bound,
            "height_skewness": bound_skewness(spectral, bound),
            "height_skewness_of_all_bound_waves": bound_skewness(spectral),
        }
    up, cross = field.resolved_mss()
    return PreparedSea(
        field,
        {
            "waves": "geometry down to the cut, facets below it",
            "cut_wavenumber_rad_m": cut,
            "cut_by": "sea.shortest_wave_m" if cut == requested else f"{100 * RESOLVED_SHARE:g} % of the slope variance",
            "tile_length_m": [t.length for t in field.tiles],
            "tile_turn_deg": [float(np.degrees(t.rotation)) for t in field.tiles],
            "tile_shortest_wave_m": [2.0 * np.pi / t.k_max for t in field.tiles],
            "resolved_significant_height_m": field.significant_height,
            "resolved_mss_up": up,
            "resolved_mss_cross": cross,
            "resolved_slope_covariance": field.resolved_covariance(),
            "facet_mss_up": statistics.mss_up - up,
            "facet_mss_cross": statistics.mss_cross - cross,
            **facts,
        },
    )


@lru_cache(maxsize=8)
def _report_no_bound_waves(resolved: bool, kind: str) -> None:
    """Report once that bound waves are requested of a sea without geometry."""
    if not resolved or kind == "flat":
        key, other = ("sea.spectrum.kind = 'flat'", "select waves") if resolved else ("sea.resolve_waves = false", "set it to true")
        log.warning("seaglint: sea.nonlinear = 'second-order' has no effect with %s, which leaves no waves as geometry; %s", key, other)


def breaking_waves(scenario: Scenario, waves: WaveField | None) -> FoamField | None:
    """Return the breaking waves of a sea; None without foam and without resolved waves, where its mean share is everywhere."""
    crests = breaking_crests(scenario)
    if crests is None or waves is None:
        return None
    return FoamField.create(waves, crests, scenario.wind.speed_m_s, waves.spectrum.wind_to_azimuth, scenario.seed)


def require_drawable(scenario: Scenario, statistics: SlopeStatistics) -> None:
    """Refuse to draw a slope model with skewness and peakedness by its variances alone, unless the scenario requests it.

    Raises
    ------
    ScenarioError
        For a model that is not Gaussian.
    """
    kind = scenario.sea.slopes.kind
    if not (statistics.is_gaussian or scenario.render.gaussian_facets):
        raise ScenarioError(
            f"sea.slopes.kind = '{kind}' has skewness and peakedness, which the facets of images do not have (up to twice too little glint "
            "in the far tail); choose 'cox-munk-anisotropic', or set render.gaussian_facets = true to draw its variances alone"
        )


def facet_density(statistics: SlopeStatistics) -> str:
    """Return the slope density from which image facets are drawn, in words: always Gaussian."""
    if statistics.is_gaussian:
        return "Gaussian"
    return "Gaussian of the slope model's variances; its skewness and peakedness are in mean maps only"


def atmosphere_provenance(air: Atmosphere) -> Attributes:
    """Return the provenance that the atmosphere's table holds."""
    return dict(air.provenance)


AIR_AT: Final = 10.0  #: Height at which the temperature of the lowest air is taken [m].


def bends_by_profile(scenario: Scenario) -> bool:
    """Return true where lines of sight are to bend as in the scenario's own air."""
    air = scenario.atmosphere
    return isinstance(air, ComputedAir) and air.refraction == "profile"


def bending(scenario: Scenario, view: SeaView) -> Bending | None:
    """Return the bending of the lines of sight of an upright sensor; None with standard refraction.

    Raises
    ------
    ScenarioError
        Shadows of objects, which are drawn with standard refraction alone.
    """
    if not bends_by_profile(scenario):
        return None
    if scenario.render.object_shadows:
        raise ScenarioError(
            "render.object_shadows = true and atmosphere.refraction = 'profile': shadows on the glint are drawn with standard "
            "refraction alone; leave one of them out"
        )
    assert isinstance(view.atmosphere, ProfileAtmosphere)  # of the two kinds of air above
    profile = view.atmosphere.sums.profile
    # A sensor below 10 m takes the air at its own height.
    lowest = float(np.interp(min(view.sensor_height, AIR_AT), profile.height, profile.temperature))
    return Bending(view.atmosphere.index, view.sensor_height, lowest)


def require_standard_refraction(scenario: Scenario) -> None:
    """Refuse refraction by the profile for cameras that are not upright scans of equal angles at one height.

    Raises
    ------
    ScenarioError
        The scenario requests refraction by the profile.
    """
    if bends_by_profile(scenario):
        raise ScenarioError(
            "atmosphere.refraction = 'profile' is for an upright camera at one height with sensor.projection = 'equal-angle' and "
            "sensor.roll_deg = 0; change the sensor or leave atmosphere.refraction out ('standard')"
        )
