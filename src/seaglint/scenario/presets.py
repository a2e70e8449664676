"""Presets of objects, scenes and sensors, with the source of each number.

A number without a published source is marked *assumed*, with the reason for it. A number that is cited from a maker's data sheet of which
no copy was available is marked as such.

Temperatures of objects are assumed throughout: surfaces are near the temperature of air and sea, engines and bodies are warm. Lengths are
[starboard, forward, up]; the origin of a floating object lies in the plane of its waterline.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final

from seaglint.base.errors import ScenarioError
from seaglint.base.free_form import TomlTables
from seaglint.base.optional import remedy

TABLES: Final = ("optics", "detector", "scan", "noise")  #: Tables of ``[sensor]`` that a preset replaces as a whole.


@dataclass(frozen=True)
class ObjectPreset:
    """Keys of an object and the sources of their numbers."""

    title: str
    sources: tuple[str, ...]
    values: Mapping[str, Any]


def _box(size: list[float], at: list[float], **more: Any) -> TomlTables:
    return {"kind": "box", "size_m": size, "at_m": at, **more}


def _hull(beam: float, length: float, depth: float, draught: float, bow: float) -> TomlTables:
    """Return a box whose bow is cut to a point, with its waterline at z = 0; ``bow`` is the length of the point [m]."""
    # Each side of the bow runs over half the beam and the length of the point; `turn` is its angle to the keel.
    side, reach = 2.0 * beam + bow, math.hypot(0.5 * beam, bow)
    turn = math.degrees(math.atan2(0.5 * beam, bow))
    cuts = []
    # Starboard and port side of the bow are cut by one box each.
    for sign in (1.0, -1.0):
        # a box whose side runs from the stem to where the bow begins
        aside, ahead = sign * (0.25 * beam + 0.5 * side * bow / reach), 0.5 * (length - bow) + 0.25 * side * beam / reach
        cuts.append(_box([side, 2.0 * side, 2.0 * depth], [aside, ahead, 0.5 * depth - draught], heading_deg=-sign * turn))
    return {"kind": "difference", "parts": [_box([beam, length, depth], [0.0, 0.0, 0.5 * depth - draught]), *cuts]}


def _bird(east: float, ahead: float, up: float) -> list[TomlTables]:
    body = {"kind": "ellipsoid", "semi_axes_m": [0.07, 0.3, 0.07], "at_m": [east, ahead, up], "temperature_k": 295.0}
    return [body, _box([1.4, 0.16, 0.02], [east, ahead + 0.05, up + 0.02])]


def _aloft(surface: TomlTables, *parts: TomlTables) -> TomlTables:
    """Return the values of a union of parts; ``surface`` has the temperature and emissivity of those without their own."""
    return {"shape": {"kind": "union", "parts": list(parts)}, **surface}


def _afloat(surface: TomlTables, *parts: TomlTables) -> TomlTables:
    """Return the values of a union of parts that floats."""
    return {"floats": True, "height_m": 0.0, **_aloft(surface, *parts)}


#: Places of a flock's birds: to starboard, ahead and up [m].
_FLOCK: Final = (
    *((0.0, 0.0, 0.0), (-2.2, -2.1, 0.3), (2.4, -2.0, -0.2), (-4.5, -4.3, 0.1)),
    *((4.6, -3.9, 0.5), (-6.6, -6.2, -0.3), (7.0, -6.4, 0.2)),
)

#: Presets of objects by the name that the key ``preset`` takes.
OBJECTS: Final[dict[str, ObjectPreset]] = {
    "buoy": ObjectPreset(
        "discus buoy of 3 m with a mast",
        (
            "hull diameter 3 m: NDBC, 'Can you describe the moored buoys?' (ndbc.noaa.gov/faq/hull.shtml)",
            "mast top at 4 m, hull 0.9 m thick, half of it under water: assumed",
        ),
        _afloat(
            {"temperature_k": 290.0, "emissivity": 0.92},
            {"kind": "cylinder", "radius_m": 1.5, "length_m": 0.9},
            {"kind": "cone", "radius_m": 0.9, "top_radius_m": 0.15, "length_m": 2.4, "at_m": [0.0, 0.0, 1.6]},
            {"kind": "cylinder", "radius_m": 0.1, "length_m": 1.4, "at_m": [0.0, 0.0, 3.3]},
        ),
    ),
    "swimmer": ObjectPreset(
        "head and shoulders of a swimmer",
        (
            "head 0.152 m wide, 0.197 m long, 0.232 m high: means of men, ANSUR 1988 (Gordon et al. 1989)",
            "shoulders just awash, 0.49 m wide (ANSUR: biacromial 0.397, bideltoid 0.492 m); skin at 305 K, emissivity 0.98: assumed",
        ),
        _afloat(
            {"temperature_k": 305.0, "emissivity": 0.98},
            {"kind": "ellipsoid", "semi_axes_m": [0.076, 0.0985, 0.116], "at_m": [0.0, 0.0, 0.14]},
            {"kind": "ellipsoid", "semi_axes_m": [0.245, 0.12, 0.12], "at_m": [0.0, 0.0, -0.09], "temperature_k": 298.0},
        ),
    ),
    "small-boat": ObjectPreset(
        "open outboard boat of 17 ft",
        (
            "length 5.18 m, beam 2.08 m, draught 0.23 m: Boston Whaler 170 Montauk (maker's data)",
            "depth of hull 0.9 m, console and outboard: assumed",
        ),
        _afloat(
            {"temperature_k": 291.0, "emissivity": 0.92},
            _hull(2.08, 5.18, 0.9, 0.23, 1.6),
            _box([0.8, 0.7, 0.7], [0.0, -0.3, 1.0]),
            _box([0.4, 0.6, 0.9], [0.0, -2.8, 0.75], temperature_k=320.0),
        ),
    ),
    "sailing-yacht": ObjectPreset(
        "sloop of 24 ft with its mainsail up",
        (
            "length 7.32 m, beam 2.71 m, mainsail luff 8.53 m, foot 2.97 m: J/24 class rules and specifications",
            "hull 1.2 m deep and 0.35 m in the water without its keel, sail 3 cm thick, boom 1.2 m up: assumed",
        ),
        _afloat(
            {"temperature_k": 291.0, "emissivity": 0.93},
            _hull(2.71, 7.32, 1.2, 0.35, 3.0),
            _box([1.4, 2.4, 0.5], [0.0, 0.4, 1.0]),
            {"kind": "cylinder", "radius_m": 0.06, "length_m": 9.4, "at_m": [0.0, 0.75, 5.4]},
            # full height aft of a wedge is at the mast, so it is turned about
            {"kind": "wedge", "size_m": [0.03, 2.97, 8.53], "at_m": [0.0, -0.76, 6.0], "heading_deg": 180.0, "temperature_k": 288.0},
        ),
    ),
    "container-ship": ObjectPreset(
        "container ship of the old Panama locks",
        (
            "length 294.1 m, beam 32.3 m, draught 12.0 m: Panama Canal Authority, vessel requirements (original locks)",
            "depth of hull 21.5 m, six tiers of containers, bridge 40 m and funnel 45 m up: assumed",
        ),
        _afloat(
            {"temperature_k": 291.0, "emissivity": 0.94},
            _hull(32.3, 294.1, 21.5, 12.0, 45.0),
            _box([30.0, 165.0, 13.0], [0.0, 15.0, 15.9], temperature_k=294.0),
            _box([32.0, 14.0, 31.0], [0.0, -85.0, 24.9]),
            _box([10.0, 10.0, 36.0], [0.0, -97.0, 27.4], temperature_k=300.0),
            {"kind": "cylinder", "radius_m": 1.5, "length_m": 6.0, "at_m": [0.0, -97.0, 46.0], "temperature_k": 420.0},
        ),
    ),
    "fishing-vessel": ObjectPreset(
        "crab boat of 125 ft, wheelhouse aft",
        (
            "length 38.1 m, beam 8.81 m, draught 4.4 m: F/V Northwestern (Wikipedia)",
            "depth of hull 6.4 m, wheelhouse, mast and funnel: assumed",
        ),
        _afloat(
            {"temperature_k": 290.0, "emissivity": 0.94},
            _hull(8.81, 38.1, 6.4, 4.4, 9.0),
            _box([7.5, 8.0, 6.0], [0.0, -11.0, 4.9]),
            {"kind": "cylinder", "radius_m": 0.2, "length_m": 8.0, "at_m": [0.0, 8.0, 5.9]},
            {"kind": "cylinder", "radius_m": 0.5, "length_m": 2.5, "at_m": [2.0, -13.0, 9.0], "temperature_k": 380.0},
        ),
    ),
    "drone": ObjectPreset(
        "quadrotor of 0.9 m",
        (
            "0.81 m long, 0.67 m wide, 0.43 m high unfolded without propellers: DJI Matrice 300 RTK specifications",
            "body, arms, motors at 310 K: assumed",
        ),
        _aloft(
            {"temperature_k": 298.0, "emissivity": 0.9},
            _box([0.18, 0.42, 0.16], [0.0, 0.0, 0.02]),
            _box([0.05, 0.9, 0.04], [0.0, 0.0, 0.08], heading_deg=39.6),
            _box([0.05, 0.9, 0.04], [0.0, 0.0, 0.08], heading_deg=-39.6),
            *(
                {"kind": "cylinder", "radius_m": 0.035, "length_m": 0.08, "at_m": [x, y, 0.12], "temperature_k": 310.0}
                for x in (-0.28, 0.28)
                for y in (-0.34, 0.34)
            ),
            _box([0.02, 0.4, 0.3], [-0.16, 0.0, -0.1]),
            _box([0.02, 0.4, 0.3], [0.16, 0.0, -0.1]),
            _box([0.34, 0.02, 0.04], [0.0, 0.0, 0.02]),
        ),
    ),
    "light-aircraft": ObjectPreset(
        "high-winged aircraft with one engine",
        (
            "length 8.28 m, span 11.0 m, height 2.72 m, wing area 16.2 m2: Cessna 172S pilot's operating handbook",
            "fuselage, tail, engine cowling at 320 K: assumed",
        ),
        _aloft(
            {"temperature_k": 287.0, "emissivity": 0.9},
            {"kind": "ellipsoid", "semi_axes_m": [0.55, 4.14, 0.65]},
            _box([11.0, 1.47, 0.18], [0.0, 0.7, 0.65]),
            _box([3.4, 0.9, 0.1], [0.0, -3.6, 0.15]),
            _box([0.1, 0.9, 1.5], [0.0, -3.6, 0.75]),
            {"kind": "ellipsoid", "semi_axes_m": [0.5, 0.9, 0.5], "at_m": [0.0, 3.2, 0.0], "temperature_k": 320.0},
        ),
    ),
    "bird-flock": ObjectPreset(
        "seven gulls, wings spread, in a loose wedge",
        (
            "herring gull: length 0.56 to 0.66 m, span 1.37 to 1.46 m (Cornell Lab of Ornithology, All About Birds)",
            "formation, wings 0.16 m wide, plumage at 291 K, body at 295 K: assumed",
        ),
        _aloft({"temperature_k": 291.0, "emissivity": 0.96}, *(part for place in _FLOCK for part in _bird(*place))),
    ),
}


@dataclass(frozen=True)
class Preset:
    """Keys of a scenario that differ from the defaults, with the reasons."""

    title: str
    notes: tuple[str, ...]  #: Sources and remarks, one line each.
    values: TomlTables = field(default_factory=dict)
    files: tuple[str, ...] = ()  #: Files of the package that the scenario names, which are written beside it.


_SWELL: Final = {
    "kind": "jonswap",
    "significant_height_m": 2.0,
    "peak_period_s": 12.0,
    "gamma": 5.0,
    "from_deg": 330.0,
    "spreading_deg": 12.0,
}

#: Presets of scenes by the name that the parameter ``preset`` takes.
PRESETS: Final[dict[str, Preset]] = {
    "glint": Preset(
        "the glint corridor of a low Sun, seen from a ship's mast",
        (
            "Band: 3.5-5 um as in the source article's glint calculations. Air: LOWTRAN7 midlatitude summer, Navy maritime aerosol",
            "(Kneizys et al. 1988). Slopes: Cox and Munk 1954. Waves: Elfouhaily et al. 1997. Sea at 288.15 K as in the source article.",
        ),
    ),
    "calm": Preset(
        "a nearly calm sea and its bright, narrow glint",
        (
            "Sensor at 100 m, wind 0.5 m/s: the article's 'calm', where the brightest point looks as warm as 526 K.",
            "Waves this small stay facet density: the mean picture.",
        ),
        {
            "sensor": {"height_m": 100.0, "elevation_deg": -13.0, "fov_deg": [32.0, 16.0]},
            "wind": {"speed_m_s": 0.5},
            "sea": {"resolve_waves": False, "slopes": {"kind": "cox-munk-isotropic"}},
        },
    ),
    "article-10ms": Preset(
        "10 m/s of wind in the article's own manner, for mean maps",
        (
            "Settings of the headline row '62 K rise at 10 m/s': isotropic Cox-Munk slopes at the wind as given, the article's water,",
            "band means, sky and sea as one blackbody, the viewer's shadowing only. Brightest at a depression of 1.5 to 2.5 deg.",
        ),
        {
            "sun": {"zenith_deg": 77.0, "azimuth_deg": 180.0},
            "sensor": {"height_m": 100.0},
            "wind": {"speed_m_s": 10.0},
            "sea": {"water": "article", "resolve_waves": False, "slopes": {"kind": "cox-munk-isotropic"}},
            "mean": {"mode": "article"},
        },
    ),
    "buoy": Preset(
        "waves measured by a buoy",
        (
            "Directional spectrum of NDBC station 41010 (Canaveral East) of 8 June 2020: NOAA, public domain. The five files beside this",
            "one hold three hours; put a buoy's own in their place (ndbc.noaa.gov, realtime2: .data_spec, .swdir, .swdir2, .swr1, .swr2)",
            f"and set the time to an hour that they hold. Reading them needs wavespectra: {remedy('wavespectra')}.",
        ),
        {"sea": {"spectrum": {"kind": "file", "path": "41010.data_spec", "time": "2020-06-08T03:50:00Z"}}},
        tuple(f"41010.{ending}" for ending in ("data_spec", "swdir", "swdir2", "swr1", "swr2")),
    ),
    "sounding": Preset(
        "air of a sounding",
        (
            "sounding.csv beside this file: a midlatitude summer up to 10 km (Anderson et al. 1986); put your own in its place.",
            "Read are also the lists of the University of Wyoming, IGRA, SHARPpy, bufkit, Vaisala and AVAPS, sondes in NetCDF, and ERA5;",
            "'seaglint atmosphere info sounding.csv' says what is understood.",
        ),
        {"atmosphere": {"source": "lowtran", "sounding": "sounding.csv"}},
        ("sounding.csv",),
    ),
    "swell": Preset(
        "a long swell that crosses the wind sea",
        (
            "Swell of 2 m and 12 s (JONSWAP shape, Hasselmann et al. 1973), narrow, 60 deg off the wind;",
            "the wind sea is Elfouhaily et al. 1997 at the scenario's wind.",
        ),
        {"sea": {"spectrum": {"kind": "systems", "systems": [_SWELL, {"kind": "elfouhaily"}]}}},
    ),
    "asit-2019": Preset(
        "a measured sea: the Air-Sea Interaction Tower, 2019",
        (
            "Saturation of waves of 0.003 to 1378 rad/m at 19 winds of 2.69 to 17.6 m/s, interpolated in the wind, in geometry and facets",
            "(repository unh-cassll/wind-wave-directionality-paper; method of Laxague et al. 2025, doi 10.1109/TGRS.2025.3538460).",
            "The authors state that short waves are underresolved. 'radyo-2008' differs below 2 cm by eight to nineteen times: which sea",
            "is right is not known. 'seaglint evaluate slopes' lists the slope variances by band.",
        ),
        {"sea": {"spectrum": {"kind": "asit-2019"}}},
    ),
    "radyo-2008": Preset(
        "a measured sea: RaDyO, Santa Barbara Channel, 2008",
        (
            "Slope variances in bands of 20 to 1000 rad/m, medians of classes of wind of 1.73 to 9.24 m/s, in geometry and facets; longer",
            "waves are those of Elfouhaily's spectrum (repository unh-cassll/polarimetry-subpixel-variability; Laxague et al. 2025,",
            "doi 10.1109/TGRS.2025.3538460). 'asit-2019' differs below 2 cm by eight to nineteen times: which sea is right is not known.",
            "'seaglint evaluate slopes' lists the slope variances by band.",
        ),
        {"sea": {"spectrum": {"kind": "radyo-2008"}}},
    ),
    "furnace": Preset(
        "everything at one temperature: the picture must be flat",
        ("A closed isothermal cavity looks like a blackbody whatever its walls are: the test scene of every thermal renderer.",),
        {
            "sensor": {"frames": 2, "pixels": [128, 64]},
            "sea": {"temperature_k": 288.15},
            "atmosphere": {"source": "isothermal", "temperature_k": 288.15},
        },
    ),
}


@dataclass(frozen=True)
class SensorPreset:
    """Tables of a scenario that describe a sensor, with the source of each number."""

    title: str
    sensor: Mapping[str, Any]  #: Content of the table ``[sensor]``.
    band: Mapping[str, Any]
    sources: Mapping[str, str]  #: Sources by dotted key below ``[sensor]``, or ``band``.


_A6700 = "FLIR, product page of the A6700 MWIR (flir.com/products/a6700-mwir)"
_A6700_SHEET = "assumed: as the data sheet of the FLIR A6700 is cited, no copy at hand"
_BOSON = "Teledyne FLIR Boson data sheet, document 102-2013-40, release 340 (March 2021)"
_BOSON_SHEET = "assumed: as the lens table of the FLIR Boson is cited, no copy at hand"
_SCORPIO = "Sofradir EC, brochure of cooled infrared cameras (Scorpio LWIR, HgCdTe)"
_SCORPIO_SHEET = "assumed: as the data sheet of the Lynred Scorpio LW is cited, no copy at hand"
_RULE_07 = "Tennant et al., J. Electronic Materials 37, 1406 (2008), Rule 07: 9.3 um cut-off, 80 K, 15 um"
_PANORAMA = "assumed: a turn a second and a column of 640 pixels, as panoramic infrared search sensors are sold"

#: Detector of the cooled arrays of photodiodes, as far as they are alike.
_DIODES: Final = {"pitch_um": 15.0, "fill_factor": 0.9, "quantum_efficiency": 0.9, "bit_depth": 14}

#: Presets of sensors by the name that the parameter ``sensor`` takes.
SENSORS: Final[dict[str, SensorPreset]] = {
    "mwir-insb-640": SensorPreset(
        "cooled InSb camera, 3-5 um, 640 x 512 pixels of 15 um, F/2.5",
        {
            "pixels": [640, 512],
            "frame_rate_hz": 60.0,
            "optics": {"focal_length_m": 0.05, "f_number": 2.5, "transmission": 0.9, "wavefront_error_waves": 0.05},
            "detector": {**_DIODES, "integration_time_s": 0.003, "well_capacity_e": 7.2e6, "read_noise_e": 600.0},
            "noise": {"gain_spread": 0.0002, "offset_spread": 200.0, "dead_share": 0.0005},
        },
        {"min_um": 3.0, "max_um": 5.0},
        {
            "band": f"{_A6700}: 3.0-5.0 um (A6701, A6703)",
            "pixels": f"{_A6700}: 640 x 512",
            "frame_rate_hz": f"{_A6700}: up to 60 Hz at full size",
            "optics.focal_length_m": f"{_A6700_SHEET}: 50 mm lens",
            "optics.f_number": "FLIR, field-of-view calculator, part 29440-200 (A6700): F/2.5",
            "optics.transmission": "assumed: five coated germanium and silicon lenses",
            "optics.wavefront_error_waves": "assumed: close to the diffraction limit (Strehl ratio 0.9)",
            "detector.pitch_um": f"{_A6700}: 15 um",
            "detector.fill_factor": "assumed: InSb arrays of 15 um",
            "detector.integration_time_s": "assumed: NETD is then 18 mK; the product page says 20 mK or less, typically",
            "detector.quantum_efficiency": "Gemini Observatory, GNIRS detector properties: InSb with a coating about 0.9 up to 5 um",
            "detector.well_capacity_e": f"{_A6700_SHEET}: 7.2 million electrons",
            "detector.read_noise_e": "assumed: with it NETD stays below the product page's 20 mK",
            "detector.bit_depth": f"{_A6700_SHEET}: 14 bits",
            "noise.gain_spread": "assumed: residual of a two-point correction of 0.02 %",
            "noise.offset_spread": "assumed: a tenth of the temporal noise",
            "noise.dead_share": f"{_A6700_SHEET}: operability above 99.8 %, 99.95 % typical",
        },
    ),
    "lwir-mct-640": SensorPreset(
        "cooled MCT camera, 7.7-9.3 um, 640 x 512 pixels of 15 um, F/2",
        {
            "pixels": [640, 512],
            "frame_rate_hz": 100.0,
            "optics": {"focal_length_m": 0.05, "f_number": 2.0, "transmission": 0.9, "wavefront_error_waves": 0.05},
            "detector": {
                **_DIODES,
                "integration_time_s": 0.00041,
                "quantum_efficiency": 0.7,
                "well_capacity_e": 1.1e7,
                "read_noise_e": 1000.0,
                "dark_current_e_s": 2.0e7,
            },
            "noise": {"gain_spread": 0.0003, "offset_spread": 500.0, "dead_share": 0.002},
        },
        {"min_um": 7.7, "max_um": 9.3},
        {
            "band": f"{_SCORPIO_SHEET}: 7.7-9.3 um (the brochure says 7.7-9.5 um)",
            "pixels": f"{_SCORPIO}: 640 x 512",
            "frame_rate_hz": "assumed: a camera's rate, with which a frame is far longer than the integration",
            "optics.focal_length_m": "assumed: field of view of 11 deg",
            "optics.f_number": f"{_SCORPIO_SHEET}: F/2",
            "optics.transmission": "assumed: coated germanium lenses",
            "optics.wavefront_error_waves": "assumed: close to the diffraction limit (Strehl ratio 0.9)",
            "detector.pitch_um": f"{_SCORPIO_SHEET}: 15 um",
            "detector.fill_factor": "assumed",
            "detector.integration_time_s": "assumed: NETD is then 22 mK, that of arrays of this kind",
            "detector.quantum_efficiency": f"{_SCORPIO_SHEET}: above 70 %",
            "detector.well_capacity_e": "assumed: the order that NETD of 22 mK at 300 K needs",
            "detector.read_noise_e": "assumed",
            "detector.dark_current_e_s": _RULE_07,
            "detector.bit_depth": "assumed: camera electronics",
            "noise.gain_spread": "assumed: residual of a two-point correction of 0.03 %",
            "noise.offset_spread": "assumed: a quarter of the temporal noise",
            "noise.dead_share": "assumed: operability of 99.8 %",
        },
    ),
    "lwir-microbolometer-640": SensorPreset(
        "uncooled VOx microbolometer, 7.5-13.5 um, 640 x 512 pixels of 12 um, F/1",
        {
            "pixels": [640, 512],
            "frame_rate_hz": 60.0,
            "optics": {"focal_length_m": 0.018, "f_number": 1.0, "wavefront_error_waves": 0.05},
            "detector": {
                "kind": "thermal",
                "pitch_um": 12.0,
                "netd_k": 0.04,
                "netd_f_number": 1.0,
                "time_constant_s": 0.008,
                "bit_depth": 16,
            },
            "scan": {"row_time_s": 3.2e-5},
        },
        {"min_um": 7.5, "max_um": 13.5},
        {
            "band": "FLIR, answer on spectral response (groupgets.com): 7.5-13.5 um, window and bolometer",
            "pixels": f"{_BOSON}: 640 x 512",
            "frame_rate_hz": f"{_BOSON}: 60 Hz",
            "optics.focal_length_m": f"{_BOSON_SHEET}: 18 mm, 24 deg wide",
            "optics.f_number": f"{_BOSON}: NETD is stated at F/1.0",
            "optics.wavefront_error_waves": "assumed",
            "detector.kind": f"{_BOSON}: uncooled VOx microbolometer",
            "detector.pitch_um": "assumed: 12 um, with 18 mm and 640 pixels the 24 deg of the lens",
            "detector.netd_k": f"{_BOSON}: below 40 mK at F/1.0, the lens's transmission in it",
            "detector.netd_f_number": f"{_BOSON}: F/1.0",
            "detector.time_constant_s": "assumed: 8 ms; AT Sensors, basics of microbolometers: 7 to 12 ms",
            "detector.bit_depth": "assumed: 16 bits without gain control",
            "scan.row_time_s": "FLIR ADK (a Boson) user manual, 5.2: about 32 us from line to line",
        },
    ),
    "mwir-panoramic": SensorPreset(
        "rotating MWIR scanner, 3.4-4.9 um, 360 deg by 20 deg once a second",
        {
            "pixels": [11310, 640],
            "frame_rate_hz": 1.0,
            "projection": "equal-angle",
            "optics": {"focal_length_m": 0.027, "f_number": 2.0, "transmission": 0.85, "wavefront_error_waves": 0.05},
            "detector": {**_DIODES, "integration_time_s": 8.8e-5, "well_capacity_e": 1.0e6, "read_noise_e": 150.0},
            "scan": {"kind": "panoramic", "period_s": 1.0},
            "noise": {"gain_spread": 0.0003, "row": 100.0},
        },
        {"min_um": 3.4, "max_um": 4.9},
        {
            "band": "assumed: InSb behind a cold filter for the mid-wave window",
            "pixels": _PANORAMA,
            "frame_rate_hz": _PANORAMA,
            "projection": "a rotating column has equal steps of azimuth",
            "optics.focal_length_m": "assumed: 640 pixels see 20 deg",
            "optics.f_number": "assumed: cold shield of F/2",
            "optics.transmission": "assumed: lenses and window",
            "optics.wavefront_error_waves": "assumed: close to the diffraction limit (Strehl ratio 0.9)",
            "detector.pitch_um": f"{_A6700}: 15 um",
            "detector.fill_factor": "assumed: InSb arrays of 15 um",
            "detector.integration_time_s": "the time in which the scanner moves on by a pixel",
            "detector.quantum_efficiency": "Gemini Observatory, GNIRS detector properties: InSb with a coating about 0.9 up to 5 um",
            "detector.well_capacity_e": "assumed: gain for short exposures",
            "detector.read_noise_e": "assumed: small wells have low read noise",
            "detector.bit_depth": "assumed: 14 bits, as cameras of this kind have",
            "scan.kind": _PANORAMA,
            "scan.period_s": _PANORAMA,
            "noise.gain_spread": "assumed: residual of a two-point correction of 0.03 %",
            "noise.row": "assumed: every row of a scanned picture is one pixel of the column, whose offset makes a stripe",
        },
    ),
}


def with_sensor(raw: Mapping[str, Any], name: str) -> TomlTables:
    """Return a scenario's raw tables with the pixels, rate, band and four tables of its sensor replaced by a preset's.

    Height, direction, projection and all other keys of the scenario are unchanged.

    Raises
    ------
    ScenarioError
        For a name that is no preset.
    """
    try:
        chosen = SENSORS[name]
    except KeyError:
        raise ScenarioError(f"sensor='{name}' is not one of {', '.join(SENSORS)}") from None
    own = raw.get("sensor", {})
    replaced = (*TABLES, "fov_deg", "pixels", "frame_rate_hz")
    remaining = {key: value for key, value in own.items() if key not in replaced} if isinstance(own, Mapping) else {}
    new = {key: dict(value) if isinstance(value, Mapping) else value for key, value in chosen.sensor.items()}
    return {**raw, "sensor": {**remaining, **new}, "band": dict(chosen.band)}
