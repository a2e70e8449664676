"""Rays of a profile with the optical depth of their gases, kept for hazes of other winds: only the aerosol knows the wind."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, field
from typing import Final

from seaglint.air.profile.bent_ray import BentRay
from seaglint.base.conventions import FloatArray

MOST_BYTES: Final = 64 << 20  #: Bytes of kept rays of a profile on some channels.


@dataclass(frozen=True, eq=False)
class GasRay:
    """Way through the air, with what no haze changes."""

    ray: BentRay | None  #: The ray; None for a path between two heights.
    height: FloatArray  #: Heights of the cuts [m, (cuts + 1,)].
    length: FloatArray  #: Lengths of the cuts [m, (cuts,)].
    #: Optical depth of the gases from the start to the ends of the pieces [1, (pieces, n)], or of the whole way [1, (n,)].
    depth: FloatArray
    glow: FloatArray | None = None  #: Mean Planck radiance of the pieces [W m-2 sr-1 per cm-1, (pieces, n)]; None where it is not needed.

    @property
    def size(self) -> int:
        """Bytes."""
        return self.height.nbytes + self.length.nbytes + self.depth.nbytes + (0 if self.glow is None else self.glow.nbytes)


@dataclass(eq=False)
class GasRays:
    """Rays of one profile on some channels; the oldest go when there are more than :data:`MOST_BYTES`."""

    _held: OrderedDict[Hashable, GasRay] = field(default_factory=OrderedDict)
    _size: int = 0
    _lock: threading.Lock = field(default_factory=threading.Lock)

    def get(self, key: Hashable, make: Callable[[], GasRay]) -> GasRay:
        """Return the ray of a key, made where it is not there."""
        return self.get_each([key], lambda _: [make()])[0]

    def get_each(self, keys: Sequence[Hashable], make: Callable[[Sequence[int]], Sequence[GasRay]]) -> list[GasRay]:
        """Return the rays of keys; those that are not there are made in one go, by their positions among the keys."""
        found: dict[Hashable, GasRay] = {}
        with self._lock:
            for key in keys:
                held = self._held.get(key)
                if held is not None:
                    self._held.move_to_end(key)
                    found[key] = held
        missing = [k for k, key in enumerate(keys) if key not in found]
        if missing:
            made = {keys[k]: ray for k, ray in zip(missing, make(missing), strict=True)}
            found |= made
            with self._lock:
                for key, ray in made.items():
                    if key not in self._held:
                        self._held[key] = ray
                        self._size += ray.size
                while self._size > MOST_BYTES and len(self._held) > 1:
                    self._size -= self._held.popitem(last=False)[1].size
        return [found[key] for key in keys]
