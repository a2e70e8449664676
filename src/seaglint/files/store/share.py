"""Shares of a sequence for batch arrays: each share has its own units, without a scheduler."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

from seaglint.base.errors import DataError


@dataclass(frozen=True)
class Share:
    """Units ``index``, ``index + count``, ... of a sequence."""

    index: int  #: Index of the share, counted from 0.
    count: int

    @classmethod
    def parse(cls, text: str) -> Share:
        """Parse a text ``i/n``.

        >>> Share.parse("2/7")
        Share(index=2, count=7)

        Raises
        ------
        DataError
            Another form, or a share that is not there.
        """
        match = re.fullmatch(r"\s*(\d{1,9})\s*/\s*(\d{1,9})\s*", text)
        if match is None or not int(match[1]) < int(match[2]):
            raise DataError(f"shard='{text}' is no share of the work; give i/n, counted from 0: the first of four is 0/4, the last 3/4")
        return cls(int(match[1]), int(match[2]))

    def __str__(self) -> str:
        return f"{self.index}/{self.count}"

    def units(self, count: int) -> range:
        """Return the share's units of ``count``; none where there are fewer units than shares.

        >>> list(Share(1, 2).units(5)), list(Share(6, 7).units(5))
        ([1, 3], [])
        """
        return range(self.index, count, self.count)


def shares_of(units: Iterable[int], counts: Iterable[int]) -> str:
    """Return as text the shares to which units belong, where the work was divided into ``counts`` shares.

    >>> shares_of([1, 3, 4], [2])
    '0/2, 1/2'
    """
    held = sorted(set(units))
    return ", ".join(str(Share(i, n)) for n in counts for i in sorted({unit % n for unit in held}))
