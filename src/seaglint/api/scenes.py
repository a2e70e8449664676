"""Functions of one scene without files: ``sg.load``, ``sg.mean`` and ``sg.image``."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from seaglint.base.parameters import documented
from seaglint.studies.mean.mean_requests import MeanRequest

if TYPE_CHECKING:
    import xarray as xr

    from seaglint.api.inputs import SceneInput
    from seaglint.base.conventions import Progress
    from seaglint.scenario.model import Scenario


def load(source: str | Path | Mapping[str, Any]) -> Scenario:
    """Read and check a scenario.

    Parameters
    ----------
    source : path or mapping
        A TOML file, or its content as tables in a mapping.

    Returns
    -------
    Scenario
        Frozen; defaults filled in.

    Raises
    ------
    ScenarioError
        One line for each mistake.

    Examples
    --------
    >>> import seaglint as sg
    >>> round(sg.load({"sensor": {"height_m": "100 ft"}}).sensor.height_m, 2)
    30.48
    """
    from seaglint.scenario.load import load_scenario, parse_scenario

    return parse_scenario(source) if isinstance(source, Mapping) else load_scenario(source)


@documented(MeanRequest)
def mean(scenario: SceneInput, *, progress: Progress | None = None) -> xr.Dataset:
    """Map mean radiance and apparent temperature over the view.

    Parameters
    ----------
    {request}
    progress : callable, optional
        Called with (rows or pixels done, all of them).

    Returns
    -------
    xarray.Dataset
        Maps (y, x) with units, coordinates and provenance, as ``seaglint mean`` writes them; radiances [W m-2 sr-1].

    Raises
    ------
    SeaglintError
        A condition outside the models; see :mod:`seaglint.studies.prepare.prepare`.

    Examples
    --------
    >>> import seaglint as sg
    >>> found = sg.mean(sg.load({"sensor": {"pixels": [8, 4]}}))
    >>> found.radiance.dims, found.radiance.units
    (('y', 'x'), 'W m-2 sr-1')
    """
    from seaglint.api.inputs import scenario_of, with_band
    from seaglint.files.netcdf import labelled
    from seaglint.studies.mean.mean_map import mean as computed

    return with_band(labelled(computed(scenario_of(scenario), progress)))


def image(scenario: SceneInput, time: float = 0.0, layers: Collection[str] = ()) -> xr.Dataset:
    """Radiance at the aperture at one time, without a file; of a scenario with a detector too.

    It is sharp: optics and detector are left aside. :func:`frames` gives the counts that :func:`render` writes.

    Parameters
    ----------
    scenario : Scenario, path or mapping
        See :func:`load`; its ``render.layers``, optics and detector are left aside.
    time : float
        Time from the start [s]; any, frames are not more than instants.
    layers : collection of str
        Images to be there beside the radiance, of :data:`seaglint.base.schema.LAYERS`: the radiance's four parts, distance and slope of
        the sea, the share of a pixel that it fills, that of glint in the radiance, the number of the object in it.

    Returns
    -------
    xarray.Dataset
        ``radiance`` [W m-2 sr-1, (y, x)] and the layers, with units, coordinates and provenance. Of a scenario without a detector it is
        the frame that :func:`render` writes for this time.

    Raises
    ------
    SeaglintError
        A condition outside the models, a time outside the platform's track, or an unknown layer.

    Notes
    -----
    Each call prepares everything; for many times take :func:`seaglint.studies.sequence.render_sequence.prepare_sequence`, ``at(time)``.

    Examples
    --------
    >>> import seaglint as sg
    >>> scene = sg.load({"sensor": {"pixels": [8, 4]}, "sea": {"resolve_waves": False}})
    >>> found = sg.image(scene, time=0.5, layers=["range"])
    >>> found["range"].units, float(found.time)
    ('m', 0.5)
    """
    from seaglint.api.inputs import scenario_of, with_band
    from seaglint.files.netcdf import labelled
    from seaglint.studies.sequence.image import image as drawn

    return with_band(labelled(drawn(scenario_of(scenario), time, layers)))
