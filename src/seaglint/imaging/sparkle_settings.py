"""Sparkle settings of a scene: cells of one length and time, or the waves; and whether sparkles matter in its pixels."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from seaglint.base.conventions import horizon_depression
from seaglint.facet.glint import glint
from seaglint.facet.sea_view import SeaView
from seaglint.facet.sunlight import turn_at, visible_sun
from seaglint.imaging.camera.imager import Camera
from seaglint.imaging.scene import Levels
from seaglint.imaging.sparkle import NO_SPARKLE, Sparkle, sparkle_of, sparkle_rows
from seaglint.imaging.wave_sparkle import cluster_table
from seaglint.radiance.lit_variance import WaveGlint
from seaglint.radiance.variance import patches

NEGLIGIBLE = 1e-4  #: Relative variance of the mirrored Sun, weighted by its square, below which sparkles are omitted: 1 % of the glint.

SURVEYED = 24  #: Number of rows and columns at which this variance is evaluated.


def relative_variance(view: SeaView, camera: Camera, cell: float | WaveGlint) -> float:
    """Return the relative variance of the mirrored Sun in a camera's pixels by the mean model, weighted by the square of its mean [1].

    Parameters
    ----------
    view : SeaView
        Sea and Sun.
    camera : Camera
        Its pixels.
    cell : float or WaveGlint
        Length of a cell of the sea [m], or the waves.

    Returns
    -------
    float
        0 where no Sun is mirrored.
    """
    rows, columns = (np.unique(np.linspace(0, n - 1, SURVEYED).astype(int)) for n in (camera.rows, camera.columns))
    rows = rows[-camera.elevations[rows] > horizon_depression(camera.height)]
    ground = sparkle_rows(camera)
    slant = (ground.along * ground.grazing / camera.row_step)[rows][:, None]
    solid = (ground.reach * camera.column_step * camera.row_step)[rows][:, None] / slant
    theta = np.arccos(ground.grazing[rows])[:, None]
    turn = turn_at(ground.range_m[rows])[:, None]
    sun = (view.solar_zenith, view.solar_azimuth)
    mirrored = glint(theta, camera.azimuths[columns] + np.pi, *sun, view.slopes, view.shadowing, turn, view.disc.lit_radius)
    shown = mirrored.chance > 0.0
    if not shown.any():
        return 0.0
    cosine = np.where(shown, mirrored.cos_incidence, 1.0)
    if isinstance(cell, WaveGlint):
        up = math.cos(visible_sun(view.solar_zenith)[1])
        lit = cell.relative_variance(
            view.slopes, view.disc.lit_radius, cosine, theta, up, slant, solid, np.where(shown, mirrored.chance, 1.0), view.solar_azimuth
        )
        return float(np.sum(mirrored.chance**2 * lit) / np.sum(mirrored.chance**2))
    # number of cells in a pixel
    many = patches(cosine, theta, view.solar_zenith, slant, solid, cell)
    return float(np.sum(mirrored.chance * (1.0 - mirrored.chance) / np.maximum(many, 1.0)) / np.sum(mirrored.chance**2))


@dataclass(frozen=True)
class Sparkles:
    """Sparkle settings of a scene; ``use = "auto"`` omits them where they are negligible.

    Parameters
    ----------
    seed : int
        The sea's seed.
    cell : float
        Length of its cells [m]; not used with ``waves``.
    correlation_time : float
        Correlation time of the glint at a point [s]; not used with ``waves``.
    use : {"auto", "on", "off"}
        Draw them, omit them, or omit them where they are negligible.
    waves : WaveGlint, optional
        Waves from which the fluctuation follows.
    """

    seed: int
    cell: float
    correlation_time: float
    use: Literal["auto", "on", "off"] = "auto"
    waves: WaveGlint | None = None

    def reseeded(self, seed: int) -> Sparkles:
        """Return the sparkles of another realisation of the sea."""
        return replace(self, seed=seed)

    def of(self, view: SeaView, camera: Camera, levels: Levels) -> tuple[Sparkle, dict[str, Any]]:
        """Return the parameters for the kernels, ``NO_SPARKLE`` for images without sparkles, and a note for the provenance."""
        if self.use == "off":
            return NO_SPARKLE, {"subpixel_glint": "off: the mean over the facets of a pixel"}
        variance = relative_variance(view, camera, self.cell if self.waves is None else self.waves)
        if variance == 0.0:
            return NO_SPARKLE, {"subpixel_glint": "none: no mirrored Sun in the image"}
        if self.use == "auto" and variance < NEGLIGIBLE:
            return NO_SPARKLE, {"subpixel_glint": f"left out: its relative variance, {variance:.1e}, is below {NEGLIGIBLE:g}"}
        note = {"subpixel_glint": "gamma field on the water's mean position", "subpixel_glint_relative_variance": float(f"{variance:.3g}")}
        if self.waves is None:
            note |= {"subpixel_glint_cell_m": self.cell, "subpixel_glint_correlation_time_s": self.correlation_time}
            return sparkle_of(self.seed, self.cell, self.correlation_time), note
        table = cluster_table(self.waves, view, camera, levels)
        note |= {"subpixel_glint_from": "waves", "subpixel_glint_correlation_time_s": [float(f"{t:.3g}") for t in table.times[:, -1]]}
        return sparkle_of(self.seed, 1.0, 1.0)._replace(clusters=table), note


NO_SPARKLES = Sparkles(0, 1.0, 1.0, "off")  #: Settings of scenes that hold the mean over the facets of a pixel.
