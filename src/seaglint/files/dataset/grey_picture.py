"""Grey pictures as PNG or TIFF with their scale: as PNG text, or as JSON in a TIFF's ImageDescription."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import BackendError, DataError
from seaglint.base.optional import optional
from seaglint.files.outputs import moved_when_whole

ImageKind = Literal["png", "tiff"]


def write_picture(path: Path, levels: NDArray[Any], about: Mapping[str, Any]) -> None:
    """Write levels [uint8 or uint16, (rows, columns)]; equal levels and text are equal bytes.

    Raises
    ------
    StorageError
        No room or no rights; nothing is left behind.
    """
    with moved_when_whole(path) as partial:
        if path.suffix == ".png":
            from PIL import Image
            from PIL.PngImagePlugin import PngInfo

            text = PngInfo()
            for name, value in about.items():
                text.add_text(name, repr(value) if isinstance(value, float) else str(value))
            Image.fromarray(levels).save(partial, format="PNG", pnginfo=text, compress_level=6)
        else:
            tifffile = optional("tifffile", f"{path}: TIFF")

            with tifffile.TiffWriter(partial) as file:
                # no date and no program: the same picture is the same file
                file.write(levels, photometric="minisblack", metadata=None, software="seaglint", description=json.dumps(dict(about)))


def read_picture(path: Path) -> NDArray[Any]:
    """Read the levels of a picture [(rows, columns)].

    Raises
    ------
    DataError
        It is not there, cannot be read, or is no grey picture.
    """
    try:
        if path.suffix == ".png":
            from PIL import Image

            with Image.open(path) as image:
                grey = image.mode in ("L", "I;16")
                levels = np.asarray(image)
        else:
            tifffile = optional("tifffile", f"{path}: TIFF")

            levels = tifffile.imread(path)
            grey = levels.ndim == 2
    except BackendError:
        raise
    except Exception as error:  # whatever a reader finds wrong with it
        raise DataError(f"{path}: cannot be read as a picture ({type(error).__name__}: {error})") from error
    if not grey:
        raise DataError(f"{path}: is no grey picture of 8 or 16 bits")
    return levels


def read_about(path: Path) -> dict[str, str]:
    """Read the text of a picture by name."""
    if path.suffix == ".png":
        from PIL import Image

        with Image.open(path) as image:
            image.load()
            return {str(name): str(value) for name, value in image.info.items()}
    tifffile = optional("tifffile", f"{path}: TIFF")

    with tifffile.TiffFile(path) as file:
        return {name: str(value) for name, value in json.loads(file.pages.first.description).items()}
