"""Signal-to-noise ratios that 8 bits keep, by the frames that share a range and the share of clipped pixels.

``python docs/figures/dataset_ranges.py`` renders 24 scenes of ``examples/small-objects.toml`` in 16 bits and prints, for each rule of the
range, the number of labels with a ratio above 3 in counts that lose more than a tenth and more than half of it.
"""

from __future__ import annotations

import json
import tempfile
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation

from seaglint.formats.dataset.dataset_writing import BLUR, local_contrast
from seaglint.formats.dataset.grey_pictures import decoded, read_picture
from seaglint.formats.dataset.picture_levels import FrameRange, PictureLevels
from seaglint.scenario.ensemble_file import parse_ensemble
from seaglint.studies.ensemble.ensemble_dataset import DatasetOptions, EnsembleSource, ensemble_dataset

ROOT = Path(__file__).resolve().parents[2]
SCENES, FRAMES = 24, 2
LEAST = 3.0
"""Ratio in counts above which a label is compared."""


def ratios(values: NDArray[Any], masks: list[NDArray[np.bool_]]) -> list[float]:
    """Ratio of each label; 0 where its surroundings have one value."""
    covered = binary_dilation(np.logical_or.reduce(masks), iterations=BLUR)
    measured = [local_contrast(values, mask, covered) for mask in masks]
    return [0.0 if one is None else one[1] for one in measured]


def main() -> None:
    """Render the scenes and print a line for each rule."""
    raw = tomllib.loads((ROOT / "examples" / "small-objects.toml").read_text(encoding="utf-8"))
    raw["ensemble"] |= {"scenes": SCENES, "frames": FRAMES}
    with tempfile.TemporaryDirectory() as place:
        source = EnsembleSource(parse_ensemble(raw), "small-objects", None)
        folder = ensemble_dataset(source, Path(place) / "D", DatasetOptions.of("coco", 16))
        document = json.loads((folder / "annotations.json").read_text(encoding="utf-8"))
        counts = {one["id"]: read_picture(folder / "images" / one["file_name"]).astype(np.float64) for one in document["images"]}
    masks: dict[int, list[NDArray[np.bool_]]] = {}
    for one in document["annotations"]:
        masks.setdefault(one["image_id"], []).append(decoded(one["segmentation"]["counts"], counts[one["image_id"]].shape))
    scene_of = {one["id"]: one["scene"] for one in document["images"]}
    for share in ("set", "scene", "frame"):
        for clip in (0.0, 0.1, 1.0):
            group = {number: {"set": "", "scene": scene_of[number], "frame": str(number)}[share] for number in counts}
            ends = {number: FrameRange.of(values, clip) for number, values in counts.items()}
            left, clipped = [], 0
            for number, values in counts.items():
                chosen = [ends[other] for other in counts if group[other] == group[number]]
                low, high = min(one.low for one in chosen), max(one.high for one in chosen)
                levels, beyond = PictureLevels.of_counts(low, high, 8, (1.0, 0.0)).of(values)
                clipped += beyond
                if number in masks:
                    pairs = zip(ratios(values, masks[number]), ratios(levels.astype(float), masks[number]), strict=True)
                    left += [after / before for before, after in pairs if before > LEAST]
            lost, pixels = np.array(left), sum(map(np.size, counts.values()))
            print(
                f"range of the {share}, {clip:g} % clipped at each end: {100 * clipped / pixels:.2f} % of pixels; of {lost.size} labels "
                f"{np.sum(lost < 0.9)} lose more than a tenth, {np.sum(lost < 0.5)} more than half"
            )


if __name__ == "__main__":
    main()
