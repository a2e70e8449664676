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
import pickle
import sys
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, fields
from importlib.util import find_spec, module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType
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
    """Detector from a user's function; its results are checked at every call.

    It pickles by value, so that functions of a notebook, lambdas and closures reach other processes.
    """

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
            array = np.asarray(result)
            # Complex numbers would lose their imaginary part with a mere warning, and text may be read as numbers.
            if array.dtype.kind not in "biuf":
                raise TypeError("no real numbers")
            # A copy: a function may return the same array at each call.
            with np.errstate(over="ignore"):  # infinite where single precision ends
                out = np.array(array, np.float32)
        except Exception as error:  # arrays of other libraries may compute here, and fail in their own ways
            why = "" if isinstance(error, TypeError | ValueError) else f": {_error_line(error)}"
            raise DataError(
                f"detector {self.name} returned {_kind(result)}{why}; an array of real numbers of shape {expected} is needed"
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

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle by value.

        Raises
        ------
        DataError
            The function holds something that cannot be copied to another process.
        """
        given = tuple(getattr(self, one.name) for one in fields(self) if one.init)
        try:
            return _from_pickled, (pickled_by_value(given, self.function),)
        except Exception as error:
            raise DataError(
                f"detector {self.name} cannot be copied to another process: {_error_line(error)}; create what it holds inside the "
                "function, or write it in a file and give FILE.py:function, or give time_limit=math.inf without workers: it then runs here"
            ) from error


def pickled_by_value(value: Any, function: Any) -> bytes:
    """Pickle a value that holds a user's function; the function's module is included where other processes cannot import it."""
    import cloudpickle

    module = sys.modules.get(getattr(function, "__module__", None) or "")
    included = module is not None and module.__name__ != "__main__" and not _importable(module.__name__)
    if included:
        cloudpickle.register_pickle_by_value(module)
    try:
        content: bytes = cloudpickle.dumps(value)
    finally:
        if included:
            cloudpickle.unregister_pickle_by_value(module)
    return content


def _importable(module: str) -> bool:
    """Return whether a new process finds a module by its name."""
    try:
        return find_spec(module) is not None
    except (ImportError, ValueError):
        return False


def _from_pickled(content: bytes) -> UserDetector:
    return UserDetector(*pickle.loads(content))


def _kind(result: Any) -> str:
    """Return the type of a result, of an array with its numbers."""
    return f"an array of {result.dtype}" if isinstance(result, np.ndarray) else type(result).__name__


def _error_line(error: Exception) -> str:
    """Kind and text of a user's error, in one line."""
    return " ".join(f"{type(error).__name__}: {error}".split())


def load(path: str) -> UserDetector:
    """Load the detector ``package.module:attribute`` or ``FILE.py:attribute``; the current folder is searched as well.

    The attribute is as for ``user_detector``.

    Raises
    ------
    DataError
        A path without the form, a module that cannot be imported, or an attribute that is missing, fails or cannot be called.
    """
    place, _, attribute = path.rpartition(":")
    if not place or not attribute:
        raise DataError(f"detector {path!r} is not of the form package.module:function or FILE.py:function; give e.g. mine:detector")
    folders = [str(Path.cwd()), *([str(Path(place).absolute().parent)] if place.endswith(".py") else [])]
    sys.path[:0] = folders
    try:
        module = _module_of_file(place) if place.endswith(".py") else importlib.import_module(place)
    except Exception as error:
        raise DataError(f"detector {path!r}: module {place} cannot be imported: {_error_line(error)}") from error
    finally:
        for folder in folders:
            if folder in sys.path:
                sys.path.remove(folder)
    if not hasattr(module, attribute):
        raise DataError(f"detector {path!r}: module {place} has no {attribute}; check the name after the colon")
    return user_detector(getattr(module, attribute), f"detector {path!r}", path)


def _module_of_file(place: str) -> ModuleType:
    """Import a file of Python under the name of the file."""
    spec = spec_from_file_location(Path(place).stem, place)
    assert spec is not None and spec.loader is not None  # noqa: PT018  # a name with the ending .py has a loader
    module = module_from_spec(spec)
    # Classes of the file look their module up by its name; a module that is imported already keeps the name.
    sys.modules.setdefault(module.__name__, module)
    spec.loader.exec_module(module)
    return module


def user_detector(given: Any, described: str, name: str) -> UserDetector:
    """Return the detector of a function of frames, of an object that is called like it, or of a class of such objects.

    Functions and objects may have the attributes ``name``, ``lead``, ``calibrated``, ``takes_nan`` and ``reach``; an object may have the
    whole interface of :class:`Detector`.

    Parameters
    ----------
    given : callable or class
        A class needs no arguments.
    described : str
        Beginning of the errors.
    name : str
        Name in the results, unless the attribute ``name`` states another.

    Raises
    ------
    DataError
        An object that cannot be called, a class that cannot be made, or attributes that are not allowed.
    """
    if isinstance(given, type):
        try:
            given = given()
        except TypeError as error:
            raise DataError(f"{described}: the class needs arguments ({error}); give an instance of it instead") from error
        except Exception as error:
            raise DataError(f"{described}: no instance of the class can be made: {_error_line(error)}") from error
    if not callable(given):
        raise DataError(f"{described} is a {type(given).__name__}, which cannot be called; name a function of frames")
    source = getattr(given, "func", given)  # of a partial function

    def stated(attribute: str, default: Any) -> Any:
        return getattr(given, attribute, getattr(source, attribute, default))

    lead = stated("lead", 0)
    if not isinstance(lead, int) or lead < 0:
        raise DataError(f"{described}: lead = {lead!r} is not a number of frames of 0 or more")
    reach = stated("reach", None)
    if reach is not None and (not isinstance(reach, int) or reach < 0):
        raise DataError(f"{described}: reach = {reach!r} is not a number of pixels of 0 or more")
    # Wrapped also where it has the whole interface, so that its results are checked.
    calibrated, takes_nan = (bool(stated(flag, False)) for flag in ("calibrated", "takes_nan"))
    return UserDetector(given, str(stated("name", name)), lead, calibrated, takes_nan, reach)


def detector_of(given: Any) -> str | Detector | None:
    """Return a detector that was given in Python in one of its forms: a name or path, a function, an object or a class, or nothing.

    A detector of this package is returned unchanged.

    Raises
    ------
    DataError
        An object that is none of these.

    Examples
    --------
    >>> detector_of("matched"), detector_of(None), detector_of(lambda frames: frames).name
    ('matched', None, 'lambda')
    """
    if given is None or isinstance(given, str | UserDetector):
        return given
    if isinstance(given, Detector) and type(given).__module__.startswith("seaglint."):
        return given
    function = getattr(given, "func", given)  # of a partial function the name is that of its function
    name = str(getattr(function, "__name__", type(given).__name__)).strip("<>")
    if not callable(given):
        raise DataError(f"detector = {' '.join(repr(given).split())[:60]} cannot be called; give a name, FILE.py:function, or a function")
    return user_detector(given, f"detector {name}", name)
