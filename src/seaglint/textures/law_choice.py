"""Choice of the law of a texture by the false alarms of pictures that its fit has not seen.

The data are divided into two halves. Each law is fitted to one half and judged by the other, and the reverse: the rates above 3 and 3.5
standard deviations of the Laplacian of a sample, over those of the half. A ratio has an interval (:mod:`seaglint.clutter.rate_ratios`); its
deviate is its logarithm over the half-width of the interval on the side of 1, beyond 1 where the interval leaves 1 out. The law with the
smallest root mean square of its deviates is chosen, or the first in order of simplicity that is about as good.
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
from seaglint.clutter.false_alarms import FalseAlarmRate, FalseAlarms
from seaglint.clutter.rate_ratios import RateRatio, rate_ratio
from seaglint.textures.gauss_markov import Offset
from seaglint.textures.gaussian_texture import FieldsOf, GaussianTexture, Law, LawName
from seaglint.textures.long_tails import interior

Frames = NDArray[np.float32]

THRESHOLDS: Final = (3.0, 3.5)  #: Thresholds of the rates [standard deviations of the filtered picture].

#: Laws among which the fit chooses, in order of preference: the simpler first, and a slow scale before none, as most pictures have one.
LAWS: Final = (
    Law("gaussian"),
    Law("gamma"),
    Law("lognormal"),
    Law("k"),
    Law("empirical"),
    Law("gaussian", scaled=True),
    Law("empirical", scaled=True),
    Law("noise", scaled=True),
    Law("noise"),
)

UNJUDGED: Final = Law("empirical")  #: Law of a picture that is too small to be divided.

SAMPLED: Final = 300_000  #: Number of pixels of the sample of a law.

ALIKE: Final = 0.15  #: Difference of the mean deviates of two laws below which the simpler one is chosen [1].

FRAMES: Final = 16  #: Least number of frames that are divided in time.

LEAST_SIDE: Final = 24  #: Least number of rows and columns of a half [px].


@dataclass(frozen=True)
class JudgedLaw:
    """Law with the ratios of its rates to those of the halves that it has not seen."""

    law: Law
    ratios: tuple[RateRatio, ...]  #: Of both halves at 3 and at 3.5 standard deviations; empty where no field could be fitted.

    @property
    def deviate(self) -> float:
        """Root mean square deviate of the ratios from 1 [1]; below 1 they agree with the halves."""
        return math.sqrt(sum(deviate(ratio) ** 2 for ratio in self.ratios) / len(self.ratios)) if self.ratios else math.inf

    @property
    def agrees(self) -> bool:
        """True if all intervals contain 1."""
        return bool(self.ratios) and all(deviate(ratio) <= 1.0 for ratio in self.ratios)

    def as_dict(self) -> JsonObject:
        """Return plain numbers and words."""
        labels = [(half, threshold) for half in (1, 2) for threshold in THRESHOLDS]
        rows = [
            {"half": half, "threshold_sigma": m, "ratio": r.value, "interval": r.interval, "note": r.note}
            for (half, m), r in zip(labels, self.ratios, strict=False)
        ]
        return {"law": self.law.name, "deviate": self.deviate if self.ratios else None, "agrees": self.agrees, "ratios": rows}

    @property
    def text(self) -> str:
        """Law and ratios in words."""
        if not self.ratios:
            return f"{self.law.name}: no field has these correlations"
        return f"{self.law.name}: {', '.join(ratio.text for ratio in self.ratios)}"


def deviate(ratio: RateRatio) -> float:
    """Return the logarithm of a ratio over the half-width of its interval on the side of 1 [1]: above 1 the interval leaves 1 out.

    Examples
    --------
    >>> round(deviate(RateRatio(0.5, 0.25, 1.0)), 3), round(deviate(RateRatio(2.0, 1.0, 8.0)), 3), deviate(RateRatio(None, None, None))
    (1.0, 1.0, 0.0)
    """
    if ratio.low is None:
        return 0.0
    if ratio.high is None:
        return 0.0 if ratio.low <= 1.0 else 1.0 + math.log(ratio.low)
    if not ratio.value:
        return 0.0 if ratio.high >= 1.0 else 1.0 - math.log(ratio.high)
    end = ratio.high if ratio.value < 1.0 else ratio.low
    width = abs(math.log(end / ratio.value)) if end > 0.0 else math.inf
    return abs(math.log(ratio.value)) / width


def halves(data: Frames) -> tuple[Frames, Frames] | None:
    """Divide data into two halves: in time from 16 frames on, else the left and right, or upper and lower ones; None if too small."""
    frames, rows, columns = data.shape
    if frames >= FRAMES:
        return data[: frames // 2], data[frames // 2 :]
    if columns >= 2 * LEAST_SIDE and (columns >= rows or rows < 2 * LEAST_SIDE):
        return data[:, :, : columns // 2], data[:, :, columns // 2 :]
    if rows >= 2 * LEAST_SIDE:
        return data[:, : rows // 2], data[:, rows // 2 :]
    return None


def laplacian_rates(frames: Frames) -> list[FalseAlarmRate]:
    """Return the rates of the Laplacian of pictures above ``THRESHOLDS``, each in standard deviations of its frame."""
    alarms = FalseAlarms(THRESHOLDS, 1, estimated=True)
    for frame in frames:
        alarms.add(interior(frame[None]))
    return alarms.rates()


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


def judge_laws(parts: tuple[Frames, Frames], laws: Sequence[Law], offsets: Sequence[Offset], seed: int) -> list[JudgedLaw]:
    """Fit laws to each half and compare their rates with those of the other half.

    Parameters
    ----------
    parts : (ndarray, ndarray), each (frames, rows, columns)
        Both halves [u].
    laws : sequence of Law
    offsets : sequence of (int, int, int)
        Neighbours of the field.
    seed : int
        Seed of the samples.
    """
    found: dict[Law, tuple[RateRatio, ...]] = dict.fromkeys(laws, ())
    lost: set[Law] = set()
    for seen, other in (parts, parts[::-1]):
        fields, rates = FieldsOf(seen, offsets=offsets), laplacian_rates(other)
        for law in laws:
            try:
                sampled = sampled_rates(fields.fit(law).texture, other.shape, seed)
            except (DataError, DomainError):
                # No field has the correlations that this law needs.
                lost.add(law)
                continue
            found[law] += tuple(rate_ratio(a, b) for a, b in zip(rates, sampled, strict=True))
    return [JudgedLaw(law, () if law in lost else found[law]) for law in laws]


def candidates(tails: LawName | Literal["auto"], product: bool | None) -> tuple[Law, ...]:
    """Return the laws that are judged: all of them, or those of one distribution; with a slow scale, without, or both.

    Examples
    --------
    >>> [law.name for law in candidates("gamma", None)]
    ['gamma values', 'gamma values times a slow scale']
    """
    laws: tuple[Law, ...]
    if tails == "auto":
        laws = LAWS
    elif tails == "gaussian" and product is None:
        laws = (Law("gaussian"),)
    else:
        laws = (Law(tails), Law(tails, scaled=True))
    return tuple(law for law in laws if product in (None, law.scaled))


def choose_law(judged: Sequence[JudgedLaw]) -> JudgedLaw:
    """Return the law with the smallest deviate, or the first one that is about as good."""
    least = min(one.deviate for one in judged)
    return next(one for one in judged if one.deviate <= least + ALIKE)


def reasons(chosen: JudgedLaw, judged: Sequence[JudgedLaw]) -> tuple[str, ...]:
    """Return why a law was chosen, in sentences for a report."""
    if not chosen.ratios:
        return (f"{chosen.law.name}: no half could be judged",)
    rates = f"sample over unseen half, above {' and '.join(f'{m:g}' for m in THRESHOLDS)} sigma of the Laplacian"
    out = [f"law: {chosen.text} ({rates}; first and second half)"]
    others = [one for one in judged if one is not chosen and one.ratios]
    if others:
        near = min(others, key=lambda one: one.deviate)
        better = "; it agrees as well, and the law that comes first in order is taken" if near.deviate <= chosen.deviate else ""
        out.append(f"next law: {near.text}{better}")
    if not chosen.agrees:
        out.append(
            "no law has the rates of both halves: the halves differ, or their tails have another cause; rates of samples are not certain"
        )
    return tuple(out)
