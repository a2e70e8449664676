"""Shadow of a body on itself: a map of its surfaces that face away from the Sun."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from seaglint.base.jit import kernel, njit

#: Least distance towards the Sun between a shading and a shaded surface, as a share of the body's size: rounding of its shadow map.
LIFT: Final = 1e-3


class SunMap(NamedTuple):
    """Shadow map: coordinates towards the Sun [m] of the surfaces that face away from it, on a grid across its light.

    The fields are direction to the Sun (3), unit vectors across (2, 3), coordinates of the first cell and cells per metre (4), and
    coordinates towards the Sun [m]. Without cells nothing is shaded.
    """

    sun: np.ndarray
    across: np.ndarray
    first: np.ndarray
    nearest: np.ndarray
    lift: float


@kernel
def lit(shadow: SunMap, point: tuple[float, float, float]) -> bool:
    """True if no part of the body is between a point and the Sun."""
    if shadow.nearest.shape[0] == 0:
        return True
    a, f = shadow.across, shadow.first
    i = int((a[0, 0] * point[0] + a[0, 1] * point[1] + a[0, 2] * point[2] - f[0]) * f[2])
    j = int((a[1, 0] * point[0] + a[1, 1] * point[1] + a[1, 2] * point[2] - f[1]) * f[3])
    if i < 0 or j < 0 or i >= shadow.nearest.shape[1] or j >= shadow.nearest.shape[0]:
        return True
    along = shadow.sun[0] * point[0] + shadow.sun[1] * point[1] + shadow.sun[2] * point[2]
    return bool(shadow.nearest[j, i] <= along + shadow.lift)


@njit
def sun_map(vertex: np.ndarray, corner: np.ndarray, axes: tuple[np.ndarray, np.ndarray], cells: int, lift: float) -> SunMap:
    """Shadow map of triangles that face away from the Sun: a closed body shades itself by these, and no lit facet by itself.

    ``axes``: direction to the Sun and unit vectors across it; ``cells``: along a side; ``lift``: how much nearer to the Sun shades [m].
    """
    sun, across = axes
    wide = high = cells
    nearest = np.full((high, wide), -np.inf)
    point = np.empty((vertex.shape[0], 3))
    low, top = np.full(2, np.inf), np.full(2, -np.inf)
    for n in range(vertex.shape[0]):
        east, north, up = vertex[n, 0], vertex[n, 1], vertex[n, 2]
        for k in range(2):
            point[n, k] = across[k, 0] * east + across[k, 1] * north + across[k, 2] * up
            low[k], top[k] = min(low[k], point[n, k]), max(top[k], point[n, k])
        point[n, 2] = sun[0] * east + sun[1] * north + sun[2] * up
    first = np.array([low[0], low[1], cells / max(top[0] - low[0], 1e-9), cells / max(top[1] - low[1], 1e-9)])
    for n in range(vertex.shape[0]):
        point[n, 0], point[n, 1] = (point[n, 0] - first[0]) * first[2], (point[n, 1] - first[1]) * first[3]
    for t in range(corner.shape[0]):
        a, b, c = corner[t, 0], corner[t, 1], corner[t, 2]
        ax, ay, bx, by, cx, cy = point[a, 0], point[a, 1], point[b, 0], point[b, 1], point[c, 0], point[c, 1]
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        if area >= 0.0:
            continue
        # shares of b and c, and the coordinate towards the Sun, change linearly from cell to cell
        scale = 1.0 / area
        b_across, b_down, c_across, c_down = (cy - ay) * scale, (ax - cx) * scale, (ay - by) * scale, (bx - ax) * scale
        to_b, to_c = point[b, 2] - point[a, 2], point[c, 2] - point[a, 2]
        left, right = max(int(min(ax, bx, cx)), 0), min(int(max(ax, bx, cx)) + 1, wide)
        for j in range(max(int(min(ay, by, cy)), 0), min(int(max(ay, by, cy)) + 1, high)):
            dx, dy = left + 0.5 - ax, j + 0.5 - ay
            of_b, of_c = dx * b_across + dy * b_down, dx * c_across + dy * c_down
            for i in range(left, right):
                if of_b >= 0.0 and of_c >= 0.0 and of_b + of_c <= 1.0:
                    along = point[a, 2] + of_b * to_b + of_c * to_c
                    if along > nearest[j, i]:
                        nearest[j, i] = along
                of_b += b_across
                of_c += c_across
    return SunMap(sun, across, first, nearest, lift)
