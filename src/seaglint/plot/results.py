"""What plots and the report read of an analysis. The pipeline's own classes have these attributes; plots do not import the pipeline."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from seaglint.clutter.correlation import SpatialCorrelation, TemporalCorrelation
from seaglint.clutter.extremes import TailFit
from seaglint.clutter.false_alarms import FalseAlarms
from seaglint.clutter.filters import Filter
from seaglint.clutter.fits import Fit
from seaglint.clutter.goodness import Goodness
from seaglint.clutter.segmentation import Segmentation
from seaglint.clutter.spectrum import Spectrum
from seaglint.detection.base import Detector
from seaglint.io.recording import Recording

BoolArray = NDArray[np.bool_]
FrameArray = NDArray[np.float32]


class Region(Protocol):
    """Statistics of one region."""

    @property
    def mask(self) -> BoolArray:
        """Its pixels, shape (rows, columns)."""
        ...

    @property
    def sample(self) -> NDArray[np.float64]:
        """Values that were fitted."""
        ...

    @property
    def fits(self) -> Mapping[str, Fit]:
        """By family."""
        ...

    @property
    def goodness(self) -> Mapping[str, Goodness]:
        """By family, of valid fits."""
        ...

    @property
    def spatial(self) -> SpatialCorrelation:
        """Along the picture's axes."""
        ...

    @property
    def temporal(self) -> TemporalCorrelation:
        """Of each pixel with itself later."""
        ...

    @property
    def spectrum(self) -> Spectrum | None:
        """None for pictures that are too small."""
        ...

    @property
    def alarms(self) -> Mapping[str, FalseAlarms]:
        """By filter or detector, the filter first."""
        ...

    def tail(self, name: str) -> tuple[TailFit | None, str | None]:
        """Extreme-value tail of a filter or detector, or why there is none."""
        ...


class Options(Protocol):
    """How it was analysed."""

    @property
    def filter(self) -> Filter:
        """Before thresholds."""
        ...

    @property
    def scope(self) -> str:
        """Whose standard deviation."""
        ...

    @property
    def thresholds(self) -> Sequence[float]:
        """Asked for beside 3.0 and 3.5 [standard deviations]."""
        ...

    @property
    def rows(self) -> tuple[float, float]:
        """Part of the rows, as shares of the height."""
        ...

    @property
    def mask(self) -> BoolArray | None:
        """Glinting pixels as given."""
        ...

    @property
    def detectors(self) -> Sequence[Detector]:
        """Judged beside the filter."""
        ...

    @property
    def seed(self) -> int:
        """Of everything that was sampled."""
        ...


class Slices(Protocol):
    """A row and a column in time: raw, filtered, above 3 standard deviations."""

    @property
    def row(self) -> int:
        """[px]."""
        ...

    @property
    def column(self) -> int:
        """[px]."""
        ...

    @property
    def along_row(self) -> tuple[FrameArray, FrameArray, BoolArray]:
        """Each of shape (frames, columns)."""
        ...

    @property
    def along_column(self) -> tuple[FrameArray, FrameArray, BoolArray]:
        """Each of shape (frames, rows)."""
        ...


class Analysis(Protocol):
    """All results of a recording, as :class:`seaglint.pipeline.analysis.Analysis` has them."""

    @property
    def recording(self) -> Recording:
        """What was analysed."""
        ...

    @property
    def options(self) -> Options:
        """How."""
        ...

    @property
    def segmentation(self) -> Segmentation | None:
        """None where a mask was given."""
        ...

    @property
    def image(self) -> NDArray[np.float64]:
        """Mean in time, shape (rows, columns)."""
        ...

    @property
    def regions(self) -> Mapping[str, Region]:
        """``all`` and, where found, ``glint`` and ``background``."""
        ...

    @property
    def slices(self) -> Slices:
        """A row and a column in time."""
        ...

    @property
    def notes(self) -> Sequence[str]:
        """Sentences that belong on top."""
        ...

    def as_dict(self) -> dict[str, Any]:
        """Plain numbers and text of all results."""
        ...
