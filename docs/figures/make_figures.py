"""Draw the pictures of the README and the documentation into docs/images, from examples/demo.toml, as the commands do.

    python docs/figures/make_figures.py              all of them
    python docs/figures/make_figures.py fig2 fig3    some of them

``demo.png`` is the picture of ``./run demo`` (its first frame), ``mean.png`` that of ``seaglint mean examples/demo.toml --preview``,
``fig2.png`` to ``fig4.png``, ``fig10.png``, ``fig12.png`` (some minutes) and ``measured.png`` those of ``seaglint reproduce``,
``near_horizon.png`` that of ``docs/data/near_horizon.csv``, ``clutter_*.png`` pictures of ``seaglint analyze --report`` of the demo's four
seconds (which take some minutes to render), ``likelihood_regions.png`` glint in three regions of the sea, ``glint_atlas.png`` over the
world in January and July (coastlines need the extra ``maps``), ``best_looks.png`` by bearing at one place and date,
``response_masks.png`` geometric masks and masks of responses of four objects,
``dataset_examples.png`` the sheet of a data set of the first 18 scenes of ``examples/small-objects.toml`` (some minutes).

``video`` makes the first page's ten seconds of the demo (some minutes): ``docs/_static/demo.mp4`` with its picture ``demo.jpg``.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pictures import renew, save

if TYPE_CHECKING:
    from seaglint.analysis import Analysis
    from seaglint.scenario.model import Scenario

ROOT = Path(__file__).resolve().parents[2]
SCENARIO = ROOT / "examples" / "demo.toml"
IMAGES = ROOT / "docs" / "images"
CLUTTER = ("regions", "rates", "exceedances", "slices", "histograms")
VIDEO = ROOT / "docs" / "_static" / "demo.mp4"
VIDEO_FRAMES = 250
"""Frames of the video: ten seconds."""
SCENES = 18
"""Scenes of the sheet of a data set."""


def seaglint(*arguments: str | Path) -> None:
    """Run the command line."""
    subprocess.run([sys.executable, "-m", "seaglint.cli.app", *map(str, arguments)], check=True)


def render(folder: Path) -> Path:
    """First frame of the demo."""
    run = folder / "run.zarr"
    seaglint("render", SCENARIO, "-o", run, "--frames", "0:1", "--preview")
    return run.with_suffix(".png")


def mean(folder: Path) -> Path:
    """Mean map of the demo."""
    seaglint("mean", SCENARIO, "-o", folder / "mean.nc", "--preview")
    return folder / "mean.png"


def figure(name: str, folder: Path) -> Path:
    """A figure of the article."""
    seaglint("reproduce", name, "-o", folder)
    return folder / f"{name}.png"


@cache
def demo_analysis(folder: Path) -> Analysis:
    """Clutter of the demo, rendered once."""
    from seaglint.analysis import analyze
    from seaglint.formats.recording import open_recording

    run = folder / "clutter.zarr"
    if not run.exists():
        seaglint("render", SCENARIO, "-o", run)
    return analyze(open_recording(run))


def near_horizon(folder: Path) -> Path:
    """Ratio of resolved waves to the mean model, from the table of ``docs/figures/near_horizon_table.py``."""
    import numpy as np
    from matplotlib.figure import Figure

    rows = np.genfromtxt(ROOT / "docs" / "data" / "near_horizon.csv", delimiter=",", names=True)
    picture = Figure(figsize=(6.4, 4.0), layout="constrained")
    axes = picture.subplots()
    for zenith in np.unique(rows["solar_zenith_deg"]):
        row = rows[rows["solar_zenith_deg"] == zenith]
        axes.errorbar(row["depression_deg"], row["glint_ratio"], row["glint_standard_error"], marker="o", ms=3, label=f"Sun at {zenith:g}°")
    axes.plot(row["depression_deg"], row["bound"], "k--", label="bound 1 + Λ")
    axes.axhline(1.0, color="0.7", lw=0.8)
    axes.set(xscale="log", ylim=(0.0, 2.0), xlabel="depression [deg]", ylabel="glint of resolved waves / mean model [1]")
    axes.set_xticks(row["depression_deg"], [f"{d:g}" for d in row["depression_deg"]], minor=False)
    axes.set_xticks([], minor=True)
    axes.legend(fontsize=8)
    path = folder / "near_horizon.png"
    save(picture, path)
    return path


def clutter(name: str, folder: Path) -> Path:
    """A picture of the report."""
    from seaglint.plot.clutter_pictures import PICTURES
    from seaglint.plot.figures_and_pages import png

    output = folder / f"clutter_{name}.png"
    output.write_bytes(png(PICTURES[name].draw(demo_analysis(folder))))
    return output


def likelihood_regions(folder: Path) -> Path:
    """Glint in three regions of the sea; prints the numbers."""
    from likelihood_regions import regions
    from seaglint.plot.environment_charts import write_regions

    found, output = regions(), folder / "likelihood_regions.png"
    write_regions(found, output)
    for name, columns in found.items():
        print(name, *(f"{t:g}: {p:.4f}" for t, p in zip(columns["threshold"], columns["probability"], strict=True)))
        print("  by month", *(f"{p:.4f}" for p in columns["by_month"]))
    return output


def glint_scenario(**wanted: Any) -> Scenario:
    """Looks in 3-5 um from 30 m, with the climatology of the world's seas."""
    from seaglint.scenario.load import parse_scenario

    settings = {"weather": "world", "threshold_w_m2_sr": [0.25]} | wanted
    return parse_scenario({"band": {"min_um": 3.0, "max_um": 5.0}, "sensor": {"height_m": 30.0}, "likelihood": settings})


def glint_atlas(folder: Path) -> Path:
    """Glint over the world's seas in January and July, of looks near the Sun's azimuth; prints the means by latitude."""
    from seaglint.plot.likelihood_maps import write_map
    from seaglint.studies.likelihood.chance_map import likelihood_map

    chances, output = likelihood_map(glint_scenario(months=[1, 7], azimuth_from_sun_deg=[-15, 15])), folder / "glint_atlas.png"
    write_map(chances, output)
    for month, values in zip((1, 7), chances.probability[0].mean("longitude").values, strict=True):
        print(f"month {month}", *(f"{p:.3f}" for p in values))
    return output


def best_looks(folder: Path) -> Path:
    """Glint by bearing, hour and depression at one place and date; prints the best looks."""
    from seaglint.plot.likelihood_maps import write_best
    from seaglint.studies.likelihood.best_looks import best_looks as computed

    looks, output = computed(glint_scenario(place=[45, -30], depression_deg=[1.5, 15]), date="2026-04-15"), folder / "best_looks.png"
    write_best(looks, output)
    print("\n".join(looks.lines()))
    return output


def dataset_examples(folder: Path) -> Path:
    """Sheet of a data set; prints its card."""
    from seaglint.scenario.ensemble_file import parse_ensemble
    from seaglint.studies.ensemble.ensemble_dataset import DatasetOptions, EnsembleSource, ensemble_dataset

    raw = tomllib.loads((ROOT / "examples" / "small-objects.toml").read_text(encoding="utf-8"))
    # The first of the same draws: points of Sobol are the same in any number, and one frame of a scene is on the sheet.
    raw["ensemble"] |= {"scenes": SCENES, "frames": 1}
    made = ensemble_dataset(EnsembleSource(parse_ensemble(raw), "small-objects", None), folder / "D", DatasetOptions.of("coco"))
    print((made / "README.md").read_text(encoding="utf-8"))
    return made / "examples.png"


def response_masks(folder: Path) -> Path:
    """Geometric masks and masks of responses of four objects before one camera; prints their pixels."""
    import numpy as np
    from matplotlib.figure import Figure

    from seaglint.scenario.load import parse_scenario
    from seaglint.studies.sequence.labelled_frames import frame_datasets

    ball = {"temperature_k": 330, "north_m": -1200, "height_m": 2}
    objects = [
        {"name": "point", "shape": {"kind": "point", "intensity_w_sr": 2.0}, "north_m": -1200, "height_m": 2, "east_m": 5.0},
        {**ball, "name": "streak", "shape": {"kind": "sphere", "radius_m": 0.2}, "east_m": 2.0, "course_deg": 90, "speed_m_s": 900},
        {**ball, "name": "small", "shape": {"kind": "sphere", "radius_m": 0.2}, "east_m": -1.3},
        {**ball, "name": "large", "shape": {"kind": "sphere", "radius_m": 1.2}, "east_m": -4.8},
    ]
    camera = {"pixels": [48, 20], "azimuth_deg": 180, "elevation_deg": -1.34, "height_m": 30, "projection": "pinhole", "frames": 1}
    detector = {"pitch_um": 15, "fill_factor": 0.9, "integration_time_s": 0.002, "well_capacity_e": 8e6, "bit_depth": 14}
    sensor = {**camera, "optics": {"focal_length_m": 0.05, "f_number": 3.5}, "detector": detector}
    scenario = {"sensor": sensor, "band": {"min_um": 3.5, "max_um": 5.0}, "sun": {"azimuth_deg": 0}, "wind": {"speed_m_s": 4}}
    (frame,) = frame_datasets(parse_scenario({**scenario, "objects": objects}))
    picture = Figure(figsize=(8.0, 2.2), layout="constrained")
    counts = frame.signal.to_numpy().astype(float)
    for axes, name, title in zip(picture.subplots(1, 2), ("masks", "response_masks"), ("geometric", "response"), strict=True):
        axes.imshow(counts, cmap="gray", interpolation="nearest", vmin=counts.min(), vmax=np.percentile(counts, 95))
        for mask in frame[name].to_numpy():
            # Edges of pixels, drawn on a grid so fine that contours follow them.
            fine = np.kron(np.pad(mask, 1), np.ones((12, 12)))
            places = [(np.arange(size) + 0.5) / 12 - 1.5 for size in fine.shape]
            axes.contour(places[1], places[0], fine, levels=[0.5], colors="#5aeb78", linewidths=1.2)
        axes.set(title=title, xlabel="column [px]", ylabel="row [px]", xlim=(-0.5, 47.5), ylim=(19.5, -0.5))
        print(title, dict(zip(frame.names.to_numpy(), frame[name].sum(("y", "x")).to_numpy().tolist(), strict=True)))
    path = folder / "response_masks.png"
    save(picture, path)
    return path


def video(folder: Path) -> None:
    """Video of ten seconds of the demo, compressed for a page of the web, and its middle frame."""
    import av

    scenario = folder / "video.toml"
    scenario.write_text(re.sub(r"^frames = .*", f"frames = {VIDEO_FRAMES}", SCENARIO.read_text(encoding="utf-8"), flags=re.MULTILINE))
    seaglint("render", scenario, "-o", folder / "video.zarr", "--preview")
    with av.open(str(folder / "video.mp4")) as preview, av.open(str(VIDEO), "w", options={"movflags": "faststart"}) as output:
        source = preview.streams.video[0]
        stream = output.add_stream("libx264", rate=source.average_rate)
        stream.width, stream.height, stream.pix_fmt = source.width, source.height, "yuv420p"
        stream.options = {"crf": "32", "preset": "slow"}  # 1.2 MB; previews are of crf 18 and 9.7 MB
        for number, frame in enumerate(preview.decode(source)):
            if number == VIDEO_FRAMES // 2:
                frame.to_image().save(VIDEO.with_suffix(".jpg"), quality=80, optimize=True)
            output.mux(stream.encode(av.VideoFrame.from_image(frame.to_image())))
        output.mux(stream.encode())


def main(names: list[str]) -> None:
    """Draw those named, or all."""
    others = (near_horizon, likelihood_regions, glint_atlas, best_looks, response_masks, dataset_examples)
    pictures = (
        {"demo": render, "mean": mean}
        | {draw.__name__: draw for draw in others}
        | {name: partial(figure, name) for name in ("fig2", "fig3", "fig4", "fig10", "fig12", "measured")}
    )
    pictures |= {f"clutter_{name}": partial(clutter, name) for name in CLUTTER}
    if unknown := set(names) - {*pictures, "video"}:
        sys.exit(f"{', '.join(sorted(unknown))}: not one of {', '.join((*pictures, 'video'))}")
    IMAGES.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        for name in names or (*pictures, "video"):
            if name == "video":
                video(Path(folder))
                continue
            shutil.copy(pictures[name](Path(folder)), IMAGES / f"{name}.png")
            renew(IMAGES / f"{name}.png")
    for picture in sorted(IMAGES.glob("*.png")):
        print(f"{picture.relative_to(ROOT)}  {picture.stat().st_size / 1e3:.0f} kB")


if __name__ == "__main__":
    main(sys.argv[1:])
