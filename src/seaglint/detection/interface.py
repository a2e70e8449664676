"""Interface of a detector, its use on streams, and detectors from a user's own function.

A detector is called with frames of shape (k, rows, columns) and returns a statistic for the frames from ``lead`` on, shape
(k - lead, rows, columns): large where a target is likely, NaN where no statistic is defined. A ``calibrated`` detector returns equivalent
standard deviations: the probability of a false alarm above m is the Gaussian tail Q(m) on the clutter for which it is designed, and this
property is evaluated. The statistic of any other detector is divided by its measured sigma first
(:func:`seaglint.clutter.thresholds.standardise`).

Objects share a frame where their statistics do not disturb each other: ``reach`` is the distance up to which a detector uses pixels around
a pixel. A ``linear`` detector gives the sum of the statistics of two sequences for their sum, so that clutter and objects may pass through
it separately.

Recordings have missing pixels: dead lines and pixels, even rows of sky, NaN. A user's function gets whole frames (``filled``), as few
functions are made for NaN and a median or mean over a frame would be lost for all of it; its statistic is masked where a value is missing.
With an attribute ``takes_nan = True`` the function gets NaN instead.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import DataError

Frames = NDArray[np.float32]

#: Distribution of a calibrated statistic on the clutter it is designed for.
GAUSSIAN_TAIL: Final = "equivalent standard deviations: exceeds m with probability Q(m)"


@runtime_checkable
class Detector(Protocol):
    """Interface of a detector for false-alarm counting."""

    @property
    def name(self) -> str:
        """Short name as in the results."""
        ...

    @property
    def lead(self) -> int:
        """Number of earlier frames that the statistic of a frame needs [frames]; 0 works on single images."""
        ...

    @property
    def calibrated(self) -> bool:
        """True if the statistic is in equivalent standard deviations."""
        ...

    @property
    def reach(self) -> int | None:
        """Distance in rows and columns up to which other pixels affect a pixel's statistic [px]. None where that may be the whole frame."""
        ...

    @property
    def linear(self) -> bool:
        """True if the statistic of a sum of sequences is the sum of their statistics."""
        ...

    @property
    def null_law(self) -> str | None:
        """Distribution of the statistic on clutter without objects, and the kind of clutter; None where no law is stated."""
        ...

    def __call__(self, frames: Frames) -> Frames:
        """Statistic of the frames from ``lead`` on, shape (k - lead, rows, columns) [1]."""
        ...


def filled(frames: Frames) -> Frames:
    """Return frames whose missing values are replaced by the nearest valid pixel of the same frame.

    Filters repeat the nearest pixel beyond the border in the same way, so that no edge appears where a line is dead. A frame without any
    value takes the mean of the others, or 0 without other values.

    Parameters
    ----------
    frames : ndarray, shape (k, rows, columns)
        NaN or infinite where missing.

    Returns
    -------
    ndarray, shape (k, rows, columns)
        A copy, finite.

    Examples
    --------
    >>> filled(np.array([[[np.nan, 2.0, np.nan, np.nan, 5.0]]], np.float32)).ravel().tolist()
    [2.0, 2.0, 2.0, 5.0, 5.0]
    """
    from scipy.ndimage import distance_transform_edt

    out = frames.copy()
    missing = ~np.isfinite(frames)
    whole = missing.all(axis=(1, 2))
    if whole.any():
        out[whole] = frames[~missing].mean(dtype=np.float64) if not whole.all() else 0.0
    nearest: tuple[NDArray[Any], ...] = ()
    for k in np.flatnonzero(missing.any(axis=(1, 2)) & ~whole):
        # Dead lines are the same in every frame: their neighbours are searched once.
        if not nearest or not np.array_equal(missing[k], missing[k - 1]):
            nearest = tuple(distance_transform_edt(missing[k], return_distances=False, return_indices=True))
        out[k] = out[k][nearest]
    return out


def statistics(detector: Detector, blocks: Iterable[Frames]) -> Iterator[Frames]:
    """Iterate over the statistic of a sequence in blocks, equal to the statistic of the whole; the first ``lead`` frames give none.

    Raises
    ------
    DataError
        The sequence is not longer than the detector's lead.
    """
    # The last ``lead`` frames of a block are repeated before the next one.
    earlier: Frames | None = None
    given, received = 0, 0
    for block in blocks:
        frames = block if earlier is None else np.concatenate([earlier, block])
        received += block.shape[0]
        if frames.shape[0] > detector.lead:
            statistic = detector(frames)
            given += statistic.shape[0]
            yield statistic
        earlier = frames[frames.shape[0] - min(detector.lead, frames.shape[0]) :] if detector.lead else None
    if given == 0:
        raise DataError(f"detector {detector.name} needs {detector.lead + 1} frames; the sequence has {received}")


@dataclass(frozen=True)
class UserDetector:
    """Detector from a user's function; its results are checked at every call."""

    function: Callable[[Frames], Any]  #: Frames (k, rows, columns), float32, to an array (k - lead, rows, columns) of numbers.
    name: str  #: Name in the results.
    lead: int = 0  #: Earlier frames needed [frames].
    calibrated: bool = False  #: Whether the statistic is in equivalent standard deviations.
    takes_nan: bool = False  #: Whether the function gets NaN where values are missing, rather than frames filled by ``filled``.
    reach: int | None = None  #: Pixels around a pixel on which its statistic depends [px]; the whole frame by default.
    linear: bool = field(default=False, init=False)

    @property
    def null_law(self) -> str | None:
        """Distribution of equivalent standard deviations where the function declares them."""
        return GAUSSIAN_TAIL if self.calibrated else None

    def __call__(self, frames: Frames) -> Frames:
        """Statistic of the frames from ``lead`` on, shape (k - lead, rows, columns) [1].

        NaN where the pixel is missing in its frame or in one of the ``lead`` before it, unless the function takes NaN.

        Raises
        ------
        DataError
            The function fails, or its result is not an array of numbers of that shape.
        """
        # A copy: a function that works in place must not change the frames of the next detector.
        whole = frames.copy() if self.takes_nan else filled(frames)
        try:
            result = self.function(whole)
        except Exception as error:
            raise DataError(f"detector {self.name} failed on frames of shape {frames.shape}: {_error_line(error)}") from error
        expected = (frames.shape[0] - self.lead, *frames.shape[1:])
        try:
            # Conversion to real numbers would drop the imaginary part with a mere warning.
            if np.iscomplexobj(result):
                raise TypeError("no order among complex numbers")
            out = np.asarray(result, np.float32)
        except (TypeError, ValueError) as error:
            raise DataError(
                f"detector {self.name} returned {type(result).__name__}; an array of real numbers of shape {expected} is needed"
            ) from error
        if out.shape != expected:
            raise DataError(
                f"detector {self.name} returned shape {out.shape} for frames of shape {frames.shape}; {expected} is needed "
                f"(set the function's attribute lead, now {self.lead}, if it uses earlier frames)"
            )
        return out if self.takes_nan else self._only_known(out, frames)

    def _only_known(self, statistic: Frames, frames: Frames) -> Frames:
        """Statistic with NaN where the function used filled values of the same pixel."""
        missing = ~np.isfinite(frames)
        if not missing.any():
            return statistic
        unknown = missing[self.lead :].copy()
        for back in range(1, self.lead + 1):
            unknown |= missing[self.lead - back : frames.shape[0] - back]
        return np.where(unknown, np.float32(np.nan), statistic)


def _error_line(error: Exception) -> str:
    """Kind and text of a user's error, in one line."""
    return " ".join(f"{type(error).__name__}: {error}".split())


def load(path: str) -> Detector:
    """Load the detector ``package.module:attribute``; the current folder is searched as well.

    The attribute is a function of frames, which may carry attributes ``lead``, ``calibrated``, ``takes_nan`` and ``reach``, or an object
    with the interface of :class:`Detector`, or a class of such objects that needs no arguments.

    Raises
    ------
    DataError
        A path without the form, a module that cannot be imported, or an attribute that is missing, fails or cannot be called.
    """
    module_name, _, attribute = path.partition(":")
    if not module_name or not attribute:
        raise DataError(f"detector {path!r} is not of the form package.module:function; give e.g. mine:detector")
    folder = str(Path.cwd())
    sys.path.insert(0, folder)
    try:
        module = importlib.import_module(module_name)
    except Exception as error:
        raise DataError(f"detector {path!r}: module {module_name} cannot be imported: {_error_line(error)}") from error
    finally:
        if folder in sys.path:
            sys.path.remove(folder)
    if not hasattr(module, attribute):
        raise DataError(f"detector {path!r}: module {module_name} has no {attribute}; check the name after the colon")
    detector = getattr(module, attribute)
    if isinstance(detector, type):
        try:
            detector = detector()
        except TypeError as error:
            raise DataError(f"detector {path!r}: the class needs arguments ({error}); give an instance of it in the module") from error
        except Exception as error:
            raise DataError(f"detector {path!r}: no instance of the class can be made: {_error_line(error)}") from error
    if not callable(detector):
        raise DataError(f"detector {path!r} is a {type(detector).__name__}, which cannot be called; name a function of frames")
    lead = getattr(detector, "lead", 0)
    if not isinstance(lead, int) or lead < 0:
        raise DataError(f"detector {path!r}: lead = {lead!r} is not a number of frames of 0 or more")
    reach = getattr(detector, "reach", None)
    if reach is not None and (not isinstance(reach, int) or reach < 0):
        raise DataError(f"detector {path!r}: reach = {reach!r} is not a number of pixels of 0 or more")
    # Wrapped also where it has the whole interface, so that its results are checked.
    calibrated, takes_nan = (bool(getattr(detector, flag, False)) for flag in ("calibrated", "takes_nan"))
    return UserDetector(detector, str(getattr(detector, "name", path)), lead, calibrated, takes_nan, reach)
