"""Functions of detectors: on a recording, or on whatever a detector is to be judged."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from seaglint.api.inputs import recording_of, request_of
from seaglint.api.judged_study import judged_record, numbers_of
from seaglint.api.result_record import ResultRecord
from seaglint.base.absent_numbers import absent_numbers
from seaglint.base.parameters import documented
from seaglint.studies.detect.requests import DesignRequest, RecordingRequest

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import ArrayLike, NDArray

    from seaglint.analysis import Recording
    from seaglint.base.conventions import Progress
    from seaglint.files.recording import RawLayout
    from seaglint.scenario.model import Scenario


@documented(RecordingRequest)
def detect_recording(
    source: xr.Dataset | xr.DataArray | NDArray[Any] | str | Path | Recording,
    *,
    detector: str | None = None,
    filter: str = "none",
    kernel: ArrayLike | None = None,
    signature: ArrayLike | None = None,
    threshold: float | None = None,
    threshold_law: Literal["sigma", "frame", "fixed", "design"] = "sigma",
    time_limit: float = 60.0,
    level: float = 0.95,
    injections: int = 2000,
    placement: Literal["random", "centre"] = "random",
    match_radius: float = 1.0,
    velocity: tuple[float, float] = (0.0, 0.0),
    duration: int = 0,
    pointing: Literal["least-squares", "centroid"] = "least-squares",
    seed: int = 0,
    contrast: float | Sequence[float] | None = None,
    object_sigma_px: float | None = None,
    psf: ArrayLike | None = None,
    frame_rate: float | None = None,
    units: str | None = None,
    variable: str | None = None,
    channel: str | None = None,
    axes: str | None = None,
    missing: Sequence[float] = (),
    saturation: float | None = None,
    raw: RawLayout | None = None,
    pixel_mrad: float | None = None,
    vary: Mapping[str, Sequence[Any]] | Sequence[str] = (),
    progress: Progress | None = None,
) -> ResultRecord:
    """Detection on a recording without objects.

    Parameters
    ----------
    {request}
    progress : callable, optional
        Called with (steps done, steps in all).

    Returns
    -------
    ResultRecord
        Values that ``seaglint detect recording --json`` prints; ``plot()`` draws the operating characteristic.

    Raises
    ------
    SeaglintError
        Frames that are too few, a detector that fails, numbers that are not allowed.

    Examples
    --------
    >>> import numpy as np, seaglint as sg
    >>> noise = np.random.default_rng(1).normal(10.0, 0.5, (8, 64, 64))
    >>> found = sg.detect_recording(noise, contrast=[1.0, 3.0], detector="matched", threshold=3.0, injections=200)
    >>> [entry["p_d"] > 0.9 for entry in found["sweep"]]
    [False, True]
    """
    from seaglint.studies.detect.recordings import run_recording, settings_of
    from seaglint.studies.detect.unstated import options_of

    request = request_of(RecordingRequest, locals(), source="recording", contrast=numbers_of(contrast), missing=tuple(missing), vary=None)
    opened = recording_of(source, request)
    pixel = None if pixel_mrad is None else _angle(pixel_mrad)
    with absent_numbers():
        study = run_recording(opened, options_of(request, opened, pixel), settings_of(vary), progress=progress)
    values = study.as_dict() if vary else study.good[0].done.result
    return judged_record(study, values, opened.units or "")


@documented(RecordingRequest, DesignRequest)
def detect(
    source: Scenario | xr.Dataset | xr.DataArray | NDArray[Any] | str | Path | Recording,
    contrast: float | Sequence[float] | None = None,
    *,
    detector: str | None = None,
    filter: str = "none",
    threshold: float | None = None,
    threshold_law: Literal["sigma", "frame", "fixed", "design"] = "sigma",
    injections: int = 2000,
    object_sigma_px: float | None = None,
    psf: ArrayLike | None = None,
    objects: str = "point",
    frames: int = 32,
    precision: float | None = None,
    time_budget: float | None = None,
    design: bool = False,
    p_fa: float | None = None,
    frame_rate: float | None = None,
    units: str | None = None,
    variable: str | None = None,
    placement: Literal["random", "centre"] = "random",
    match_radius: float = 1.0,
    velocity: tuple[float, float] = (0.0, 0.0),
    pointing: Literal["least-squares", "centroid"] = "least-squares",
    duration: int = 0,
    seed: int = 0,
    progress: Progress | None = None,
) -> ResultRecord:
    """Probabilities of detection and false alarm, and errors of place, of a detector: on a recording or in the scenes of a scenario.

    :func:`detect_recording`, :func:`detect_scene` and :func:`detect_design` have all parameters of each kind.

    Parameters
    ----------
    {request}
    design : bool
        Contrast of a scenario's object for P_d 0.9 at one false alarm per hour and field, or at ``p_fa``, and the loss against white noise.
    progress : callable, optional
        Called with (done, in all).

    Returns
    -------
    ResultRecord
        Values that ``seaglint detect --json`` prints. Notebooks show them as a table.

    Raises
    ------
    SeaglintError
        Frames that are too few, a detector that fails, numbers that are not allowed.

    Examples
    --------
    >>> import numpy as np, seaglint as sg
    >>> noise = np.random.default_rng(1).normal(10.0, 0.5, (8, 64, 64))
    >>> found = sg.detect(noise, [1.0, 3.0], detector="matched", threshold=3.0, injections=200)
    >>> [entry["p_d"] > 0.9 for entry in found["sweep"]]
    [False, True]
    """
    from seaglint.api.judging_scenes import detect_design, detect_scene
    from seaglint.scenario.model import Scenario

    given = dict(locals())
    if not isinstance(source, Scenario) and not (isinstance(source, str | Path) and Path(source).suffix.lower() == ".toml"):
        names = set(detect_recording.__kwdefaults__ or {}) & set(given)
        return detect_recording(source, **{name: given[name] for name in names})
    function = detect_design if design or p_fa is not None else detect_scene
    names = set(function.__kwdefaults__ or {}) & set(given)
    return function(source, **{name: given[name] for name in names})


def _angle(pixel_mrad: float) -> tuple[float, float]:
    """Return the angle of a pixel [mrad] between rows and between columns [deg]."""
    from math import degrees

    from seaglint.base.errors import DataError

    if not 0 < pixel_mrad < 1000:
        raise DataError(f"pixel_mrad = {pixel_mrad:g}: give an angle above 0 and below 1000 mrad")
    return (degrees(1e-3 * pixel_mrad),) * 2
