"""Picture of a sweep: lines over one key, an image over two."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from seaglint.base.errors import DataError
from seaglint.base.schema import VARIABLES
from seaglint.plot.figures_and_pages import new_figure, save_figure

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Variables that a picture shows, in order of preference; without any of them the first variable with numbers is shown.
SHOWN: Final = ("apparent_temperature", "radiance", "transmittance", "netd_k", "probability")

MOST_LINES: Final = 8  #: Largest number of lines in a panel; of more values, this many are chosen evenly.

MOST_PANELS: Final = 4  #: Largest number of panels, chosen likewise.


def shown(dataset: xr.Dataset) -> str:
    """Return the name of the variable that a picture shows.

    Raises
    ------
    DataError
        No variable has numbers.
    """
    numeric = [str(name) for name, values in dataset.data_vars.items() if values.dtype.kind in "iuf"]
    if not numeric:
        raise DataError("the sweep has no variable with numbers; there is nothing to draw")
    return next((name for name in SHOWN if name in numeric), numeric[0])


def draw_sweep(dataset: xr.Dataset) -> Figure:
    """Return the figure of a sweep.

    One dimension gives a line, two dimensions with numbers an image with a scale; further dimensions become lines or panels, one for each
    value. Pictures are represented by the mean of their pixels.

    Raises
    ------
    DataError
        The sweep has no variable with numbers, or no finite value.
    """
    name = shown(dataset)
    values = dataset[name].astype(np.float64)
    pixels = [dim for dim in ("y", "x") if dim in values.dims]
    title = _label(values, name)
    if pixels:
        values, title = values.mean(pixels), f"{title}, mean of the picture"
    if not np.isfinite(values.values).any():
        raise DataError(f"{name} has no finite value; there is nothing to draw")
    wide = [str(dim) for dim in values.dims if values.sizes[dim] > 1]
    values = values.squeeze([dim for dim in values.dims if values.sizes[dim] == 1])
    numbers = [dim for dim in wide if _is_numeric(dataset, dim)]
    # Up to three values are easier to read as lines than as rows of an image.
    flat = len(wide) == 2 and len(numbers) == 2 and min(values.sizes[dim] for dim in wide) > 3
    across = [] if flat else wide[:-2]  # view angles come last and remain for the axes
    panels = _panel_positions(values, across)
    figure = new_figure(6.5 * min(len(panels), 2), 4.6 * ((len(panels) + 1) // 2))
    grid = figure.subplots((len(panels) + 1) // 2, min(len(panels), 2), squeeze=False).ravel()
    for axes, place in zip(grid, panels, strict=False):
        part = values.isel(place)
        if flat:
            _image(figure, axes, dataset, part, title)
        else:
            _lines(axes, dataset, part, title)
        axes.set_title(_values_text(dataset, place), fontsize=9)
    for axes in grid[len(panels) :]:
        axes.set_axis_off()
    fixed = {str(dim): 0 for dim in dataset[name].dims if dim not in wide and dim not in pixels}
    figure.suptitle(", ".join(part for part in (str(dataset.attrs.get("title", "")), _values_text(dataset, fixed)) if part), fontsize=10)
    return figure


def _is_numeric(dataset: xr.Dataset, dim: str) -> bool:
    return dim in dataset.coords and dataset[dim].dtype.kind in "iuf"


def _label(values: xr.DataArray, name: str) -> str:
    if name in VARIABLES:
        return VARIABLES[name].label
    units = values.attrs.get("units", "")
    return f"{values.attrs.get('long_name', name)}" + (f" [{units}]" if units and units != "1" else "")


def _axis(dataset: xr.Dataset, dim: str) -> str:
    units = dataset[dim].attrs.get("units", "") if dim in dataset.coords else ""
    return f"{dim} [{units}]" if units and units != "1" else dim


def _value(dataset: xr.Dataset, dim: str, place: int) -> str:
    if dim not in dataset.coords:
        return str(place)
    value = dataset[dim].values[place]
    return f"{value:g}" if dataset[dim].dtype.kind in "iuf" else str(value)


def _values_text(dataset: xr.Dataset, place: dict[str, int]) -> str:
    return ", ".join(f"{dim} = {_value(dataset, dim, at)}" for dim, at in place.items())


def _evenly(size: int, most: int) -> list[int]:
    # Rounded positions may coincide; a set keeps each once.
    return sorted({round(float(at)) for at in np.linspace(0, size - 1, min(size, most))})


def _panel_positions(values: xr.DataArray, dims: list[str]) -> list[dict[str, int]]:
    """Return the positions along further dimensions that get a panel."""
    shape = tuple(values.sizes[dim] for dim in dims)
    chosen = _evenly(int(np.prod(shape, dtype=int)), MOST_PANELS) if dims else [0]
    return [dict(zip(dims, map(int, np.unravel_index(at, shape)), strict=True)) if dims else {} for at in chosen]


def _horizontal(dataset: xr.Dataset, part: xr.DataArray) -> str | None:
    """Return the dimension along the horizontal axis: a view angle, otherwise the longest dimension with numbers."""
    dims = [str(dim) for dim in part.dims]
    numeric = [dim for dim in dims if _is_numeric(dataset, dim)] or dims
    angle = [dim for dim in numeric if dim.startswith("view_")]
    return angle[0] if angle else max(numeric, key=lambda dim: part.sizes[dim]) if numeric else None


def _lines(axes: Axes, dataset: xr.Dataset, part: xr.DataArray, title: str) -> None:
    """Draw lines over one dimension, one for each value of the other."""
    along = _horizontal(dataset, part)
    axes.set_ylabel(title, fontsize=9)
    if along is None:
        axes.plot([0.0], [float(part)], "o")
        return
    rest = [str(dim) for dim in part.dims if dim != along]
    part = part.sortby(along) if _is_numeric(dataset, along) else part
    x: Any = part[along].values if along in dataset.coords else np.arange(part.sizes[along])
    x = x if x.dtype.kind in "iufM" else [str(value) for value in x]
    for at in _evenly(part.sizes[rest[0]], MOST_LINES) if rest else [None]:
        y = part if at is None else part.isel({rest[0]: at})
        axes.plot(x, y.values, marker="." if len(x) < 40 else None, label=None if at is None else _value(dataset, rest[0], at))
    if rest:
        axes.legend(title=_axis(dataset, rest[0]), fontsize=7, title_fontsize=8)
    axes.set_xlabel(_axis(dataset, along))
    axes.grid(alpha=0.3)


def _image(figure: Figure, axes: Axes, dataset: xr.Dataset, part: xr.DataArray, title: str) -> None:
    """Draw values over two dimensions, with a scale."""
    down, across = (str(dim) for dim in part.dims)
    order = part.sortby([down, across])
    drawn = axes.pcolormesh(order[across].values, order[down].values, order.values, shading="nearest", cmap="inferno")
    axes.set_xlabel(_axis(dataset, across))
    axes.set_ylabel(_axis(dataset, down))
    figure.colorbar(drawn, ax=axes).set_label(title, fontsize=9)


def write_sweep(dataset: xr.Dataset, output: Path) -> Path:
    """Write the picture as PNG.

    Raises
    ------
    StorageError
        No room or no rights; nothing is left behind.
    """
    return save_figure(draw_sweep(dataset), output, 130, format="png")
