"""Interface of a prepared scene: an image of it from a pose at a time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.facet.sea_view import SeaView
from seaglint.imaging.camera.imager import Imager
from seaglint.imaging.camera.pose import Pose
from seaglint.imaging.detail_levels import Levels
from seaglint.imaging.layers import Layers
from seaglint.imaging.wave_surface import Surface
from seaglint.sea.field import WaveField


class Instant(NamedTuple):
    """Sea of an instant under a sensor: its levels of detail, their lattices, and these as kernels read them."""

    levels: Levels
    lattices: tuple[NDArray[np.float32], ...]
    surface: Surface


class Scene(Protocol):
    """Sea, air and Sun prepared for a camera; immutable."""

    @property
    def view(self) -> SeaView:
        """Sea, air and Sun, at the sensor's first height."""
        ...

    @property
    def layers(self) -> tuple[str, ...]:
        """Layers that images have beside ``radiance`` and ``glint_radiance``."""
        ...

    @property
    def pose(self) -> Pose:
        """Pose that the scene was prepared for, or the first of them."""
        ...

    @property
    def waves(self) -> WaveField | None:
        """Part of the slopes that is geometry; None where no waves are resolved."""
        ...

    @property
    def report(self) -> Mapping[str, Any]:
        """Settings chosen during preparation, for the provenance."""
        ...

    def reseeded(self, seed: int) -> Self:
        """Return another realisation of the same sea, sparkles included, without preparing anything again."""
        ...

    @property
    def pixels(self) -> Imager:
        """The camera's pixels."""
        ...

    def seen_from(self, pose: Pose) -> SeaView:
        """View of sea, air and Sun from a pose."""
        ...

    def sea(self, pose: Pose, time: float) -> Instant:
        """Sea of an instant under a sensor."""
        ...

    def drawn(self, pose: Pose, time: float, sea: Instant | None = None) -> Layers:
        """Image of the scene; see :func:`image`."""
        ...

    def columns(self, pose: Pose, time: float, part: tuple[int, int], sea: Instant | None = None) -> Layers:
        """Image of the columns ``part = (first, end)`` alone."""
        ...

    def directions(self, pose: Pose) -> tuple[FloatArray, FloatArray]:
        """Azimuth and elevation of pixel centres [rad]: of columns and rows of an upright camera, else of all pixels."""
        ...


def image(scene: Scene, pose: Pose, time: float, sea: Instant | None = None) -> Layers:
    """Draw a scene.

    Parameters
    ----------
    scene : Scene
        Prepared scene.
    pose : Pose
        Place and attitude of the sensor.
    time : float
        Time from the start [s].
    sea : Instant, optional
        ``scene.sea(pose, time)``, where it is at hand.

    Returns
    -------
    Layers
        Radiance at the aperture, the mirrored Sun in it [W m-2 sr-1, (rows, columns)] and the scene's other layers; a function of the
        arguments alone.

    Raises
    ------
    DomainError
        A pose that the scene was not prepared for, or a crest above the sensor.
    """
    if not np.isfinite(time):
        raise DomainError(f"time = {time:g} s is not finite; give seconds from the start")
    return scene.drawn(pose, time, sea)


def joined(parts: Sequence[Layers]) -> Layers:
    """Images joined side by side, from the left."""
    return Layers({name: np.concatenate([part[name] for part in parts], axis=1) for name in parts[0]})


def require_columns(part: tuple[int, int], columns: int) -> None:
    """Refuse columns ``part = (first, end)`` outside the image.

    Raises
    ------
    DomainError
        Saying which there are.
    """
    if not 0 <= part[0] < part[1] <= columns:
        raise DomainError(f"columns {part[0]} to {part[1]} of {columns}; give 0 <= first < end <= {columns}")
