"""Contrasts, detector and threshold of a request that states none of them, chosen from the clutter of the frames themselves."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from seaglint.base.errors import DataError
from seaglint.base.threads import single_threaded_algebra
from seaglint.detection.background import Background, count_false_alarms
from seaglint.studies.detect.injected import SWEEP
from seaglint.studies.detect.performance import as_given, detector_for

if TYPE_CHECKING:
    from seaglint.analysis import Recording
    from seaglint.studies.detect.performance import DetectionOptions
    from seaglint.studies.detect.requests import SpotRequest

#: Detector where none is named: it takes the level off, and weighs by the covariance of each part of the frame.
SUITED: Final = "matched-local"

RATE: Final = 1e-4  #: Rate of false alarms per pixel where no threshold is stated, as far as the pixels support it.

FEWEST: Final = 20  #: Least number of exceedances by which a threshold is chosen.

_FRAMES: Final = 16  #: Number of frames from which the clutter's deviation is taken.


def options_of(request: SpotRequest, source: Recording, pixel_deg: tuple[float, float] | None = None) -> DetectionOptions:
    """Return how a recording is judged: what the request states, and what suits the recording where it states no contrast.

    Raises
    ------
    DataError
        Frames without variation, or numbers that are not allowed.
    """
    if request.contrast is not None:
        return request.detection(request.contrast, source.frame_rate, pixel_deg)
    named = request.detector or (SUITED if min(source.rows, source.columns) >= 64 else "log")
    sigma = clutter_deviation(source)
    suited = replace(request, detector=named)
    options = suited.detection(tuple(float(f"{factor * sigma:.3g}") for factor in SWEEP), source.frame_rate, pixel_deg)
    if request.threshold is not None or request.threshold_law != "sigma":
        return options
    return replace(options, threshold=threshold_of(source, options))


def clutter_deviation(source: Recording) -> float:
    """Return the standard deviation of all pixels of some frames [units of the recording].

    Raises
    ------
    DataError
        Frames that do not vary.
    """
    numbers = np.unique(np.linspace(0, source.frames - 1, min(source.frames, _FRAMES)).astype(int))
    sigma = float(np.nanstd(np.stack([source.read(int(n), int(n) + 1)[0] for n in numbers]).astype(np.float64)))
    if not (np.isfinite(sigma) and sigma > 0.0):
        raise DataError(f"{source.source}: its frames do not vary, so there is no clutter to choose contrasts by; state `contrast`")
    return sigma


def threshold_of(source: Recording, options: DetectionOptions) -> float:
    """Return the lowest threshold that leaves the usual rate of false alarms [standard deviations, three digits]."""
    given = as_given(source, options)
    with single_threaded_algebra():
        background = Background(detector_for(given, options), given)
        curve = count_false_alarms(background, background.threshold(options.threshold, "sigma"), options.level).alarms.curve()
    wanted = max(RATE * curve.pixels, FEWEST)
    beyond = np.flatnonzero(curve.exceedances <= wanted)
    found = float(curve.threshold[beyond[0]]) if beyond.size else options.threshold
    return float(f"{max(found, 1.0):.3g}")
