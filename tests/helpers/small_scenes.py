"""Finished scene stores of a few pixels, written by hand: what is in them is known to the last bit."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from seaglint.formats.dataset.scene_records import Entry
from seaglint.objects.drawing.truth import NUMBERS
from seaglint.optics.band import Band
from seaglint.store.layout import Layout, Truth, packed
from seaglint.store.sequence_store import Frame, write_sequence

ROWS, COLUMNS, FRAMES = 24, 32, 3
LINE = (3.2e-4, -0.01)
"""Radiance of a count and of none."""

OBJECTS = (
    {"name": "speck-1", "shape": {"kind": "point", "intensity_w_sr": 1.0}},
    {"name": "boat", "preset": "small-boat", "shape": {"kind": "box", "size_m": [1, 2, 3]}},
)


def masks(scene: int, frame: int) -> list[np.ndarray]:
    """A speck of a pixel that moves, and a boat of an odd shape that is out of view in the last frame."""
    speck, boat = np.zeros((ROWS, COLUMNS), bool), np.zeros((ROWS, COLUMNS), bool)
    speck[3 + scene % 4, 5 + 2 * frame] = True
    if frame < FRAMES - 1:
        boat[12:15, 20:27] = True
        boat[10:12, 22] = True
        boat[14, 20] = False
    return [speck, boat]


def values(scene: int, frame: int, *, counts: bool) -> np.ndarray:
    """Noise around a level, with the objects above it."""
    noise = np.random.default_rng((scene, frame)).normal(0.0, 20.0, (ROWS, COLUMNS))
    found = 5000.0 + noise
    for mask, contrast in zip(masks(scene, frame), (150.0, 90.0), strict=True):
        found[mask] += contrast
    return np.rint(found).astype(np.uint16) if counts else (found * LINE[0] + LINE[1]).astype(np.float32)


def scene_of(scene: int, *, counts: bool = True, objects: bool = True) -> tuple[Layout, Frame]:
    """Layout and frames of a scene, as a rendered sequence has them."""
    names = tuple(str(item["name"]) for item in OBJECTS) if objects else ()
    about = {"objects": list(OBJECTS)} if objects else {}
    scenario = {"sensor": {"frame_rate_hz": 30.0}, **about}
    layout = Layout(
        azimuth_deg=np.linspace(178.0, 182.0, COLUMNS),
        elevation_deg=np.linspace(1.0, -2.0, ROWS),
        frames=range(FRAMES),
        frame_rate=30.0,
        band=Band(np.array([3.5, 5.0]), np.ones(2)),
        variables=("signal",) if counts else ("radiance",),
        details={"signal": {"radiance_scale": LINE[0], "radiance_offset": LINE[1]}} if counts else {},
        attributes={"seed": 100 + scene, "scenario": json.dumps(scenario)},
        truth=Truth(names) if objects else None,
    )

    def frame(number: int) -> dict[str, np.ndarray]:
        out: dict[str, np.ndarray] = {layout.variables[0]: values(scene, number, counts=counts)}
        if objects:
            found = masks(scene, number)
            numbers = [_numbers(mask) for mask in found]
            out |= {name: np.array([one[name] for one in numbers]) for name in NUMBERS}
            owner = found[0] * np.uint16(1) + found[1] * np.uint16(2)
            out |= {"object_mask": packed(found), "object_id": owner.astype(np.uint16)}
        return out

    return layout, frame


def write_scene(path: Path, scene: int, *, counts: bool = True, objects: bool = True) -> Path:
    """A store as rendering leaves it."""
    layout, frame = scene_of(scene, counts=counts, objects=objects)
    return write_sequence(path, layout, frame)


def _numbers(mask: np.ndarray) -> dict[str, float]:
    out = dict.fromkeys(NUMBERS, np.nan) | {"range_m": 2000.0, "visible_share": float(mask.any()), "pixels": 0.25 * mask.sum()}
    if mask.any():
        rows, columns = np.nonzero(mask)
        out |= {"column_px": columns.mean() + 0.25, "row_px": rows.mean(), "contrast_W_m2_sr": 0.03, "signal_to_clutter": 5.0}
        out |= {"bbox_left_px": columns.min(), "bbox_top_px": rows.min()}
        out |= {"bbox_width_px": np.ptp(columns) + 1, "bbox_height_px": np.ptp(rows) + 1}
    return out


def entries(folder: Path, count: int, splits: tuple[str, ...], **more: bool) -> list[Entry]:
    """Some scenes, the last one without objects."""
    folder.mkdir(parents=True, exist_ok=True)
    out = []
    for scene in range(count):
        name = f"{scene:04d}"
        store = write_scene(folder / f"{name}.zarr", scene, objects=scene < count - 1, **more)
        out.append(Entry(name, str(store), splits[scene % len(splits)], {"seed": 100 + scene, "wind.speed_m_s": 5.0 + scene}))
    return out
