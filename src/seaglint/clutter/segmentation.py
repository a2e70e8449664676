"""Segmentation of the glint corridor: a bright part of the sea that the glint of the Sun or Moon makes, or none.

Method, unsupervised, on the time-averaged image (with the temporal standard deviation of each pixel and one frame where there are frames):

1. Sky: the rows from the top with less than half of the texture (mean absolute difference of horizontal neighbours) of the rows below
   them. They belong to neither class.
2. Envelope: a Gaussian smoothing of 1/24 of the shorter side, so that single waves do not count.
3. Background of a row: its 10 % quantile, made convex over the rows. A sea without glint changes steadily with depression
   angle, which a convex curve follows; a corridor, also one wider than the picture, rises above it.
4. Candidate: the largest connected part above Otsu's threshold between two classes, holes filled.

The candidate is a corridor if all of these hold:

- Symmetric and narrow: a Gaussian in azimuth about one vertical axis, inside the picture or up to half of its width beyond a border, with a
  height for each row, explains the envelope's variation along the rows. It fades within the picture, to both sides of an axis inside it.
- Gradual: the chance of a glint falls off over many waves, a shore is an edge.
- Sparkling: a gain (vignetting, uneven illumination) multiplies the fine structure and leaves its skewness. Noise added to it only lowers
  the skewness where the gain is low. Glints are sparse beside a corridor and dense within it: the skewness is positive beside it and lower
  within, where the structure is nevertheless stronger. Haze weakens structure. A saturated corridor loses this; it needs
  saturated pixels, structure that is skewed to the bright, and structure that rises less than the brightness. A low Sun leaves the sea
  beside the corridor so dark that no gain explains the ratio. Of radiances, whose zero is known, a gain raises structure and brightness
  alike; structure that rises more is glint too.

A candidate that fails only narrowly is no corridor either, and the reason states it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.base.free_form import JsonObject, plain
from seaglint.clutter.correlation import BoolArray

METHOD = "bright part (Otsu) above a convex row background; symmetric about a vertical axis, gradual, sparkling"
SHORTEST_SIDE = 32  # px; the envelope below has then 24 independent patches a side at most, too few for a corridor
LEAST_SYMMETRY = (0.85, 0.75)  # each pair: limit of a corridor, and the limit up to which a failure is a narrow one
LEAST_CONTRAST = (1.5, 1.2)  # noise of any correlation that fits several times into the picture mostly stays below
SHARPEST_BORDER = (0.44, 0.50)  # of the step, within 1/24 of the shorter side; shores have 0.47 and more
FADED = 0.6  # of the largest brightness of the fitted peak, at the border of the picture
NEAR_BORDER = 0.15  # of the width: an axis nearer to a border shows one side of the corridor only
LEAST_SPARKLE = (0.30, 0.20)  # difference of skewnesses; textures under vignetting have at most 0.2
LEAST_STRUCTURE = (1.10, 0.90)  # of the background's; haze and saturation weaken it
LEAST_SKEWNESS = 0.25  # beside a corridor
DEEPEST_SHADE = 6.0  # ratio of structure that no gain makes: the cos^4 law at 50 degrees from the axis
MORE_THAN_GAIN = 1.3  # of the ratio of radiances; unknown gradients of a gain within tiles change it by less than 1.1
SURE = 3.0  # standard errors of the difference of skewnesses
SATURATED = 0.01  # share of the candidate's pixels at the ceiling
MOST_STRUCTURE_SATURATED = 0.85  # of the brightness's ratio: a gain raises both alike


@dataclass(frozen=True)
class FineStructure:
    """Fine structure of the candidate and of the sea beside it, in tiles of the same rows."""

    structure_ratio: float = np.nan  #: Standard deviation in the candidate over its value beside it [1].
    #: Brightness, above zero in radiances and otherwise above the darkest sea, in the candidate over its value beside it [1].
    brightness_ratio: float = np.nan
    radiance: bool = False  #: Whether values are radiances.
    skewness_within: float = np.nan  #: Skewness in the candidate [1].
    skewness_beside: float = np.nan  #: Skewness beside the candidate [1].
    error: float = np.nan  #: Standard error of the difference of both skewnesses [1].
    saturated: float = 0.0  #: Share of the candidate's pixels with the largest value of the picture [1].


@dataclass(frozen=True)
class Segmentation:
    """Regions of a picture, with the criteria of the decision."""

    #: Corridor, (rows, columns); empty where nothing was found. The three regions are disjoint; pixels without data are in none.
    glint: BoolArray
    background: BoolArray  #: Sea beside the corridor, (rows, columns).
    sky: BoolArray  #: Sky, (rows, columns).
    found: bool  #: Whether there is a corridor.
    #: Share of the envelope's variation along rows that a peak about a vertical axis explains [1]; NaN if not decidable.
    symmetry: float = np.nan
    axis_column: float = np.nan  #: Column of this axis [px]; outside the picture where half of a corridor or less is seen.
    contrast: float = np.nan  #: Mean of the candidate above the background's in standard deviations of the background's pixels [1].
    #: Step of brightness within the envelope's length of the border over the step between the inner half of the candidate and the outer
    #: half of the background [1]; NaN without a border, or with less contrast than a corridor has.
    border_step: float = np.nan
    sparkle: FineStructure = FineStructure()  #: Fine structure within the candidate and beside it.
    reason: str = ""  #: Reason for the absence of a corridor; empty if there is one.
    method: str = METHOD  #: One line for reports.

    def as_dict(self) -> JsonObject:
        """Return the decision with its criteria as plain numbers and text; pixels of sky are counted."""
        names = ("found", "method", "symmetry", "axis_column", "contrast", "border_step")
        values = {name: getattr(self, name) for name in names} | {"sparkle": vars(self.sparkle)}
        return plain(values | {"reason": self.reason or None, "sky_pixels": int(self.sky.sum())})


def segment(mean: ArrayLike, std: ArrayLike | None = None, frame: ArrayLike | None = None, *, radiance: bool = False) -> Segmentation:
    """Find the glint corridor in a picture.

    Parameters
    ----------
    mean : array_like, shape (rows, columns)
        Brightness averaged over time, or one frame; NaN where there are no data. Any unit, any offset.
    std : array_like, shape (rows, columns), optional
        Standard deviation over time of each pixel, same unit; it makes the corridor of a sequence much clearer.
    frame : array_like, shape (rows, columns), optional
        One frame of the sequence, whose fine structure is not averaged over time; by default ``mean``.
    radiance : bool
        Whether values are radiances: 0 is no light. The level of other values is unknown.

    Returns
    -------
    Segmentation

    Raises
    ------
    DataError
        If the arrays are not two-dimensional or differ in shape.
    """
    image = np.asarray(mean, dtype=np.float64)
    if image.ndim != 2:
        raise DataError(f"segmentation got an array of shape {image.shape}; give the mean image, (rows, columns)")
    deviation, single = (None if given is None else np.asarray(given, dtype=np.float64) for given in (std, frame))
    valid = np.isfinite(image)
    for name, given in (("standard deviation", deviation), ("frame", single)):
        if given is not None and given.shape != image.shape:
            raise DataError(f"mean image {image.shape} and {name} {given.shape} differ in shape; give one value of each per pixel")
    if deviation is not None:
        valid &= np.isfinite(deviation)
    nothing = np.zeros(image.shape, dtype=bool)
    if min(image.shape) < SHORTEST_SIDE:
        reason = f"picture of {image.shape[0]} x {image.shape[1]} px is too small to tell; at least {SHORTEST_SIDE} px a side are needed"
        return Segmentation(nothing, valid, nothing, False, reason=reason)
    if valid.sum() < image.size / 2 or np.ptp(image[valid]) == 0.0:
        reason = "constant picture, or less than half of it has data"
        return Segmentation(nothing, valid, nothing, False, reason=reason)

    first = _rows_of_sky(np.where(valid, image, np.nan))
    sky = nothing.copy()
    sky[:first] = valid[:first]
    sea = slice(first, None)
    excess = _excess(image[sea], valid[sea])
    candidate = _candidate(image[sea], None if deviation is None else deviation[sea], valid[sea], excess)
    symmetry, axis = _peak(excess)
    contrast = _contrast(image[sea], candidate, valid[sea], excess)
    # without contrast there is no step to take a share of
    step = _border_step(image[sea], candidate, valid[sea]) if contrast >= LEAST_CONTRAST[1] else float("nan")
    sparkle = _sparkle((image if single is None else single)[sea], candidate, valid[sea], radiance)
    reason = _refusal(symmetry, contrast, step, sparkle)
    glint = nothing.copy()
    if not reason:
        glint[sea] = candidate & valid[sea]
    return Segmentation(
        glint=glint,
        background=valid & ~sky & ~glint,
        sky=sky,
        found=not reason,
        symmetry=symmetry,
        axis_column=axis,
        contrast=contrast,
        border_step=step,
        sparkle=sparkle,
        reason=reason,
    )


def _refusal(symmetry: float, contrast: float, step: float, sparkle: FineStructure) -> str:
    """Reason why the brighter part is no corridor, or an empty text."""
    if not contrast >= LEAST_CONTRAST[1]:
        return f"brighter part only {contrast:.1f} standard deviations above the background, a corridor at least {LEAST_CONTRAST[0]:g}"
    if not symmetry >= LEAST_SYMMETRY[1]:
        share = f"{100 * symmetry:.0f} % of the variation along rows, a corridor at least {100 * LEAST_SYMMETRY[0]:.0f} %"
        return f"no peak about a vertical axis that fades within the picture explains the brightness ({share})"
    if step > SHARPEST_BORDER[1]:
        share = f"{100 * step:.0f} % of the step at once, glint at most {100 * SHARPEST_BORDER[0]:.0f} %"
        return f"brighter part has a sharp border ({share}): a shore"
    if not np.isfinite(sparkle.error):
        return "no rows show both the brighter part and sea beside it, whose fine structure could be compared"
    dull, close = _dullness(sparkle)
    if dull and not close:
        return dull
    narrow = [dull] if dull else []
    if contrast < LEAST_CONTRAST[0]:
        narrow.append(f"contrast {contrast:.1f} (a corridor has at least {LEAST_CONTRAST[0]:g})")
    if symmetry < LEAST_SYMMETRY[0]:
        narrow.append(f"a vertical axis explains {100 * symmetry:.0f} % (of a corridor at least {100 * LEAST_SYMMETRY[0]:.0f} %)")
    if step > SHARPEST_BORDER[0]:
        narrow.append(f"{100 * step:.0f} % of the step at the border (of a corridor at most {100 * SHARPEST_BORDER[0]:.0f} %)")
    if not narrow:
        return ""
    return f"a bright part is not surely glint: {', '.join(narrow)}; look at the picture and give the corridor with --mask or --regions"


def _dullness(of: FineStructure) -> tuple[str, bool]:
    """Reason why the fine structure is not a corridor's, or an empty text, and whether it fails narrowly."""
    skewed = of.skewness_within > LEAST_SKEWNESS and of.skewness_beside > LEAST_SKEWNESS
    if of.saturated >= SATURATED:
        # A ceiling lowers the skewness of any texture.
        if skewed and of.structure_ratio < MOST_STRUCTURE_SATURATED * of.brightness_ratio:
            return "", False
        share = f"{100 * of.saturated:.2g} % of the brighter part saturated"
        ratio = f"{of.structure_ratio:.2f} times the structure and {of.brightness_ratio:.2f} times the brightness of the background"
        return f"{share}, with {ratio}: a gain or haze would do so", False
    if of.structure_ratio >= DEEPEST_SHADE and of.skewness_within > 0.0:
        return "", False
    if of.radiance and of.structure_ratio >= max(MORE_THAN_GAIN * of.brightness_ratio, LEAST_STRUCTURE[0]):
        return "", False
    # A gain G over a texture with noise multiplies the third moment by G^3: the skewness beside is between (structure / G)^3 times the
    # skewness within and the skewness within.
    gain = min(of.brightness_ratio, DEEPEST_SHADE)
    denser = of.skewness_beside - of.skewness_within if of.skewness_beside >= LEAST_SKEWNESS else 0.0
    drop = max(denser, of.skewness_within * min(of.structure_ratio / gain, 1.0) ** 3 - of.skewness_beside)
    sure = drop >= SURE * of.error
    if sure and drop >= LEAST_SPARKLE[0] and of.structure_ratio >= LEAST_STRUCTURE[0]:
        return "", False
    close = sure and drop >= LEAST_SPARKLE[1] and of.structure_ratio >= LEAST_STRUCTURE[1]
    text = f"skewness of the fine structure {of.skewness_within:.2f} within and {of.skewness_beside:.2f} beside"
    if of.structure_ratio < LEAST_STRUCTURE[0]:
        return f"fine structure {of.structure_ratio:.2f} times the background's (of a corridor at least {LEAST_STRUCTURE[0]:g})", close
    if close:
        return f"{text} (a corridor falls by at least {LEAST_SPARKLE[0]:g})", close
    return f"brighter part does not sparkle ({text}): shading, haze or a coast, not glint", close


def _rows_of_sky(image: FloatArray) -> int:
    """Number of rows from the top that are much smoother than those below; 0 where the picture has no such edge."""
    difference = np.abs(np.diff(image, axis=1))
    count = np.isfinite(difference).sum(axis=1)
    texture = np.where(count > 0, np.nansum(difference, axis=1) / np.maximum(count, 1), 0.0)
    rows = len(texture)
    first = 0
    for row in range(4, int(0.8 * rows)):
        above = np.median(texture[:row])
        below = np.median(texture[row : row + max(8, rows // 8)])
        # The largest row above counts too: a ship on the horizon is not sky, and calm patches of sea have rough rows above.
        if below > 0.0 and below >= 2.0 * above and texture[:row].max() < 0.7 * below:
            first = row
    return first


def _smoothed(image: FloatArray, valid: BoolArray, sigma: float) -> FloatArray:
    """Gaussian mean of the pixels that have values."""
    from scipy.ndimage import gaussian_filter

    weight = gaussian_filter(valid.astype(np.float64), sigma, mode="nearest")
    total = gaussian_filter(np.where(valid, image, 0.0), sigma, mode="nearest")
    return np.where(weight > 1e-6, total / np.maximum(weight, 1e-6), float(np.mean(image[valid])))


def _convex_below(profile: FloatArray) -> FloatArray:
    """Greatest convex function nowhere above the profile (lower hull, monotone chain)."""
    corners: list[int] = []
    for i in range(len(profile)):
        while len(corners) >= 2:
            a, b = corners[-2], corners[-1]
            if (profile[b] - profile[a]) * (i - a) < (profile[i] - profile[a]) * (b - a):
                break
            corners.pop()
        corners.append(i)
    return np.interp(np.arange(len(profile)), corners, profile[corners])


def otsu_threshold(values: FloatArray, bins: int = 512) -> tuple[float, float]:
    """Threshold between two classes and its separability, between-class over total variance (Otsu 1979).

    Parameters
    ----------
    values : ndarray
        Any shape, finite.
    bins : int
        Cells of the histogram; the threshold is known to one of them.

    Returns
    -------
    threshold, separability : float
        Separability is 2/pi for a Gaussian, 3/4 for a uniform density, 1 for two values; 0 for a constant.
    """
    counts, edges = np.histogram(values, bins)
    centre = 0.5 * (edges[1:] + edges[:-1])
    share = counts / counts.sum()
    below = np.cumsum(share)[:-1]
    first_moment = np.cumsum(share * centre)
    total = first_moment[-1]
    inside = (below > 0.0) & (below < 1.0)
    between = np.zeros(bins - 1)
    between[inside] = (total * below[inside] - first_moment[:-1][inside]) ** 2 / (below[inside] * (1.0 - below[inside]))
    variance = float(np.sum(share * (centre - total) ** 2))
    best = int(between.argmax())
    return float(edges[best + 1]), float(between[best] / variance) if variance > 0.0 else 0.0


def _excess(layer: FloatArray, valid: BoolArray) -> FloatArray:
    """Return the envelope above the background of each row."""
    # A quantile is shifted by single rows of missing data less than a mean is; 1/24 leaves some twenty patches a side.
    smooth = _smoothed(layer, valid, _envelope_length(layer))
    return smooth - _convex_below(np.quantile(smooth, 0.1, axis=1))[:, None]


def _candidate(image: FloatArray, deviation: FloatArray | None, valid: BoolArray, excess: FloatArray) -> BoolArray:
    """Return the largest connected part of the brighter of two classes, holes filled."""
    from scipy import ndimage

    layers = [excess] if deviation is None else [excess, _excess(deviation, valid)]
    # Mean and deviation each in units of its standard deviation: glint raises both, and neither unit should decide.
    score = sum((layer / max(float(layer.std()), np.finfo(float).tiny) for layer in layers), np.zeros(image.shape))
    label, count = ndimage.label(score > otsu_threshold(score)[0])
    if count == 0:
        return np.zeros(image.shape, dtype=bool)
    largest = 1 + int(np.argmax(np.bincount(label.ravel())[1:]))
    return np.asarray(ndimage.binary_fill_holes(label == largest), dtype=bool)


def _contrast(image: FloatArray, candidate: BoolArray, valid: BoolArray, excess: FloatArray) -> float:
    """Return the mean of the candidate above the background's in standard deviations of the background's pixels."""
    inside, outside = candidate & valid, ~candidate & valid
    if not inside.any() or not outside.any():
        return 0.0
    base = image - (_smoothed(image, valid, _envelope_length(image)) - excess)
    noise = float(base[outside].std())
    return float(base[inside].mean() - base[outside].mean()) / noise if noise > 0.0 else np.inf


def _peak(excess: FloatArray) -> tuple[float, float]:
    """Return the share of the variation along rows explained by a peak about a vertical axis that fades in the picture, and its column.

    The peak is a Gaussian with one axis and width for all rows; each row has its own level and height, not below 0.
    """
    rows, columns = excess.shape
    step = max(columns // 128, 1)
    thinned = excess[:: max(rows // 64, 1), ::step]
    varying = thinned - thinned.mean(axis=1, keepdims=True)
    total = float(np.sum(varying**2))
    if total <= 0.0:
        return 0.0, float("nan")
    place = np.arange(0, columns, step)
    axes, widths = (grid.ravel() for grid in np.meshgrid(np.linspace(-0.5, 1.5, 65), np.geomspace(0.04, 1.0, 14)))
    peaks = np.exp(-0.5 * ((place - columns * axes[:, None]) / (columns * widths[:, None])) ** 2)
    # A peak far beyond the border is divided by its largest value in the picture.
    peaks /= np.maximum(peaks.max(axis=1, keepdims=True), 1e-300)
    ends = np.where(axes < NEAR_BORDER, 0.0, peaks[:, 0]), np.where(axes > 1.0 - NEAR_BORDER, 0.0, peaks[:, -1])
    centred = peaks - peaks.mean(axis=1, keepdims=True)
    squares = np.sum(centred**2, axis=1)
    fades = (np.maximum(*ends) < FADED) & (squares > 0.0)
    heights = np.maximum(varying @ centred[fades].T, 0.0)
    explained = np.sum(heights**2, axis=0) / squares[fades]
    best = int(explained.argmax())
    return float(explained[best]) / total, float(columns * axes[fades][best])


def _sparkle(frame: FloatArray, candidate: BoolArray, valid: BoolArray, radiance: bool) -> FineStructure:
    """Return the fine structure of tiles in the candidate and of tiles beside it, compared row by row of tiles."""
    # Lines at the border of the picture are often frames that programs drew.
    border = 4
    used = np.zeros(frame.shape, dtype=bool)
    used[border:-border, border:-border] = (valid & np.isfinite(frame))[border:-border, border:-border]
    known = np.where(used, frame, 0.0)
    fine = known - _smoothed(frame, used, 2.0)
    side = max(min(frame.shape) // 8, 8)
    first_rows, first_columns = (np.linspace(0, size, size // side, endpoint=False).astype(int) for size in frame.shape)

    def tiles(values: FloatArray) -> FloatArray:
        sums = np.add.reduceat(np.where(used, values, 0.0), first_rows, axis=0)
        return np.asarray(np.add.reduceat(sums, first_columns, axis=1))

    count = tiles(np.ones(frame.shape))
    layers = candidate.astype(np.float64), known, fine**2, fine**3
    share, level, variance, third = (tiles(layer) / np.maximum(count, 1.0) for layer in layers)
    good = (count >= 0.5 * side**2) & (variance > 0.0)
    within, beside = good & (share > 0.75), good & (share < 0.25)
    both = np.flatnonzero(within.any(axis=1) & beside.any(axis=1))
    inside = candidate & used
    saturated = float(np.mean(frame[inside] >= frame[used].max())) if inside.any() else 0.0
    if both.size < 2:
        return FineStructure(saturated=saturated)
    skewness = third / np.where(good, variance, 1.0) ** 1.5
    # Medians over tiles leave out ships and other single objects.
    pairs = np.array(
        [[[np.median(values[row, part[row]]) for part in (within, beside)] for values in (level, variance, skewness)] for row in both]
    )
    weight = np.array([min(within[row].sum(), beside[row].sum()) for row in both], dtype=np.float64)
    weight /= weight.sum()
    darkest = 0.0 if radiance else float(np.quantile(known[used] - fine[used], 0.002))
    above = np.maximum(weight @ pairs[:, 0] - darkest, 0.0)
    drop = pairs[:, 2, 1] - pairs[:, 2, 0]
    # Tile rows are independent; their number is that of equal weights.
    spread = float(weight @ (drop - weight @ drop) ** 2) / max(1.0 / float(np.sum(weight**2)) - 1.0, 0.5)
    return FineStructure(
        structure_ratio=float(np.exp(0.5 * weight @ np.log(pairs[:, 1, 0] / pairs[:, 1, 1]))),
        brightness_ratio=float(above[0] / max(above[1], 1e-3 * above[0])) if above[0] > 0.0 else 1.0,
        skewness_within=float(weight @ pairs[:, 2, 0]),
        skewness_beside=float(weight @ pairs[:, 2, 1]),
        error=float(np.sqrt(spread)),
        saturated=saturated,
        radiance=radiance,
    )


def _envelope_length(image: FloatArray) -> float:
    """Standard deviation of the smoothing that preserves the envelope [px]."""
    return float(max(min(image.shape) / 24.0, 1.0))


def _border_step(image: FloatArray, corridor: BoolArray, valid: BoolArray) -> float:
    """Return the step of brightness near the border over the step between the inner corridor and the outer background, or NaN.

    The latter are the inner half of the corridor and the outer half of the background. The border is determined again with half of the
    smoothing: the envelope's border is pixels away from the border of a ragged shore.
    """
    from scipy import ndimage

    if not corridor.any() or corridor.all():
        return float("nan")
    length = _envelope_length(image)
    near = max(0.5 * length, 1.5)
    smooth = _smoothed(image, valid, near)
    within, beyond = ndimage.distance_transform_edt(corridor), ndimage.distance_transform_edt(~corridor)
    threshold, _ = otsu_threshold(smooth[np.maximum(within, beyond) < 1.5 * length])
    label, count = ndimage.label(smooth > threshold)
    shared = np.bincount(label[corridor], minlength=count + 1)[1:]
    if count == 0 or not shared.any():
        return float("nan")
    refined = ndimage.binary_fill_holes(label == 1 + int(shared.argmax()))
    # Distance from the border, which lies half a pixel from the nearest pixels, positive in the corridor [px].
    depth = np.where(refined, ndimage.distance_transform_edt(refined) - 0.5, 0.5 - ndimage.distance_transform_edt(~refined))

    def level(low: float, high: float, side: float) -> float:
        band = (side * depth > low) & (side * depth < high) & valid
        return float(image[band].mean()) if band.any() else float("nan")

    # The inner half of the corridor and the outer half of the background: a glint increases up to its middle.
    inner, outer = (0.5 * float((side * depth).max()) for side in (1.0, -1.0))
    far = level(inner, np.inf, 1.0) - level(outer, np.inf, -1.0)
    step = level(0.5 * near, 2.0 * near, 1.0) - level(0.5 * near, 2.0 * near, -1.0)
    return float(step / far) if far > 0.0 else float("nan")
