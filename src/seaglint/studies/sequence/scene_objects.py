"""Objects of a scenario in its pictures, drawn over the sea, and their labels for the store.

Labels are speed, streak, blur and class of size; those of a detector's counts are in ``seaglint.studies.sequence.object_counts``.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError, ScenarioError
from seaglint.imaging.camera.imager import Attitude, Imager
from seaglint.imaging.camera.pose import Pose
from seaglint.imaging.layers import Layers
from seaglint.imaging.refraction import RefractedScene
from seaglint.imaging.scene import Instant, Scene, joined
from seaglint.objects.body import Body
from seaglint.objects.drawing.compose import BodySight, composed, refracted_picture, shadowed
from seaglint.objects.drawing.draw import Drawer, Stage
from seaglint.objects.drawing.image_path import SHORT, Streak, View, path_about
from seaglint.objects.drawing.light import Counting
from seaglint.objects.drawing.truth import labels, numbers_of, size_classes
from seaglint.objects.wakes import foam_of_ships
from seaglint.scenario.model import Scenario
from seaglint.sea.foam.ship_foam import FoamSegments
from seaglint.sea.wave_field import WaveField
from seaglint.store.layout import Truth, packed

Numbers = dict[str, FloatArray]  #: Numbers of all objects by the names of their columns [(objects,)].


def motion_numbers(
    streaks: Sequence[Streak | None], labels: Mapping[str, NDArray[np.float64]], blur: float = math.nan, *, mirage: bool = False
) -> Numbers:
    """Return speed, streak and blur of objects.

    Parameters
    ----------
    streaks : sequence of Streak
        Streaks of the objects; None for objects behind the camera.
    labels : mapping
        Their other labels.
    blur : float
        Standard deviation of the sensor's blur [pixels]; NaN without a sensor.
    mirage : bool
        Whether the air shifts objects in the picture: streaks are then shifted to the middle of the visible object.
    """
    names = ("velocity_column_px_s", "velocity_row_px_s", "motion_px", "blur_px")
    ends = ("streak_begin_column_px", "streak_begin_row_px", "streak_end_column_px", "streak_end_row_px")
    out = {name: np.full(len(streaks), math.nan) for name in (*names, *ends)}
    for n, streak in enumerate(streaks):
        if streak is None:
            continue
        place = np.array([labels["column_px"][n], labels["row_px"][n]])
        # In a mirage the drawn image is displaced from the geometric path.
        shift = place - streak.middle if mirage and np.isfinite(place).all() else np.zeros(2)
        out["velocity_column_px_s"][n], out["velocity_row_px_s"][n] = streak.velocity
        out["motion_px"][n] = streak.length
        # A streak of length L has the variance L^2/12 along it, L^2/24 averaged over both directions.
        out["blur_px"][n] = math.sqrt(blur**2 + streak.length**2 / 24.0)
        for name, value in zip(ends, (streak.ends + shift).ravel(), strict=True):
            out[name][n] = value
    return out


BodiesOf = Callable[[WaveField | None], tuple[Body, ...]]  #: Bodies over a realisation of the sea: those that float follow it.


@dataclass(frozen=True, eq=False)
class DrawnImage:
    """An image with objects, the radiance of the sea alone [W m-2 sr-1], and the sight of each object."""

    layers: Layers
    sea: NDArray[np.float32]
    sights: tuple[BodySight, ...]

    @classmethod
    def beside(cls, parts: list[DrawnImage]) -> DrawnImage:
        """Return images side by side, from the left, without sights."""
        return cls(joined([part.layers for part in parts]), np.concatenate([part.sea for part in parts], axis=1), ())

    @classmethod
    def below(cls, parts: list[DrawnImage]) -> DrawnImage:
        """Return images one below the other, from the top, without sights."""
        layers = Layers({name: np.concatenate([part.layers[name] for part in parts], axis=0) for name in parts[0].layers})
        return cls(layers, np.concatenate([part.sea for part in parts], axis=0), ())

    def rows(self, first: int, end: int) -> DrawnImage:
        """Return some rows alone, without sights."""
        cut = slice(first, end)
        return DrawnImage(Layers({name: image[cut] for name, image in self.layers.items()}), self.sea[cut], ())


@dataclass(frozen=True, eq=False)
class SceneObjects:
    """Objects of one realisation of the sea. Make them with ``of``."""

    drawer: Drawer
    _bodies: BodiesOf
    shadows: bool = False

    @classmethod
    def of(cls, bodies: BodiesOf, waves: WaveField | None, *, shadows: bool = False) -> SceneObjects | None:
        """Return objects over a sea, with or without ``shadows`` on its glint; None without objects."""
        placed = bodies(waves)
        return cls(Drawer.of(placed), bodies, shadows) if placed else None

    def others(self, bodies: BodiesOf, waves: WaveField | None, *, shadows: bool = False) -> SceneObjects | None:
        """Return other objects over a sea, in the light that is already computed; None without objects."""
        placed = bodies(waves)
        return replace(self, drawer=self.drawer.moved(placed), _bodies=bodies, shadows=shadows) if placed else None

    def counting(self, counted: Counting | None) -> SceneObjects:
        """Return the objects before a detector that counts photons, or of energy (None)."""
        return replace(self, drawer=self.drawer.counting(counted))

    def over(self, waves: WaveField | None) -> SceneObjects:
        """Return the objects over another realisation of the sea."""
        return replace(self, drawer=self.drawer.moved(self._bodies(waves)))

    def foam(self, time: float) -> FoamSegments:
        """Return the foam of the ships among them at a time [s]."""
        return foam_of_ships(self.drawer.bodies, time)

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
    ) -> DrawnImage:
        """Draw objects over the image of the sea in ``window = (columns, rows)``, first and end.

        Without ``compose`` the objects are left out, and only their shadows drawn.
        """
        layers, sea = image
        waves = None if scene.waves is None else (sea.levels, sea.surface)
        stage = Stage(scene.pixels, pose, scene.seen_from(pose), waves, *window)
        if not compose:
            if self.shadows:
                layers = shadowed(layers, stage, self.drawer.placed(pose, time)[1], self.drawer.light(stage.view))
            return DrawnImage(layers, layers.radiance, ())
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
        return DrawnImage(out, layers.radiance, sights)

    def truth(
        self, seen: tuple[BodySight, ...], sea: NDArray[Any], scene: Scene, camera: tuple[Imager, Attitude]
    ) -> Mapping[str, NDArray[Any]]:
        """Return the stored arrays of the objects of a frame, by variable of the group ``truth``, without motion and counts.

        Sights, sea and ``camera``, with its attitude, belong to the stored pixels.
        """
        numbers, masks, which = labels(seen, sea, self.drawer.light(scene.view).kelvin, around=scene.pixels.goes_round)
        return {**numbers, "size_class": size_classes(numbers, *camera), "object_mask": packed(masks), "object_id": which}

    def streaks(self, view: View, time: float) -> tuple[Streak | None, ...]:
        """Return place and speed of each object in the image at a time [s]."""
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
    """Return a function for the bodies of a scenario's ``[[objects]]``; they are empty without objects.

    Raises
    ------
    ScenarioError
        When the function is called: objects that do not fit the scene.
    """
    if not scenario.objects:
        return lambda waves: ()
    from seaglint.studies.build.bodies import bodies

    def made(waves: WaveField | None) -> tuple[Body, ...]:
        try:
            return tuple(bodies(scenario, waves))
        except DomainError as error:
            raise ScenarioError(str(error)) from error

    return made
