"""Values of options that are small files or layouts of files: weights, masks, raw layouts."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

RAW_NAMES = ("rows", "columns", "dtype", "byte_order", "offset", "frame_header")


def weights(path: Path) -> NDArray[np.float64]:
    """Numbers of a small CSV or NumPy file."""
    import numpy as np

    from seaglint.base.errors import DataError
    from seaglint.files.text_file import read_text

    try:
        if path.suffix == ".npy":
            return np.asarray(np.load(path, allow_pickle=False), dtype=np.float64)
        text = read_text(path, "give a CSV or .npy file").replace(";", " ").replace(",", " ")
        return np.loadtxt(text.splitlines(), dtype=np.float64, ndmin=2)
    except (OSError, ValueError) as error:
        raise DataError(f"{path}: cannot be read as rows of numbers ({str(error).splitlines()[0]}); give a CSV or .npy file") from error


def read_mask(path: Path) -> NDArray[np.bool_]:
    """Mask from an image or a NumPy file: true where it is not zero."""
    import numpy as np

    from seaglint.base.errors import DataError
    from seaglint.files.recording import open_recording

    opened = open_recording(path, channel=None)
    if opened.frames != 1:
        raise DataError(f"{path}: a mask is one image, this has {opened.frames} frames")
    return np.asarray(np.nan_to_num(opened.read(0, 1)[0]) != 0.0)


def raw_layout(text: str | None) -> Any:
    """Layout of a raw file from ``name=value`` pairs; None where nothing is said."""
    if text is None:
        return None
    from seaglint.base.errors import DataError
    from seaglint.files.recording import RawLayout

    table: dict[str, Any] = {}
    for pair in text.split(","):
        name, sign, value = (part.strip() for part in pair.partition("="))
        if not sign:
            raise DataError(f"--raw {text}: give name=value pairs of {', '.join(RAW_NAMES)}, separated by commas")
        table[name] = _typed(value)
    return RawLayout.of(table, "--raw")


def _typed(value: str) -> int | float | str:
    """A whole number, a number, or text."""
    for kind in (int, float):
        try:
            return kind(value)
        except ValueError:
            continue
    return value
