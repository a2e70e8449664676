"""Loaders of public programs for data sets of small targets, written anew with NumPy from their documentation: paths, lists, values.

- BasicIRSTD, SCTransNet (README and ``dataset.py`` of XinyiYing/BasicIRSTD, xdFai/SCTransNet): lists ``train_NAME``, ``test_NAME``.
- DNANet (``load_param_data.py`` of YeRen123455/Infrared-Small-Target-Detection): lists in a folder of the split.
- DTUM (``MIRSDTDataLoader.py`` of TinaLRJ/Multi-frame-infrared-small-target-detection-DTUM): stacks of five frames.
- DeepPro (``TrainDataLoader.py`` and ``TestDataLoader.py`` of TinaLRJ/DeepPro): sequences of the listed stacks.
- LMAFormer (``train_data.py`` of lifier/LMAFormer): one folder of pictures and one of masks, each with a folder for a sequence.
- CocoVID (``coco_video_parser.py`` of open-mmlab/mmtracking).
"""

from __future__ import annotations

import json
from collections import defaultdict
from pathlib import Path

import numpy as np
from PIL import Image
from scipy.io import loadmat


def grey(path: Path) -> np.ndarray:
    """Values of a picture as BasicIRSTD takes them: as 32-bit integers."""
    with Image.open(path) as image:
        return np.asarray(image.convert("I"), dtype=np.float32)


def share(path: Path) -> np.ndarray:
    """Mask over 255."""
    with Image.open(path) as image:
        return np.asarray(image, dtype=np.float32) / 255.0


def basic_irstd(parent: Path, name: str, split: str) -> list[tuple[str, np.ndarray, np.ndarray]]:
    """Names, normalised pictures and masks; the normalisation reads both lists, whichever is loaded."""
    root = parent / name
    lists = {one: (root / "img_idx" / f"{one}_{name}.txt").read_text().splitlines() for one in ("train", "test")}
    every = [grey(root / "images" / f"{one}.png") for one in lists["train"] + lists["test"]]
    mean, std = np.mean([one.mean() for one in every]), np.mean([one.std() for one in every])
    return [
        (one, (grey(root / "images" / f"{one}.png") - mean) / std, share(root / "masks" / f"{one}.png")) for one in lists[split]
    ]  # fmt: skip


def dnanet(root: Path, folder: str, split: str) -> list[tuple[str, np.ndarray, np.ndarray]]:
    """Names, pictures as RGB and masks, of the list in a folder."""
    names = (root / folder / f"{split}.txt").read_text().splitlines()
    pictures = [np.asarray(Image.open(root / "images" / f"{one}.png").convert("RGB")) for one in names]
    return [(one, picture, share(root / "masks" / f"{one}.png")) for one, picture in zip(names, pictures, strict=True)]


def dtum(root: Path, split: str) -> list[tuple[str, np.ndarray, np.ndarray, np.ndarray]]:
    """Paths of stacks, the last five frames of each, mask and centroids of the last one."""
    out = []
    for line in np.loadtxt(root / f"{split}.txt", dtype=bytes).astype(str):
        stack = loadmat(root / line).get("Mix").astype(np.float32)[-5:]
        mask, centroids = (share(root / line.replace(".mat", ".png").replace("Mix", name)) for name in ("masks", "masks_centroid"))
        out.append((line, stack, mask, centroids))
    return out


def deep_pro(root: Path, split: str) -> dict[str, tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Pictures, masks and centroids [(frames, rows, columns)] of the sequences of the listed stacks."""
    names = dict.fromkeys(line.split("/")[0] for line in np.loadtxt(root / f"{split}.txt", dtype=bytes).astype(str))
    parts = ("images", "masks", "masks_centroid")
    return {
        name: tuple(
            np.stack([np.asarray(Image.open(path), np.float32) for path in sorted((root / name / part).iterdir())]) for part in parts
        )
        for name in names
    }


def lma_former(images: Path, masks: Path, names: list[str]) -> dict[str, list[tuple[np.ndarray, np.ndarray]]]:
    """Pictures as RGB and masks of the frames of sequences, which are found by their masks."""
    return {
        name: [
            (np.asarray(Image.open(images / name / mask.name).convert("RGB")), np.asarray(Image.open(mask).convert("L")))
            for mask in sorted((masks / name).glob("*.png"))
        ]
        for name in names
    }


class CocoVid:
    """Index of annotations by video."""

    def __init__(self, path: Path) -> None:
        document = json.loads(path.read_text())
        self.videos = {video["id"]: video for video in document["videos"]}
        self.images = {image["id"]: image for image in document["images"]}
        self.categories = {category["id"]: category["name"] for category in document["categories"]}
        self.of_image: dict[int, list[dict]] = defaultdict(list)
        self.instances: dict[int, list[int]] = defaultdict(list)
        for annotation in document["annotations"]:
            self.of_image[annotation["image_id"]].append(annotation)
            if annotation["instance_id"] not in self.instances[annotation["video_id"]]:
                self.instances[annotation["video_id"]].append(annotation["instance_id"])

    def frames(self, video: int) -> list[dict]:
        """Images of a video: its ``frame_id`` is the place in a list of their number."""
        images = [image for image in self.images.values() if image["video_id"] == video]
        out: list[dict] = [{}] * len(images)
        for image in images:
            out[image["frame_id"]] = image
        return out
