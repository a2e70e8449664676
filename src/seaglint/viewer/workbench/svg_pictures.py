"""Pictures of the workbench as SVG: pixels with axes and colour bar, and the plan of a scenario from above.

The plan shows the sensor's view, range rings, horizon, objects and their tracks.
"""

from __future__ import annotations

import base64
import io
import math
from collections.abc import Iterator
from dataclasses import dataclass
from html import escape
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

from seaglint.base.brightness import Scale, eight_bit
from seaglint.base.conventions import FloatArray, horizon_range, surface_range
from seaglint.base.representation import rounded
from seaglint.base.schema import VARIABLES
from seaglint.plot.scale import round_ticks, scale_of
from seaglint.scenario.model import Scenario
from seaglint.scenario.sun import SunPosition, sun_position
from seaglint.scenario.text.display import SUN, VIEW
from seaglint.studies.build import scenario_physics
from seaglint.studies.build.bodies import bodies
from seaglint.viewer.workbench.small_pictures import PreviewPicture

Quantity = Literal["radiance", "apparent_temperature"]

# As wide as the picture on a page of usual width, so that its text has the size of the page's text.
_WIDTH, _LEFT, _TOP, _BOTTOM = 480.0, 52.0, 8.0, 40.0
_RIGHT: Final[dict[Quantity, float]] = {"radiance": 112.0, "apparent_temperature": 128.0}
_LOW, _HIGH = 100.0, 320.0  # least and greatest height of the image in the picture


def map_svg(picture: PreviewPicture, quantity: Quantity = "radiance", title: str = "map") -> str:
    """Return the picture with azimuth and elevation [deg] on its axes, or columns and rows of the whole picture, and a colour bar."""
    values = picture.radiance if quantity == "radiance" else picture.temperature
    whole, own = scale_of(picture.radiance), scale_of(picture.radiance, depression=picture.depression)
    # Radiance decides for both pictures whether the sky goes beyond the scale.
    scale = scale_of(values, depression=picture.depression if (own.low, own.high) != (whole.low, whole.high) else None)
    rows, columns = values.shape
    x, y, names = _axes(picture)
    width, height = _image_size(picture, quantity)
    middle, below = _TOP + height / 2, _TOP + height
    pieces = [
        f'<image x="{_LEFT:g}" y="{_TOP:g}" width="{width:.1f}" height="{height:.1f}" preserveAspectRatio="none" '
        f'style="image-rendering:pixelated" href="{_png(scale.share(values), _colours(quantity))}"/>',
        f'<rect x="{_LEFT:g}" y="{_TOP:g}" width="{width:.1f}" height="{height:.1f}" fill="none" stroke="currentColor" '
        'stroke-opacity=".5"/>',
        *_ticks(x, _LEFT, width, below, across=True),
        *_ticks(y, _TOP, height, _LEFT, across=False),
        f'<text x="{_LEFT + width / 2:.1f}" y="{below + 34:.1f}" text-anchor="middle">{names[0]}</text>',
        f'<text x="13" y="{middle:.1f}" text-anchor="middle" transform="rotate(-90 13 {middle:.1f})">{names[1]}</text>',
        *_bar(scale, quantity, _LEFT + width + 12, height),
    ]
    size = f"{_LEFT + width + _RIGHT[quantity]:.0f} {_TOP + height + _BOTTOM:.0f}"
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {size}" width="100%" role="img" '
        f'aria-label="{title}: {VARIABLES[quantity].long_name}" font-family="system-ui, sans-serif" '
        f'font-size="11" fill="currentColor" data-rows="{rows}" data-columns="{columns}">{"".join(pieces)}</svg>'
    )


def _image_size(picture: PreviewPicture, quantity: Quantity) -> tuple[float, float]:
    """Return width and height of the pixels in the picture."""
    x, y, _ = _axes(picture)
    width = _WIDTH - _LEFT - _RIGHT[quantity]
    shape = abs((y[1] - y[0]) / (x[1] - x[0]))
    height = min(max(width * shape, _LOW), _HIGH)
    # High pictures become narrower, so that pixels stay square; extreme shapes are stretched.
    return (height / shape if height == _HIGH and 0.2 < shape < 5.0 else width), height


def value_at(picture: PreviewPicture, quantity: Quantity, across: float, down: float) -> str:
    """Return direction and values of the pixel at a place of ``map_svg``, in shares of its width and height; empty outside the pixels."""
    width, height = _image_size(picture, quantity)
    x = (across * (_LEFT + width + _RIGHT[quantity]) - _LEFT) / width
    y = (down * (_TOP + height + _BOTTOM) - _TOP) / height
    if not (0.0 <= x < 1.0 and 0.0 <= y < 1.0):
        return ""
    rows, columns = picture.radiance.shape
    place = int(y * rows), int(x * columns)
    radiance, kelvin = float(picture.radiance[place]), float(picture.temperature[place])
    ends, sides, _ = _axes(picture)
    # Centres of pixels.
    azimuth = ends[0] + (place[1] + 0.5) / columns * (ends[1] - ends[0])
    elevation = sides[0] + (place[0] + 0.5) / rows * (sides[1] - sides[0])
    if picture.azimuth is None or picture.elevation is None:
        where = f"column {math.floor(azimuth)}, row {math.floor(elevation)}"
    else:
        where = f"azimuth {azimuth % 360.0:.2f}°, elevation {elevation:.2f}°"
    if not math.isfinite(radiance):
        return f"{where}: no value".replace("-", "\u2212")
    warm = f", {kelvin:.2f} K ({kelvin - 273.15:.2f} °C)" if math.isfinite(kelvin) else ""
    return f"{where}: {radiance:.4g} {VARIABLES['radiance'].symbol}{warm}".replace("-", "\u2212")


def _axes(picture: PreviewPicture) -> tuple[tuple[float, float], tuple[float, float], tuple[str, str]]:
    if picture.azimuth is not None and picture.elevation is not None:
        return picture.azimuth, picture.elevation, ("azimuth [deg]", "elevation [deg]")
    columns, rows = picture.pixels
    return (0.0, float(columns)), (0.0, float(rows)), ("column [px]", "row [px]")


def even(low: float, high: float, most: int = 7) -> list[float]:
    """Return round numbers between two others, at most a given number.

    >>> even(172.0, 188.0)
    [172.5, 175.0, 177.5, 180.0, 182.5, 185.0, 187.5]
    """
    low, high = min(low, high), max(low, high)
    if not high > low:
        return [low]
    size = 10.0 ** math.floor(math.log10((high - low) / most))
    # The decade below the exact step, times the first round factor that gives few enough numbers.
    step = next(size * part for part in (1.0, 2.0, 2.5, 5.0, 10.0, 20.0) if (high - low) / (size * part) <= most)
    # 1e-9 of a step keeps ends that are multiples of the step but for rounding.
    return [round(n * step, 10) for n in range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)]


def _ticks(ends: tuple[float, float], begin: float, length: float, edge: float, *, across: bool) -> Iterator[str]:
    for value in even(*ends, most=7 if across else 5):
        at = begin + length * (value - ends[0]) / (ends[1] - ends[0])
        text = f"{value % 360 if across and ends[1] > 360 else value:g}".replace("-", "\u2212")
        if across:
            yield f'<path d="M{at:.1f},{edge:.1f}v5" stroke="currentColor" stroke-opacity=".6"/>'
            yield f'<text x="{at:.1f}" y="{edge + 17:.1f}" text-anchor="middle">{text}</text>'
        else:
            yield f'<path d="M{edge:.1f},{at:.1f}h-5" stroke="currentColor" stroke-opacity=".6"/>'
            yield f'<text x="{edge - 8:.1f}" y="{at:.1f}" text-anchor="end" dominant-baseline="central">{text}</text>'


def _bar(scale: Scale, quantity: Quantity, left: float, height: float) -> Iterator[str]:
    shares = np.linspace(1.0, 0.0, 128)[:, np.newaxis]
    yield (
        f'<image x="{left:.1f}" y="{_TOP:g}" width="12" height="{height:.1f}" preserveAspectRatio="none" '
        f'href="{_png(shares, _colours(quantity))}"/>'
    )
    if scale.logarithmic:
        ticks = round_ticks(scale.share, scale.value)
        shown, labels = scale.share(ticks), [rounded(tick, 9) for tick in ticks]
    else:
        shown = np.linspace(0.0, 1.0, 5)
        labels = alike(scale.value(shown))
    if quantity == "apparent_temperature":
        kelvin = scale.value(np.asarray(shown))
        labels = [f"{label} ({text})" for label, text in zip(labels, alike(kelvin - 273.15), strict=True)]
    for share, label in zip(shown, labels, strict=True):
        y = min(max(_TOP + height * (1.0 - share), _TOP + 5), _TOP + height - 5)
        yield f'<text x="{left + 17:.1f}" y="{y:.1f}" dominant-baseline="central">{label}</text>'
    unit, x, y = VARIABLES[quantity].symbol or VARIABLES[quantity].units, left + _RIGHT[quantity] - 22, _TOP + height / 2
    unit += " (°C)" if quantity == "apparent_temperature" else ""
    unit += ", log" if scale.logarithmic else ""
    yield f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="middle" transform="rotate(-90 {x:.1f} {y:.1f})">{unit}</text>'


def alike(values: FloatArray) -> list[str]:
    """Return numbers of one scale as text, all with as many decimals as two digits of a quarter of its length need.

    >>> alike(np.array([1.35, 7.6812, 14.0])), alike(np.array([281.2, 281.9]))
    (['1.4', '7.7', '14.0'], ['281.20', '281.90'])
    """
    length = float(np.ptp(values))
    decimals = min(max(1 - math.floor(math.log10(length / 4.0)), 0), 9) if length > 0.0 else 1
    return [f"{value:.{decimals}f}".replace("-", "\u2212") for value in values]


def _colours(quantity: Quantity) -> NDArray[np.uint8]:
    from matplotlib import colormaps

    name: Final = "inferno" if quantity == "radiance" else "gray"
    return np.asarray(np.round(255 * colormaps[name](np.linspace(0.0, 1.0, 256))[:, :3]), np.uint8)


def _png(share: NDArray[Any], colours: NDArray[np.uint8]) -> str:
    """Return a data URL of pixels with a brightness from 0 to 1; pixels without a value are green."""
    from PIL import Image

    known = np.isfinite(share)
    pixels = colours[eight_bit(share)]
    pixels[~known] = (40, 140, 90)
    out = io.BytesIO()
    Image.fromarray(pixels).save(out, format="png")
    return "data:image/png;base64," + base64.b64encode(out.getvalue()).decode("ascii")


_TIMES: Final = 41  #: Number of points along a track.

_SIZE, _RADIUS = 320.0, 134.0

_COLOURS: Final = ("#e4572e", "#a06cd5", "#2e9e9e", "#d1495b", "#7a9e3f", "#c77d2a", "#4f7cac", "#b0578d")


@dataclass(frozen=True, eq=False)
class PlanView:
    """Plan of a scenario: positions east and north of the sensor's start [m], and directions [deg]."""

    ways: dict[str, FloatArray]  #: Tracks of the objects by name, over the time of the frames; shape (times, 2).
    own: FloatArray  #: Track of the sensor; shape (times, 2).
    horizon: float  #: Range of the horizon [m].
    nearest: float  #: Range of the nearest sea in view [m]; NaN where no sea is in view.
    azimuth: float  #: Azimuth of the view's centre at the start [deg].
    width: float
    sun: SunPosition


def plan(scenario: Scenario) -> PlanView:
    """Lay out a scenario on a flat sea.

    Raises
    ------
    ScenarioError
        The tracks or the objects are not valid.
    """
    calm = scenario
    if scenario.platform is not None and scenario.platform.floats:  # a floating sensor only rocks about its position
        still = None if scenario.platform.track is None and scenario.platform.keyframes is None else scenario.platform
        calm = scenario.model_copy(update={"platform": still and still.model_copy(update={"floats": False})})
    times = np.linspace(0.0, (scenario.sensor.frames - 1) / scenario.sensor.frame_rate_hz, _TIMES)
    track = scenario_physics.track(calm)
    poses = [track.at(float(time)) for time in times]
    own = np.array([(pose.east, pose.north) for pose in poses])
    ways = {body.name: np.array([body.motion.at(float(time)).position[:2] for time in times]) - own[0] for body in bodies(calm)}
    height, azimuth = poses[0].height, math.degrees(poses[0].attitude.azimuth)
    # Lower edge of the view, below the horizontal.
    steepest = math.radians(-scenario.sensor.elevation_deg + 0.5 * scenario.sensor.fov_deg[1])
    return PlanView(
        ways=ways,
        own=own - own[0],
        horizon=horizon_range(height),
        nearest=float(surface_range(height, min(steepest, 0.5 * math.pi))),
        azimuth=azimuth,
        width=scenario.sensor.fov_deg[0],
        sun=sun_position(scenario),
    )


def reach(view: PlanView, whole: bool) -> float:
    """Return the displayed range [m]: up to the farthest object, or the horizon where ``whole`` or there is no object."""
    # A margin of 12 % around the farthest object; at least 20 m, for objects at the sensor itself.
    far = max((float(np.hypot(way[:, 0], way[:, 1]).max()) for way in view.ways.values()), default=0.0)
    return view.horizon * 1.05 if whole or not view.ways else max(far * 1.12, 20.0)


def rings(far: float) -> list[float]:
    """Return three to six round ranges up to a range [m].

    >>> rings(6500.0)
    [1000.0, 2000.0, 3000.0, 4000.0, 5000.0, 6000.0]
    """
    step = 10.0 ** math.floor(math.log10(far))
    step = next(step * part for part in (0.1, 0.2, 0.5, 1.0, 2.0) if far / (step * part) <= 6.5)
    return [step * (n + 1) for n in range(math.floor(far / step))]


def distance(metres: float) -> str:
    """Return a range as text.

    >>> distance(500.0), distance(14280.0)
    ('500 m', '14.3 km')
    """
    return f"{metres:.3g} m" if metres < 1000.0 else f"{metres / 1000.0:.3g} km"


def plan_svg(view: PlanView, *, whole: bool = False) -> str:
    """Return the plan as SVG, north up, the sensor's start in the middle."""
    far = reach(view, whole)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_SIZE:g} {_SIZE:g}" width="100%" role="img" '
        f'aria-label="plan: north up" font-family="system-ui, sans-serif" font-size="11" fill="currentColor">'
        + "".join(_pieces(view, far))
        + "</svg>"
    )


def _point(east: float, north: float, far: float) -> tuple[float, float]:
    return 0.5 * _SIZE + _RADIUS * east / far, 0.5 * _SIZE - _RADIUS * north / far


def _polar(azimuth: float, radius: float) -> str:
    angle = math.radians(azimuth)
    return f"{0.5 * _SIZE + radius * math.sin(angle):.1f},{0.5 * _SIZE - radius * math.cos(angle):.1f}"


def _pieces(view: PlanView, far: float) -> Iterator[str]:
    middle = 0.5 * _SIZE
    yield _wedge(view, far)
    for ring in rings(far):
        r = _RADIUS * ring / far
        yield f'<circle cx="{middle:g}" cy="{middle:g}" r="{r:.1f}" fill="none" stroke="currentColor" stroke-opacity=".22"/>'
    if view.horizon <= far:
        r = _RADIUS * view.horizon / far
        yield f'<circle class="horizon" cx="{middle:g}" cy="{middle:g}" r="{r:.1f}" fill="none" stroke="{VIEW}" stroke-dasharray="6 4"/>'
        # In the corner, which no circle reaches.
        yield f'<text x="{_SIZE - 3:g}" y="{_SIZE - 5:g}" text-anchor="end">horizon {distance(view.horizon)}</text>'
    for ring in rings(far):
        # Over the horizon's line, on a ground of its own.
        yield (
            f'<text x="{middle + 4:g}" y="{middle - _RADIUS * ring / far - 3:.1f}" fill="var(--faint)" stroke="var(--panel)" '
            f'stroke-width="4" paint-order="stroke">{distance(ring)}</text>'
        )
    for azimuth, name in ((0, "N"), (90, "E"), (180, "S"), (270, "W")):
        x, y = _polar(azimuth, _RADIUS + 13).split(",")
        yield f'<text x="{x}" y="{y}" text-anchor="middle" dominant-baseline="central" font-weight="600">{name}</text>'
    if view.sun.zenith < 0.5 * math.pi:
        x, y = _polar(math.degrees(view.sun.azimuth), _RADIUS).split(",")
        yield f'<circle cx="{x}" cy="{y}" r="6" fill="{SUN}"><title>towards the Sun</title></circle>'
    yield from _line(view.own, "sensor", "currentColor", far)
    used: list[tuple[float, float]] = []
    # Names from the top down, so that names that are moved down keep their order.
    for number, (name, way) in enumerate(sorted(view.ways.items(), key=lambda item: -float(item[1][0, 1]))):
        colour = _COLOURS[number % len(_COLOURS)]
        yield from _line(way, name, colour, far)
        yield _name(_point(float(way[0, 0]), float(way[0, 1]), far), name, colour, used)


def _wedge(view: PlanView, far: float) -> str:
    """Return the sea in view: from the nearest point to the horizon."""
    # A full circle as one arc would begin and end at the same point, and SVG draws nothing.
    half, top = 0.5 * min(view.width, 359.9), _RADIUS * min(view.horizon, far) / far
    bottom = min(_RADIUS * view.nearest / far, top) if math.isfinite(view.nearest) else top
    left, right = view.azimuth - half, view.azimuth + half
    large = int(view.width > 180.0)
    outer = f"L{_polar(left, top)}A{top:.1f},{top:.1f} 0 {large} 1 {_polar(right, top)}"
    inner = f"M{_polar(right, bottom)}A{bottom:.1f},{bottom:.1f} 0 {large} 0 {_polar(left, bottom)}"
    return f'<path class="sea" d="{inner}{outer}Z" fill="{VIEW}" fill-opacity=".2" stroke="{VIEW}" stroke-opacity=".6"/>'


def _line(way: FloatArray, name: str, colour: str, far: float) -> Iterator[str]:
    """Yield the drawing of a track: a dot at its beginning, an arrowhead at its end."""
    points = [_point(float(east), float(north), far) for east, north in way]
    (x, y), (u, v) = points[0], points[-1]
    text = escape(name)
    if math.hypot(u - x, v - y) > 1.0:
        path = "M" + "L".join(f"{a:.1f},{b:.1f}" for a, b in points)
        back = math.atan2(points[-2][1] - v, points[-2][0] - u)
        head = "".join(f"M{u:.1f},{v:.1f}L{u + 6 * math.cos(back + t):.1f},{v + 6 * math.sin(back + t):.1f}" for t in (-0.5, 0.5))
        yield f'<path class="way" d="{path}{head}" fill="none" stroke="{colour}" stroke-width="1.6"><title>{text}</title></path>'
    yield f'<circle class="place" cx="{x:.1f}" cy="{y:.1f}" r="3.5" fill="{colour}"><title>{text}</title></circle>'


def _name(place: tuple[float, float], name: str, colour: str, used: list[tuple[float, float]]) -> str:
    """Return a name beside its position, moved down where another name is, with a line to the position."""
    x, y = place[0] + 26.0, place[1]
    while any(abs(y - other[1]) < 12.0 and abs(x - other[0]) < 90.0 for other in used):
        y += 3.0
    used.append((x, y))
    text = escape(name if len(name) < 24 else f"{name[:22]}…")
    at, anchor = (x - 52.0, ' text-anchor="end"') if x > _SIZE - 100.0 else (x, "")
    leader = f'<path d="M{place[0]:.1f},{place[1]:.1f}L{at:.1f},{y:.1f}" stroke="{colour}" stroke-opacity=".7"/>'
    return f'{leader}<text x="{at:.1f}" y="{y:.1f}" dominant-baseline="central"{anchor}>{text}</text>'
