"""Choice of the law of a texture by the false alarms of pictures that its fit has not seen.

The data are divided into two halves. Each law is fitted to one half and judged by the other, and the reverse: the rates above 3 and 3.5
standard deviations of the Laplacian of a sample, over those of the half. A ratio has an interval (``seaglint.clutter.rate_ratios``); the
deviate of a law is the logarithm of the ratio over the half-width of the interval of the half alone, so that a law of uncertain rates gains
nothing. The law with the smallest root mean square of its deviates is chosen, or the first in order that is about as good.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import DataError, DomainError
from seaglint.base.free_form import JsonObject
from seaglint.clutter.false_alarms import FalseAlarmRate
from seaglint.clutter.rate_ratios import RateRatio, rate_ratio
from seaglint.textures.gauss_markov import Offset
from seaglint.textures.gaussian_texture import NAMES, FieldsOf, GaussianTexture, LawName, TextureLaw
from seaglint.textures.long_tails import THRESHOLDS, laplacian_alarms

Frames = NDArray[np.float32]

#: Laws among which the fit chooses, in order of preference: the simpler first, and a slow scale before none, as most pictures have one.
LAWS: Final = (
    TextureLaw("gaussian"),
    TextureLaw("gamma"),
    TextureLaw("lognormal"),
    TextureLaw("k"),
    TextureLaw("empirical"),
    TextureLaw("gaussian", scaled=True),
    TextureLaw("empirical", scaled=True),
    TextureLaw("noise", scaled=True),
    TextureLaw("noise"),
)

UNJUDGED: Final = TextureLaw("empirical")  #: TextureLaw of a picture that is too small to be divided.

SAMPLED: Final = 300_000  #: Number of pixels of the sample of a law.

JUDGED: Final = 400_000  #: Largest number of pixels of a half by which laws are judged.

ALIKE: Final = 0.15  #: Difference of the mean deviates of two laws below which the simpler one is chosen [1].

FRAMES: Final = 16  #: Least number of frames that are divided in time.

LEAST_SIDE: Final = 24  #: Least number of rows and columns of a half [px].


@dataclass(frozen=True)
class JudgedLaw:
    """Law with the ratios of its rates to those of the halves that it has not seen."""

    law: TextureLaw
    ratios: tuple[
        RateRatio, ...
    ]  #: Of the second and of the first half at 3 and 3.5 standard deviations; empty where no field could be fitted.
    deviates: tuple[float, ...] = ()  #: Deviates of the rates of samples from those of the halves [1]; see ``deviate``.
    reason: str | None = None  #: Reason why no field could be fitted.

    @property
    def deviate(self) -> float:
        """Root mean square deviate [1]; below 1 the rates agree with the halves. Infinite where the law could not be judged."""
        return math.sqrt(sum(value**2 for value in self.deviates) / len(self.deviates)) if self.deviates else math.inf

    @property
    def agrees(self) -> bool:
        """True if the intervals of all rates contain the rates of samples."""
        return bool(self.deviates) and max(self.deviates) <= 1.0

    def as_dict(self) -> JsonObject:
        """Return plain numbers and words."""
        labels = [(half, threshold) for half in (2, 1) for threshold in THRESHOLDS]
        rows = [
            {"unseen_half": half, "threshold_sigma": m, "ratio": r.value, "interval": r.interval, "note": r.note}
            for (half, m), r in zip(labels, self.ratios, strict=False)
        ]
        known = self.deviate if self.deviates else None
        return {"law": self.law.name, "deviate": known, "agrees": self.agrees, "ratios": rows, "reason": self.reason}

    @property
    def text(self) -> str:
        """Law and ratios in words."""
        if self.reason is not None:
            return f"{self.law.name}: {self.reason}"
        labelled = [f"{ratio.text} above {m:g} sigma" for ratio, m in zip(self.ratios, THRESHOLDS * 2, strict=False)]
        half = len(THRESHOLDS)
        return f"{self.law.name}: {', '.join(labelled[:half])} in the second half, {', '.join(labelled[half:])} in the first"


def deviate(data: FalseAlarmRate, sampled: FalseAlarmRate) -> float | None:
    """Return how far the rate of a sample lies from the rate of data, over the half-width of the interval of the data on its side [1].

    Both in logarithms, so that the interval of the data alone decides, for all laws alike: above 1 it leaves the rate of the sample out.
    None without an interval.
    """
    if data.rate_low is None or data.rate_high is None or data.pixels == 0 or sampled.pixels == 0:
        return None
    # Half an exceedance replaces none.
    own, other = (max(rate.exceedances, 0.5) / rate.pixels for rate in (data, sampled))
    end = data.rate_high if other > own else max(data.rate_low, 1e-3 * own)
    width = max(abs(math.log(end / own)), 1e-9)
    return abs(math.log(other / own)) / width


def halves(data: Frames) -> tuple[Frames, Frames] | None:
    """Divide data where half of the pixels that count lie on either side.

    In time from 16 frames on, else into a left and a right, or an upper and a lower part; None if a part would be too small.
    """
    frames, rows, columns = data.shape
    known = np.isfinite(data)
    if frames >= FRAMES:
        middle = _middle(known.sum(axis=(1, 2)), FRAMES // 2)
        return data[:middle], data[middle:]
    if columns >= 2 * LEAST_SIDE and (columns >= rows or rows < 2 * LEAST_SIDE):
        middle = _middle(known.sum(axis=(0, 1)), LEAST_SIDE)
        return data[:, :, :middle], data[:, :, middle:]
    if rows >= 2 * LEAST_SIDE:
        middle = _middle(known.sum(axis=(0, 2)), LEAST_SIDE)
        return data[:, :middle], data[:, middle:]
    return None


def _middle(counts: NDArray[np.int64], least: int) -> int:
    """Return where the sum of counts is nearest to half, not nearer to an end than ``least``."""
    total = np.cumsum(counts)
    middle = 1 + int(np.argmin(np.abs(total - 0.5 * total[-1])))
    return min(max(middle, least), counts.size - least)


def _judged_part(part: Frames) -> Frames:
    """Return a half of at most ``JUDGED`` pixels: its middle frames, or its middle."""
    frames, rows, columns = part.shape
    if part.size <= JUDGED:
        return part
    count = min(max(JUDGED // (rows * columns), 1), frames)
    share = math.sqrt(min(JUDGED / (count * rows * columns), 1.0))
    sizes = (count, int(share * rows), int(share * columns))
    firsts = [(n - size) // 2 for n, size in zip(part.shape, sizes, strict=True)]
    return part[tuple(slice(first, first + size) for first, size in zip(firsts, sizes, strict=True))]


def laplacian_rates(frames: Frames) -> list[FalseAlarmRate]:
    """Return the rates of the Laplacian of pictures above ``THRESHOLDS``, each in standard deviations of its frame."""
    return laplacian_alarms(frames).rates()


def sampled_rates(texture: GaussianTexture, shape: Sequence[int], seed: int) -> list[FalseAlarmRate]:
    """Return the rates of samples of a texture in frames of a size, each in standard deviations of its frame.

    Parameters
    ----------
    texture : GaussianTexture
    shape : (int, int, int)
        Frames, rows and columns of the pictures that are judged. A single picture is sampled several times.
    seed : int
        Seed of the sample.
    """
    deep, rows, columns = (1 if texture.reach[0] == 0 else max(shape[0], 2 * texture.reach[0] + 1)), *shape[1:]
    count = max(SAMPLED // (deep * rows * columns), 1)
    down = max(int(math.sqrt(count * columns / rows)), 1)
    across = max(-(-count // down), 1)
    least = [2 * far + 1 for far in texture.reach[1:]]
    torus = (deep, max(down * rows, least[0]), max(across * columns, least[1]))
    field = texture.sample(torus, seed)
    tiles = field[:, : down * rows, : across * columns].reshape(deep, down, rows, across, columns)
    return laplacian_rates(np.ascontiguousarray(tiles.transpose(1, 3, 0, 2, 4)).reshape(-1, rows, columns))


def judge_laws(parts: tuple[Frames, Frames], laws: Sequence[TextureLaw], offsets: Sequence[Offset], seed: int) -> list[JudgedLaw]:
    """Fit laws to each half and compare their rates with those of the other half.

    Parameters
    ----------
    parts : (ndarray, ndarray), each (frames, rows, columns)
        Both halves [u].
    laws : sequence of TextureLaw
    offsets : sequence of (int, int, int)
        Neighbours of the field.
    seed : int
        Seed of the samples.

    Raises
    ------
    DataError
        A half with too few pixels that count.
    """
    ratios: dict[TextureLaw, list[RateRatio]] = {law: [] for law in laws}
    deviates: dict[TextureLaw, list[float]] = {law: [] for law in laws}
    reasons: dict[TextureLaw, str] = {}
    first, second = map(_judged_part, parts)
    for seen, other in ((first, second), (second, first)):
        fields, rates = FieldsOf(seen, offsets=offsets, coarse=True), laplacian_rates(other)
        for law in laws:
            try:
                sampled = sampled_rates(fields.fit(law).texture, other.shape, seed)
            except (DataError, DomainError) as error:
                reasons[law] = str(error)
                continue
            ratios[law] += [rate_ratio(a, b) for a, b in zip(rates, sampled, strict=True)]
            deviates[law] += [value for a, b in zip(rates, sampled, strict=True) if (value := deviate(a, b)) is not None]
    return [
        JudgedLaw(law, (), (), reasons[law]) if law in reasons else JudgedLaw(law, tuple(ratios[law]), tuple(deviates[law])) for law in laws
    ]


def candidates(tails: LawName | Literal["auto"], product: bool | None) -> tuple[TextureLaw, ...]:
    """Return the laws that are judged: all of them, or those of one distribution; with a slow scale, without, or both.

    Examples
    --------
    >>> [law.name for law in candidates("gamma", None)]
    ['gamma values', 'gamma values times a slow scale']
    """
    laws: tuple[TextureLaw, ...]
    if tails != "auto" and tails not in NAMES:
        raise DomainError(f"tails = {tails!r}; allowed are auto, {', '.join(NAMES)}")
    if product not in (None, True, False):
        raise DomainError(f"product = {product!r}; allowed are True, False and None, which lets the rates decide")
    if tails == "auto":
        laws = LAWS
    elif tails == "gaussian" and product is None:
        laws = (TextureLaw("gaussian"),)
    else:
        laws = (TextureLaw(tails), TextureLaw(tails, scaled=True))
    return tuple(law for law in laws if product in (None, law.scaled))


def choose_law(judged: Sequence[JudgedLaw]) -> JudgedLaw:
    """Return the law with the smallest deviate, or the first one that is about as good."""
    least = min(one.deviate for one in judged)
    return next(one for one in judged if one.deviate <= least + ALIKE)


def reasons(chosen: JudgedLaw, judged: Sequence[JudgedLaw]) -> tuple[str, ...]:
    """Return why a law was chosen, in sentences for a report."""
    if not chosen.deviates:
        return (f"law: {chosen.law.name}, not judged: {chosen.reason or 'the rates of the halves have no intervals'}",)
    out = [f"law (rates of samples over those of the half that the fit has not seen): {chosen.text}"]
    others = [one for one in judged if one is not chosen and one.ratios]
    if others:
        near = min(others, key=lambda one: one.deviate)
        better = "; about as good, and the simpler law is taken" if near.deviate <= chosen.deviate else ""
        out.append(f"next best law: {near.text}{better}")
    if chosen.agrees and others:
        out.append(f"{sum(one.agrees for one in judged)} of {len(judged)} laws agree with the rates of both halves")
    elif not chosen.agrees:
        out.append(
            f"{'no' if others else 'this'} law {'has' if others else 'does not have'} the rates of both halves within their intervals: the "
            "halves differ, or their tails have another cause; rates of samples are not certain"
        )
    return tuple(out)
