"""Two textures side by side: pictures, filtered pictures, distributions, spectra, correlations, and the report around them."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from seaglint.base.brightness import scale_limits
from seaglint.clutter.rate_ratios import VERDICTS
from seaglint.plot.figures_and_pages import bullets, figure, new_figure, notes, number, page, png, section, table
from seaglint.store.outputs import refuse_existing, write_text
from seaglint.textures.long_tails import interior
from seaglint.textures.quality import LIMITS, Comparison, TextureDistances

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Frames = NDArray[np.floating[Any]]

COLOURS = ("#1f4e79", "#c8553d", "#7a7a7a")


def draw_pictures(comparison: Comparison, first: Frames, second: Frames) -> Figure:
    """Draw the middle frame of both textures, and its Laplacian in standard deviations, on common scales."""
    figure = new_figure(12.0, 8.0)
    axes = figure.subplots(2, 2)
    images = [frames[len(frames) // 2] for frames in (first, second)]
    low, high = scale_limits(np.concatenate([image.ravel() for image in images]))
    for column, (image, one) in enumerate(zip(images, (comparison.first, comparison.second), strict=True)):
        shown = axes[0, column].imshow(image, cmap="gray", vmin=low, vmax=high, interpolation="nearest")
        figure.colorbar(shown, ax=axes[0, column], shrink=0.8, label="value")
        axes[0, column].set_title(one.name, fontsize=10)
        shown = axes[1, column].imshow(interior(image[None])[0], cmap="gray", vmin=-4.0, vmax=4.0, interpolation="nearest")
        figure.colorbar(shown, ax=axes[1, column], shrink=0.8, label="Laplacian [σ]")
        for panel in axes[:, column]:
            panel.set(xlabel="column [px]", ylabel="row [px]")
    return figure


def draw_measures(comparison: Comparison, gaussian: Comparison | None = None) -> Figure:
    """Draw filtered rates, values, spectra and correlations of both textures, and of the Gaussian field where it is given."""
    figure = new_figure(13.0, 8.0)
    (rates, values, spectra), (space, time, features) = figure.subplots(2, 3)
    textures = [comparison.first, comparison.second, *(() if gaussian is None else (gaussian.second,))]
    for one, colour in zip(textures, COLOURS, strict=False):
        shown = (one.curve.threshold > 0.0) & (one.curve.exceedances > 0)
        rates.semilogy(one.curve.threshold[shown], one.curve.rate[shown], color=colour, label=one.name)
        values.hist(one.values, bins=120, density=True, histtype="step", color=colour, label=one.name, log=True)
        spectra.semilogy(*one.spectrum.radial(), color=colour, label=one.name)
        space.plot(one.x, color=colour, label=f"{one.name}, columns")
        space.plot(one.y, color=colour, linestyle="--", label=f"{one.name}, rows")
        if one.time is not None:
            time.plot(one.time, color=colour, label=one.name)
    grid = np.linspace(0.0, 6.0, 200)
    from seaglint.clutter.thresholds import gaussian_rate

    rates.semilogy(grid, gaussian_rate(grid), color="black", linewidth=0.8, linestyle=":", label="Gaussian tail")
    names = list(comparison.first.features)
    # A feature that is 0 has no ratio, and no bar.
    ratios = [comparison.second.features[name] / (comparison.first.features[name] or np.nan) for name in names]
    features.barh(names, ratios, color=COLOURS[1])
    features.axvline(1.0, color="black", linewidth=0.8)
    titles = {
        rates: ("filtered picture: rate above a threshold", "threshold [σ]"),
        values: ("values", "value"),
        spectra: ("power spectrum, mean over directions", "frequency [cycles/px]"),
        space: ("correlation in space", "distance [px]"),
        time: ("correlation in time", "distance [frames]"),
        features: ("co-occurrence features, second over first", "ratio"),
    }
    for axes, (title, label) in titles.items():
        axes.set_title(title, fontsize=10)
        axes.set_xlabel(label)
        axes.grid(alpha=0.3)
        if axes is not features and axes.get_legend_handles_labels()[0]:
            axes.legend(fontsize=7)
    if not time.lines:
        time.text(0.5, 0.5, "no time in one of the two", ha="center", transform=time.transAxes)
    return figure


def comparison_report(
    comparison: Comparison, first: Frames, second: Frames, gaussian: Comparison | None = None, about: Sequence[str] = ()
) -> str:
    """Return the report as HTML text; ``about`` are sentences on the fit."""
    distances = comparison.distances
    measures = figure(png(draw_measures(comparison, gaussian)), "measures", "Both textures in numbers.")
    title = f"Textures: {distances.second} against {distances.first}"
    body = [
        f"<h1>{escape(title)}</h1>",
        notes([*distances.fails, *distances.undecided], "All differences are within their limits."),
        *([section("The fit", bullets(about))] if about else []),
        section("Side by side", figure(png(draw_pictures(comparison, first, second)), "pictures", "Middle frames, and their Laplacians.")),
        section("False alarms of the filtered picture", _rates(distances, gaussian)),
        section("Measures", _measures(distances), measures),
        section("How it was done", _methods()),
    ]
    return page(title, body)


def _rates(distances: TextureDistances, gaussian: Comparison | None) -> str:
    head = [
        "threshold [σ]",
        "Gaussian tail",
        distances.first,
        "95 % interval",
        distances.second,
        "95 % interval",
        "second / first",
        "within the limit",
    ]
    plain = None if gaussian is None else gaussian.distances.filtered_rates
    if plain is not None:
        head += ["Gaussian field", "Gaussian field / first"]
    rows = []
    for i, entry in enumerate(distances.filtered_rates):
        row = [number(entry.threshold_sigma), number(entry.gaussian_rate)]
        for rate, (low, high) in ((entry.first, entry.first_interval), (entry.second, entry.second_interval)):
            row += [number(rate), f"{number(low)} … {number(high)}"]
        row += [entry.ratio.text, VERDICTS[entry.verdict]]
        if plain is not None:
            row += [number(plain[i].second), plain[i].ratio.text]
        rows.append(row)
    return table(head, rows)


def _measures(distances: TextureDistances) -> str:
    values = distances.marginal
    rows = [
        ["distribution functions, largest distance", number(values.ks), number(LIMITS["ks"])],
        ["values, Wasserstein [standard deviations]", number(values.wasserstein_std), ""],
        ["spectra, rms [dB]", number(distances.spectrum_distance_db), number(LIMITS["spectrum_db"])],
        ["correlations in space, rms", number(distances.correlation_distance), number(LIMITS["correlation"])],
        ["correlations in time, rms", number(distances.time_correlation_distance), number(LIMITS["time_correlation"])],
    ]
    rows += [
        [f"co-occurrence, {name}, relative", number(pair.relative), number(LIMITS["cooccurrence"])]
        for name, pair in distances.cooccurrence.items()
    ]
    keys = ("mean", "std", "skewness", "excess_kurtosis")
    both = (distances.first, values.first), (distances.second, values.second)
    moments = [[name, *(number(getattr(one, key), 4) for key in keys)] for name, one in both]
    return table(["distance", "found", "limit"], rows) + table(
        ["texture", "mean", "standard deviation", "skewness", "excess kurtosis"], moments
    )


def _methods() -> str:
    return bullets((
        "The filter is the Laplacian of five points; thresholds are in standard deviations of each filtered frame; the border is left out.",
        "Spectra are of Hann windowed squares, in units of each texture's variance; two samples of one texture differ by about 1 dB.",
        "Correlations in space are to 12 px, in time to 25 frames. Co-occurrence: 16 common levels, four neighbours (Haralick 1973).",
    ))  # fmt: skip


def write_comparison(
    comparison: Comparison,
    first: Frames,
    second: Frames,
    path: str | Path,
    *,
    gaussian: Comparison | None = None,
    about: Sequence[str] = (),
    overwrite: bool = False,
) -> Path:
    """Write the report of a comparison; the same comparison gives the same bytes.

    Parameters
    ----------
    comparison : Comparison
    first, second : ndarray, shape (frames, rows, columns)
        Both textures [u].
    path : path
        HTML file.
    gaussian : Comparison, optional
        Comparison of the same data with a Gaussian field.
    about : sequence of str
        Sentences on the fit: data, model and method.
    overwrite : bool
        Replace an existing file.

    Raises
    ------
    DataError
        The file exists, or its folder does not.
    StorageError
        No room or no rights.
    """
    output = refuse_existing(path, overwrite=overwrite)
    write_text(comparison_report(comparison, first, second, gaussian, about), output)
    return output
