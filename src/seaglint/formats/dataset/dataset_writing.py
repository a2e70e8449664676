"""Writing and checking of a labelled data set: pictures of each scene with a record, then the files that need all scenes.

The latter are annotations, tables, a sheet of examples, a card with statistics, and checksums. The check compares files with checksums,
pictures with records, boxes with masks, and splits with each other.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation

from seaglint.base.brightness import Scale, eight_bit, scale_limits
from seaglint.base.errors import BackendError, DataError
from seaglint.base.free_form import JsonObject
from seaglint.base.reports import REPORTS
from seaglint.formats.dataset import format_named
from seaglint.formats.dataset.grey_pictures import box_of, compressed, read_picture, write_picture
from seaglint.formats.dataset.labelled_scene import LabelledScene
from seaglint.formats.dataset.picture_levels import FrameRange, PictureLevels, PictureOptions
from seaglint.formats.dataset.scene_records import (
    DIFFICULTIES,
    HARD,
    LEAST_SNR,
    SPLITS,
    TRUTH_COLUMNS,
    Catalogue,
    DatasetFormat,
    DatasetFrame,
    DatasetObject,
    DatasetScene,
    Entry,
    Piece,
    known,
)
from seaglint.formats.object_labels import GEOMETRIC, RESPONSE, Label, run_lengths
from seaglint.formats.tables.table_text import read_rows, require_parquet, write_parquet, write_rows
from seaglint.objects.drawing.truth import LEAST_CLUTTER, SURROUND
from seaglint.store.outputs import moved_when_whole, read_json, read_text, write_json, write_text
from seaglint.version import __version__

BLUR: Final = 2  #: Pixels around masks into which optics spread an object: left out of its surroundings.

WIDTH: Final = 240  #: Greatest side of an example [pixels].

COLUMNS: Final = 6

BESIDE: Final = ("", "16")  #: Endings of the folders of the first picture of a frame and of the second one.

SUMS: Final = "SHA256SUMS"
ABOUT: Final = "dataset.json"
KIND: Final = "seaglint-dataset-1"  #: Value of ``kind`` in ``dataset.json`` of our data sets.

LICENCE: Final = "CC-BY-4.0"  #: Licence of a data set whose ensemble states no other.

EXAMPLES: Final = 18  #: Pictures on the sheet of examples.

_GAP, _TEXT = 6, 14
_GREEN: Final = (90, 235, 120)
_GREY: Final = (150, 150, 150)

_SNR_EDGES: Final = (0.0, 1.0, 2.0, 3.0, 5.0, 7.0, 10.0, 15.0, 20.0, 50.0, float("inf"))
_AREA_EDGES: Final = (1, 2, 4, 9, 16, 25, 49, 81, float("inf"))
_SIZE_EDGES: Final = (0.0, 0.01, 0.1, 1.0, 4.0, 9.0, 25.0, 81.0, float("inf"))


#: Sentences of the data card on masks.
_MASK_TEXTS: Final = {
    RESPONSE: "Masks and boxes are of an object's response after the optics: pixels whose counts it changes by at least the share "
    "`render.mask_share` of its largest change, before noise, and pixels that it covers by at least half.",
    GEOMETRIC: "Masks and boxes have the pixels that an object touches, before optics blur it. Of an object smaller than a pixel it is the "
    "pixels that it lies in, one at least.",
}


@dataclass(frozen=True)
class ConversionSettings:
    """Settings of the conversion of scenes to a data set."""

    folder: str  #: Folder of the data set, or of the unfinished one.
    format: str  #: Name of one of ``seaglint.formats.dataset.FORMATS``.
    pictures: PictureOptions  #: Bits, range and kind of pictures.
    classes: Mapping[str, str]  #: Category of an object by its name; the default is its preset, or the kind of its shape.
    masks: str = RESPONSE  #: Kind of masks, one of ``seaglint.formats.object_labels.MASKS``.
    min_snr: float = LEAST_SNR  #: Signal-to-noise ratio below which objects are ignored.


def convert(entry: Entry, scene: LabelledScene, settings: ConversionSettings) -> DatasetScene:
    """Write a scene's pictures, and its record last.

    Raises
    ------
    DataError
        Pixels without a value.
    StorageError
        No room or no rights.
    """
    folder, form = Path(settings.folder), format_named(settings.format)
    relations = _levels(scene, settings.pictures) if form.pictures else [()] * len(scene.frames)
    numbered: list[DatasetFrame] = []
    rows: list[DatasetObject] = []
    for place, values, labels in scene.each():
        frame, time = scene.frames[place], round(scene.times[place], 9)
        picture = DatasetFrame(form.frame_name(entry.name, frame, place), frame, time, relations[place])
        clipped = _write_pictures(folder, form, entry, picture, values, settings.pictures.image)
        numbered.append(replace(picture, clipped_px=clipped))
        rows += _rows(place, np.asarray(values, np.float64), labels, scene) if labels else ()
    objects = scene.scenario.get("objects") or []
    part = DatasetScene(
        scene=entry.name,
        split=entry.split,
        seed=scene.seed,
        shape=scene.shape,
        frame_rate_hz=float(scene.scenario["sensor"]["frame_rate_hz"]),
        names=tuple(item["name"] for item in objects),
        categories=tuple(category_of(item, settings.classes) for item in objects),
        pictures=tuple(numbered),
        rows=tuple(rows),
        parameters=dict(entry.parameters),
        masks=settings.masks if scene.labels is None else scene.labels.masks,
        min_snr=settings.min_snr,
    )
    form.write_scene(folder, part, settings.pictures.image)
    # The record comes last: its presence marks the files of the scene as complete.
    part.write(folder)
    return part


def _levels(scene: LabelledScene, options: PictureOptions) -> list[tuple[PictureLevels, ...]]:
    """Return the levels of the pictures of each frame of the scene."""
    # Frame by frame, so that one frame of a store at a time is in memory.
    frames = [FrameRange.of(scene.image(place), options.clip) for place in range(len(scene.frames))]
    if not np.isfinite([(frame.least, frame.most) for frame in frames]).all():
        raise DataError(f"{scene.source}: its pictures have pixels without a value; render it again")
    return options.levels(frames, scene.line if scene.variable == "signal" else None)


def _write_pictures(folder: Path, form: type[DatasetFormat], entry: Entry, picture: DatasetFrame, values: NDArray[Any], image: str) -> int:
    """Write the pictures of a frame, and return the number of pixels that are clipped in the first one."""
    clipped: list[int] = []
    for levels, beside in zip(picture.levels, BESIDE, strict=False):
        path = form.image_path(folder, entry.split, picture.name, image, beside)
        path.parent.mkdir(parents=True, exist_ok=True)
        pixels, beyond = levels.of(values)
        clipped.append(beyond)
        about = {"scene": entry.name, "frame": picture.frame, "time_s": picture.time_s, **levels.attributes, "clipped_px": beyond}
        write_picture(path, pixels, about)
    return clipped[0] if clipped else 0


def category_of(item: Mapping[str, Any], classes: Mapping[str, str]) -> str:
    """Return the class of an object by its name, preset or kind of shape; those that a template drew are named NAME-1, NAME-2, ..."""
    name = str(item["name"])
    drawn, _, number = name.rpartition("-")
    return str(classes.get(name) or (classes.get(drawn) if number.isdecimal() else None) or item.get("preset") or item["shape"]["kind"])


def _rows(place: int, values: NDArray[np.float64], labels: Sequence[Label], scene: LabelledScene) -> Iterator[DatasetObject]:
    """Yield the truth of a frame of a scene."""
    spread = binary_dilation(np.logical_or.reduce([label.mask for label in labels]), iterations=BLUR)
    for label in labels:
        numbers = {name: known(value) for name, value in label.values.items()}
        measured = visibility(values, label.mask, spread, label.values, counts=scene.variable == "signal")
        contrast, mean, snr = (
            (None, None, None) if measured is None else (measured.contrast * scene.line[0], measured.mean_snr, measured.snr)
        )
        yield DatasetObject(place, label.number, numbers, contrast, mean, snr, tuple(pieces(label)))


def pieces(label: Label) -> list[Piece]:
    """Return boxes and masks of the visible pixels of an object: the box is the mask's; one over the seam of a panorama is cut there."""
    mask = label.mask
    if not mask.any():
        return []
    columns = mask.shape[1]
    left, width = label.side("left"), label.side("width")
    # A box that reaches beyond the last column of a panorama continues at column 0.
    halves = [np.arange(columns) >= left, np.arange(columns) < left] if left + width > columns else [np.ones(columns, bool)]
    return [Piece(box_of(part), int(part.sum()), compressed(run_lengths(part))) for part in (mask & half for half in halves) if part.any()]


class Visibility(NamedTuple):
    """Visibility of an object in the delivered picture."""

    contrast: float  #: Mean over its mask above the mean around it, in the picture's values.
    mean_snr: float  #: Absolute contrast over the standard deviation around it [1].
    snr: float  #: Largest change of a pixel by the object, without noise, over the standard deviation around it [1].


def visibility(
    values: NDArray[np.float64], mask: NDArray[np.bool_], covered: NDArray[np.bool_], numbers: Mapping[str, float], *, counts: bool
) -> Visibility | None:
    r"""Return contrast and signal-to-noise ratios of an object in the delivered picture.

    The contrast is :math:`\bar v_t - \bar v_b`, the ratio of means :math:`|\bar v_t - \bar v_b| / \sigma_b`, with the mean over the mask,
    and mean and standard deviation of the pixels within 10 of the mask's box that no object covers or blurs into. The ratio of the peak is
    :math:`|c| / \sigma_b`, with the largest change ``c`` of a pixel by the object before noise: it depends on no single value of the noise,
    and warm and cold parts of a body do not cancel. Without a detector it is ``signal_to_clutter``, and the ratio of means where the truth
    has no peak. None where the object is out of view, or its surroundings have fewer than 8 such pixels or do not vary.

    Parameters
    ----------
    values : ndarray
        Counts or radiance.
    mask : ndarray
        Of the object.
    covered : ndarray
        Pixels that are no surroundings of any object.
    numbers : mapping
        Truth of the object.
    counts : bool
        Whether the values are counts of a detector.
    """
    if not mask.any():
        return None
    left, top, width, height = box_of(mask)
    where = (slice(max(top - SURROUND, 0), top + height + SURROUND), slice(max(left - SURROUND, 0), left + width + SURROUND))
    around = values[where][~covered[where]]
    # Too few pixels give no standard deviation that is worth a ratio.
    spread = float(around.std()) if around.size >= LEAST_CLUTTER else 0.0
    if spread == 0.0:
        return None
    contrast = float(values[mask].mean()) - float(around.mean())
    snr = abs(numbers["counts_peak"]) / spread if counts else numbers["signal_to_clutter"]
    return Visibility(contrast, abs(contrast) / spread, abs(contrast) / spread if math.isnan(snr) else snr)


@dataclass(frozen=True, eq=False)
class Example:
    """Picture with its boxes (first column and row, columns and rows) and a line below it."""

    values: NDArray[Any]
    boxes: Sequence[tuple[int, int, int, int]]
    title: str
    ignored: Sequence[tuple[int, int, int, int]] = ()  #: Boxes of ignored objects.


def write_sheet(examples: Sequence[Example], path: Path) -> None:
    """Write examples as PNG, each stretched from its 1st to its 99.8th percentile.

    Raises
    ------
    StorageError
        No room or no rights; nothing is left behind.
    """
    from PIL import Image, ImageDraw

    columns = max(min(COLUMNS, len(examples)), 1)
    rows = max(math.ceil(len(examples) / columns), 1)
    sizes = [(round(e.values.shape[1] * _zoom(e)), round(e.values.shape[0] * _zoom(e))) for e in examples] or [(WIDTH, WIDTH)]
    tall = max(height for _, height in sizes)
    # Cells have the size of the largest example, so that titles are in lines.
    across, down = max(width for width, _ in sizes) + _GAP, tall + _TEXT + _GAP
    sheet = Image.new("RGB", (columns * across + _GAP, rows * down + _GAP), (24, 24, 28))
    pen = ImageDraw.Draw(sheet)
    for i, example in enumerate(examples):
        left, top = _GAP + i % columns * across, _GAP + i // columns * down
        zoom = _zoom(example)
        size = sizes[i]
        resampling = Image.Resampling.NEAREST if zoom >= 1.0 else Image.Resampling.BOX
        sheet.paste(Image.fromarray(_grey(example.values)).resize(size, resampling).convert("RGB"), (left, top))
        for box, colour in [*((box, _GREEN) for box in example.boxes), *((box, _GREY) for box in example.ignored)]:
            # The frame is three pixels of the picture wider than the box, so that it does not cover the object.
            x0, y0 = left + (box[0] - 3) * zoom, top + (box[1] - 3) * zoom
            x1, y1 = left + (box[0] + box[2] + 3) * zoom, top + (box[1] + box[3] + 3) * zoom
            pen.rectangle((max(x0, left), max(y0, top), min(x1, left + size[0] - 1), min(y1, top + size[1] - 1)), outline=colour)
        pen.text((left, top + tall + 1), example.title, fill=(220, 220, 220))
    with moved_when_whole(path) as partial:
        sheet.save(partial, format="PNG")


def _zoom(example: Example) -> float:
    zoom = WIDTH / max(example.values.shape)
    return float(math.floor(zoom)) if zoom >= 1.0 else zoom


def _grey(values: NDArray[Any]) -> NDArray[np.uint8]:
    return eight_bit(Scale(*scale_limits(values, (1.0, 99.8))).share(values))


def statistics(catalogue: Catalogue) -> JsonObject:
    """Return the statistics of a data set."""
    rows = [(part, row) for part in catalogue.parts for row in part.rows]
    visible = [(part, row) for part, row in rows if row.pieces]
    filled = {(part.scene, row.frame) for part, row in visible}
    images = sum(len(part.pictures) for part in catalogue.parts)
    return {
        "scenes": {split: len(catalogue.of_split(split)) for split in SPLITS},
        "images": {split: sum(len(part.pictures) for part in catalogue.of_split(split)) for split in SPLITS},
        "annotated_objects": {split: sum(bool(row.pieces) for part, row in rows if part.split == split) for split in SPLITS},
        "ignored_objects": {split: sum(part.ignores(row) for part, row in rows if part.split == split) for split in SPLITS},
        "images_without_objects": images - len(filled),
        "objects_out_of_view": len(rows) - len(visible),
        "by_category": {name: sum(part.categories[row.number] == name for part, row in visible) for name in catalogue.categories},
        "picture_sizes": sorted({f"{part.shape[1]} x {part.shape[0]}" for part in catalogue.parts}),
        "by_difficulty": {
            name: sum(part.difficulty(row) == name for part, row in visible) for name in (*(d[0] for d in DIFFICULTIES), HARD)
        },
        "snr": _histogram((row.snr for _, row in visible), _SNR_EDGES),
        "mask_pixels": _histogram((row.area for _, row in visible), _AREA_EDGES),
        "mean_mask_pixels": float(f"{np.mean([row.area for _, row in visible]):.4g}") if visible else 0.0,
        "filled_px": _histogram((row.values["pixels"] for _, row in visible), _SIZE_EDGES),
        "range_m": _quartiles(row.values["range_m"] for _, row in visible),
        "parameters": _ranges(catalogue),
    }


def _histogram(values: Iterable[float | None], edges: Sequence[float]) -> dict[str, int]:
    counts = np.histogram([value for value in values if value is not None], edges)[0]
    names = [f"{low:g} to {high:g}" if np.isfinite(high) else f"above {low:g}" for low, high in pairwise(edges)]
    return dict(zip(names, counts.tolist(), strict=True))


def _quartiles(values: Iterable[float | None]) -> dict[str, float]:
    known = [value for value in values if value is not None]
    if not known:
        return {}
    names = ("least", "lower quartile", "median", "upper quartile", "most")
    return {name: float(f"{value:.5g}") for name, value in zip(names, np.percentile(known, (0, 25, 50, 75, 100)), strict=True)}


def _ranges(catalogue: Catalogue) -> JsonObject:
    """Return the least and greatest drawn number of each parameter; for words the count of each."""
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
    """Return the text of ``README.md``.

    Parameters
    ----------
    about : mapping
        ``title``, ``description``, ``licence``, ``licence_note``, ``version``, ``seed``, ``split``, ``counts``, ``command`` (further
        options), ``min_snr``, ``masks`` (the kinds of masks in the scenes), and of pictures ``bits``, ``image``, ``scale``,
        ``clipped_px`` and ``pixels``.
    numbers : mapping
        Result of ``statistics``.
    form : type of DatasetFormat
        Format.
    """
    total = {name: sum(numbers[name].values()) for name in ("scenes", "images", "annotated_objects", "ignored_objects")}
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
        f"- Made by seaglint {about['version']} with `seaglint dataset ensemble.toml --format {form.name}{about['command']}` from the file "
        "`ensemble.toml`; "
        f"seed {about['seed']}. The same file, version and kind of processor give the same bytes.",
        f"- Split by scene, {' / '.join(f'{fraction:g}' for fraction in about['split'])}, a function of the seed and the scene's number: "
        "no scene has pictures in two splits.",
        *(f"- {_MASK_TEXTS[kind]}" for kind in about["masks"]),
        f"- The mean mask has {numbers['mean_mask_pixels']:g} pixels. `filled_px`: pixels that an object fills at the aperture, in parts.",
        "- `snr`: largest change of a pixel by the object, without noise, over the standard deviation around it (clutter and noise, 10 "
        "pixels beyond the box, without objects) in the pictures as delivered. `mean_snr`: the mean over the mask less the mean around it, "
        "over the same deviation. `signal_to_clutter`: the largest change of a pixel over the deviation of the sea around it, before the "
        "sensor.",
        f"- {total['ignored_objects']} of {total['annotated_objects']} annotated objects have an `snr` below {about['min_snr']:g} and are "
        "ignored (`ignore`; `iscrowd` and `ignore` 1 in COCO; left out of formats without such a field): neither a detection nor a miss of "
        "them counts.",
        "- `difficulty`: "
        + "; ".join(
            f"{name} from `snr` {ratio:g}, a visible share of {share:g} and {pixels} pixels of the mask"
            for name, ratio, share, pixels in DIFFICULTIES
        )
        + f"; {HARD} otherwise.",
        "- Centroids count from 0 at the middle of the first pixel; boxes from 0 at its left and upper edge.",
        "",
        "## Licence",
        "",
        f"{about['licence']}{about['licence_note']}",
        "",
        "## Statistics",
        "",
    ]
    lines += _table(("", *SPLITS, "all"), [(n.replace("_", " "), *numbers[n].values(), total[n]) for n in total])
    for head, name in (
        ("category", "by_category"),
        ("difficulty", "by_difficulty"),
        ("snr", "snr"),
        ("pixels of the mask", "mask_pixels"),
        ("pixels filled", "filled_px"),
    ):
        lines += _table((head, "annotated objects"), list(numbers[name].items()))
    lines += _table(tuple(f"range, {name} [m]" for name in numbers["range_m"]), [tuple(f"{v:g}" for v in numbers["range_m"].values())])
    drawn = [
        (f"`{name}`", ", ".join(f"{key} {value:g}" for key, value in values.items())) for name, values in numbers["parameters"].items()
    ]
    lines += _table(("drawn for each scene", "values"), drawn)
    return "\n".join(lines).rstrip("\n") + "\n"


def _pixels(about: Mapping[str, Any], form: type[DatasetFormat]) -> str:
    if not form.pictures:
        return "Counts or radiance as the scenes have them."
    source = "counts" if about["counts"] else "radiance"
    text = "text chunks" if about["image"] == "png" else "JSON in ImageDescription"
    bits = {"8": "8 bits", "16": "16 bits", "both": "8 bits, and beside them 16 bits (folders that end in 16)"}[about["bits"]]
    own = {"frame": "are those of the picture", "limits": "are the same for all pictures"}.get(
        about.get("scale", ""), "are those of the scene"
    )
    where = f"{'' if about.get('scale') == 'frame' else 'in `parameters.csv` and '}in each picture ({text})"
    clipped, pixels = about["clipped_px"], about["pixels"]
    beyond = (
        f" {clipped} of {pixels} pixels are beyond the range of 8 bits and clipped to its ends (`clipped_px`)." if clipped else
        "" if about["bits"] == "16" else " No pixel is clipped."
    )  # fmt: skip
    return (
        f"{about['image'].upper()}, {bits}, from {source}. A pixel's value gives the radiance, "
        f"`radiance = radiance_scale * value + radiance_offset` [W m-2 sr-1], to half a step, `radiance_error`. Scale and offset {own}, "
        f"{where}.{beyond}"
    )


def _table(head: Sequence[str], body: Sequence[Sequence[Any]]) -> list[str]:
    """Return the lines of a Markdown table; no lines for an empty one."""
    if not body or not head:
        return []
    return [*("| " + " | ".join(str(cell) for cell in line) + " |" for line in [head, tuple("---" for _ in head), *body]), ""]


def files(folder: Path) -> list[str]:
    """Return all files of a data set but the checksums themselves, with slashes, in order."""
    paths = (path.relative_to(folder) for path in folder.rglob("*") if path.is_file())
    return sorted(path.as_posix() for path in paths if path.as_posix() != SUMS and not path.parts[0].startswith("."))


def write_sums(folder: Path) -> None:
    """Write the checksums of all files, as ``sha256sum`` does."""
    write_text("".join(f"{_digest(folder / name)}  {name}\n" for name in files(folder)), folder / SUMS)


def _digest(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def read_about(folder: Path) -> JsonObject:
    """Read ``dataset.json``.

    Raises
    ------
    DataError
        No data set of ours.
    """
    try:
        about = read_json(folder / ABOUT, "")
        if about["kind"] == KIND:
            return dict(about)
    except (DataError, KeyError, TypeError):
        pass
    raise DataError(f"{folder}: is no data set of seaglint: it has no readable {ABOUT}; give a folder that 'seaglint dataset' made")


def problems(folder: Path) -> Iterator[str]:
    """Return the faults of a data set, a line each; nothing where it is whole.

    Raises
    ------
    DataError
        No data set of ours.
    """
    about = read_about(folder)
    try:
        sums = {name: digest for digest, name in (line.split("  ", 1) for line in read_text(folder / SUMS, "").splitlines())}
    except (DataError, ValueError):
        yield f"{SUMS}: is missing or cut"
        return
    names = files(folder)
    missing = sorted(set(sums) - set(names))
    yield from (f"{name}: is missing" for name in missing)
    yield from (f"{name}: is not in {SUMS}" for name in sorted(set(names) - set(sums)))
    yield from (
        f"{name}: its checksum is another than in {SUMS}" for name in names if name in sums and _digest(folder / name) != sums[name]
    )
    # Further checks would repeat the missing files in other words.
    if missing:
        return
    yield from _split_problems(folder, about)
    form = format_named(about["format"])
    if form.pictures:
        yield from _picture_problems(folder, about, form)
    yield from form.problems(folder, about)


def _split_problems(folder: Path, about: Mapping[str, Any]) -> Iterator[str]:
    """Yield scenes whose split differs between the files."""
    for name in ("parameters.csv", "truth.csv"):
        for row in read_rows(folder / name):
            recorded = about["scenes"].get(row["scene"], {}).get("split")
            if recorded != row["split"]:
                yield f"{name}: scene {row['scene']} is in '{row['split']}' and in '{recorded}' of {ABOUT}"


def _picture_problems(folder: Path, about: Mapping[str, Any], form: type[DatasetFormat]) -> Iterator[str]:
    for one in about["scenes"].values():
        for picture in one["images"]:
            for bits, beside in zip(PictureOptions.of(about["bits"]).bits, BESIDE, strict=False):
                path = form.image_path(folder, one["split"], picture, about["image"], beside)
                try:
                    levels = read_picture(path)
                except DataError as error:
                    yield str(error)
                    continue
                if levels.shape != (one["height"], one["width"]) or 8 * levels.dtype.itemsize != bits:
                    size = f"{levels.shape[1]} x {levels.shape[0]} pixels of {8 * levels.dtype.itemsize} bits"
                    yield f"{path.name}: has {size}, not {one['width']} x {one['height']} of {bits}"


def finish(folder: Path, catalogue: Catalogue, settings: ConversionSettings, about: Mapping[str, Any]) -> None:
    """Write the files beside the pictures.

    Parameters
    ----------
    folder : Path
        With the pictures.
    catalogue : Catalogue
        Records of all scenes.
    settings : ConversionSettings
        How they were written.
    about : mapping
        ``description``, ``licence`` (None for the default), ``split``, ``made_from``, and ``folder``, the final name of the folder.
    """
    counts = all(levels.counts for part in catalogue.parts for picture in part.pictures for levels in picture.levels)
    shared = {
        "title": catalogue.title,
        "description": about["description"],
        "licence": about["licence"] or LICENCE,
        "version": __version__,
        "seed": catalogue.seed,
        "split": list(about["split"]),
        "min_snr": settings.min_snr,
    }
    form = format_named(settings.format)
    form.write(folder, catalogue, {**shared, "folder": about["folder"]})
    _write_tables(folder, catalogue)
    write_sheet(_examples(folder, catalogue, settings), folder / "examples.png")
    numbers = statistics(catalogue)
    pictured = {**settings.pictures.named, **levels_lost(catalogue)} if form.pictures else {}
    document = {
        "kind": KIND,
        "format": settings.format,
        **pictured,
        **shared,
        "categories": list(catalogue.categories),
        "scenes": {part.scene: _scene(part) for part in catalogue.parts},
        "statistics": numbers,
        "made_from": about["made_from"],
    }
    write_json(document, folder / ABOUT)
    note = ". The ensemble's file names no licence; this is seaglint's default, and yours to change with `[dataset] licence`."
    command = settings.pictures.command if form.pictures else ""
    command += "" if settings.masks == RESPONSE else f" --masks {settings.masks}"
    command += f" --min-snr {settings.min_snr:g}"
    texts = {**shared, **pictured, "licence_note": "" if about["licence"] else note, "counts": counts, "command": command}
    texts["masks"] = sorted({part.masks for part in catalogue.parts if part.names} or {settings.masks}, reverse=True)
    write_text(card(texts, numbers, form), folder / "README.md")
    write_sums(folder)  # last: a data set with checksums is complete
    report_lost(pictured)


def _scene(part: DatasetScene) -> JsonObject:
    rows, columns = part.shape
    images = [picture.name for picture in part.pictures]
    about = {"split": part.split, "seed": part.seed, "width": columns, "height": rows, "masks": part.masks}
    return {**about, **part.attributes, "images": images}


def levels_lost(catalogue: Catalogue) -> dict[str, int]:
    """Return the number of pixels, of those that are clipped, and of visible labels with a contrast below one step of their picture.

    A label is visible with a signal-to-noise ratio above 1.
    """
    out = {"pixels": 0, "clipped_px": 0, "labels_below_a_step": 0}
    for part in catalogue.parts:
        out["pixels"] += len(part.pictures) * part.shape[0] * part.shape[1]
        out["clipped_px"] += sum(picture.clipped_px for picture in part.pictures)
        for row in part.rows:
            step = abs(part.pictures[row.frame].levels[0].radiance_scale)
            visible = row.local_contrast is not None and (row.snr or 0.0) > 1.0
            out["labels_below_a_step"] += visible and abs(row.local_contrast or 0.0) < step
    return out


def report_lost(about: Mapping[str, Any]) -> None:
    """Report clipped pixels and labels that the steps of 8 bits hide, a line each; nothing where there are none."""
    clipped, labels = about.get("clipped_px", 0), about.get("labels_below_a_step", 0)
    if clipped:
        REPORTS.warning(
            "%d of %d pixels (%.3g %%) are beyond the range of 8 bits and clipped to its ends; clipped_px has the number of each picture",
            clipped, about["pixels"], 100.0 * clipped / about["pixels"],
        )  # fmt: skip
    if labels and about["bits"] != "16":
        REPORTS.warning(
            "%d labels with a signal-to-noise ratio above 1 have a contrast below one step of 8 bits, as bright pixels fill the range; "
            "clip a share of the pixels (clip), or write pictures of 16 bits too (bits)",
            labels,
        )


def _write_tables(folder: Path, catalogue: Catalogue) -> None:
    """Write ``parameters.csv``, ``truth.csv``, and ``truth.parquet`` if PyArrow is installed."""
    parameters, truth = catalogue.parameters(), catalogue.truth()
    write_rows(parameters, folder / "parameters.csv")
    if truth:
        write_rows(truth, folder / "truth.csv")
    else:
        write_text(",".join(TRUTH_COLUMNS) + "\n", folder / "truth.csv")
    try:
        require_parquet()
    except BackendError:
        return
    write_parquet({name: [row[name] for row in truth] for name in TRUTH_COLUMNS}, folder / "truth.parquet")


def _examples(folder: Path, catalogue: Catalogue, settings: ConversionSettings) -> list[Example]:
    """Return one picture of each of some scenes, evenly among all: the first of the pictures with most objects."""
    parts = catalogue.parts
    # A set: neighbouring places of a short list may round to one scene.
    chosen = [parts[i] for i in sorted({round(j) for j in np.linspace(0, len(parts) - 1, min(EXAMPLES, len(parts)))})]
    out = []
    for part in chosen:
        place = int(np.argmax([sum(len(row.pieces) for row in part.rows if row.frame == i) for i in range(len(part.pictures))]))
        rows = [row for row in part.rows if row.frame == place and row.pieces]
        most = max((row.snr for row in rows if row.snr is not None), default=None)
        title = f"{part.pictures[place].name} {part.split}" + (f", largest SNR {most:.3g}" if most is not None else "")
        picture = format_named(settings.format).picture(folder, part, place, settings.pictures.image)
        seen, ignored = ([piece.box for row in rows for piece in row.pieces if part.ignores(row) == kind] for kind in (False, True))
        out.append(Example(picture, seen, title, ignored))
    return out
