"""What every prepared scene answers: an image of it from a pose at a time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Protocol, Self

import numpy as np

from seaglint.errors import DomainError
from seaglint.radiance.view import SeaView
from seaglint.render.layers import Layers
from seaglint.render.platform import Pose


class Scene(Protocol):
    """A sea, its air and its Sun, prepared for a camera: frozen, whatever is drawn of it."""

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
        """The pose that the scene was prepared for, or the first of them."""
        ...

    @property
    def report(self) -> Mapping[str, Any]:
        """What was decided on preparing, for the provenance."""
        ...

    def reseeded(self, seed: int) -> Self:
        """Another realisation of the same sea, sparkles included, without preparing anything again."""
        ...

    def drawn(self, pose: Pose, time: float) -> Layers:
        """The image; see :func:`image`."""
        ...


def image(scene: Scene, pose: Pose, time: float) -> Layers:
    """Draw a scene.

    Parameters
    ----------
    scene : Scene
        What is prepared.
    pose : Pose
        Place and attitude of the sensor.
    time : float
        Time from the start [s].

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
    return scene.drawn(pose, time)


def joined(parts: Sequence[Layers]) -> Layers:
    """Images side by side, from the left."""
    return Layers({name: np.concatenate([part[name] for part in parts], axis=1) for name in parts[0]})


def require_columns(part: tuple[int, int], columns: int) -> None:
    """Refuse columns ``part = (first, end)`` that an image has not.

    Raises
    ------
    DomainError
        Saying which there are.
    """
    if not 0 <= part[0] < part[1] <= columns:
        raise DomainError(f"columns {part[0]} to {part[1]} of {columns}; give 0 <= first < end <= {columns}")
