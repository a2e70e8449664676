"""Committed pictures stay small: ``python docs/figures/pictures.py FILE.png ...`` reduces those above 300 kB to 256 colours."""

from __future__ import annotations

import sys
from pathlib import Path

from PIL import Image

LARGE = 300_000
"""Bytes above which a picture is reduced."""


def slim(path: Path) -> Path:
    """Reduce a large PNG to 256 colours, without dithering, where that makes it smaller."""
    if path.stat().st_size > LARGE:
        before = path.stat().st_size
        reduced = Image.open(path).convert("RGB").quantize(256, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
        reduced.save(path.with_suffix(".slim"), "PNG", optimize=True)
        if path.with_suffix(".slim").stat().st_size < before:
            path.with_suffix(".slim").replace(path)
        else:
            path.with_suffix(".slim").unlink()
    return path


if __name__ == "__main__":
    for name in sys.argv[1:]:
        print(name, slim(Path(name)).stat().st_size)
