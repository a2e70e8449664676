"""Slope variance of a scenario's sea by bands of the wavenumber: waves that are geometry, facets, and the spectrum."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.scenario.model import Scenario
from seaglint.scenario.records.sea_tables import SpectrumSlopes
from seaglint.sea.slopes.slope_statistics import SlopeStatistics
from seaglint.sea.spectra.directional import DirectionalSpectrum
from seaglint.studies.build import scenario_physics
from seaglint.studies.build.waves_and_slopes import drawn_waves, levels, slopes, spectrum

if TYPE_CHECKING:
    import xarray as xr

Pair = tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class SlopeBand:
    """Slope variances of one band, along and across the wind [1]."""

    k_min_rad_m: float  #: Lowest wavenumber [rad m⁻¹].
    k_max_rad_m: float  #: Highest wavenumber [rad m⁻¹].
    drawn_up: float  #: Waves that are geometry, along the wind: variance of the ensemble.
    drawn_cross: float  #: Waves that are geometry, across the wind.
    #: Facets, along the wind: the slope law less the drawn waves. Below the cut it is the error of the lattice's sums, of either sign.
    facets_up: float
    facets_cross: float  #: Facets, across the wind.
    spectrum_up: float  #: All waves of ``sea.spectrum``, along the wind.
    spectrum_cross: float  #: All waves of ``sea.spectrum``, across the wind.


@dataclass(frozen=True, kw_only=True)
class SlopeBands:
    """Slope variances of a sea by band, and of the whole sea."""

    bands: tuple[SlopeBand, ...]  #: Ascending, side by side.
    whole: SlopeBand  #: All waves; the highest wavenumber is the spectrum's, or the slope law's.
    slopes: str  #: Kind of the slope law, or the levels of a sea drawn between the campaigns.
    spectrum: str  #: Kind of the spectrum.
    cut_wavenumber_rad_m: float  #: Wavenumber up to which waves are geometry [rad m⁻¹]; 0 without such waves.

    def as_dict(self) -> dict[str, Any]:
        """Return plain values."""
        return asdict(self)

    def lines(self) -> list[str]:
        """Return the bands as lines of a table."""
        names = ("drawn", "facets", "spectrum")
        head = f"{'rad/m':>14}" + "".join(f"{name + ' ' + way:>15}" for name in names for way in ("up", "cross"))
        rows = []
        for band in (*self.bands, self.whole):
            label = "whole sea" if band is self.whole else f"{band.k_min_rad_m:g}-{band.k_max_rad_m:g}"
            values = [getattr(band, f"{name}_{way}") for name in names for way in ("up", "cross")]
            rows.append(f"{label:>14}" + "".join(f"{round(value, 6) + 0.0:15.6f}" for value in values))
        cut = f"geometry up to {self.cut_wavenumber_rad_m:.4g} rad/m" if self.cut_wavenumber_rad_m else "no waves are geometry"
        return [f"slopes: {self.slopes}; spectrum: {self.spectrum}; {cut}", head, *rows]

    def dataset(self) -> xr.Dataset:
        """Return the bands as a dataset over ``band``."""
        import xarray as xr

        columns = {name: [asdict(band)[name] for band in self.bands] for name in asdict(self.whole)}
        edges = {name: ("band", columns.pop(name), {"units": "rad m-1"}) for name in ("k_min_rad_m", "k_max_rad_m")}
        whole = {f"whole_{name}": value for name, value in asdict(self.whole).items() if name in columns}
        attributes = {"slopes": self.slopes, "spectrum": self.spectrum, "cut_wavenumber_rad_m": self.cut_wavenumber_rad_m, **whole}
        return xr.Dataset({name: ("band", values, {"units": "1"}) for name, values in columns.items()}, edges, attributes)


def _edges(bands: Sequence[float] | str) -> FloatArray:
    """Return the edges of bands [rad/m], of numbers or of a text such as ``5,20,100``; refuse those that are no bands."""
    try:
        edges = np.asarray(bands.split(",") if isinstance(bands, str) else bands, dtype=np.float64)
    except (TypeError, ValueError):
        edges = np.empty(0)
    if edges.ndim == 1 and edges.size >= 2 and np.all(np.isfinite(edges)) and edges[0] >= 0.0 and np.all(np.diff(edges) > 0.0):
        return edges
    given = ",".join(f"{edge:g}" for edge in edges) if edges.ndim == 1 and edges.size else bands
    raise DomainError(f"bands = {given} are no bands of wavenumbers; give two or more ascending edges of 0 rad/m or above, as 5,20,100")


def slope_bands(scenario: Scenario, bands: Sequence[float] | str) -> SlopeBands:
    """Return the slope variances of a scenario's sea in bands between ascending wavenumbers [rad/m].

    Raises
    ------
    DomainError
        Edges that are no numbers, fewer than two, negative, not finite or not ascending.
    """
    edges = _edges(bands)
    statistics, sea = slopes(scenario), spectrum(scenario)
    prepared = scenario_physics.sea(scenario, statistics)
    drawn_sea = scenario.sea.uncertainty != "none"
    # Slopes of a drawn sea are those of its waves, whatever sea.slopes is.
    source = drawn_waves(scenario) if drawn_sea else sea if isinstance(scenario.sea.slopes, SpectrumSlopes) else None
    # The residual slopes of light winds are in no spectrum.
    exact = statistics.directed is None and source is not None

    def variances(low: float, high: float) -> tuple[Pair, Pair, Pair]:
        """Return the variances of drawn waves, of the slope law and of the spectrum."""
        waves = (0.0, 0.0) if sea is None else sea.mss(high, low)
        drawn = (0.0, 0.0) if prepared.waves is None else prepared.waves.band_mss(low, high)
        law = source.mss(high, low) if exact and source is not None else _law(statistics, low, high)
        return drawn, law, waves

    top = max(float(edges[-1]), _last(statistics, sea))
    rows = [_band(low, high, *variances(low, high)) for low, high in pairwise(edges.tolist())]
    whole = (0.0, 0.0) if prepared.waves is None else prepared.waves.resolved_mss()
    total = _band(0.0, top, whole, (statistics.mss_up, statistics.mss_cross), (0.0, 0.0) if sea is None else sea.mss())
    cut = 0.0 if prepared.waves is None else prepared.waves.tiles[-1].k_max
    kind: str = scenario.sea.slopes.kind
    if drawn_sea:
        kind = f"drawn between the campaigns, levels {', '.join(f'{level:.2f}' for level in levels(scenario))}"
    return SlopeBands(bands=tuple(rows), whole=total, slopes=kind, spectrum=scenario.sea.spectrum.kind, cut_wavenumber_rad_m=cut)


def _last(statistics: SlopeStatistics, sea: DirectionalSpectrum | None) -> float:
    """Return the wavenumber of the shortest waves of the law or the spectrum [rad/m]."""
    return float(statistics.growth()[-1, 0]) if sea is None else max(float(statistics.growth()[-1, 0]), sea.wavenumber_range[1])


def _law(statistics: SlopeStatistics, low: float, high: float) -> Pair:
    """Return the slope variance of the law in a band, along and across the wind [1]: linear in log k between the nodes of its growth."""
    if statistics.is_flat:
        return 0.0, 0.0
    growth: FloatArray = statistics.growth()
    x = np.log(growth[:, 0])

    def below(k: float, column: int) -> float:
        return float(np.interp(np.log(k), x, growth[:, column], left=0.0)) if k > 0.0 else 0.0

    return below(high, 1) - below(low, 1), below(high, 2) - below(low, 2)


def _band(low: float, high: float, drawn: Pair, law: Pair, waves: Pair) -> SlopeBand:
    return SlopeBand(
        k_min_rad_m=low,
        k_max_rad_m=high,
        drawn_up=drawn[0],
        drawn_cross=drawn[1],
        facets_up=law[0] - drawn[0],
        facets_cross=law[1] - drawn[1],
        spectrum_up=waves[0],
        spectrum_cross=waves[1],
    )
