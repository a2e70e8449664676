"""Function ``sg.detect``: a detector evaluated on a recording or in the scenes of a scenario."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

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


def detect(
    source: Scenario | xr.Dataset | xr.DataArray | NDArray[Any] | str | Path | Recording,
    contrast: float | Sequence[float] | None = None,
    *,
    detector: str = "threshold",
    filter: str = "none",
    threshold: float = 4.0,
    threshold_law: str = "sigma",
    injections: int = 1000,
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
    source : Scenario, dataset, array, path or Recording
        Frames without objects as for :func:`seaglint.api.analyze`, or a scenario, of which independent seas are rendered.
    contrast : float or sequence of float, optional
        Signal of an object in the pixel at whose centre it lies [units of the source]; of a scenario the in-band contrast at the aperture
        [W m-2 sr-1], and without it a sweep in standard deviations of its frames.
    detector, filter : str
        Names, or ``package.module:function`` of your own detector.
    threshold, threshold_law
        Threshold and its law, as on the command line.
    injections : int
        Objects of each contrast.
    object_sigma_px : float, optional
        Standard deviation of a Gaussian spot [px]; of a recording 0.8 where nothing is said.
    psf : array_like, optional
        Point spread instead, one value a pixel.
    objects : str
        Objects of a scenario: "point", "gaussian", or the name of one of its objects.
    frames : int
        Largest number of independent seas of a scenario.
    precision, time_budget : float, optional
        Limits for a scenario: half width of the interval of P_d that is enough [1]; longest time [s].
    design : bool
        Contrast of a scenario's object for P_d 0.9 at one false alarm per hour and field, or at ``p_fa``, and the loss against white noise.
    frame_rate, units, variable
        Properties of the recording, as for :func:`seaglint.api.analyze`.
    placement : {"random", "centre"}
        Places of the objects: anywhere within pixels, or at their centres.
    match_radius : float
        Largest distance of a detection from the object's pixel [px].
    velocity : (float, float)
        Motion of the objects down and to the right [px a frame].
    pointing : {"least-squares", "centroid"}
        Estimate of the place of a detection.
    duration : int
        Frames for which an object is there, up to the one judged; 0 for all that the detector sees.
    seed : int
        Seed of the places.
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
    from seaglint.base.errors import DataError
    from seaglint.clutter.filters import named as filter_named
    from seaglint.detection.spot import GaussianSpot, SampledSpot
    from seaglint.detection.trials import InjectedObjects
    from seaglint.scenario.model import Scenario
    from seaglint.studies.detect.performance import DetectionOptions
    from seaglint.studies.detect.performance import detect as judged

    if threshold_law not in ("sigma", "frame", "fixed", "design"):
        raise DataError(f"threshold_law = {threshold_law!r} is not one of sigma, frame, fixed, design; give one of them")
    if psf is not None and object_sigma_px is not None:
        raise DataError("`psf` and `object_sigma_px` are two shapes of one object; give one of them")
    shape = SampledSpot(psf) if psf is not None else GaussianSpot(0.8 if object_sigma_px is None else object_sigma_px)
    contrasts = None if contrast is None else tuple(float(c) for c in np.atleast_1d(np.asarray(contrast, float)))
    template = InjectedObjects(
        shape, contrasts or (1.0,), injections, placement, match_radius, velocity, pointing, seed=seed, duration=duration
    )
    law: Any = threshold_law
    options = DetectionOptions(template, detector, filter_named(filter), threshold, law)
    if not isinstance(source, Scenario):
        if contrasts is None:
            raise DataError("contrast is missing: what an object adds to its pixel, in the units of the frames; give e.g. contrast=4")
        opened = recording_of(source, frame_rate, units, variable)
        from dataclasses import replace

        result = judged(opened, replace(options, frame_rate=opened.frame_rate), name=opened.source, progress=progress)
        return Judgement(result.as_dict(), units=opened.units, frame_rate_hz=opened.frame_rate)
    from seaglint.files.detection_parts import parts_folder
    from seaglint.studies.detect.designer import Design
    from seaglint.studies.detect.injected import Strength
    from seaglint.studies.detect.rendered_seas import Clock, SceneOptions, run_scene

    own = shape if psf is not None or object_sigma_px is not None or objects == "gaussian" else None
    design_options = Design(p_fa=p_fa) if design or p_fa is not None else None
    strength = None if contrasts is None else Strength(contrasts)
    scene_options = SceneOptions(options, objects, strength, own, frames, precision, None, design_options)
    with parts_folder(None) as (parts, _):
        judged_scene = run_scene(source, scene_options, parts, clock=Clock(time_budget), name="scenario", progress=progress)
    return Judgement(judged_scene.result)
