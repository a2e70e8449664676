"""Request to analyse a recording: its clutter statistics and false alarms.

Importing this module loads nothing else: a help page needs it.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from seaglint.base.parameters import Parameter
from seaglint.studies.reading_requests import ReadingRequest, WeightsFile, filter_of, values_of

if TYPE_CHECKING:
    from seaglint.analysis import AnalysisOptions


@dataclass(frozen=True)
class AnalysisRequest(ReadingRequest):
    """Request to analyse a recording.

    ``mask``, ``kernel`` and ``signature`` are arrays or :class:`~seaglint.studies.reading_requests.WeightsFile`; filter and detectors are
    names, or objects of :mod:`seaglint.clutter.filters` and :mod:`seaglint.detection`.
    """

    mask: Annotated[
        Any,
        Parameter("image or .npy, not zero where the sea glints; instead of the segmentation", form="mask", detail="In Python an array."),
    ] = None
    rows: Annotated[
        tuple[float, float], Parameter("part of the rows to analyse", form="shares", detail="Shares of the height from the top [1].")
    ] = (
        0.0,
        1.0,
    )
    filter: Annotated[
        Any,
        Parameter(
            "laplacian, difference-of-gaussians, median-subtraction, top-hat, matched, none",
            form="name",
            subject="filter before the thresholds:",
        ),
    ] = "laplacian"
    kernel: Annotated[Any, Parameter("CSV or .npy of filter weights of your own, instead of `filter`", form="weights")] = None
    signature: Annotated[Any, Parameter("CSV or .npy of the target for `filter` matched", form="weights")] = None
    thresholds: Annotated[
        tuple[float, ...], Parameter("thresholds beside 3.0 and 3.5, in standard deviations; repeatable", option="--threshold")
    ] = ()
    scope: Annotated[
        Literal["frame", "sequence", "local"],
        Parameter("standard deviation of each 'frame', of the whole 'sequence', or 'local'", form="name", option="--sigma"),
    ] = "frame"
    detectors: Annotated[
        tuple[Any, ...],
        Parameter(
            "ca-cfar, os-cfar, os-cfar-exponential, frame-difference, integration, or package.module:function; repeatable",
            form="names",
            option="--detector",
            subject="detectors that are counted like the filter:",
        ),
    ] = ()
    border: Annotated[
        Literal["auto", "keep", "drop"],
        Parameter("'keep' or 'drop' filtered pixels that see repeated ones beyond the border; 'auto': keep in one image", form="name"),
    ] = "auto"
    seed: Annotated[int, Parameter("of the samples that are drawn", least=0)] = 0

    @property
    def files(self) -> list[Path]:
        """Files that are read beside the recording, which no result may replace."""
        return [given.path for given in (self.mask, self.kernel, self.signature) if isinstance(given, WeightsFile)]

    def options(self) -> AnalysisOptions:
        """Return the options of the analysis: filters and detectors from names, sequences as tuples, masks as plain arrays.

        Raises
        ------
        DataError
            A name that there is not, or a filter without its target.
        """
        from typing import get_args

        import numpy as np

        from seaglint.analysis import AnalysisOptions
        from seaglint.analysis.run import Border
        from seaglint.base.errors import DataError
        from seaglint.clutter.thresholds import Scope
        from seaglint.detection.named_detectors import named

        for name, value, allowed in (("scope", self.scope, get_args(Scope)), ("border", self.border, get_args(Border))):
            if value not in allowed:
                raise DataError(f"{name} = {value!r} is not one of {', '.join(allowed)}; give one of them or leave it out")
        by_name = isinstance(self.filter, str) or self.kernel is not None
        return AnalysisOptions(
            filter=filter_of(self.filter, self.kernel, self.signature) if by_name else self.filter,
            thresholds=tuple(self.thresholds),
            scope=self.scope,
            rows=(self.rows[0], self.rows[1]),
            mask=None if self.mask is None else np.asarray(values_of(self.mask), dtype=np.bool_),
            detectors=tuple(named(each) if isinstance(each, str) else each for each in self.detectors),
            seed=self.seed,
            border=self.border,
        )
