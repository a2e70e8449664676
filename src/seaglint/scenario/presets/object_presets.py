"""Presets of objects with public dimensions, with the source of each number.

A number without a published source is marked *assumed*. Temperatures are assumed throughout: surfaces near that of air and sea, warm where
engines and bodies are. Lengths are [starboard, forward, up]; the origin of what floats is in the plane of its waterline.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

from seaglint.base.free_form import TomlTables


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
    side, reach = 2.0 * beam + bow, math.hypot(0.5 * beam, bow)
    turn = math.degrees(math.atan2(0.5 * beam, bow))
    cuts = []
    for sign in (1.0, -1.0):
        # a box whose side runs from the stem to where the bow begins
        aside, ahead = sign * (0.25 * beam + 0.5 * side * bow / reach), 0.5 * (length - bow) + 0.25 * side * beam / reach
        cut = _box([side, 2.0 * side, 2.0 * depth], [aside, ahead, 0.5 * depth - draught], heading_deg=-sign * turn)
        cuts.append(cut)
    return {"kind": "difference", "parts": [_box([beam, length, depth], [0.0, 0.0, 0.5 * depth - draught]), *cuts]}


def _union(*parts: TomlTables) -> TomlTables:
    return {"kind": "union", "parts": list(parts)}


def _bird(east: float, ahead: float, up: float) -> list[TomlTables]:
    body = {"kind": "ellipsoid", "semi_axes_m": [0.07, 0.3, 0.07], "at_m": [east, ahead, up], "temperature_k": 295.0}
    return [body, _box([1.4, 0.16, 0.02], [east, ahead + 0.05, up + 0.02])]


_AFLOAT: Final[TomlTables] = {"floats": True, "height_m": 0.0}

#: Presets of objects by the name that the key ``preset`` takes.
OBJECTS: Final[dict[str, ObjectPreset]] = {
    "buoy": ObjectPreset(
        "discus buoy of 3 m with a mast",
        (
            "hull diameter 3 m: NDBC, 'Can you describe the moored buoys?' (ndbc.noaa.gov/faq/hull.shtml)",
            "mast top at 4 m, hull 0.9 m thick, half of it under water: assumed",
        ),
        {
            **_AFLOAT,
            "shape": _union(
                {"kind": "cylinder", "radius_m": 1.5, "length_m": 0.9},
                {"kind": "cone", "radius_m": 0.9, "top_radius_m": 0.15, "length_m": 2.4, "at_m": [0.0, 0.0, 1.6]},
                {"kind": "cylinder", "radius_m": 0.1, "length_m": 1.4, "at_m": [0.0, 0.0, 3.3]},
            ),
            "temperature_k": 290.0,
            "emissivity": 0.92,
        },
    ),
    "swimmer": ObjectPreset(
        "head and shoulders of a swimmer",
        (
            "head 0.152 m wide, 0.197 m long, 0.232 m high: means of men, ANSUR 1988 (Gordon et al. 1989)",
            "shoulders just awash, 0.49 m wide (ANSUR: biacromial 0.397, bideltoid 0.492 m); skin at 305 K, emissivity 0.98: assumed",
        ),
        {
            **_AFLOAT,
            "shape": _union(
                {"kind": "ellipsoid", "semi_axes_m": [0.076, 0.0985, 0.116], "at_m": [0.0, 0.0, 0.14]},
                {"kind": "ellipsoid", "semi_axes_m": [0.245, 0.12, 0.12], "at_m": [0.0, 0.0, -0.09], "temperature_k": 298.0},
            ),
            "temperature_k": 305.0,
            "emissivity": 0.98,
        },
    ),
    "small-boat": ObjectPreset(
        "open outboard boat of 17 ft",
        (
            "length 5.18 m, beam 2.08 m, draught 0.23 m: Boston Whaler 170 Montauk (maker's data)",
            "depth of hull 0.9 m, console and outboard: assumed",
        ),
        {
            **_AFLOAT,
            "shape": _union(
                _hull(2.08, 5.18, 0.9, 0.23, 1.6),
                _box([0.8, 0.7, 0.7], [0.0, -0.3, 1.0]),
                _box([0.4, 0.6, 0.9], [0.0, -2.8, 0.75], temperature_k=320.0),
            ),
            "temperature_k": 291.0,
            "emissivity": 0.92,
        },
    ),
    "sailing-yacht": ObjectPreset(
        "sloop of 24 ft with its mainsail up",
        (
            "length 7.32 m, beam 2.71 m, mainsail luff 8.53 m, foot 2.97 m: J/24 class rules and specifications",
            "hull 1.2 m deep and 0.35 m in the water without its keel, sail 3 cm thick, boom 1.2 m up: assumed",
        ),
        {
            **_AFLOAT,
            "shape": _union(
                _hull(2.71, 7.32, 1.2, 0.35, 3.0),
                _box([1.4, 2.4, 0.5], [0.0, 0.4, 1.0]),
                {"kind": "cylinder", "radius_m": 0.06, "length_m": 9.4, "at_m": [0.0, 0.75, 5.4]},
                # full height aft of a wedge is at the mast, so it is turned about
                {"kind": "wedge", "size_m": [0.03, 2.97, 8.53], "at_m": [0.0, -0.76, 6.0], "heading_deg": 180.0, "temperature_k": 288.0},
            ),
            "temperature_k": 291.0,
            "emissivity": 0.93,
        },
    ),
    "container-ship": ObjectPreset(
        "container ship of the old Panama locks",
        (
            "length 294.1 m, beam 32.3 m, draught 12.0 m: Panama Canal Authority, vessel requirements (original locks)",
            "depth of hull 21.5 m, six tiers of containers, bridge 40 m and funnel 45 m up: assumed",
        ),
        {
            **_AFLOAT,
            "shape": _union(
                _hull(32.3, 294.1, 21.5, 12.0, 45.0),
                _box([30.0, 165.0, 13.0], [0.0, 15.0, 15.9], temperature_k=294.0),
                _box([32.0, 14.0, 31.0], [0.0, -85.0, 24.9]),
                _box([10.0, 10.0, 36.0], [0.0, -97.0, 27.4], temperature_k=300.0),
                {"kind": "cylinder", "radius_m": 1.5, "length_m": 6.0, "at_m": [0.0, -97.0, 46.0], "temperature_k": 420.0},
            ),
            "temperature_k": 291.0,
            "emissivity": 0.94,
        },
    ),
    "fishing-vessel": ObjectPreset(
        "crab boat of 125 ft, wheelhouse aft",
        (
            "length 38.1 m, beam 8.81 m, draught 4.4 m: F/V Northwestern (Wikipedia)",
            "depth of hull 6.4 m, wheelhouse, mast and funnel: assumed",
        ),
        {
            **_AFLOAT,
            "shape": _union(
                _hull(8.81, 38.1, 6.4, 4.4, 9.0),
                _box([7.5, 8.0, 6.0], [0.0, -11.0, 4.9]),
                {"kind": "cylinder", "radius_m": 0.2, "length_m": 8.0, "at_m": [0.0, 8.0, 5.9]},
                {"kind": "cylinder", "radius_m": 0.5, "length_m": 2.5, "at_m": [2.0, -13.0, 9.0], "temperature_k": 380.0},
            ),
            "temperature_k": 290.0,
            "emissivity": 0.94,
        },
    ),
    "drone": ObjectPreset(
        "quadrotor of 0.9 m",
        (
            "0.81 m long, 0.67 m wide, 0.43 m high unfolded without propellers: DJI Matrice 300 RTK specifications",
            "body, arms, motors at 310 K: assumed",
        ),
        {
            "shape": _union(
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
            "temperature_k": 298.0,
            "emissivity": 0.9,
        },
    ),
    "light-aircraft": ObjectPreset(
        "high-winged aircraft with one engine",
        (
            "length 8.28 m, span 11.0 m, height 2.72 m, wing area 16.2 m2: Cessna 172S pilot's operating handbook",
            "fuselage, tail, engine cowling at 320 K: assumed",
        ),
        {
            "shape": _union(
                {"kind": "ellipsoid", "semi_axes_m": [0.55, 4.14, 0.65]},
                _box([11.0, 1.47, 0.18], [0.0, 0.7, 0.65]),
                _box([3.4, 0.9, 0.1], [0.0, -3.6, 0.15]),
                _box([0.1, 0.9, 1.5], [0.0, -3.6, 0.75]),
                {"kind": "ellipsoid", "semi_axes_m": [0.5, 0.9, 0.5], "at_m": [0.0, 3.2, 0.0], "temperature_k": 320.0},
            ),
            "temperature_k": 287.0,
            "emissivity": 0.9,
        },
    ),
    "bird-flock": ObjectPreset(
        "seven gulls, wings spread, in a loose wedge",
        (
            "herring gull: length 0.56 to 0.66 m, span 1.37 to 1.46 m (Cornell Lab of Ornithology, All About Birds)",
            "formation, wings 0.16 m wide, plumage at 291 K, body at 295 K: assumed",
        ),
        {
            "shape": _union(
                *(
                    part
                    for place in (
                        (0.0, 0.0, 0.0),
                        (-2.2, -2.1, 0.3),
                        (2.4, -2.0, -0.2),
                        (-4.5, -4.3, 0.1),
                        (4.6, -3.9, 0.5),
                        (-6.6, -6.2, -0.3),
                        (7.0, -6.4, 0.2),
                    )
                    for part in _bird(*place)
                )
            ),
            "temperature_k": 291.0,
            "emissivity": 0.96,
        },
    ),
}
