"""Contents of a sequence or a map, and how it was made."""

from __future__ import annotations

import json
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from seaglint.base.errors import DataError, SeaglintError
from seaglint.base.free_form import JsonObject
from seaglint.files.counts import pictures
from seaglint.files.directions import directions
from seaglint.files.netcdf import open_netcdf
from seaglint.files.sequence_summary import Summary, images, summarise
from seaglint.files.store.location import place_of
from seaglint.files.store.store import open_sequence
from seaglint.studies.contents.input_facts import scene_line

if TYPE_CHECKING:
    import xarray as xr

_HIDDEN = frozenset(
    {"scenario", "band_wavelength_um", "band_response", "Conventions", "title", "seaglint_format", "frame_rate_hz", "seed", "unfinished"}
)
_BOOKS = frozenset({"frame_checksum", "frame_done", "wavelength_bounds"})  #: Variables that no user looks at.


@dataclass(frozen=True)
class FramesHeld:
    """Frames of a sequence: their number, how many are written, whether all are, the number of the first, and the rate [Hz]."""

    frames: int
    frames_done: int
    complete: bool
    first_frame: int
    frame_rate_hz: float


@dataclass(frozen=True)
class DirectionsHeld:
    """Directions and band of a picture."""

    #: ``azimuth_deg``, ``elevation_deg``: Of the first and last column and row; of a picture that is turned, the limits [deg].
    azimuth_deg: list[float]
    elevation_deg: list[float]
    band_um: list[float]  #: Limits of the band [um].


@dataclass(frozen=True)
class FileFacts:
    """Contents of an output file."""

    #: ``path``, ``title``: Place and title.
    path: str
    title: str
    variables: list[str]  #: Names of its variables.
    frames: FramesHeld | None  #: Frames of a sequence; None of a map.
    pixels: list[int]  #: Columns and rows.
    directions: DirectionsHeld | None  #: Directions and band; None of a texture, whose pixels look nowhere and have no band.
    seed: int | None  #: Seed, as far as there is one.
    bytes: int  #: Size [B].
    provenance: JsonObject  #: Attributes about its making.
    units: str = ""  #: Units of a texture.
    summary: Summary | None = None  #: Statistics of the frames that are written.
    saturated_share: list[float] | None = None  #: Share of saturated pixels of each written frame [1]; None without a detector.
    scenario: JsonObject | None = None  #: Scenario as one table, as far as it can be read.

    def as_dict(self) -> JsonObject:
        """Return plain numbers and text; keys that a kind of file does not have are left out."""
        out: JsonObject = {"path": self.path, "title": self.title, "variables": self.variables}
        out |= {} if self.frames is None else asdict(self.frames)
        out |= {"pixels": self.pixels} | ({"units": self.units} if self.directions is None else asdict(self.directions))
        out |= {"seed": self.seed, "bytes": self.bytes}
        out |= {} if self.summary is None else {"statistics": self.summary.as_dict(), "summary": self.summary.line}
        out |= {} if self.saturated_share is None else {"saturated_share": self.saturated_share}
        return out | {"provenance": self.provenance} | ({} if self.directions is None else {"scenario": self.scenario})


@dataclass(frozen=True)
class ArrayFile:
    """Arrays that this program computed and that are no pictures: a sweep, the air along paths, a map of chances."""

    #: ``path``, ``title``: Place and title.
    path: str
    title: str
    sizes: dict[str, int]  #: Length of each dimension.
    variables: dict[str, str]  #: Units of each variable.
    bytes: int  #: Size [B].
    provenance: JsonObject  #: Attributes about its making.
    scenario: JsonObject | None  #: Scenario as one table, as far as it can be read.

    def as_dict(self) -> JsonObject:
        """Return plain numbers and text."""
        return asdict(self)


def is_array_file(dataset: xr.Dataset) -> bool:
    """Return true for arrays of this program that are no pictures."""
    return "seaglint_version" in dataset.attrs and not {"x", "y"} <= set(dataset.sizes)


def _array_file(path: Path | str, dataset: xr.Dataset) -> ArrayFile:
    return ArrayFile(
        path=str(path),
        title=str(dataset.attrs.get("title", "")),
        sizes={str(name): int(size) for name, size in dataset.sizes.items()},
        variables={str(name): str(array.attrs.get("units", "")) for name, array in dataset.data_vars.items()},
        bytes=_size(path),
        provenance=_provenance(dataset),
        scenario=_scenario(dataset),
    )


def _scenario(dataset: xr.Dataset) -> JsonObject | None:
    try:
        scenario: JsonObject = json.loads(dataset.attrs["scenario"])
    except (KeyError, ValueError):
        return None
    return scenario


def _array_lines(facts: ArrayFile, everything: bool) -> list[str]:
    """Return the facts of arrays as lines of text."""
    out = [f"{facts.path}: {facts.title}", f"  dimensions        {', '.join(f'{name} {size}' for name, size in facts.sizes.items())}"]
    out.append("  variables         " + ", ".join(f"{name} [{unit}]" if unit else name for name, unit in facts.variables.items()))
    if facts.scenario is not None:
        with suppress(KeyError, TypeError, ValueError):  # of an older version, or damaged
            out.append(f"  scene             {scene_line(facts.scenario)}")
    out.append(f"  file              {facts.bytes / 1e6:.1f} MB")
    if everything:
        return [*out, *(f"  {key:17} {value}" for key, value in facts.provenance.items())]
    return [*out, f"  how it was made   seaglint info --all {facts.path}"]


def describe(path: Path | str) -> FileFacts | ArrayFile:
    """Facts about an output file.

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
            return _array_file(path, dataset) if is_array_file(dataset) else _facts(path, dataset)
        except SeaglintError:
            raise
        except Exception as error:  # what a damaged file holds may be of any type, and h5py raises nearly anything
            reason = " ".join(str(error).split())[:200] or type(error).__name__
            raise DataError(f"{path}: cannot be read as a seaglint file ({reason}); make it again") from error


def _size(path: Path | str) -> int:
    if isinstance(path, Path) and path.is_file():
        return path.stat().st_size
    return place_of(path).bytes


def _facts(path: Path | str, dataset: xr.Dataset) -> FileFacts:
    if "texture" in dataset:
        return _texture_facts(path, dataset)
    radiance = pictures(dataset)
    azimuth, elevation = directions(dataset)
    upright = azimuth.ndim == 1
    frames = None
    done = len(images(dataset))
    if "time" in radiance.dims:
        frames = _frames(dataset, radiance.sizes["time"], done)
    saturated = None
    if "saturated_share" in dataset:
        shares = dataset["saturated_share"].to_numpy()
        saturated = [float(share) for share in shares[shares == shares]]
    return FileFacts(
        path=str(path),
        title=dataset.attrs.get("title", ""),
        variables=sorted(map(str, dataset.data_vars)),
        frames=frames,
        pixels=[int(radiance.sizes["x"]), int(radiance.sizes["y"])],
        directions=DirectionsHeld(
            [float(azimuth[0]), float(azimuth[-1])] if upright else [float(azimuth.min()), float(azimuth.max())],
            [float(elevation[0]), float(elevation[-1])] if upright else [float(elevation.max()), float(elevation.min())],
            [float(dataset.attrs["band_wavelength_um"][0]), float(dataset.attrs["band_wavelength_um"][-1])],
        ),
        seed=int(dataset.attrs["seed"]) if "seed" in dataset.attrs else None,
        bytes=_size(path),
        provenance=_provenance(dataset),
        summary=summarise(dataset) if done else None,
        saturated_share=saturated,
        scenario=_scenario(dataset),
    )


def _texture_facts(path: Path | str, dataset: xr.Dataset) -> FileFacts:
    """A loop of a texture, whose pixels look nowhere and have no band."""
    field = dataset["texture"]
    return FileFacts(
        path=str(path),
        title=dataset.attrs.get("title", ""),
        variables=["texture"],
        frames=_frames(dataset, field.sizes["time"], len(images(dataset, "texture"))),
        pixels=[int(field.sizes["x"]), int(field.sizes["y"])],
        directions=None,
        seed=int(dataset.attrs["seed"]),
        bytes=_size(path),
        provenance=_provenance(dataset),
        units=field.attrs.get("units", ""),
    )


def _frames(dataset: xr.Dataset, count: int, done: int) -> FramesHeld:
    return FramesHeld(count, done, done == count, int(dataset["frame"][0]), float(dataset.attrs["frame_rate_hz"]))


def _provenance(dataset: xr.Dataset) -> JsonObject:
    return {key: _plain(value) for key, value in dataset.attrs.items() if key not in _HIDDEN}


def _plain(value: Any) -> Any:
    return value.tolist() if hasattr(value, "tolist") else value


def lines(facts: FileFacts | ArrayFile, *, everything: bool = False) -> list[str]:
    """Return the facts as at most ten lines of text, or with ``everything`` that was noted when the file was made."""
    if isinstance(facts, ArrayFile):
        return _array_lines(facts, everything)
    nx, ny = facts.pixels
    out = [f"{facts.path}: {facts.title}"]
    if (held := facts.frames) is not None:
        state = "complete" if held.complete else f"UNFINISHED, {held.frames_done} done"
        out.append(f"  frames            {held.frames} from number {held.first_frame} at {held.frame_rate_hz:g} Hz, {state}")
    if facts.directions is not None:
        seen = facts.directions
        (a0, a1), (e0, e1), (w0, w1) = seen.azimuth_deg, seen.elevation_deg, seen.band_um
        out += [
            f"  pixels            {nx} x {ny}: azimuth {a0:g} to {a1:g} deg, elevation {e0:g} to {e1:g} deg",
            f"  band              {w0:g} to {w1:g} um",
        ]
    else:
        out.append(f"  pixels            {nx} x {ny}, periodic along every axis")
    if facts.scenario is not None:
        with suppress(KeyError, TypeError, ValueError):  # of an older version, or damaged
            out.append(f"  scene             {scene_line(facts.scenario)}")
    if facts.summary is not None:
        out.append(f"  radiance          {facts.summary.line}")
    if shares := facts.saturated_share:
        out.append(
            f"  saturated         {100 * sum(shares) / len(shares):.3g} % of the pixels, {100 * max(shares):.3g} % in the worst frame"
        )
    named = facts.variables if everything else [name for name in facts.variables if name not in _BOOKS]
    out += [
        f"  variables         {', '.join(named)}",
        f"  file              {facts.bytes / 1e6:.1f} MB, seed {facts.seed}",
    ]
    if everything:
        return [*out, *(f"  {key:17} {value}" for key, value in facts.provenance.items())]
    if facts.provenance:
        out.append(f"  how it was made   seaglint info --all {facts.path}")
    return out
