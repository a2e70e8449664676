"""Function ``sg.detect``: a detector evaluated on a recording or in the scenes of a scenario."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from seaglint.base.parameters import documented
from seaglint.studies.detect.requests import DesignRequest, RecordingRequest, SceneRequest, SpotRequest

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import ArrayLike, NDArray

    from seaglint.analysis import Recording
    from seaglint.base.conventions import Progress
    from seaglint.scenario.model import Scenario


class Judgement(dict[str, Any]):
    """Results of ``seaglint detect --json``; a notebook shows detection of each contrast, false alarms and notes."""

    def _repr_html_(self) -> str:
        from seaglint.studies.detect.performance import shown

        return shown(self, self["notes"])


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
) -> dict[str, Any]:
    """Probabilities of detection and false alarm, and errors of place, of a detector.

    Parameters
    ----------
    {request}
    design : bool
        Contrast of a scenario's object for P_d 0.9 at one false alarm per hour and field, or at ``p_fa``, and the loss against white noise.
    progress : callable, optional
        Called with (done, in all).

    Returns
    -------
    dict
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
    import numpy as np

    from seaglint.api.inputs import recording_of
    from seaglint.files.detection_parts import parts_folder
    from seaglint.scenario.model import Scenario
    from seaglint.studies.detect.performance import detect as judged
    from seaglint.studies.detect.recordings import judged_of
    from seaglint.studies.detect.rendered_seas import Clock, run_scene
    from seaglint.studies.detect.unstated import options_of

    request = SpotRequest(
        "scenario",
        detector,
        filter,
        threshold=threshold,
        threshold_law=threshold_law,
        injections=injections,
        placement=placement,
        match_radius=match_radius,
        velocity=velocity,
        duration=duration,
        pointing=pointing,
        seed=seed,
        contrast=None if contrast is None else tuple(float(c) for c in np.atleast_1d(np.asarray(contrast, float))),
        object_sigma_px=object_sigma_px,
        psf=psf,
    )
    if isinstance(source, Scenario):
        own: dict[str, Any] = {**vars(request), "objects": objects, "frames": frames, "precision": precision, "time_budget": time_budget}
        rendered = DesignRequest(**own, p_fa=p_fa) if design or p_fa is not None else SceneRequest(**own)
        with parts_folder(None) as (parts, _):
            done = run_scene(source, rendered.scene_options(), parts, clock=Clock(time_budget), name=rendered.source, progress=progress)
        return Judgement(done.result)
    opened = recording_of(source, frame_rate, units, variable)
    found = judged(opened, options_of(request, opened), name=opened.source, progress=progress)
    return Judgement(judged_of(found, opened).result)
