"""Regions of a picture: rectangle, ellipse and polygon, as text of a request, as CSV, and as files of ImageJ.

Places are columns and rows as fractions of pixels, and pixel ``n`` spans ``n`` to ``n + 1``, as in ImageJ. A pixel belongs to a region if
its centre lies inside.
"""

from __future__ import annotations

import csv
import io
import math
import re
import zipfile
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import DataError
from seaglint.base.optional import optional
from seaglint.formats.tables.table_text import csv_text

BoolArray = NDArray[np.bool_]
Floats = NDArray[np.float64]

Shape = Literal["rectangle", "ellipse", "polygon"]
SHAPES: Final[tuple[Shape, ...]] = get_args(Shape)

MOST_CORNERS: Final = 10_000  #: Largest number of corners of a polygon.

MOST_REGIONS: Final = 100  #: Largest number of regions of a file or a request.

#: Largest number of numbers of all these regions: they have to fit into one request.
MOST_NUMBERS: Final = 40_000

MOST_ARCHIVE: Final = 5_000_000  #: Largest size of an uploaded archive's content [bytes].

_FURTHEST: Final = 1e9  #: Largest coordinate [px]: a region may reach beyond the image, but not beyond what array indices hold.

_HEAD: Final = ("name", "shape", "numbers")


@dataclass(frozen=True)
class PictureRegion:
    """Part of a picture.

    The numbers [px] of a rectangle and an ellipse are left, top, width and height, and of a polygon column and row of each corner.
    """

    shape: Shape  #: Kind of the region.
    numbers: tuple[float, ...]  #: Numbers of its shape [px].
    name: str = ""  #: Name for tables and files.

    def __post_init__(self) -> None:
        """Check the numbers."""
        if self.shape not in SHAPES:
            raise DataError(f"region '{self.shape}': allowed are {', '.join(SHAPES)}")
        if not all(math.isfinite(v) and abs(v) <= _FURTHEST for v in self.numbers):
            raise DataError(f"{self.shape}: give finite numbers of pixels")
        if self.shape == "polygon":
            if len(self.numbers) % 2 or not 6 <= len(self.numbers) <= 2 * MOST_CORNERS:
                raise DataError(f"polygon of {len(self.numbers) / 2:g} corners: give column and row of 3 to {MOST_CORNERS} corners")
        elif len(self.numbers) != 4 or min(self.numbers[2:]) <= 0.0:
            raise DataError(f"{self.shape} {self.text}: give left, top, width and height, the last two above 0")

    @classmethod
    def rectangle(cls, left: float, top: float, width: float, height: float) -> PictureRegion:
        """Return a rectangle."""
        return cls("rectangle", (left, top, width, height))

    @classmethod
    def of_text(cls, text: str, name: str = "") -> PictureRegion:
        """Return the region of a request's text: ``"ellipse 10 8 36 33"``.

        Raises
        ------
        DataError
            The text describes no region.

        Examples
        --------
        >>> PictureRegion.of_text("ellipse 10 8 36 33").numbers
        (10.0, 8.0, 36.0, 33.0)
        """
        shape, *words = text.split() or [""]
        try:
            numbers = tuple(float(word) for word in words)
        except ValueError:
            raise DataError(f"region {text[:60]!r}: give a shape and its numbers of pixels, such as 'ellipse 10 8 36 33'") from None
        for known in SHAPES:
            if known == shape:
                return cls(known, numbers, name)
        raise DataError(f"region '{shape[:40]}': allowed are {', '.join(SHAPES)}")

    @property
    def text(self) -> str:
        """Return the text of a request."""
        return " ".join([self.shape, *(f"{value:.10g}" for value in self.numbers)])

    def mask(self, rows: int, columns: int) -> BoolArray:
        """Return a mask of the image that is true for pixels whose centres lie inside the region.

        Raises
        ------
        DataError
            No pixel of the region lies in the image.
        """
        across: Floats = np.arange(columns, dtype=np.float64) + 0.5
        down: Floats = np.arange(rows, dtype=np.float64)[:, np.newaxis] + 0.5
        if self.shape == "polygon":
            out = _inside_polygon(across, down, np.reshape(self.numbers, (-1, 2)))
        else:
            left, top, width, height = self.numbers
            if self.shape == "rectangle":
                out = (across > left) & (across < left + width) & (down > top) & (down < top + height)
            else:
                out = ((across - left) / width * 2 - 1) ** 2 + ((down - top) / height * 2 - 1) ** 2 <= 1.0
        if not out.any():
            raise DataError(f"region {self.text}: no pixel, or outside the image of {rows} rows and {columns} columns; drag one inside")
        return out


def _inside_polygon(across: Floats, down: Floats, corners: Floats) -> BoolArray:
    """Return the pixels from which a ray to the left crosses an odd number of sides."""
    out = np.zeros((down.size, across.size), np.bool_)
    centres = down.ravel()
    for (x0, y0), (x1, y1) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        # A side includes its upper end only, so that a corner between two sides counts once.
        first, last = np.searchsorted(centres, (min(y0, y1), max(y0, y1)))
        if first < last:
            out[first:last] ^= across > x0 + (down[first:last] - y0) * (x1 - x0) / (y1 - y0)
    return out


def check_many(regions: list[PictureRegion]) -> list[PictureRegion]:
    """Return regions that are neither too many nor too large for a request.

    Raises
    ------
    DataError
        They are.
    """
    if not 1 <= len(regions) <= MOST_REGIONS:
        raise DataError(f"{len(regions)} regions: give 1 to {MOST_REGIONS}")
    if (numbers := sum(len(region.numbers) for region in regions)) > MOST_NUMBERS:
        raise DataError(f"regions with {numbers // 2} corners in all: give at most {MOST_NUMBERS // 2}, in fewer or simpler polygons")
    return regions


def to_csv(regions: Iterable[PictureRegion]) -> str:
    """Return regions as CSV: name, shape, and the numbers of the shape in one cell."""
    return csv_text([_HEAD, *((region.name, region.shape, region.text.partition(" ")[2]) for region in regions)])


def of_csv(text: str, source: str = "regions as CSV") -> list[PictureRegion]:
    """Return the regions of a CSV file that ``to_csv`` wrote; ``source`` names it in errors.

    Raises
    ------
    DataError
        The text is no such table.
    """
    reader = csv.reader(io.StringIO(text))
    rows = [(reader.line_num, row) for row in reader if any(cell.strip() for cell in row)]
    if not rows or tuple(cell.strip() for cell in rows[0][1]) != _HEAD:
        raise DataError(f"{source}: the first line must be '{','.join(_HEAD)}'; save regions here to see an example")
    out = []
    for line, row in rows[1:]:
        if len(row) != len(_HEAD):
            raise DataError(f"{source}, line {line}: has {len(row)} cells; give {', '.join(_HEAD)}")
        try:
            out.append(PictureRegion.of_text(f"{row[1]} {row[2]}", row[0].strip()[:40]))
        except DataError as error:
            raise DataError(f"{source}, line {line}: {error}") from None
    return out


def to_imagej(regions: Iterable[PictureRegion]) -> bytes:
    """Return regions as an archive of ImageJ's ROI manager (``.zip``), one entry for each region.

    Raises
    ------
    BackendError
        roifile is not installed.
    """
    roifile = optional("roifile", "a file of ImageJ")
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        for number, region in enumerate(regions, 1):
            name = re.sub(r"[^\w .-]", "_", region.name) or str(number)
            if region.shape == "polygon":
                roi = roifile.ImagejRoi.frompoints(np.reshape(region.numbers, (-1, 2)), name=name)
                roi.roitype = roifile.ROI_TYPE.POLYGON
            else:
                left, top, width, height = region.numbers
                # The format has whole numbers for the box.
                ends = {"left": round(left), "top": round(top), "right": round(left + width), "bottom": round(top + height)}
                kind = roifile.ROI_TYPE.RECT if region.shape == "rectangle" else roifile.ROI_TYPE.OVAL
                roi = roifile.ImagejRoi(roitype=kind, name=name, **ends)
            archive.writestr(f"{number:03d}-{name}.roi", roi.tobytes())
    return out.getvalue()


def of_imagej(content: bytes) -> list[PictureRegion]:
    """Return the regions of a file of ImageJ, one region (``.roi``) or an archive (``.zip``).

    Raises
    ------
    DataError
        The content is damaged, or has a kind of region that cannot be used.
    BackendError
        roifile is not installed.
    """
    roifile = optional("roifile", "a file of ImageJ")
    entries = [("region", content)]
    if content[:2] == b"PK":
        try:
            with zipfile.ZipFile(io.BytesIO(content)) as archive:
                inside = [entry for entry in archive.infolist() if entry.filename.lower().endswith(".roi")]
                if sum(entry.file_size for entry in inside) > MOST_ARCHIVE:
                    raise DataError(f"archive of ImageJ: its regions are larger than {MOST_ARCHIVE} bytes; save fewer of them")
                entries = [(entry.filename[:-4], archive.read(entry)) for entry in inside]
        except (zipfile.BadZipFile, NotImplementedError, RuntimeError, OSError, EOFError) as error:
            raise DataError(f"archive of ImageJ: is damaged ({error}); save it again") from None
    return [_of_roi(roifile, name, entry) for name, entry in entries]


def _of_roi(roifile: object, name: str, content: bytes) -> PictureRegion:
    kinds = roifile.ROI_TYPE  # type: ignore[attr-defined]
    try:
        roi = roifile.ImagejRoi.frombytes(content)  # type: ignore[attr-defined]
        corners = np.asarray(roi.coordinates(), np.float64) if roi.roitype in (kinds.POLYGON, kinds.FREEHAND, kinds.TRACED) else None
    # Damaged files fail in many ways, depending on the place of the damage.
    except Exception as error:
        raise DataError(f"region of ImageJ '{name[:40]}': cannot be read ({' '.join(str(error).split())[:100]}); save it again") from None
    name = (roi.name or name)[:40]
    box = (float(roi.left), float(roi.top), float(roi.right - roi.left), float(roi.bottom - roi.top))
    if corners is not None:
        return PictureRegion("polygon", tuple(corners.ravel().tolist()), name)
    if roi.roitype == kinds.RECT:
        return PictureRegion("rectangle", box, name)
    if roi.roitype == kinds.OVAL:
        return PictureRegion("ellipse", box, name)
    raise DataError(f"region of ImageJ '{name}': is a {roi.roitype.name.lower()}; allowed are rectangles, ovals and polygons")


def of_file(content: bytes, source: str = "file of regions") -> list[PictureRegion]:
    """Return the regions of an uploaded file: CSV, or ImageJ's ``.roi`` or ``.zip``; ``source`` names it in errors.

    Raises
    ------
    DataError
        The file holds no regions, or too many.
    """
    if content[:2] == b"PK" or content[:4] == b"Iout":
        regions = of_imagej(content)
    else:
        try:
            regions = of_csv(content.decode("utf-8-sig"), source)
        except (UnicodeDecodeError, csv.Error):
            raise DataError(f"{source}: is neither CSV nor a file of ImageJ (.roi, .zip); give one of them") from None
    return check_many(regions)
