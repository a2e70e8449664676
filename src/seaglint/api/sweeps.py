"""The function ``sg.sweep``: one quantity over every combination of values of a scenario's keys."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from seaglint.api.inputs import team_of
from seaglint.base.parameters import documented
from seaglint.studies.sweep.sweep_requests import MOST_CASES, SweepRequest

if TYPE_CHECKING:
    import xarray as xr

    from seaglint.base.conventions import Progress
    from seaglint.cluster import Workers
    from seaglint.scenario.model import Scenario


@documented(SweepRequest)
def sweep(
    scenario: Scenario | str | Path | Mapping[str, Any],
    vary: Mapping[str, Sequence[Any]],
    *,
    what: Literal["mean", "image", "sensor", "atmosphere", "likelihood"] | Callable[[Scenario], Any] = "mean",
    at: Mapping[str, Any] | None = None,
    workers: int | Workers | None = None,
    threads: int | None = None,
    keep_going: bool = False,
    most_cases: int = MOST_CASES,
    lazy: bool = False,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Compute one quantity over every combination of values of keys.

    Parameters
    ----------
    scenario : Scenario, path or mapping
        See :func:`load`; or a TOML file, or its content as tables in a mapping.
    {request}
    lazy : bool
        Compute a case when its values are read: arrays are those of Dask, with a piece for each case. The first case is computed at once.
    progress : callable, optional
        Called with (cases done, cases in all).

    Returns
    -------
    xarray.Dataset
        Dimensions are the swept keys by their names, with their values and units as coordinates, then those of ``at`` or of the picture.
        Of failed cases the attribute ``failed_cases`` states the number and ``failures`` the first reasons.

    Raises
    ------
    SeaglintError
        A key that does not exist, values of another unit, more cases than ``most_cases`` or than memory holds, or a case that fails.

    Notes
    -----
    What a key does not touch is prepared once: the air of a wind serves all Suns, for example.

    Examples
    --------
    >>> import seaglint as sg
    >>> winds = {"wind.speed_m_s": [5, "20 kn"], "sun.zenith_deg": [30, 60]}
    >>> seen = sg.sweep({"band": {"min_um": 8, "max_um": 12}}, winds, at={"view_zenith_deg": [0, 60]})
    >>> dict(seen.radiance.sizes)
    {'wind.speed_m_s': 2, 'sun.zenith_deg': 2, 'view_zenith_deg': 2}
    """
    from seaglint.studies.sweep.run_sweep import sweep as computed

    with team_of(workers, threads) as others:
        return computed(
            scenario,
            vary,
            what=what,
            at=at,
            workers=others,
            threads=threads if workers is None else None,
            keep_going=keep_going,
            most_cases=most_cases,
            lazy=lazy,
            progress=progress,
        )
