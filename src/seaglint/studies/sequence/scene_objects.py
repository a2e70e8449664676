"""Objects of a scenario in its pictures: drawn over the sea, with what is true of them for the store."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import DomainError, ScenarioError
from seaglint.files.store.stored_truth import Truth, packed
from seaglint.imaging.camera.imager import Attitude, Imager
from seaglint.imaging.camera.pose import Pose
from seaglint.imaging.layers import Layers
from seaglint.imaging.refracted import RefractedScene
from seaglint.imaging.scene import Instant, Scene, joined
from seaglint.objects.body import Body
from seaglint.objects.drawing.compose import BodySight, composed
from seaglint.objects.drawing.draw import Drawer, Stage
from seaglint.objects.drawing.image_path import SHORT, Streak, View, path_about
from seaglint.objects.drawing.light import Counting
from seaglint.objects.drawing.object_shadow import shadowed
from seaglint.objects.drawing.refracted_bodies import refracted_picture
from seaglint.objects.drawing.truth import labels, numbers_of, size_classes
from seaglint.scenario.model import Scenario
from seaglint.sea.field import WaveField

BodiesOf = Callable[[WaveField | None], tuple[Body, ...]]  #: Bodies over a realisation of the sea: those that float follow it.


@dataclass(frozen=True, eq=False)
class Drawn:
    """An image with objects, the sea's alone [W m-2 sr-1], and what is seen of each object."""

    layers: Layers
    sea: NDArray[np.float32]
    sights: tuple[BodySight, ...]

    @classmethod
    def beside(cls, parts: list[Drawn]) -> Drawn:
        """Images side by side, from the left, without sights."""
        return cls(joined([part.layers for part in parts]), np.concatenate([part.sea for part in parts], axis=1), ())

    @classmethod
    def below(cls, parts: list[Drawn]) -> Drawn:
        """Images one below the other, from the top, without sights."""
        layers = Layers({name: np.concatenate([part.layers[name] for part in parts], axis=0) for name in parts[0].layers})
        return cls(layers, np.concatenate([part.sea for part in parts], axis=0), ())

    def rows(self, first: int, end: int) -> Drawn:
        """Some rows alone, without sights."""
        cut = slice(first, end)
        return Drawn(Layers({name: image[cut] for name, image in self.layers.items()}), self.sea[cut], ())


@dataclass(frozen=True, eq=False)
class SceneObjects:
    """Objects of one realisation of the sea. Make them with :meth:`of`."""

    drawer: Drawer
    _bodies: BodiesOf
    shadows: bool = False

    @classmethod
    def of(cls, bodies: BodiesOf, waves: WaveField | None, *, shadows: bool = False) -> SceneObjects | None:
        """Objects over a sea, with ``shadows`` on its glint or without; None where there are none."""
        placed = bodies(waves)
        return cls(Drawer.of(placed), bodies, shadows) if placed else None

    def counting(self, counted: Counting | None) -> SceneObjects:
        """Return the objects before a detector that counts photons, or of energy (None)."""
        return replace(self, drawer=Drawer.of(self.drawer.bodies, counted))

    def over(self, waves: WaveField | None) -> SceneObjects:
        """Return the objects over another realisation of the sea."""
        return replace(self, drawer=self.drawer.moved(self._bodies(waves)))

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the objects."""
        return tuple(body.name for body in self.drawer.bodies)

    def draw(
        self,
        scene: Scene,
        pose: Pose,
        time: float,
        image: tuple[Layers, Instant],
        window: tuple[tuple[int, int], tuple[int, int]],
        *,
        compose: bool = True,
    ) -> Drawn:
        """Objects over an image of the sea, the one of ``window = (columns, rows)``, first and end.

        Without ``compose`` the objects are left out, and only their shadows drawn.
        """
        layers, sea = image
        waves = None if scene.waves is None else (sea.levels, sea.surface)
        stage = Stage(scene.pixels, pose, scene.seen_from(pose), waves, *window)
        if not compose:
            if self.shadows:
                layers = shadowed(layers, stage, self.drawer.placed(pose, time)[1], self.drawer.light(stage.view))
            return Drawn(layers, layers.radiance, ())
        if isinstance(scene, RefractedScene):
            picture = refracted_picture(self.drawer, stage, scene, time)
        else:
            picture = self.drawer.picture(stage, time)
        if self.shadows:
            layers = shadowed(layers, stage, picture.placed, self.drawer.light(stage.view))
        out, sights = composed(layers, stage, picture, self.drawer.light(stage.view))
        if "object_id" in out:
            whole = numbers_of(sights, (stage.imager.rows, stage.imager.columns), around=stage.imager.goes_round)
            out = Layers({**out, "object_id": whole[slice(*window[1]), slice(*window[0])].astype(np.float32)})
        return Drawn(out, layers.radiance, sights)

    def truth(
        self, seen: tuple[BodySight, ...], sea: NDArray[Any], scene: Scene, camera: tuple[Imager, Attitude]
    ) -> Mapping[str, NDArray[Any]]:
        """Return the stored arrays of the objects of a frame, by variable of the group ``truth``, without motion and counts.

        Sights, sea and ``camera``, with its attitude, are those of the stored pixels.
        """
        kelvin = self.drawer.light(scene.view).kelvin
        numbers, masks, which = labels(seen, sea, kelvin, around=scene.pixels.goes_round)
        sizes = size_classes(numbers, *camera)
        return {**numbers, "size_class": sizes, "object_mask": packed(masks), "object_id": which}

    def streaks(self, view: View, time: float) -> tuple[Streak | None, ...]:
        """Place and speed of each object in the image at a time [s]."""
        out: list[Streak | None] = [None] * len(self.drawer.bodies)
        for part in self.drawer.parts:
            if out[part.body] is None:
                path = path_about(view, self.drawer.bodies[part.body].motion, part, time, SHORT)
                out[part.body] = Streak.of(path, time, time)
        return tuple(out)

    def layout(self) -> Truth:
        """Return the layout of the group ``truth``."""
        return Truth(self.names)


def bodies_of(scenario: Scenario) -> BodiesOf:
    """Bodies of a scenario's ``[[objects]]``; none without.

    Raises
    ------
    ScenarioError
        When asked for: objects that do not fit the scene.
    """
    if not scenario.objects:
        return lambda waves: ()
    from seaglint.studies.prepare.bodies import bodies

    def made(waves: WaveField | None) -> tuple[Body, ...]:
        try:
            return tuple(bodies(scenario, waves))
        except DomainError as error:
            raise ScenarioError(str(error)) from error

    return made
