"""Figure 10 of the source article, drawn from the dataset of its study."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from seaglint.plot.new_figure import new_figure

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

_COLUMNS: Final = (
    "sea from above, quantised",
    "exchange sample, likelihood given the histogram",
    "Gibbs sweeps at the pseudo-likelihood's fit",
    "Gibbs sweeps, couplings weakened",
)


def draw_figure_10(dataset: xr.Dataset) -> Figure:
    """Textures of isotropic couplings above, of horizontal emphasis below; beside them the picture, a frozen and a molten sample."""
    figure = new_figure(14.0, 8.0)
    panels = figure.subplots(2, len(_COLUMNS))
    names = ("(a) isotropic", "(b) horizontal")
    for i, row in enumerate(panels):
        for j, axes in enumerate(row):
            axes.imshow(
                dataset["grey_level"].to_numpy()[i, j], cmap="gray", vmin=0, vmax=dataset.attrs["levels"] - 1, interpolation="nearest"
            )
            axes.set_xticks([])
            axes.set_yticks([])
            tie = dataset["correlation"].to_numpy()[i, j]
            spread = float(dataset["std_level"].to_numpy()[i, j])
            lines = [f"deviation {spread:.2f} levels; correlation → {tie[0]:.2f}, ↓ {tie[1]:.2f}"]
            if j == 1:
                coupling, error = (dataset[key].to_numpy()[i, 1] for key in ("coupling", "coupling_standard_error"))
                lines.append(f"β → {coupling[0]:.3f} ± {error[0]:.3f}, ↓ {coupling[1]:.3f} ± {error[1]:.3f}")
            if j == 2:
                lines.append(f"{dataset.attrs['regimes'][i][0]}: mean-field slope {float(dataset['mean_field_slope'][i, 0]):.2f}")
            if j == 3:
                lines.append(dataset.attrs["regimes"][i][1])
            axes.set_xlabel("\n".join(lines), fontsize=9)
            if i == 0:
                axes.set_title(_COLUMNS[j], fontsize=10)
        row[0].set_ylabel(names[i], fontsize=11)
    figure.suptitle(
        f"Autobinomial textures: {dataset.attrs['levels']} grey levels, order {dataset.attrs['order']}, {dataset.attrs['sweeps']} sweeps",
        fontsize=11,
    )
    return figure
