"""The data card: what a data set holds, how it was made, and its statistics."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
from typing import Any, Final

import numpy as np

from seaglint.base.free_form import JsonObject
from seaglint.files.dataset.dataset_format import DatasetFormat
from seaglint.files.dataset.part import Catalogue
from seaglint.files.dataset.split import SPLITS

_SNR_EDGES: Final = (0.0, 1.0, 2.0, 3.0, 5.0, 7.0, 10.0, 15.0, 20.0, 50.0, float("inf"))
_SIZE_EDGES: Final = (0.0, 0.01, 0.1, 1.0, 4.0, 9.0, 25.0, 81.0, float("inf"))


def statistics(catalogue: Catalogue) -> JsonObject:
    """Numbers of a data set."""
    rows = [(part, row) for part in catalogue.parts for row in part.rows]
    seen = [(part, row) for part, row in rows if row.pieces]
    filled = {(part.scene, row.frame) for part, row in seen}
    images = sum(len(part.pictures) for part in catalogue.parts)
    return {
        "scenes": {split: len(catalogue.of_split(split)) for split in SPLITS},
        "images": {split: sum(len(part.pictures) for part in catalogue.of_split(split)) for split in SPLITS},
        "annotated_objects": {split: sum(bool(row.pieces) for part, row in rows if part.split == split) for split in SPLITS},
        "images_without_objects": images - len(filled),
        "objects_out_of_view": len(rows) - len(seen),
        "by_category": {name: sum(part.categories[row.number] == name for part, row in seen) for name in catalogue.categories},
        "picture_sizes": sorted({f"{part.shape[1]} x {part.shape[0]}" for part in catalogue.parts}),
        "snr": _histogram((row.snr for _, row in seen), _SNR_EDGES),
        "filled_px": _histogram((row.values["pixels"] for _, row in seen), _SIZE_EDGES),
        "range_m": _quartiles(row.values["range_m"] for _, row in seen),
        "parameters": _ranges(catalogue),
    }


def _histogram(values: Iterable[float | None], edges: Sequence[float]) -> dict[str, int]:
    known = [value for value in values if value is not None]
    counts = np.histogram(known, edges)[0]
    names = [f"{low:g} to {high:g}" if np.isfinite(high) else f"above {low:g}" for low, high in pairwise(edges)]
    return dict(zip(names, counts.tolist(), strict=True))


def _quartiles(values: Iterable[float | None]) -> dict[str, float]:
    known = [value for value in values if value is not None]
    if not known:
        return {}
    names = ("least", "lower quartile", "median", "upper quartile", "most")
    return {name: float(f"{value:.5g}") for name, value in zip(names, np.percentile(known, (0, 25, 50, 75, 100)), strict=True)}


def _ranges(catalogue: Catalogue) -> JsonObject:
    """Least and greatest number of what was drawn; of words, how often each."""
    out: JsonObject = {}
    for name in dict.fromkeys(key for part in catalogue.parts for key in part.parameters if key not in ("scene", "seed")):
        values = [part.parameters[name] for part in catalogue.parts if part.parameters.get(name) is not None]
        numbers = [value for value in values if isinstance(value, int | float) and not isinstance(value, bool)]
        if values and len(numbers) == len(values):
            out[name] = {"least": float(f"{min(numbers):.6g}"), "most": float(f"{max(numbers):.6g}")}
        elif values:
            words = [str(value) for value in values]
            out[name] = {"values": len(set(words)), **({} if len(set(words)) > 8 else {w: words.count(w) for w in sorted(set(words))})}
    return out


def card(about: Mapping[str, Any], numbers: Mapping[str, Any], form: type[DatasetFormat]) -> str:
    """Text of ``README.md``.

    Parameters
    ----------
    about : mapping
        ``title``, ``description``, ``licence``, ``licence_note``, ``version``, ``seed``, ``bits``, ``image``, ``counts``, ``split``.
    found : mapping
        As :func:`statistics` gives it.
    form : type of DatasetFormat
        Format.
    """
    total = {name: sum(numbers[name].values()) for name in ("scenes", "images", "annotated_objects")}
    lines = [f"# {about['title']}", ""]
    if about["description"]:
        lines += [about["description"], ""]
    lines += [
        "Simulated infrared pictures of the sea, with the truth of the objects in them. No sensor took them.",
        "",
        "![Examples with the boxes of their objects](examples.png)",
        "",
        "## What",
        "",
        f"- {total['images']} pictures of {total['scenes']} scenes, {', '.join(numbers['picture_sizes'])} pixels, with "
        f"{total['annotated_objects']} annotated objects; {numbers['images_without_objects']} pictures have none.",
        f"- Layout `{form.name}`: {form.layout}. {_pixels(about, form)}",
        "- `parameters.csv`: a row for each scene. `truth.csv` (and `truth.parquet`): a row for each object and frame, also of those "
        "out of view, which have no annotation.",
        "- `dataset.json`: all of this for programs. `SHA256SUMS`: checksums, for `sha256sum -c`.",
        "",
        "## How",
        "",
        f"- Made by seaglint {about['version']} with `seaglint dataset ensemble.toml --format {form.name}` from the file `ensemble.toml`; "
        f"seed {about['seed']}. The same file, version and kind of processor give the same bytes.",
        f"- Split by scene, {' / '.join(f'{fraction:g}' for fraction in about['split'])}, a function of the seed and the scene's number: "
        "no scene has pictures in two splits.",
        "- A mask has the pixels that an object touches, before optics blur it. Of an object smaller than a pixel it is the pixels that it "
        "lies in, one at least. `filled_px` is how much of them it fills.",
        "- `snr`: absolute value of the mean over the mask less the mean around it, over the standard deviation around it (clutter and "
        "noise, 10 pixels beyond the box, without objects), in the pictures as delivered; a body that is partly warmer and partly colder "
        "than the sea may have a small one and be plain to see. `signal_to_clutter`: the largest change of a pixel over the deviation of "
        "the sea around it, before the sensor.",
        "- Centroids count from 0 at the middle of the first pixel; boxes from 0 at its left and upper edge.",
        "",
        "## Licence",
        "",
        f"{about['licence']}{about['licence_note']}",
        "",
        "## Statistics",
        "",
    ]
    columns = ("", *SPLITS, "all")
    lines += _table(columns, [(n.replace("_", " "), *numbers[n].values(), total[n]) for n in total])
    lines += _table(("category", "annotated objects"), list(numbers["by_category"].items()))
    lines += _table(("snr", "annotated objects"), list(numbers["snr"].items()))
    lines += _table(("pixels filled", "annotated objects"), list(numbers["filled_px"].items()))
    lines += _table(tuple(f"range, {name} [m]" for name in numbers["range_m"]), [tuple(f"{v:g}" for v in numbers["range_m"].values())])
    drawn = [
        (f"`{name}`", ", ".join(f"{key} {value:g}" for key, value in values.items())) for name, values in numbers["parameters"].items()
    ]
    lines += _table(("drawn for each scene", "values"), drawn)
    return "\n".join(lines).rstrip("\n") + "\n"


def _pixels(about: Mapping[str, Any], form: type[DatasetFormat]) -> str:
    if not form.pictures:
        return "Counts or radiance as the scenes have them."
    made = "counts" if about["counts"] else "radiance"
    lines = (
        "The line from a pixel's value to radiance, `radiance = radiance_scale * value + radiance_offset` [W m-2 sr-1], is one for each "
    )
    return (
        f"{about['image'].upper()}, {about['bits']} bits, from {made}. {lines}scene, in `parameters.csv` and in each picture "
        f"({'text chunks' if about['image'] == 'png' else 'JSON in ImageDescription'}); it is right to half a step."
    )


def _table(head: Sequence[str], body: Sequence[Sequence[Any]]) -> list[str]:
    """Lines of a table; none where it is empty."""
    if not body or not head:
        return []
    lines = [head, tuple("---" for _ in head), *body]
    return [*("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines), ""]
