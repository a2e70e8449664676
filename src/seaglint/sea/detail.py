"""Levels of detail: the same sea without its shortest waves, about one octave less at each level.

Each tile of a :class:`~seaglint.sea.field.WaveField` comes as it is and low-passed on lattices of half, a quarter, ... of its points,
as long as waves are left. A level is a choice of one version of every tile that still has waves. What a level leaves out belongs to
the facets.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from seaglint.sea.field import WaveField
from seaglint.sea.tiles import longest_wave_number

NARROWEST: Final = 1.5  #: Least ratio of the upper limit of a low-passed tile to its lowest wavenumber; a narrower tile is omitted.

SMALLEST: Final = 16  #: Fewest lattice points along a side of a low-passed tile.


@dataclass(frozen=True)
class Level:
    """One level of detail: the tiles of the sea that it contains."""

    parts: tuple[int, ...]  #: Versions of tiles, by their place in :attr:`Detail.parts`, longest waves first.
    shortest_wave: float  #: Length of the shortest wave kept [m].
    mss: tuple[float, float]  #: Slope variance (up, cross) of its waves [1].
    covariance: float = 0.0  #: Covariance of its slopes along the wind and to the right of it [1].


@dataclass(frozen=True, eq=False)
class Detail:
    """Levels of detail of a sea, finest first, and the versions of its tiles that they consist of.

    The coarsest level still has the energetic waves.
    """

    parts: tuple[WaveField, ...]
    levels: tuple[Level, ...]

    @classmethod
    def calm(cls) -> Detail:
        """Levels of detail of a sea without waves: one empty level."""
        return cls((), (Level((), float("inf"), (0.0, 0.0)),))

    @classmethod
    def of(cls, waves: WaveField, levels: int | None = None) -> Detail:
        """Levels of detail of a sea; ``levels`` limits their number (1: the full sea alone)."""
        longest = longest_wave_number(waves.spectrum)
        parts: list[WaveField] = []
        versions: list[list[int]] = []
        for i, tile in enumerate(waves.tiles):
            part, chain = waves.only(i), []
            least = NARROWEST * max(tile.k_min, longest)
            while True:
                chain.append(len(parts))
                parts.append(part)
                held = part.tiles[0]
                if 0.5 * held.k_max < least or held.n // 2 < SMALLEST or (held.n // 2) % 4:
                    break
                part = part.halved()
            versions.append(chain)
        chosen = [[chain[0] for chain in versions[: i + 1]] for i in range(len(versions))]
        selections = [
            (*first[:-1], version)  # whole longer tiles, and the last one's versions
            for first, chain in zip(reversed(chosen), reversed(versions), strict=True)
            for version in chain
        ]
        every = cls(tuple(parts), tuple(_level(parts, level) for level in selections[:levels]))
        return every.first(len(every.levels))

    def first(self, levels: int) -> Detail:
        """Return the finest levels alone, with the parts that they need."""
        used = self.levels[:levels]
        used_parts = sorted({p for level in used for p in level.parts})
        place = {p: i for i, p in enumerate(used_parts)}
        return Detail(tuple(self.parts[p] for p in used_parts), tuple(replace(v, parts=tuple(place[p] for p in v.parts)) for v in used))

    def surfaces(self, time: float, workers: int = 1) -> tuple[NDArray[np.float32], ...]:
        """Lattices of every part at one time [s], from which heights and slopes are read (:meth:`WaveField.coefficients`)."""
        return tuple(part.coefficients(time, workers)[0] for part in self.parts)


def _level(parts: list[WaveField], level: tuple[int, ...]) -> Level:
    mss = np.sum([parts[p].resolved_mss() for p in level], axis=0)
    covariance = sum(parts[p].resolved_covariance() for p in level)
    return Level(level, 2.0 * np.pi / parts[level[-1]].tiles[0].k_max, (float(mss[0]), float(mss[1])), covariance)
