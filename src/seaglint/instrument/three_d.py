r"""Three-dimensional noise: a cube of frames of an even scene split into seven components.

Averaging operators over time, rows and columns (NVESD) take the cube apart; with :math:`D_t` the mean over time and so on,

.. math:: \text{TVH} = (1 - D_t)(1 - D_v)(1 - D_h)\,U, \quad \text{VH} = D_t (1 - D_v)(1 - D_h)\,U, \;\ldots

the parts are orthogonal and their mean squares add to the variance of the cube. The mean over n samples of a component that changes still
holds one n-th of its variance: :func:`three_d_noise` takes that off, so that components put in come back.

References
----------
J. D'Agostino and C. Webb, 3-D analysis framework and measurement methodology for imaging system noise, Proc. SPIE 1488 (1991).
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError

#: Components: time; rows (each one level); columns; rows in time; columns in time; pixels; pixels in time.
COMPONENTS: Final = ("T", "V", "H", "TV", "TH", "VH", "TVH")


def three_d_noise(cube: NDArray[np.floating] | NDArray[np.integer]) -> dict[str, float]:
    """Standard deviations of the seven components, in the units of the cube.

    Parameters
    ----------
    cube : ndarray
        Frames of an even scene [(time, rows, columns)], two or more of each.

    Returns
    -------
    dict
        By the names of :data:`COMPONENTS`; 0 where a component is below what the others leave in its mean.
    """
    u = np.asarray(cube, np.float64)
    if u.ndim != 3 or min(u.shape) < 2:
        raise DataError(f"a cube of shape {u.shape}; 3-D noise needs two or more frames, rows and columns")
    nt, nv, nh = u.shape
    u = u - u.mean()
    raw: dict[str, FloatArray] = {}
    rest = u
    t, v, h = (rest.mean(axis=axes, keepdims=True) for axes in ((1, 2), (0, 2), (0, 1)))
    tv, th, vh = (rest.mean(axis=axis, keepdims=True) for axis in (2, 1, 0))
    raw["T"], raw["V"], raw["H"] = t, v, h
    raw["TV"], raw["TH"], raw["VH"] = tv - t - v, th - t - h, vh - v - h
    raw["TVH"] = u - tv - th - vh + t + v + h
    degrees = {
        "T": nt - 1, "V": nv - 1, "H": nh - 1, "TV": (nt - 1) * (nv - 1), "TH": (nt - 1) * (nh - 1), "VH": (nv - 1) * (nh - 1),
        "TVH": (nt - 1) * (nv - 1) * (nh - 1),
    }  # fmt: skip
    # Mean squares over degrees of freedom, each in the scale of single samples of its component.
    mean_square = {name: float(np.sum(part**2)) / degrees[name] for name, part in raw.items()}
    out = {"TVH": mean_square["TVH"]}
    out["TV"] = mean_square["TV"] - out["TVH"] / nh
    out["TH"] = mean_square["TH"] - out["TVH"] / nv
    out["VH"] = mean_square["VH"] - out["TVH"] / nt
    out["T"] = mean_square["T"] - out["TV"] / nv - out["TH"] / nh - out["TVH"] / (nv * nh)
    out["V"] = mean_square["V"] - out["TV"] / nt - out["VH"] / nh - out["TVH"] / (nt * nh)
    out["H"] = mean_square["H"] - out["TH"] / nt - out["VH"] / nv - out["TVH"] / (nt * nv)
    return {name: float(np.sqrt(max(out[name], 0.0))) for name in COMPONENTS}
