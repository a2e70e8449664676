"""Functions of recordings: ``sg.analyze`` and ``sg.apparent_temperature``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from seaglint.base.parameters import documented
from seaglint.studies.analysis_requests import AnalysisRequest

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import ArrayLike, NDArray

    from seaglint.analysis import Analysis, Recording
    from seaglint.base.conventions import Progress
    from seaglint.clutter.filters import Filter
    from seaglint.detection.interface import Detector
    from seaglint.files.recording import RawLayout
    from seaglint.optics.band import Band


@documented(AnalysisRequest)
def analyze(
    recording: xr.Dataset | xr.DataArray | NDArray[Any] | str | Path | Recording,
    *,
    frame_rate: float | None = None,
    units: str | None = None,
    variable: str | None = None,
    channel: str | None = None,
    axes: str | None = None,
    missing: Sequence[float] = (),
    saturation: float | None = None,
    raw: RawLayout | None = None,
    filter: str | Filter = "laplacian",
    kernel: ArrayLike | None = None,
    signature: ArrayLike | None = None,
    thresholds: Sequence[float] = (),
    scope: Literal["frame", "sequence", "local"] = "frame",
    rows: tuple[float, float] = (0.0, 1.0),
    mask: ArrayLike | None = None,
    border: Literal["auto", "keep", "drop"] = "auto",
    detectors: str | Detector | Sequence[str | Detector] = (),
    seed: int = 0,
    progress: Progress | None = None,
) -> Analysis:
    """Clutter statistics and false alarms of a recording, by region.

    Parameters
    ----------
    recording : xarray.Dataset, xarray.DataArray, ndarray, path or Recording
        What :func:`render` gives or a part of it, an array (rows, columns) or (frames, rows, columns), or a file of any format that
        :func:`seaglint.files.recording.open_recording` reads.
    {request}
    progress : callable, optional
        Called with (frames read, frames to read in all).

    Returns
    -------
    Analysis
        The regions' numbers, ``as_dict()`` of them for a file, and what :mod:`seaglint.plot.analysis_report` writes a report of.

    Raises
    ------
    DataError
        A filter, detector or word that there is not, or a recording that holds no images or nothing finite.

    Examples
    --------
    >>> import numpy as np, seaglint as sg
    >>> frames = np.random.default_rng(1).normal(1.0, 0.1, (20, 32, 32))
    >>> found = sg.analyze(frames, frame_rate=25.0, thresholds=[4.0], filter="none")
    >>> round(found.regions["all"].moments.std, 2)
    0.1
    """
    from seaglint.analysis import analyze as analysed
    from seaglint.api.inputs import recording_of, request_of

    several = tuple(detectors) if isinstance(detectors, list | tuple) else (detectors,)
    request = request_of(AnalysisRequest, locals(), thresholds=tuple(thresholds), detectors=several, missing=tuple(missing))
    resolved = request.options()
    opened = recording_of(recording, request)
    return analysed(opened, resolved) if progress is None else analysed(opened, resolved, progress)


def apparent_temperature(radiance: xr.Dataset | xr.DataArray | ArrayLike, band: Band | tuple[float, float] | None = None) -> xr.DataArray:
    """Temperature of the blackbody whose radiance in the band is that of each pixel.

    Parameters
    ----------
    radiance : xarray.Dataset, xarray.DataArray or array_like
        In-band radiance [W m-2 sr-1], or a dataset that holds it as ``radiance``, or counts as ``signal``.
    band : Band or (float, float), optional
        Spectral band that it is integrated over, or the edges of a rectangular one [um]; what the attributes say by default.

    Returns
    -------
    xarray.DataArray
        Kelvin, same shape, coordinates and other attributes; NaN for radiances of no temperature between 100 and 6500 K.

    Raises
    ------
    DataError
        No band given, and none in the attributes.

    Examples
    --------
    >>> import seaglint as sg
    >>> round(float(sg.apparent_temperature(1.45, band=(3.0, 5.0))), 1)
    293.2
    """
    from seaglint.api.inputs import kelvin_of

    return kelvin_of(radiance, band)
