"""Measure the coverage of the intervals of ratios of false-alarm rates on synthetic fields of known rates.

Usage: ``python benchmarks/rate_ratio_intervals.py [--pairs N] [--draws N] [--seed S]``; the table is in docs/validation/textures.md.
Ten kinds of pictures and clips, N pairs of each: both of one kind, or of two. The true ratio is the ratio of the mean rates of ``--draws``
pictures of each kind, which no pair contains.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.fft import irfftn, rfftn
from scipy.special import gammaincinv, ndtr

from seaglint.base.conventions import FloatArray
from seaglint.clutter.rate_ratios import rate_ratio
from seaglint.textures.law_choice import laplacian_rates
from seaglint.textures.long_tails import THRESHOLDS

Shape = tuple[int, int, int]


def correlated(generator: np.random.Generator, shape: Shape, lengths: tuple[float, float, float], *, smooth: bool = False) -> FloatArray:
    """Return a Gaussian field of mean 0 and variance 1, cut from a torus twice as large; lengths in frames, rows and columns."""
    size = [2 * n if n > 1 else 1 for n in shape]
    waves = np.meshgrid(np.fft.fftfreq(size[0]), np.fft.fftfreq(size[1]), np.fft.rfftfreq(size[2]), indexing="ij")
    square = sum((2.0 * np.pi * wave * length) ** 2 for wave, length in zip(waves, lengths, strict=True))
    gain = np.exp(-0.25 * square) if smooth else (1.0 + square) ** -0.9
    weight = np.full(size[2] // 2 + 1, 2.0)
    weight[[0, -1]] = 1.0
    field = irfftn(rfftn(generator.standard_normal(size)) * gain, size) / np.sqrt(float((weight * gain**2).sum()) / np.prod(size))
    return np.asarray(field[: shape[0], : shape[1], : shape[2]])


def gamma(field: FloatArray, shape: float) -> FloatArray:
    """Return gamma distributed values of a Gaussian field."""
    return np.asarray(gammaincinv(shape, ndtr(field)))


@dataclass(frozen=True)
class Kind:
    """Kind of pictures or clips."""

    name: str
    shape: Shape
    draw: Callable[[np.random.Generator, Shape], FloatArray]


def _slow(spread: float, length: float) -> Callable[[np.random.Generator, Shape], FloatArray]:
    return lambda g, s: correlated(g, s, (0.3, 1, 1)) * np.exp(spread * correlated(g, s, (2, length, length), smooth=True))


KINDS = (
    Kind("Gaussian, 1 px", (1, 120, 160), lambda g, s: correlated(g, s, (0.3, 1, 1.5))),
    Kind("Gaussian, 3 x 6 px", (1, 90, 200), lambda g, s: correlated(g, s, (0.3, 3, 6))),
    Kind("gamma values of shape 2", (1, 100, 130), lambda g, s: gamma(correlated(g, s, (0.3, 1, 2)), 2.0)),
    Kind("gamma values of shape 8, 2 x 4 px", (1, 180, 260), lambda g, s: gamma(correlated(g, s, (0.3, 2, 4)), 8.0)),
    Kind("lognormal values", (1, 80, 120), lambda g, s: np.exp(0.35 * correlated(g, s, (0.3, 1, 2)))),
    Kind("slow scale of 12 px", (1, 120, 160), _slow(0.3, 12.0)),
    Kind("slow scale of 20 px", (1, 200, 300), _slow(0.25, 20.0)),
    Kind(
        "long-tailed noise",
        (1, 70, 140),
        lambda g, s: correlated(g, s, (0.3, 1, 1)) * np.sqrt(gamma(correlated(g, s, (0.3, 0.3, 0.3), smooth=True), 1.5)),
    ),
    Kind("clip of gamma values", (12, 64, 64), lambda g, s: gamma(correlated(g, s, (2, 1, 2)), 3.0)),
    Kind("clip with a slow scale", (12, 80, 80), _slow(0.3, 10.0)),
)


def main() -> None:
    """Draw, count, print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pairs", type=int, default=50, help="of each kind (default 50: 500 pairs)")
    parser.add_argument("--draws", type=int, default=150, help="pictures of each kind whose mean rate is taken as true")
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()

    def rates(kind: int, number: int) -> list:  # type: ignore[type-arg]
        generator = np.random.default_rng([given.seed, kind, number])
        return laplacian_rates(KINDS[kind].draw(generator, KINDS[kind].shape).astype(np.float32))

    true, drawn = [], []
    for k in range(len(KINDS)):
        true.append(np.mean([[rate.rate for rate in rates(k, i)] for i in range(given.draws)], axis=0))
        drawn.append([rates(k, given.draws + i) for i in range(2 * given.pairs)])
    print("| first picture | second picture | true ratio at 3 and 3.5 sigma | contained | mean width (factor up and down) |")
    print("| --- | --- | --- | --- | --- |")
    hits = total = 0
    for k, kind in enumerate(KINDS):
        # Every other pair is of two kinds.
        other = (k + 3) % len(KINDS)
        contained, widths, count = 0, [], 0
        for i in range(given.pairs):
            second = k if i % 2 == 0 else other
            for q in range(len(THRESHOLDS)):
                ratio = rate_ratio(drawn[k][i][q], drawn[second][given.pairs + i][q])
                if ratio.low is None:
                    continue
                high = np.inf if ratio.high is None else ratio.high
                count += 1
                contained += bool(ratio.low <= true[second][q] / true[k][q] <= high)
                if ratio.low > 0.0 and np.isfinite(high):
                    widths.append(0.5 * np.log(high / ratio.low))
        expected = " and ".join(f"{a:.3g}" for a in true[other] / true[k])
        print(f"| {kind.name} | the same; {KINDS[other].name} | 1; {expected} | {contained} of {count} | {np.exp(np.mean(widths)):.2f} |")
        hits, total = hits + contained, total + count
    print(f"\n{hits} of {total} intervals contain the true ratio: {100.0 * hits / total:.1f} %")


if __name__ == "__main__":
    main()
