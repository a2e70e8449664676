"""Options of ``seaglint detect``, parsed into one record."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import MISSING, dataclass, fields
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final, Literal, get_type_hints

import typer

from seaglint.cli.analyze import RAW_HELP, filter_of, weights
from seaglint.cli.sensor import SensorPreset
from seaglint.cli.terminal.numbers import contrasts_of
from seaglint.cli.terminal.options import Overwrite, ProgressOption
from seaglint.cli.terminal.progress import ProgressMode
from seaglint.cli.terminal.workers import DaskOption, DaskSlurmOption, WorkersOption

if TYPE_CHECKING:
    from seaglint.detection.spot import SpotShape
    from seaglint.detection.trials import InjectedObjects
    from seaglint.studies.detect.performance import DetectionOptions

Law = Literal["sigma", "frame", "fixed", "design"]
Placement = Literal["random", "centre"]
Pointing = Literal["least-squares", "centroid"]

OF_RECORDINGS: Final = ("raw", "variable", "channel", "axes", "units", "saturation", "frame_rate", "pixel_mrad")
"""Options that say something of a recording."""

OF_SCENARIOS: Final = (
    *("objects_are", "temperature_difference", "intensity", "range_m", "object_height_m", "seas", "cases", "precision", "precision_fa"),
    *("time_budget", "resume", "design", "p_fa", "alarms_per_hour", "wanted_p_d", "find_range", "object_name", "range_limits", "bearings"),
    "sensor_preset",
)
"""Options for scenarios alone."""


@dataclass(frozen=True)
class DetectOptions:
    """What the command line says; see the options' own help."""

    recording: Annotated[
        str,
        typer.Argument(
            metavar="INPUT", help="SCENARIO.toml, or a sequence without objects: Zarr, NetCDF, PNG, TIFF, FITS, NumPy, HDF5, video, raw"
        ),
    ]
    contrast: Annotated[
        str | None,
        typer.Option(
            "--contrast",
            help="what an object centred on a pixel adds to it: 4, several 1,2,4, or FIRST:LAST:STEP [units of INPUT]; "
            "of a scenario the in-band contrast at the aperture [W m-2 sr-1]",
        ),
    ] = None
    detector: Annotated[
        str,
        typer.Option(
            "--detector",
            help="threshold, matched, matched-global, matched-local, log, top-hat, max-mean, max-median, patch-image, ca-cfar, os-cfar, "
            "os-cfar-exponential, temporal-profile, track-before-detect, frame-difference, integration, or package.module:function",
        ),
    ] = "threshold"
    filter_name: Annotated[
        str,
        typer.Option(
            "--filter", help="before the detector: laplacian, difference-of-gaussians, median-subtraction, top-hat, matched, none"
        ),
    ] = "none"
    kernel: Annotated[Path | None, typer.Option("--kernel", help="CSV or .npy of filter weights of your own, instead of --filter")] = None
    signature: Annotated[Path | None, typer.Option("--signature", help="CSV or .npy of the target for --filter matched")] = None
    object_sigma_px: Annotated[
        float | None, typer.Option("--object-sigma-px", help="standard deviation of the object's Gaussian blur [px]; 0.8 without --psf")
    ] = None
    psf: Annotated[Path | None, typer.Option("--psf", help="CSV or .npy of the object's point spread, one value a pixel, instead")] = None
    threshold: Annotated[float, typer.Option("--threshold", help="in the unit of --threshold-law")] = 4.0
    threshold_law: Annotated[
        Law,
        typer.Option(
            "--threshold-law",
            help="'sigma': standard deviations above the mean of all frames; 'frame': of each frame; 'fixed': the statistic's unit; "
            "'design': rate of false alarms for which the detector is designed",
        ),
    ] = "sigma"
    injections: Annotated[int, typer.Option("--injections", min=1, help="objects of each contrast")] = 2000
    placement: Annotated[Placement, typer.Option("--placement", help="'random' within pixels, or at the 'centre' of pixels")] = "random"
    match_radius: Annotated[float, typer.Option("--match-radius", help="largest distance of a detection from the object's pixel [px]")] = (
        1.0
    )
    velocity: Annotated[str, typer.Option("--velocity", metavar="X,Y", help="motion to the right and down [px a frame]")] = "0,0"
    duration: Annotated[
        int, typer.Option("--duration", min=0, help="frames for which the object is there, up to the one judged; 0: all the detector sees")
    ] = 0
    pointing: Annotated[Pointing, typer.Option("--pointing", help="place of detections by 'least-squares' or 'centroid'")] = "least-squares"
    seed: Annotated[int, typer.Option("--seed", min=0, help="of the places")] = 0
    level: Annotated[float, typer.Option("--level", help="of the intervals")] = 0.95
    time_limit: Annotated[float, typer.Option("--time-limit", help="longest time of a call of your own detector [s]")] = 60.0
    as_json: Annotated[bool, typer.Option("--json", help="print JSON")] = False
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", metavar="RESULT", help="writes RESULT.json, RESULT.csv (or .parquet), RESULT_roc.csv, RESULT_roc.png"
        ),
    ] = None
    frame_rate: Annotated[float | None, typer.Option("--frame-rate", help="frames per second, where the file does not say [Hz]")] = None
    pixel_mrad: Annotated[float | None, typer.Option("--pixel-mrad", help="angle of a pixel, where the file does not say [mrad]")] = None
    units: Annotated[str | None, typer.Option("--units", help="units of the values, where the file does not say")] = None
    variable: Annotated[str | None, typer.Option("--variable", help="which array of a file that holds several")] = None
    channel: Annotated[str | None, typer.Option("--channel", help="mean, red, green or blue of true colour images")] = None
    axes: Annotated[str | None, typer.Option("--axes", help="order of an array of three axes: tyx (time first, the default) or yxt")] = None
    saturation: Annotated[float | None, typer.Option("--saturation", help="value from which on the sensor is saturated")] = None
    raw: Annotated[str | None, typer.Option("--raw", help=RAW_HELP)] = None
    overwrite: Overwrite = False
    show: ProgressOption = ProgressMode.AUTO
    objects_are: Annotated[
        str | None, typer.Option("--objects", help="of a scenario: point, gaussian, or the name of one of its [[objects]]")
    ] = None
    temperature_difference: Annotated[
        str | None, typer.Option("--temperature-difference", help="instead of --contrast: apparent, to the field's mean [K]")
    ] = None
    intensity: Annotated[str | None, typer.Option("--intensity", help="instead of --contrast: of a point at --range-m [W/sr]")] = None
    range_m: Annotated[float | None, typer.Option("--range-m", help="range of that point [m]")] = None
    object_height_m: Annotated[float | None, typer.Option("--object-height-m", help="its height; 5 where nothing is said [m]")] = None
    seas: Annotated[int | None, typer.Option("--frames", min=1, help="independent seas at most; 32 where nothing is said")] = None
    vary: Annotated[
        list[str] | None,
        typer.Option("--vary", metavar="KEY=A,B,C", help="values of a scenario's key, of detector, filter or threshold; repeatable"),
    ] = None
    cases: Annotated[Path | None, typer.Option("--cases", metavar="F.csv", help="a case a row, keys as headings")] = None
    report: Annotated[Path | None, typer.Option("--report", metavar="F.html", help="report with pictures")] = None
    precision: Annotated[float | None, typer.Option("--precision", help="half width of the interval of P_d that is enough")] = None
    precision_fa: Annotated[float | None, typer.Option("--precision-fa", help="the same of P_fa, as a share of it")] = None
    time_budget: Annotated[float | None, typer.Option("--time-budget", min=0.0, help="longest time for all cases [s]")] = None
    resume: Annotated[bool, typer.Option("--resume", help="go on with what is kept beside RESULT")] = False
    design: Annotated[
        bool, typer.Option("--design", help="contrast for P_d 0.9 at one false alarm per hour and field, and the loss against white noise")
    ] = False
    p_fa: Annotated[float | None, typer.Option("--p-fa", help="for --design and --range: rate per pixel instead")] = None
    alarms_per_hour: Annotated[float | None, typer.Option("--alarms-per-hour", help="or so many false alarms an hour")] = None
    wanted_p_d: Annotated[float | None, typer.Option("--p-d", help="for --design and --range: P_d wanted instead of 0.9")] = None
    find_range: Annotated[bool, typer.Option("--range", help="range up to which an object of the scenario is detected")] = False
    object_name: Annotated[str | None, typer.Option("--object", metavar="NAME", help="which of the [[objects]], for --range")] = None
    range_limits: Annotated[str | None, typer.Option("--range-limits", metavar="NEAR:FAR", help="ranges tried; 500:40000 [m]")] = None
    bearings: Annotated[
        str | None, typer.Option("--bearings", help="for --range: from the Sun's azimuth, clockwise, e.g. 0:330:30 [deg]")
    ] = None
    sensor_preset: SensorPreset = None
    workers: WorkersOption = None
    dask: DaskOption = None
    dask_slurm: DaskSlurmOption = None

    def given(self, names: tuple[str, ...]) -> list[str]:
        """Those of some options that were set, as they are typed."""
        plain = {field.name: field.default for field in fields(self)}
        return [typed(name) for name in names if getattr(self, name) != plain[name]]

    @property
    def contrasts(self) -> tuple[float, ...] | None:
        """Contrasts, where they are stated."""
        return None if self.contrast is None else contrasts_of(self.contrast)

    @property
    def shape(self) -> SpotShape:
        """The object's shape.

        Raises
        ------
        DataError
            Two of them.
        """
        from seaglint.base.errors import DataError
        from seaglint.detection.spot import GaussianSpot, SampledSpot

        if self.psf is None:
            return GaussianSpot(0.8 if self.object_sigma_px is None else self.object_sigma_px)
        if self.object_sigma_px is not None:
            raise DataError("--psf and --object-sigma-px are two shapes of one object; give one of them")
        return SampledSpot(weights(self.psf))

    @property
    def shape_is_given(self) -> bool:
        """Whether a shape of the user's is meant rather than that of a point or a named object."""
        return self.psf is not None or self.object_sigma_px is not None or self.objects_are == "gaussian"

    def objects(self, contrasts: tuple[float, ...]) -> InjectedObjects:
        """What is injected."""
        from seaglint.detection.trials import InjectedObjects

        return InjectedObjects(
            self.shape,
            contrasts,
            self.injections,
            self.placement,
            self.match_radius,
            _velocity(self.velocity),
            self.pointing,
            self.seed,
            self.duration,
        )

    @property
    def of_scenario(self) -> bool:
        """Whether frames are rendered."""
        return Path(self.recording).suffix.lower() == ".toml"

    def judged(
        self, objects: InjectedObjects, frame_rate: float | None = None, pixel_deg: tuple[float, float] | None = None
    ) -> DetectionOptions:
        """Detector, filter and threshold; of frames at that rate [Hz] with pixels of that angle [deg]."""
        from seaglint.studies.detect.performance import DetectionOptions

        chosen = filter_of(self.filter_name, self.kernel, self.signature)
        law, level, limit = self.threshold_law, self.level, self.time_limit
        return DetectionOptions(objects, self.detector, chosen, self.threshold, law, level, frame_rate, pixel_deg, limit)


def _velocity(text: str) -> tuple[float, float]:
    """Rows and columns a frame, of X,Y."""
    from seaglint.base.errors import DataError

    try:
        right, down = (float(part) for part in text.split(","))
    except ValueError:
        raise DataError(f"--velocity {text}: give X,Y in pixels a frame, to the right and down, e.g. 0.5,0") from None
    return down, right


def _annotations() -> dict[str, Any]:
    return get_type_hints(DetectOptions, include_extras=True)


def typed(name: str) -> str:
    """An option as it is typed."""
    (told,) = (value for value in _annotations()[name].__metadata__ if isinstance(value, typer.models.ParameterInfo))
    return str(told.default)


def with_options(command: Callable[[DetectOptions], None]) -> Callable[..., None]:
    """A command that takes every field of :class:`DetectOptions` as an argument or option of its own."""
    hints = _annotations()
    parameters = [
        inspect.Parameter(
            field.name,
            inspect.Parameter.POSITIONAL_OR_KEYWORD,
            default=inspect.Parameter.empty if field.default is MISSING else field.default,
            annotation=hints[field.name],
        )
        for field in fields(DetectOptions)
    ]

    @wraps(command)
    def called(**given: Any) -> None:
        command(DetectOptions(**given))

    called.__annotations__ = {**hints, "return": None}
    called.__signature__ = inspect.Signature(parameters, return_annotation=None)  # type: ignore[attr-defined]
    return called
