"""Table ``[sensor]``: place, direction and pixels of the sensor, and its tables.

``[sensor.optics]`` is the optics before the detector, ``[sensor.detector]`` its pixels, ``[sensor.noise]`` the noise beyond shot, dark and
read noise, and ``[sensor.scan]`` the time at which each column and row is taken.
"""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, StrictBool, TypeAdapter, ValidationError, ValidationInfo, model_validator

from seaglint.base.limits import SHAKEN, SMEARED, TOP_OF_AIR, WIDEST_PINHOLE_DEG
from seaglint.base.reports import REPORTS
from seaglint.scenario.records.quantities import Azimuth, InputFile, Quantity, Record, about, default_tag, rule

_Exposure = Annotated[float, Quantity("s", gt=0, le=1e4)]
_FNumber = Annotated[float, Quantity(ge=0.5, le=200)]
_Side = Annotated[int, Quantity(ge=1, le=65_536, integer=True)]

Rms = Quantity("", ge=0, le=1e12)
Share = Quantity(ge=0, le=1)

HIGHEST_SENSOR = TOP_OF_AIR  #: Greatest height of a sensor [m].

SPACE = "space"  #: Word for the height of the top of the air, above which nothing changes on the way to a satellite but the range.

SQUARE_PIXEL_TOLERANCE = 0.01  #: Relative difference of the pixel's two angular sides up to which it counts as square.

MOST_OBLONG = 3.0  #: Ratio of a pixel's sides from which a mistyped number is likelier than a line scanner.

#: Ratio of sides above which an image upright in pixels and wide in degrees (or the reverse) counts as swapped numbers.
REVERSED_OBLONG = 1.5

AGREEMENT = 0.005  #: Relative difference up to which two ways of giving the same number agree, since data sheets round.


class PhotonDetector(Record):
    """Pixels that count photons: InSb, MCT and others; what is left out is neutral."""

    kind: Literal["photon"] = "photon"
    pitch_um: Annotated[float, Quantity("um", gt=0, le=1000), about("distance of the pixels' centres")]
    fill_factor: Annotated[float, Quantity(gt=0, le=1), about("share of a pixel's area that is sensitive")] = 1.0
    integration_time_s: Annotated[_Exposure | None, about("integration time; default: a whole frame")] = None
    short_integration_time_s: Annotated[
        _Exposure | None, about("second, shorter integration after the first, taken where that saturates (high dynamic range)")
    ] = None
    quantum_efficiency: Annotated[float, Quantity(gt=0, le=1), about("electrons for each photon in the band")] = 1.0
    quantum_efficiency_file: Annotated[
        InputFile | None, about("CSV file with columns wavelength_um, response; its peak is quantum_efficiency, over the whole band")
    ] = None
    well_capacity_e: Annotated[
        Annotated[float, Quantity("", gt=0, le=1e12)] | None, about("electrons that a pixel holds; any number where left out")
    ] = None
    read_noise_e: Annotated[float, Quantity("", ge=0, le=1e9), about("rms noise of a reading in electrons")] = 0.0
    dark_current_e_s: Annotated[float, Quantity("", ge=0, le=1e15), about("dark current in electrons per second")] = 0.0
    bit_depth: Annotated[int, Quantity(ge=1, le=16, integer=True), about("bits of a count")] = 16
    gain_e_per_count: Annotated[
        Annotated[float, Quantity("", gt=0, le=1e9)] | None,
        about("electrons for each count; where left out a full well (or a blackbody of 400 K) fills the counts"),
    ] = None
    offset_counts: Annotated[float, Quantity("", ge=0, le=65_535), about("counts without electrons")] = 0.0
    crosstalk: Annotated[float, Quantity(ge=0, le=0.8), about("share of the electrons that the four neighbours get")] = 0.0
    netd_k: Annotated[
        Annotated[float, Quantity("K", gt=0, le=100)] | None,
        about(
            "noise-equivalent temperature difference of the data sheet: gives the read noise beside integration_time_s, the "
            "integration time without it"
        ),
    ] = None
    netd_temperature_k: Annotated[float, Quantity("K", ge=200, le=400), about("blackbody temperature for which netd_k is stated")] = 300.0

    @model_validator(mode="after")
    def _is_possible(self) -> Self:
        if self.netd_k is not None and self.integration_time_s is not None and self.read_noise_e > 0.0:
            text = (
                f"= {self.netd_k:g} is given beside integration_time_s and read_noise_e, and any two of the three give the third; "
                "leave one out ('seaglint sensor' prints it)"
            )
            raise rule("sensor.detector.netd_k", text, value=self.netd_k)
        if self.well_capacity_e is not None and self.well_capacity_e <= self.read_noise_e:
            text = f"= {self.well_capacity_e:g} is not above sensor.detector.read_noise_e = {self.read_noise_e:g}; correct one of them"
            raise rule("sensor.detector.well_capacity_e", text, value=self.well_capacity_e, allowed=f"above {self.read_noise_e:g}")
        if self.short_integration_time_s is not None and self.well_capacity_e is None:
            text = "is missing beside short_integration_time_s, which is taken where the well is full; add it"
            raise rule("sensor.detector.well_capacity_e", text)
        _require_offset(self)
        return self


class ThermalDetector(Record):
    """Pixels that answer to absorbed power, with a lag and the noise that a data sheet states: microbolometers."""

    kind: Literal["thermal"]
    pitch_um: Annotated[float, Quantity("um", gt=0, le=1000), about("distance of the pixels' centres")]
    netd_k: Annotated[float, Quantity("K", gt=0, le=100), about("noise-equivalent temperature difference of the data sheet")]
    netd_f_number: Annotated[float, Quantity(ge=0.5, le=20), about("f-number of the optics for which netd_k is stated")] = 1.0
    netd_temperature_k: Annotated[float, Quantity("K", ge=200, le=400), about("blackbody temperature for which netd_k is stated")] = 300.0
    time_constant_s: Annotated[float, Quantity("s", ge=0, le=10), about("time constant of the exponential lag")] = 0.0
    fill_factor: Annotated[float, Quantity(gt=0, le=1), about("share of a pixel's area that absorbs")] = 1.0
    absorptance: Annotated[float, Quantity(gt=0, le=1), about("share of the power that is absorbed")] = 1.0
    full_scale_k: Annotated[float, Quantity("K", ge=300, le=3000), about("blackbody that fills the counts")] = 433.15
    bit_depth: Annotated[int, Quantity(ge=1, le=16, integer=True), about("bits of a count")] = 16
    offset_counts: Annotated[float, Quantity("", ge=0, le=65_535), about("counts without power")] = 0.0

    @model_validator(mode="after")
    def _is_possible(self) -> Self:
        _require_offset(self)
        return self


def _require_offset(detector: PhotonDetector | ThermalDetector) -> None:
    """Refuse an offset that fills all counts."""
    if detector.offset_counts >= (1 << detector.bit_depth) - 1:
        text = f"= {detector.offset_counts:g} leaves nothing of {detector.bit_depth} bits; give a lower offset or a greater bit_depth"
        raise rule("sensor.detector.offset_counts", text, value=detector.offset_counts)


Detector = Annotated[Annotated[PhotonDetector | ThermalDetector, Field(discriminator="kind")], default_tag("kind", "photon")]


class Noise(Record):
    """Noise in units of the signal: electrons of a photon detector, nanowatts of a thermal one."""

    temporal: Annotated[StrictBool, about("noise that changes from frame to frame: shot, dark, read, 1/f")] = True
    fixed_pattern: Annotated[StrictBool, about("what stays: gain and offset of the pixels, dead, hot and blinking ones")] = True
    one_over_f: Annotated[float, Rms, about("rms of a pixel's 1/f noise over a thousand frames")] = 0.0
    frame: Annotated[float, Rms, about("rms of what a whole frame has in common, anew in each (T)")] = 0.0
    row: Annotated[float, Rms, about("rms of the rows' fixed offsets (V)")] = 0.0
    column: Annotated[float, Rms, about("rms of the columns' fixed offsets (H)")] = 0.0
    row_temporal: Annotated[float, Rms, about("rms of the rows' offsets that are new in each frame (TV)")] = 0.0
    column_temporal: Annotated[float, Rms, about("rms of the columns' offsets that are new in each frame (TH)")] = 0.0
    gain_spread: Annotated[float, Share, about("rms relative spread of the pixels' gain (PRNU)")] = 0.0
    offset_spread: Annotated[float, Rms, about("rms spread of the pixels' offset (VH)")] = 0.0
    curvature_spread: Annotated[float, Share, about("rms spread of the relative deviation from a straight line at full scale")] = 0.0
    corrected_at_k: Annotated[
        tuple[Annotated[float, Quantity("K", ge=200, le=1000)], Annotated[float, Quantity("K", ge=200, le=1000)]] | None,
        about("two-point correction at blackbodies of these temperatures: takes the spreads of gain and offset off"),
    ] = None
    drift_per_hour: Annotated[float, Rms, about("rms change of the pixels' offsets in an hour since the first frame")] = 0.0
    dead_share: Annotated[float, Share, about("share of the pixels that see nothing")] = 0.0
    hot_share: Annotated[float, Share, about("share of the pixels with a high dark signal")] = 0.0
    hot_signal: Annotated[float, Rms, about("their dark signal")] = 0.0
    blinking_share: Annotated[float, Share, about("share of the pixels that jump between two levels")] = 0.0
    blinking_signal: Annotated[float, Rms, about("distance of the levels")] = 0.0
    blinking_time_s: Annotated[float, Quantity("s", gt=0, le=1e6), about("mean time between jumps")] = 1.0

    @model_validator(mode="after")
    def _shares_fit(self) -> Self:
        total = self.dead_share + self.hot_share + self.blinking_share
        if total > 1.0:
            text = f"= {self.dead_share:g} with hot_share and blinking_share is {total:g} of the pixels; give shares up to 1 in all"
            raise rule("sensor.noise.dead_share", text, value=self.dead_share)
        if self.corrected_at_k is not None and self.corrected_at_k[0] == self.corrected_at_k[1]:
            text = f"= [{self.corrected_at_k[0]:g}, {self.corrected_at_k[1]:g}] is one temperature; give two"
            raise rule("sensor.noise.corrected_at_k", text, value=self.corrected_at_k)
        return self


class Optics(Record):
    """Aperture, focal length, blur and losses; what is left out is neutral."""

    aperture_m: Annotated[Annotated[float, Quantity("m", gt=0, le=10)] | None, about("diameter of the entrance pupil")] = None
    f_number: Annotated[_FNumber | None, about("focal length over aperture; 0.5 is the sine condition's end")] = None
    focal_length_m: Annotated[Annotated[float, Quantity("m", gt=0, le=100)] | None, about("focal length")] = None
    ifov_urad: Annotated[
        Annotated[float, Quantity("urad", gt=0, le=1e5)] | None,
        about("angle between pixels, pitch over focal length; one of several ways to give the focal length"),
    ] = None
    transmission: Annotated[float, Quantity(gt=0, le=1), about("transmission of the optics in the band")] = 1.0
    obscuration: Annotated[float, Quantity(ge=0, lt=1), about("diameter of the central obscuration over that of the pupil")] = 0.0
    wavefront_error_waves: Annotated[
        float, Quantity(ge=0, le=0.18), about("rms wavefront error in waves of the mean wavelength (Shannon's fit)")
    ] = 0.0
    defocus_waves: Annotated[
        float, Quantity(ge=0, le=10), about("path error of defocus at the pupil's edge, in waves of the mean wavelength")
    ] = 0.0
    jitter_urad: Annotated[
        float, Quantity("urad", ge=0, le=1e5), about("rms movement of the line of sight in an exposure, each direction")
    ] = 0.0
    drift_along_urad_s: Annotated[float, Quantity("urad/s", ge=-1e8, le=1e8), about("steady movement of the line of sight along rows")] = (
        0.0
    )
    drift_across_urad_s: Annotated[float, Quantity("urad/s", ge=-1e8, le=1e8), about("the same across rows")] = 0.0
    solid_angle: Annotated[
        Literal["sine", "thin-lens"],
        about("pi/(4F^2) of optics that obey the sine condition, or pi/(4F^2 + 1) of a thin lens; 6 % apart at F/2"),
    ] = "sine"
    temperature_k: Annotated[float, Quantity("K", ge=50, le=400), about("temperature of warm optics and housing")] = 293.15
    emissivity: Annotated[float, Quantity(ge=0, le=1), about("emissivity of warm optics, 1 - transmission for lenses")] = 0.0
    cold_shield_f_number: Annotated[
        _FNumber | None, about("f-number of the cold shield; below that of the optics it lets the warm housing in, else it fits")
    ] = None
    stray_share: Annotated[float, Quantity(ge=0, lt=1), about("share of the light scattered evenly over the picture")] = 0.0
    cos4: Annotated[StrictBool, about("illumination falls with the fourth power of the field angle's cosine")] = False
    distortion: Annotated[
        float, Quantity(ge=-0.3, le=0.3), about("relative radial shift of the picture's corners; positive is pincushion")
    ] = 0.0


class Scan(Record):
    """Staring array, line scanner or rotating panoramic scanner."""

    kind: Annotated[
        Literal["staring", "line", "panoramic"], about("all columns at once; one after the other; or round and round over 360 deg")
    ] = "staring"
    period_s: Annotated[
        Annotated[float, Quantity("s", ge=0, le=1e5)] | None,
        about("time of a scan or a turn; default: a frame; 0 takes all columns at once"),
    ] = None
    direction: Annotated[Literal["right", "left"], about("way in which a scanner goes; right is clockwise")] = "right"
    row_time_s: Annotated[
        float, Quantity("s", ge=0, le=1), about("time from row to row of a rolling shutter, from the top; 0 is a global one")
    ] = 0.0

    @model_validator(mode="after")
    def _one_way_of_time(self) -> Self:
        if self.kind == "staring" and self.period_s is not None:
            raise rule("sensor.scan.period_s", "is for scanners; leave it out, or set sensor.scan.kind = 'line' or 'panoramic'")
        if self.kind != "staring" and self.row_time_s > 0.0:
            raise rule("sensor.scan.row_time_s", "is for staring arrays with a rolling shutter; leave it out, or set kind = 'staring'")
        return self


_PIXELS = (512, 256)
_DETECTOR: TypeAdapter[Detector] = TypeAdapter(Detector)


def _from_space(raw: object) -> object:
    """Return the top of the air for the word ``space`` and report it; return any other value unchanged."""
    if raw != SPACE:
        return raw
    text = "sensor.height_m = 'space': the sensor is at the top of the air, %g m; ranges and pixels are those seen from there"
    REPORTS.warning(text, TOP_OF_AIR)
    return TOP_OF_AIR


class Sensor(Record):
    """Where the sensor stands and looks, and its pixels."""

    height_m: Annotated[
        float,
        Quantity("m", gt=0, le=HIGHEST_SENSOR, advice="for a satellite write 'space', the top of the air"),
        BeforeValidator(_from_space),
        about("height above the mean sea, or 'space' for the top of the air, 100 km; with the table atmosphere 2 m to 10 km"),
    ] = 30.0
    azimuth_deg: Annotated[Azimuth, about("azimuth of the image centre, clockwise from north")] = 180.0
    elevation_deg: Annotated[
        float, Quantity("deg", ge=-90, le=90), about("elevation of the image centre; horizontal 0, looking down negative")
    ] = -3.5
    roll_deg: Annotated[
        float,
        Quantity("deg", ge=-360, le=360),
        about("turn about the line of sight, clockwise as seen from behind the sensor (right side down)"),
    ] = 0.0
    projection: Annotated[
        Literal["equal-angle", "pinhole"],
        about("equal steps of azimuth and elevation (a scanner, panoramas), or a plane image behind a lens"),
    ] = "equal-angle"
    fov_deg: Annotated[
        tuple[Annotated[float, Quantity("deg", gt=0, le=360)], Annotated[float, Quantity("deg", gt=0, le=180)]],
        about("field of view [width, height]"),
    ] = (16.0, 8.0)
    pixels: Annotated[tuple[_Side, _Side], about("number of pixels [width, height]")] = _PIXELS
    pixel_shape: Annotated[
        Literal["auto", "square", "any"],
        about(
            "auto refuses fields of view that disagree with the pixels (sides beyond 3:1, or 1.5:1 with width and height "
            "reversed); square refuses pixels not square within 1 %; any refuses none"
        ),
    ] = "auto"
    frame_rate_hz: Annotated[float, Quantity("Hz", ge=1e-5, le=100_000), about("frames per second")] = 25.0
    frames: Annotated[int, Quantity(ge=1, le=10_000_000, integer=True), about("number of frames")] = 100
    optics: Annotated[Optics | None, about("optics; with the detector they make counts of radiance")] = None
    detector: Annotated[Detector | None, about("the detector's pixels")] = None
    scan: Annotated[Scan | None, about("when each column and row is taken; all at once without it")] = None
    noise: Annotated[Noise | None, about("what the detector adds beyond shot, dark and read noise")] = None

    @property
    def ifov_deg(self) -> tuple[float, float]:
        """Return the angular size of a pixel (width, height) [deg]."""
        return self.fov_deg[0] / self.pixels[0], self.fov_deg[1] / self.pixels[1]

    @property
    def senses(self) -> bool:
        """Return true where the sensor has a detector, so that radiance becomes counts."""
        return self.detector is not None

    @property
    def fov_follows(self) -> bool:
        """Return true where the field of view follows from the pixels and the focal length that the optics state."""
        return self.optics is not None and self.detector is not None and bool(_focal_lengths(self.optics, self.detector))

    @property
    def focal_length_m(self) -> float:
        """Return the focal length [m] from any of the keys that give it; all that are given agree."""
        assert self.optics is not None
        assert self.detector is not None
        return next(iter(_focal_lengths(self.optics, self.detector).values()), _from_view(self.fov_deg, self.pixels, self))

    @property
    def aperture_m(self) -> float:
        """Return the diameter of the aperture [m]."""
        assert self.optics is not None
        if self.optics.aperture_m is not None:
            return self.optics.aperture_m
        assert self.optics.f_number is not None
        return self.focal_length_m / self.optics.f_number

    @model_validator(mode="before")
    @classmethod
    def _field_of_view_of_the_optics(cls, raw: Any, info: ValidationInfo) -> Any:
        """Derive a field of view that is not given from the pixels and the focal length."""
        if not isinstance(raw, dict) or raw.get("fov_deg") is not None or raw.get("optics") is None or raw.get("detector") is None:
            return raw
        try:
            optics = Optics.model_validate(raw["optics"], context=info.context)
            detector = _DETECTOR.validate_python(raw["detector"], context=info.context)
            columns, rows = (int(n) for n in raw.get("pixels", _PIXELS))
        except (ValidationError, TypeError, ValueError):
            return raw  # their own validation reports the mistakes
        focal = next(iter(_focal_lengths(optics, detector).values()), None)
        if focal is None or columns < 1 or rows < 1:
            return raw
        view = _view_of(focal, detector, (columns, rows), raw.get("projection") == "pinhole")
        scan = raw.get("scan")
        if isinstance(scan, dict) and scan.get("kind") == "panoramic":
            view[0] = 360.0
        if view[0] > 360.0 or view[1] > 180.0:
            text = (
                f"would be {view[0]:.4g} x {view[1]:.4g} deg: {columns} x {rows} pixels of {detector.pitch_um:g} um at a focal length of "
                f"{focal:.4g} m; allowed: up to 360 x 180 deg: give fewer pixels, a smaller pitch_um or a longer focal length"
            )
            raise rule("sensor.fov_deg", text, value=view, allowed="up to 360 x 180 deg")
        return {**raw, "fov_deg": view}

    @model_validator(mode="after")
    def _sensor_is_whole(self) -> Self:
        if self.optics is None and self.detector is None:
            for name in ("scan", "noise"):
                if getattr(self, name) is not None:
                    raise rule(f"sensor.{name}", "is given without [sensor.optics] and [sensor.detector]; add them or leave it out")
            return self
        if self.optics is None or self.detector is None:
            missing = "optics" if self.optics is None else "detector"
            needs = "aperture_m and f_number" if self.optics is None else "pitch_um"
            raise rule(f"sensor.{missing}", f"is missing: a sensor has [sensor.optics] and [sensor.detector]; add it with {needs}")
        if self.optics.distortion and self.scan is not None and self.scan.kind != "staring":
            text = f"= {self.optics.distortion:g} is of pictures on a focal plane, and a scanner makes its columns one by one; leave it out"
            raise rule("sensor.optics.distortion", text, value=self.optics.distortion)
        _require_focal_length(self, self.optics, self.detector)
        _require_times(self)
        _require_steady(self, self.optics, self.detector)
        return self

    @model_validator(mode="after")
    def _image_is_possible(self) -> Self:
        (width, height), (nx, ny) = self.fov_deg, self.pixels
        dx, dy = self.ifov_deg
        if self.projection == "pinhole" and max(width, height) > WIDEST_PINHOLE_DEG:
            text = f"= [{width:g}, {height:g}] is too wide for sensor.projection = 'pinhole'; allowed: up to {WIDEST_PINHOLE_DEG:g} deg"
            raise rule("sensor.fov_deg", f"{text}, or 'equal-angle'", value=self.fov_deg, allowed=f"up to {WIDEST_PINHOLE_DEG:g} deg")
        # Width and height of pixels and view in opposite order hint at swapped numbers, so less oblong pixels are refused.
        reverse = (nx - ny) * (width - height) < 0
        most = {"auto": REVERSED_OBLONG if reverse else MOST_OBLONG, "square": 1.0 + SQUARE_PIXEL_TOLERANCE, "any": float("inf")}
        if max(dx, dy) > most[self.pixel_shape] * min(dx, dy):
            text = (
                f"= [{nx}, {ny}] disagrees with sensor.fov_deg = [{width:g}, {height:g}]: a pixel would be {dx:.4g} x {dy:.4g} deg; "
                f"for square pixels use pixels = [{nx}, {max(round(nx * height / width), 1)}], or set sensor.pixel_shape = 'any'"
            )
            raise rule("sensor.pixels", text, value=self.pixels)
        # Rows of an equal-angle picture beyond the zenith would repeat directions of other columns.
        top, bottom = self.elevation_deg + 0.5 * height, self.elevation_deg - 0.5 * height
        if self.projection == "equal-angle" and (top > 90.0 or bottom < -90.0):
            reach = f"reaches from {bottom:g} to {top:g} deg; allowed is -90 to 90 deg, or sensor.projection = 'pinhole'"
            text = f"= {self.elevation_deg:g} with a field of view {height:g} deg high {reach}"
            raise rule("sensor.elevation_deg", text, value=self.elevation_deg)
        return self


def _focal_lengths(optics: Optics, detector: Detector) -> dict[str, float]:
    """Return the focal lengths by the keys that give them [m]; ``focal_length_m`` first."""
    out = {}
    if optics.focal_length_m is not None:
        out["sensor.optics.focal_length_m"] = optics.focal_length_m
    if optics.f_number is not None and optics.aperture_m is not None:
        out["sensor.optics.f_number"] = optics.f_number * optics.aperture_m
    if optics.ifov_urad is not None:
        out["sensor.optics.ifov_urad"] = detector.pitch_um / optics.ifov_urad
    return out


def _view_of(focal: float, detector: Detector, pixels: tuple[int, int], plane: bool) -> list[float]:
    """Return the field of view of pixels behind a focal length [deg, (width, height)]."""
    step = 1e-6 * detector.pitch_um / focal
    return [2.0 * math.degrees(math.atan(0.5 * step * n)) if plane else math.degrees(step) * n for n in pixels]


def _from_view(fov_deg: tuple[float, float], pixels: tuple[int, int], sensor: Sensor) -> float:
    """Return the focal length that the field of view has with the detector's pixels [m]; its height, which no scan changes."""
    assert sensor.detector is not None
    height, size = math.radians(fov_deg[1]), 1e-6 * sensor.detector.pitch_um * pixels[1]
    return 0.5 * size / math.tan(0.5 * height) if sensor.projection == "pinhole" else size / height


def _require_focal_length(sensor: Sensor, optics: Optics, detector: Detector) -> None:
    """Refuse optics without a focal length or with several different ones."""
    given = _focal_lengths(optics, detector)
    if not given and "fov_deg" not in sensor.model_fields_set:
        text = "is missing: give it, or sensor.optics.f_number beside aperture_m, or ifov_urad, or sensor.fov_deg"
        raise rule("sensor.optics.focal_length_m", text)
    focal = sensor.focal_length_m
    for key, value in given.items():
        first = next(iter(given))
        if abs(value / focal - 1.0) > AGREEMENT:
            text = (
                f"makes a focal length of {value:.5g} m (f-number times aperture, or pitch over IFOV), and {first} one of {focal:.5g} m; "
                f"they may differ by {100 * AGREEMENT:g} %: correct one or leave it out"
            )
            raise rule(key, text, value=value, allowed=f"{focal:.5g} m")
    if optics.aperture_m is None and optics.f_number is None:
        text = "is missing: blur and light need the aperture; add it, or sensor.optics.f_number"
        raise rule("sensor.optics.aperture_m", text)
    # The sine condition allows no f-number below 0.5.
    if focal / sensor.aperture_m < 0.5 * (1.0 - AGREEMENT):
        text = f"= {sensor.aperture_m:g} with a focal length of {focal:g} m is F/{focal / sensor.aperture_m:.2g}; no optics are below F/0.5"
        raise rule("sensor.optics.aperture_m", text, value=sensor.aperture_m, allowed=f"up to {2 * focal:g} m")
    width, height = _view_of(focal, detector, sensor.pixels, sensor.projection == "pinhole")
    for name, value, own in (("width", width, sensor.fov_deg[0]), ("height", height, sensor.fov_deg[1])):
        if abs(value / own - 1.0) > AGREEMENT:
            text = (
                f"= [{sensor.fov_deg[0]:.6g}, {sensor.fov_deg[1]:.6g}] disagrees in {name} with {sensor.pixels[0]} x {sensor.pixels[1]} "
                f"pixels of {detector.pitch_um:g} um at a focal length of {focal:.5g} m, which see {width:.6g} x {height:.6g} deg; "
                f"they may differ by {100 * AGREEMENT:g} %: leave fov_deg out, or correct pixels, pitch_um or the focal length"
            )
            raise rule("sensor.fov_deg", text, value=sensor.fov_deg, allowed=f"[{width:.6g}, {height:.6g}]")
    if sensor.scan is not None and sensor.scan.kind == "panoramic" and abs(sensor.fov_deg[0] - 360.0) > 1e-6:
        text = f"= [{sensor.fov_deg[0]:g}, {sensor.fov_deg[1]:g}] is no turn, and sensor.scan.kind is 'panoramic'; give 360 deg, or 'line'"
        raise rule("sensor.fov_deg", text, value=sensor.fov_deg)


def _require_steady(sensor: Sensor, optics: Optics, detector: Detector) -> None:
    """Refuse movement of the line of sight in an exposure that is too wide for the picture."""
    # Pitch [um] over focal length [m] is the pixel's angle in microradians, the unit of jitter and drift.
    step, sides = detector.pitch_um / sensor.focal_length_m, sensor.pixels  # microradians, pixels
    most = max(SHAKEN[0] * min(sides), SHAKEN[1]) * step
    if optics.jitter_urad > most:
        text = (
            f"= {optics.jitter_urad:g} is {optics.jitter_urad / step:.4g} pixels rms, too wide for a picture of {sides[0]} x {sides[1]} "
            f"pixels; allowed are up to {most:.4g} urad: lower it, or give more pixels"
        )
        raise rule("sensor.optics.jitter_urad", text, value=optics.jitter_urad, allowed=f"up to {most:.4g} urad")
    if not isinstance(detector, PhotonDetector):
        return  # a lag blurs in time, not within a picture
    exposure = _exposure(sensor, detector)
    if exposure is None:
        return
    _require_well(detector, exposure)
    for name, drift, side in (("along", optics.drift_along_urad_s, sides[0]), ("across", optics.drift_across_urad_s, sides[1])):
        fastest = max(side, SMEARED) * step / exposure
        if abs(drift) > fastest:
            key = f"sensor.optics.drift_{name}_urad_s"
            text = (
                f"= {drift:g} moves the picture by {abs(drift) * exposure / step:.4g} pixels in an exposure of {exposure:g} s; allowed are "
                f"up to {fastest:.4g} urad/s: lower it, or shorten sensor.detector.integration_time_s"
            )
            raise rule(key, text, value=drift, allowed=f"up to {fastest:.4g} urad/s")


def _require_well(detector: PhotonDetector, exposure: float) -> None:
    """Refuse dark current that alone fills the well, in either exposure."""
    for time in (detector.short_integration_time_s, exposure):
        if time is not None and detector.well_capacity_e is not None and detector.dark_current_e_s * time >= detector.well_capacity_e:
            most = detector.well_capacity_e / time
            text = (
                f"= {detector.dark_current_e_s:g} fills the well of {detector.well_capacity_e:g} electrons in {time:g} s; "
                f"allowed are below {most:.4g}: lower it, or shorten the integration"
            )
            raise rule("sensor.detector.dark_current_e_s", text, value=detector.dark_current_e_s, allowed=f"below {most:.4g}")


def _exposure(sensor: Sensor, detector: PhotonDetector) -> float | None:
    """Return the integration time [s]: by default a frame, of a scanner the time in which it moves on by a pixel; None if by NETD."""
    if detector.integration_time_s is not None:
        return detector.integration_time_s
    if detector.netd_k is not None:
        return None
    scan, frame = sensor.scan, 1.0 / sensor.frame_rate_hz
    if scan is None or scan.kind == "staring" or scan.period_s == 0.0:
        return frame
    return (frame if scan.period_s is None else scan.period_s) / sensor.pixels[0]


def _require_times(sensor: Sensor) -> None:
    """Refuse exposures and scans that do not fit into a frame."""
    frame, scan, detector = 1.0 / sensor.frame_rate_hz, sensor.scan, sensor.detector
    # The margin lets an exposure equal to the frame pass after rounding.
    longest = frame * (1.0 + 1e-9)
    if isinstance(detector, PhotonDetector) and detector.integration_time_s is not None:
        # Both exposures of a high dynamic range follow one another within the frame.
        whole = detector.integration_time_s + (detector.short_integration_time_s or 0.0)
        if whole > longest:
            rate = f"sensor.frame_rate_hz = {sensor.frame_rate_hz:g}"
            text = f"= {detector.integration_time_s:g} is longer than a frame of {frame:g} s ({rate})"
            if detector.short_integration_time_s is not None:
                text += f" with short_integration_time_s = {detector.short_integration_time_s:g}"
            raise rule(
                "sensor.detector.integration_time_s", f"{text}; shorten it or lower the rate", value=whole, allowed=f"up to {frame:g} s"
            )
        if detector.short_integration_time_s is not None and detector.short_integration_time_s >= detector.integration_time_s:
            text = f"= {detector.short_integration_time_s:g} is not shorter than integration_time_s = {detector.integration_time_s:g}"
            raise rule("sensor.detector.short_integration_time_s", f"{text}; swap them", value=detector.short_integration_time_s)
    if isinstance(detector, PhotonDetector) and detector.integration_time_s is None and detector.short_integration_time_s is not None:
        raise rule("sensor.detector.integration_time_s", "is missing beside short_integration_time_s; add it")
    if scan is None:
        return
    if scan.period_s is not None and scan.period_s > longest:
        text = f"= {scan.period_s:g} is longer than a frame of {frame:g} s; shorten it, or lower sensor.frame_rate_hz"
        raise rule("sensor.scan.period_s", text, value=scan.period_s, allowed=f"up to {frame:g} s")
    if scan.row_time_s * sensor.pixels[1] > longest:
        text = f"= {scan.row_time_s:g} for {sensor.pixels[1]} rows is longer than a frame of {frame:g} s; shorten it"
        raise rule("sensor.scan.row_time_s", text, value=scan.row_time_s, allowed=f"up to {frame / sensor.pixels[1]:.3g} s")
