"""Requests of the page of sequences: its script, pictures, probes, traces, regions, analyses and downloads.

Sources, frames and layers are numbers and names that are looked up in lists; no text of a request becomes a path. Long computations are
``PageJob``.
"""

from __future__ import annotations

import base64
import io
import json
import math
import tempfile
from collections.abc import Awaitable, Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, get_args

import numpy as np
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import JSONResponse, RedirectResponse, Response
from starlette.routing import Route

from seaglint.base.brightness import Scale
from seaglint.base.errors import DataError, SeaglintError
from seaglint.base.free_form import JsonObject, number
from seaglint.base.optional import optional
from seaglint.clutter.filters import NAMES
from seaglint.formats.tables.table_text import csv_text
from seaglint.plot.video import Colours, palette, video_available, write_video
from seaglint.version import __version__
from seaglint.viewer.dragged_region import exceedances, quick, whole
from seaglint.viewer.frame_source import OVER_TIME, GoneError, ViewerSource
from seaglint.viewer.jobs import Jobs
from seaglint.viewer.library import Library
from seaglint.viewer.over_time import courses, profile, project, statistics, trace
from seaglint.viewer.picture import KINDS, Scales, Show, tag
from seaglint.viewer.regions import PictureRegion, check_many, of_file, to_csv, to_imagej

if TYPE_CHECKING:
    from seaglint.base.conventions import Progress

Answer = Callable[[Request], Response]
AnswerToBody = Callable[[Request, bytes], Response]

MOST_CLIP: Final = 400_000_000  #: Largest size of a clip's frames in memory [bytes].

TYPES: Final = {".png": "image/png", ".npy": "application/octet-stream", ".tif": "image/tiff"}  #: Media types by ending.

STATIC: Final = Path(__file__).parent / "static"
_FILES: Final = {path.name: path for path in sorted(STATIC.iterdir()) if path.suffix in (".js", ".css", ".html", ".svg")}
_MEDIA: Final = {".js": "text/javascript", ".css": "text/css", ".html": "text/html", ".svg": "image/svg+xml"}
_COLOURS: Final[tuple[Colours, ...]] = get_args(Colours)
_TICKS: Final = 5
# Browsers may store answers, but must check whether they are still valid: a sequence may be growing.
_FRESH: Final = {"cache-control": "no-cache"}


def probe(source: ViewerSource, index: int, row: int, column: int) -> JsonObject:
    """Return the values of a pixel of one frame, by layer, with units; direction and objects where they are known.

    Raises
    ------
    DataError
        The pixel lies outside the image, or the frame does not exist.
    """
    opened = source.opened
    source.require_pixel(row, column)
    values = []
    for layer in opened.layers.values():
        value = float(source.read(index, layer.name)[row, column])
        values.append({"name": layer.name, "label": layer.label, "unit": layer.unit, "value": value if np.isfinite(value) else None})
    azimuth, elevation = towards(source, index, row, column)
    inside = [b.name for b in source.boxes(index) if b.left <= column < b.left + b.width and b.top <= row < b.top + b.height]
    return {
        "frame": index,
        "row": row,
        "column": column,
        "azimuth_deg": azimuth,
        "elevation_deg": elevation,
        "values": values,
        "objects": inside,
    }


def towards(source: ViewerSource, index: int, row: int, column: int) -> tuple[float | None, float | None]:
    """Return azimuth and elevation of a pixel's centre [deg]; None where they are not known."""
    angles = source.directions(index)
    if angles is None:
        return None, None
    azimuth, elevation = angles
    if azimuth.ndim == 1:
        return float(azimuth[column]), float(elevation[row])
    return float(azimuth[row, column]), float(elevation[row, column])


def frame_file(show: Show, index: int, ending: str, scaling: Scale, colours: Colours) -> bytes:
    """Return one frame as a file: PNG as displayed, one pixel for each pixel; NumPy or TIFF with the values and their unit.

    Raises
    ------
    DataError
        The ending is not known.
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
        The frames do not exist, or do not fit into memory.
    BackendError
        PyAV is not installed.
    """
    import xarray as xr

    opened, chosen = show.source.opened, show.source.layer(show.layer)
    done = show.source.done()
    frames = done[(done >= first) & (done <= last)]
    if not frames.size:
        raise DataError(f"clip of frames {first} to {last}: none of these frames exists; choose others")
    # Frames are in single precision: 4 bytes a pixel.
    most = max(MOST_CLIP // (4 * opened.rows * opened.columns), 1)
    if frames.size > most:
        raise DataError(f"clip of {frames.size} frames: at most {most} of this size; choose fewer, or use 'seaglint export'")
    scaling = scales.of(show, int(frames[0]))
    # A frame of equal values needs a scale of some width.
    low, high = scaling.low, scaling.high if scaling.high > scaling.low else scaling.low + 1.0
    block = np.stack([show.image(int(index)).astype(np.float32) for index in frames])
    times = frames / (opened.frame_rate or 25.0) if opened.times is None else opened.times[frames]
    name = chosen.name
    dataset = xr.Dataset({name: (("time", "y", "x"), block, {"units": chosen.unit})}, coords={"time": times})
    with tempfile.TemporaryDirectory(prefix="seaglint-clip-") as folder:
        video = Path(folder) / "clip.mp4"
        write_video(dataset, video, variable=name, colours=colours, limits=(low, high), rate=opened.frame_rate)
        return video.read_bytes()


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


class Query:
    """Numbers and words of a request's query; malformed ones raise an error."""

    def __init__(self, request: Request) -> None:
        self._given = request.query_params

    def word(self, name: str) -> str | None:
        """Return the text of a parameter, or None if it is empty."""
        return self._given.get(name) or None

    def integer(self, name: str, default: int | None = None) -> int:
        """Return a whole number."""
        value = self.real(name, None if default is None else float(default))
        if not value.is_integer():
            raise DataError(f"{name} = {value:g}: give a whole number")
        return int(value)

    def real(self, name: str, default: float | None = None) -> float:
        """Return a finite number."""
        text = self._given.get(name)
        if text is None or text == "":
            if default is None:
                raise DataError(f"{name}: is missing; give a number")
            return default
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        # Larger numbers would overflow in single precision.
        if not math.isfinite(value) or abs(value) > 1e30:
            raise DataError(f"{name} = {text[:40]!r}: give a finite number")
        return value

    def colours(self) -> Colours:
        """Return the colours of the brightness scale."""
        requested = self.word("colours") or _COLOURS[0]
        for known in _COLOURS:
            if known == requested:
                return known
        raise DataError(f"colours '{requested[:40]}': allowed are {', '.join(_COLOURS)}")


def regions_of(body: bytes) -> list[PictureRegion]:
    """Return the regions of a request's body: ``{"regions": [["ellipse 10 8 36 33", "name"], ...]}``.

    Raises
    ------
    DataError
        The body has another form, or a region is none.
    """
    try:
        given = [(str(text), str(name)) for text, name in json.loads(body)["regions"]]
    except (ValueError, TypeError, KeyError):
        raise DataError('regions of a request: give {"regions": [["rectangle 10 8 36 33", "name"]]}') from None
    return check_many([PictureRegion.of_text(text, name[:40]) for text, name in given])


def region_of(body: bytes) -> PictureRegion:
    """Return the only region of a request's body."""
    regions = regions_of(body)
    if len(regions) != 1:
        raise DataError(f"{len(regions)} regions are given; mark one on the picture")
    return regions[0]


def routes(library: Library, links: list[dict[str, str]]) -> list[Route]:
    """Return the routes of the page and all its requests; ``links`` are the other pages of the viewer."""
    return _Pages(library, links).routes()


def _refusals_as_json(answer: Answer) -> Answer:
    """Return a handler that answers errors as JSON: ``{"error": text}``."""

    def answered(request: Request) -> Response:
        try:
            return answer(request)
        except GoneError as error:
            return _json({"error": str(error), "gone": True}, 410)
        except SeaglintError as error:
            return _json({"error": str(error)}, 409)

    return answered


def _with_body(answer: AnswerToBody) -> Callable[[Request], Awaitable[Response]]:
    """Return a handler that reads the body of a request before it answers in a thread."""

    async def answered(request: Request) -> Response:
        body = await request.body()
        return await run_in_threadpool(_refusals_as_json(lambda request: answer(request, body)), request)

    return answered


class _Pages:
    """Handlers that share the library, scales and jobs."""

    def __init__(self, library: Library, links: list[dict[str, str]]) -> None:
        self._library, self._links = library, links
        self._scales, self._jobs = Scales(), Jobs()

    def routes(self) -> list[Route]:
        """Return all routes of the page."""
        frame = "{source:int}/{index:int}"
        table_of: list[tuple[str, Answer, str]] = [
            ("/", self.page, "GET"),
            ("/static/{name}", self.static, "GET"),
            ("/favicon.ico", self.icon, "GET"),
            ("/api/session", self.session, "GET"),
            ("/api/source/{source:int}", self.source, "GET"),
            (f"/api/frame/{frame}", self.frame, "GET"),
            (f"/api/probe/{frame}", self.probe, "GET"),
            (f"/api/truth/{frame}", self.truth, "GET"),
            (f"/api/profile/{frame}", self.profile, "GET"),
            ("/api/trace/{source:int}", self.trace, "POST"),
            ("/api/project/{source:int}", self.project, "POST"),
            ("/api/job/{job:int}", self.job, "GET"),
            ("/api/job/{job:int}", self.cancel, "DELETE"),
            (f"/api/export/frame/{frame}/{{kind}}", self.export_frame, "GET"),
            ("/api/export/clip/{source:int}", self.export_clip, "GET"),
        ]
        with_body: list[tuple[str, AnswerToBody]] = [
            (f"/api/region/{frame}", self.region),
            (f"/api/regions/{frame}", self.regions),
            (f"/api/exceedances/{frame}", self.exceedances),
            (f"/api/analysis/{frame}", self.analyse),
            ("/api/courses/{source:int}", self.courses),
            ("/api/save/regions/{kind}", self.save_regions),
            ("/api/load/regions", self.load_regions),
        ]
        return [
            *(Route(path, _refusals_as_json(answer), methods=[method]) for path, answer, method in table_of),
            *(Route(path, _with_body(answer), methods=["POST"]) for path, answer in with_body),
        ]

    def _of(self, request: Request) -> ViewerSource:
        return self._library.source(int(request.path_params["source"]))

    def _show(self, request: Request) -> Show:
        query = Query(request)
        minus, low = query.word("minus"), query.word("low")
        return Show(
            source=self._of(request),
            layer=query.word("layer"),
            minus=None if minus is None else self._library.source(query.integer("minus")),
            kind=query.word("scaling") or KINDS[1],
            fixed=query.word("fixed") != "0",
            limits=None if low is None else (query.real("low"), query.real("high")),
        )

    def page(self, request: Request) -> Response:
        """Return the page of sequences; the first other page where no sequence was given."""
        if self._links and not len(self._library):
            return RedirectResponse(self._links[0]["path"])
        return self._file("index.html")

    def static(self, request: Request) -> Response:
        """Return script and style."""
        return self._file(str(request.path_params["name"]))

    def icon(self, request: Request) -> Response:
        """Return the icon, which browsers request by this name if a page names no icon."""
        return self._file("icon.svg")

    def _file(self, name: str) -> Response:
        path = _FILES.get(name)
        if path is None:
            return JSONResponse({"error": "no such file"}, status_code=404)
        return Response(path.read_bytes(), media_type=_MEDIA[path.suffix], headers=_FRESH)

    def session(self, request: Request) -> Response:
        """Return the choices of the page."""
        tables = {name: base64.b64encode(palette(name).tobytes()).decode() for name in _COLOURS}
        answer = {
            "version": __version__,
            "sources": self._library.listed(),
            "given": self._library.given,
            "pages": self._links,
            "colours": tables,
            "scalings": KINDS,
            "filters": NAMES,
            "over_time": OVER_TIME,
            "video": video_available(),
        }
        return _json(answer)

    def source(self, request: Request) -> Response:
        """Return the description of a source."""
        source = self._of(request)
        opened, done = source.opened, source.done()
        # Axes with angles only where these hold for all frames.
        directions = None if opened.directions is None or opened.turning else source.directions(0)
        upright = directions is not None and directions[0].ndim == 1
        answer = {
            "name": Path(source.path).name,
            "title": opened.title,
            "frames": opened.frames,
            "done": int(done.size),
            "first": int(done[0]) if done.size else None,
            "last": int(done[-1]) if done.size else None,
            "rows": opened.rows,
            "columns": opened.columns,
            "frame_rate_hz": opened.frame_rate,
            "start_s": None if opened.times is None or not opened.times.size else float(opened.times[0]),
            "azimuth_deg": directions[0].tolist() if upright and directions is not None else None,
            "elevation_deg": directions[1].tolist() if upright and directions is not None else None,
            "layers": [
                {"name": layer.name, "label": layer.label, "unit": layer.unit, "over_time": layer.over_frames is not None}
                for layer in opened.layers.values()
            ],
            "truth": opened.boxes is not None,
            "notes": list(opened.notes),
        }
        return _json(answer)

    def frame(self, request: Request) -> Response:
        """Return the levels of a frame, one byte a pixel, with their scale in the header ``Seaglint-Scale``."""
        show, index = self._show(request), _index(request)
        scaling = self._scales.of(show, index)
        # A browser that shows a frame again sends its tag, and pixels are transferred only if they changed.
        etag = tag(show, index, scaling)
        # Numbers for the colour bar: the page does not know the form of the scale.
        shares = np.linspace(0.0, 1.0, _TICKS)
        chosen = show.source.layer(show.layer)
        unit = chosen.unit if show.minus is None else chosen.spread_unit
        scale = {"shares": shares.tolist(), "values": scaling.value(shares).tolist(), "unit": unit}
        headers = {**_FRESH, "etag": etag, "seaglint-scale": json.dumps(scale)}
        if request.headers.get("if-none-match") == etag:
            return Response(status_code=304, headers=headers)
        return Response(scaling.levels(show.image(index)).tobytes(), media_type="application/octet-stream", headers=headers)

    def probe(self, request: Request) -> Response:
        """Return the values under the pointer."""
        query = Query(request)
        return _json(probe(self._of(request), _index(request), query.integer("row"), query.integer("column")))

    def trace(self, request: Request) -> Response:
        """Start reading the values of a pixel in all frames."""
        query, source = Query(request), self._of(request)
        row, column, layer = query.integer("row"), query.integer("column"), query.word("layer")
        source.require_pixel(row, column)
        return self._started(lambda progress: trace(source, row, column, layer, progress))

    def truth(self, request: Request) -> Response:
        """Return the boxes of objects."""
        boxes = self._of(request).boxes(_index(request))
        return _json({"boxes": [vars(box) | {"range_m": box.range_m if math.isfinite(box.range_m) else None} for box in boxes]})

    def region(self, request: Request, body: bytes) -> Response:
        """Return histogram, moments and fits of a region of one frame."""
        return _json(quick(self._of(request), _index(request), region_of(body), Query(request).word("layer")))

    def regions(self, request: Request, body: bytes) -> Response:
        """Return the statistics of several regions of one frame."""
        layer = self._of(request).layer(Query(request).word("layer"))
        rows = statistics(self._of(request), _index(request), regions_of(body), layer.name)
        return _json({"frame": _index(request), "unit": layer.unit, "spread_unit": layer.spread_unit, "regions": rows})

    def courses(self, request: Request, body: bytes) -> Response:
        """Start the computation of the mean of regions in all frames."""
        source, regions, layer = self._of(request), regions_of(body), Query(request).word("layer")
        return self._started(lambda progress: courses(source, regions, layer, progress))

    def project(self, request: Request) -> Response:
        """Start the computation of mean, deviation and maximum over time."""
        source, layer = self._of(request), Query(request).word("layer")
        return self._started(lambda progress: project(source, layer, progress))

    def _started(self, work: Callable[[Progress], JsonObject]) -> Response:
        return _json({"job": self._jobs.start(work)}, 202)

    def save_regions(self, request: Request, body: bytes) -> Response:
        """Return regions as a file: CSV, or an archive of ImageJ."""
        regions, kind = regions_of(body), str(request.path_params["kind"])
        if kind == "csv":
            return _download(to_csv(regions).encode(), "regions.csv", "text/csv")
        if kind == "imagej":
            return _download(to_imagej(regions), "RoiSet.zip", "application/zip")
        raise DataError(f"regions as {kind[:20]}: allowed are csv, imagej")

    def load_regions(self, request: Request, body: bytes) -> Response:
        """Return the regions of an uploaded file."""
        name = (Query(request).word("name") or "file of regions")[:80]
        return _json({"regions": [[region.text, region.name] for region in of_file(body, name)]})

    def profile(self, request: Request) -> Response:
        """Return the values along a line."""
        query, source = Query(request), self._of(request)
        chosen = source.layer(query.word("layer"))
        x0, y0, x1, y1 = (query.real(name) for name in ("column", "row", "to_column", "to_row"))
        distance, columns, rows, values = profile(source.read(_index(request), chosen.name), (x0, y0, x1, y1))
        answer = {
            "distance_px": distance.round(6).tolist(),
            "columns": columns.tolist(),
            "rows": rows.tolist(),
            "values": [number(value) for value in values.tolist()],
            "label": chosen.label,
            "unit": chosen.unit,
        }
        return _json(answer)

    def exceedances(self, request: Request, body: bytes) -> Response:
        """Return the number of pixels above a threshold, and their mask as bits, row by row; without a region of the whole frame."""
        query = Query(request)
        where = region_of(body) if body else None
        result, above = exceedances(
            self._of(request), _index(request), query.real("sigma"), query.word("filter") or NAMES[0], query.word("layer"), where
        )
        return _json({**result, "mask": base64.b64encode(np.packbits(above).tobytes()).decode()})

    def analyse(self, request: Request, body: bytes) -> Response:
        """Start the whole analysis of a region."""
        query, source, where = Query(request), self._of(request), region_of(body)
        layer = query.word("layer")
        only = None if query.word("all") == "1" else _index(request)
        return self._started(lambda progress: whole(source, where, layer, only, progress))

    def cancel(self, request: Request) -> Response:
        """Cancel a job; it ends at its next report of progress."""
        self._jobs.get(int(request.path_params["job"])).cancelled = True
        return _json({})

    def job(self, request: Request) -> Response:
        """Return the progress of a job, and its result once it exists; the result of an analysis also as JSON or CSV to save."""
        job = self._jobs.get(int(request.path_params["job"]))
        query = Query(request)
        if job.error is not None:
            raise DataError(job.error)
        if job.result is None:
            return _json({"done": job.done, "total": job.total, "result": None})
        save = query.word("save")
        if save == "csv":
            return _download(table(job.result).encode(), "region.csv", "text/csv")
        if save == "json":
            return _download(json.dumps(job.result, indent=2, ensure_ascii=False).encode(), "region.json", "application/json")
        return _json({"done": job.total, "total": job.total, "result": job.result})

    def export_frame(self, request: Request) -> Response:
        """Return one frame as a file."""
        show, index = self._show(request), _index(request)
        ending = "." + str(request.path_params["kind"])
        if ending not in TYPES:
            raise DataError(f"{ending[:20]}: a frame is saved as {', '.join(TYPES)}; choose one of them")
        body = frame_file(show, index, ending, self._scales.of(show, index), Query(request).colours())
        return _download(body, f"{_stem(show.source)}-{show.source.layer(show.layer).name}-{index:05d}{ending}", TYPES[ending])

    def export_clip(self, request: Request) -> Response:
        """Return frames as a video."""
        show, query = self._show(request), Query(request)
        first, last = query.integer("first"), query.integer("last")
        return _download(clip(show, first, last, self._scales, query.colours()), f"{_stem(show.source)}-{first}-{last}.mp4", "video/mp4")


def _index(request: Request) -> int:
    """Return the frame of a request."""
    return int(request.path_params["index"])


def _json(content: Any, status: int = 200) -> Response:
    return JSONResponse(content, status_code=status, headers=_FRESH)


def _stem(source: ViewerSource) -> str:
    """Return a name for a download, of letters, digits, hyphens and underscores."""
    stem = Path(source.path).name.removesuffix(".partial").split(".")[0]
    return "".join(c if (c.isascii() and c.isalnum()) or c in "-_" else "_" for c in stem)[:60] or "frame"


def _download(body: bytes, name: str, media: str) -> Response:
    return Response(body, media_type=media, headers={**_FRESH, "content-disposition": f'attachment; filename="{name}"'})
