"""Judge bright parts of pictures with ``seaglint.clutter.segmentation`` and write the verdicts into docs/validation/clutter.md.

    python docs/figures/corridor_verdicts.py                     both tables, some three minutes of processor time
    python docs/figures/corridor_verdicts.py --print             on the terminal only
    python docs/figures/corridor_verdicts.py --earlier FILE.py   counts of an earlier segmentation.py too (EARLIER keeps them)

The first table judges the measured pictures of the folder that ``data_folders.py`` finds; without it the table stays as it is. The second
one counts corridors that are found in random rendered seas, and random pictures without glint that are called glint.
"""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Callable, Iterator
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from seaglint.clutter import segmentation
from seaglint.formats.recording import open_recording
from seaglint.imaging.scene import image
from seaglint.radiance.mean_radiance import mean_radiance
from seaglint.scenario.load import parse_scenario
from seaglint.studies.article.table1 import CORRIDOR_SHARE
from seaglint.studies.build import scenario_physics
from seaglint.studies.sequence.render_sequence import prepare_sequence
from validation_tables import ROOT, table, write_table

sys.path.append(str(ROOT / "tools"))
from data_folders import data_folder

Picture = NDArray[np.float64]

BY_EYE = {
    "Misc_107": "sea from above, uneven illumination",
    "Misc_12": "bright haze above a horizon",
    "Misc_2": "coast or haze, vignetting",
    "Misc_20": "sky and sea",
    "Misc_24": "sea, wakes, vignetting",
    "Misc_25": "sea, bright frame",
    "Misc_26": "sea from above, bright frame",
    "Misc_28": "clouds, sky and sea",
    "Misc_38": "coast, sky and sea",
    "Misc_4": "sky and sea",
    "Misc_44": "bands of cloud and sea",
    "Misc_66": "glint, saturated",
    "Misc_71": "haze, vignetting",
}
"""What each measured picture shows, as a person sees it: one glint corridor, below the horizon in row 42 of Misc_66."""

SEAS = 20
"""Random rendered corridors; they take most of the time."""

FRAMES = 5
"""Frames of each, at 10 Hz."""

SHADES = 150
"""Random pictures of each kind without glint."""

EARLIER: dict[str, tuple[int, float]] = {
    "corridor, 3.5-5 µm, one frame": (7, 0.573),
    "corridor, 3.5-5 µm, 5 frames": (10, 0.722),
    "corridor, Sun inside, 5 frames": (5, 0.734),
    "corridor, all 5 frames, taken as counts": (13, 0.715),
    "corridor, Sun at the border, 5 frames": (5, 0.724),
    "corridor, Sun outside, 5 frames": (3, 0.666),
    "corridor, 8-12 µm, one frame": (2, 0.579),
    "corridor, 8-12 µm, 5 frames": (3, 0.691),
    "no glint: vignetting": (2, 0.0),
    "no glint: all kinds, taken as radiances": (63, 0.0),
    "no glint: vignetting, saturated": (6, 0.0),
    "no glint: ramps": (8, 0.0),
    "no glint: coasts under vignetting": (12, 0.0),
    "no glint: clouds": (5, 0.0),
    "no glint: haze": (30, 0.0),
    "no glint: wakes": (0, 0.0),
}
"""Of the segmentation before 2026-11-28 on the same pictures: number called glint, and mean overlap with the corridor [1]."""

ROWS, COLUMNS = 96, 128


class Sea(NamedTuple):
    """A rendered sea: frames (frames, rows, columns) [W m-2 sr-1], true corridor, and how it was drawn."""

    frames: Picture
    corridor: NDArray[np.bool_]
    infrared: str
    place: str


def drawn_sea(number: int) -> dict[str, Any]:
    """Scenario of a random sea: band, wind, Sun, height and field of view, the Sun's azimuth in the picture, at its border or beside it."""
    rng = np.random.default_rng((77, number))
    band = (3.5, 5.0) if rng.random() < 0.6 else (8.0, 12.0)
    wide = float(np.exp(rng.uniform(np.log(4.0), np.log(40.0))))
    high = wide * ROWS / COLUMNS
    top = float(rng.uniform(0.3, 8.0)) if rng.random() < 0.7 else float(rng.uniform(-0.3 * high, 0.0))
    low, most = {0: (0.0, 0.3), 1: (0.4, 0.5), 2: (0.5, 0.7)}[int(rng.choice(3, p=[0.5, 0.3, 0.2]))]
    turn = float(rng.choice([-1.0, 1.0]) * rng.uniform(low, most)) * wide
    return {
        "seed": number,
        "sun": {"zenith_deg": float(rng.uniform(45.0, 85.0)), "azimuth_deg": 180.0},
        "sensor": {
            "height_m": float(rng.uniform(15.0, 120.0)),
            "azimuth_deg": 180.0 + turn,
            "elevation_deg": -(top + 0.5 * high),
            "fov_deg": [wide, high],
            "pixels": [COLUMNS, ROWS],
            "frame_rate_hz": 10,
            "frames": FRAMES,
        },
        "atmosphere": {"spectroscopy": "lowtran7"},
        "band": {"min_um": band[0], "max_um": band[1]},
        "wind": {"speed_m_s": float(rng.uniform(2.0, 15.0)), "from_deg": float(rng.uniform(0.0, 360.0))},
        "sea": {"shortest_wave_m": float(np.exp(rng.uniform(np.log(1.0), np.log(3.0))))},
    }


def rendered(number: int) -> Sea | None:
    """A random sea, or none where the mean glint does not fall to half of its row's largest within the picture in 70 % of the rows."""
    tables = drawn_sea(number)
    scenario = parse_scenario(tables)
    camera, scene = scenario_physics.camera(scenario), prepare_sequence(scenario).scene
    sun = mean_radiance(scene.view, camera.elevations, camera.azimuths).sun
    most = sun.max(axis=1, keepdims=True)
    corridor = (sun > 0.0) & (sun >= CORRIDOR_SHARE * most)
    sea = most[:, 0] > 0.0
    if sea.sum() < ROWS // 2 or np.mean(~corridor[sea].all(axis=1)) < 0.7:
        return None
    frames = np.stack([image(scene, scene.pose, 0.1 * k).radiance for k in range(FRAMES)]).astype(np.float64)
    turn = abs(tables["sensor"]["azimuth_deg"] - 180.0) / tables["sensor"]["fov_deg"][0]
    place = "inside" if turn < 0.35 else "at the border" if turn < 0.5 else "outside"
    return Sea(frames, corridor, "3.5-5 µm" if tables["band"]["min_um"] < 5.0 else "8-12 µm", place)


def smooth(rng: np.random.Generator, sigma: tuple[float, float]) -> Picture:
    """A Gaussian field of unit variance, correlated over lengths down and along [px]."""
    from scipy.ndimage import gaussian_filter

    field = gaussian_filter(rng.standard_normal((ROWS, COLUMNS)), sigma, mode="wrap")
    return np.asarray(field / field.std())


def texture(rng: np.random.Generator) -> Picture:
    """Waves: a random field, above 0, of mean 1, of any skewness from a Gaussian's to a sparse gamma field's."""
    from scipy.stats import gamma, norm

    down = float(rng.uniform(0.4, 2.0))
    field = smooth(rng, (down, down * float(rng.uniform(1.0, 4.0))))
    shape = float(np.exp(rng.uniform(np.log(1.0), np.log(40.0))))
    return np.asarray(gamma.ppf(norm.cdf(field), shape) / shape)


def vignetting(rng: np.random.Generator) -> Picture:
    """A gain about any centre: cos^4-like, down to a fifth at the farthest corner."""
    y, x = np.mgrid[:ROWS, :COLUMNS]
    middle = rng.uniform(-0.2, 1.2, 2) * (ROWS, COLUMNS)
    radius = np.hypot((y - middle[0]) * float(np.exp(rng.uniform(-0.7, 0.7))), x - middle[1])
    least = float(rng.uniform(0.2, 0.9))
    bend = (1.0 / np.sqrt(least) - 1.0) / float(radius.max()) ** 2
    return np.asarray(1.0 / (1.0 + bend * radius**2) ** 2)


def shaded(rng: np.random.Generator) -> Picture:
    """A texture under vignetting, on any level."""
    return texture(rng) * vignetting(rng) + float(rng.choice([0.0, rng.uniform(0.0, 2.0)]))


def clipped(rng: np.random.Generator) -> Picture:
    """A texture under vignetting whose brightest pixels are saturated."""
    picture = texture(rng) * vignetting(rng)
    return np.minimum(picture, np.quantile(picture, float(rng.uniform(0.8, 0.995))))


def ramp(rng: np.random.Generator) -> Picture:
    """A texture with a gain or a level that increases across the picture."""
    y, x = np.mgrid[:ROWS, :COLUMNS]
    turn = float(rng.uniform(0.0, 2.0 * np.pi))
    rise = np.cos(turn) * x / COLUMNS + np.sin(turn) * y / ROWS
    rise = (rise - rise.min()) / np.ptp(rise)
    return texture(rng) * (0.3 + rise) if rng.random() < 0.5 else 0.3 * texture(rng) + float(rng.uniform(0.2, 3.0)) * rise


def coast(rng: np.random.Generator) -> Picture:
    """Land of another brightness and texture behind a ragged shore, under vignetting."""
    y, x = np.mgrid[:ROWS, :COLUMNS]
    turn = float(rng.uniform(0.0, 2.0 * np.pi))
    along = np.cos(turn) * (x - COLUMNS * rng.uniform(0.2, 0.8)) + np.sin(turn) * (y - ROWS * rng.uniform(0.2, 0.8))
    land = along + 0.05 * ROWS * smooth(rng, (6.0, 6.0)) > 0.0
    sea = float(rng.uniform(0.1, 0.6)) * (texture(rng) - 1.0)
    return np.where(land, float(rng.uniform(1.5, 3.0)) + float(rng.uniform(0.1, 1.0)) * (texture(rng) - 1.0), 1.0 + sea) * vignetting(rng)


def clouds(rng: np.random.Generator) -> Picture:
    """Bright bands or patches of cloud above or over a sea, which hide its texture."""
    band = smooth(rng, (float(rng.uniform(4.0, 12.0)), float(rng.uniform(8.0, 40.0))))
    cover = np.clip(0.5 + 0.5 * band, 0.0, 1.0)
    sea = 0.3 * texture(rng)
    return (1.0 - cover) * sea + cover * (float(rng.uniform(0.5, 2.0)) + float(rng.uniform(0.0, 0.1)) * smooth(rng, (1.5, 1.5)))


def haze(rng: np.random.Generator) -> Picture:
    """Haze with a bright patch of any place and size, through which less of the sea's texture is seen, with a sensor's noise."""
    y, x = np.mgrid[:ROWS, :COLUMNS]
    middle, size = rng.uniform(-0.2, 1.2, 2) * (ROWS, COLUMNS), np.exp(rng.uniform(np.log(0.15), np.log(1.0), 2)) * (ROWS, COLUMNS)
    patch = np.exp(-0.5 * (((y - middle[0]) / size[0]) ** 2 + ((x - middle[1]) / size[1]) ** 2))
    seen = 1.0 - float(rng.uniform(0.0, 0.9)) * patch
    noise = float(rng.uniform(0.0, 0.1)) * rng.standard_normal((ROWS, COLUMNS))
    return 0.3 * texture(rng) * seen + float(rng.uniform(0.3, 2.0)) * patch + noise


def wake(rng: np.random.Generator) -> Picture:
    """A bright, rougher wedge behind a ship at any bearing."""
    y, x = np.mgrid[:ROWS, :COLUMNS]
    turn, at = float(rng.uniform(0.0, 2.0 * np.pi)), rng.uniform(0.1, 0.9, 2) * (ROWS, COLUMNS)
    along = np.cos(turn) * (x - at[1]) + np.sin(turn) * (y - at[0])
    across = -np.sin(turn) * (x - at[1]) + np.cos(turn) * (y - at[0])
    wide = 1.0 + float(rng.uniform(0.02, 0.25)) * np.maximum(along, 0.0)
    trail = (along > 0.0) * np.exp(-0.5 * (across / wide) ** 2) * np.exp(-np.maximum(along, 0.0) / float(rng.uniform(30.0, 300.0)))
    return texture(rng) * (0.3 + float(rng.uniform(0.0, 0.5)) * trail) + float(rng.uniform(0.3, 2.0)) * trail


KINDS: dict[str, Callable[[np.random.Generator], Picture]] = {
    "vignetting": shaded,
    "vignetting, saturated": clipped,
    "ramps": ramp,
    "coasts under vignetting": coast,
    "clouds": clouds,
    "haze": haze,
    "wakes": wake,
}
"""Random pictures without glint, by kind."""


def without_glint(kind: str, count: int) -> Iterator[Picture]:
    """Random pictures of a kind."""
    for number in range(count):
        yield KINDS[kind](np.random.default_rng((78, list(KINDS).index(kind), number)))


def overlap(found: NDArray[np.bool_], corridor: NDArray[np.bool_]) -> float:
    """Pixels in both over pixels in either [1]."""
    return float((found & corridor).sum() / (found | corridor).sum())


def measured() -> list[str] | None:
    """Table of the measured pictures, or none where these are not here."""
    data = data_folder("SEAGLINT_DATA_DIR")
    if data is None:
        return None
    rows = []
    for name, seen in BY_EYE.items():
        picture = open_recording(data / "imagery" / f"{name}.png", channel="mean").read_block(0, 1)[0]
        found = segmentation.segment(picture)
        fine = found.sparkle
        numbers = found.symmetry, found.contrast, found.border_step, fine.structure_ratio, fine.brightness_ratio
        cells = ["" if np.isnan(number) else f"{number:.2f}" for number in (*numbers, fine.skewness_within, fine.skewness_beside)]
        rows.append((name, seen, "glint" if found.found else "none", *cells, f"{100 * fine.saturated:.1f}"))
    head = "picture", "by eye", "verdict", "symmetry", "contrast", "border step", "structure ratio", "brightness ratio"
    return list(table((*head, "skewness within", "beside", "saturated [%]"), rows))


Count = tuple[int, float]  # number called glint, mean overlap of these with the truth


def counts(earlier: ModuleType | None) -> tuple[dict[str, int], dict[str, Count], dict[str, Count]]:
    """Pictures by row of the table, what is called glint now, and by an earlier module."""
    pictures: dict[str, int] = {}
    hits: list[dict[str, list[float]]] = [{}, {}]

    def add(names: tuple[str, ...], layers: tuple[Picture, ...], corridor: NDArray[np.bool_] | None, *, radiance: bool = True) -> None:
        for name in names:
            pictures[name] = pictures.get(name, 0) + 1
        results = [segmentation.segment(*layers, radiance=radiance)]
        # An earlier module takes mean and deviation alone, and no units.
        results += [] if earlier is None else [earlier.segment(*layers[:2])]
        for kept, result in zip(hits, results, strict=False):
            for name in names:
                share = 0.0 if corridor is None else overlap(result.glint, corridor)
                kept.setdefault(name, []).extend([share] if result.found else [])

    drawn, number = 0, 0
    while drawn < SEAS:
        sea = rendered(number)
        number += 1
        if sea is None:
            continue
        drawn += 1
        mean, std = sea.frames.mean(axis=0), sea.frames.std(axis=0)
        add((f"corridor, {sea.infrared}, one frame",), (sea.frames[0],), sea.corridor)
        names = f"corridor, {sea.infrared}, {FRAMES} frames", f"corridor, Sun {sea.place}, {FRAMES} frames"
        add(names, (mean, std, sea.frames[0]), sea.corridor)
        add((f"corridor, all {FRAMES} frames, taken as counts",), (mean, std, sea.frames[0]), sea.corridor, radiance=False)
    for kind in KINDS:
        for picture in without_glint(kind, SHADES):
            add((f"no glint: {kind}",), (picture,), None, radiance=False)
            add(("no glint: all kinds, taken as radiances",), (picture,), None)
    now, before = ({name: (len(kept), float(np.mean(kept)) if kept else 0.0) for name, kept in every.items()} for every in hits)
    return pictures, now, before


def rates(earlier: ModuleType | None) -> list[str]:
    """Table of the random pictures."""
    pictures, now, before = counts(earlier)
    if earlier is not None:
        print("EARLIER =", {name: (count, round(share, 3)) for name, (count, share) in before.items()})
    before = EARLIER if earlier is None else before
    rows = []
    for name in sorted(pictures):
        truth = name.startswith("corridor")
        cells = [[f"{kept[name][0]}", f"{kept[name][1]:.2f}" if truth and kept[name][0] else ""] for kept in (before, now) if name in kept]
        old, new = cells if len(cells) == 2 else (["", ""], cells[0])
        rows.append((name, f"{pictures[name]}", *old, *new))
    return list(table(("pictures", "number", "called glint before", "overlap before", "called glint", "overlap"), rows))


def module_of(path: str) -> ModuleType:
    """A module from a file of any place."""
    spec = importlib.util.spec_from_file_location("earlier_segmentation", path)
    if spec is None or spec.loader is None:
        raise SystemExit(f"{path}: not a module")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def main(arguments: list[str]) -> None:
    """Judge, print, write."""
    earlier = module_of(arguments[arguments.index("--earlier") + 1]) if "--earlier" in arguments else None
    for name, lines in (("corridor-pictures", measured()), ("corridor-rates", rates(earlier))):
        if lines is None:
            print(f"{name}: left as it is, the measured pictures are not here")
            continue
        print(*lines, sep="\n")
        if "--print" not in arguments:
            write_table(name, lines)


if __name__ == "__main__":
    main(sys.argv[1:])
