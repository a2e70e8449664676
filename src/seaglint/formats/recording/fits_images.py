"""Reader of FITS: one image of a file, or several of one name as frames; also compressed (``.fits.gz``, ``.fits.fz``).

References
----------
FITS standard 4.0: BSCALE, BZERO and BLANK (4.4.2.5), EXTNAME and EXTVER (4.4.2.6), CTYPE, CUNIT and CDELT (8.2), ZQUANTIZ (10.2).
"""

from __future__ import annotations

import warnings
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.analysis.recording import Recording
from seaglint.base.errors import DataError
from seaglint.base.optional import optional
from seaglint.formats.recording.arrays import ArrayFacts, ArrayReading, joined, of_array, text_of
from seaglint.formats.recording.frame_axes import one_rate, seconds_in
from seaglint.formats.recording.stored_values import Decoding, in_type

ENDINGS: Final = (".fits", ".fit", ".fts", ".fits.gz", ".fit.gz", ".fts.gz", ".fits.fz", ".fit.fz", ".fz")

_RATES: Final = ("FRMRATE", "FRATE", "FPS", "FRAMERAT")  #: Cards of a frame rate [Hz].

_TIMES: Final = ("TIME", "UTC", "TAI", "TT")
_LISTED: Final = 6


def open_fits(path: Path, how: ArrayReading) -> Recording:
    """Open an image of a FITS file: the first with data, or ``variable``; rows stay in the order of the file.

    ``variable`` is a name (``SCI``), a name and version (``SCI,2``), the number of an extension (``2``), ``SCI,*`` for all images of one
    name as frames, or ``*`` for all images of the file.

    Raises
    ------
    DataError
        No such image, images that differ in shape or units, or a file that is cut.
    """
    fits = optional("astropy.io.fits", f"{path}: FITS")

    with path.open("rb") as opened:
        head = opened.read(6)
    if head != b"SIMPLE" and not head.startswith(b"\x1f\x8b"):
        raise DataError(f"{path}: is no FITS file, which begins with SIMPLE; give a FITS file, or another ending")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # warnings of cards that are not used; the used ones are checked here
            file = fits.open(path, memmap=True, do_not_scale_image_data=True)  # scaled memory maps are refused
            images = {i: hdu for i, hdu in enumerate(file) if hdu.is_image and hdu.header.get("NAXIS", 0) >= 2 and _has_data(hdu)}
            labels = _labels(images)
    except Exception as error:
        raise DataError(f"{path}: cannot be read as FITS ({error})") from error
    chosen = _chosen(images, labels, how.variable, path)
    try:
        if len(chosen) > 1:
            return joined([_image(images[i], f"{path}:{labels[i]}", how) for i in chosen], f"{path}:{how.variable}")
        recording = _image(images[chosen[0]], f"{path}:{labels[chosen[0]]}", how)
    except (TypeError, ValueError, OSError) as error:
        raise DataError(f"{path}: is cut ({error}); copy it again") from error
    others = [f"{labels[i]} ({' x '.join(map(str, images[i].shape))})" for i in images if i != chosen[0]]
    if others and how.variable is None:
        listed = ", ".join(others[:_LISTED]) + (", ..." if len(others) > _LISTED else "")
        alike = [labels[i].partition(",")[0] for i in images]
        every = f"{alike[0]},*" if alike.count(alike[0]) > 1 else "*"
        all_of = f", '{every}' all of {'one name' if every != '*' else 'them'} as frames"
        recording = recording.with_notes(f"{labels[chosen[0]]} is read; the file also holds {listed} (--variable reads another{all_of})")
    return recording


def _has_data(hdu: Any) -> bool:
    return all(int(hdu.header.get(f"NAXIS{i + 1}", 0)) > 0 for i in range(int(hdu.header["NAXIS"])))


def _labels(images: dict[int, Any]) -> dict[int, str]:
    """Return a name for each image: EXTNAME, with its version where it is not the only one, or the number of the extension."""
    names = {i: str(hdu.name or "").strip() for i, hdu in images.items()}
    count = Counter(names.values())
    versions = {i: int(hdu.header.get("EXTVER", 1)) for i, hdu in images.items()}
    counted: Counter[str] = Counter()
    labels = {}
    for i, name in names.items():
        counted[name] += 1
        same = [versions[j] for j in images if names[j] == name]
        # Versions that repeat distinguish no images: the images of one name are counted.
        version = versions[i] if len(set(same)) == len(same) else counted[name]
        labels[i] = f"extension {i}" if not name else name if count[name] == 1 and version == 1 else f"{name},{version}"
    return labels


def _chosen(images: dict[int, Any], labels: dict[int, str], requested: str | None, path: Path) -> list[int]:
    if not images:
        raise DataError(f"{path}: no image variable (none); give a FITS file with an image of two axes or more")
    if requested is None:
        return [next(iter(images))]
    name, _, version = (part.strip() for part in requested.strip("[]").partition(","))
    if requested.strip() == "*":
        return list(images)
    same = [i for i in images if labels[i].partition(",")[0].upper() == name.upper()]
    if version == "*" and same:
        return same
    if not version:
        if same:
            return same[:1]
        if name.isdecimal() and int(name) in images:
            return [int(name)]
    exact = [i for i in same if labels[i].upper() == f"{name},{version}".upper() or (version == "1" and "," not in labels[i])]
    if exact:
        return exact
    available = ", ".join(label if label.endswith(f" {i}") else f"{label} (or {i})" for i, label in labels.items())
    raise DataError(f"{path}: has no image variable '{requested}'; it has {available}")


def _image(hdu: Any, source: str, how: ArrayReading) -> Recording:
    """Return the recording of one image."""
    header = hdu.header
    if header.get("GROUPS") is True:
        raise DataError(f"{source}: holds random groups, which are no images; write them as an image")
    bits, scale, zero = int(header["BITPIX"]), float(header.get("BSCALE", 1.0)), float(header.get("BZERO", 0.0))
    notes: list[str] = []
    blank = header.get("BLANK")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        stored = hdu.data
    if blank is not None and bits < 0:
        notes.append(f"BLANK = {blank} holds for integers only and is ignored in floats")
        blank = None
    if str(header.get("ZQUANTIZ", "NONE")).strip().upper() not in ("NONE", "") or _quantised(hdu):
        notes.append("floats were rounded when the file was compressed: small differences and tails are those of the rounded values")
    if header.get("BAYERPAT") or header.get("COLORTYP"):
        notes.append("pixels stand under a mosaic of colour filters: neighbours are of different colours")
    if str(header.get("ROWORDER", "")).strip().upper() == "BOTTOM-UP":
        notes.append("the first row of the file is the lowest one (ROWORDER): pictures are upside down")
    if isinstance(stored, np.ndarray) and stored.dtype.kind == "f" and bits > 0:  # compressed images come scaled
        scale, zero, blank = 1.0, 0.0, None
    integers = stored.dtype.kind in "iu"
    unsigned = bits in (8, 16, 32) and scale == 1.0 and zero == (-128.0 if bits == 8 else 2.0 ** (bits - 1)) and integers
    missing = in_type([] if blank is None else [blank], stored.dtype)
    decoding = Decoding(missing, scale=scale, offset=zero)
    # FITS has signed integers only: 16 bits of a camera are stored with an offset of half the scale.
    full = 2.0**bits - 1.0 if unsigned and bits in (16, 32) else 127.0 if unsigned else None
    limit = header.get("SATURATE", header.get("SATLEVEL"))
    if isinstance(limit, int | float) and not isinstance(limit, bool) and np.isfinite(limit) and limit > 0:
        full = float(limit)
    rate, rate_notes = _frame_rate(header)
    facts = ArrayFacts(
        _axes(header, stored.ndim),
        frame_rate=rate, units=text_of(header.get("BUNIT")), decoding=decoding, saturation=full, notes=(*notes, *rate_notes),
    )  # fmt: skip
    array: Any = stored
    # Without missing values integers stay integers; with them the result has NaN and is of floats.
    if unsigned and not missing:
        array, facts = _Shifted(stored, zero), replace(facts, decoding=Decoding())
    return of_array(array, source, how, facts)


def _quantised(hdu: Any) -> bool:
    """Return true for floats of a compressed image that were made integers."""
    compressed = getattr(hdu, "_bintable", None)
    if compressed is None or int(hdu.header["BITPIX"]) > 0:
        return False
    return "ZSCALE" in [column.name for column in compressed.columns] or "ZSCALE" in compressed.header


class _Shifted:
    """Integers of the other sign: the offset is added exactly."""

    def __init__(self, stored: Any, zero: float) -> None:
        self._stored, self.shape = stored, stored.shape
        self._zero, size = int(zero), stored.dtype.itemsize
        self.dtype = np.dtype(f"{'u' if zero > 0 else 'i'}{size}")

    def __getitem__(self, key: Any) -> NDArray[Any]:
        return (np.asarray(self._stored[key]).astype(np.int64) + self._zero).astype(self.dtype)


def _frame_rate(header: Any) -> tuple[float | None, tuple[str, ...]]:
    """Return the frame rate [Hz] of a card or of a time axis, or a note where they contradict each other."""
    rates: dict[str, float] = {}
    for name in _RATES:
        value = header.get(name)
        if isinstance(value, int | float) and not isinstance(value, bool) and np.isfinite(value) and value > 0.0:
            rates[name] = float(value)
    why: tuple[str, ...] = ()
    for i in range(3, int(header["NAXIS"]) + 1):
        step = header.get(f"CDELT{i}", header.get(f"CD{i}_{i}"))
        if str(header.get(f"CTYPE{i}", "")).strip().upper() not in _TIMES or not isinstance(step, int | float) or step <= 0.0:
            continue
        unit = str(header.get(f"CUNIT{i}", header.get("TIMEUNIT", "s"))).strip() or "s"
        seconds = seconds_in(unit)
        if seconds is None:
            why = (f"CUNIT{i} = '{unit}' is no unit of time that is read; give --frame-rate",)
        else:
            rates[f"CDELT{i}"] = 1.0 / (float(step) * seconds)
    rate, contradiction = one_rate(rates)
    return rate, (*why, *contradiction)


def _axes(header: Any, count: int) -> tuple[str, ...]:
    """Return names of the axes of an array in its order, as far as the cards name the third and further axes."""
    names = ["x", "y"]
    for i in range(3, count + 1):
        kind = str(header.get(f"CTYPE{i}", "")).strip().upper()
        if kind in _TIMES:
            names.append("t")
        elif kind in ("RGB", "RGBA", "COLOR"):
            names.append("rgb")
        elif kind.partition("-")[0] in ("STOKES", "WAVE", "FREQ", "AWAV", "BAND", "CHANNEL", "ENER", "WAVN"):
            names.append("c")
        elif int(header[f"NAXIS{i}"]) == 1:
            names.append("-")
        else:
            names.append("" if "t" in names else "t" if count == 3 and not kind else "")
    return tuple(names[::-1]) if all(names) and {"c", "rgb"} & set(names) else ()
