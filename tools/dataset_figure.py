"""Picture of the guide's page on data sets: examples of the first scenes of ``examples/small-objects.toml``.

``python tools/dataset_figure.py`` renders 18 scenes in a few minutes and writes docs/images/dataset_examples.png.
"""

from __future__ import annotations

import shutil
import tempfile
import tomllib
from pathlib import Path

from seaglint.scenario.ensemble_file import parse_ensemble
from seaglint.studies.ensemble.ensemble_dataset import DatasetOptions, EnsembleSource, ensemble_dataset

ROOT = Path(__file__).resolve().parents[1]
SCENES = 18


def main() -> None:
    """Render and copy the sheet."""
    raw = tomllib.loads((ROOT / "examples" / "small-objects.toml").read_text(encoding="utf-8"))
    # The first of the same draws: points of Sobol are the same in any number, and one frame of a scene is on the sheet.
    raw["ensemble"] |= {"scenes": SCENES, "frames": 1}
    with tempfile.TemporaryDirectory() as folder:
        made = ensemble_dataset(EnsembleSource(parse_ensemble(raw), "small-objects", None), Path(folder) / "D", DatasetOptions.of("coco"))
        print((made / "README.md").read_text(encoding="utf-8"))
        shutil.copy(made / "examples.png", ROOT / "docs" / "images" / "dataset_examples.png")


if __name__ == "__main__":
    main()
