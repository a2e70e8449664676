"""Requests for a detection study, one record for each kind: of a recording, of scenes, of the contrast needed, of the range.

The commands ``seaglint detect recording``, ``scene``, ``design`` and ``range`` make their options from these records, Python passes the
same names, and the studies take the records themselves. Importing this module loads no numerical package: a help page needs it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import degrees
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Final, Literal, Self

from seaglint.base.errors import DataError, DomainError
from seaglint.base.parameters import Parameter
from seaglint.detection.detector_names import CHOICE, TRIED
from seaglint.studies.study_requests import SEA_DRAWS, TIME_LIMIT, ReadingRequest, WeightsFile, filter_of, require_sea_draws, values_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from seaglint.detection.interface import Detector
    from seaglint.detection.spot import SpotShape
    from seaglint.studies.detect.designer import Design
    from seaglint.studies.detect.injected import Strength
    from seaglint.studies.detect.performance import DetectionOptions

USUAL_THRESHOLD: Final = 4.0  #: Threshold of a request that states none, in the unit of its law.

RANGES: Final = (500.0, 40_000.0)  #: Nearest and farthest range that is tried where none are stated [m].

PRECISION: Final = 0.04  #: Share of the range at which its bisection ends where none is stated [1].


@dataclass(frozen=True)
class DetectorRequest:
    """Parameters that all kinds of request share: the detector and the injection of objects.

    Each has a line of help. ``kernel`` and ``signature`` are arrays or ``WeightsFile``; ``filter`` may also be a filter itself.
    """

    usual_detector: ClassVar[str] = "threshold"  #: Detector of a request that names none.

    source: Annotated[str, Parameter("recording or scenario", "")]
    detector: Annotated[
        Any,
        Parameter(
            CHOICE,
            "Detector",
            "name",
            subject="detector:",
            python=f"Detector: {CHOICE}; or a function, a lambda or an object that is called with frames (time, rows, columns) and returns "
            "a statistic of that shape. None: threshold; of a recording without `contrast` matched-local; of a range the best of "
            f"{', '.join(TRIED[:-1])} and {TRIED[-1]}.",
        ),
    ] = None
    filter: Annotated[
        Any,
        Parameter(
            "before the detector: laplacian, difference-of-gaussians, median-subtraction, top-hat, matched, none",
            "Detector",
            "name",
            python="Filter before the detector: laplacian, difference-of-gaussians, median-subtraction, top-hat or none.",
        ),
    ] = "none"
    kernel: Annotated[Any, Parameter("CSV or .npy of filter weights of your own, instead of `filter`", "Detector", "weights")] = None
    signature: Annotated[Any, Parameter("CSV or .npy of the target for `filter` matched", "Detector", "weights")] = None
    threshold: Annotated[
        float | None,
        Parameter(
            "in the unit of `threshold_law`; default: 4",
            "Detector",
            subject="threshold",
            detail="Of a recording without `contrast` that of one false alarm in 10,000 pixels.",
        ),
    ] = None
    threshold_law: Annotated[
        Literal["sigma", "frame", "fixed", "design"],
        Parameter(
            "'sigma': standard deviations above the mean of all frames; 'frame': of each frame; 'fixed': the statistic's unit; "
            "'design': rate of false alarms for which the detector is designed",
            "Detector",
            subject="unit of the threshold.",
        ),
    ] = "sigma"
    time_limit: Annotated[float, TIME_LIMIT] = 60.0
    level: Annotated[float, Parameter("of the intervals", "Detector")] = 0.95
    injections: Annotated[int, Parameter("objects of each contrast", "Object", least=1)] = 2000
    placement: Annotated[
        Literal["random", "centre"],
        Parameter("'random' within pixels, or at the 'centre' of pixels", "Object", subject="places of the objects:"),
    ] = "random"
    match_radius: Annotated[float, Parameter("largest distance of a detection from the object's pixel [px]", "Object")] = 1.0
    velocity: Annotated[
        tuple[float, float],
        Parameter(
            "motion to the right and down [px a frame]",
            "Object",
            "pair",
            "X,Y",
            python="Motion of the objects to the right and down [px a frame].",
        ),
    ] = (0.0, 0.0)
    duration: Annotated[
        int, Parameter("frames for which the object is there, up to the one judged; 0: all the detector sees", "Object", least=0)
    ] = 0
    pointing: Annotated[
        Literal["least-squares", "centroid"], Parameter("place of detections by 'least-squares' or 'centroid'", "Object")
    ] = "least-squares"
    seed: Annotated[int, Parameter("of the places", "Object", least=0)] = 0

    @property
    def spot(self) -> SpotShape:
        """Shape of the objects; a spot of 0.8 px where none is stated."""
        from seaglint.detection.spot import GaussianSpot

        return GaussianSpot(0.8)

    @property
    def stated_detector(self) -> str | Detector:
        """Detector, or the name of the usual one where none is stated."""
        return self.usual_detector if self.detector in (None, "") else self.detector

    @property
    def detector_name(self) -> str:
        """Name of the detector, also where none is stated."""
        return named if isinstance(named := self.stated_detector, str) else named.name

    def detection(
        self,
        contrasts: tuple[float, ...] = (1.0,),
        frame_rate: float | None = None,
        pixel_deg: tuple[float, float] | None = None,
        shape: SpotShape | None = None,
    ) -> DetectionOptions:
        """Return detector, filter, threshold and objects, for frames at that rate [Hz] with pixels of that angle [deg].

        ``shape`` replaces the shape of the request, where a scene has its own.

        Raises
        ------
        DataError
            An unknown law of thresholds, or an unknown filter.
        DomainError
            Numbers that are not allowed.
        """
        from seaglint.detection.trials import InjectedObjects
        from seaglint.studies.detect.performance import DetectionOptions

        if self.threshold_law not in ("sigma", "frame", "fixed", "design"):
            raise DataError(f"threshold_law = {self.threshold_law!r} is not one of sigma, frame, fixed, design; give one of them")
        right, down = self.velocity  # a user states (x, y), frames are indexed by (row, column)
        objects = InjectedObjects(
            shape=shape or self.spot,
            contrasts=contrasts,
            injections=self.injections,
            placement=self.placement,
            match_radius=self.match_radius,
            velocity=(down, right),
            pointing=self.pointing,
            seed=self.seed,
            duration=self.duration,
        )
        return DetectionOptions(
            objects=objects,
            detector=self.stated_detector,
            filter=filter_of(self.filter, self.kernel, self.signature) if isinstance(self.filter, str) else self.filter,
            threshold=USUAL_THRESHOLD if self.threshold is None else self.threshold,
            law=self.threshold_law,
            level=self.level,
            frame_rate=frame_rate,
            pixel_deg=pixel_deg,
            time_limit=self.time_limit,
        )


@dataclass(frozen=True)
class SpotRequest(DetectorRequest):
    """Parameters of an object that the user describes: its contrast and its shape."""

    contrast: Annotated[
        tuple[float, ...] | None,
        Parameter(
            "what an object centred on a pixel adds to it: 4, several 1,2,4, or FIRST:LAST:STEP [units of INPUT]; "
            "of a scenario the in-band contrast at the aperture [W m-2 sr-1]; without it 0.5 to 16 standard deviations of the clutter",
            "Object",
            "numbers",
            python="What an object centred on a pixel adds to it [units of the source]; of a scenario the in-band contrast at the aperture "
            "[W m-2 sr-1]; without it 0.5 to 16 standard deviations of the clutter.",
        ),
    ] = None
    object_sigma_px: Annotated[
        float | None,
        Parameter(
            "standard deviation of the object's Gaussian blur [px]; 0.8 without `psf`",
            "Object",
            detail="Points of a scenario have the blur of its sensor where nothing is said.",
        ),
    ] = None
    psf: Annotated[
        Any,
        Parameter(
            "CSV or .npy of the object's point spread, one value a pixel, instead",
            "Object",
            "weights",
            python="Point spread of the object instead, one value a pixel.",
        ),
    ] = None

    @property
    def spot(self) -> SpotShape:
        """Shape of the objects.

        Raises
        ------
        DataError
            Two shapes are stated.
        """
        from seaglint.detection.spot import GaussianSpot, SampledSpot

        if self.psf is None:
            return GaussianSpot(0.8 if self.object_sigma_px is None else self.object_sigma_px)
        if self.object_sigma_px is not None:
            raise DataError("`psf` and `object_sigma_px` are two shapes of one object; give one of them")
        return SampledSpot(values_of(self.psf))


@dataclass(frozen=True)
class RecordingRequest(ReadingRequest, SpotRequest):
    """Request to evaluate a detector on a recording without objects."""

    source: Annotated[
        str,
        Parameter(
            "frames without objects: Zarr, NetCDF, PNG, TIFF, FITS, NumPy, HDF5, video, raw",
            "",
            metavar="INPUT",
            python="Frames without objects as for :func:`sg.analyze`, or a scenario, of which independent seas are rendered.",
        ),
    ]
    pixel_mrad: Annotated[float | None, Parameter("angle of a pixel, where the file does not say [mrad]", "Recording")] = None
    vary: Annotated[
        list[str] | None, Parameter("values of detector, filter or threshold; repeatable", "Detector", metavar="KEY=A,B,C|A:B:STEP")
    ] = None

    @property
    def files(self) -> list[Path]:
        """Files that are read together with the recording, which no result may replace."""
        return [given.path for given in (self.kernel, self.signature, self.psf) if isinstance(given, WeightsFile)]

    def pixel_deg(self, name: str) -> tuple[float, float] | None:
        """Return the stated angle of a pixel, between rows and between columns [deg]; ``name`` is the beginning of the error.

        Raises
        ------
        DataError
            An angle outside 0 to 1000 mrad.
        """
        if self.pixel_mrad is None:
            return None
        if not 0 < self.pixel_mrad < 1000:
            raise DataError(f"{name}{self.pixel_mrad:g}: give an angle above 0 and below 1000 mrad")
        return (degrees(1e-3 * self.pixel_mrad),) * 2


@dataclass(frozen=True)
class CasesRequest(DetectorRequest):
    """Parameters of a request that renders scenes: which cases of a scenario, and how many seas of each."""

    source: Annotated[str, Parameter("scenario file; 'seaglint init my.toml' writes one", "", metavar="SCENARIO.toml")]
    frames: Annotated[int | None, Parameter("independent seas at most; default: 32", "Scenes", least=1)] = None
    vary: Annotated[
        list[str] | None,
        Parameter("values of a scenario's key, of detector, filter or threshold; repeatable", "Scenes", metavar="KEY=A,B,C|A:B:STEP"),
    ] = None
    cases: Annotated[Path | None, Parameter("a case a row, keys as headings", "Scenes", metavar="F.csv")] = None
    sensor: Annotated[
        str | None, Parameter("sensor of a data sheet instead of the scenario's: 'seaglint sensor --presets' lists them", "Scenes")
    ] = None

    @property
    def seas(self) -> int:
        """Largest number of independent seas of each case."""
        return 32 if self.frames is None else self.frames

    def require_valid(self) -> None:
        """Refuse numbers that are not allowed, before anything is read or rendered.

        Raises
        ------
        SeaglintError
            The first of them.
        """
        self.detection()
        if self.seas < 1:
            raise DomainError(f"{self.seas} seas; give at least 1")

    @property
    def settings(self) -> tuple[Any, ...]:
        """Everything except the scenario on which a result depends: results are stored under a digest of it."""
        options = self.detection()
        if not isinstance(options.detector, str):
            # A detector that was given as an object is known in this process alone, and so are the parts that are stored under its number.
            options = replace(options, detector=f"{options.detector.name} {id(options.detector)}")
        return (options, self.seas)


@dataclass(frozen=True)
class SceneRequest(CasesRequest, SpotRequest):
    """Request to evaluate a detector in independent rendered seas of a scenario."""

    objects: Annotated[str | None, Parameter("of a scenario: point, gaussian, or the name of one of its [[objects]]", "Object")] = None
    temperature_difference: Annotated[
        tuple[float, ...] | None, Parameter("instead of `contrast`: apparent, to the field's mean [K]", "Object", "numbers")
    ] = None
    intensity: Annotated[
        tuple[float, ...] | None, Parameter("instead of `contrast`: of a point at `range_m` [W/sr]", "Object", "numbers")
    ] = None
    range_m: Annotated[float | None, Parameter("range of that point [m]", "Object")] = None
    object_height_m: Annotated[float | None, Parameter("its height; default: 5 [m]", "Object")] = None
    precision: Annotated[float | None, Parameter("half width of the interval of P_d that is enough", "Scenes")] = None
    precision_fa: Annotated[float | None, Parameter("the same of P_fa, as a share of it", "Scenes")] = None
    time_budget: Annotated[float | None, Parameter("longest time for all cases [s]", "Scenes", least=0)] = None
    sea_draws: Annotated[int | None, SEA_DRAWS._replace(group="Scenes")] = None

    def strength(self) -> Strength | None:
        """Return the stated contrasts with their unit; None where none are stated.

        Raises
        ------
        DataError
            Contrasts in two units, or the intensity of an object that is no point.
        """
        from seaglint.studies.detect.injected import Strength

        stated = [value for value in (self.contrast, self.temperature_difference, self.intensity) if value is not None]
        if len(stated) > 1:
            raise DataError("`contrast`, `temperature_difference` and `intensity` say the same of an object; give one of them")
        if not stated:
            return None
        if self.contrast is not None:
            return Strength(stated[0])
        if self.intensity is not None and (self.objects or "point") != "point":
            raise DataError(f"`intensity` is that of a point, and objects = {self.objects}; give objects=point")
        height = 5.0 if self.object_height_m is None else self.object_height_m
        return Strength(stated[0], "K" if self.intensity is None else "W/sr", self.range_m, height)

    @property
    def kind(self) -> str:
        """Kind of the objects: point, gaussian, or the name of one of the scenario's objects."""
        return self.objects or "point"

    @property
    def own_shape(self) -> SpotShape | None:
        """Stated shape of the objects; None where the scene gives it."""
        return self.spot if self.psf is not None or self.object_sigma_px is not None or self.kind == "gaussian" else None

    def design(self) -> Design | None:
        """Return the request for a needed contrast; None here."""
        return None

    def require_valid(self) -> None:
        """Refuse numbers that are not allowed, see ``CasesRequest.require_valid``."""
        self.design()
        super().require_valid()
        self.strength()
        require_sea_draws(self.sea_draws)
        for name, value in (("precision", self.precision), ("precision of P_fa", self.precision_fa)):
            if value is not None and not 0.0 < value < 1.0:
                raise DomainError(f"{name} = {value:g} is not between 0 and 1; give e.g. 0.02")

    @property
    def settings(self) -> tuple[Any, ...]:
        """Everything except the scenario on which a result depends, see ``CasesRequest.settings``."""
        scene = (self.kind, self.strength(), self.own_shape, self.precision, self.precision_fa, self.design())
        return (*super().settings, *scene)


@dataclass(frozen=True)
class RateRequest:
    """Parameters of what counts as detected: P_d and the rate of false alarms."""

    p_fa: Annotated[float | None, Parameter("rate of false alarms per pixel, instead of per hour", "Design")] = None
    alarms_per_hour: Annotated[float | None, Parameter("false alarms an hour in the whole field; default: 1", "Design")] = None
    p_d: Annotated[float | None, Parameter("P_d that is enough; default: 0.9", "Design")] = None

    def design(self) -> Design:
        """Return the P_d and the rate of false alarms at which an object counts as detected."""
        from seaglint.studies.detect.designer import Design

        return Design(self.p_d or 0.9, self.p_fa, self.alarms_per_hour or 1.0)


@dataclass(frozen=True)
class DesignRequest(RateRequest, SceneRequest):
    """Request for the contrast that an object needs, and for the loss against white noise."""


@dataclass(frozen=True)
class RangeRequest(RateRequest, CasesRequest):
    """Request for the range up to which an object of a scenario is detected.

    Without a stated detector the matched filter gives the first estimate, and the range itself is that of the best of a short list.
    """

    usual_detector: ClassVar[str] = "matched"

    source: Annotated[str, Parameter("scenario file with [[objects]]", "", metavar="SCENARIO.toml")]
    object: Annotated[str | None, Parameter("which of the [[objects]]; may be left out where there is one", "Range", metavar="NAME")] = None
    range_limits: Annotated[tuple[float, float] | None, Parameter("ranges tried; 500:40000 [m]", "Range", "limits", "NEAR:FAR")] = None
    bearings: Annotated[
        tuple[float, ...] | None, Parameter("from the Sun's azimuth, clockwise, e.g. 0:330:30 [deg]", "Range", "numbers")
    ] = None

    precision: Annotated[float | None, Parameter("share of the range to which frames refine it; default: 0.04", "Range")] = None

    @property
    def limits(self) -> tuple[float, float]:
        """Nearest and farthest range that is tried [m]."""
        return self.range_limits or RANGES

    @property
    def share(self) -> float:
        """Share of the range at which the bisection ends [1]."""
        return PRECISION if self.precision is None else self.precision

    @property
    def settings(self) -> tuple[Any, ...]:
        """Everything except the scenario on which P_d at a range depends, see ``CasesRequest.settings``."""
        return (*super().settings, self.design())

    def of_objects(self, names: Sequence[str]) -> Self:
        """Return the request with its object's name, in a scenario that has objects of these names.

        Raises
        ------
        DataError
            No name, and not a single object.
        DomainError
            Ranges, precision, P_d or a rate that are not allowed.
        """
        name = self.object or (names[0] if len(names) == 1 else None)
        if not names:
            raise DataError(
                'the scenario has no object to look for; add one, e.g. the three lines [[objects]], preset = "small-boat", north_m = 2000'
            )
        if name is None:
            raise DataError(f"a range is that of one object; name it with object=NAME: {', '.join(names)}")
        self.design()
        near, far = self.limits
        if not 0.0 < near < far:
            raise DomainError(f"ranges from {near:g} to {far:g} m; give two rising numbers above 0")
        if not 0.0 < self.share < 1.0:
            raise DomainError(f"precision = {self.share:g} is not between 0 and 1; it is a share of the range, e.g. 0.04")
        return replace(self, object=name)
