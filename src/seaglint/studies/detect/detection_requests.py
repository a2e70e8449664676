"""Requests for a detection study, one record for each kind: of a recording, of scenes, of the contrast needed, of the range.

The commands ``seaglint detect recording``, ``scene``, ``design`` and ``range`` make their options from these records, and Python passes the
same names. Importing this module loads nothing else: a help page needs it.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final, Literal

from seaglint.base.parameters import Parameter
from seaglint.studies.study_requests import ReadingRequest, WeightsFile, filter_of, values_of

if TYPE_CHECKING:
    from seaglint.clutter.filters import Filter
    from seaglint.detection.spot import SpotShape
    from seaglint.detection.trials import InjectedObjects
    from seaglint.studies.detect.designer import Design
    from seaglint.studies.detect.injected import Strength
    from seaglint.studies.detect.performance import DetectionOptions
    from seaglint.studies.detect.range_search import RangeOptions
    from seaglint.studies.detect.rendered_seas import SceneOptions


USUAL_DETECTOR: Final = "threshold"  #: Detector of a request that names none.

USUAL_THRESHOLD: Final = 4.0  #: Threshold of a request that gives none, in the unit of its law.


@dataclass(frozen=True)
class DetectorRequest:
    """Parameters that all kinds of request share: the detector and the injection of objects.

    Each has a line of help. ``velocity`` is (down, right) in Python; ``kernel`` and ``signature`` are arrays or :class:`WeightsFile`.
    """

    source: Annotated[str, Parameter("recording or scenario", "")]
    detector: Annotated[
        str | None,
        Parameter(
            "threshold, matched, matched-global, matched-local, log, top-hat, max-mean, max-median, patch-image, ca-cfar, os-cfar, "
            "os-cfar-exponential, temporal-profile, track-before-detect, frame-difference, integration, or package.module:function",
            "Detector",
            subject="detector:",
            python="Detector: threshold, matched, matched-global, matched-local, log, top-hat, max-mean, max-median, patch-image, ca-cfar, "
            "os-cfar, os-cfar-exponential, temporal-profile, track-before-detect, frame-difference, integration, or "
            "package.module:function.",
            detail="Where nothing is said `threshold`; of a recording without `contrast` matched-local; of a range the best of "
            "matched, matched-global, matched-local, ca-cfar and max-median.",
        ),
    ] = None
    filter: Annotated[
        str,
        Parameter(
            "before the detector: laplacian, difference-of-gaussians, median-subtraction, top-hat, matched, none",
            "Detector",
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
    time_limit: Annotated[float, Parameter("longest time of a call of your own detector [s]", "Detector")] = 60.0
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
        """Shape of the objects; of a request without one a spot of 0.8 px."""
        from seaglint.detection.spot import GaussianSpot

        return GaussianSpot(0.8)

    @property
    def usual_detector(self) -> str:
        """Detector where none is named."""
        return USUAL_DETECTOR

    def injected(self, contrasts: tuple[float, ...]) -> InjectedObjects:
        """Return the objects to inject, at some contrasts."""
        from seaglint.detection.trials import InjectedObjects

        return InjectedObjects(
            self.spot,
            contrasts,
            self.injections,
            self.placement,
            self.match_radius,
            (self.velocity[1], self.velocity[0]),
            self.pointing,
            self.seed,
            self.duration,
        )

    def detection(
        self, contrasts: tuple[float, ...], frame_rate: float | None = None, pixel_deg: tuple[float, float] | None = None
    ) -> DetectionOptions:
        """Return detector, filter, threshold and objects, for frames at that rate [Hz] with pixels of that angle [deg].

        Raises
        ------
        DataError
            A law of thresholds that there is not.
        """
        from seaglint.base.errors import DataError
        from seaglint.studies.detect.performance import DetectionOptions

        if self.threshold_law not in ("sigma", "frame", "fixed", "design"):
            raise DataError(f"threshold_law = {self.threshold_law!r} is not one of sigma, frame, fixed, design; give one of them")
        law, level, limit = self.threshold_law, self.level, self.time_limit
        objects, chosen = self.injected(contrasts), self._filter()
        detector, threshold = self.detector or self.usual_detector, USUAL_THRESHOLD if self.threshold is None else self.threshold
        return DetectionOptions(objects, detector, chosen, threshold, law, level, frame_rate, pixel_deg, limit)

    def _filter(self) -> Filter:
        return filter_of(self.filter, self.kernel, self.signature)


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
            Two of them.
        """
        from seaglint.base.errors import DataError
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
            python="Frames without objects as for :func:`seaglint.api.analyze`, or a scenario, of which independent seas are rendered.",
        ),
    ]
    pixel_mrad: Annotated[float | None, Parameter("angle of a pixel, where the file does not say [mrad]", "Recording")] = None
    vary: Annotated[
        list[str] | None, Parameter("values of detector, filter or threshold; repeatable", "Detector", metavar="KEY=A,B,C|A:B:STEP")
    ] = None

    @property
    def files(self) -> list[Path]:
        """Files that are read beside the recording, which no result may replace."""
        return [given.path for given in (self.kernel, self.signature, self.psf) if isinstance(given, WeightsFile)]


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
        str | None,
        Parameter("sensor of a data sheet instead of the scenario's: 'seaglint sensor --presets' lists them", "Scenes"),
    ] = None

    @property
    def seas(self) -> int:
        """Largest number of independent seas of each case."""
        return 32 if self.frames is None else self.frames

    def scene_options(self) -> SceneOptions:
        """Return how each scene is judged."""
        from seaglint.studies.detect.rendered_seas import SceneOptions

        return SceneOptions(self.detection((1.0,)), seas=self.seas)


@dataclass(frozen=True)
class SceneRequest(CasesRequest, SpotRequest):
    """Request to evaluate a detector in independent rendered seas of a scenario."""

    source: Annotated[str, Parameter("scenario file; 'seaglint init my.toml' writes one", "", metavar="SCENARIO.toml")]
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

    def strength(self) -> Strength | None:
        """Return the contrasts as they are stated; None where nothing is said.

        Raises
        ------
        DataError
            Two statements of one thing, or the intensity of what is no point.
        """
        from seaglint.base.errors import DataError
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

    def design(self) -> Design | None:
        """Return what is asked about needed contrasts; nothing."""
        return None

    def scene_options(self) -> SceneOptions:
        """Return how each scene is judged."""
        from seaglint.studies.detect.rendered_seas import SceneOptions

        design = self.design()
        own = self.psf is not None or self.object_sigma_px is not None or self.objects == "gaussian"
        shape = self.spot if own else None
        judged, strength = self.detection((1.0,)), self.strength()
        return SceneOptions(judged, self.objects or "point", strength, shape, self.seas, self.precision, self.precision_fa, design)


@dataclass(frozen=True)
class RateRequest:
    """Parameters of what counts as detected: P_d and the rate of false alarms."""

    p_fa: Annotated[float | None, Parameter("rate of false alarms per pixel, instead of per hour", "Design")] = None
    alarms_per_hour: Annotated[float | None, Parameter("false alarms an hour in the whole field; default: 1", "Design")] = None
    p_d: Annotated[float | None, Parameter("P_d that is enough; default: 0.9", "Design")] = None

    def design(self) -> Design:
        """Return P_d and rate as a record."""
        from seaglint.studies.detect.designer import Design

        return Design(self.p_d or 0.9, self.p_fa, self.alarms_per_hour or 1.0)


@dataclass(frozen=True)
class DesignRequest(RateRequest, SceneRequest):
    """Request for the contrast that an object needs, and for the loss against white noise."""

    source: Annotated[str, Parameter("scenario file; 'seaglint init my.toml' writes one", "", metavar="SCENARIO.toml")]


@dataclass(frozen=True)
class RangeRequest(RateRequest, CasesRequest):
    """Request for the range up to which an object of a scenario is detected."""

    source: Annotated[str, Parameter("scenario file with [[objects]]", "", metavar="SCENARIO.toml")]
    object: Annotated[str | None, Parameter("which of the [[objects]]; may be left out where there is one", "Range", metavar="NAME")] = None
    range_limits: Annotated[tuple[float, float] | None, Parameter("ranges tried; 500:40000 [m]", "Range", "limits", "NEAR:FAR")] = None
    bearings: Annotated[
        tuple[float, ...] | None, Parameter("from the Sun's azimuth, clockwise, e.g. 0:330:30 [deg]", "Range", "numbers")
    ] = None

    precision: Annotated[float | None, Parameter("share of the range to which frames refine it; default: 0.04", "Range")] = None

    @property
    def usual_detector(self) -> str:
        """Detector where none is named, of a first estimate: the matched filter; the range itself is that of the best of a short list."""
        return "matched"

    def range_options(self, names: list[str]) -> RangeOptions:
        """Return what range is looked for, in a scenario that has objects of these names.

        Raises
        ------
        DataError
            No name, and not a single object.
        """
        from seaglint.base.errors import DataError
        from seaglint.studies.detect.designer import TRIED
        from seaglint.studies.detect.range_search import RangeOptions

        name = self.object or (names[0] if len(names) == 1 else None)
        if not names:
            raise DataError(
                'the scenario has no object to look for; add one, e.g. the three lines [[objects]], preset = "small-boat", north_m = 2000'
            )
        if name is None:
            raise DataError(f"a range is that of one object; name it with object=NAME: {', '.join(names)}")
        precision = RangeOptions.precision if self.precision is None else self.precision
        detectors = TRIED if self.detector is None else ()
        return RangeOptions(name, self.range_limits or RangeOptions.limits, self.design(), precision, detectors)
