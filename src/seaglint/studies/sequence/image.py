"""A scenario becomes one labelled image."""

from __future__ import annotations

import math
from collections.abc import Collection
from typing import TYPE_CHECKING

import numpy as np

from seaglint.base.errors import DomainError
from seaglint.base.schema import VARIABLES
from seaglint.files.netcdf import plain_attributes
from seaglint.files.provenance import band_attributes
from seaglint.imaging.layers import require_layers
from seaglint.scenario.model import Scenario
from seaglint.studies.sequence.out_of_view import report_out_of_view
from seaglint.studies.sequence.render_sequence import poses, prepare_sequence

if TYPE_CHECKING:
    import xarray as xr


def image(scenario: Scenario, time: float = 0.0, layers: Collection[str] = ()) -> xr.Dataset:
    """Image of a scenario at a time, as a labelled dataset.

    Parameters
    ----------
    scenario : Scenario
        What to render; its ``render.layers`` are left aside.
    time : float
        Time from the start [s].
    layers : collection of str
        Of :data:`seaglint.base.schema.LAYERS`, to be there beside the radiance.

    Returns
    -------
    xarray.Dataset
        ``radiance`` [W m-2 sr-1, (y, x)] and the layers; ``azimuth`` and ``elevation`` of the pixels at that time as coordinates, and the
        place of a moving sensor.

    Raises
    ------
    DomainError
        A time that is not finite or outside the platform's track, or a layer that there is not.

    Examples
    --------
    >>> from seaglint.scenario.load import parse_scenario
    >>> small = parse_scenario({"sensor": {"pixels": [8, 4]}, "sea": {"resolve_waves": False}})
    >>> list(image(small, layers=["range"]).data_vars)
    ['radiance', 'range']
    """
    import xarray as xr

    if not math.isfinite(time):
        raise DomainError(f"time = {time:g} s is not finite; give seconds from the start")
    requested = require_layers([layers] if isinstance(layers, str) else layers)
    report_out_of_view(scenario, times=np.array([time]))
    settings = scenario.render.model_copy(update={"layers": requested, "apparent_temperature": False})
    run = prepare_sequence(scenario.model_copy(update={"render": settings}), range(1))
    layer_values = run.at(time)
    azimuth, elevation = run.scene_at(time).directions(run.track.at(time))
    whole = azimuth.ndim == 2
    place = {name: float(values[0]) for name, values in poses(run.track, np.array([time])).items()} if run.track.moves else {}
    return xr.Dataset(
        {name: (("y", "x"), layer_values[name].astype(VARIABLES[name].dtype, copy=False)) for name in ("radiance", *requested)},
        coords={
            "azimuth": (("y", "x") if whole else "x", np.degrees(azimuth)),
            "elevation": (("y", "x") if whole else "y", np.degrees(elevation)),
            "time": float(time),
            **place,
        },
        attrs=plain_attributes({**run.layout.attributes, "title": "Infrared image of the sea", **band_attributes(run.layout.band)}),
    )
