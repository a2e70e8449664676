"""Signal injected into the frames of a scenario: its shape behind the sensor, and its contrast from the statement of the user."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError, DomainError
from seaglint.detection.spot import FineSpot, GaussianSpot, SpotShape
from seaglint.instrument.chain import SensorModel
from seaglint.instrument.figures_of_merit import point_response
from seaglint.objects.drawing.compose import BodySight
from seaglint.scenario.model import Scenario
from seaglint.scenario.records.object_tables import Object
from seaglint.studies.build.sensor_model import sensor_model
from seaglint.studies.detect.scene_frames import IndependentSeas, sea_seed
from seaglint.studies.sequence.render_sequence import prepare_sequence
from seaglint.studies.sequence.sensed_sequence import prepare_sensed
from seaglint.studies.sequence.sequence_work import SceneCache

Unit = Literal["W m-2 sr-1", "K", "W/sr"]

REACH: Final = 12  #: Pixels from an object's brightest pixel beyond which its blur is cut [px].

CUT: Final = 1e-3  #: Share of its peak below which the edge of an object's picture is cut.

FINEST: Final = 5  #: Steps to a pixel, at least, at which a point's response is known.

_AROUND = 20

SWEEP: Final = (0.5, 1.0, 2.0, 4.0, 8.0, 16.0)  #: Contrasts by default [standard deviations of the clutter].


@dataclass(frozen=True)
class Strength:
    """Contrasts in the unit in which they are stated."""

    values: tuple[float, ...]  #: Contrasts in ``unit``.
    #: In-band radiance at the aperture, or apparent temperature, of an object that fills a pixel, against the field's mean; or the in-band
    #: intensity of a point before the path.
    unit: Unit = "W m-2 sr-1"
    range_m: float | None = None  #: Distance of that point [m].
    height_m: float = 5.0  #: Height of that point [m].

    def __post_init__(self) -> None:
        wrong = [v for v in self.values if v == 0 or not math.isfinite(v)]
        if wrong or not self.values:
            given = f"contrast = {wrong[0]:g}" if wrong else "no contrast given"
            raise DomainError(f"{given}: an object must differ from what is behind it; give a finite number other than 0")
        if self.unit == "W/sr" and (self.range_m is None or not self.range_m > 0):
            raise DomainError("an intensity in W/sr is seen from a range; give range_m, above 0")

    def at_aperture(self, seas: IndependentSeas, mean: float) -> tuple[float, ...]:
        """Return the in-band contrasts at the aperture, over the angle of a pixel [W m-2 sr-1]; ``mean`` is the field's mean [W m-2 sr-1].

        Raises
        ------
        DomainError
            A temperature below 100 K, or a range beyond the air that is known.
        """
        match self.unit:
            case "W m-2 sr-1":
                return self.values
            case "K":
                return tuple(_of_temperature(seas, mean, v) for v in self.values)
            case "W/sr":
                share = transmittance(seas, self.range_m or 0.0, self.height_m)
                angle = seas.pixel_solid_angle
                # The slant distance, from the difference of heights.
                distance = math.hypot(self.range_m or 0.0, seas.sequence.scene.view.sensor_height - self.height_m)
                return tuple(v * share / (distance**2 * angle) for v in self.values)


def _of_temperature(seas: IndependentSeas, mean: float, difference: float) -> float:
    from seaglint.optics.band import apparent_temperature
    from seaglint.optics.blackbody import planck_wavenumber

    view = seas.sequence.scene.view
    around = float(apparent_temperature(np.array([mean]), view.band, view.atmosphere.wavenumber_cm)[0])
    if not math.isfinite(around) or around + difference < 100.0:
        raise DomainError(f"temperature difference = {difference:g} K from {around:.4g} K is no temperature above 100 K; give another")
    hot, cold = (float(view.in_band(planck_wavenumber(view.atmosphere.wavenumber_cm, t))) for t in (around + difference, around))
    return hot - cold


def transmittance(seas: IndependentSeas, range_m: float, height_m: float) -> float:
    """Return the mean over the band of the transmittance to a point [1], weighted by the response alone, as for drawn points.

    Raises
    ------
    DomainError
        A range or a height beyond the air that is known.
    """
    view = seas.sequence.scene.view
    tau = view.atmosphere.transmittance(view.sensor_height, np.array([range_m]), np.array([height_m]))[..., view.in_band.grid]
    return float((np.clip(tau, 0.0, 1.0) @ view.in_band.weights / view.in_band.weights.sum())[0])


def fine_response(picture: NDArray[np.float64], steps: int, blur: Callable[[NDArray[np.float32]], NDArray[Any]]) -> FloatArray:
    """Return the signal of pixels at every fine place of a picture with ``steps`` x ``steps`` values to a pixel, blurred by ``blur``.

    Element (i, j) is the value of a pixel centred on the picture's element i, j; half a fine pixel away from it where ``steps`` is even.
    """
    rows, columns = picture.shape
    out = np.zeros((rows, columns))
    for down in range(steps):
        for right in range(steps):
            # pixel i of the shifted picture holds the fine pixels i steps + down ...; its centre is (steps - 1) / 2 further on
            out[down::steps, right::steps] = blur(np.roll(picture, (-down, -right), axis=(0, 1)).astype(np.float32))
    return np.roll(out, ((steps - 1) // 2,) * 2, axis=(0, 1))


def spot_of(response: FloatArray, steps: int) -> tuple[FineSpot, float]:
    """Return the shape about the largest value of a response, and that value with its sign.

    Raises
    ------
    DataError
        A response that is 0 everywhere.
    """
    row, column = np.unravel_index(int(np.abs(response).argmax()), response.shape)
    peak = float(response[row, column])
    if peak == 0.0:
        raise DataError("the object leaves nothing in the picture: it is hidden, out of view, or as bright as what is behind it")
    whole = response / peak
    rim = [np.abs(whole) >= CUT]
    # The faint rim is cut; the rest is rounded up to whole pixels about the peak.
    far = max(int(np.abs(np.nonzero(rim[0])[axis] - at).max()) for axis, at in ((0, row), (1, column)))
    half = min(max(-(-far // steps), 1), REACH) * steps
    return FineSpot(np.pad(whole, half)[row : row + 2 * half + 1, column : column + 2 * half + 1], steps), peak


def point_shape(model: SensorModel | None) -> tuple[SpotShape, float]:
    """Return the shape of a point behind the sensor, and its ``point_response``.

    Without a sensor the shape is a spot within one pixel.
    """
    if model is None:
        return GaussianSpot(0.05), 1.0
    # At least as fine as the rendering, and fine enough for displacements within a pixel.
    steps = max(model.finest, FINEST)
    steps += 1 - steps % 2  # an odd number has a fine pixel in the middle
    size = 2 * _AROUND + 1
    blur = _blur(model, size, steps, points=True)
    picture = np.zeros((size * steps, size * steps))
    middle = _AROUND * steps + steps // 2
    picture[middle, middle] = float(steps * steps)
    return spot_of(fine_response(picture, steps, blur), steps)[0], point_response(model)


def _blur(model: SensorModel, size: int, steps: int, *, points: bool = False) -> Callable[[NDArray[np.float32]], NDArray[Any]]:
    """Return the blur of a sensor's optics, detector and stray light, for a small square picture of means over pixels or of points."""
    small = replace(model, circle=False, _transfers=type(model._transfers)())
    transfer = small.transfer((size * steps, size * steps), steps, points=points)
    direct = 1.0 - model.optics.stray_share
    return lambda picture: direct * transfer(picture)


@dataclass(frozen=True)
class ObjectSignal:
    """Signal of an object of a scenario over the mean sea."""

    shape: SpotShape  #: Shape of the object, behind the sensor if the scenario has one.
    contrast: float  #: Contrast of its brightest pixel, when it is centred there [W m-2 sr-1].
    row: float  #: Row of that pixel in the whole picture [px].
    column: float  #: Column of that pixel in the whole picture [px].
    columns: tuple[int, int] = (0, 0)  #: First column of the object, and the column after the last [px].
    whole: float = 0.0  #: Visible solid angle over the mean sea [sr]; 1 for a point.
    among: Scenario | None = None  #: The object alone among the scenario's waves; None where they are no geometry and hide nothing.

    def visible_shares(self, count: int, seas: IndependentSeas) -> FloatArray:
        """Return the share of the object that independent seas leave visible, over the share that the mean sea leaves visible.

        Parameters
        ----------
        count : int
            Number of seas.
        seas : IndependentSeas
            Seas of the same scenario, whose prepared tables are used here, too.

        Returns
        -------
        ndarray, shape (count,)
            Shares [1]; 1 where no waves are geometry. A point is visible or not.
        """
        if self.among is None:
            return np.ones(count)
        sequence = seas.with_objects(self.among)
        fine = sequence.scene.pixels.columns // self.among.sensor.pixels[0]
        columns = self.columns[0] * fine, self.columns[1] * fine
        visible = [_in_view(sequence.reseeded(sea_seed(self.among.seed, k)).sights(0.0, columns)) for k in range(count)]
        return np.minimum(np.array(visible) / self.whole, 1.0)


def _in_view(sights: tuple[BodySight, ...]) -> float:
    """Return the visible solid angle of the single object [sr]; 1 or 0 for a point."""
    (sight,) = sights
    if sight.whole > 0.0:
        return sight.seen
    return float(any((share.radiance > 0.0).any() for share in sight.shares))


def item_of(scenario: Scenario, name: str) -> Object:
    """Return the object of a name.

    Raises
    ------
    DataError
        No object of that name.
    """
    for item in scenario.objects or ():
        if item.name == name:
            return item
    names = ", ".join(item.name for item in scenario.objects or ()) or "none"
    raise DataError(f"object '{name}' is not in the scenario; its [[objects]] are {names}")


def object_signal(scenario: Scenario, name: str, cached: SceneCache | None = None) -> ObjectSignal:
    """Draw one object over the mean sea, through path and sensor; ``cached`` holds the sea that the objects of several scenarios share.

    Raises
    ------
    DataError
        No object of that name, or nothing of it is visible.
    """
    item = item_of(scenario, name)
    plain = scenario.render.model_copy(update={"layers": (), "apparent_temperature": False, "step_m": None})
    alone = scenario.model_copy(update={"objects": (item,), "render": plain})
    # Over the mean sea: waves that are geometry would hide some of the object.
    calm = alone.model_copy(update={"sea": scenario.sea.model_copy(update={"resolve_waves": False})})
    if calm.sensor.senses:
        if scenario.render.oversampling is None:
            # A shape resolves the optics' cut-off; fewer than three steps to a pixel do not give one that can be displaced within it.
            drawn_finer = plain.model_copy(update={"oversampling": max(sensor_model(scenario).finest, 3)})
            calm = calm.model_copy(update={"render": drawn_finer})
        sensed = prepare_sensed(calm, cached=cached)
        sequence, steps, model = sensed.fine, sensed.sensed.oversampling, sensed.sensed.model
    else:
        steps, model = 3, None
        columns, rows = calm.sensor.pixels
        finer = calm.sensor.model_copy(update={"pixels": (columns * steps, rows * steps)})
        sequence = prepare_sequence(calm.model_copy(update={"sensor": finer}), cached=cached)
    drawn = sequence.drawn(0.0)
    difference = drawn.layers.radiance.astype(np.float64) - drawn.sea
    if not np.abs(difference).any():
        raise DataError(f"object '{name}' leaves nothing in the picture: it is hidden, out of view, or as bright as what is behind it")
    rows_lit, columns_lit = (np.nonzero(np.abs(difference).max(axis=axis))[0] for axis in (1, 0))
    row, column = (int(v.mean()) // steps for v in (rows_lit, columns_lit))
    reach = max(int(np.ptp(v)) // steps for v in (rows_lit, columns_lit)) // 2 + _AROUND
    size = 2 * reach + 1
    # A margin, so that the object may lie at the border of the picture.
    padded = np.pad(difference, reach * steps)
    picture = padded[row * steps : (row + size) * steps, column * steps : (column + size) * steps]
    if not drawn.sights[0].whole > 0.0:  # a point, wherever it lies in its pixel
        shape, share = point_shape(model)
        centre = [(float(at) + 0.5) / steps - 0.5 for at in np.argwhere(difference).mean(axis=0)]
        extent = int(columns_lit[0]) // steps, int(columns_lit[-1]) // steps + 1
        among = alone if scenario.sea.resolve_waves else None
        return ObjectSignal(shape, share * float(difference.sum()) / steps**2, centre[0], centre[1], extent, _in_view(drawn.sights), among)
    if model is None:
        response = fine_response(picture, steps, lambda p: p.reshape(size, steps, size, steps).mean(axis=(1, 3)))
    else:
        response = fine_response(picture, steps, _blur(model, size, steps))
    try:
        shape, contrast = spot_of(response, steps)
    except DomainError as error:
        raise DataError(f"object '{name}': {error}") from error
    peak = np.unravel_index(int(np.abs(response).argmax()), response.shape)
    place = [(at - reach) + (float(p) + 0.5) / steps - 0.5 for at, p in zip((row, column), peak, strict=True)]
    extent = int(columns_lit[0]) // steps, int(columns_lit[-1]) // steps + 1
    return ObjectSignal(shape, contrast, place[0], place[1], extent, _in_view(drawn.sights), alone if scenario.sea.resolve_waves else None)
