"""Outlook on the labels of an ensemble before its scenes are rendered: objects out of view, and labels too weak to be visible."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.ndimage import binary_dilation

from seaglint.base.errors import SeaglintError
from seaglint.base.reports import REPORTS
from seaglint.base.threads import thread_limit
from seaglint.formats.dataset.dataset_writing import BLUR, visibility
from seaglint.formats.dataset.scene_records import LEAST_SNR
from seaglint.scenario.model import Scenario
from seaglint.store.layout import unpacked
from seaglint.studies.ensemble.law_draws import EnsembleScene, prepared
from seaglint.studies.sequence.out_of_view import out_of_view, times_of
from seaglint.studies.sequence.sequence_work import SceneCache

MOST_SCENES: Final = 500  #: Largest number of scenes whose objects are checked; of more scenes the first are checked.

MOST_NAMED: Final = 3  #: Largest number of objects out of view that are named; more are counted.

MOST_FRAMES: Final = 6  #: Largest number of frames that are drawn for an estimate.

SHARE: Final = 8  #: Frames of an ensemble for each one that is drawn for the estimate: it adds an eighth to the work at most.

PATIENCE: Final = 15.0  #: Time after which no further frame is drawn for the estimate [s].


def report_unseen(scenes: Sequence[EnsembleScene]) -> None:
    """Report the number of objects of an ensemble that are in no frame of their scene, with the first of them."""
    checked, objects, count = scenes[:MOST_SCENES], 0, 0
    named: list[str] = []
    for scene in checked:
        scenario = scene.scenario
        if not scenario.objects:
            continue
        objects += len(scenario.objects)
        for one in out_of_view(scenario, times_of(scenario)):
            count += 1
            if len(named) < MOST_NAMED:
                named.append(f"'{one.name}' of scene {scene.label}, {one.place}" + (", behind the horizon" if one.seen_to else ""))
    if not count:
        return
    first = f" of the first {len(checked)} scenes" if len(checked) < len(scenes) else ""
    more = f"; and {count - len(named)} more" if count > len(named) else ""
    REPORTS.warning(
        "%d of %d objects%s never enter the view and get no label: %s%s; point the sensor there, or place objects by column and row",
        count, objects, first, "; ".join(named), more,
    )  # fmt: skip


@dataclass(frozen=True)
class WeakLabels:
    """Estimated number of weak labels, from the first frames of some scenes."""

    weak: int  #: Labels with a ratio below ``least`` in the frames drawn.
    seen: int  #: All labels with a ratio in the frames drawn.
    frames: int  #: Frames drawn.
    labels: int  #: Labels expected in all frames of all scenes.
    noise: bool  #: True where a detector adds noise; without one the ratio is to clutter alone.
    least: float = LEAST_SNR  #: Ratio below which a label is weak.

    @property
    def line(self) -> str:
        """Return the estimate as a sentence."""
        about = f"some {round(self.labels * self.weak / self.seen)} of about {self.labels} labels" if self.seen else "no label"
        noise = "" if self.noise else " (to clutter alone: the scenes have no detector, and so no noise)"
        judged = "frame of one scene" if self.frames == 1 else f"frames of {self.frames} scenes"
        return (
            f"estimate: {about} will have a signal-to-noise ratio below {self.least:g}{noise} and be marked ignore, judged by "
            f"{self.weak} of {self.seen} in the first {judged}; nearer or warmer objects, a narrower field of view or, if noise dominates, "
            "less noise raise it; truth.csv has the ratio of each label (snr)"
        )


def weak_labels(
    scenes: Sequence[EnsembleScene], most: int = MOST_FRAMES, *, least: float = LEAST_SNR, patience: float = PATIENCE
) -> WeakLabels | None:
    """Estimate the number of labels with a ratio below ``least``; None without objects, or with too few frames to draw one for an estimate.

    First frames of scenes spread over the ensemble are drawn as for the data set, and their ratios are computed in the same way.

    Raises
    ------
    SeaglintError
        A scene that cannot be drawn.
    """
    with_objects = [scene.scenario for scene in scenes if scene.scenario.objects]
    count = min(len(with_objects), sum(scene.scenario.sensor.frames for scene in scenes) // SHARE, most)
    if not count:
        return None
    begin, cached = time.monotonic(), SceneCache()
    ratios: list[float] = []
    drawn = objects = 0
    for place in np.unique(np.linspace(0, len(with_objects) - 1, count).round().astype(int)):
        if drawn and time.monotonic() - begin > patience:
            break
        scenario = with_objects[int(place)]
        ratios += _ratios(scenario, cached)
        drawn, objects = drawn + 1, objects + len(scenario.objects or ())
    # Labels per object in all frames are taken as in the drawn ones.
    known = sum(len(scenario.objects or ()) * scenario.sensor.frames for scenario in with_objects)
    labels = round(known * len(ratios) / objects)
    weak = sum(ratio < least for ratio in ratios)
    return WeakLabels(weak, len(ratios), drawn, labels, all(scenario.sensor.senses for scenario in with_objects), least)


def _ratios(scenario: Scenario, cached: SceneCache) -> list[float]:
    """Return the signal-to-noise ratios of the labels in the first frame of a scene."""
    with thread_limit():
        run = prepared(scenario, cached)
        images = run.images(run.layout.frames[0])
    counts = "signal" in images
    values = np.asarray(images["signal" if counts else "radiance"], np.float64)
    masks = list(unpacked(images["response_mask" if counts else "object_mask"], len(scenario.objects or ())))
    # Blur carries light of an object into its neighbourhood, which is no background there.
    around = binary_dilation(np.logical_or.reduce(masks), iterations=BLUR)
    names = ("counts_peak",) if counts else ("signal_to_clutter",)
    numbers = [{name: float(images[name][n]) for name in names} for n in range(len(masks))]
    seen = (visibility(values, mask, around, row, counts=counts) for mask, row in zip(masks, numbers, strict=True))
    return [one.snr for one in seen if one is not None]


def report_weak(scenes: Sequence[EnsembleScene], least: float = LEAST_SNR) -> None:
    """Report the number of weak labels, if any; a scene that cannot be drawn is reported when it is rendered."""
    try:
        estimate = weak_labels(scenes, least=least)
    except SeaglintError:
        return
    if estimate is not None and estimate.weak:
        REPORTS.warning("%s", estimate.line)
