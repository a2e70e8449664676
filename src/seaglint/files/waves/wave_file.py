"""Content of a wave file: times, places, and the bands of each record, read on request."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError, SeaglintError
from seaglint.base.optional import optional
from seaglint.files.netcdf import drop_quietly
from seaglint.files.waves.bands import Bands


@dataclass(frozen=True, eq=False)
class Held:
    """Records of one file, read on request."""

    bands: Callable[[int, int], Bands]  #: ``bands(time, site)`` by index.
    times: NDArray[np.datetime64] | None = None  #: Time of every record, UTC; None where the file has none.
    sites: tuple[str, ...] = ("1",)  #: Names of the sites.
    #: ``latitude_deg``, ``longitude_deg``: Place of every record and site [deg, (times, sites)]; None where the file does not say.
    latitude_deg: FloatArray | None = None
    longitude_deg: FloatArray | None = None
    note: str | None = field(default=None, kw_only=True)  #: Sentence on the record that the user should know.


def reader(name: str) -> Callable[..., Any]:
    """Return a function of wavespectra.

    Raises
    ------
    BackendError
        If wavespectra is not installed.
    """
    function: Callable[..., Any] = getattr(optional("wavespectra", "reading of measured spectra"), name)
    return function


def parsed(path: Path, kind: str, parse: Callable[[], Any]) -> Any:
    """Return the result of a parser; its exceptions, which are of any type, become an error of one line.

    Libraries' warnings of what their own libraries will change are theirs to act on, and not shown.
    """
    try:
        with warnings.catch_warnings():
            for category in (DeprecationWarning, FutureWarning):
                warnings.simplefilter("ignore", category)
            return parse()
    except SeaglintError:
        raise
    except Exception as error:
        text = " ".join(str(error).split())[:200] or type(error).__name__
        drop_quietly(error)
        raise DataError(f"{path} cannot be read as {kind} ({text}); it may be cut or of another kind: see sea.spectrum.format") from error
