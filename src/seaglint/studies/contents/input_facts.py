"""Contents of files that are given to commands: scenarios, recordings of others, plain arrays."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from seaglint.base.free_form import JsonObject


@dataclass(frozen=True)
class ScenarioFacts:
    """Contents of a scenario file or an ensemble file."""

    path: str  #: The file.
    kind: str  #: "scenario" or "ensemble".
    about: list[str]  #: What it describes, a line each.

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
    #: ``frames``, ``rows``, ``columns``: Size.
    frames: int
    rows: int
    columns: int
    units: str | None  #: Units of the values, where the file says them.
    frame_rate_hz: float | None  #: Frames per second, where the file says them.
    #: ``least``, ``most``: Smallest and largest value of the first frame; None where it has none.
    least: float | None
    most: float | None
    notes: list[str]  #: Notes on the format.

    @property
    def lines(self) -> list[str]:
        """Return the facts as lines of text."""
        unit = self.units or "no unit"
        rate = f"{self.frame_rate_hz:g} Hz" if self.frame_rate_hz else "no frame rate"
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
    """Return true for one of our stores or maps, and for what is to be read as one: a URL, a Zarr folder, NetCDF, nothing at all."""
    if not isinstance(path, Path) or not path.exists():
        return not str(path).endswith(".toml")
    if path.is_dir():
        from seaglint.files.recording.labelled import is_zarr
        from seaglint.files.store.store import is_sequence

        return is_sequence(path) or (path.suffix.lower() == ".zarr" and not (is_zarr(path) and _is_of_others(path)))
    return path.suffix.lower() == "" or (path.suffix.lower() in (".nc", ".nc4") and not _is_of_others(path))


def _is_of_others(path: Path) -> bool:
    """Return true for images of another program: a file or store that opens and holds none of our pictures."""
    from seaglint.base.errors import SeaglintError
    from seaglint.base.schema import IMAGES
    from seaglint.files.netcdf import open_netcdf

    try:
        if path.is_dir():
            import zarr

            node = zarr.open(str(path), mode="r")
            return isinstance(node, zarr.Array) or not set(IMAGES) & {name for name, _ in node.members()}
        with open_netcdf(path, decode_times=False) as dataset:
            return "seaglint_version" not in dataset.attrs and not set(IMAGES) & {str(name) for name in dataset.data_vars}
    except (SeaglintError, OSError, ValueError, KeyError):
        return False  # what cannot be opened is reported by the reader of our own files


def describe_scenario(path: Path) -> ScenarioFacts:
    """Facts about a scenario file, or an ensemble file.

    Raises
    ------
    ScenarioError
        It is neither.
    """
    import tomllib

    from seaglint.scenario.load import load_scenario

    try:
        raw = tomllib.loads(path.read_bytes().decode("utf-8-sig"))
    except (OSError, ValueError, RecursionError):
        raw = {}  # told by the reader of scenarios
    if "ensemble" in raw:
        from seaglint.scenario.ensemble_file import load_ensemble

        ensemble = load_ensemble(path).ensemble
        keys = [str(vary["key"]) for vary in raw.get("vary", [])]
        return ScenarioFacts(str(path), "ensemble", [f"{ensemble.scenes} scenes; drawn for each: {', '.join(keys) or 'the seed alone'}"])
    scenario = load_scenario(path)
    return ScenarioFacts(str(path), "scenario", [*camera_lines(scenario.model_dump(mode="json", exclude_none=True))])


def camera_lines(scenario: Mapping[str, Any]) -> list[str]:
    """Return the lines that say what a scenario, as one table, describes: camera, scene, objects."""
    sensor, band = scenario["sensor"], scenario["band"]
    (nx, ny), (width, height) = sensor["pixels"], sensor["fov_deg"]
    edges = f"{band['min_um']:g} to {band['max_um']:g} um" if "min_um" in band else f"band of {band['response']}"
    out = [
        f"camera            {nx} x {ny} pixels over {width:.4g} x {height:.4g} deg, {edges}, "
        f"{'counts of a ' + sensor['detector']['kind'] + ' detector' if sensor.get('detector') else 'radiance at the aperture'}",
        f"looks             from {sensor['height_m']:g} m to azimuth {sensor['azimuth_deg']:g}, elevation {sensor['elevation_deg']:g} deg, "
        f"{sensor['frames']} frames at {sensor['frame_rate_hz']:g} Hz",
        f"scene             {scene_line(scenario)}",
    ]
    objects = [str(item.get("name", "")) for item in scenario.get("objects", ())]
    if objects:
        shown = ", ".join(objects[:5]) + (", ..." if len(objects) > 5 else "")
        out.append(f"objects           {len(objects)}: {shown}")
    return out


def scene_line(scenario: Mapping[str, Any]) -> str:
    """Return wind, Sun, sea and air of a scenario, as one table, in a line."""
    wind, sun, air = scenario["wind"], scenario.get("sun"), scenario["atmosphere"]
    time, place = scenario.get("time"), scenario.get("place")
    if sun:
        light = f"Sun {sun['zenith_deg']:g} deg from the zenith towards azimuth {sun['azimuth_deg']:g}"
    elif time and place:
        light = f"Sun of {time['utc']} at {place['latitude_deg']:g}, {place['longitude_deg']:g} deg"
    else:
        light = "Sun by time and place"
    name = air.get("model") or air["source"]
    if air.get("sounding"):
        name = f"of {Path(str(air['sounding'])).name}, continued by {name}"
    return (
        f"wind {wind['speed_m_s']:g} m/s from {wind['from_deg']:g} deg; {light}; sea at {scenario['sea']['temperature_k']:g} K; air {name}"
    )


def describe_recording(path: Path, variable: str | None = None, channel: str | None = None, axes: str | None = None) -> RecordingFacts:
    """Facts about images of any format that ``seaglint analyze`` reads; of several channels the first without a request.

    Raises
    ------
    DataError
        No recording, or a damaged one.
    """
    import numpy as np

    from seaglint.files.recording import open_recording
    from seaglint.files.recording.stored import SeveralChannelsError

    try:
        recording = open_recording(path, variable=variable, channel=channel, axes=axes)
    except SeveralChannelsError:
        recording = open_recording(path, variable=variable, channel="1", axes=axes)
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
