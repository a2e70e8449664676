"""Accuracy settings of the renderer and the error that each of them bounds."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from seaglint.base.errors import DomainError


@dataclass(frozen=True)
class Accuracy:
    """Accuracy settings of the renderer."""

    step: float | None = None  #: Largest step of the sweep at the finest level of detail [m]; from ``steps_per_wave`` where it is None.
    #: Steps of the sweep per shortest resolved wave, as many as its lattice has; twice as many move column means by less than 0.5 %.
    steps_per_wave: float = 4.0
    lines_per_column: int = 16  #: Most lines of sight in a column, a power of two; as many are used as ``variance_error`` asks for.
    #: Columns that an octave's longest waves must span to stay geometry, whatever their share of the variance; 0 keeps all waves at any
    #: range.
    shortest_wave_columns: float = 2.0
    #: Error of the variance of pixels, to first order in the slopes, up to which levels of detail leave waves out and lines stand apart.
    #: With the default, deviations of pixels are within 5 % of those of finer pictures averaged down, from 10 m to 3 km.
    variance_error: float = 0.02
    #: Slope variance among neighbouring pieces of sea in a third of a row, over that of their facets, up to which they are shaded as one; 0
    #: shades each for itself. Mean radiance moves by less than 0.1 %, the deviation of pixels by less than 1 %.
    merged_spread: float = 0.1
    crest: float = 1.25  #: Height above which no crest is expected, in significant heights: five standard deviations.
    #: Share of the sea in the shadow of resolved waves, by Smith's law, below which none is drawn: glint changes by less than 0.3 %.
    negligible_shadow: float = 1e-3
    steepest_rise: float = 3.0  #: Rise of the sea along a shadow ray that is reckoned with, in rms slopes: one place in 700 is steeper.
    #: Cells of the sweep across a pixel of a turned camera: waves of a pixel's size keep 96 % of their variance (two: 93 %, four: 97 %).
    oversampling: int = 3
    #: Elevation from which on downwards a turned camera's rays are walked one by one [rad]: they are cheap there, and columns of equal
    #: azimuth get narrow.
    walk_below: float = math.radians(-40.0)
    #: Ratio of the sensor heights for which the air is prepared: transmittances of a moving sensor are within that of a height 2 % lower.
    height_step: float = 1.02

    def __post_init__(self) -> None:
        lines = self.lines_per_column
        if lines < 1 or lines & (lines - 1):
            raise DomainError(f"lines_per_column = {lines} is no power of two; give 1, 2, 4, 8 or 16")
        if self.oversampling < 1:
            raise DomainError(f"oversampling = {self.oversampling} is outside 1 and more; give a whole number from 1 on")

    def of_cells(self) -> Accuracy:
        """Return the settings for the sweep's cells of a turned camera, with as many lines in a pixel of the camera for any cells."""
        return replace(
            self,
            lines_per_column=max(self.lines_per_column >> (self.oversampling.bit_length() - 1), 1),
            shortest_wave_columns=self.shortest_wave_columns * self.oversampling,
        )
