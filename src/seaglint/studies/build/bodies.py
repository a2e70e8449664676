"""Bodies of a scenario's objects: their shapes, motions and waterlines, built and checked."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import assert_never

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError, DomainError, Mistake, ScenarioError
from seaglint.base.limits import LOWTRAN_HEIGHTS, PROFILE_HEIGHTS
from seaglint.formats.mesh import METRES, read_mesh
from seaglint.formats.tables.input_tables import OBJECT_COLUMNS
from seaglint.imaging.camera.pose import Track
from seaglint.objects import solids as primitives
from seaglint.objects.approach import CLEARANCE, first_contact
from seaglint.objects.body import Body, GasPlume, Placement, PointSource, Solid
from seaglint.objects.floating import Afloat, Steered, Swell
from seaglint.objects.mesh_checks import oriented, require_materials, waterline
from seaglint.objects.motion import Course, Keyframed, Rest, east_north, rotation
from seaglint.objects.solids import Operation, combined, common_volume, placed, plume_in, solid
from seaglint.scenario.model import Scenario
from seaglint.scenario.records import object_tables
from seaglint.scenario.records.object_tables import Object
from seaglint.sea.wave_field import WaveField
from seaglint.studies.build import scenario_physics

MOST_CHECKED = 33  #: Times at which objects are compared with each other.

OVERLAP = 1e-6  #: Share of the smaller of two solids that they may have in common: solids that touch do not overlap.

Part = Solid | GasPlume | PointSource
Parts = list[Part]
# Temperature [K] and emissivity of parts that do not state their own.
Material = tuple[float | None, float]


def bodies(scenario: Scenario, waves: WaveField | None = None) -> tuple[Body, ...]:
    """Return the scenario's objects as bodies.

    Parameters
    ----------
    scenario : Scenario
        With ``objects``, or without any.
    waves : WaveField, optional
        Waves on which floating objects ride; None is a flat sea.

    Returns
    -------
    tuple of Body
        In the scenario's order. Positions are on the axes of the sea, as the sensor's positions are: places that the scenario states from
        the sensor's start are shifted by that start.

    Raises
    ------
    ScenarioError
        Naming the object: a shape that is no closed surface or has no volume, materials out of range, keyframes that are out of order or
        jump, objects under water, in the sensor, in each other or above the air.
    """
    if not scenario.objects:
        return ()
    track = scenario_physics.track(scenario)
    start = track.at(0.0)
    origin = np.array([start.east, start.north])
    last = (scenario.sensor.frames - 1) / scenario.sensor.frame_rate_hz
    # A long sequence is checked at some of its frames only.
    times = np.linspace(0.0, last, min(scenario.sensor.frames, MOST_CHECKED))
    swells: dict[float, Swell] = {}

    def swell(half_sides: FloatArray) -> Swell | None:
        if waves is None:
            return None
        # half sides by their binary logarithm, so that a fleet of boats shares one list of waves
        narrow = 2.0 ** float(np.floor(np.log2(max(float(half_sides.min()), 0.01))))
        if narrow not in swells:
            swells[narrow] = Swell.of(waves, (narrow, narrow))
        return swells[narrow]

    placed = []
    for item in scenario.objects:
        with _naming(item):
            parts = tuple(shape_parts(item))
            base = _motion(scenario, item, parts, origin)
            _require_seen(scenario, parts, base, times)
            placed.append(Body(item.name, parts, _ridden(item, parts, base, swell) if item.floats else base))
    _require_clear(placed, track, last)
    _require_apart(placed, times)
    return tuple(placed)


def unchecked_bodies(scenario: Scenario) -> tuple[Body, ...]:
    """Return the scenario's objects on a flat sea, each where it is, without comparing them with each other and the sensor.

    Raises
    ------
    ScenarioError
        Naming the object whose shape or way cannot be built.
    """
    start, placed = scenario_physics.track(scenario).at(0.0), []
    origin = np.array([start.east, start.north])
    for item in scenario.objects or ():
        with _naming(item):
            parts = tuple(shape_parts(item))
            placed.append(Body(item.name, parts, _motion(scenario, item, parts, origin)))
    return tuple(placed)


@contextmanager
def _naming(item: Object) -> Iterator[None]:
    try:
        yield
    except (DomainError, DataError) as error:
        key = f"objects ('{item.name}')"
        text = f"{key}: {error}"
        raise ScenarioError(text, mistakes=(Mistake(key, getattr(error, "value", None), getattr(error, "allowed", None), text),)) from error


def shape_parts(item: Object) -> Parts:
    """Return the parts of an object, in its own axes.

    Raises
    ------
    DomainError, DataError
        A shape that cannot be built.
    """
    assert item.shape is not None  # the model refuses an object without one
    parts = _built(item.shape, (item.temperature_k, item.emissivity))
    for part in parts:
        if isinstance(part, Solid):
            require_materials(part)
    return parts


def _built(shape: object_tables.Shape, above: Material) -> Parts:
    """Return the parts of a shape in the axes of the object or shape that contains it."""
    if isinstance(shape, object_tables.Point):
        return [PointSource(shape.intensity_w_sr, shape.temperature_difference_k, shape.area_m2, shape.temperature_k)]
    # A part without its own material has the material of the shape or object that contains it.
    own = (above[0] if shape.temperature_k is None else shape.temperature_k, above[1] if shape.emissivity is None else shape.emissivity)
    turn = rotation(*(float(np.radians(angle)) for angle in (shape.heading_deg, shape.pitch_deg, shape.roll_deg)))
    out: Parts = []
    for part in _unplaced(shape, own):
        match part:
            case Solid():
                out.append(placed(part, shape.at_m, turn))
            case GasPlume():
                out.append(plume_in(part, shape.at_m, turn))
            case PointSource():
                raise DomainError("shape: a point has no place among other parts; give it an object of its own")
            case other:
                assert_never(other)
    return out


def _unplaced(shape: object_tables.Shape, material: Material) -> Parts:
    match shape:
        case object_tables.Sphere(radius_m=radius):
            return [_of(primitives.sphere(radius), material)]
        case object_tables.Ellipsoid(semi_axes_m=semi_axes):
            return [_of(primitives.ellipsoid(semi_axes), material)]
        case object_tables.Box(size_m=size):
            return [_of(primitives.box(size), material)]
        case object_tables.Cylinder(radius_m=radius, length_m=length):
            return [_of(primitives.cylinder(radius, length), material)]
        case object_tables.Cone(radius_m=radius, length_m=length, top_radius_m=top):
            return [_of(primitives.cone(radius, length, top), material)]
        case object_tables.Wedge(size_m=size):
            return [_of(primitives.wedge(size), material)]
        case object_tables.MeshFile():
            return [_from_file(shape, material)]
        case object_tables.Plume(semi_axes_m=semi_axes):
            # a plume of gases does not inherit the emissivity of the object that contains it
            emissivity = None if shape.gases else material[1]
            return [
                GasPlume((0.0, 0.0, 0.0), semi_axes, _temperature(material), emissivity, shape.co2_share or 0.0, shape.h2o_share or 0.0)
            ]
        case object_tables.Union(parts=parts):
            return _together(parts, material)
        case object_tables.Intersection(parts=parts):
            return [_combined("intersection", parts, material)]
        case object_tables.Difference(parts=parts):
            return [_combined("difference", parts, material)]
        case object_tables.Point():
            return _built(shape, material)
        case other:
            assert_never(other)


def _together(parts: tuple[object_tables.Shape, ...], material: Material) -> Parts:
    built = [part for shape in parts for part in _built(shape, material)]
    solids = [part for part in built if isinstance(part, Solid)]
    rest = [part for part in built if not isinstance(part, Solid)]
    if any(isinstance(part, PointSource) for part in rest):
        raise DomainError("shape: a point has no place among other parts; give it an object of its own")
    whole: Parts = [combined("union", solids)] if solids or not rest else []
    return whole + rest


def _combined(operation: Operation, parts: tuple[object_tables.Shape, ...], material: Material) -> Solid:
    built = [part for shape in parts for part in _built(shape, material)]
    solids = [part for part in built if isinstance(part, Solid)]
    if len(solids) < len(built):
        raise DomainError(f"shape: plumes and points cannot be parts of a {operation}; put them into a union, or an object of their own")
    return combined(operation, solids)


def _of(mesh: primitives.Mesh, material: Material) -> Solid:
    return solid(mesh, _temperature(material), material[1])


def _temperature(material: Material) -> float:
    if material[0] is None:
        raise DomainError("temperature_k is missing; give the object one, or each of its parts")
    return material[0]


def _from_file(shape: object_tables.MeshFile, material: Material) -> Solid:
    try:
        data = read_mesh(shape.path, metres=METRES[shape.units] * shape.scale, up=shape.up)
    except DataError as error:
        raise DataError(f"shape.path: {error}") from error
    # keys of the scenario replace the file's values
    temperature = data.temperature if data.temperature is not None and shape.temperature_k is None else _temperature(material)
    emissivity = data.emissivity if data.emissivity is not None and shape.emissivity is None else material[1]
    try:
        return solid(oriented(data.mesh), temperature, emissivity)
    except DomainError as error:
        raise DomainError(f"shape.path = '{shape.path}': {error}") from error


def _motion(scenario: Scenario, item: Object, parts: Sequence[Part], origin: FloatArray) -> Steered:
    """Return the motion of an object on a flat sea."""
    trim = tuple(float(np.radians(angle)) for angle in (item.pitch_deg, item.roll_deg))
    if item.track is not None or item.keyframes is not None:
        return _keyframed(scenario, item, parts, origin)
    course = item.course_deg
    heading = float(np.radians(item.heading_deg if item.heading_deg is not None else course if course is not None else 0.0))
    start = Placement(np.array([*(origin + _place(scenario, item)), _height(item, parts)]), rotation(heading, *trim))
    if course is None or item.speed_m_s is None:
        return Rest(start)
    towards = float(np.radians(course))
    return Course(start, item.speed_m_s * np.array([np.sin(towards), np.cos(towards), 0.0]))


def _keyframed(scenario: Scenario, item: Object, parts: Sequence[Part], origin: FloatArray) -> Keyframed:
    columns, names = scenario_physics.keyframe_columns(item, OBJECT_COLUMNS)
    where = "" if item.track is None else f"track = '{item.track}': "
    size = len(names)
    if "latitude_deg" in columns or "longitude_deg" in columns:
        ways = [name for name in ("latitude_deg", "longitude_deg") if name not in columns]
        if ways or "east_m" in columns or "north_m" in columns:
            raise DomainError(f"{where}give latitude_deg and longitude_deg in all keyframes, or east_m and north_m")
        start = _start(scenario)
        degrees = np.radians(np.column_stack([columns["latitude_deg"], columns["longitude_deg"]]))
        place = np.array([east_north(float(a), float(b), start) for a, b in degrees]).reshape(size, 2)
    else:
        rest = _place(scenario, item)
        place = np.stack([columns.get("east_m", np.full(size, rest[0])), columns.get("north_m", np.full(size, rest[1]))], axis=1)
    height = columns["height_m"] if "height_m" in columns else np.full(size, _height(item, parts))
    rest_angles = {"heading_deg": item.heading_deg or 0.0, "pitch_deg": item.pitch_deg, "roll_deg": item.roll_deg}
    angles = np.radians(np.stack([columns.get(name, np.full(size, value)) for name, value in rest_angles.items()], axis=1))
    # Without any heading the forward end points along the motion.
    follows = "heading_deg" not in columns and item.heading_deg is None
    try:
        motion = Keyframed.create(
            np.asarray(columns["time_s"]), np.column_stack([place + origin, height]), angles, names, follows=follows, path=item.path
        )
        # Both ends of the sequence must be inside the keyframes.
        motion.at(0.0)
        motion.at((scenario.sensor.frames - 1) / scenario.sensor.frame_rate_hz)
    except DomainError as error:
        raise DomainError(f"{where}{error}", name=error.name, value=error.value, allowed=error.allowed) from error
    return motion


def _start(scenario: Scenario) -> tuple[float, float]:
    if scenario.place is None:
        raise DomainError("latitude_deg and longitude_deg need [place] and [time]; give them, or east_m and north_m")
    return float(np.radians(scenario.place.latitude_deg)), float(np.radians(scenario.place.longitude_deg))


def _place(scenario: Scenario, item: Object) -> FloatArray:
    """Return the place of an object east and north of the sensor's start [m]."""
    if item.latitude_deg is not None and item.longitude_deg is not None:
        latitude, longitude = float(np.radians(item.latitude_deg)), float(np.radians(item.longitude_deg))
        return np.array(east_north(latitude, longitude, _start(scenario)))
    return np.array([item.east_m or 0.0, item.north_m or 0.0])


def _height(item: Object, parts: Sequence[Part]) -> float:
    """Return the height of an object's origin [m]."""
    if item.height_m is not None:
        return item.height_m
    if item.draught_m is None:
        if item.floats:
            return 0.0
        raise DomainError("height_m is missing; give the height of its centre, or draught_m, or floats = true")
    corners = _corners(parts)
    if not len(corners):
        raise DomainError(f"draught_m = {item.draught_m:g} of what has no surface; give height_m")
    turn = rotation(0.0, *(float(np.radians(angle)) for angle in (item.pitch_deg, item.roll_deg)))
    return -item.draught_m - float((corners @ turn.T)[:, 2].min())


def _corners(parts: Sequence[Part]) -> FloatArray:
    """Return the vertices of the solids and of boxes around the plumes [m, (corners, 3)]."""
    corners = [part.vertices for part in parts if isinstance(part, Solid)]
    # The eight corners of the box around an ellipsoid.
    signs = np.stack(np.meshgrid((-1.0, 1.0), (-1.0, 1.0), (-1.0, 1.0)), axis=-1).reshape(-1, 3)
    corners += [np.asarray(part.centre) + signs * np.asarray(part.semi_axes) for part in parts if isinstance(part, GasPlume)]
    return np.concatenate(corners) if corners else np.zeros((0, 3))


def _ridden(item: Object, parts: Sequence[Part], base: Steered, swell: Callable[[FloatArray], Swell | None]) -> Steered:
    """Return a motion on the waves, over the waterline of the largest solid that the water cuts."""
    first = base.at(0.0)
    trim = rotation(0.0, *(float(np.radians(angle)) for angle in (item.pitch_deg, item.roll_deg)))
    cuts = [waterline(placed(part, np.zeros(3), trim), -float(first.position[2])) for part in parts if isinstance(part, Solid)]
    waterlines = [cut for cut in cuts if cut is not None]
    if not waterlines and any(isinstance(part, Solid) for part in parts):
        raise DomainError(
            f"floats, but the water does not cut it: its centre is {first.position[2]:g} m above the mean sea; correct height_m, or give "
            "draught_m instead"
        )
    centre, half = max(waterlines, key=lambda cut: float(np.prod(cut[1]))) if waterlines else (np.zeros(2), np.zeros(2))
    waves = swell(half)
    return base if waves is None else Afloat(base, waves, centre, half)


def _require_seen(scenario: Scenario, parts: Sequence[Part], base: Steered, times: FloatArray) -> None:
    """Refuse objects that are wholly under the sea or reach above the air."""
    corners = _corners(parts)
    if not len(corners):
        corners = np.zeros((1, 3))
    tops = {"table": PROFILE_HEIGHTS[1], "lowtran": PROFILE_HEIGHTS[1], "lowtran-fortran": LOWTRAN_HEIGHTS[1]}
    limit = tops.get(scenario.atmosphere.source, np.inf)
    for time in times:
        at = base.at(float(time))
        heights = corners @ at.rotation[2] + at.position[2]
        if heights.max() <= 0.0:
            raise DomainError(
                f"height_m: at {time:g} s it is under water, its highest point {-heights.max():.3g} m deep; give a greater height_m "
                "or, for keyframes, path = 'straight'"
            )
        if heights.max() > limit:
            raise DomainError(
                f"height_m: at {time:g} s it reaches {heights.max():.6g} m, above the air of atmosphere.source = "
                f"'{scenario.atmosphere.source}'; allowed: up to {limit:g} m"
            )


def _require_clear(placed: list[Body], track: Track, last: float) -> None:
    """Refuse objects that the sensor enters at any time; a floating sensor is taken along its keyframes on a flat sea."""

    def eye(time: float) -> FloatArray:
        pose = track.at(time)
        return np.array([pose.east, pose.north, pose.height])

    for body in placed:
        if (contact := first_contact(body, eye, track.time, last)) is not None:
            text = (
                f"at {contact.time:.6g} s the sensor is inside it, {contact.distance:.3g} m from its origin; move one of them by east_m, "
                "north_m or height_m"
            )
            if any(isinstance(part, PointSource) for part in body.parts):
                text = (
                    f"at {contact.time:.6g} s the sensor is {contact.distance:.3g} m from it, and a point needs {CLEARANCE:g} m; move one "
                    "of them by east_m, north_m or height_m"
                )
            raise _refused(body.name, text)


def _require_apart(placed: list[Body], times: FloatArray) -> None:
    """Refuse objects that overlap."""
    # A ball around each body is a cheap first test before solids are intersected.
    reach = [float(np.linalg.norm(_corners(body.parts), axis=1).max(initial=0.0)) for body in placed]
    for time in times:
        now = [body.motion.at(float(time)) for body in placed]
        for i, one in enumerate(placed):
            for j in range(i):
                near = np.linalg.norm(now[i].position - now[j].position) < reach[i] + reach[j]
                if near and _overlap(one, now[i], placed[j], now[j]):
                    text = (
                        f"at {time:g} s it overlaps '{placed[j].name}'; move one of them by east_m, north_m or height_m, "
                        "or make them parts of one union"
                    )
                    raise _refused(one.name, text)


def _refused(name: str, text: str) -> ScenarioError:
    key = f"objects ('{name}')"
    return ScenarioError(f"{key}: {text}", mistakes=(Mistake(key, None, None, f"{key}: {text}"),))


def _overlap(one: Body, at: Placement, other: Body, there: Placement) -> bool:
    for part in (p for p in one.parts if isinstance(p, Solid)):
        first = placed(part, at.position - there.position, at.rotation)
        for other_part in (p for p in other.parts if isinstance(p, Solid)):
            second = placed(other_part, np.zeros(3), there.rotation)
            # Boxes that do not meet cannot hold solids that do.
            low = np.maximum(first.vertices.min(axis=0), second.vertices.min(axis=0))
            high = np.minimum(first.vertices.max(axis=0), second.vertices.max(axis=0))
            if np.all(low < high):
                smaller = min(primitives.volume((p.vertices, p.triangles)) for p in (first, second))
                if common_volume(first, second) > OVERLAP * smaller:
                    return True
    return False
