"""The class of the source article's Fig. 12: a frame in colours and in grey, and the geometry from the side."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Protocol

import numpy as np
from numpy.typing import NDArray

from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.conventions import FloatArray, horizon_depression
from seaglint.base.schema import VARIABLES
from seaglint.files.directions import directions
from seaglint.files.outputs import moved_when_whole
from seaglint.files.provenance import stored_band
from seaglint.files.sequence_summary import to_temperature
from seaglint.files.store.object_labels import Label
from seaglint.plot.new_figure import new_figure
from seaglint.plot.scale import scale_of

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Colours of the bodies in their order: the article's attacking one is red, the defending one green.
COLOURS: Final = ("tab:red", "tab:green", "tab:orange", "tab:purple")

_CLOSE: Final = 24  #: Pixels along each side of a close view.

_SECOND_MARKS: Final = 1.0  #: Time between marks on the ways [s].


class EngagementWays(Protocol):
    """Positions of sensor and bodies in the vertical plane of the line of sight, from :func:`seaglint.studies.article.fig12.ways`."""

    @property
    def time(self) -> FloatArray:
        """Times of the frames [s]."""
        ...

    @property
    def ahead(self) -> dict[str, FloatArray]:
        """Distance ahead of the sensor's start by name [m, (frames,)]; that of the sensor is ``"sensor"``."""
        ...

    @property
    def height(self) -> dict[str, FloatArray]:
        """Height above the mean sea by name [m, (frames,)]."""
        ...

    @property
    def sight(self) -> tuple[float, float]:
        """Elevations of the image's lower and upper edge [rad]."""
        ...


def draw(dataset: xr.Dataset, index: int, labels: list[Label], ways: EngagementWays) -> Figure:
    """One frame of the sequence beside its geometry.

    Parameters
    ----------
    dataset : xarray.Dataset
        The sequence.
    index : int
        Frame that is shown, of those stored.
    labels : list of Label
        Of the bodies in that frame.
    ways : EngagementWays
        Of sensor and bodies over the frames stored.
    """
    figure = new_figure(12.0, 9.5)
    panels = figure.subplot_mosaic([["colours", "grey"], ["side", "side"]], height_ratios=[1.9, 1.0])
    radiance = dataset["radiance"].isel(time=index).to_numpy()
    scale = scale_of(radiance, "linear")
    kelvin = to_temperature(np.maximum(radiance, 0.0), stored_band(dataset.attrs))
    limits = to_temperature(np.maximum([scale.low, scale.high], 0.0), stored_band(dataset.attrs))
    band = stored_band(dataset.attrs)
    extent = _extent(dataset)
    shown = panels["colours"].imshow(kelvin, cmap="turbo", vmin=limits[0], vmax=limits[1], extent=extent, interpolation="nearest")
    bar = figure.colorbar(shown, ax=panels["colours"], extend="both", location="bottom", shrink=0.8, pad=0.02)
    bar.set_label(VARIABLES["apparent_temperature"].label)
    shown = panels["grey"].imshow(radiance, cmap="gray", vmin=scale.low, vmax=scale.high, extent=extent, interpolation="nearest")
    bar = figure.colorbar(shown, ax=panels["grey"], extend="both", location="bottom", shrink=0.8, pad=0.02)
    bar.set_label(f"in-band radiance [{VARIABLES['radiance'].symbol}]")
    for letter, axes in (("a", panels["colours"]), ("b", panels["grey"])):
        axes.set(xlabel="azimuth [deg]", ylabel="elevation [deg]", aspect="auto")
        axes.set_title(f"({letter}) t = {float(ways.time[index]):.2f} s, {band.min_um:g}–{band.max_um:g} µm", fontsize=10)
    for number, label in enumerate(labels):
        if label.mask.any():
            _marked(panels["colours"], label, radiance.shape, extent, COLOURS[number % len(COLOURS)])
            _close_view(panels["grey"], radiance, label, number, (scale.low, scale.high))
    _side(panels["side"], index, ways)
    figure.draw_without_rendering()
    panels["side"].set_title(f"{panels['side'].get_title()}; heights {_enlarged(panels['side']):.0f} times enlarged", fontsize=10)
    return figure


def write(dataset: xr.Dataset, index: int, labels: list[Label], ways: EngagementWays, output: str | Path) -> Path:
    """Draw the figure (:func:`draw`) and write it as PNG, without date or version inside.

    Raises
    ------
    StorageError
        No room or no rights; nothing is left behind.
    """
    output = Path(output)
    with moved_when_whole(output) as partial:
        draw(dataset, index, labels, ways).savefig(partial, format="png", dpi=90, metadata={"Software": None})
    return output


def _extent(dataset: xr.Dataset) -> tuple[float, float, float, float]:
    """Azimuths of the left and right edge and elevations of the lower and upper one [deg]."""
    azimuth, elevation = directions(dataset)
    if azimuth.ndim == 2:  # upright all the same: every row has the same azimuths
        azimuth, elevation = np.unwrap(azimuth[0], period=360.0) % 360.0, elevation[:, 0]
    across = 0.5 * (azimuth[-1] - azimuth[0]) / max(azimuth.size - 1, 1)
    down = 0.5 * (elevation[0] - elevation[-1]) / max(elevation.size - 1, 1)
    return float(azimuth[0] - across), float(azimuth[-1] + across), float(elevation[-1] - down), float(elevation[0] + down)


def _marked(axes: Axes, label: Label, shape: tuple[int, ...], extent: tuple[float, float, float, float], colour: str) -> None:
    """A ring about a body, with its name and range."""
    x = extent[0] + (label.values["column_px"] + 0.5) / shape[1] * (extent[1] - extent[0])
    y = extent[3] - (label.values["row_px"] + 0.5) / shape[0] * (extent[3] - extent[2])
    axes.plot(x, y, "o", ms=22, mfc="none", mec="white", mew=2.6)
    axes.plot(x, y, "o", ms=22, mfc="none", mec=colour, mew=1.4)
    right = x > 0.5 * (extent[0] + extent[1])
    text = f"{label.name}\n{1e-3 * label.values['range_m']:.2f} km"
    axes.annotate(
        text,
        (x, y),
        (-14 if right else 14, 0),
        textcoords="offset points",
        ha="right" if right else "left",
        va="center",
        fontsize=8,
        color="white",
        bbox={"boxstyle": "round", "fc": "black", "ec": colour, "alpha": 0.7},
    )


def _close_view(axes: Axes, radiance: NDArray[Any], label: Label, number: int, limits: tuple[float, float]) -> None:
    """The pixels about a body, enlarged, in a corner of the image."""
    rows, columns = radiance.shape
    side = min(_CLOSE, rows, columns)
    left = int(np.clip(round(label.values["column_px"]) - side // 2, 0, columns - side))
    top = int(np.clip(round(label.values["row_px"]) - side // 2, 0, rows - side))
    inset = axes.inset_axes((0.02 + 0.32 * number, 0.02, 0.28, 0.28))
    inset.imshow(radiance[top : top + side, left : left + side], cmap="gray", vmin=limits[0], vmax=limits[1], interpolation="nearest")
    inset.set(xticks=[], yticks=[])
    inset.set_title(f"{label.name}, {side} × {side} pixels", fontsize=7, color="white", pad=2, backgroundcolor="black")
    for spine in inset.spines.values():
        spine.set(color=COLOURS[number % len(COLOURS)], linewidth=2)


def _side(axes: Axes, index: int, ways: EngagementWays) -> None:
    """Heights against the distance ahead of the sensor's start, with what the image of the frame sees."""
    farthest = 1.08 * max(float(ahead.max()) for ahead in ways.ahead.values()) + 1.0
    names = ["sensor", *(name for name in ways.ahead if name != "sensor")]
    x, h = float(ways.ahead["sensor"][index]), float(ways.height["sensor"][index])
    along = np.linspace(0.0, farthest - x, 200)

    def ray(elevation: float) -> FloatArray:
        return np.asarray(h + along * np.tan(elevation) + along**2 / (2.0 * EFFECTIVE_EARTH_RADIUS))

    lower, upper = (ray(elevation) for elevation in ways.sight)
    axes.fill_between(
        1e-3 * (x + along), np.maximum(lower, 0.0), upper, color="0.9", lw=0, label=f"field of view at {ways.time[index]:.2f} s"
    )
    axes.plot(1e-3 * (x + along), ray(-horizon_depression(h)), "k:", lw=0.8, label="to the horizon")
    every = max(round(_SECOND_MARKS / float(ways.time[1] - ways.time[0])), 1) if ways.time.size > 1 else 1
    for number, name in enumerate(names):
        colour = "black" if name == "sensor" else COLOURS[(number - 1) % len(COLOURS)]
        ahead, height = 1e-3 * ways.ahead[name], ways.height[name]
        axes.plot(ahead, height, "-", color=colour, lw=1.2)
        axes.plot(ahead[::every], height[::every], "|", color=colour, ms=7)
        axes.plot(ahead[index], height[index], "o", color=colour, ms=7, label=name)
    axes.axhspan(-6.0, 0.0, color="tab:blue", alpha=0.4, lw=0)
    axes.set_xlim(min(0.0, *(1e-3 * float(a.min()) for a in ways.ahead.values())) - 0.05, 1e-3 * farthest)
    axes.set_ylim(-6.0, 1.25 * max(float(height.max()) for height in ways.height.values()))
    axes.set(xlabel="distance ahead of the sensor's start, along the sea [km]", ylabel="height above the mean sea [m]")
    marks = f"marks every {_SECOND_MARKS:g} s" if every > 1 else "marks every frame"
    axes.set_title(f"(c) from the side; {marks}", fontsize=10)
    axes.legend(loc="upper right", fontsize=8, ncols=2)


def _enlarged(axes: Axes) -> float:
    """How many times heights are enlarged against distances, after the layout."""
    size = axes.get_window_extent()
    metres = float(np.ptp(axes.get_ylim())), 1e3 * float(np.ptp(axes.get_xlim()))
    return float((size.height / metres[0]) / (size.width / metres[1]))
