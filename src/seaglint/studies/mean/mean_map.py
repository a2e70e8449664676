"""Maps of mean radiance and apparent temperature of a scenario.

Pixels on a grid of azimuth and elevation are computed by rows and columns. Other pixels are averaged over lines of sight through each
pixel, weighted by solid angle.
"""

from __future__ import annotations

import json
import logging
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Final, assert_never

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray, Progress, horizon_depression
from seaglint.base.kernel_plan import compile_ahead
from seaglint.base.threads import single_threaded_algebra
from seaglint.facet.sea_view import SeaView
from seaglint.imaging.camera.imager import Attitude, Camera, Imager
from seaglint.imaging.camera.pose import Pose, pixel_directions, pose_at
from seaglint.imaging.refraction import air_beyond
from seaglint.optics.band import apparent_temperature
from seaglint.radiance.article import article_radiance
from seaglint.radiance.lit_variance import WaveGlint
from seaglint.radiance.mean_radiance import NODES, MeanModel, SeaRadiance, mean_radiance
from seaglint.radiance.variance import sea_variance
from seaglint.scenario.model import Scenario
from seaglint.scenario.records.sea_tables import MeasuredWaves, SpectrumFile, SpectrumSlopes, WavenumberFile
from seaglint.store.provenance import band_attributes, provenance
from seaglint.studies.build import scenario_physics
from seaglint.studies.build.measured_waves import digest
from seaglint.studies.build.scenario_physics import bending, require_standard_refraction
from seaglint.studies.build.waves_and_slopes import drawn_sea_facts, slopes
from seaglint.studies.mean.air_contrast import air_line
from seaglint.studies.sea_draws import COUNT, SeaUnknown, part_of, sea_line
from seaglint.studies.sea_draws import sea_draws as drawn_seas
from seaglint.studies.sequence.memory import require_mean_memory

if TYPE_CHECKING:
    import xarray as xr


#: Mapped components, beside the sum of the radiances and its temperature.
MAPS: Final = ("path_radiance", "emitted_radiance", "sky_radiance", "glint_radiance", "glint_std")

UNKNOWN: Final = ("radiance", "apparent_temperature", "glint_std")  #: Variables with an interval over drawn seas.

#: Height of a pixel, or of a part of it, over its distance from the horizon, from which it is sampled more finely: below it the middle is
#: within 1e-4 of the mean.
ROW_SHARE: Final = 0.02

ROW_POINTS: Final = 8  #: Elevations averaged in such a pixel, and azimuths where columns are not upright and ``SIDE`` do not serve.

CUT_POINTS: Final = 64  #: Elevations averaged in a whole row that the horizon cuts: the share of it that is sea is within 1/128.

#: Points along each side of a pixel that the horizon cuts: glint of a low Sun may end there, and 8 are up to 3 % off.
EDGE_POINTS: Final = 24

SIDE: Final = 3  #: Lines of sight along each side of any other pixel that is not small, as many as the cells of a turned image.

#: Root of the solid angle of a pixel below which its middle serves [rad]: glint varies over degrees, the middle is within 1e-4.
SMALL: Final = 2e-3

PIXEL_BLOCK: Final = 1 << 17  #: Lines of sight at a time: memory stays below 100 MB.

#: Four components of the radiance [W m-2 sr-1] and the variance of glint [(5, n)], of elevations and azimuths [rad] and the solid angle of
#: the pixels that they belong to [sr, (n,)].
Sights = Callable[[FloatArray, FloatArray, FloatArray], FloatArray]


def over_pixels(imager: Imager, pose: Pose, components_along: Sights, progress: Progress | None = None) -> dict[str, FloatArray]:
    """Return means over the pixels of a camera [W m-2 sr-1, (rows, columns)], by the names of ``MAPS``.

    Cells of the sea are independent, so a pixel's variance is the mean of its lines of sight, each with the solid angle of the pixel.
    """
    rows, columns = imager.rows, imager.columns
    out = np.empty((len(MAPS), rows * columns))
    dip, attitude = horizon_depression(pose.height), pose.attitude
    size, report = PIXEL_BLOCK // 4, progress or (lambda done, total: None)
    for first in range(0, rows * columns, size):
        report(first, rows * columns)
        pixels = np.arange(first, min(first + size, rows * columns))
        # Four points per pixel estimate its height and its distance from the horizon.
        quarters = _points(pixels, columns, 2)
        elevation = np.arctan2(*_rise_and_run(imager.directions(attitude, *quarters)))
        # Points at a quarter and three quarters span half of the pixel, hence the factor 2.
        middle, spread = elevation.mean(axis=1), 2.0 * np.ptp(elevation, axis=1)
        below = np.abs(middle + dip)
        sides = np.where(imager.solid_angle(attitude, *quarters).mean(axis=1) < SMALL**2, 1, SIDE)
        # Later lines refine pixels nearer to the horizon, so their order matters.
        sides[spread > ROW_SHARE * below] = SIDE
        sides[spread > SIDE * ROW_SHARE * below] = ROW_POINTS
        sides[0.5 * spread > below] = EDGE_POINTS
        for side in (1, SIDE, ROW_POINTS, EDGE_POINTS):
            chosen, most = pixels[sides == side], PIXEL_BLOCK // side**2
            for block in (chosen[i : i + most] for i in range(0, chosen.size, most)):
                out[:, block] = _means(imager, attitude, _points(block, columns, side), components_along)
    report(rows * columns, rows * columns)
    # Variances are averaged; the standard deviation comes last.
    out[-1] = np.sqrt(out[-1])
    return {name: values.reshape(rows, columns) for name, values in zip(MAPS, out, strict=True)}


def _points(pixels: np.ndarray, columns: int, side: int) -> tuple[FloatArray, FloatArray]:
    """Return image points across and down [pixels, (n, side squared)] of pixels counted row by row."""
    row, column = np.divmod(pixels, columns)
    down, across = np.divmod(np.arange(side * side), side)
    return column[:, None] + (across + 0.5) / side, row[:, None] + (down + 0.5) / side


def _rise_and_run(sight: FloatArray) -> tuple[FloatArray, FloatArray]:
    return sight[..., 2], np.hypot(sight[..., 0], sight[..., 1])


def _means(imager: Imager, attitude: Attitude, points: tuple[FloatArray, FloatArray], components_along: Sights) -> FloatArray:
    """Return means over the points of each pixel, weighted by the solid angle of each point [(5, pixels)]."""
    sight, weight = imager.directions(attitude, *points), imager.solid_angle(attitude, *points)
    pixel = weight.mean(axis=1)
    elevation, azimuth = np.arctan2(*_rise_and_run(sight)), np.arctan2(sight[..., 0], sight[..., 1])
    of_pixel = np.repeat(pixel, weight.shape[1])
    values = components_along(elevation.ravel(), azimuth.ravel(), of_pixel).reshape(-1, *weight.shape)
    return np.asarray((values * weight).mean(axis=2) / pixel)


_log = logging.getLogger(__name__)

#: Widest part of a column whose middle serves without a Sun [rad]: emission and sky change with the azimuth as its second harmonic.
_WIDEST: Final = math.radians(5.0)


BLOCK: Final = 1 << 20  #: Lines of sight that are computed at a time where a picture has many rows: progress is reported between blocks.


@single_threaded_algebra()
def mean(scenario: Scenario, progress: Progress | None = None, *, sea_draws: int | None = None) -> xr.Dataset:
    """Compute the mean radiance over the field of view as a labelled dataset; ``progress`` is called with (pieces done, all).

    Dimensions ``y, x`` are the image's rows from the top and its columns; ``elevation`` and ``azimuth`` (clockwise) belong to rows and
    columns if the image is a grid of them, else to every pixel (y, x). A moving sensor is at its place of time 0. Variables are
    ``radiance``, ``apparent_temperature``, the four components of the radiance and ``glint_std``, the standard deviation of glint in a
    pixel. In the mode ``article`` the emitted radiance is the radiance of one blackbody for sea and mirrored sky, and the sky's part is 0
    below the horizon. With ``[sea.foam]`` water and foam are mixed by the mean share, the attribute ``foam_share``; sunlight that foam
    reflects diffusely counts in ``glint_radiance``, and not in ``glint_std``. The mode ``article`` has no foam.

    With ``sea_draws``, variables ``..._sea_low`` and ``..._sea_high`` of ``UNKNOWN`` are the values that 5 % and 95 % of so many seas
    between the campaigns are below, pixel by pixel; the others remain those of the scenario.

    Raises
    ------
    SeaglintError
        A condition outside the models.

    Examples
    --------
    >>> from seaglint.scenario.load import parse_scenario
    >>> small = parse_scenario({"sensor": {"pixels": [8, 4]}})
    >>> dict(mean(small).radiance.sizes)
    {'y': 4, 'x': 8}
    """
    import xarray as xr

    seas = [] if sea_draws is None else drawn_seas(scenario, sea_draws)
    # The memory is checked before anything is compiled or computed.
    require_mean_memory(scenario, seas=len(seas))
    compile_ahead("mean")
    track, imager = scenario_physics.track(scenario), scenario_physics.imager(scenario)
    pose = track.at(0.0)
    view = scenario_physics.standing_view(scenario, pose.height)
    if scenario.mean.mode == "article":
        view = scenario_physics.article_view(scenario, view)
    camera, length = imager.camera(pose.height, pose.attitude), scenario_physics.glint_correlation(scenario)
    if camera is not None:
        azimuth, elevation = camera.azimuths, camera.elevations
    else:
        require_standard_refraction(scenario)
        azimuth, elevation = imager.centres(pose.attitude)

    def images(seen: SeaView, correlation: float | WaveGlint, progress: Progress | None) -> dict[str, FloatArray]:
        if camera is not None:
            maps = _of_rows(scenario, camera, seen, correlation, progress)
        else:
            maps = over_pixels(imager, pose, components_along(scenario, seen, correlation), progress)
        # The components are disjoint: their sum is the radiance at the sensor.
        total = maps["path_radiance"] + maps["emitted_radiance"] + maps["sky_radiance"] + maps["glint_radiance"]
        return {"radiance": total, "apparent_temperature": apparent_temperature(total, seen.band, seen.atmosphere.wavenumber_cm)} | maps

    values = images(view, length, part_of(progress, 0, 1 + len(seas)))
    if seas:
        # Air, sky and light are the scenario's: a sea has other waves alone, from which slopes and sparkle follow.
        drawn = {name: np.empty((len(seas), *values[name].shape), dtype=np.float32) for name in UNKNOWN}
        for number, sea in enumerate(seas):
            of_sea = images(
                replace(view, slopes=slopes(sea)), scenario_physics.glint_correlation(sea), part_of(progress, 1 + number, 1 + len(seas))
            )
            for name, stack in drawn.items():
                stack[number] = of_sea[name]
        values |= _sea_intervals(drawn)
    return xr.Dataset(
        {name: (("y", "x"), np.asarray(image, dtype=np.float32)) for name, image in values.items()},
        coords={**pixel_directions(azimuth, elevation), **pose_at(track, 0.0)},
        attrs=provenance(
            "Mean infrared radiance of the sea",
            scenario.model_dump_json(exclude_none=True),
            scenario.seed,
            mean_mode=scenario.mean.mode,
            mean_shadowing=view.shadowing.word,
            **_correlation(length),
            mss_up=view.slopes.mss_up,
            mss_cross=view.slopes.mss_cross,
            **scenario_physics.light_attributes(scenario),
            atmosphere_table=json.dumps(scenario_physics.atmosphere_provenance(view.atmosphere)),
            **drawn_sea_facts(scenario),
            **({} if sea_draws is None else {COUNT: sea_draws}),
            **_foam(view),
            **_wave_file(scenario),
            **_air_note(scenario),
            **band_attributes(view.band),
        ),
    )


def _sea_intervals(drawn: dict[str, NDArray[np.float32]]) -> dict[str, FloatArray]:
    """Return the ends of the intervals over drawn seas, by the names of their variables; row by row, as quantiles take copies."""
    ends: dict[str, FloatArray] = {}
    for name, stack in drawn.items():
        rows = [SeaUnknown.of(stack[:, row]) for row in range(stack.shape[1])]
        ends[f"{name}_sea_low"] = np.array([row.low for row in rows])
        ends[f"{name}_sea_high"] = np.array([row.high for row in rows])
    return ends


def brightest_lines(dataset: xr.Dataset) -> list[str]:
    """Return the interval 'sea unknown' of the pixel with the most glint in plain words; empty without drawn seas."""
    if COUNT not in dataset.attrs:
        return []
    glint = dataset.glint_radiance.to_numpy()
    y, x = np.unravel_index(int(np.argmax(glint)), glint.shape)
    lines = []
    for name, what, unit in (
        ("radiance", "radiance", "W m-2 sr-1"),
        ("apparent_temperature", "apparent temperature", "K"),
        ("glint_std", "standard deviation of glint", "W m-2 sr-1"),
    ):
        value, low, high = (float(dataset[each][y, x]) for each in (name, f"{name}_sea_low", f"{name}_sea_high"))
        lines.append(
            f"brightest glint, {what}: {value:.4g} {unit}; {sea_line(low, high, int(dataset.attrs[COUNT]), unit=unit, value=value)}"
        )
    return lines


def _air_note(scenario: Scenario) -> dict[str, str]:
    """Return the attribute on the share of a contrast that the air transmits, if the scenario does not state air and water."""
    line = air_line(scenario)
    return {} if line is None else {"air_note": line}


def _foam(view: SeaView) -> dict[str, float]:
    """Return the attribute on the mean share of foam, for a sea with foam; the article's blackbody has none."""
    return {} if view.foam is None or view.background == "blackbody" else {"foam_share": view.foam.share}


def _wave_file(scenario: Scenario) -> dict[str, str | int]:
    """Return attributes on the file of waves or the measured sea, and whether slopes follow it; report slopes that do not."""
    spectrum = scenario.sea.spectrum
    if not isinstance(spectrum, SpectrumFile | MeasuredWaves):
        return {}
    used = isinstance(scenario.sea.slopes, SpectrumSlopes)
    path = spectrum.path if isinstance(spectrum, SpectrumFile | WavenumberFile) else None
    if not used:
        name = spectrum.kind if path is None else path
        _log.warning("slopes follow the wind, not the waves of %s (sea.slopes.kind = 'spectrum' follows the waves)", name)
    # The digest identifies the waves where the file moves or changes.
    source = {"measured_sea": spectrum.kind} if path is None else {"wave_file": str(path), "wave_file_sha256": digest(Path(path))}
    return {**source, "measured_waves_used": int(used)}


def _correlation(correlation: float | WaveGlint) -> dict[str, str | float]:
    """Return the length of the sea's cells [m], or the name of what replaces it and the length of the waves from which on it counts [m]."""
    if not isinstance(correlation, WaveGlint):
        return {"glint_correlation_length_m": correlation}
    cut = correlation.shortest_wave
    return {"glint_correlation": "waves", **({"glint_waves_shorter_than_m": cut} if math.isfinite(cut) else {})}


def _of_rows(
    scenario: Scenario, camera: Camera, view: SeaView, length: float | WaveGlint, progress: Progress | None
) -> dict[str, FloatArray]:
    """Return components and the standard deviation of glint on a grid of elevation and azimuth [W m-2 sr-1, (rows, columns) each].

    Cells of the sea are independent, so a row's variance is the mean over its elevations, each with the solid angle of the pixel.
    """
    bent = bending(scenario, view)
    rows, points_across = RowAverage.of(camera, None if bent is None else bent.horizon), azimuths_across(view, camera.column_step)
    require_mean_memory(scenario, rows.elevations.size * camera.columns * points_across)
    rays = None if bent is None else bent.paths(rows.elevations)
    elevations = rows.elevations if bent is None or rays is None else bent.straight(rays)
    azimuths = (camera.azimuths[:, None] + camera.column_step * ((np.arange(points_across) + 0.5) / points_across - 0.5)).ravel()
    beyond = None if bent is None or rays is None else air_beyond(view, bent, bent.beyond(rays))
    solid_angle = np.repeat(pixel_solid_angle(camera), rows.points)
    # Blocks hold whole rows.
    size = max(BLOCK // azimuths.size, 1)
    match scenario.mean.mode:
        # Large pictures interpolate between nodes of elevation; small ones are cheaper line by line.
        case "spectral" if camera.rows > size and elevations.size > NODES:
            along = MeanModel.prepare(view).map
        case "spectral":
            along, size = partial(mean_radiance, view), camera.rows
        case "article":
            along = partial(article_radiance, view)
        case other:
            assert_never(other)
    report = progress or (lambda done, total: None)
    maps = {name: np.empty((camera.rows, camera.columns)) for name in MAPS}
    for first in range(0, camera.rows, size):
        report(first, camera.rows)
        average, part = rows.of_rows(first, min(first + size, camera.rows))
        fine = along(elevations[part], azimuths)
        variance = sea_variance(view, fine, elevations[part], solid_angle[part], length)
        if beyond is not None:
            share, added = (each[part, None] for each in beyond)
            # Air beyond the standard path attenuates all parts and adds its own emission to the path.
            lit = {name: share * getattr(fine, name) for name in ("path", "emission", "sky", "sun", "foam_sun")}
            fine, variance = replace(fine, **{**lit, "path": lit["path"] + added}), share**2 * variance
        for name, values in zip(MAPS, (fine.path, fine.emission, fine.sky, fine.sunlight, variance), strict=True):
            mean_of_rows = average(values)
            if mean_of_rows.shape[1] > 1:
                mean_of_rows = mean_of_rows.reshape(-1, camera.columns, points_across).mean(axis=2)
            maps[name][first : first + size] = mean_of_rows
    report(camera.rows, camera.rows)
    return maps | {MAPS[-1]: np.sqrt(maps[MAPS[-1]])}


def azimuths_across(view: SeaView, step: float) -> int:
    """Return the number of azimuths averaged across columns ``step`` wide [rad]: three per standard deviation of the narrowest glint.

    The mean is then within 0.5 % of the brightest; narrower columns are computed at their middle.
    """
    narrowest = min(light.glint_width for light in view.lights if light is not None)
    return max(math.ceil(3.0 * step / narrowest), math.ceil(step / _WIDEST))


def components_along(scenario: Scenario, view: SeaView, length: float | WaveGlint) -> Sights:
    """Return a function for components at scattered lines of sight (``Sights``), with the variance of glint in place of its root."""
    along: Callable[[FloatArray, FloatArray], SeaRadiance]
    match scenario.mean.mode:
        case "spectral":
            along = MeanModel.prepare(view).along
        case "article":

            def along(elevation: FloatArray, azimuth: FloatArray) -> SeaRadiance:
                return article_radiance(view, elevation, azimuth[:, None])

        case other:
            assert_never(other)

    def stacked(elevation: FloatArray, azimuth: FloatArray, solid_angle: FloatArray) -> FloatArray:
        components = along(elevation, azimuth)
        variance = sea_variance(view, components, elevation, solid_angle, length)
        return np.concatenate([components.path, components.emission, components.sky, components.sunlight, variance], axis=1).T

    return stacked


@dataclass(frozen=True, eq=False)
class RowAverage:
    """Elevations within the height of each pixel row, and the mean over them, as an image has it. Make it with ``of``.

    Rows that are high against their distance from the horizon are the mean of ``ROW_POINTS`` elevations, the row that the horizon cuts
    of ``CUT_POINTS``; for others the middle serves.
    """

    elevations: FloatArray
    starts: NDArray[np.intp]
    points: NDArray[np.intp]

    @classmethod
    def of(cls, camera: Camera, horizon: float | None = None) -> RowAverage:
        """Return elevations for the rows of a camera, from the top; ``horizon`` [rad] is the sea's if refraction is not standard."""
        below = np.abs(camera.elevations + (horizon_depression(camera.height) if horizon is None else -horizon))
        points = np.where(camera.row_step > ROW_SHARE * below, ROW_POINTS, 1)
        # The row that the horizon cuts comes last, because it also fulfils the condition above.
        points[below < 0.5 * camera.row_step] = CUT_POINTS
        row = np.repeat(np.arange(camera.rows), points)
        starts = np.cumsum(points) - points
        # Offsets within a pixel row, from -1/2 at the top to 1/2.
        part = (np.arange(row.size) - starts[row] + 0.5) / points[row] - 0.5
        return cls(camera.elevations[row] - part * camera.row_step, starts, points)

    def of_rows(self, first: int, end: int) -> tuple[RowAverage, slice]:
        """Return the averages of some of the rows, and the slice of their elevations."""
        begin = int(self.starts[first])
        part = slice(begin, int(self.starts[end - 1] + self.points[end - 1]))
        return RowAverage(self.elevations[part], self.starts[first:end] - begin, self.points[first:end]), part

    def __call__(self, values: FloatArray) -> FloatArray:
        """Return the mean of (elevations, columns) over the elevations of each row (rows, columns)."""
        averaged = values[self.starts]
        for row in np.flatnonzero(self.points > 1):  # few: those next to the horizon
            averaged[row] = values[self.starts[row] : self.starts[row] + self.points[row]].mean(axis=0)
        return averaged


def pixel_solid_angle(camera: Camera) -> FloatArray:
    """Return the solid angle of a pixel of each row [sr, (rows,)]: azimuth step times the difference of the sines of its edges."""
    edge = 0.5 * camera.row_step
    return np.asarray(camera.column_step * (np.sin(camera.elevations + edge) - np.sin(camera.elevations - edge)))
