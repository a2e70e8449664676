"""What the functions of ``import seaglint as sg`` take in many forms, brought into one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from seaglint.analysis import Options, Recording


def options_of(given: Mapping[str, Any]) -> Options:
    """Fields of the record; filters and detectors by name, sequences as tuples, masks as plain arrays."""
    from typing import get_args

    import numpy as np

    from seaglint.analysis import Options
    from seaglint.analysis.run import Border
    from seaglint.clutter import filters
    from seaglint.clutter.thresholds import Scope
    from seaglint.detection import choice
    from seaglint.errors import DataError

    known = [field.name for field in fields(Options)]
    for name in given:
        if name not in known:
            raise DataError(f"option '{name}' is not one of {', '.join(known)}; leave it out or give one of them")
    for name, allowed in (("scope", get_args(Scope)), ("border", get_args(Border))):
        if name in given and given[name] not in allowed:
            raise DataError(f"{name} = {given[name]!r} is not one of {', '.join(allowed)}; give one of them or leave it out")
    out: dict[str, Any] = {name: tuple(value) if isinstance(value, list) else value for name, value in given.items()}
    if isinstance(out.get("filter"), str):
        out["filter"] = filters.named(out["filter"])
    if "detectors" in out:
        wanted = (out["detectors"],) if isinstance(out["detectors"], str) else out["detectors"]
        out["detectors"] = tuple(choice.named(d) if isinstance(d, str) else d for d in wanted)
    if out.get("mask") is not None:
        out["mask"] = np.asarray(out["mask"], dtype=np.bool_)
    return Options(**out)


def recording_of(given: Any, frame_rate: float | None, units: str | None, variable: str | None) -> Recording:
    """What is analysed, from a file or from memory."""
    from dataclasses import replace

    import numpy as np
    import xarray as xr

    from seaglint.analysis import Recording
    from seaglint.io.recording import open_recording
    from seaglint.io.recording.arrays import Reading, of_array, of_dataset

    if isinstance(given, str | Path):
        return open_recording(given, frame_rate=frame_rate, units=units, variable=variable)
    if isinstance(given, xr.DataArray):
        given = given.to_dataset(name=str(given.name or "values"))
    if isinstance(given, xr.Dataset):
        ordered = given.transpose("time", ...) if "time" in given.dims else given
        found = of_dataset(ordered, "dataset", Reading(variable))
    elif isinstance(given, Recording):
        found = given
    else:
        found = of_array(np.asarray(given), "array", Reading(), frame_rate=frame_rate, units=units)
    return replace(found, frame_rate=frame_rate or found.frame_rate, units=units or found.units)
