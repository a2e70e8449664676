"""Scattered sunlight in the files of :mod:`seaglint.files.air.air_file`: reader, checks and writer.

NetCDF: variables ``path_scattered`` (range_m), ``sky_scattered`` (sky_zenith_deg) and ``sensor_sky_scattered`` (sensor_sky_zenith_deg),
each also on ``azimuth_from_sun_deg`` and ``wavenumber_cm``, and the attribute ``solar_zenith_deg``. CSV: kinds ``path-scattered`` and
``sky-scattered`` with the columns ``azimuth_from_sun_deg`` and ``solar_zenith_deg`` besides those of ``path`` and ``sky``.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from seaglint.air.sampled.sampled_air import HEIGHT_SLACK
from seaglint.air.scattering.scattered_samples import ScatteredSamples, ScatteredSky
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.files.tables.table_text import TableRow, TextTable

if TYPE_CHECKING:
    import xarray as xr

AZIMUTH: Final = "azimuth_from_sun_deg"

SUN: Final = "solar_zenith_deg"

KINDS: Final = {"path-scattered": "path", "sky-scattered": "sky"}  #: Kinds of lines of a CSV file, and the kind whose nodes they share.

COLUMNS: Final = (AZIMUTH, SUN)

#: Variables of a NetCDF file, with their kind and coordinate.
VARIABLES: Final = {
    "path_scattered": ("path", "range_m"),
    "sky_scattered": ("sky", "sky_zenith_deg"),
    "sensor_sky_scattered": ("sensor_sky", "sensor_sky_zenith_deg"),
}


@dataclass(frozen=True, eq=False)
class Block:
    """Scattered sunlight of one kind seen from one height: nodes, azimuths [deg], wavenumbers, radiance (nodes, azimuths, n)."""

    kind: str
    height: float
    node: FloatArray
    azimuth: FloatArray
    wavenumber_cm: FloatArray
    radiance: FloatArray


def blocks_of_dataset(path: Path, dataset: Any, height: float) -> tuple[float | None, list[Block]]:
    """Return the zenith angle of the Sun [deg] and the scattered sunlight of a file.

    Raises
    ------
    DataError
        Naming the variable that cannot be used.
    """
    present = [name for name in VARIABLES if name in dataset]
    if not present:
        return None, []
    solar = dataset.attrs.get(SUN, dataset[SUN].to_numpy() if SUN in dataset else None)
    try:
        zenith = float(np.asarray(solar, dtype=np.float64).item())
    except (TypeError, ValueError):
        zenith = np.nan
    if not 0.0 <= zenith <= 90.0:
        raise DataError(f"{path}: {present[0]} needs the attribute {SUN}, the zenith angle of its Sun within 0 to 90; add it")
    azimuth = _azimuths(path, dataset)
    out = []
    for name in present:
        kind, dimension = VARIABLES[name]
        required = (dimension, AZIMUTH, "wavenumber_cm")
        if set(dataset[name].dims) != set(required) or dimension not in dataset.coords:
            raise DataError(f"{path}: needs the variable {name} on the dimensions {', '.join(required)}")
        values = np.asarray(dataset[name].transpose(*required), dtype=np.float64)
        if not np.all((values >= 0.0) & np.isfinite(values)):
            raise DataError(f"{path}: {name} has values outside the range allowed: 0 or more")
        nodes, nu = (np.asarray(dataset[key], dtype=np.float64) for key in (dimension, "wavenumber_cm"))
        order = np.ix_(np.argsort(nodes), np.argsort(azimuth), np.argsort(nu))
        seen_from = 0.0 if kind == "sky" else height
        out.append(Block(kind.removeprefix("sensor_"), seen_from, np.sort(nodes), np.sort(azimuth), np.sort(nu), values[order]))
    return zenith, out


def _azimuths(path: Path, dataset: Any) -> FloatArray:
    if AZIMUTH not in dataset.coords or dataset[AZIMUTH].dims != (AZIMUTH,):
        raise DataError(f"{path}: scattered sunlight needs the coordinate {AZIMUTH}; add it")
    values = np.asarray(dataset[AZIMUTH], dtype=np.float64)
    _require_azimuths(str(path), values)
    return values


def _require_azimuths(where: str, values: FloatArray) -> None:
    if values.size < 2 or np.unique(values).size < values.size or not np.all((values >= 0.0) & (values <= 180.0)):
        raise DataError(f"{where}: {AZIMUTH} needs at least 2 different values within 0 to 180")
    if values.min() > 0.0 or values.max() < 180.0:
        raise DataError(f"{where}: {AZIMUTH} goes from {values.min():g} to {values.max():g}; give it from 0 (towards the Sun) to 180")


@dataclass
class ScatteredRows:
    """Lines of a CSV file, gathered by kind, height and place."""

    table: TextTable
    solar: float | None = None
    cells: dict[tuple[str, float], dict[tuple[float, float, float], tuple[int, float]]] = field(default_factory=dict)

    def add(self, row: TableRow, kind: str, height: float, node: float, nu: float, radiance: float) -> None:
        """Add a line.

        Raises
        ------
        DataError
            Another Sun than the lines before, or a place given twice.
        """
        self.table.require(*COLUMNS)
        azimuth, solar = self.table.number(row, AZIMUTH, 0.0, 180.0), self.table.number(row, SUN, 0.0, 90.0)
        if self.solar is not None and solar != self.solar:
            raise self.table.error(row.line, f"{SUN} = {solar:g}, {self.solar:g} before; leave the lines of one Sun")
        self.solar = solar
        block = self.cells.setdefault((KINDS[kind], height), {})
        if (node, azimuth, nu) in block:
            raise self.table.error(
                row.line, f"gives {kind} at the same place, azimuth and wavenumber as line {block[node, azimuth, nu][0]}; remove one"
            )
        block[node, azimuth, nu] = (row.line, radiance)

    def blocks(self) -> list[Block]:
        """Return rectangles of nodes, azimuths and wavenumbers.

        Raises
        ------
        DataError
            Holes, or azimuths that do not go from 0 to 180 deg.
        """
        out = []
        for (kind, height), block in self.cells.items():
            axes = [np.unique([at[i] for at in block]) for i in range(3)]
            first = next(iter(block.values()))[0]
            _require_azimuths(f"{self.table.path}: line {first}", axes[1])
            if len(block) != axes[0].size * axes[1].size * axes[2].size:
                raise self.table.error(
                    first,
                    f"{kind}-scattered from {height:g} m has {len(block)} of {axes[0].size} x {axes[1].size} x {axes[2].size} samples "
                    "(places, azimuths, wavenumbers); complete them",
                )
            values = np.array([[[block[x, a, v][1] for v in axes[2]] for a in axes[1]] for x in axes[0]])
            out.append(Block(kind, height, axes[0], axes[1], axes[2], values))
        return out


def assembled(
    path: Path, solar_deg: float | None, blocks: list[Block], height: float, nu: FloatArray, nodes: dict[tuple[str, float], FloatArray]
) -> ScatteredSamples | None:
    """Return scattered sunlight for a sensor height, on the nodes and the spectral grid of the thermal radiance.

    Raises
    ------
    DataError
        Nodes, wavenumbers or azimuths differ from those of the rest.
    """
    mine = [b for b in blocks if b.height <= HEIGHT_SLACK or abs(b.height - height) <= HEIGHT_SLACK]
    if solar_deg is None or not mine:
        return None
    for b in mine:
        what = f"{path}: scattered {b.kind} from {b.height:g} m"
        if b.wavenumber_cm.size != nu.size or not np.allclose(b.wavenumber_cm, nu, rtol=1e-9, atol=0.0):
            raise DataError(f"{what} has another spectral grid than the paths to {height:g} m; give all on one")
        thermal = next((x for (kind, h), x in nodes.items() if kind == b.kind and abs(h - b.height) <= HEIGHT_SLACK), None)
        if thermal is None or thermal.size != b.node.size or not np.allclose(thermal, b.node, rtol=1e-9, atol=1e-9):
            raise DataError(
                f"{what} is at other {'ranges' if b.kind == 'path' else 'zenith angles'} than the thermal one; give both at all"
            )
        if b.azimuth.size != mine[0].azimuth.size or not np.array_equal(b.azimuth, mine[0].azimuth):
            raise DataError(f"{what} is at other azimuths than scattered {mine[0].kind}; give all at the same ones")
    paths = [b for b in mine if b.kind == "path"]
    return ScatteredSamples(
        solar_zenith=float(np.radians(solar_deg)),
        azimuth=np.radians(mine[0].azimuth),
        range_m=paths[0].node if paths else np.empty(0),
        path=paths[0].radiance if paths else None,
        skies=tuple(ScatteredSky(b.height, np.radians(b.node), b.radiance) for b in mine if b.kind == "sky"),
    )


def csv_lines(dataset: xr.Dataset, height: str) -> Iterator[str]:
    """Yield lines of a CSV file in the columns of :data:`seaglint.files.air.air_file.COLUMNS` and :data:`COLUMNS`."""
    for name, (kind, dimension) in VARIABLES.items():
        if name not in dataset:
            continue
        at, solar = ("0" if kind == "sky" else height), f"{float(dataset.attrs[SUN])!r}"
        values = dataset[name].transpose(dimension, AZIMUTH, "wavenumber_cm").to_numpy()
        nu = [repr(v) for v in dataset["wavenumber_cm"].to_numpy().tolist()]
        for i, node in enumerate(dataset[dimension].to_numpy().tolist()):
            place = f"path-scattered,{at},{node!r}," if kind == "path" else f"sky-scattered,{at},,{node!r}"
            for j, azimuth in enumerate(dataset[AZIMUTH].to_numpy().tolist()):
                yield from (f"{place},{v},,{x:.9g},,{azimuth!r},{solar}" for v, x in zip(nu, values[i, j].tolist(), strict=True))
