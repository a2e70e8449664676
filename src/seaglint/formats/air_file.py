"""Atmosphere from a file of transmittance, radiance and, if it has it, scattered sunlight: plain CSV, or NetCDF.

CSV, one spectral sample of one direction a line::

    kind,height_m,range_m,zenith_deg,wavenumber_cm,transmittance,radiance,irradiance
    path,30,1000,,2000,0.71,2.1e-4,
    sky,0,,60,2000,,8.7e-4,
    sun,0,,60,2000,,,3.1e-3

``path``: transmittance and thermal path radiance from the sea at the arc ``range_m`` from the sensor's foot to the sensor at ``height_m``;
``sky``: thermal radiance at ``zenith_deg`` seen from ``height_m`` (0: from the sea, needed; the sensor's height: for directions above
the sea horizon, down to it, which is below 90 deg); ``sun``: irradiance at the sea, normal to the beam, at 1 au. With a column
``wavenumber_cm``, radiance is in W m-2 sr-1 per cm-1 and irradiance in W m-2 per cm-1; with ``wavelength_um`` instead, both are per um.
Columns that a kind does not use may be empty, or missing where no kind does.

NetCDF, the same quantities on the dimensions ``wavenumber_cm``, ``range_m``, ``sun_zenith_deg``, ``sky_zenith_deg`` (coordinates of these
names) and, where given, ``sensor_sky_zenith_deg``: variables ``path_transmittance``, ``path_radiance`` (range_m, wavenumber_cm),
``sun_irradiance`` (sun_zenith_deg, wavenumber_cm), ``sky_radiance`` (sky_zenith_deg, wavenumber_cm), ``sensor_sky_radiance``
(sensor_sky_zenith_deg, wavenumber_cm), and the attribute ``sensor_height_m``. With the attribute ``paths_reach_horizon = 1`` the last path
touches the sea horizon, so that longer ones (to wave crests) continue along the tangent.

Sunlight scattered by the air is optional. CSV: kinds ``path-scattered`` and ``sky-scattered`` with the columns ``azimuth_from_sun_deg``
and ``solar_zenith_deg`` in addition to the columns of ``path`` and ``sky``. NetCDF: variables ``path_scattered`` (range_m),
``sky_scattered`` (sky_zenith_deg) and ``sensor_sky_scattered`` (sensor_sky_zenith_deg), each also on ``azimuth_from_sun_deg`` and
``wavenumber_cm``, and the attribute ``solar_zenith_deg``.
"""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from seaglint.air.protocol import ScatteredSamples, ScatteredSky
from seaglint.air.sampled_air import HEIGHT_SLACK, PathSamples, SampledAtmosphere, SunSamples
from seaglint.air.sun_and_sky import SkySamples
from seaglint.base.conventions import FloatArray, horizon_depression
from seaglint.base.errors import DataError, SeaglintError
from seaglint.formats.tables.table_text import TextTable, read_table
from seaglint.store.netcdf import open_netcdf, write_netcdf
from seaglint.store.outputs import reason_of, refuse_existing, write_text

if TYPE_CHECKING:
    import xarray as xr


AZIMUTH: Final = "azimuth_from_sun_deg"

SUN: Final = "solar_zenith_deg"

MOST_SUN_DEG: Final = 96.0  #: Largest zenith angle of a Sun whose light the air scatters [deg].

KINDS: Final = {"path-scattered": "path", "sky-scattered": "sky"}  #: Kinds of lines of a CSV file, and the kind whose nodes they share.

SCATTERED_COLUMNS: Final = (AZIMUTH, SUN)

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
    if not 0.0 <= zenith <= MOST_SUN_DEG:
        raise DataError(f"{path}: {present[0]} needs the attribute {SUN}, the zenith angle of its Sun within 0 to {MOST_SUN_DEG:g}; add it")
    azimuth = _azimuths(path, dataset)
    out = []
    for name in present:
        kind, dimension = VARIABLES[name]
        values = _field(path, dataset, name, (dimension, AZIMUTH, "wavenumber_cm"))
        nodes, nu = (np.asarray(dataset[key], dtype=np.float64) for key in (dimension, "wavenumber_cm"))
        # Files may have their axes in any order; interpolation needs them ascending.
        order = np.ix_(np.argsort(nodes), np.argsort(azimuth), np.argsort(nu))
        seen_from = 0.0 if kind == "sky" else height
        out.append(Block(kind.removeprefix("sensor_"), seen_from, np.sort(nodes), np.sort(azimuth), np.sort(nu), values[order]))
    return zenith, out


def _field(path: Path, dataset: Any, name: str, dimensions: tuple[str, ...], most: float = np.inf) -> FloatArray:
    """Return a variable in the order of these dimensions; refuse other dimensions, and values below 0 or above ``most``."""
    if name not in dataset or set(dataset[name].dims) != set(dimensions) or any(axis not in dataset.coords for axis in dimensions):
        raise DataError(f"{path}: needs the variable {name} on the dimensions {', '.join(dimensions)}")
    values = np.asarray(dataset[name].transpose(*dimensions), dtype=np.float64)
    if not np.all((values >= 0.0) & (values <= most) & np.isfinite(values)):
        allowed = f"0 to {most:g}" if np.isfinite(most) else "0 or more"
        raise DataError(f"{path}: {name} has values outside the range allowed: {allowed}")
    return values


def _azimuths(path: Path, dataset: Any) -> FloatArray:
    if AZIMUTH not in dataset.coords or dataset[AZIMUTH].dims != (AZIMUTH,):
        raise DataError(f"{path}: scattered sunlight needs the coordinate {AZIMUTH}; add it")
    values = np.asarray(dataset[AZIMUTH], dtype=np.float64)
    # Radiance is interpolated in azimuth: towards the Sun and away from it nothing could be extrapolated.
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

    def add(self, row: int, kind: str, height: float, node: float, nu: float, radiance: float) -> None:
        """Add a line.

        Raises
        ------
        DataError
            Another Sun than the lines before, or a place given twice.
        """
        self.table.require_columns(*SCATTERED_COLUMNS)
        azimuth, solar, line = (
            self.table.number(row, AZIMUTH, 0.0, 180.0),
            self.table.number(row, SUN, 0.0, MOST_SUN_DEG),
            self.table.lines[row],
        )
        if self.solar is not None and solar != self.solar:
            raise self.table.error(line, f"{SUN} = {solar:g}, {self.solar:g} before; leave the lines of one Sun")
        self.solar = solar
        block = self.cells.setdefault((KINDS[kind], height), {})
        if (node, azimuth, nu) in block:
            first = block[node, azimuth, nu][0]
            raise self.table.error(line, f"gives {kind} at the same place, azimuth and wavenumber as line {first}; remove one")
        block[node, azimuth, nu] = (line, radiance)

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
        Nodes, wavenumbers or azimuths differ between the parts of the file.
    """
    used = [b for b in blocks if b.height <= HEIGHT_SLACK or abs(b.height - height) <= HEIGHT_SLACK]
    if solar_deg is None or not used:
        return None
    for b in used:
        what = f"{path}: scattered {b.kind} from {b.height:g} m"
        if b.wavenumber_cm.size != nu.size or not np.allclose(b.wavenumber_cm, nu, rtol=1e-9, atol=0.0):
            raise DataError(f"{what} has another spectral grid than the paths to {height:g} m; give all on one")
        thermal = next((x for (kind, h), x in nodes.items() if kind == b.kind and abs(h - b.height) <= HEIGHT_SLACK), None)
        if thermal is None or thermal.size != b.node.size or not np.allclose(thermal, b.node, rtol=1e-9, atol=1e-9):
            nodes_of = "ranges" if b.kind == "path" else "zenith angles"
            raise DataError(f"{what} is at other {nodes_of} than the thermal one; give both at all")
        if b.azimuth.size != used[0].azimuth.size or not np.array_equal(b.azimuth, used[0].azimuth):
            raise DataError(f"{what} is at other azimuths than scattered {used[0].kind}; give all at the same ones")
    paths = [b for b in used if b.kind == "path"]
    return ScatteredSamples(
        solar_zenith=float(np.radians(solar_deg)),
        azimuth=np.radians(used[0].azimuth),
        range_m=paths[0].node if paths else np.empty(0),
        path=paths[0].radiance if paths else None,
        skies=tuple(ScatteredSky(b.height, np.radians(b.node), b.radiance) for b in used if b.kind == "sky"),
    )


def csv_lines(dataset: xr.Dataset, height: str) -> Iterator[str]:
    """Yield lines of a CSV file in the columns of ``seaglint.formats.air_file.COLUMNS`` and ``COLUMNS``."""
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


COLUMNS = ("kind", "height_m", "range_m", "zenith_deg", "wavenumber_cm", "transmittance", "radiance", "irradiance")

NETCDF_ENDINGS: Final = (".nc", ".nc4", ".netcdf", ".h5")

#: Columns that a line needs, by its kind.
NEEDS: dict[str, tuple[str, ...]] = {
    "path-scattered": ("height_m", "range_m", "radiance"),
    "sky-scattered": ("height_m", "zenith_deg", "radiance"),
    "path": ("height_m", "range_m", "transmittance", "radiance"),
    "sky": ("height_m", "zenith_deg", "radiance"),
    "sun": ("zenith_deg", "irradiance"),
}

#: Largest zenith angles of a file [deg]: the sky seen from a height reaches below the horizontal.
ANGLES = {"sky": 100.0, "sky-scattered": 100.0, "sun": 90.0}


@dataclass(frozen=True)
class _Spectra:
    """Spectra of one kind from one height, as read: nodes ascending, wavenumber ascending."""

    node: FloatArray
    wavenumber_cm: FloatArray
    values: dict[str, FloatArray]


@dataclass(frozen=True)
class _Content:
    """Content of a file."""

    blocks: Mapping[tuple[str, float], _Spectra]
    beyond: bool = False
    solar_zenith_deg: float | None = None
    scattered: tuple[Block, ...] = ()


def read_atmosphere(path: str | Path, sensor_height: float) -> SampledAtmosphere:
    """Read the atmosphere of a CSV or NetCDF (``.nc``) file for a sensor at ``sensor_height`` [m].

    Raises
    ------
    DataError
        Naming the file and the line, column or variable that cannot be used.
    """
    path = Path(path)
    return _assembled(path, _from_netcdf(path) if path.suffix.lower() in NETCDF_ENDINGS else _from_csv(path), sensor_height)


def require_kind(output: Path) -> None:
    """Refuse an ending of which no format is written."""
    if output.suffix.lower() not in (".csv", *NETCDF_ENDINGS):
        raise DataError(f"{output}: is neither .csv nor .nc; the ending says what is written")


def write_atmosphere(dataset: xr.Dataset, output: str | Path, *, overwrite: bool = False) -> Path:
    """Write an atmosphere laid out as the NetCDF form; as CSV where the name ends so.

    Raises
    ------
    DataError
        The output exists, or its ending is not known.
    StorageError
        No room or no rights; nothing is left behind.
    """
    output = refuse_existing(output, overwrite=overwrite)
    require_kind(output)
    if output.suffix.lower() in NETCDF_ENDINGS:
        return write_netcdf(dataset, output, overwrite=overwrite)
    lit = [name for name in VARIABLES if name in dataset]
    columns = (*COLUMNS, *SCATTERED_COLUMNS) if lit else COLUMNS
    lines = ["# radiance in W m-2 sr-1 per cm-1, irradiance in W m-2 per cm-1, Sun at 1 au", ",".join(columns)]
    height = f"{float(dataset.attrs['sensor_height_m'])!r}"
    nu = [repr(value) for value in dataset["wavenumber_cm"].to_numpy().tolist()]

    def add(kind: str, at: str, node: str, *variables: str, cells: str) -> None:
        fields = [dataset[name].transpose(node, "wavenumber_cm").to_numpy() for name in variables]
        for i, where in enumerate(dataset[node].to_numpy().tolist()):
            start = f"{kind},{at},{where!r},," if kind == "path" else f"{kind},{at},,{where!r},"
            values = zip(*(field[i].tolist() for field in fields), strict=True)
            end = ",," if lit else ""
            lines.extend(start + v + cells.format(*(f"{x:.9g}" for x in row)) + end for v, row in zip(nu, values, strict=True))

    add("path", height, "range_m", "path_transmittance", "path_radiance", cells=",{},{},")
    add("sky", "0", "sky_zenith_deg", "sky_radiance", cells=",,{},")
    if "sensor_sky_radiance" in dataset:
        add("sky", height, "sensor_sky_zenith_deg", "sensor_sky_radiance", cells=",,{},")
    add("sun", "", "sun_zenith_deg", "sun_irradiance", cells=",,,{}")
    lines.extend(csv_lines(dataset, height))
    # Wavenumbers and nodes are written in full, so that grids agree after reading.
    write_text("\n".join(lines) + "\n", output)
    return output


def _assembled(path: Path, content: _Content, sensor_height: float) -> SampledAtmosphere:
    blocks = content.blocks
    heights = sorted(height for kind, height in blocks if kind == "path")
    height = next((h for h in heights if abs(h - sensor_height) <= HEIGHT_SLACK), None)
    if height is None:
        available = f"paths to {', '.join(f'{h:g}' for h in heights)} m" if heights else "no paths"
        raise DataError(
            f"{path}: holds {available}, none to sensor.height_m = {sensor_height:g}; set sensor.height_m to one of them or add paths"
        )
    if not any(kind == "sun" for kind, _ in blocks):
        raise DataError(f"{path}: holds no sunlight; add lines of kind sun (irradiance 0 for a night)")
    if not any(kind == "sky" and h <= HEIGHT_SLACK for kind, h in blocks):
        raise DataError(f"{path}: holds no sky seen from the sea, which the water mirrors; add lines of kind sky at height_m = 0")
    # The Sun is the same from all heights: its block is the only one of its kind.
    paths, sun = blocks["path", height], next(block for (kind, _), block in blocks.items() if kind == "sun")
    # All products are formed at each wavenumber, so that all blocks need one grid.
    nu = paths.wavenumber_cm
    for (kind, h), block in blocks.items():
        if block.wavenumber_cm.size != nu.size or not np.allclose(block.wavenumber_cm, nu, rtol=1e-9, atol=0.0):
            raise DataError(f"{path}: {kind} from {h:g} m has another spectral grid than the paths to {height:g} m; give all on one")
    skies = [
        SkySamples(
            h,
            np.radians(90.0 - block.node[::-1]),
            block.values["radiance"][::-1],
            dip=horizon_depression(h) if h > HEIGHT_SLACK else 0.0,
            kinks=(0.0,) if np.any(block.node == 90.0) else (),
        )
        for (kind, h), block in blocks.items()
        if kind == "sky" and (h <= HEIGHT_SLACK or abs(h - height) <= HEIGHT_SLACK)
    ]
    return SampledAtmosphere.create(
        nu,
        height=height,
        path=PathSamples(paths.node, paths.values["transmittance"], paths.values["radiance"], beyond=content.beyond),
        sun=SunSamples(np.radians(sun.node), sun.values["irradiance"]),
        skies=skies,
        scattered=assembled(
            path, content.solar_zenith_deg, list(content.scattered), height, nu, {key: block.node for key, block in blocks.items()}
        ),
        name=str(path),
        provenance={"table": "user's file", "file": path.name, "sha256": hashlib.sha256(path.read_bytes()).hexdigest()},
    )


def _from_csv(path: Path) -> _Content:
    table = read_table(path, COLUMNS)
    table.require_columns("kind")
    spectral = table.one_of("wavenumber_cm", "wavelength_um")
    cells: dict[tuple[str, float], dict[tuple[float, float], tuple[int, dict[str, float]]]] = {}
    lit = ScatteredRows(table)
    for row, kind in enumerate(table.text("kind")):
        if kind not in NEEDS:
            raise table.error(table.lines[row], f"kind = '{kind}' is not one of path, sky, sun, path-scattered, sky-scattered")
        table.require_columns(*NEEDS[kind])
        x = table.number(row, spectral, 1e-3)
        # Files per wavelength are converted once, at reading: all further code works per wavenumber.
        per = 1.0 if spectral == "wavenumber_cm" else x * x * 1e-4  # per um -> per cm-1: |d lambda / d nu| = lambda^2 / 1e4
        nu = x if spectral == "wavenumber_cm" else 1e4 / x
        height = table.number(row, "height_m", 0.0, 1e5) if kind != "sun" else 0.0
        node = table.number(row, "range_m", 0.0, 2e6) if "range_m" in NEEDS[kind] else table.number(row, "zenith_deg", 0.0, ANGLES[kind])
        values = {}
        for name in NEEDS[kind]:
            if name == "transmittance":
                values[name] = table.number(row, name, 0.0, 1.0)
            elif name in ("radiance", "irradiance"):
                values[name] = per * table.number(row, name, 0.0)
        if kind in KINDS:
            lit.add(row, kind, height, node, nu, values["radiance"])
            continue
        block = cells.setdefault((kind, height), {})
        if (node, nu) in block:
            raise table.error(table.lines[row], f"gives {kind} at the same place and {spectral} as line {block[node, nu][0]}; remove one")
        block[node, nu] = (table.lines[row], values)
    return _Content(
        {key: _gridded(table, key, block) for key, block in cells.items()}, solar_zenith_deg=lit.solar, scattered=tuple(lit.blocks())
    )


def _gridded(table: TextTable, key: tuple[str, float], block: dict[tuple[float, float], tuple[int, dict[str, float]]]) -> _Spectra:
    """Return a rectangle of nodes by wavenumbers; a missing sample is reported with the first line of its node."""
    nodes, grid = (np.unique([at[i] for at in block]) for i in (0, 1))
    what = "range_m" if key[0] == "path" else "zenith_deg"
    if nodes.size < 2 or grid.size < 2:
        line = next(iter(block.values()))[0]
        raise table.error(
            line, f"{key[0]} from {key[1]:g} m has {nodes.size} {what} and {grid.size} spectral samples; at least 2 of both are needed"
        )
    if len(block) != nodes.size * grid.size:
        # A file that was cut lacks samples of its last node: the node with fewest samples is named.
        first: dict[float, int] = {}
        for (node, _), (line, _) in block.items():
            first.setdefault(node, line)
        count = Counter(node for node, _ in block)
        short = min(count, key=lambda node: count[node])
        at = f"{key[0]} from {key[1]:g} m at {what} = {short:g}"
        raise table.error(first[short], f"{at} has {count[short]} of the {grid.size} spectral samples of the others; complete them")
    names = next(iter(block.values()))[1]
    return _Spectra(nodes, grid, {name: np.array([[block[node, nu][1][name] for nu in grid] for node in nodes]) for name in names})


def _from_netcdf(path: Path) -> _Content:
    try:
        with open_netcdf(path, decode_timedelta=False, decode_times=False) as dataset:
            return _of_dataset(path, dataset.load())
    except SeaglintError:
        raise
    except Exception as error:  # h5py and xarray raise nearly anything for a file of another kind
        raise DataError(f"{path}: cannot be read as NetCDF 4: {reason_of(error)}") from None


def _of_dataset(path: Path, dataset: Any) -> _Content:
    try:
        height = float(dataset.attrs["sensor_height_m"])
    except (KeyError, TypeError, ValueError):
        raise DataError(f"{path}: has no attribute sensor_height_m; give the height of the paths in metres") from None
    grid = _coordinate(path, dataset, "wavenumber_cm", 1e-3, np.inf)

    def block(dimension: str, low: float, high: float, variables: dict[str, tuple[str, float]]) -> _Spectra:
        nodes = _coordinate(path, dataset, dimension, low, high)
        values = {}
        for name, (variable, most) in variables.items():
            values[name] = _field(path, dataset, variable, (dimension, "wavenumber_cm"), most)[np.ix_(np.argsort(nodes), np.argsort(grid))]
        return _Spectra(np.sort(nodes), np.sort(grid), values)

    blocks = {
        ("path", height): block("range_m", 0.0, 2e6, {"transmittance": ("path_transmittance", 1.0), "radiance": ("path_radiance", np.inf)}),
        ("sun", 0.0): block("sun_zenith_deg", 0.0, 90.0, {"irradiance": ("sun_irradiance", np.inf)}),
        ("sky", 0.0): block("sky_zenith_deg", 0.0, 90.0, {"radiance": ("sky_radiance", np.inf)}),
    }
    if "sensor_sky_radiance" in dataset:
        blocks["sky", height] = block("sensor_sky_zenith_deg", 0.0, ANGLES["sky"], {"radiance": ("sensor_sky_radiance", np.inf)})
    solar, scattered = blocks_of_dataset(path, dataset, height)
    return _Content(blocks, bool(dataset.attrs.get("paths_reach_horizon", 0)), solar, tuple(scattered))


def _coordinate(path: Path, dataset: Any, name: str, low: float, high: float) -> FloatArray:
    if name not in dataset.coords or dataset[name].dims != (name,):
        raise DataError(f"{path}: needs the coordinate {name}")
    values = np.asarray(dataset[name], dtype=np.float64)
    if values.size < 2 or np.unique(values).size < values.size or not np.all((values >= low) & (values <= high)):
        raise DataError(f"{path}: {name} needs at least 2 different values within {low:g} to {high:g}")
    return values
