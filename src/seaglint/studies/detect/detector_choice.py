"""Choice of the detector of a range: each of a short list is tried on the same frames, and the one with most contrast to spare is taken."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from seaglint.base.errors import SeaglintError
from seaglint.detection.design import by_windows
from seaglint.files.detection_range import TriedDetector
from seaglint.studies.detect.designer import rate_threshold
from seaglint.studies.detect.performance import detect

if TYPE_CHECKING:
    from seaglint.detection.sources import FrameSource
    from seaglint.studies.detect.designer import Design
    from seaglint.studies.detect.performance import DetectionOptions

#: Detectors that are tried where none is stated; each looks at one frame, so that all of them share the frames.
TRIED: Final = ("matched", "matched-global", "matched-local", "ca-cfar", "max-median")

INJECTIONS: Final = 120  #: Most objects of each contrast that are tried for a choice; 120 of them know a P_d of 0.9 to 0.03.

LARGEST: Final = 32.0  #: Largest margin that is measured [1]; larger ones count as this.

SMALLEST: Final = 0.125  #: Smallest margin that is measured [1].

_FACTORS: Final = np.geomspace(1.0 / LARGEST, 1.0 / SMALLEST, 17)


def tried_detectors(
    names: Sequence[str], source: FrameSource, options: DetectionOptions, contrast: float, design: Design, range_m: float
) -> list[TriedDetector]:
    """Return the margin of each detector on some frames.

    Parameters
    ----------
    names : sequence of str
        Detectors.
    source : FrameSource
        Frames without objects.
    options : DetectionOptions
        Objects, threshold and filter; the detector is each of ``names``.
    contrast : float
        Contrast of the object in its pixel, above 0 [units of the source].
    design : Design
        Wanted P_d and rate of false alarms.
    range_m : float
        Range at which these are the frames [m].
    """
    out = []
    for name in names:
        try:
            margin = contrast_margin(source, replace(options, detector=name), contrast, design)
            note = None if margin is not None else f"it needs more than {1.0 / SMALLEST:g} times the contrast"
        except SeaglintError as error:
            margin, note = None, str(error)
        out.append(TriedDetector(name, range_m, margin, note))
    return out


def contrast_margin(source: FrameSource, options: DetectionOptions, contrast: float, design: Design) -> float | None:
    """Return a contrast over the one at which the wanted P_d is reached, at most :data:`LARGEST` [1]; None below :data:`SMALLEST`.

    P_d is counted at seventeen contrasts, taken to rise with the contrast, and interpolated in its logarithm.

    Raises
    ------
    SeaglintError
        A detector that cannot judge the frames, or a rate of false alarms that they are too few for.
    """
    contrasts = tuple(float(value) for value in contrast * _FACTORS)
    objects = replace(options.objects, contrasts=contrasts, injections=min(options.objects.injections, INJECTIONS))
    found = detect(source, replace(options, objects=objects), locate=False)
    threshold = rate_threshold(found, design).sigma
    rates = np.maximum.accumulate([by_windows(scores, threshold, options.level).rate for scores in found.trials.scores])
    if rates[-1] < design.p_d:
        return None
    above = int(np.argmax(rates >= design.p_d))
    if above == 0:
        return LARGEST
    between = float(np.interp(design.p_d, rates[above - 1 : above + 1], np.log(_FACTORS[above - 1 : above + 1])))
    return float(np.exp(-between))


def best_of(tried: Sequence[TriedDetector]) -> TriedDetector:
    """Return the detector with the largest margin, of equal ones the first.

    Examples
    --------
    >>> best_of([TriedDetector("a", 1e3, None, "it fails"), TriedDetector("b", 1e3, 1.2), TriedDetector("c", 1e3, 0.8)]).detector
    'b'
    """
    return max(tried, key=lambda one: 0.0 if one.contrast_margin is None else one.contrast_margin)


def choice_line(tried: Sequence[TriedDetector], p_d: float) -> str:
    """Return the margins of one range as text, the largest first.

    Examples
    --------
    >>> choice_line([TriedDetector("a", 5e3, None, "it fails"), TriedDetector("b", 5e3, 1.234)], 0.9)
    'contrast at 5000 m over what is needed for P_d 0.9: b 1.23, a none; b is taken'
    """
    falling = sorted(tried, key=lambda one: -(one.contrast_margin or 0.0))
    margins = ", ".join(f"{one.detector} {'none' if one.contrast_margin is None else f'{one.contrast_margin:.3g}'}" for one in falling)
    return f"contrast at {tried[0].range_m:.0f} m over what is needed for P_d {p_d:g}: {margins}; {best_of(tried).detector} is taken"
