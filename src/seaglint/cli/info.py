"""Contents of a sequence or a map, and how it was made."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from seaglint.base.errors import DataError, SeaglintError
from seaglint.files.counts import pictures
from seaglint.files.directions import directions
from seaglint.files.netcdf import open_netcdf
from seaglint.files.store.location import place_of
from seaglint.files.store.store import open_sequence
from seaglint.plot.sequence_summary import images, summarise

if TYPE_CHECKING:
    import xarray as xr

_HIDDEN = frozenset(
    {"scenario", "band_wavelength_um", "band_response", "Conventions", "title", "seaglint_format", "frame_rate_hz", "seed", "unfinished"}
)


def describe(path: Path | str) -> dict[str, Any]:
    """Facts about an output file as plain values.

    Raises
    ------
    DataError
        Nothing is there, or it cannot be read.
    """
    if isinstance(path, Path) and path.is_file():
        dataset = open_netcdf(path, decode_times=False)
    else:
        dataset = open_sequence(path, allow_partial=True)
    with dataset:
        try:
            return _facts(path, dataset)
        except SeaglintError:
            raise
        except Exception as error:  # what a damaged file holds may be of any type, and h5py raises nearly anything
            reason = " ".join(str(error).split())[:200] or type(error).__name__
            raise DataError(f"{path}: cannot be read as a seaglint file ({reason}); make it again") from error


def _size(path: Path | str) -> int:
    if isinstance(path, Path) and path.is_file():
        return path.stat().st_size
    return place_of(path).bytes


def _facts(path: Path | str, dataset: xr.Dataset) -> dict[str, Any]:
    if "texture" in dataset:
        return _texture_facts(path, dataset)
    radiance = pictures(dataset)
    azimuth, elevation = directions(dataset)
    upright = azimuth.ndim == 1
    facts: dict[str, Any] = {"path": str(path), "title": dataset.attrs.get("title", ""), "variables": sorted(map(str, dataset.data_vars))}
    if "time" in radiance.dims:
        done = len(images(dataset))
        facts |= {
            "frames": radiance.sizes["time"],
            "frames_done": done,
            "complete": done == radiance.sizes["time"],
            "first_frame": int(dataset["frame"][0]),
            "frame_rate_hz": float(dataset.attrs["frame_rate_hz"]),
        }
    facts |= {
        "pixels": [int(radiance.sizes["x"]), int(radiance.sizes["y"])],
        "azimuth_deg": [float(azimuth[0]), float(azimuth[-1])] if upright else [float(azimuth.min()), float(azimuth.max())],
        "elevation_deg": [float(elevation[0]), float(elevation[-1])] if upright else [float(elevation.max()), float(elevation.min())],
        "band_um": [float(dataset.attrs["band_wavelength_um"][0]), float(dataset.attrs["band_wavelength_um"][-1])],
        "seed": int(dataset.attrs["seed"]) if "seed" in dataset.attrs else None,
        "bytes": _size(path),
    }
    if len(images(dataset)):
        summary = summarise(dataset)
        facts |= {"statistics": summary.as_dict(), "summary": summary.line}
    if "saturated_share" in dataset:
        shares = dataset["saturated_share"].to_numpy()
        facts["saturated_share"] = [float(share) for share in shares[shares == shares]]
    facts["provenance"] = {key: _plain(value) for key, value in dataset.attrs.items() if key not in _HIDDEN}
    try:
        facts["scenario"] = json.loads(dataset.attrs["scenario"])
    except (KeyError, ValueError):
        facts["scenario"] = None
    return facts


def _texture_facts(path: Path | str, dataset: xr.Dataset) -> dict[str, Any]:
    """A loop of a texture, whose pixels look nowhere and have no band."""
    field = dataset["texture"]
    return {
        "path": str(path),
        "title": dataset.attrs.get("title", ""),
        "variables": ["texture"],
        "frames": field.sizes["time"],
        "frames_done": len(images(dataset, "texture")),
        "complete": len(images(dataset, "texture")) == field.sizes["time"],
        "first_frame": int(dataset["frame"][0]),
        "frame_rate_hz": float(dataset.attrs["frame_rate_hz"]),
        "pixels": [int(field.sizes["x"]), int(field.sizes["y"])],
        "units": field.attrs.get("units", ""),
        "seed": int(dataset.attrs["seed"]),
        "bytes": _size(path),
        "provenance": {key: _plain(value) for key, value in dataset.attrs.items() if key not in _HIDDEN},
    }


def _plain(value: Any) -> Any:
    return value.tolist() if hasattr(value, "tolist") else value


def lines(facts: dict[str, Any]) -> list[str]:
    """Return the facts as lines of text."""
    nx, ny = facts["pixels"]
    out = [f"{facts['path']}: {facts['title']}"]
    if "frames" in facts:
        state = "complete" if facts["complete"] else f"UNFINISHED, {facts['frames_done']} done"
        out.append(f"  frames            {facts['frames']} from number {facts['first_frame']} at {facts['frame_rate_hz']:g} Hz, {state}")
    if "band_um" in facts:
        (a0, a1), (e0, e1), (w0, w1) = (facts[key] for key in ("azimuth_deg", "elevation_deg", "band_um"))
        out += [
            f"  pixels            {nx} x {ny}: azimuth {a0:g} to {a1:g} deg, elevation {e0:g} to {e1:g} deg",
            f"  band              {w0:g} to {w1:g} um",
        ]
    else:
        out.append(f"  pixels            {nx} x {ny}, periodic along every axis")
    out += [
        f"  variables         {', '.join(facts['variables'])}",
        f"  size              {facts['bytes'] / 1e6:.1f} MB",
        f"  seed              {facts['seed']}",
    ]
    if "summary" in facts:
        out.append(f"  radiance          {facts['summary']}")
    if facts.get("saturated_share"):
        shares = facts["saturated_share"]
        out.append(
            f"  saturated         {100 * sum(shares) / len(shares):.3g} % of the pixels, {100 * max(shares):.3g} % in the worst frame"
        )
    out += [f"  {key:17} {value}" for key, value in facts["provenance"].items()]
    return out
