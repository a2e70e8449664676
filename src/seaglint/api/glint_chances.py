"""Function of the likelihood of glint: ``sg.likelihood``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from seaglint.api.inputs import scenario_of, team_of
from seaglint.api.result_record import ResultRecord
from seaglint.base.parameters import documented
from seaglint.studies.likelihood.likelihood_requests import LikelihoodRequest

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from seaglint.api.inputs import SceneInput
    from seaglint.base.conventions import Progress
    from seaglint.climate.likelihood_summary import LikelihoodSummary
    from seaglint.cluster import Workers


@documented(LikelihoodRequest)
def likelihood(
    scenario: SceneInput,
    *,
    by_month: bool = False,
    step: float = 1.0,
    track: str | Path | None = None,
    workers: int | Workers | None = None,
    progress: Progress | None = None,
) -> ResultRecord | xr.Dataset:
    """How often glint is brighter than thresholds.

    Parameters
    ----------
    scenario : Scenario, path or mapping
        Scenario with a table ``[likelihood]``.
    {request}
    workers : int or Workers, optional
        Processes on this machine that share the work of a map, or workers as :func:`seaglint.cluster.dask.connected` gives them.
    progress : callable, optional
        Called with (steps done, steps in all).

    Returns
    -------
    ResultRecord or xarray.Dataset
        Chances of the thresholds with their intervals and causes, ``plot()`` draws them; with ``by_month`` a map, ``probability`` [1] over
        ``threshold, month, latitude, longitude``; with ``track`` the chance of each threshold [1] over ``time`` along the way.

    Raises
    ------
    SeaglintError
        A scenario without ``[likelihood]`` or a region, or a file of a way that cannot be used.

    Examples
    --------
    >>> import seaglint as sg
    >>> chances = sg.likelihood({"likelihood": {"threshold_w_m2_sr": [1.0], "samples": 1024}})
    >>> 0.0 <= chances["results"][0]["probability"] <= 1.0
    True
    """
    from seaglint.base.errors import DataError

    loaded = scenario_of(scenario)
    if by_month and track is not None:
        raise DataError("by_month and track are both given: a map, or the way of a ship; give one of them")
    if by_month:
        from seaglint.studies.likelihood.chance_map import likelihood_map

        with team_of(workers) as team:
            return likelihood_map(loaded, step=step, progress=progress, workers=team)
    if track is not None:
        from seaglint.studies.likelihood.ship_track import along_track

        return along_track(loaded, Path(track)).dataset()
    from seaglint.studies.likelihood.glint_chance import likelihood as computed

    result = computed(loaded, progress=progress)
    summary = result.summary()

    def draw() -> Figure:
        from seaglint.plot.likelihood_charts import draw_charts

        return draw_charts(summary, result.month_by_hour())

    return ResultRecord(summary.as_dict(), draw=draw, html=lambda: _shown(summary), title="likelihood of glint")


def _shown(summary: LikelihoodSummary) -> str:
    """Return the table of a notebook: the chance of each threshold."""
    from seaglint.base.representation import card, notes, table

    rows = [(row.threshold_w_m2_sr, row.probability, row.interval, row.false_alarms_per_hour) for row in summary.results]
    head = ("threshold [W m-2 sr-1]", "probability", "95 % interval", "false alarms an hour")
    return card(f"{summary.case}: {summary.quantity}", table(head, rows) + notes(summary.notes))
