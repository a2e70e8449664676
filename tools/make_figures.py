"""Draw the pictures of the README and the documentation into docs/images, from examples/demo.toml, as the commands do.

    python tools/make_figures.py

``demo.png`` is the picture of ``./run demo`` (its first frame), ``mean.png`` that of ``seaglint mean examples/demo.toml --preview``.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SCENARIO = ROOT / "examples" / "demo.toml"
IMAGES = ROOT / "docs" / "images"


def seaglint(*arguments: str | Path) -> None:
    """Run the command line."""
    subprocess.run([sys.executable, "-m", "seaglint.cli.app", *map(str, arguments)], check=True)


def main() -> None:
    """Draw both."""
    IMAGES.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        run, mean = Path(folder) / "run.zarr", Path(folder) / "mean.nc"
        seaglint("render", SCENARIO, "-o", run, "--frames", "0:1", "--preview")
        seaglint("mean", SCENARIO, "-o", mean, "--preview")
        shutil.copy(run.with_suffix(".png"), IMAGES / "demo.png")
        shutil.copy(mean.with_suffix(".png"), IMAGES / "mean.png")
    for picture in sorted(IMAGES.glob("*.png")):
        print(f"{picture.relative_to(ROOT)}  {picture.stat().st_size / 1e3:.0f} kB")


if __name__ == "__main__":
    main()
