"""Shadows of waves under a low Sun: the share of the solar disc that a point of the resolved sea sees over the crests towards it."""

from __future__ import annotations

import math

from seaglint.air.setting_sun import visible_part_kernel
from seaglint.base.jit import kernel
from seaglint.facet.sunlight import Sunlight
from seaglint.imaging.wave_surface import Surface, SurfaceLine, height, point_height, position

FARTHEST = 4000  #: Number of steps after which a Sun at the very horizon counts as visible.


@kernel
def sun_over_waves(
    surface: Surface, level: int, line: SurfaceLine, sunward: SurfaceLine, r: float, march: tuple[float, float], sun: Sunlight
) -> tuple[float, float]:
    """Share of the solar disc visible from the sea ``r`` metres along a line, over the waves of a level towards the Sun there.

    With it comes the height of that part's middle above the whole disc's [rad].

    The skyline is looked for in the Sun's own azimuth, in steps [m] of ``march[0]`` or as many as a sea that rises by ``march[1]`` at
    most allows, as far as the highest crest could reach over the lower limb; the round sea's drop over that distance is left out. Tiles are
    displaced on the whole way as where it begins.
    """
    step, rise = march
    tiles = line.part.shape[0]
    own = height(surface, line, 0, tiles, r)
    low = max(sun.lower_tangent, 1e-4)
    steps = min((surface.crest[level, 0] - own) / (low * step), float(FARTHEST))
    # most waves that shade a place are near it: the first step is taken in parts
    skyline, n = -1.0, 0.25
    while n <= steps:
        d, z = n * step, 0.0
        for j in range(tiles):
            u, v = position(line, j, r)
            u, v = u + d * sunward.step[j, 0, 0], v + d * sunward.step[j, 0, 1]
            z += point_height(surface, line, j, u, v)
        skyline = max(skyline, (z - own) / d)
        if skyline >= sun.upper_tangent:
            return 0.0, 0.0
        # the sea cannot rise to the ray before it has made up for the gap
        ray = max(low, skyline)
        n = max(2.0 * n if n < 1.0 else n + 1.0, math.floor(n + (own + d * ray - z) / (max(rise - ray, 1e-6) * step)))
    if skyline <= low:
        return 1.0, 0.0
    return visible_part_kernel(math.asin(sun.up) - math.atan(skyline))
