"""Run the scripts of docs/gallery and keep their pictures in docs/images/gallery, each below 100 kB, with a small one for overviews.

    python docs/figures/make_gallery.py                       all of them
    python docs/figures/make_gallery.py panorama night        some of them
    python docs/figures/make_gallery.py --small -o /tmp/look  at reduced size, elsewhere

Every script writes one picture of its own name into the folder that it runs in. A picture stays PNG where 256 colours keep it small
enough, else it becomes JPEG.
"""

from __future__ import annotations

import argparse
import io
import os
import runpy
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import matplotlib
from PIL import Image

ROOT = Path(__file__).resolve().parents[2]
SCRIPTS = ROOT / "docs" / "gallery"
IMAGES = ROOT / "docs" / "images" / "gallery"
MOST_BYTES = 100_000
THUMBNAIL_WIDTH = 360


def names() -> list[str]:
    """Names of all scripts."""
    return sorted(path.stem for path in SCRIPTS.glob("*.py"))


def encoded(picture: Image.Image) -> tuple[str, bytes]:
    """Ending and bytes of a picture, below the most."""
    tries: list[tuple[str, Callable[[io.BytesIO], None]]] = [
        ("png", lambda out: picture.quantize(256, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE).save(out, "PNG", optimize=True))
    ]
    tries += [("jpg", lambda out, q=q: picture.save(out, "JPEG", quality=q, optimize=True)) for q in (88, 80, 70, 60)]  # type: ignore[misc]
    for ending, write in tries:
        out = io.BytesIO()
        write(out)
        if out.tell() < MOST_BYTES:
            return ending, out.getvalue()
    raise SystemExit(f"a picture of {picture.size} pixels stays above {MOST_BYTES} bytes; draw it smaller")


def draw(name: str, *, small: bool = False) -> Image.Image:
    """Picture that a script draws."""
    import matplotlib.pyplot as plt

    matplotlib.use("Agg")
    before, size = Path.cwd(), os.environ.pop("SEAGLINT_GALLERY_SIZE", None)
    if small:
        os.environ["SEAGLINT_GALLERY_SIZE"] = "small"
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        try:
            runpy.run_path(str(SCRIPTS / f"{name}.py"), run_name="__main__")
            return Image.open(f"{name}.png").convert("RGB")
        finally:
            os.chdir(before)
            plt.close("all")
            os.environ.pop("SEAGLINT_GALLERY_SIZE", None)
            if size is not None:
                os.environ["SEAGLINT_GALLERY_SIZE"] = size


def keep(name: str, picture: Image.Image, folder: Path) -> Path:
    """Write a picture and its small one; return the large one's path."""
    (folder / "small").mkdir(parents=True, exist_ok=True)
    for old in (folder / f"{name}.png", folder / f"{name}.jpg"):
        old.unlink(missing_ok=True)
    ending, content = encoded(picture)
    path = folder / f"{name}.{ending}"
    path.write_bytes(content)
    thumbnail = picture.copy()
    thumbnail.thumbnail((THUMBNAIL_WIDTH, THUMBNAIL_WIDTH))
    thumbnail.save(folder / "small" / f"{name}.jpg", quality=80, optimize=True)
    return path


def main() -> None:
    """Draw those named, or all."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("names", nargs="*", help="scripts; all by default")
    parser.add_argument("--small", action="store_true", help="at the reduced size of the tests")
    parser.add_argument("-o", "--output", type=Path, default=IMAGES, help="folder of the pictures")
    given = parser.parse_args()
    if unknown := sorted(set(given.names) - set(names())):
        sys.exit(f"{', '.join(unknown)}: not one of {', '.join(names())}")
    for name in given.names or names():
        start = time.perf_counter()
        path = keep(name, draw(name, small=given.small), given.output)
        print(f"{path.name}  {path.stat().st_size / 1e3:.0f} kB  {time.perf_counter() - start:.1f} s", flush=True)


if __name__ == "__main__":
    main()
