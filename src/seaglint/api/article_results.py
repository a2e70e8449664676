"""Functions ``sg.reproduce``: results of the source article, and comparisons with measured spectra."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Literal

from seaglint.api.inputs_and_results import ResultRecord

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from seaglint.base.conventions import Progress

__all__ = ["fig2", "fig3", "fig4", "fig5", "fig10", "fig12", "headline", "measured", "table1"]


def headline() -> ResultRecord:
    """Headline numbers of the article beside ours.

    Returns
    -------
    ResultRecord
        Value of the article, ours, unit and settings by name.

    Examples
    --------
    >>> import seaglint as sg
    >>> sg.reproduce.headline()["contrast_mwir"]["article"]
    0.42
    """
    from seaglint.studies.article.headline import headline as rows

    return ResultRecord({name: row.as_dict() for name, row in rows().items()}, title="headline numbers")


def fig2(*, progress: Progress | None = None) -> xr.Dataset:
    """Path and boundary properties against range and wind.

    Figure 2 of the article.

    Parameters
    ----------
    progress : callable, optional
        Called with (winds done, all of them).

    Returns
    -------
    xarray.Dataset
        The curves, with units.

    Examples
    --------
    >>> import seaglint as sg
    >>> dict(sg.reproduce.fig2().sizes)
    {'wind_speed_m_s': 5, 'slant_range_m': 120, 'zenith_deg': 61}
    """
    return _figure("fig2", progress)


def fig3(*, progress: Progress | None = None) -> xr.Dataset:
    """Mirrored Sun and apparent temperature against zenith angles.

    Figure 3 of the article.

    Parameters
    ----------
    progress : callable, optional
        Called with (winds done, all of them).

    Returns
    -------
    xarray.Dataset
        The curves, with units.

    Examples
    --------
    >>> import seaglint as sg
    >>> dict(sg.reproduce.fig3().sizes)
    {'wind_speed_m_s': 3, 'solar_zenith_deg': 31, 'sensor_zenith_deg': 140}
    """
    return _figure("fig3", progress)


def fig4(*, progress: Progress | None = None) -> xr.Dataset:
    """Glint images for winds: mean and standard deviation.

    Figure 4 of the article.

    Parameters
    ----------
    progress : callable, optional
        Called with (winds done, all of them).

    Returns
    -------
    xarray.Dataset
        The images, with units.

    Examples
    --------
    >>> import seaglint as sg
    >>> sg.reproduce.fig4().wind_speed_m_s.size
    3
    """
    return _figure("fig4", progress)


def fig5(*, weather: str | Path | None = None, spectral: bool = False, progress: Progress | None = None) -> xr.Dataset:
    """Chance of glint against the azimuth from the Sun.

    Figure 5 of the article; it takes a minute.

    Parameters
    ----------
    weather : path, optional
        Weather table instead of the packaged North Atlantic.
    spectral : bool
        Radiance per wavenumber instead of the article's band means.
    progress : callable, optional
        Called with (azimuths done, all of them).

    Returns
    -------
    xarray.Dataset
        Columns of both panels over ``row``; attributes ``brightest`` [W m-2 sr-1] and ``printed`` [1], the largest chance of the printed
        threshold.

    Raises
    ------
    SeaglintError
        A weather table that cannot be read.

    Examples
    --------
    >>> import seaglint as sg
    >>> sg.reproduce.fig5()  # doctest: +SKIP
    """
    import xarray as xr

    from seaglint.studies.article.figures_5_and_12 import figure_5

    table = None if weather is None else Path(weather)
    result = figure_5(table, mode="spectral" if spectral else "article", report=progress)
    columns = {name: ("row", values) for name, values in result.columns.items()}
    return xr.Dataset(columns, attrs={"brightest": result.brightest, "printed": result.printed})


def fig10(*, progress: Progress | None = None) -> xr.Dataset:
    """Autobinomial textures, isotropic and horizontal.

    Figure 10 of the article.

    Parameters
    ----------
    progress : callable, optional
        Called with (textures done, all of them).

    Returns
    -------
    xarray.Dataset
        Pictures, couplings and their errors.

    Examples
    --------
    >>> import seaglint as sg
    >>> sg.reproduce.fig10()  # doctest: +SKIP
    """
    return _figure("fig10", progress)


def fig12(
    output: str | Path,
    *,
    frames: range | None = None,
    pixels: int | None = None,
    resume: bool = False,
    overwrite: bool = False,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Two bodies that close over a glinting sea.

    The sequence of Figure 12 of the article; it takes some minutes.

    Parameters
    ----------
    output : path
        Zarr store to make.
    frames : range, optional
        Frames to render; all 100 by default.
    pixels : int, optional
        Pixels along each side, 16 to 512; fewer for a quick look.
    resume : bool
        Continue an unfinished sequence.
    overwrite : bool
        Replace a store that is there.
    progress : callable, optional
        Called with (frames done, frames in all).

    Returns
    -------
    xarray.Dataset
        The sequence; :func:`sg.labels` gives the labels of both bodies.

    Raises
    ------
    SeaglintError
        Frames or pixels outside their ranges, or a store that is there or cannot be made.

    Examples
    --------
    >>> import seaglint as sg, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     seen = sg.reproduce.fig12(f"{folder}/f.zarr", frames=range(60, 61), pixels=16)
    ...     seen.radiance.shape
    (1, 16, 16)
    """
    from seaglint.api.inputs_and_results import with_band
    from seaglint.store.sequence_store import open_sequence
    from seaglint.studies.article import figures_5_and_12 as engagement

    size = engagement.PIXELS if pixels is None else pixels
    engagement.sequence(output, frames, size, resume=resume, overwrite=overwrite, progress=progress)
    return with_band(open_sequence(output))


def table1(*, progress: Progress | None = None) -> ResultRecord:
    """Table 1 of the article, of false alarms, beside ours.

    It renders two seconds of glint, twice: some ten minutes on two cores.

    Parameters
    ----------
    progress : callable, optional
        Called with (frames done, frames in all).

    Returns
    -------
    ResultRecord
        ``rows`` with the value of the article and ours (as rendered and through a detector, with sparkles by a correlation time and by the
        waves), ``settings`` and ``notes``.

    Examples
    --------
    >>> import seaglint as sg
    >>> sg.reproduce.table1()  # doctest: +SKIP
    """
    from seaglint.studies.article.table1 import table1 as computed

    result = computed() if progress is None else computed(progress)
    rows = {name: row.as_dict() for name, row in result.rows().items()}
    return ResultRecord({"rows": rows, "settings": result.settings(), "notes": list(result.analysis.notes)}, title="Table 1")


def measured(*, spectroscopy: Literal["lblrtm", "lowtran7", "both"] = "both") -> ResultRecord:
    """Measured spectra of sky and sea beside ours.

    Parameters
    ----------
    spectroscopy : str
        Absorption of the air: ``lblrtm``, ``lowtran7`` or ``both``.

    Returns
    -------
    ResultRecord
        ``rows``, a band of a measurement each; ``plot()`` draws the spectra.

    Raises
    ------
    SeaglintError
        Another spectroscopy.

    Examples
    --------
    >>> import seaglint as sg
    >>> row = sg.reproduce.measured(spectroscopy="lowtran7")["rows"][0]
    >>> row["case"], round(row["measured"], 1), round(row["ours"], 1), row["unit"]
    ('AERI, zenith sky, Oklahoma 2001', 267.0, 266.7, 'K')
    """
    from seaglint.studies.measured.against_measurements import against_measurements

    result = against_measurements(spectroscopy)

    def draw() -> Figure:
        from seaglint.plot.sensor_and_spectra import draw_beside

        return draw_beside(result.spectra)

    return ResultRecord({"rows": [row.as_dict() for row in result.rows]}, draw=draw, title="measured spectra")


def _figure(name: str, progress: Progress | None) -> xr.Dataset:
    """Compute a figure."""
    from seaglint.studies.article.figures import FIGURES, ignore_progress

    return FIGURES[name](progress or ignore_progress)
