"""Contents of files that are given to commands: scenarios, recordings, and this program's sequences, maps and arrays."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from seaglint.base.errors import DataError, ScenarioError, SeaglintError
from seaglint.base.free_form import JsonObject
from seaglint.base.representation import decimals
from seaglint.store.location import place_of
from seaglint.store.netcdf import open_netcdf
from seaglint.store.sequence_store import is_sequence, open_sequence
from seaglint.store.stored_images import Summary, directions, images, pictures, summarise

if TYPE_CHECKING:
    import xarray as xr

    from seaglint.scenario.model import Scenario


@dataclass(frozen=True)
class ScenarioFacts:
    """Contents of a scenario file or an ensemble file."""

    path: str  #: The file.
    kind: str  #: "scenario" or "ensemble".
    about: list[str]  #: Description of its contents, a line each.

    @property
    def lines(self) -> list[str]:
        """Return the facts as lines of text."""
        return [f"{self.path}: {'an' if self.kind == 'ensemble' else 'a'} {self.kind}", *(f"  {line}" for line in self.about)]

    def as_dict(self) -> JsonObject:
        """Return plain text."""
        return asdict(self)


@dataclass(frozen=True)
class RecordingFacts:
    """Contents of a recording: images in a file of any format that ``seaglint analyze`` reads."""

    path: str  #: File or folder.
    frames: int  #: Number of frames.
    rows: int  #: Number of rows.
    columns: int  #: Number of columns.
    units: str | None  #: Units of the values, if the file states them.
    frame_rate_hz: float | None  #: Frames per second, if the file states them.
    least: float | None  #: Smallest value of the first frame; None where it has none.
    most: float | None  #: Largest value of the first frame; None where it has none.
    notes: list[str]  #: Notes on the format.

    @property
    def lines(self) -> list[str]:
        """Return the facts as lines of text."""
        unit = self.units or "no unit"
        rate = f"{decimals(self.frame_rate_hz, 3)} Hz" if self.frame_rate_hz else "no frame rate"
        first = "no values" if self.least is None else f"{self.least:.6g} to {self.most:.6g} in the first frame"
        out = [
            f"{self.path}: a recording",
            f"  frames            {self.frames} of {self.columns} x {self.rows} pixels, {rate}",
            f"  values            {first}, {unit}",
        ]
        missing = [
            text for text, lacks in (("--units", not self.units), ("--frame-rate", not self.frame_rate_hz and self.frames > 1)) if lacks
        ]
        if missing:
            out.append(f"  not in the file   directions and band; say the rest with {' and '.join(missing)} of 'seaglint analyze'")
        return [*out, *(f"  note              {note}" for note in self.notes)]

    def as_dict(self) -> JsonObject:
        """Return plain numbers and text."""
        return asdict(self)


def is_ours(path: Path | str) -> bool:
    """Return true for stores and maps of this program, and for places to be read as one: a URL, a Zarr folder, NetCDF, no file."""
    if not isinstance(path, Path) or not path.exists():
        return not str(path).endswith(".toml")
    if path.is_dir():
        from seaglint.formats.recording.labelled_arrays import is_zarr

        # A Zarr store of another program is read as a recording.
        return is_sequence(path) or (path.suffix.lower() == ".zarr" and not (is_zarr(path) and _is_of_others(path)))
    return path.suffix.lower() == "" or (path.suffix.lower() in (".nc", ".nc4") and not _is_of_others(path))


def _is_of_others(path: Path) -> bool:
    """Return true for images of another program: a file or store that opens and holds no picture of this program."""
    from seaglint.base.schema import IMAGES

    try:
        if path.is_dir():
            import zarr

            node = zarr.open(str(path), mode="r")
            return isinstance(node, zarr.Array) or not set(IMAGES) & {name for name, _ in node.members()}
        with open_netcdf(path, decode_times=False) as dataset:
            return "seaglint_version" not in dataset.attrs and not set(IMAGES) & {str(name) for name in dataset.data_vars}
    except (SeaglintError, OSError, ValueError, KeyError):
        return False  # the reader of this program's files reports why a file cannot be opened


def describe_scenario(path: Path) -> ScenarioFacts:
    """Return facts about a scenario file, or an ensemble file.

    Raises
    ------
    ScenarioError
        It is no scenario and no ensemble.
    """
    import tomllib

    from seaglint.scenario.load import load_scenario

    try:
        raw = tomllib.loads(path.read_bytes().decode("utf-8-sig"))
    except (OSError, ValueError, RecursionError):
        raw = {}  # the reader of scenarios reports the reason
    if "ensemble" in raw:
        from seaglint.scenario.ensemble_file import load_ensemble

        ensemble = load_ensemble(path).ensemble
        keys = [str(vary["key"]) for vary in raw.get("vary", [])]
        return ScenarioFacts(str(path), "ensemble", [f"{ensemble.scenes} scenes; drawn for each: {', '.join(keys) or 'the seed alone'}"])
    scenario = load_scenario(path)
    camera = camera_lines(scenario.model_dump(mode="json", exclude_none=True))
    return ScenarioFacts(str(path), "scenario", [*camera, *_moon_lines(scenario)])


def _moon_lines(scenario: Scenario) -> list[str]:
    """Return lines on the Sun and the Moon over a scenario with ``[moon]``."""
    from seaglint.facet.sea_view import farthest_turn
    from seaglint.scenario.moon import ECLIPSED, moon_position
    from seaglint.scenario.sun import sun_position

    try:
        sun, moon = sun_position(scenario), moon_position(scenario)
    except ScenarioError:
        return ["Moon              by time and place of every draw of [likelihood]"] if scenario.moon is not None else []
    if moon is None:
        return []
    zenith, azimuth, phase, radius = (math.degrees(angle) for angle in (moon.zenith, moon.azimuth, moon.phase, moon.radius))
    below = ""
    if (depth := moon.zenith - moon.radius - 0.5 * math.pi) > farthest_turn(scenario.sensor.height_m):
        below = "; it is below the horizon: no moonlight"
    elif depth > 0.0:
        below = "; it is below the horizontal: only places towards it are lit"
    lines = [
        f"Sun               zenith {math.degrees(sun.zenith):.2f} deg, azimuth {math.degrees(sun.azimuth) % 360.0:.2f} deg",
        f"Moon              zenith {zenith:.2f} deg, azimuth {azimuth % 360.0:.2f} deg, phase {phase:.1f} deg "
        f"({100.0 * moon.lit_share:.0f} % lit), radius {radius:.3f} deg{below}",
    ]
    if moon.phase < ECLIPSED and not (scenario.moon is None or scenario.moon.given):
        lines.append("note              the Moon may be in the Earth's shadow: eclipses are left out")
    return lines


def camera_lines(scenario: Mapping[str, Any]) -> list[str]:
    """Return lines of text on the camera, scene and objects of a scenario, given as one table."""
    sensor, band = scenario["sensor"], scenario["band"]
    (nx, ny), (width, height) = sensor["pixels"], sensor["fov_deg"]
    edges = f"{decimals(band['min_um'], 3)} to {decimals(band['max_um'], 3)} um" if "min_um" in band else f"band of {band['response']}"
    out = [
        f"camera            {nx} x {ny} pixels over {width:.4g} x {height:.4g} deg, {edges}, "
        f"{'counts of a ' + sensor['detector']['kind'] + ' detector' if sensor.get('detector') else 'radiance at the aperture'}",
        f"looks             from {decimals(sensor['height_m'])} m to azimuth {decimals(sensor['azimuth_deg'])}, "
        f"elevation {decimals(sensor['elevation_deg'])} deg, {sensor['frames']} frames at {decimals(sensor['frame_rate_hz'], 3)} Hz",
        f"scene             {scene_line(scenario)}",
    ]
    if objects := [str(item.get("name", "")) for item in scenario.get("objects", ())]:
        shown = ", ".join(objects[:5]) + (", ..." if len(objects) > 5 else "")
        out.append(f"objects           {len(objects)}: {shown}")
    return out


def scene_line(scenario: Mapping[str, Any]) -> str:
    """Return wind, Sun, sea and air of a scenario, as one table, in a line."""
    wind, sun, air = scenario["wind"], scenario.get("sun"), scenario["atmosphere"]
    time, place = scenario.get("time"), scenario.get("place")
    if sun:
        light = f"Sun {decimals(sun['zenith_deg'])} deg from the zenith towards azimuth {decimals(sun['azimuth_deg'])}"
    elif time and place:
        light = f"Sun of {time['utc']} at {decimals(place['latitude_deg'])}, {decimals(place['longitude_deg'])} deg"
    else:
        light = "Sun by time and place"
    if (moon := scenario.get("moon")) is not None:
        light += "; Moon"
        if "zenith_deg" in moon:
            light += f" {decimals(moon['zenith_deg'])} deg from the zenith, phase {decimals(moon['phase_deg'])} deg"
    name = air.get("model") or air["source"]
    if air.get("sounding"):
        name = f"of {Path(str(air['sounding'])).name}, continued by {name}"
    return (
        f"wind {decimals(wind['speed_m_s'])} m/s from {decimals(wind['from_deg'])} deg; {light}; "
        f"sea at {decimals(scenario['sea']['temperature_k'])} K{_with_foam(scenario)}; air {name}"
    )


def _with_foam(scenario: Mapping[str, Any]) -> str:
    """Return the share of foam and its law as words of a line; nothing for a sea without foam."""
    foam = scenario["sea"].get("foam")
    if not foam:
        return ""
    from seaglint.sea.foam.coverage_laws import coverage

    share = coverage(foam["law"], scenario["wind"]["speed_m_s"], extrapolate=foam["extrapolate"])
    return f", {100.0 * share:.3g} % foam ({foam['law']})"


def describe_recording(path: Path, variable: str | None = None, channel: str | None = None, axes: str | None = None) -> RecordingFacts:
    """Return facts about images of any format that ``seaglint analyze`` reads; of several channels the first by default.

    Raises
    ------
    DataError
        No recording, or a damaged one.
    """
    import numpy as np

    from seaglint.formats.recording import open_recording
    from seaglint.formats.recording.stored_values import SeveralChannelsError

    try:
        recording = open_recording(path, variable=variable, channel=channel, axes=axes)
    except SeveralChannelsError:
        recording = open_recording(path, variable=variable, channel="1", axes=axes)
    # Recordings may subtract an offset to preserve precision; it is added again.
    first = recording.read(0, 1)[0].astype(float) + recording.offset
    known = first[np.isfinite(first)]
    return RecordingFacts(
        str(path),
        recording.frames,
        recording.rows,
        recording.columns,
        recording.units,
        recording.frame_rate,
        float(known.min()) if known.size else None,
        float(known.max()) if known.size else None,
        list(recording.notes),
    )


_HIDDEN = frozenset(
    {"scenario", "band_wavelength_um", "band_response", "Conventions", "title", "seaglint_format", "frame_rate_hz", "seed", "unfinished"}
)
_BOOKS = frozenset({"frame_checksum", "frame_done", "wavelength_bounds"})  #: Variables for bookkeeping, which are not listed by default.


@dataclass(frozen=True)
class SequenceFrames:
    """Frames of a sequence: their number, the number of written frames, completeness, the first number, and the rate [Hz]."""

    frames: int
    frames_done: int
    complete: bool
    first_frame: int
    frame_rate_hz: float


@dataclass(frozen=True)
class PictureDirections:
    """Directions and band of a picture."""

    azimuth_deg: list[float]  #: Azimuths of the first and last column; of a picture that is turned, their limits [deg].
    elevation_deg: list[float]  #: Elevations of the first and last row; of a picture that is turned, their limits [deg].
    band_um: list[float]  #: Limits of the band [um].


@dataclass(frozen=True)
class FileFacts:
    """Contents of an output file."""

    path: str  #: Path of the file.
    title: str  #: Title.
    variables: list[str]  #: Names of its variables.
    frames: SequenceFrames | None  #: Frames of a sequence; None of a map.
    pixels: list[int]  #: Columns and rows.
    directions: PictureDirections | None  #: Directions and band; None of a texture, whose pixels have neither.
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
    """Arrays of this program that are no pictures: a sweep, the air along paths, a map of chances."""

    path: str  #: Path of the file.
    title: str  #: Title.
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
    out += [*_scene(facts.scenario), f"  file              {facts.bytes / 1e6:.1f} MB"]
    return [*out, *_making(facts, everything)]


def _scene(scenario: JsonObject | None) -> list[str]:
    """Return the line on the scene; none for a scenario that is missing, of an older version, or damaged."""
    with suppress(KeyError, TypeError, ValueError):
        return [] if scenario is None else [f"  scene             {scene_line(scenario)}"]
    return []


def _making(facts: FileFacts | ArrayFile, everything: bool) -> list[str]:
    """Return the attributes on the making of a file, or the command that prints them."""
    if everything:
        return [f"  {key:17} {value}" for key, value in facts.provenance.items()]
    return [f"  how it was made   seaglint info --all {facts.path}"]


def describe(path: Path | str) -> FileFacts | ArrayFile:
    """Return facts about an output file.

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
        except Exception as error:  # contents of a damaged file may be of any type, and h5py raises errors of many types
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
    done = len(images(dataset))
    frames = _frames(dataset, radiance.sizes["time"], done) if "time" in radiance.dims else None
    saturated = None
    if "saturated_share" in dataset:
        shares = dataset["saturated_share"].to_numpy()
        # NaN is unequal to itself: frames that are not written are left out.
        saturated = [float(share) for share in shares[shares == shares]]
    return FileFacts(
        path=str(path),
        title=dataset.attrs.get("title", ""),
        variables=sorted(map(str, dataset.data_vars)),
        frames=frames,
        pixels=[int(radiance.sizes["x"]), int(radiance.sizes["y"])],
        directions=PictureDirections(
            [float(azimuth[0]), float(azimuth[-1])] if upright else [float(azimuth.min()), float(azimuth.max())],
            # The first row is the top, so elevations of a turned picture begin with the maximum too.
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
    """Return the facts of a loop of a texture, whose pixels have no direction and no band."""
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


def _frames(dataset: xr.Dataset, count: int, done: int) -> SequenceFrames:
    return SequenceFrames(count, done, done == count, int(dataset["frame"][0]), float(dataset.attrs["frame_rate_hz"]))


def _provenance(dataset: xr.Dataset) -> JsonObject:
    return {k: v.tolist() if hasattr(v, "tolist") else v for k, v in dataset.attrs.items() if k not in _HIDDEN}


def lines(facts: FileFacts | ArrayFile, *, everything: bool = False) -> list[str]:
    """Return the facts as at most ten lines of text, or with ``everything`` also all attributes on its making."""
    if isinstance(facts, ArrayFile):
        return _array_lines(facts, everything)
    nx, ny = facts.pixels
    out = [f"{facts.path}: {facts.title}"]
    if (frames := facts.frames) is not None:
        state = "complete" if frames.complete else f"UNFINISHED, {frames.frames_done} done"
        out.append(
            f"  frames            {frames.frames} from number {frames.first_frame} at {decimals(frames.frame_rate_hz, 3)} Hz, {state}"
        )
    if facts.directions is not None:
        view = facts.directions
        # First and last column, first and last row, both ends of the band.
        (a0, a1), (e0, e1), (w0, w1) = view.azimuth_deg, view.elevation_deg, view.band_um
        # Decimals of a pixel's width; two where a column is the only one.
        pitch = abs(a1 - a0) / (nx - 1) if nx > 1 else 0.0
        fine = min(max(math.ceil(-math.log10(pitch)), 0), 6) if pitch else 2
        azimuths, elevations = (f"{decimals(first, fine)} to {decimals(last, fine)} deg" for first, last in ((a0, a1), (e0, e1)))
        out += [
            f"  pixels            {nx} x {ny}: azimuth {azimuths}, elevation {elevations}",
            f"  band              {decimals(w0, 3)} to {decimals(w1, 3)} um",
        ]
    else:
        out.append(f"  pixels            {nx} x {ny}, periodic along every axis")
    out += _scene(facts.scenario)
    if facts.summary is not None:
        out.append(f"  radiance          {facts.summary.line}")
    if shares := facts.saturated_share:
        out.append(
            f"  saturated         {100 * sum(shares) / len(shares):.3g} % of the pixels, {100 * max(shares):.3g} % in the worst frame"
        )
    named = facts.variables if everything else [name for name in facts.variables if name not in _BOOKS]
    out += [f"  variables         {', '.join(named)}", f"  file              {facts.bytes / 1e6:.1f} MB, seed {facts.seed}"]
    return [*out, *_making(facts, everything)] if facts.provenance else out
