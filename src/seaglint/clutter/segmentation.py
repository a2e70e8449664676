"""Segmentation of the glint corridor: two classes of smoothed brightness above the row's background, or none.

Method, unsupervised, on the time-averaged image (and the temporal standard deviation of each pixel where there are frames):

1. Sky: the rows from the top with less than half of the texture (mean absolute difference of horizontal neighbours) of the rows below
   them. They belong to neither class.
2. Envelope: a Gaussian smoothing of 1/24 of the shorter side, so that single waves do not count.
3. Background of a row: its 10 % quantile, made convex over the rows. A sea without glint changes steadily with depression
   angle, which a convex curve follows; a corridor, also one wider than the picture, rises above it.
4. Two classes by Otsu's threshold, the largest connected part of the upper one, holes filled.
5. It is a corridor only if the classes separate (Otsu's criterion at least 0.69; a Gaussian split at its mean has 0.64), its
   mean is two standard deviations of the background's pixels above it, it does not span the picture from side to side, its
   texture differs from the background's (brightness alone is shading of the lens or haze), and its border is gradual: the chance
   of a glint falls off over many waves, a shore is an edge. A corridor that passes a criterion narrowly is reported as doubtful.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.base.free_form import JsonObject, plain
from seaglint.clutter.correlation import BoolArray

METHOD = "two classes (Otsu) of smoothed brightness above a convex row background, largest connected part"
SHORTEST_SIDE = 32  # px; the envelope below has then 24 independent patches a side at most, too few for two classes
LEAST_SEPARABILITY = 0.69  # between 0.64 of a split Gaussian and 0.71 of the weakest measured corridor
LEAST_CONTRAST = 2.0  # noise of any correlation that fits several times into the picture stays below 1.5
TEXTURE_ALIKE = (0.85, 1.2)  # shading leaves texture within 5 %; glint at least 1.6 times, or 0.6 times where it saturates
MOST_SPANNING_ROWS = 0.5
SHARPEST_BORDER = 0.44  # of the step, within 1/24 of the shorter side; measured and rendered corridors have at most 0.40, shores 0.47
CLEAR_SEPARABILITY = 0.75  # that of a uniform density: shading across the picture comes near it, two classes exceed it
CLEAR_CONTRAST = 3.0
CLEAR_TEXTURE = (0.6, 1.6)
CLEAR_BORDER = 0.38


@dataclass(frozen=True)
class Segmentation:
    """Regions of a picture, with the criteria of the decision."""

    #: Corridor, (rows, columns); empty where nothing was found. The three regions are disjoint; pixels without data are in none.
    glint: BoolArray
    background: BoolArray  #: Sea beside the corridor, (rows, columns).
    sky: BoolArray  #: Sky, (rows, columns).
    found: bool  #: Whether there is a corridor.
    #: Otsu's criterion, variance between the two classes over total variance of the envelope [1]; NaN if not decidable.
    separability: float = np.nan
    contrast: float = np.nan  #: Mean of the corridor above the background's in standard deviations of the background's pixels [1].
    #: Root mean square of fine structure (in time where frames were given) in the corridor over its value in the background.
    texture_ratio: float = np.nan
    #: Step of brightness within the envelope's length of the border over the step between the inner half of the corridor and the outer half
    #: of the background [1]; NaN without a border, or with less contrast than a corridor has.
    border_step: float = np.nan
    reason: str = ""  #: Reason for the absence of a corridor; empty if there is one.
    doubt: str = ""  #: Criteria that a corridor passes only narrowly; empty where it is clear, and without a corridor.
    method: str = METHOD  #: One line for reports.

    def as_dict(self) -> JsonObject:
        """Return the decision with its criteria as plain numbers and text; pixels of sky are counted."""
        values = {name: getattr(self, name) for name in ("found", "method", "separability", "contrast", "border_step")}
        return plain(values | {"reason": self.reason or None, "doubt": self.doubt or None} | {"sky_pixels": int(self.sky.sum())})


def segment(mean: ArrayLike, std: ArrayLike | None = None) -> Segmentation:
    """Find the glint corridor in a picture.

    Parameters
    ----------
    mean : array_like, shape (rows, columns)
        Brightness averaged over time, or one frame; NaN where there are no data. Any unit, any offset.
    std : array_like, shape (rows, columns), optional
        Standard deviation over time of each pixel, same unit; it makes the corridor of a sequence much clearer.

    Returns
    -------
    Segmentation

    Raises
    ------
    DataError
        If the arrays are not two-dimensional or differ in shape.
    """
    image = np.asarray(mean, dtype=np.float64)
    deviation = None if std is None else np.asarray(std, dtype=np.float64)
    if image.ndim != 2:
        raise DataError(f"segmentation got an array of shape {image.shape}; give the mean image, (rows, columns)")
    if deviation is not None and deviation.shape != image.shape:
        raise DataError(f"mean image {image.shape} and standard deviation {deviation.shape} differ in shape; give one of each per pixel")
    valid = np.isfinite(image)
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
    corridor, separability, contrast, texture, spanning = _corridor(image[sea], None if deviation is None else deviation[sea], valid[sea])
    # without contrast there is no step to take a share of
    step = _border_step(image[sea], corridor, valid[sea]) if contrast >= LEAST_CONTRAST else float("nan")
    reason = _refusal(separability, contrast, texture, spanning, step)
    doubt = "" if reason else _doubt(separability, contrast, texture, step)
    glint = nothing.copy()
    if not reason:
        glint[sea] = corridor & valid[sea]
    return Segmentation(
        glint=glint,
        background=valid & ~sky & ~glint,
        sky=sky,
        found=not reason,
        separability=separability,
        contrast=contrast,
        texture_ratio=texture,
        border_step=step,
        reason=reason,
        doubt=doubt,
    )


def _refusal(separability: float, contrast: float, texture: float, spanning: float, step: float) -> str:
    """Reason why the brighter class is no corridor, or an empty text."""
    if not separability >= LEAST_SEPARABILITY:
        return f"brightness has no two classes: separability {separability:.2f}, a corridor has at least {LEAST_SEPARABILITY}"
    if not contrast >= LEAST_CONTRAST:
        return f"brighter part only {contrast:.1f} standard deviations above the background, a corridor at least {LEAST_CONTRAST:g}"
    if spanning > MOST_SPANNING_ROWS:
        return "brighter part goes from side to side: a band along the horizon or haze"
    if not (texture <= TEXTURE_ALIKE[0] or texture >= TEXTURE_ALIKE[1]):
        return f"brighter part has the background's texture (ratio {texture:.2f}): shading, not glint"
    if step > SHARPEST_BORDER:
        share = f"{100 * step:.0f} % of the step at once, glint at most {100 * SHARPEST_BORDER:.0f} %"
        return f"brighter part has a sharp border ({share}): a shore"
    return ""


def _doubt(separability: float, contrast: float, texture: float, step: float) -> str:
    """Criteria that pass narrowly, or an empty text."""
    narrow = []
    if separability < CLEAR_SEPARABILITY:
        narrow.append(f"separability {separability:.2f} (clear from {CLEAR_SEPARABILITY:g})")
    if contrast < CLEAR_CONTRAST:
        narrow.append(f"contrast {contrast:.1f} (clear from {CLEAR_CONTRAST:g})")
    if CLEAR_TEXTURE[0] < texture < CLEAR_TEXTURE[1]:
        narrow.append(f"texture {texture:.2f} of the background's (clear below {CLEAR_TEXTURE[0]:g} or above {CLEAR_TEXTURE[1]:g})")
    if step > CLEAR_BORDER:
        narrow.append(f"{100 * step:.0f} % of the step at the border (clear to {100 * CLEAR_BORDER:.0f} %)")
    return ", ".join(narrow)


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


def _corridor(image: FloatArray, deviation: FloatArray | None, valid: BoolArray) -> tuple[BoolArray, float, float, float, float]:
    """Brighter class with its separability, contrast, texture ratio and share of rows that it spans."""
    from scipy import ndimage

    # A quantile is shifted by single rows of missing data less than a mean is; 1/24 leaves some twenty patches a side.
    sigma = _envelope_length(image)
    excess = []
    for layer in (image,) if deviation is None else (image, deviation):
        smooth = _smoothed(layer, valid, sigma)
        excess.append(smooth - _convex_below(np.quantile(smooth, 0.1, axis=1))[:, None])
    # Mean and deviation each in units of its standard deviation: glint raises both, and neither unit should decide.
    score = sum((layer / max(float(layer.std()), np.finfo(float).tiny) for layer in excess), np.zeros(image.shape))
    threshold, separability = otsu_threshold(score)
    label, count = ndimage.label(score > threshold)
    if count == 0:
        return np.zeros(image.shape, dtype=bool), separability, 0.0, 1.0, 0.0
    largest = 1 + int(np.argmax(np.bincount(label.ravel())[1:]))
    corridor = np.asarray(ndimage.binary_fill_holes(label == largest), dtype=bool)
    inside, outside = corridor & valid, ~corridor & valid
    if not inside.any() or not outside.any():
        return corridor, separability, 0.0, 1.0, 1.0
    base = image - (_smoothed(image, valid, sigma) - excess[0])
    noise = float(base[outside].std())
    contrast = float(base[inside].mean() - base[outside].mean()) / noise if noise > 0.0 else np.inf
    if deviation is None:
        fine = np.where(valid, image, 0.0) - np.where(valid, _smoothed(image, valid, 3.0), 0.0)
    else:
        fine = np.where(valid, deviation, 0.0)
    low = float(np.sqrt(np.mean(fine[outside] ** 2)))
    texture = float(np.sqrt(np.mean(fine[inside] ** 2))) / low if low > 0.0 else np.inf
    rows = np.flatnonzero(corridor.any(axis=1))
    return corridor, separability, contrast, texture, float(np.mean(corridor[rows, 0] & corridor[rows, -1]))


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
