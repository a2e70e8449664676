"""Frames of a scene and the labels of its objects: read from the scene's store, or held in memory by the process that drew them."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import groupby, repeat
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seaglint.base.free_form import JsonObject
from seaglint.base.schema import NUMBERS, VARIABLES, default_image
from seaglint.formats.object_labels import RESPONSE, Label, Labels
from seaglint.store.layout import Layout
from seaglint.store.sequence_store import open_sequence
from seaglint.store.stored_images import count_line, line_of, pictures


@dataclass(frozen=True, eq=False)
class LabelledScene:
    """Frames of a scene with their labels, in the values of its store. Make them with ``stored`` or ``held``."""

    source: Path  #: Store or scenario, which errors name.
    variable: str  #: Name of the images: ``signal`` or ``radiance``.
    line: tuple[float, float]  #: Radiance of one count and of zero counts [W m-2 sr-1]; (1, 0) of radiance.
    frames: tuple[int, ...]  #: Numbers of the frames.
    times: tuple[float, ...]  #: Times of the frames [s].
    shape: tuple[int, int]  #: Rows and columns.
    seed: int
    scenario: JsonObject
    image: Callable[[int], NDArray[Any]]  #: Image (rows, columns) of a frame by its place in the sequence.
    labels: Labels | None  #: Labels of the objects; None without objects.

    @classmethod
    @contextmanager
    def stored(cls, store: Path, masks: str = RESPONSE) -> Iterator[LabelledScene]:
        """Open the frames of a finished sequence, which are read one at a time, with masks of a kind.

        Raises
        ------
        DataError
            No finished sequence.
        """
        with open_sequence(store) as dataset:
            variable = pictures(dataset)
            scenario = json.loads(dataset.attrs["scenario"])
            yield cls(
                source=store,
                variable=str(variable.name),
                line=count_line(variable),
                frames=tuple(int(number) for number in dataset["frame"].to_numpy()),
                times=tuple(float(time) for time in dataset["time"].to_numpy()),
                shape=(int(variable.shape[1]), int(variable.shape[2])),
                seed=int(dataset.attrs["seed"]),
                scenario=scenario,
                image=lambda place: variable[place].to_numpy(),
                labels=Labels.of(store, masks) if scenario.get("objects") else None,
            )

    @classmethod
    def held(cls, source: Path, layout: Layout, frames: Iterable[Mapping[str, NDArray[Any]]], masks: str = RESPONSE) -> LabelledScene:
        """Hold frames in memory, in the types in which a store holds them; arrays that a data set does not need are dropped.

        Parameters
        ----------
        source : Path
            File of the scenario.
        layout : Layout
            Layout of the sequence.
        frames : iterable of mapping
            Arrays of each frame by variable, as they are written to a store.
        masks : str
            Kind of masks.
        """
        variable = default_image(layout.variables)
        assert variable is not None  # every rendered sequence has radiance or counts
        planes = () if layout.truth is None else tuple(name for name in layout.truth.images if name != "object_id")
        truth = {} if layout.truth is None else {**dict.fromkeys(NUMBERS, "float64"), **{name: VARIABLES[name].dtype for name in planes}}
        kinds = {variable: VARIABLES[variable].dtype, **truth}
        kept = [{name: np.array(arrays[name], kind) for name, kind in kinds.items()} for arrays in frames]
        numbers, shape = tuple(layout.frames), layout.shape[1:]
        group = {name: np.stack([arrays[name] for arrays in kept]) for name in truth}
        return cls(
            source=source,
            variable=variable,
            line=line_of(variable, layout.details.get(variable, {})),
            frames=numbers,
            times=tuple(number / layout.frame_rate for number in numbers),
            shape=shape,
            seed=int(layout.attributes["seed"]),
            scenario=json.loads(layout.attributes["scenario"]),
            image=lambda place: kept[place][variable],
            labels=None if layout.truth is None else Labels(source, layout.truth.names, numbers, shape, group, masks),
        )

    def each(self) -> Iterator[tuple[int, NDArray[Any], Sequence[Label]]]:
        """Yield place, image and labels of each frame."""
        groups: Iterator[Sequence[Label]] = repeat(())
        if self.labels is not None:
            groups = (list(group) for _, group in groupby(self.labels, key=lambda label: label.frame))
        for place, labels in zip(range(len(self.frames)), groups, strict=False):
            yield place, self.image(place), labels
