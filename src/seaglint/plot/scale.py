"""Brightness scale of a preview: limits from the displayed pixels, and a logarithm where glint is bright.

Where the sky alone would determine the scale, the limits are taken from the sea.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

from seaglint.base.brightness import Scale, scale_limits
from seaglint.base.conventions import FloatArray
from seaglint.base.representation import rounded
from seaglint.base.schema import ARTICLE_RADIANCE_PER_SI, ARTICLE_RADIANCE_SYMBOL

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colorbar import Colorbar

Kind = Literal["auto", "linear", "log"]

_FLAT: Final = 0.1  #: Share of a linear scale that the middle half of the pixels has to span; else the scale is logarithmic.


#: Part of the sea below the horizon that takes the sky's radiance with distance, and sets no limit [% of the pixels of the sea].
_FAR: Final = 25.0

_OWN: Final = 0.5  #: Share of the whole scale below which the sea gets its own scale [1].

#: Ratio of the brightest sky to the median of the sea from which sunlight is taken as the reason [1]. Without sunlight the sky has at most
#: 1.5 times the sea's radiance, at night in 3.5-5 um.
_SUNLIT: Final = 2.0

_CLOSE: Final = 0.055  #: Least distance of two numbers at a colour bar [share of its length].

_WIDE: Final = 0.22  #: Distance of two numbers at a colour bar from which another is written between them [share of its length].

_DECADES: Final = 12  #: Largest number of decades at a colour bar.


def scale_of(values: NDArray[Any], kind: Kind = "auto", depression: NDArray[Any] | None = None) -> Scale:
    """Return the scale of images: its limits leave out one pixel in five hundred at either end.

    Where the sky alone makes an automatic scale more than twice as wide as the sea needs, its limits are the limits of the sea.

    Parameters
    ----------
    values : ndarray
        Radiances [any unit].
    kind : {"auto", "linear", "log"}
        ``auto`` takes the logarithm where half of the pixels would share less than a tenth of a linear scale at its dark end; the others
        span the sky too.
    depression : ndarray, optional
        Angle of the pixels below the sea's horizon, negative in the sky, of a shape that broadcasts to the shape of ``values`` [deg].

    Returns
    -------
    Scale
        Never empty.

    Examples
    --------
    >>> scale_of(np.linspace(1.0, 2.0, 1001)).logarithmic, scale_of(np.geomspace(1.0, 1e6, 1001)).logarithmic
    (False, True)
    """
    low, high = scale_limits(values)
    if kind == "auto" and depression is not None:
        values = _sea_alone(values, np.broadcast_to(depression, values.shape), (low, high))
        low, high = scale_limits(values)
    finite = values[np.isfinite(values)]
    if kind == "linear" or finite.size == 0:
        return Scale(low, high)
    quarter, middle, three_quarters = (float(v) for v in np.percentile(finite, (25.0, 50.0, 75.0)))
    # Glint is a bright tail: the pixels crowd at the dark end. Where they crowd at the bright end, a logarithm would not separate them.
    crowded = three_quarters - quarter < _FLAT * (high - low) and middle - low < 0.5 * (high - low)
    if kind == "auto" and not crowded:
        return Scale(low, high)
    # The darker half of the pixels within one width; not less than a thousandth of the range, which is flat.
    return Scale(low, high, max(middle - low, 1e-3 * (high - low)))


def _sea_alone(values: NDArray[Any], depression: NDArray[Any], limits: tuple[float, float]) -> NDArray[Any]:
    """Return the values within the limits of the sea: brighter or darker pixels of the sky, and of the sea below the horizon, are left out.

    Air warmer or colder than the water would leave the sea a small part of the scale: at night in 8-12 um 0.7 K of 8 K.
    """
    known = np.isfinite(values)
    sea, sky = known & (depression > 0.0), known & (depression <= 0.0)
    if not sea.any() or not sky.any():
        return values
    # The part of the sea closest to the horizon has nearly the radiance of the sky above it, and would bring the sky's limits back.
    near = sea & (depression > np.percentile(depression[sea], _FAR))
    if not near.any():
        return values
    far = sea & ~near
    low, high = scale_limits(values[near])
    (low_far, high_far), (low_sky, high_sky) = scale_limits(values[far]), scale_limits(values[sky])
    # Glint below the horizon is brighter than the sky there, and stays.
    bright = high_far <= high_sky < _SUNLIT * float(np.median(values[near]))
    dark = low_far >= low_sky
    within = values[near | (known & ~(bright & (values > high)) & ~(dark & (values < low)))]
    low, high = scale_limits(within)
    # Where both scales are of similar width, the sky stays within the scale.
    return within if high - low < _OWN * (limits[1] - limits[0]) else values


def tick_labels(values: NDArray[Any], digits: int = 3) -> list[str]:
    """Return the numbers of a colour bar with as many digits as make neighbours differ, at least ``digits`` and at most 9.

    Examples
    --------
    >>> tick_labels(np.array([28.01, 28.04, 28.2, 30.0]))
    ['28.01', '28.04', '28.2', '30']
    >>> tick_labels(np.array([903.0, 4610.0, 25400.0]))
    ['903', '4610', '25400']
    """
    # Neighbours may be equal even with 9 digits; the labels with 9 are returned then.
    for figures in range(digits, 10):
        labels = [rounded(value, figures) for value in values]
        if len(set(labels)) == len(labels):
            break
    return labels


def round_ticks(share: Callable[[FloatArray], FloatArray], value: Callable[[FloatArray], FloatArray]) -> FloatArray:
    """Return round numbers for the bar of a logarithmic scale, rising: 1, 2 and 5 times powers of ten, then others where a gap is wide.

    Parameters
    ----------
    share : callable
        Brightness [0, 1] of values, as ``seaglint.base.brightness.Scale.share``.
    value : callable
        Its inverse.

    Examples
    --------
    >>> def of(scale):
    ...     return round_ticks(scale.share, scale.value).tolist()
    >>> of(Scale(0.8, 250.0, width=1.0))
    [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0]
    >>> of(Scale(28.01, 30.4, width=0.03))
    [28.05, 28.1, 28.2, 28.5, 29.0]
    """
    low, high = (float(end) for end in value(np.array([0.0, 1.0])))
    ticks: list[float] = []
    # Without positive values there are no powers of ten, and all numbers come from the gaps.
    top = int(np.floor(np.log10(high))) if high > 0.0 else None
    # Powers of ten first: where there is room for some of the numbers alone, for these.
    for factor in (1, 5, 2) if top is not None else ():
        for exponent in range(top or 0, (top or 0) - _DECADES, -1):
            tick = float(f"{factor}e{exponent}")
            if low <= tick <= high:
                at, others = share(np.array([tick])), share(np.array(ticks))
                if np.all(np.abs(others - at) >= _CLOSE):
                    ticks.append(tick)
    # Each round leaves at most about two thirds of every wide gap; the bound guarantees an end.
    for _ in range(_DECADES):
        ends = [0.0, *share(np.array(sorted(ticks))).tolist(), 1.0]
        wide = [(begin, end) for begin, end in pairwise(ends) if end - begin > _WIDE]
        if not wide:
            break
        for begin, end in wide:
            # From the middle third of the gap, so that the number keeps its distance from both neighbours.
            third = (end - begin) / 3.0
            ticks.append(_roundest(*value(np.array([begin + third, end - third])).tolist()))
    return np.array(sorted(ticks))


def add_article_units(axes: Axes, side: Literal["left", "right"]) -> None:
    """Add an axis at a side that has the radiances of the other one in the unit of the source article."""

    def article(radiance: Any) -> Any:
        return ARTICLE_RADIANCE_PER_SI * radiance

    def back(radiance: Any) -> Any:
        return radiance / ARTICLE_RADIANCE_PER_SI

    second = axes.secondary_yaxis(side, functions=(article, back))
    second.set_ylabel(ARTICLE_RADIANCE_SYMBOL, fontsize=8)
    second.tick_params(labelsize=7)


def number_decades(bar: Colorbar) -> None:
    """Write 1, 2 and 5 of each decade at the bar of a ``LogNorm``; over more than four decades, powers of ten only."""
    from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

    low, high = float(bar.norm.vmin or 1.0), float(bar.norm.vmax or 1.0)
    # Three numbers a decade have room beside the bar up to four decades.
    factors = (1, 2, 5) if high / low < 1e4 else (1,)
    exponents = range(int(np.floor(np.log10(low))), int(np.floor(np.log10(high))) + 1)
    ticks = [tick for exponent in exponents for factor in factors if low <= (tick := float(f"{factor}e{exponent}")) <= high]
    # Matplotlib's own labels are powers of ten with raised exponents; these are plain numbers.
    bar.locator, bar.minorlocator = FixedLocator(ticks), NullLocator()
    bar.formatter = FuncFormatter(lambda tick, _: rounded(tick, 9))
    bar.update_ticks()


def _roundest(low: float, high: float) -> float:
    """Return the number with the fewest digits between two others."""
    # From steps above both numbers down to the smallest positive double. 1e-300 keeps the logarithm finite where both are 0.
    for exponent in range(int(np.floor(np.log10(max(abs(low), abs(high), 1e-300)))) + 1, -320, -1):
        # Coarse steps first: the first multiple inside has the fewest digits.
        for factor in (5, 2, 1):
            step = float(f"{factor}e{exponent}")
            if step > 0.0 and (value := np.ceil(low / step) * step) <= high:
                # A multiple of the step has rounding errors in its last digits, which a label would show.
                return float(f"{value:.12g}")
    return 0.5 * (low + high)
