r"""Noise of a detector (temporal noise, fixed pattern, defective pixels), and analysis of frames into three-dimensional noise.

Every number is a function of (seed, frame, pixel): a frame has equal noise alone and in its sequence, for any number of threads. The
settings include all seven components of three-dimensional noise (NVESD): frame (T), row (V), column (H), row in time (TV), column in time
(TH), pixel (VH: gain and offset) and pixel in time (TVH: shot, read, 1/f).

1/f noise is a sum of octaves: the values of the k-th are constant for :math:`2^k` frames (Voss's method), so that any frame can be computed
alone and the density falls like 1/f over the octaves.

Two-point correction makes the response of all pixels equal at two signals, ``x1`` and ``x2``. It removes the spreads of gain and offset; a
spread ``c`` of the curvature leaves :math:`c\,(x - x_1)(x - x_2)/x_{full}`. The drift after the correction is added.

:func:`three_d_noise` splits a cube of frames of an even scene into the seven components by averaging operators over time, rows and columns
(NVESD). With :math:`D_t` the mean over time and so on,

.. math:: \text{TVH} = (1 - D_t)(1 - D_v)(1 - D_h)\,U, \quad \text{VH} = D_t (1 - D_v)(1 - D_h)\,U, \;\ldots

the parts are orthogonal and their mean squares add to the variance of the cube. The mean over n samples of a changing component contains
one n-th of its variance: the function subtracts it, so that it recovers the components of synthetic noise.

References
----------
J. D'Agostino and C. Webb, 3-D analysis framework and measurement methodology for imaging system noise, Proc. SPIE 1488 (1991).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.base.random import stream

OCTAVES: Final = 10  #: Number of octaves of 1/f noise: down to a thousandth of the frame rate.

BLINK_SHARE: Final = 0.5  #: Share of the time that a blinking pixel is in its upper state.


@dataclass(frozen=True)
class DetectorNoise:
    """Noise settings of a detector, in units of the signal (electrons; nanowatts of a thermal detector)."""

    temporal: bool = True  #: True for noise that changes in time.
    fixed_pattern: bool = True  #: True for noise that is constant in time, defective pixels included.
    one_over_f: float = 0.0  #: Rms of the 1/f noise of a pixel over its octaves.
    frame: float = 0.0  #: Rms of the common noise of all pixels of a frame (T).
    row: float = 0.0  #: Rms of the fixed noise of rows (V).
    column: float = 0.0  #: Rms of the fixed noise of columns (H).
    row_temporal: float = 0.0  #: Rms of the noise of rows that changes from frame to frame (TV).
    column_temporal: float = 0.0  #: Rms of the noise of columns that changes from frame to frame (TH).
    gain_spread: float = 0.0  #: Rms relative spread of the gain of pixels [1].
    offset_spread: float = 0.0  #: Rms spread of the offset of pixels.
    curvature_spread: float = 0.0  #: Rms spread of the relative deviation from a straight line at full scale [1].
    corrected_at: tuple[float, float] | None = None  #: Signals of a two-point correction; None without correction.
    drift_per_hour: float = 0.0  #: Rms of the change of offsets in an hour.
    dead_share: float = 0.0  #: Share of pixels without response [1].
    hot_share: float = 0.0  #: Share of pixels with a high dark signal [1].
    blinking_share: float = 0.0  #: Share of pixels that jump between two levels [1].
    hot_signal: float = 0.0  #: Dark signal of hot pixels.
    blinking_signal: float = 0.0  #: Height of the jumps of blinking pixels.
    blinking_time: float = 1.0  #: Mean time between jumps [s].


@dataclass(frozen=True, eq=False)
class Pattern:
    """Fixed pattern of one detector, a function of its seed and size; make it with ``of``."""

    noise: DetectorNoise
    full_scale: float
    gain: FloatArray | None
    offset: FloatArray | None
    curvature: FloatArray | None
    drift: FloatArray | None
    dead: NDArray[np.bool_] | None
    hot: NDArray[np.bool_] | None
    blinking: NDArray[np.int64] | None  #: Flat indices of the blinking pixels.
    cells: tuple[int, int]  #: Rows and columns of the detector: equal to the picture's, or one column for a scanner.
    seed: int = field(default=0)

    @classmethod
    def of(cls, noise: DetectorNoise, seed: int, shape: tuple[int, int], full_scale: float, *, scanning: bool = False) -> Pattern:
        """Draw the pattern of a detector with pictures of ``shape`` (rows, columns); a scanner has one pixel for each row."""
        cells = (shape[0], 1) if scanning else shape
        if not noise.fixed_pattern:
            return cls(noise, full_scale, None, None, None, None, None, None, None, cells, seed)

        def spread(rms: float, purpose: str) -> FloatArray | None:
            return rms * stream(seed, purpose).standard_normal(cells) if rms > 0.0 else None

        corrected = noise.corrected_at is not None
        # two-point correction removes differences of gain and offset, but not lines added after it
        offset = None if corrected else spread(noise.offset_spread, "sensor offset")
        lines = np.zeros(shape)
        if noise.row > 0.0:
            lines += noise.row * stream(seed, "sensor rows").standard_normal((shape[0], 1))
        if noise.column > 0.0:
            lines += noise.column * stream(seed, "sensor columns").standard_normal((1, shape[1]))
        if noise.row > 0.0 or noise.column > 0.0:
            offset = lines if offset is None else offset + lines
        place = stream(seed, "sensor defects").random(cells)
        dead, hot = noise.dead_share, noise.dead_share + noise.hot_share
        blinks = np.flatnonzero((place >= hot) & (place < hot + noise.blinking_share))
        return cls(
            noise,
            full_scale,
            None if corrected else spread(noise.gain_spread, "sensor gain"),
            offset,
            spread(noise.curvature_spread, "sensor curvature"),
            spread(noise.drift_per_hour / 3600.0, "sensor drift"),
            place < dead if dead > 0.0 else None,
            (place >= dead) & (place < hot) if noise.hot_share > 0.0 else None,
            blinks if blinks.size else None,
            cells,
            seed,
        )

    def response(self, light: FloatArray) -> FloatArray:
        """Return the mean signal of every pixel from the signal of an ideal one: gain, curvature, dead pixels."""
        if self.gain is not None:
            light = light * (1.0 + self.gain)
        if self.curvature is not None:
            first, second = self.noise.corrected_at or (0.0, 0.0)
            light = light + self.curvature * (light - first) * (light - second) / self.full_scale
        if self.dead is not None:
            light = np.where(self.dead, 0.0, light)
        return light

    def dark(self, shape: tuple[int, int]) -> FloatArray | float:
        """Return the additional dark signal of hot pixels."""
        if self.hot is None:
            return 0.0
        return np.broadcast_to(np.where(self.hot, self.noise.hot_signal, 0.0), shape)

    def added(self, time: float, signal: FloatArray) -> FloatArray:
        """Return the signal with offsets, drift and blinking, which are added after the exposure."""
        if self.offset is not None:
            signal = signal + self.offset
        if self.drift is not None:
            signal = signal + self.drift * time
        if self.blinking is not None:
            jumps = np.zeros(self.cells)
            jumps.reshape(-1)[self.blinking] = self.noise.blinking_signal * self._states(time)
            signal = signal + jumps
        return signal

    def _states(self, time: float) -> FloatArray:
        """Return the state of each blinking pixel, 1 for the upper level: drawn anew in spans that begin at a separate phase."""
        assert self.blinking is not None
        count = self.blinking.size
        # half of the new states are equal to the old ones: spans are half of the mean time between jumps
        span = self.noise.blinking_time * BLINK_SHARE
        phase = stream(self.seed, "sensor blinking phase").random(count)
        number = np.floor(time / span + phase).astype(np.int64)
        up = np.zeros(count)
        for value in np.unique(number):
            draws = stream(self.seed, "sensor blinking", int(value) & 0xFFFFFFFF).random(count)
            members = number == value
            up[members] = draws[members] < BLINK_SHARE
        return up


def temporal_noise(noise: DetectorNoise, seed: int, frame: int, shape: tuple[int, int], rms: float) -> FloatArray | None:
    """Return the temporal noise of a frame: a reading's ``rms`` and components of :class:`DetectorNoise`; None without noise."""
    if not noise.temporal:
        return None
    out: FloatArray | None = None

    def add(part: FloatArray) -> None:
        nonlocal out
        out = part if out is None else out + part

    if rms > 0.0:
        add(rms * stream(seed, "sensor read", frame).standard_normal(shape))
    if noise.one_over_f > 0.0:
        add(noise.one_over_f * pink(seed, frame, shape))
    if noise.frame > 0.0:
        add(np.full(shape, noise.frame * stream(seed, "sensor frame", frame).standard_normal()))
    if noise.row_temporal > 0.0:
        lines = noise.row_temporal * stream(seed, "sensor rows in time", frame).standard_normal((shape[0], 1))
        add(np.broadcast_to(lines, shape))
    if noise.column_temporal > 0.0:
        lines = noise.column_temporal * stream(seed, "sensor columns in time", frame).standard_normal((1, shape[1]))
        add(np.broadcast_to(lines, shape))
    return out


def pink(seed: int, frame: int, shape: tuple[int, int]) -> FloatArray:
    """Return 1/f noise of unit variance of all pixels in one frame (rows, columns)."""
    total = np.zeros(shape)
    for octave in range(OCTAVES):
        # offsets from the digits of the golden ratio: spans of different octaves do not all begin together
        number = (frame + (0x9E37 >> octave)) >> octave
        total += stream(seed, "sensor 1/f", octave, number).standard_normal(shape)
    return np.asarray(total / np.sqrt(OCTAVES))


#: Components: time; rows (one level each); columns; rows in time; columns in time; pixels; pixels in time.
COMPONENTS: Final = ("T", "V", "H", "TV", "TH", "VH", "TVH")


def three_d_noise(cube: NDArray[np.floating] | NDArray[np.integer]) -> dict[str, float]:
    """Return the standard deviations of the seven components, in the units of the cube.

    Parameters
    ----------
    cube : ndarray
        Frames of an even scene (time, rows, columns), two or more of each.

    Returns
    -------
    dict
        Standard deviations by the names of ``COMPONENTS``; 0 for a component below the share of the others in its mean.
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
    # mean squares over degrees of freedom, each in the scale of single samples of its component
    mean_square = {name: float(np.sum(part**2)) / degrees[name] for name, part in raw.items()}
    out = {"TVH": mean_square["TVH"]}
    out["TV"] = mean_square["TV"] - out["TVH"] / nh
    out["TH"] = mean_square["TH"] - out["TVH"] / nv
    out["VH"] = mean_square["VH"] - out["TVH"] / nt
    out["T"] = mean_square["T"] - out["TV"] / nv - out["TH"] / nh - out["TVH"] / (nv * nh)
    out["V"] = mean_square["V"] - out["TV"] / nt - out["VH"] / nh - out["TVH"] / (nt * nh)
    out["H"] = mean_square["H"] - out["TH"] / nt - out["VH"] / nv - out["TVH"] / (nt * nv)
    return {name: float(np.sqrt(max(out[name], 0.0))) for name in COMPONENTS}
