"""Run the notebooks of ``examples``, and store their outputs and one picture of each for the gallery.

    python tools/run_notebooks.py                          run all of them; nothing is written
    python tools/run_notebooks.py training_loop            run one
    python tools/run_notebooks.py --write training_loop    store its outputs in the file, and its picture in docs/images/gallery

Each runs in an empty folder, in the interpreter that runs this tool. The picture is that of the cell with the tag ``gallery``; its small
picture is cut from it around one panel. A notebook that writes to stderr is not stored.
"""

from __future__ import annotations

import argparse
import base64
import io
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from PIL import Image

sys.path.append(str(Path(__file__).resolve().parents[1] / "docs" / "figures"))
from make_gallery import IMAGES, keep

ROOT = Path(__file__).resolve().parents[1]
EXAMPLES = ROOT / "examples"
TAG = "gallery"
PANELS = {"apparent_temperature_and_glint": (0, 42, 326, 305), "camera_and_range": (0, 30, 462, 349), "training_loop": (0, 40, 395, 230)}
"""Left, top, right and bottom of the panel that the small picture shows [pixels]; the whole picture by default."""


def names() -> list[str]:
    """Names of all notebooks."""
    return sorted(path.stem for path in EXAMPLES.glob("*.ipynb"))


def read(name: str) -> Any:
    """Notebook as it is stored."""
    import nbformat

    return nbformat.read(EXAMPLES / f"{name}.ipynb", as_version=4)


def executed(name: str, timeout: float = 300.0) -> Any:
    """Run a notebook from its first cell.

    Parameters
    ----------
    name : str
        Its name without the ending.
    timeout : float
        Longest time of a cell [s].

    Returns
    -------
    NotebookNode
        The notebook with the outputs of this run.

    Raises
    ------
    CellExecutionError
        A cell fails.
    """
    from nbclient import NotebookClient

    book = read(name)
    with tempfile.TemporaryDirectory() as folder:
        where = {"metadata": {"path": folder}}
        NotebookClient(book, timeout=timeout, kernel_name="python3", record_timing=False, resources=where).execute()
    book.metadata["language_info"] = {"name": "python"}  # without the version of the interpreter of today
    return book


def stderr(book: Any) -> list[str]:
    """What cells wrote to stderr."""
    outputs = [output for cell in book.cells for output in cell.get("outputs", [])]
    return [output["text"] for output in outputs if output.get("name") == "stderr"]


def picture(book: Any) -> Image.Image:
    """Picture that the tagged cell shows.

    Raises
    ------
    LookupError
        No tagged cell with one picture.
    """
    tagged = [cell for cell in book.cells if TAG in cell.metadata.get("tags", [])]
    found = [output["data"]["image/png"] for cell in tagged for output in cell.outputs if "image/png" in output.get("data", {})]
    if len(found) != 1:
        raise LookupError(f"{len(found)} pictures in cells with the tag '{TAG}'; tag one cell that shows one")
    return Image.open(io.BytesIO(base64.b64decode(found[0]))).convert("RGB")


def main() -> None:
    """Run those named, or all."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("names", nargs="*", help="notebooks; all by default")
    parser.add_argument("--write", action="store_true", help="store outputs and pictures")
    given = parser.parse_args()
    if unknown := sorted(set(given.names) - set(names())):
        sys.exit(f"{', '.join(unknown)}: not one of {', '.join(names())}")
    for name in given.names or names():
        start = time.perf_counter()
        book = executed(name)
        print(f"{name}  {time.perf_counter() - start:.1f} s", flush=True)
        if written := stderr(book):
            sys.exit(f"{name}: not stored, since it wrote to stderr: {written[0].strip()}")
        if given.write:
            import nbformat

            nbformat.write(book, EXAMPLES / f"{name}.ipynb")
            whole = picture(book)
            keep(name, whole, whole.crop(PANELS.get(name, (0, 0, *whole.size))), IMAGES)


if __name__ == "__main__":
    main()
