"""Run the scripts of docs/gallery and keep their pictures in docs/images/gallery, each below 100 kB, with a small one for overviews.

    python docs/figures/make_gallery.py                       all of them
    python docs/figures/make_gallery.py panorama night        some of them
    python docs/figures/make_gallery.py --small -o /tmp/look  at reduced size, elsewhere

Every script writes one picture of its own name into the folder that it runs in. A picture stays PNG where that is small enough, else it
becomes JPEG. Its small picture is the same figure drawn anew: one panel at one size for all, without title, legend and colour bar, so that
the words of its axes can be read.
"""

from __future__ import annotations

import argparse
import io
import os
import runpy
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any
from unittest import mock

import matplotlib
from PIL import Image, ImageOps

import pictures

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

ROOT = Path(__file__).resolve().parents[2]
SCRIPTS = ROOT / "docs" / "gallery"
IMAGES = ROOT / "docs" / "images" / "gallery"
MOST_BYTES = 100_000
MOST_SMALL_BYTES = 34_000
SMALL = (480, 320)
"""Width and height of a small picture [pixels], twice what pages show."""
SMALL_INCHES = (3.6, 2.4)
WORDS = 10.0
"""Size of words of a small picture [points]: 9 pixels as pages show it."""
PANELS = {"glint_winds": 1, "layers": 3, "sun_heights": 2}
"""Panel that a small picture shows, where it is not the first."""


def names() -> list[str]:
    """Names of all scripts."""
    return sorted(path.stem for path in SCRIPTS.glob("*.py"))


def jpeg(picture: Image.Image, most: int) -> bytes:
    """Picture as JPEG of the best quality below a number of bytes."""
    for quality in (88, 80, 70, 60, 50, 40):
        out = io.BytesIO()
        picture.save(out, "JPEG", quality=quality, optimize=True)
        if out.tell() < most:
            return out.getvalue()
    raise SystemExit(f"a picture of {picture.size} pixels stays above {most} bytes; draw it smaller")


def encoded(picture: Image.Image) -> tuple[str, bytes]:
    """Ending and bytes of a picture, below the most."""
    content = pictures.encoded(picture)
    return ("png", content) if len(content) < MOST_BYTES else ("jpg", jpeg(picture, MOST_BYTES))


def thin(axis: Axis) -> None:
    """Leave few ticks and a label that fits; a long label loses its unit, and is left out where that is not enough."""
    from matplotlib.ticker import FixedLocator, LogLocator, MaxNLocator

    locator, formatter = axis.get_major_locator(), axis.get_major_formatter()
    if isinstance(locator, FixedLocator) and len(ticks := list(locator.locs)) > 5:
        labels = [formatter(tick, place) for place, tick in enumerate(ticks)]
        axis.set_ticks(ticks[::2], labels[::2])
    elif isinstance(locator, LogLocator):
        locator.set_params(numticks=4)
    elif isinstance(locator, MaxNLocator):
        locator.set_params(nbins=4)
    axis.set_tick_params(labelsize=WORDS)
    axis.label.set_size(WORDS)
    most = 36 if axis.axis_name == "x" else 24
    label = axis.label.get_text()
    axis.label.set_text(next((text for text in (label, label.partition(" [")[0]) if len(text) <= most), ""))


def thumbnail(figure: Figure, panel: int = 0) -> Image.Image:
    """Draw one panel of a figure small; the figure is not drawn again afterwards."""
    bars = [axes._colorbar for axes in figure.axes if getattr(axes, "_colorbar", None)]  # type: ignore[attr-defined]
    for bar in bars:
        bar.remove()
    axes: Axes = figure.axes[panel]
    twins = axes.get_shared_x_axes().get_siblings(axes)
    for other in [other for other in figure.axes if other is not axes and (other not in twins or other.bbox.bounds != axes.bbox.bounds)]:
        other.remove()
    figure.suptitle("")
    axes.set_title("")
    axes.set_subplotspec(figure.add_gridspec(1, 1)[0])
    axes.set_anchor("C")  # colour bars draw it to one side
    for piece in [*axes.texts, *filter(None, [axes.get_legend()]), *figure.legends]:
        piece.remove()
    if axes.name == "rectilinear":
        axes.tick_params(labelbottom=True, labelleft=True)  # panels that share an axis hide them
    thin(axes.xaxis)
    thin(axes.yaxis)
    figure.set_size_inches(*SMALL_INCHES)
    out = io.BytesIO()
    figure.savefig(out, format="png", dpi=SMALL[0] / SMALL_INCHES[0])
    return Image.open(out).convert("RGB")


def draw(name: str, *, small: bool = False) -> tuple[Image.Image, Image.Image]:
    """Picture that a script draws, and its small one."""
    import matplotlib.pyplot as plt
    from matplotlib.figure import Figure

    matplotlib.use("Agg")
    before, size = Path.cwd(), os.environ.pop("SEAGLINT_GALLERY_SIZE", None)
    if small:
        os.environ["SEAGLINT_GALLERY_SIZE"] = "small"
    figures: list[Figure] = []
    write = Figure.savefig

    def noted(figure: Figure, *arguments: Any, **options: Any) -> None:
        figures.append(figure)
        write(figure, *arguments, **options)

    with tempfile.TemporaryDirectory() as folder, mock.patch.object(Figure, "savefig", noted):
        os.chdir(folder)
        try:
            runpy.run_path(str(SCRIPTS / f"{name}.py"), run_name="__main__")
            picture = Image.open(f"{name}.png").convert("RGB")
            return picture, thumbnail(figures[0], PANELS.get(name, 0))
        finally:
            os.chdir(before)
            plt.close("all")
            os.environ.pop("SEAGLINT_GALLERY_SIZE", None)
            if size is not None:
                os.environ["SEAGLINT_GALLERY_SIZE"] = size


def keep(name: str, picture: Image.Image, small: Image.Image, folder: Path) -> Path:
    """Write a picture and its small one; return the large one's path."""
    (folder / "small").mkdir(parents=True, exist_ok=True)
    for old in (folder / f"{name}.png", folder / f"{name}.jpg"):
        old.unlink(missing_ok=True)
    ending, content = encoded(picture)
    path = folder / f"{name}.{ending}"
    path.write_bytes(content)
    (folder / "small" / f"{name}.jpg").write_bytes(jpeg(ImageOps.pad(small, SMALL, color="white"), MOST_SMALL_BYTES))
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
        path = keep(name, *draw(name, small=given.small), given.output)
        print(f"{path.name}  {path.stat().st_size / 1e3:.0f} kB  {time.perf_counter() - start:.1f} s", flush=True)


if __name__ == "__main__":
    main()
