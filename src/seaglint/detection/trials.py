"""Trials of a detector with injected objects, batch by batch, and the position of each detected object.

For a linear detector, clutter and objects pass separately: the statistic of the clutter is known, and the statistic of the objects is
computed once and scaled to every contrast. Any other detector receives the frames with the objects in them. Objects before a sensor have
shot noise, and their increase is counted in steps (``seaglint.detection.sources.Counting``).

Positions are estimated by centroid or least squares, as (row, column) from the centre of the patch's middle pixel [px].

References
----------
Kay 1993, Fundamentals of Statistical Signal Processing: Estimation Theory, ch. 3 (Cramer-Rao bound); Winick 1986, J. Opt. Soc. Am. A 3,
1809 (position of a spot in pixels).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray, Progress
from seaglint.base.errors import DataError, DomainError
from seaglint.detection.background import Background, Threshold, Windows
from seaglint.detection.injection import Batch, InjectionPlan, Placement, free, inject, most_batches, nothing_free, pitch_for
from seaglint.detection.interface import Detector, Frames
from seaglint.detection.scoring import Scores, around, best, match_offsets
from seaglint.detection.sources import FrameSource
from seaglint.detection.spot import SpotShape

Pointing = Literal["least-squares", "centroid"]

FARTHEST: Final = 1.0  #: Displacement from the brightest pixel beyond which a fit is rejected [px].

_STEP = 1e-3
_ITERATIONS = 8


def border_level(patches: FloatArray) -> FloatArray:
    """Mean of the outermost pixels of each patch, shape (n,) [u]: a local level of the clutter."""
    n, side = patches.shape[:2]
    ring = np.ones((side, side), np.bool_)
    ring[1:-1, 1:-1] = False
    return np.asarray(patches[:, ring].mean(axis=1) if side > 2 else np.zeros(n))


def centroid(patches: FloatArray, level: FloatArray | float = 0.0) -> FloatArray:
    """Centre of gravity of each patch above its level, shape (n, 2) [px]; NaN where the sum above it is not positive.

    x = sum x (I - level) / sum (I - level)
    """
    above = patches - np.reshape(level, (-1, 1, 1))
    half = (patches.shape[1] - 1) / 2
    # Places count from the middle pixel of the patch.
    axis = np.arange(patches.shape[1]) - half
    total = above.sum(axis=(1, 2))
    with np.errstate(divide="ignore", invalid="ignore"):
        place = np.stack([(above.sum(axis=2) * axis).sum(axis=1), (above.sum(axis=1) * axis).sum(axis=1)], axis=1) / total[:, None]
    return np.where(total[:, None] > 0, place, np.nan)


def _derivatives(shape: SpotShape, place: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Shape and its derivatives with respect to row and column."""
    steps = _STEP * np.eye(2)
    # Central differences over a thousandth of a pixel.
    down, right = ((shape.stamps(place + s) - shape.stamps(place - s)) / (2 * _STEP) for s in steps)
    return shape.stamps(place), down, right


def least_squares(patches: FloatArray, shape: SpotShape) -> FloatArray:
    """Position of the best fit of the shape with an amplitude and a constant level to each patch, shape (n, 2) [px].

    Gauss-Newton steps on the place from the middle of the patch; amplitude and level are solved for at each. Places farther than
    ``FARTHEST`` from the middle are given as NaN: noise has a brighter pixel.

    Parameters
    ----------
    patches : ndarray, shape (n, 2 half + 1, 2 half + 1)
        Around the brightest pixel of each object [u].
    shape : SpotShape
        Shape of the object, with that ``half``.
    """
    n = patches.shape[0]
    values = patches.reshape(n, -1)
    place = np.zeros((n, 2))
    for _ in range(_ITERATIONS):
        s, down, right = (d.reshape(n, -1) for d in _derivatives(shape, place))
        # Amplitude and level first, then the step of the place with both free as well: columns S, 1, A dS/drow, A dS/dcolumn.
        centred = s - s.mean(axis=1, keepdims=True)
        amplitude = (centred * values).sum(axis=1) / np.maximum((centred**2).sum(axis=1), 1e-300)
        design = np.stack([s, np.ones_like(s), amplitude[:, None] * down, amplitude[:, None] * right], axis=2)
        normal = np.einsum("npi,npj->nij", design, design)
        # A vanishing amplitude leaves the place undetermined: the ridge keeps its step at 0.
        normal += 1e-12 * np.trace(normal, axis1=1, axis2=2)[:, None, None] * np.eye(4)
        step = np.linalg.solve(normal, np.einsum("npi,np->ni", design, values)[:, :, None])[:, 2:, 0]
        # Bounded steps: a fit to noise must not leave the patch.
        place = np.clip(place + np.clip(step, -0.5, 0.5), -2 * FARTHEST, 2 * FARTHEST)
    near = np.abs(place).max(axis=1) < FARTHEST
    return np.where(near[:, None], place, np.nan)


LARGEST_CONTRAST: Final = 1e30  #: Largest contrast in single precision, with a margin for the sums of detectors [u].


@dataclass(frozen=True)
class InjectedObjects:
    """Injected objects and the matching of detections to them."""

    shape: SpotShape  #: Shape of every object.
    contrasts: tuple[float, ...]  #: Signals of an object in the pixel at whose centre it lies; not 0 [u].
    injections: int = 1000  #: Objects of each contrast, all at the same places.
    placement: Placement = "random"  #: ``random``, anywhere within the pixels, or ``centre``, at their centres.
    match_radius: float = 1.0  #: Largest distance of a detection from the object's pixel [px].
    velocity: tuple[float, float] = (0.0, 0.0)  #: Motion in rows and columns [px a frame].
    pointing: Pointing = "least-squares"  #: Method that estimates places, ``least-squares`` or ``centroid``.
    seed: int = 0  #: Seed of places.
    duration: int = 0  #: Frames for which an object is there, up to the judged one; 0 for all that the detector sees [frames].
    only_rows: tuple[int, int] | None = None  #: Rows that hold objects, first and end [px].

    def __post_init__(self) -> None:
        wrong = [c for c in self.contrasts if c == 0 or not np.isfinite(c)]
        if wrong or not self.contrasts:
            given = f"contrast = {wrong[0]:g}" if wrong else "no contrast given"
            raise DomainError(f"{given}: an object must add something to its pixel; give a finite number other than 0")
        beyond = max(map(abs, self.contrasts))
        if beyond > LARGEST_CONTRAST:
            raise DomainError(f"contrast = {beyond:g} is beyond what frames hold; give a number within {LARGEST_CONTRAST:g}")
        if not all(np.isfinite(self.velocity)) or max(abs(v) for v in self.velocity) > 50.0:
            raise DomainError(f"velocity = {self.velocity} px a frame; give two numbers within 50")
        if self.duration < 0:
            raise DomainError(f"duration = {self.duration} frames; give at least 1, or 0 for all that the detector sees")

    def plan(self, detector: Detector, source: FrameSource) -> InjectionPlan:
        """Return the places of the objects for a detector."""
        travel = int(np.ceil(detector.lead * max(abs(v) for v in self.velocity)))
        pitch = pitch_for(detector, self.shape, self.match_radius, travel)
        margin = self.shape.half + int(self.match_radius) + travel
        place = Windows.of(source, detector.lead)
        return InjectionPlan(
            injections=self.injections,
            windows=place.count,
            rows=source.rows,
            columns=source.columns,
            pitch=pitch,
            margin=margin,
            placement=self.placement,
            seed=self.seed,
            only_rows=self.only_rows,
            spread=place.sequences > 1,
        )


@dataclass(frozen=True)
class Trials:
    """Scores of all injected objects."""

    scores: tuple[Scores, ...]  #: One for each contrast.
    saturated: tuple[int, ...]  #: Objects of each contrast that would go beyond saturation, where they are cut.
    stopped: str | None  #: Reason why fewer objects than requested were tried.


class _Batches:
    """Statistics and patches of batches of objects."""

    def __init__(
        self, background: Background, source: FrameSource, objects: InjectedObjects, threshold: Threshold, *, locate: bool
    ) -> None:
        self.locate = locate
        self.background, self.source, self.objects, self.threshold = background, source, objects, threshold
        self.offsets = match_offsets(objects.match_radius)
        half = objects.shape.half
        rows, columns = (g.ravel() for g in np.meshgrid(*[np.arange(-half, half + 1)] * 2, indexing="ij"))
        self.patch: Final = np.stack([rows, columns], axis=1)

    def run(self, batch: Batch) -> list[tuple[FloatArray, FloatArray, int]]:
        """Return score, error of place and number of saturated objects, for each contrast."""
        objects, lead = self.objects, self.background.lead
        start = self.background.place.start(batch.window)
        frames = self.source.read(start, start + lead + 1)
        alone = np.zeros_like(frames)
        present = min(objects.duration, lead + 1) or lead + 1  # frames with the object, the last ones of the window
        inject(alone[lead + 1 - present :], batch, objects.shape, 1.0, objects.velocity)
        detector, counting = self.background.detector, self.source.counting
        draws = None if counting is None else counting.draws(objects.seed, start, alone.shape)
        response = detector(alone)[-1] if detector.linear and counting is None else None
        base = around(self.background.statistic[batch.window], batch.row, batch.column, self.offsets)
        out = []
        for contrast in objects.contrasts:
            added = np.float32(contrast) * alone
            if counting is not None and draws is not None:
                added = counting.added(added, draws)
            with_objects = frames + added
            high = self._saturated(with_objects, batch)
            # Linear without saturation: the statistic of the sum is the sum of the statistics.
            if response is not None and not high:
                values = base + contrast * around(response, batch.row, batch.column, self.offsets)
            elif detector.linear and not high:
                values = base + around(detector(added)[-1], batch.row, batch.column, self.offsets)
            else:
                if self.source.saturation is not None:
                    # A pixel that was beyond saturation before stays as it was.
                    with_objects = np.minimum(with_objects, np.maximum(frames, np.float32(self.source.saturation)))
                statistic = detector(with_objects)[-1]
                values = around(statistic, batch.row, batch.column, self.offsets)
            mean, sigma = self.background.scale(batch.window, self.threshold.law)
            score, where = best((values - mean) / sigma)
            out.append((score, self._errors(with_objects[-1], batch, score, where), high))
        return out

    def _saturated(self, frames: Frames, batch: Batch) -> int:
        """Number of objects whose brightest pixel is beyond saturation."""
        if self.source.saturation is None:
            return 0
        return int((frames[-1][batch.row, batch.column] > self.source.saturation).sum())

    def _errors(self, image: Frames, batch: Batch, score: FloatArray, where: NDArray[np.int64]) -> FloatArray:
        """Estimated minus true positions of objects above the threshold, NaN for the others."""
        error = np.full((batch.size, 2), np.nan)
        detected = np.flatnonzero(score > self.threshold.sigma)
        if not detected.size or not self.locate:
            return error
        pixel = np.stack([batch.row, batch.column], axis=1)[detected] + self.offsets[where[detected]]
        side = 2 * self.objects.shape.half + 1
        patches = around(image, pixel[:, 0], pixel[:, 1], self.patch).reshape(-1, side, side)
        whole = np.isfinite(patches).all(axis=(1, 2))
        detected, pixel, patches = detected[whole], pixel[whole], patches[whole]
        if detected.size:
            bright = patches if self.objects.contrasts[0] > 0 else -patches
            fitted = (
                least_squares(bright, self.objects.shape)
                if self.objects.pointing == "least-squares"
                else centroid(bright, border_level(bright))
            )
            error[detected] = pixel + fitted - batch.place[detected]
        return error


def run_trials(
    background: Background,
    source: FrameSource,
    objects: InjectedObjects,
    threshold: Threshold,
    *,
    report: Progress | None = None,
    enough: Callable[[Sequence[int]], str | None] | None = None,
    locate: bool = True,
) -> Trials:
    """Inject objects until the requested number has been tried.

    Parameters
    ----------
    background : Background
        Statistic of the same source without objects.
    source : FrameSource
        Frames.
    objects : InjectedObjects
        Objects to inject.
    threshold : Threshold
        Above which places are estimated; the scores hold for every threshold.
    report : callable, optional
        Called with (objects done, objects in all).
    enough : callable, optional
        Called after each batch, with the numbers of objects detected at each contrast so far and last the number tried; it returns the
        reason to stop, or None to continue.
    locate : bool
        Whether the places of detected objects are estimated.

    Raises
    ------
    DataError
        No object finds a place, or the detector fails on the first batch; what fails later ends the trials with its reason.
    """
    detector = background.detector
    plan = objects.plan(detector, source)
    work = _Batches(background, source, objects, threshold, locate=locate)
    parts: list[list[tuple[Batch, FloatArray, FloatArray]]] = [[] for _ in objects.contrasts]
    saturated, tried, hits = [0] * len(objects.contrasts), 0, [0] * len(objects.contrasts)
    stopped: str | None = None
    for number in range(most_batches(plan)):
        batch = plan.batch(number)
        # Objects in masked pixels would be missed by every detector.
        batch = free(batch, np.isfinite(background.statistic[batch.window]))
        rest = objects.injections - tried
        if batch.size > rest:
            batch = Batch(batch.window, batch.row[:rest], batch.column[:rest], batch.offset[:rest])
        if batch.size == 0:
            continue
        try:
            results = work.run(batch)
        except DataError as error:
            if tried == 0:
                raise
            stopped = f"stopped after {tried} of {objects.injections} injections: {error}"
            break
        for k, (score, errors, high) in enumerate(results):
            parts[k].append((batch, score, errors))
            saturated[k] += high
            hits[k] += int((score > threshold.sigma).sum())
        tried += batch.size
        if report is not None:
            report(tried, objects.injections)
        if tried >= objects.injections:
            break
        stopped = None if enough is None else enough([*hits, tried])
        if stopped is not None:
            break
    if tried == 0:
        raise nothing_free(most_batches(plan))
    if stopped is None and tried < objects.injections:
        stopped = f"{tried} of {objects.injections} injections found a place"
    scores = tuple(Scores.joined(c, p) for c, p in zip(objects.contrasts, parts, strict=True))
    return Trials(scores, tuple(saturated), stopped)
