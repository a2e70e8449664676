"""Requests of commands: parameters with their help texts, shared by the terminal and ``import seaglint as sg``.

:class:`ReadingRequest` (how a recording is read) and :class:`WorkRequest` (how work is run) are parts of other requests. The requests
analyse a recording, render or sense a sequence, write frames for another program, map the mean radiance, evaluate tables of cases, sweep
keys of a scenario, estimate the likelihood of glint, and fit, compare, sample or place a texture.

Importing this module loads nothing else, because help pages need it.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, fields
from operator import index
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final, Literal, NamedTuple, get_args

from seaglint.base.errors import DataError
from seaglint.base.parameters import Parameter, documented
from seaglint.detection.detector_names import ANALYZED, OWN

if TYPE_CHECKING:
    from seaglint.analysis import AnalysisOptions, Recording
    from seaglint.clutter.filters import Filter


MOST_SEAS: Final = 1000  #: Largest number of drawn seas: more change no end of an interval by more than 3 % of its width.

#: Parameter of requests whose results have an interval over seas between the campaigns.
SEA_DRAWS: Final = Parameter(
    "also compute N seas between two measured campaigns and Elfouhaily's model, and give the interval 'sea unknown', 5 to 95 % of them",
    metavar="N",
    python="Number of further seas between two measured campaigns and Elfouhaily's model, of which the interval 'sea unknown' is "
    "given, 5 to 95 % of them. Their slopes are those of their waves, whatever ``sea.slopes`` says; 2 or more.",
)

SeaDraws = Annotated[int | None, SEA_DRAWS]  #: Number of drawn seas; None where the sea is not varied.


def require_sea_draws(draws: int | None, name: str = "sea_draws") -> None:
    """Refuse a number of seas from which no interval can be taken, or that takes too long.

    Raises
    ------
    DataError
        A number outside 2 to ``MOST_SEAS``, or no whole number.
    """
    if draws is None:
        return
    try:
        index(draws)
    except TypeError:
        text = f"{name} = {draws!r} is no whole number; give the number of seas to draw, from 2 to {MOST_SEAS}, e.g. 20"
        raise DataError(text) from None
    if not 2 <= draws <= MOST_SEAS:
        raise DataError(f"{name} = {draws} is outside 2 to {MOST_SEAS}; give the number of seas to draw, e.g. 20, or leave it out")


Overwrite = Annotated[bool, Parameter("replace what stands at the output", "Run")]  #: Whether files that are there already are replaced.


class WeightsFile(NamedTuple):
    """Numbers of a small file, with its place; ``values`` may be a function that reads them when they are needed."""

    path: Path
    values: Any


def values_of(given: Any) -> Any:
    """Return the numbers of a file or an array."""
    if not isinstance(given, WeightsFile):
        return given
    return given.values() if callable(given.values) else given.values


def filter_of(name: str, kernel: Any, signature: Any) -> Filter:
    """Return a filter by its name, or one of the user's own weights or target; both are arrays or :class:`WeightsFile`.

    Raises
    ------
    DataError
        A matched filter without its target, or an unknown name.
    """
    from seaglint.base.errors import DataError
    from seaglint.clutter.filters import Kernel, MatchedFilter, named

    if kernel is not None:
        return Kernel(values_of(kernel), name=kernel.path.stem if isinstance(kernel, WeightsFile) else "kernel")
    if name == "matched":
        if signature is None:
            raise DataError(
                "filter = matched needs the target's signature: give signature=ARRAY, or a file (CSV or .npy); or another filter"
            )
        return MatchedFilter(values_of(signature))
    return named(name)


@dataclass(frozen=True)
class ReadingRequest:
    """Parameters of a recording that its file does not state, or states wrongly."""

    frame_rate: Annotated[float | None, Parameter("frames per second, where the file does not say [Hz]", "Recording")] = None
    units: Annotated[str | None, Parameter("units of the values, where the file does not say", "Recording")] = None
    variable: Annotated[str | None, Parameter("which array of a file that holds several", "Recording")] = None
    channel: Annotated[
        str | None, Parameter("mean, red, green or blue of true colour images, or the number of a channel from 1", "Recording")
    ] = None
    axes: Annotated[
        str | None,
        Parameter("order of an array's axes: t time, y rows, x columns, c channels; tyx is the default, yxt has time last", "Recording"),
    ] = None
    missing: Annotated[
        tuple[float, ...], Parameter("stored number that is a missing value, besides those that the file states; repeatable", "Recording")
    ] = ()
    saturation: Annotated[float | None, Parameter("value from which on the sensor is saturated", "Recording")] = None
    raw: Annotated[
        Any, Parameter("layout of a raw file, e.g. rows=512,columns=640,dtype=uint16,offset=0,frame_header=0", "Recording", "raw")
    ] = None

    def opened(self, path: str | Path) -> Recording:
        """Return the recording of a file, read with these parameters."""
        from seaglint.formats.recording import open_recording

        return open_recording(path, **{field.name: getattr(self, field.name) for field in fields(ReadingRequest)})


@dataclass(frozen=True)
class WorkRequest:
    """Parameters of a run: threads, workers, and existing output."""

    threads: Annotated[
        int | None, Parameter("processor threads; default: all", "Run", least=1, detail="The bytes do not depend on them.")
    ] = None
    workers: Annotated[
        int | None,
        Parameter(
            "processes on this machine that share the work",
            "Run",
            metavar="N",
            least=1,
            detail="Or workers as :func:`seaglint.cluster.dask.connected` gives them.",
        ),
    ] = None
    resume: Annotated[bool, Parameter("go on with an unfinished sequence", "Run")] = False
    overwrite: Overwrite = False


#: Parameter of requests with a detector.
TIME_LIMIT: Final = Parameter(
    "longest time of a call of your own detector [s]",
    "Detector",
    python="Longest time of a call of your own detector [s], after which it is ended. It runs in a separate process, to which functions "
    "and objects are copied; with infinity they run in this process instead.",
)


@dataclass(frozen=True)
class AnalysisRequest(ReadingRequest):
    """Request to analyse a recording.

    ``mask``, ``regions``, ``kernel`` and ``signature`` are arrays or :class:`~seaglint.studies.study_requests.WeightsFile`, regions
    also a path; filter and detectors are names, or objects of :mod:`seaglint.clutter.filters` and ``seaglint.detection``.
    """

    mask: Annotated[
        Any,
        Parameter("image or .npy, not zero where the sea glints; instead of the segmentation", form="mask", detail="In Python an array."),
    ] = None
    no_glint: Annotated[bool, Parameter("look for no glint corridor: all pixels are the only region")] = False
    regions: Annotated[
        Any,
        Parameter(
            "image or .npy of whole numbers, one region a number above 0, or .json of names and rectangles; instead of the segmentation",
            form="regions",
            python="Regions instead of glint and background: an array of whole numbers (rows, columns), 0 outside all regions, a mapping "
            "of names to rectangles (``120:256,64:192``, rows and columns) or masks, or a file of such (an image, .npy or .json).",
        ),
    ] = None
    rows: Annotated[
        tuple[float, float], Parameter("part of the rows to analyse", form="shares", detail="Shares of the height from the top [1].")
    ] = (0.0, 1.0)
    filter: Annotated[
        Any,
        Parameter(
            "laplacian, difference-of-gaussians, median-subtraction, top-hat, matched, none",
            form="name",
            subject="filter before the thresholds:",
        ),
    ] = "laplacian"
    kernel: Annotated[Any, Parameter("CSV or .npy of filter weights of your own, instead of `filter`", form="weights")] = None
    signature: Annotated[Any, Parameter("CSV or .npy of the target for `filter` matched", form="weights")] = None
    thresholds: Annotated[
        tuple[float, ...], Parameter("thresholds beside 3.0 and 3.5, in standard deviations; repeatable", option="--threshold")
    ] = ()
    scope: Annotated[
        Literal["frame", "sequence", "local"],
        Parameter("standard deviation of each 'frame', of the whole 'sequence', or 'local'", form="name", option="--sigma"),
    ] = "frame"
    detectors: Annotated[
        tuple[Any, ...],
        Parameter(
            f"{', '.join(ANALYZED)}, or {OWN}; repeatable",
            form="names",
            option="--detector",
            subject="detectors that are counted like the filter:",
            detail="Functions, lambdas and objects that are called with frames as well.",
        ),
    ] = ()
    time_limit: Annotated[float, TIME_LIMIT] = 60.0
    border: Annotated[
        Literal["auto", "keep", "drop"],
        Parameter("'keep' or 'drop' filtered pixels that see repeated ones beyond the border; 'auto': keep in one image", form="name"),
    ] = "auto"
    seed: Annotated[int, Parameter("of the samples that are drawn", least=0)] = 0

    @property
    def files(self) -> list[Path]:
        """Files that are read beside the recording, which no result may replace."""
        return [given.path for given in (self.mask, self.regions, self.kernel, self.signature) if isinstance(given, WeightsFile)]

    @contextmanager
    def ready(self) -> Iterator[AnalysisOptions]:
        """Provide the options; processes of a user's detectors end with the context."""
        from seaglint.detection.isolated import ended

        options = self.options()
        try:
            yield options
        finally:
            for detector in options.detectors:
                ended(detector)

    def options(self) -> AnalysisOptions:
        """Return the options of the analysis: filters and detectors from names, sequences as tuples, masks as plain arrays.

        Raises
        ------
        DataError
            An unknown name, or a filter without its target.
        """
        import numpy as np

        from seaglint.analysis import AnalysisOptions
        from seaglint.detection.interface import detector_of
        from seaglint.detection.isolated import running
        from seaglint.detection.named_detectors import named
        from seaglint.formats.region_files import read_regions

        known: dict[str, Any] = {field.name: getattr(self, field.name) for field in fields(AnalysisOptions)}
        if isinstance(self.filter, str) or self.kernel is not None:
            known["filter"] = filter_of(self.filter, self.kernel, self.signature)
        known["mask"] = None if self.mask is None else np.asarray(values_of(self.mask), dtype=np.bool_)
        known["regions"] = read_regions(self.regions) if isinstance(self.regions, str | Path) else values_of(self.regions)
        # A user's detector has its process, in which it can be ended.
        known["detectors"] = tuple(
            named(each) if isinstance(each, str) and ":" not in each else running(each, self.time_limit)
            for each in map(detector_of, self.detectors)
            if each is not None
        )
        return AnalysisOptions(**known | {"thresholds": tuple(self.thresholds), "rows": tuple(self.rows)})


@dataclass(frozen=True)
class RenderRequest(WorkRequest):
    """Request to render the frames of a scenario into a store."""

    frames: Annotated[
        range | None, Parameter("frames to render", form="frames", detail="Counted from 0; all of the scenario's by default.")
    ] = None
    electrons: Annotated[bool, Parameter("with a detector: write electrons beside counts")] = False
    radiance: Annotated[
        bool, Parameter("with a detector: write radiance at the aperture beside counts", detail="It is averaged over pixels.")
    ] = False


@dataclass(frozen=True)
class SenseRequest(ReadingRequest, WorkRequest):
    """Request to put a scenario's sensor on radiance at the aperture."""

    seed: Annotated[int | None, Parameter("of the noise; default: the scenario's", least=0)] = None
    oversampling: Annotated[
        int | None,
        Parameter(
            "pixels of INPUT along each side of the detector's; told by our own files",
            least=1,
            detail="Found from the coordinates of a dataset, else 1.",
        ),
    ] = None
    electrons: Annotated[bool, Parameter("write electrons beside counts")] = False


@dataclass(frozen=True)
class ExportRequest:
    """Request to write frames of a run for another program."""

    variable: Annotated[str | None, Parameter("images to export; signal if there, else radiance")] = None
    frames: Annotated[range | None, Parameter("frames to export", form="every", detail="Counted in the whole sequence.")] = None
    dtype: Annotated[Literal["uint16", "float32"] | None, Parameter("type of the numbers; default: as stored (not of {videos})")] = None
    limits: Annotated[
        tuple[float, float] | None,
        Parameter(
            "values of the first and last count of uint16, or of black and white",
            metavar="LOW HIGH",
            option="--range",
            detail="Those of the frames by default.",
        ),
    ] = None
    colours: Annotated[
        Literal["white-hot", "black-hot", "perceptual"] | None, Parameter("colours of {videos}; white-hot", option="--map")
    ] = None
    rate: Annotated[float | None, Parameter("frames per second shown by {videos}; those of the run", option="--fps")] = None
    scale: Annotated[Literal["auto", "linear", "log"] | None, Parameter("brightness of {videos}; auto")] = None
    overwrite: Overwrite = False


@dataclass(frozen=True)
class MeanRequest:
    """Request to map mean radiance and apparent temperature over the view of a scenario."""

    scenario: Annotated[
        Path, Parameter("scenario file; 'seaglint init my.toml' writes one", metavar="SCENARIO.toml", python="See :func:`sg.load`.")
    ]
    overwrite: Overwrite = False
    sea_draws: SeaDraws = None

    def __post_init__(self) -> None:
        """Refuse numbers that are not allowed."""
        require_sea_draws(self.sea_draws)


@dataclass(frozen=True)
class SlopesRequest:
    """Request to list the slope variances of a scenario's sea by bands of the wavenumber."""

    scenario: Annotated[
        Path, Parameter("scenario file; 'seaglint init my.toml' writes one", metavar="SCENARIO.toml", python="See :func:`sg.load`.")
    ]
    bands: Annotated[tuple[float, ...], Parameter("edges of the bands in rad/m, ascending", form="numbers", metavar="K,K,...")] = (
        *(1.0, 5.0, 10.0, 20.0),
        *(50.0, 100.0, 300.0, 1000.0),
    )


@dataclass(frozen=True)
class EvaluationRequest:
    """Request to evaluate a table of cases row by row."""

    extrapolate: Annotated[bool, Parameter("take winds and heights that are not covered, and name them in the column 'extrapolated'")] = (
        False
    )
    overwrite: Overwrite = False


@dataclass(frozen=True)
class BandsRequest(EvaluationRequest):
    """Request to evaluate a table of cases in some spectral bands."""

    bands: Annotated[
        tuple[str, ...],
        Parameter(
            "wavelengths in um, e.g. 3.0-5.0; may be repeated",
            metavar="A-B",
            option="--band",
            python="Bands inside the tables, as ``parse_bands`` gives them.",
        ),
    ] = ()


@dataclass(frozen=True)
class MeanCasesRequest(BandsRequest):
    """Request to evaluate the mean radiance of a table of cases."""

    sea_draws: SeaDraws = None

    def __post_init__(self) -> None:
        """Refuse numbers that are not allowed."""
        require_sea_draws(self.sea_draws)


@dataclass(frozen=True)
class AirRequest(BandsRequest):
    """Request to evaluate the air in a table of cases."""

    levels: Annotated[
        Literal["lowtran", "continuous"],
        Parameter(
            "lowtran: LOWTRAN7's own layers, from tables; continuous: air that emits by the temperature at the place",
            python="``lowtran`` for LOWTRAN7's own layers, from tables; ``continuous`` for air that emits by the temperature at the place.",
        ),
    ] = "lowtran"


Quantity = Literal["mean", "image", "sensor", "atmosphere", "likelihood"]  #: Quantity that a sweep computes for each case.

QUANTITIES: Final[tuple[str, ...]] = get_args(Quantity)

MOST_CASES: Final = 100_000  #: Cases of a sweep at most, unless more are allowed.


@dataclass(frozen=True)
class SweepRequest(WorkRequest):
    """Request to compute one quantity over every combination of some values of a scenario's keys."""

    vary: Annotated[
        tuple[str, ...],
        Parameter(
            "key of the scenario with its values; STOP is included; repeatable, all combinations are computed",
            metavar="KEY=A,B,C|START:STOP:STEP",
            python="Values by key of the scenario, such as ``{'wind.speed_m_s': [2, 5, '20 kn']}``. All combinations are computed. A key "
            "may be a whole table (``'sea.slopes'``), its values tables; ``'band'`` also takes pairs of wavelengths [um].",
        ),
    ] = ()
    what: Annotated[
        Any,
        Parameter(
            "quantity of each case: mean, image, sensor, atmosphere or likelihood",
            metavar="WHAT",
            form="name",
            python="``mean`` radiance of the sea, ``image`` at time 0, figures of merit of the ``sensor``, transmittance and radiance of "
            "the ``atmosphere``, ``likelihood`` of glint; or a function of a scenario that returns a number, numbers by name, or arrays of "
            "xarray.",
        ),
    ] = "mean"
    at: Annotated[
        tuple[str, ...],
        Parameter(
            "view angles instead of the picture's pixels, for mean and atmosphere: view_zenith_deg at the sea, 0 is straight down, and "
            "view_azimuth_deg of the line of sight, clockwise from north; repeatable",
            metavar="ANGLE=A,B,C|START:STOP:STEP",
            python="View angles instead of the picture's pixels, for ``mean`` and ``atmosphere``: ``view_zenith_deg``, the zenith angle at "
            "the sea of the direction to the sensor, 0 is straight down, and ``view_azimuth_deg``, the azimuth of the line of sight, "
            "clockwise from north, by default the sensor's.",
        ),
    ] = ()
    threads: Annotated[
        int | None, Parameter("processor threads of each process; default: all", "Run", least=1, detail="Results do not depend on them.")
    ] = None
    keep_going: Annotated[
        bool, Parameter("leave cases that fail without values (NaN) and compute the others; without it the first failure ends the sweep")
    ] = False
    most_cases: Annotated[int, Parameter("largest number of cases that is computed", least=1)] = MOST_CASES


@dataclass(frozen=True)
class LikelihoodRequest:
    """Request for the likelihood that glint exceeds thresholds, with the settings of the scenario's table ``[likelihood]``."""

    by_month: Annotated[
        bool, Parameter("map the region of [likelihood], or the world's seas, by month: OUT.nc or a folder", option="--map")
    ] = False
    step: Annotated[
        float | None,
        Parameter("step of the map [deg]; default: 1, or 4 for most of the globe", least=0.05, detail="It is width and height of a cell."),
    ] = None
    track: Annotated[
        Path | None,
        Parameter(
            "CSV of a ship's way: time_utc, latitude_deg, longitude_deg and, if it looks one way, bearing_deg",
            detail="Bearings are clockwise from north; without them azimuths from the Sun are those of the scenario.",
        ),
    ] = None
    forecast: Annotated[
        Path | None,
        Parameter(
            "forecast of wind and cloud cover beside the climatology along the track: GRIB or NetCDF",
            detail="Members of an ensemble are equally likely.",
        ),
    ] = None
    wind_spread: Annotated[float, Parameter("standard deviation of the wind speed about the forecast [m/s]", least=0.0)] = 0.0
    cover_spread: Annotated[float, Parameter("standard deviation of the cloud cover about the forecast [share of the sky]", least=0.0)] = (
        0.0
    )
    best: Annotated[
        bool,
        Parameter(
            "bearing, depression and hour with the least glint at the scenario's place and a date: OUT.csv, .json, .png or a folder",
            detail="Each direction has its chance over the weather of the date; all share their draws of weather.",
        ),
    ] = False
    date: Annotated[
        str | None, Parameter("date for `best`, UTC, e.g. 2026-06-21; default: that of [time]", metavar="DATE", subject="date")
    ] = None
    sea_draws: SeaDraws = None

    def __post_init__(self) -> None:
        """Refuse several results at once, and options without use."""
        require_sea_draws(self.sea_draws)
        ways = [f"`{name}`" for name, given in (("by_month", self.by_month), ("track", self.track), ("best", self.best)) if given]
        if len(ways) > 1:
            raise DataError(f"{' and '.join(ways)} are given: a map, the way of a ship and the best look are different results; give one")
        if self.date is not None and not self.best:
            raise DataError(f"date = {self.date}: is for `best` alone; other results have the times of the scenario")
        if self.sea_draws is not None and ways:
            raise DataError(f"sea_draws = {self.sea_draws}: is for the chances of the thresholds alone; leave it or {ways[0]} out")
        if self.forecast is not None and self.track is None:
            raise DataError("a forecast is given without a track: it is read along one; give `track`, a CSV of the way")
        for name, most, unit in (("wind_spread", 50.0, "m/s"), ("cover_spread", 1.0, "share of the sky")):
            value = getattr(self, name)
            if not 0.0 <= value <= most:
                raise DataError(f"{name} = {value:g} is outside 0 to {most:g} ({unit}); give the standard deviation of the forecast")
            if value > 0.0 and self.forecast is None:
                raise DataError(f"{name} = {value:g} is given without a forecast, whose error it is; give `forecast`, or leave it out")


Seed = Annotated[int, Parameter("of the random numbers: the same seed gives the same bytes", least=0)]  #: Seed of fits and samples.


@documented()
@dataclass(frozen=True)
class FitRequest:
    """Request to fit a texture.

    Parameters
    ----------
    {request}
    """

    model: Annotated[Literal["autobinomial", "gauss-markov"], Parameter("field of the texture")] = "gauss-markov"
    tails: Annotated[
        Literal["auto", "gaussian", "gamma", "lognormal", "k", "empirical", "noise"],
        Parameter("distribution of the pixels, or 'noise' of the data's own distribution; 'auto': the best by the rates of unseen halves"),
    ] = "auto"
    region: Annotated[str | None, Parameter("part of the picture in pixels, e.g. 120:248,64:192", metavar="ROWS,COLUMNS")] = None
    any_region: Annotated[bool, Parameter("fit also where the picture is not stationary")] = False
    detrend: Annotated[bool, Parameter("take slow changes of the mean off first")] = False
    mask: Annotated[
        Any, Parameter("leave out pixels where an image or .npy of the frames' size is not 0", form="mask", detail="Or an array.")
    ] = None
    keep_defects: Annotated[bool, Parameter("count all pixels, also dead lines, dark corners, objects and pixels that never change")] = (
        False
    )
    product: Annotated[
        bool | None,
        Parameter(
            "multiply fine structure by a slow gamma field where the rates need it, always or never",
            form="switch",
            python="Multiply fine structure by a slow gamma field; None where the rates decide.",
        ),
    ] = None
    order: Annotated[int, Parameter("order of the neighbourhood (autobinomial)", least=1)] = 2
    isotropic: Annotated[bool, Parameter("one weight for each distance (autobinomial)")] = False
    levels: Annotated[int, Parameter("grey levels (autobinomial)", least=2)] = 16
    method: Annotated[
        Literal["auto", "pseudo-likelihood", "monte-carlo", "monte-carlo-exchange"],
        Parameter("how it is fitted (autobinomial); auto: as its regime asks for"),
    ] = "auto"
    keep_histogram: Annotated[bool, Parameter("draw samples with exactly the picture's histogram (autobinomial)")] = False
    seed: Seed = 0
    overwrite: Overwrite = False


@documented()
@dataclass(frozen=True)
class CompareRequest:
    """Request to compare two textures.

    Parameters
    ----------
    {request}
    """

    regions: Annotated[
        tuple[str, ...],
        Parameter(
            "part of A; given twice, of A and of B",
            metavar="ROWS,COLUMNS",
            option="--region",
            python="Part of the first, and of the second.",
        ),
    ] = ()
    detrend: Annotated[bool, Parameter("take slow changes of the mean off both")] = False
    keep_defects: Annotated[bool, Parameter("count all pixels, also dead lines, dark corners, objects and pixels that never change")] = (
        False
    )
    seed: Seed = 0
    overwrite: Overwrite = False


@documented()
@dataclass(frozen=True)
class SampleRequest:
    """Request to sample a texture, periodic in rows, columns and time.

    Parameters
    ----------
    {request}
    """

    size: Annotated[
        tuple[int, int],
        Parameter("of the picture, e.g. 512x512", form="size", metavar="COLUMNSxROWS", python="Columns and rows of the picture."),
    ] = (512, 512)
    frames: Annotated[int, Parameter("of the loop: the frame after the last is the first", least=1)] = 1
    seed: Seed = 0
    overwrite: Overwrite = False


@documented()
@dataclass(frozen=True)
class PlaceRequest:
    """Request to lay a texture on the sea of a scenario; the loop is as long as the scenario.

    Parameters
    ----------
    {request}
    """

    frames: Annotated[range | None, Parameter("frames to write", form="frames", detail="All of the scenario by default.")] = None
    size: Annotated[
        tuple[int, int],
        Parameter(
            "of the periodic field on the sea",
            form="size",
            metavar="COLUMNSxROWS",
            python="Columns and rows of the periodic field on the sea.",
        ),
    ] = (512, 512)
    cell: Annotated[
        tuple[float, float] | None,
        Parameter("of its pixels along and across the range in metres; nearest footprint", metavar="LENGTH WIDTH"),
    ] = None
    contrast: Annotated[
        Literal["auto", "glint", "model"],
        Parameter(
            "standard deviation of glint in the mean map, or of the model; auto: glint where there is any",
            detail="Glint also has the mean of that map; model has the texture's ratio to the mean, averaged over the footprint, of all "
            "that comes from the sea.",
        ),
    ] = "auto"
    seed: Annotated[int | None, Parameter("of the field; default: the scenario's", least=0)] = None
    overwrite: Overwrite = False
