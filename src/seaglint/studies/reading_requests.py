"""Parts of requests that several commands share: how a recording is read, and how work is run.

Importing this module loads nothing else: a help page needs it.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

from seaglint.base.parameters import Parameter

if TYPE_CHECKING:
    from seaglint.analysis import Recording
    from seaglint.clutter.filters import Filter


Overwrite = Annotated[bool, Parameter("replace what stands at the output", "Run")]  #: Whether files that are there already are replaced.


class WeightsFile(NamedTuple):
    """Numbers of a small file, with its place; ``values`` may be a function that reads them when they are needed."""

    path: Path
    values: Any


def values_of(given: Any) -> Any:
    """Return the numbers of a file or an array."""
    if not isinstance(given, WeightsFile):
        return given
    return given.values() if callable(given.values) else given.values


def filter_of(name: str, kernel: Any, signature: Any) -> Filter:
    """Return a filter by its name, or one of the user's own weights or target; both are arrays or :class:`WeightsFile`.

    Raises
    ------
    DataError
        A matched filter without its target, or an unknown name.
    """
    from seaglint.base.errors import DataError
    from seaglint.clutter.filters import Kernel, MatchedFilter, named

    if kernel is not None:
        return Kernel(values_of(kernel), name=kernel.path.stem if isinstance(kernel, WeightsFile) else "kernel")
    if name == "matched":
        if signature is None:
            raise DataError(
                "filter = matched needs the target's signature: give signature=ARRAY, or a file (CSV or .npy); or another filter"
            )
        return MatchedFilter(values_of(signature))
    return named(name)


@dataclass(frozen=True)
class ReadingRequest:
    """Parameters of a recording: what its file does not say, or says wrong."""

    frame_rate: Annotated[float | None, Parameter("frames per second, where the file does not say [Hz]", "Recording")] = None
    units: Annotated[str | None, Parameter("units of the values, where the file does not say", "Recording")] = None
    variable: Annotated[str | None, Parameter("which array of a file that holds several", "Recording")] = None
    channel: Annotated[
        str | None, Parameter("mean, red, green or blue of true colour images, or the number of a channel from 1", "Recording")
    ] = None
    axes: Annotated[
        str | None,
        Parameter("order of an array's axes: t time, y rows, x columns, c channels; tyx is the default, yxt has time last", "Recording"),
    ] = None
    missing: Annotated[
        tuple[float, ...], Parameter("stored number that is a missing value, besides those that the file states; repeatable", "Recording")
    ] = ()
    saturation: Annotated[float | None, Parameter("value from which on the sensor is saturated", "Recording")] = None
    raw: Annotated[
        Any,
        Parameter("layout of a raw file, e.g. rows=512,columns=640,dtype=uint16,offset=0,frame_header=0", "Recording", "raw"),
    ] = None

    def opened(self, path: str | Path) -> Recording:
        """Return the recording of a file, read so."""
        from seaglint.files.recording import open_recording

        return open_recording(
            path,
            frame_rate=self.frame_rate,
            units=self.units,
            raw=self.raw,
            variable=self.variable,
            channel=self.channel,
            axes=self.axes,
            saturation=self.saturation,
            missing=self.missing,
        )


@dataclass(frozen=True)
class WorkRequest:
    """Parameters of how work is run: by whom, and over what is there."""

    threads: Annotated[
        int | None,
        Parameter("processor threads; default: all", "Run", least=1, detail="The bytes do not depend on them."),
    ] = None
    workers: Annotated[
        int | None,
        Parameter(
            "processes on this machine that share the work",
            "Run",
            metavar="N",
            least=1,
            detail="Or workers as :func:`seaglint.cluster.dask.connected` gives them.",
        ),
    ] = None
    resume: Annotated[bool, Parameter("go on with an unfinished sequence", "Run")] = False
    overwrite: Overwrite = False
