"""Reader of spectra in any of the formats, and their conversion to the layout of ``seaglint.formats.air_file``."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.conventions import FloatArray, horizon_depression, surface_range
from seaglint.base.errors import DataError
from seaglint.formats.modtran.decks import MANIFEST, Manifest, ModtranCase, horizon_zenith_deg, read_manifest
from seaglint.formats.modtran.modtran_spectrum import ModtranSight, ModtranSpectrum
from seaglint.formats.modtran.output_files import is_csv, is_json, is_tape7, read_csv, read_json, read_tape7

if TYPE_CHECKING:
    import xarray as xr

#: A file prints three decimals of angles [deg] and heights [km], and codes may move a ray by some thousandths.
SAME_ANGLE, SAME_HEIGHT = 0.006, 0.0015

GRAZING: Final = 3e-3  #: Tolerance of a path to the horizon, as part of the horizon's depression; longer paths continue along its tangent.

LARGEST: Final = 2 << 30  #: Largest size of a file of these formats [bytes].


@dataclass(frozen=True, eq=False)
class _LineSpectrum:
    """Spectrum and its line of sight."""

    line: ModtranCase
    spectrum: ModtranSpectrum
    solar_zenith_deg: float | None


def read_spectra(path: Path) -> list[ModtranSpectrum]:
    """Read all cases of a file of any of the formats.

    Raises
    ------
    DataError
        The file is missing, of no known format, cut, or holds what cannot be.
    """
    known = "tape7 (.tp7, .7sc) of LOWTRAN7 or MODTRAN 4-5, CSV or JSON of MODTRAN 6"
    try:
        if path.stat().st_size > LARGEST:
            raise DataError(f"{path}: has more than 2 GiB; give {known}, with a narrower V1 to V2")
        content = path.read_bytes()
    except FileNotFoundError:
        raise DataError(f"{path}: no such file; give {known}") from None
    except OSError as error:
        raise DataError(f"{path}: cannot be read: {error.strerror}") from None
    if not content.strip():
        raise DataError(f"{path}: is empty; the run failed, or give {known}")
    if b"\0" in content:
        raise DataError(f"{path}: is no text (BINARY = T?); run it with text output and give {known}")
    text = content.decode("utf-8-sig", errors="replace")
    if is_json(text):
        return read_json(path, text)
    if is_csv(text):
        return read_csv(path, text)
    if is_tape7(path, text[:200_000]):
        return read_tape7(path, text)
    raise DataError(f"{path}: is of no known format; give {known}")


def read_air(files: Sequence[Path]) -> xr.Dataset:
    """Read air from files, or from a folder that ``seaglint atmosphere write`` made and that holds a code's results.

    The line of sight of a case is taken from the manifest beside the file, or else from the file's own cards or input.

    Raises
    ------
    DataError
        Naming file, case and line of what cannot be used.
    """
    seen: list[_LineSpectrum] = []
    for path in files:
        if path.is_dir():
            seen += _of_folder(path)
        else:
            manifest_path = path.parent / MANIFEST
            manifest = read_manifest(manifest_path) if manifest_path.is_file() else None
            named = manifest is not None and path.name in manifest.outputs
            seen += _of_manifest(path, manifest) if named and manifest is not None else [_of_sight(s) for s in read_spectra(path)]
    return _dataset(seen)


def _of_folder(folder: Path) -> list[_LineSpectrum]:
    manifest = read_manifest(folder / MANIFEST)
    path = next((folder / name for name in manifest.outputs if (folder / name).is_file()), None)
    if path is None:
        raise DataError(f"{folder}: holds none of {', '.join(manifest.outputs)}; run the deck there, or copy its result there")
    return _of_manifest(path, manifest)


def _of_manifest(path: Path, manifest: Manifest) -> list[_LineSpectrum]:
    spectra = read_spectra(path)
    if len(spectra) != len(manifest.lines):
        raise DataError(
            f"{path}: holds {len(spectra)} cases, {MANIFEST} beside it {len(manifest.lines)} lines of sight; "
            "the run stopped early or the output is of another deck: run the deck again"
        )
    for line, spectrum in zip(manifest.lines, spectra, strict=True):
        _require_same(line, spectrum, manifest.solar_zenith_deg)
    return [_LineSpectrum(line, s, manifest.solar_zenith_deg) for line, s in zip(manifest.lines, spectra, strict=True)]


def _require_same(line: ModtranCase, spectrum: ModtranSpectrum, solar_zenith_deg: float | None) -> None:
    """Refuse output whose own cards state another line of sight than the manifest."""
    sight = spectrum.sight
    if sight is None or (line.kind == "sun" and sight.mode != 3):
        return
    if abs(sight.height_km - line.height_m / 1e3) > SAME_HEIGHT or abs(sight.zenith_deg - line.zenith_deg) > SAME_ANGLE:
        raise DataError(
            f"{spectrum.where}: looks from {1e3 * sight.height_km:g} m at a zenith angle of {sight.zenith_deg:g} deg, {MANIFEST} says from "
            f"{line.height_m:g} m at {line.zenith_deg:g} deg; the output is of another deck: run the one beside the manifest"
        )
    if line.azimuth_deg is None or solar_zenith_deg is None or math.isnan(sight.solar_zenith_deg):
        return
    if max(abs(sight.solar_zenith_deg - solar_zenith_deg), abs(abs(sight.azimuth_deg) - line.azimuth_deg)) > SAME_ANGLE:
        raise DataError(
            f"{spectrum.where}: has a Sun at {sight.solar_zenith_deg:g} deg, {sight.azimuth_deg:g} deg aside, {MANIFEST} says at "
            f"{solar_zenith_deg:g} deg, {line.azimuth_deg:g} deg aside; the output is of another deck: run the one beside the manifest"
        )


def _of_sight(spectrum: ModtranSpectrum) -> _LineSpectrum:
    """Return the line of sight that a spectrum's file states."""
    sight = spectrum.sight
    if sight is None:
        raise DataError(
            f"{spectrum.where}: does not say which line of sight it is; keep {MANIFEST} of seaglint atmosphere write beside it, or give "
            "tape7 with its cards, or JSON with its input (JSONOPT = WRT_INPUT_OUTPUT)"
        )
    height = 1e3 * sight.height_km
    lit = sight.mode == 2 and not math.isnan(sight.azimuth_deg)
    azimuth, solar = (abs(sight.azimuth_deg), sight.solar_zenith_deg) if lit else (None, None)
    if sight.mode == 3:
        return _LineSpectrum(ModtranCase("sun", height, sight.zenith_deg), spectrum, None)
    if sight.kind == 3:
        return _LineSpectrum(_sky_line(sight, height, azimuth), spectrum, solar)
    return _LineSpectrum(_path_line(spectrum, sight, height, azimuth), spectrum, solar)


def _sky_line(sight: ModtranSight, height: float, azimuth: float | None) -> ModtranCase:
    zenith = sight.zenith_deg
    share = np.radians(zenith - 90.0) / horizon_depression(height) if zenith > 90.0 and height > 0.0 else None
    return ModtranCase("sky", height, zenith, None, None if share is None else min(float(share), 1.0), azimuth)


def _path_line(spectrum: ModtranSpectrum, sight: ModtranSight, height: float, azimuth: float | None) -> ModtranCase:
    if sight.end_km > 1e-6 or sight.zenith_deg <= 90.0 or height <= 0.0:
        raise DataError(
            f"{spectrum.where}: goes from {height:g} m at a zenith angle of {sight.zenith_deg:g} deg to {1e3 * sight.end_km:g} m; paths "
            "go from the sensor down to the sea: H1 the sensor, H2 = 0, ANGLE above 90 deg"
        )
    arc = float(surface_range(height, np.radians(sight.zenith_deg - 90.0)))
    if math.isnan(arc):
        limit = 90.0 + math.degrees(horizon_depression(height))
        raise DataError(
            f"{spectrum.where}: at a zenith angle of {sight.zenith_deg:g} deg a path from {height:g} m passes above the sea, whose horizon "
            f"is at {limit:.3f} deg; does H1 fit the sensor? Look down to the sea, or keep {MANIFEST} beside the file"
        )
    return ModtranCase("path", height, sight.zenith_deg, arc, None, azimuth)


def _dataset(seen: list[_LineSpectrum]) -> xr.Dataset:
    import xarray as xr

    nu = _common_grid(seen)
    _require_once(seen)
    paths = [s for s in seen if s.line.kind == "path"]
    heights = sorted({round(s.line.height_m, 4) for s in paths})
    if not heights:
        raise DataError(f"{_file(seen[0])}: holds no path from a sensor to the sea (ITYPE = 2, H2 = 0); add them")
    if len(heights) > 1:
        odd = next(s for s in paths if round(s.line.height_m, 4) != round(paths[0].line.height_m, 4))
        raise DataError(
            f"{odd.spectrum.where}: is a path from {odd.line.height_m:g} m, those before are from {paths[0].line.height_m:g} m; "
            "give the files of one sensor height"
        )
    height = paths[0].line.height_m
    # Sky is needed from the sea, which mirrors it, and from the sensor; other heights have no use.
    for s in seen:
        if s.line.kind == "sky" and min(s.line.height_m, abs(s.line.height_m - height)) > 1e-3:
            raise DataError(
                f"{s.spectrum.where}: is sky seen from {s.line.height_m:g} m; give it from the sea (H1 = 0) and the sensor ({height:g} m)"
            )
    from_sea = [s for s in seen if s.line.kind == "sky" and s.line.height_m <= 1e-3]
    from_sensor = [s for s in seen if s.line.kind == "sky" and s.line.height_m > 1e-3]
    suns = [s for s in seen if s.line.kind == "sun"]
    for group, what in (
        (paths, "paths from the sensor to the sea"),
        (from_sea, "sky seen from the sea (H1 = 0, ITYPE = 3)"),
        (suns, "zenith angles of the Sun (IEMSCT = 3)"),
    ):
        if len({_node(s.line) for s in group}) < 2:
            raise DataError(f"{_file(seen[0])}: holds fewer than 2 {what}; add them")
    out: dict[str, tuple[tuple[str, ...], FloatArray]] = {}
    coords: dict[str, FloatArray] = {"wavenumber_cm": nu}
    layout = (
        (paths, "range_m", ("path_transmittance", "transmittance"), ("path_radiance", "thermal"), "path_scattered"),
        (from_sea, "sky_zenith_deg", None, ("sky_radiance", "thermal"), "sky_scattered"),
        (from_sensor, "sensor_sky_zenith_deg", None, ("sensor_sky_radiance", "thermal"), "sensor_sky_scattered"),
        (suns, "sun_zenith_deg", None, ("sun_irradiance", "sun"), None),
    )
    for group, dimension, *variables, scattered in layout:
        if not group:
            continue
        first = _first_of_each(group)
        coords[dimension] = np.array(list(first))
        for variable in variables:
            if variable is not None:
                values = [s.spectrum.need(variable[1]) for s in first.values()]  # type: ignore[arg-type]
                out[variable[0]] = ((dimension, "wavenumber_cm"), np.array(values))
        if scattered is not None:
            _add_scattered(out, coords, group, dimension, scattered)
    attributes: dict[str, float | int | str] = {"title": "Air between sensor and sea", "sensor_height_m": height}
    solar = sorted({round(s.solar_zenith_deg, 3) for s in seen if s.solar_zenith_deg is not None})
    if len(solar) > 1:
        raise DataError(
            f"{_file(seen[0])}: scattered sunlight is of Suns at {', '.join(f'{z:g}' for z in solar[:4])} deg; give the files of one Sun"
        )
    if solar and any(name.endswith("scattered") for name in out):
        attributes["solar_zenith_deg"] = solar[0]
    without_azimuth = sum(_lacks_azimuth(s) for s in seen)
    if without_azimuth:
        attributes["cases_without_azimuth"] = without_azimuth
    # The longest path decides whether longer ones continue along the tangent.
    if _reaches_horizon(max(paths, key=lambda s: _node(s.line)).line):
        attributes["paths_reach_horizon"] = 1
    return xr.Dataset(
        {name: (dims, np.maximum(values, 0.0), {"units": _unit(name)}) for name, (dims, values) in out.items()},
        coords=coords,
        attrs=attributes,
    )


def _lacks_azimuth(seen: _LineSpectrum) -> bool:
    """Return true for scattered sunlight whose azimuth from the Sun is not known, so that it is left out."""
    scattered = seen.spectrum.scattered
    return seen.line.kind != "sun" and seen.line.azimuth_deg is None and scattered is not None and bool(scattered.any())


def _file(seen: _LineSpectrum) -> str:
    return seen.spectrum.where.split(": case")[0]


def _reaches_horizon(line: ModtranCase) -> bool:
    arc = line.range_m or 0.0
    # The depression of the straight ray to the end of the arc is compared with the depression of the horizon.
    psi, h = arc / EFFECTIVE_EARTH_RADIUS, line.height_m
    depression = math.atan2(h + 2.0 * EFFECTIVE_EARTH_RADIUS * math.sin(0.5 * psi) ** 2, EFFECTIVE_EARTH_RADIUS * math.sin(psi) or 1e-9)
    return depression < horizon_depression(h) * (1.0 + GRAZING)


def _unit(name: str) -> str:
    return {"path_transmittance": "1", "sun_irradiance": "W m-2 per cm-1"}.get(name, "W m-2 sr-1 per cm-1")


def _node(line: ModtranCase) -> float:
    return round(line.range_m or 0.0, 6) if line.kind == "path" else round(horizon_zenith_deg(line), 7)


def _require_once(seen: list[_LineSpectrum]) -> None:
    lines: dict[tuple[str, float, float, float | None], _LineSpectrum] = {}
    for s in seen:
        before = lines.setdefault((s.line.kind, round(s.line.height_m, 4), _node(s.line), s.line.azimuth_deg), s)
        if before is not s:
            raise DataError(f"{s.spectrum.where}: is the same line of sight as {before.spectrum.where}; give each once")


def _common_grid(seen: list[_LineSpectrum]) -> FloatArray:
    if not seen:
        raise DataError("no cases were given; name the files that MODTRAN wrote")
    nu = seen[0].spectrum.wavenumber_cm
    for s in seen:
        other = s.spectrum.wavenumber_cm
        if other.size != nu.size or not np.allclose(other, nu, rtol=1e-6, atol=0.0):
            raise DataError(
                f"{s.spectrum.where}: has {other.size} spectral samples of {other[0]:g}-{other[-1]:g} cm-1, {seen[0].spectrum.where} "
                f"{nu.size} of {nu[0]:g}-{nu[-1]:g} cm-1; give all lines of sight on one grid"
            )
    return nu


def _first_of_each(group: list[_LineSpectrum]) -> dict[float, _LineSpectrum]:
    """Return one case for each node, ascending; of several azimuths the one farthest from the Sun."""
    first: dict[float, _LineSpectrum] = {}
    for s in sorted(group, key=lambda s: (_node(s.line), -(s.line.azimuth_deg or 0.0))):
        first.setdefault(_node(s.line), s)
    return first


def _add_scattered(
    out: dict[str, tuple[tuple[str, ...], FloatArray]], coords: dict[str, FloatArray], group: list[_LineSpectrum], dimension: str, name: str
) -> None:
    """Add the scattered sunlight of a group over node and azimuth, where every case has an azimuth."""
    lit = [s for s in group if s.line.azimuth_deg is not None]
    if not lit:
        return
    nodes = list(coords[dimension])
    azimuths = sorted({s.line.azimuth_deg for s in lit if s.line.azimuth_deg is not None})
    known = coords.setdefault("azimuth_from_sun_deg", np.array(azimuths))
    cells = {(_node(s.line), s.line.azimuth_deg): s for s in lit}
    if known.tolist() != azimuths or len(cells) != len(nodes) * len(azimuths) or len(azimuths) < 2:
        raise DataError(
            f"{_file(lit[0])}: {name} has {len(cells)} cases for {len(nodes)} lines of sight and "
            f"{known.size} azimuths from the Sun; give each line at each azimuth, at 2 azimuths or more"
        )
    values = [[cells[node, azimuth].spectrum.need("scattered") for azimuth in azimuths] for node in nodes]
    out[name] = ((dimension, "azimuth_from_sun_deg", "wavenumber_cm"), np.array(values))
