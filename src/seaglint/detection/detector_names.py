"""Names of the detectors of this package, with their classes: the one list behind help texts, errors and the choice of a range.

Importing this module loads no other module: a help page needs it. ``seaglint.detection.named_detectors`` makes the detectors.
"""

from __future__ import annotations

from typing import Any, Final, NamedTuple


class DetectorEntry(NamedTuple):
    """Detector of the package: its name, its class and its use by the commands."""

    name: str  #: Name in requests and results.
    made_by: str  #: Module of ``seaglint.detection`` and class.
    statistic: str  #: Statistic in one line.
    settings: dict[str, Any] = {}  # noqa: RUF012  #: Arguments of the class.
    needs_shape: bool = False  #: True if the detector is built for the shape of an object.
    analyzed: bool = False  #: True if ``seaglint analyze`` lists it beside the filter.
    #: Place among the detectors that are tried for a range where none is stated; 0 for the others. Each of them uses one frame: they share
    #: the frames.
    tried: int = 0


#: All detectors in the order of the help pages.
DETECTORS: Final = (
    DetectorEntry("threshold", "spatial.FilterThreshold", "the frame, or the filtered frame"),
    DetectorEntry("matched", "matched.Matched", "matched filter for the object's shape in white noise", needs_shape=True, tried=1),
    DetectorEntry("matched-global", "matched.Matched", "matched filter with the covariance of the frames", needs_shape=True, tried=2),
    DetectorEntry("matched-local", "matched.LocalMatched", "matched filter with the covariance of each tile", needs_shape=True, tried=3),
    DetectorEntry("log", "spatial.FilterThreshold", "Laplacian of Gaussian of the object's size", needs_shape=True),
    DetectorEntry("top-hat", "spatial.top_hat", "the frame less its morphological opening"),
    DetectorEntry("max-mean", "spatial.DirectionalBackground", "excess over the largest mean along four lines", {"kind": "mean"}),
    DetectorEntry(
        "max-median", "spatial.DirectionalBackground", "excess over the largest median along four lines", {"kind": "median"}, tried=5
    ),
    DetectorEntry("patch-image", "patch_image.PatchImage", "sparse part of the frame's patches"),
    DetectorEntry("ca-cfar", "cfar.CellAveraging", "the pixel against the mean of its ring", analyzed=True, tried=4),
    DetectorEntry("os-cfar", "cfar.OrderedStatistic", "the pixel against quantiles of its ring", analyzed=True),
    DetectorEntry(
        "os-cfar-exponential",
        "cfar.OrderedStatistic",
        "ratio of the pixel to a quantile of its ring",
        {"clutter": "exponential"},
        analyzed=True,
    ),
    DetectorEntry("temporal-profile", "temporal.TemporalProfile", "Student's ratio of a pixel to its earlier frames"),
    DetectorEntry("track-before-detect", "temporal.TrackBeforeDetect", "largest sum along a track"),
    DetectorEntry("frame-difference", "moving.FrameDifference", "difference of two frames", analyzed=True),
    DetectorEntry("integration", "moving.RegisteredIntegration", "mean of registered frames", analyzed=True),
)

ANALYZED: Final = tuple(entry.name for entry in DETECTORS if entry.analyzed)  #: Names on the help page of ``seaglint analyze``.

#: Names of detectors that are built without the shape of an object; those of ``seaglint analyze`` come first.
PLAIN: Final = (*ANALYZED, *(entry.name for entry in DETECTORS if not (entry.analyzed or entry.needs_shape)))

NAMES: Final = (*PLAIN, *(entry.name for entry in DETECTORS if entry.needs_shape))  #: All names; the last ones need the object's shape.

#: Detectors tried for a range where none is stated, in that order: of equal ones the first is taken.
TRIED: Final = tuple(entry.name for entry in sorted(DETECTORS, key=lambda entry: entry.tried) if entry.tried)

OWN: Final = "package.module:function or FILE.py:function"  #: Forms of the name of a user's detector.

#: All names with the form of the name of a user's detector, as help texts list them.
CHOICE: Final = f"{', '.join(entry.name for entry in DETECTORS)}, or {OWN}"
