"""Downloads of the viewer: a frame as picture or numbers, a clip, and statistics as a table."""

from __future__ import annotations

import io
import json
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import numpy as np

from seaglint.base.brightness import Scale
from seaglint.base.errors import DataError
from seaglint.base.free_form import JsonObject
from seaglint.base.optional import optional
from seaglint.files.tables.table_text import csv_text
from seaglint.plot.video import Colours, palette, write_video
from seaglint.viewer.picture import Scales, Show

MOST_CLIP: Final = 400_000_000  #: Largest size of a clip's frames in memory [bytes].

TYPES: Final = {".png": "image/png", ".npy": "application/octet-stream", ".tif": "image/tiff"}  #: Media types by ending.


def frame_file(show: Show, index: int, ending: str, scaling: Scale, colours: Colours) -> bytes:
    """Return one frame as a file: PNG as shown, one pixel a pixel; NumPy or TIFF with the values and their unit.

    Raises
    ------
    DataError
        An unknown ending.
    """
    image = show.image(index)
    out = io.BytesIO()
    if ending == ".png":
        from PIL import Image
        from PIL.PngImagePlugin import PngInfo

        chosen, about = show.source.layer(show.layer), PngInfo()
        about.add_text("Description", f"{chosen.label} [{chosen.unit}], frame {index}, {scaling.low:.6g} to {scaling.high:.6g}")
        Image.fromarray(palette(colours)[scaling.levels(image)]).save(out, "PNG", pnginfo=about)
    elif ending == ".npy":
        np.save(out, image)
    elif ending == ".tif":
        tifffile = optional("tifffile", "TIFF")

        chosen = show.source.layer(show.layer)
        about_text = json.dumps({"name": chosen.name, "long_name": chosen.label, "units": chosen.unit, "frame": index}, ensure_ascii=True)
        tifffile.imwrite(out, image.astype(np.float32), description=about_text, metadata=None)
    else:
        raise DataError(f"{ending}: a frame is saved as {', '.join(TYPES)}; choose one of them")
    return out.getvalue()


def clip(show: Show, first: int, last: int, scales: Scales, colours: Colours) -> bytes:
    """Return frames ``first`` to ``last`` (included) as MP4, on one linear scale between the limits of the displayed scale.

    Raises
    ------
    DataError
        No such frames, or more than fit into memory.
    BackendError
        PyAV is not installed.
    """
    import xarray as xr

    opened, chosen = show.source.opened, show.source.layer(show.layer)
    done = show.source.done()
    frames = done[(done >= first) & (done <= last)]
    if not frames.size:
        raise DataError(f"clip of frames {first} to {last}: none of them is there; choose others")
    most = max(MOST_CLIP // (4 * opened.rows * opened.columns), 1)
    if frames.size > most:
        raise DataError(f"clip of {frames.size} frames: at most {most} of this size; choose fewer, or use 'seaglint export'")
    scaling = scales.of(show, int(frames[0]))
    low, high = scaling.low, scaling.high if scaling.high > scaling.low else scaling.low + 1.0
    block = np.stack([show.image(int(index)).astype(np.float32) for index in frames])
    times = frames / (opened.frame_rate or 25.0) if opened.times is None else opened.times[frames]
    name = chosen.name
    dataset = xr.Dataset({name: (("time", "y", "x"), block, {"units": chosen.unit})}, coords={"time": times})
    with tempfile.TemporaryDirectory(prefix="seaglint-clip-") as folder:
        made = Path(folder) / "clip.mp4"
        write_video(dataset, made, variable=name, colours=colours, limits=(low, high), rate=opened.frame_rate)
        return made.read_bytes()


def table(result: JsonObject) -> str:
    """Return statistics as CSV, one row for each number: ``fits.gamma.shape,3.21``."""
    return csv_text([("quantity", "value"), *_flat("", result)])


def _flat(prefix: str, value: Any) -> Iterator[tuple[str, Any]]:
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from _flat(f"{prefix}.{key}" if prefix else str(key), inner)
    elif isinstance(value, list):
        for place, inner in enumerate(value):
            yield from _flat(f"{prefix}[{place}]", inner)
    else:
        yield prefix, "" if value is None else value
