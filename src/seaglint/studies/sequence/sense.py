"""A sensor applied to frames of radiance, of a rendered scenario or of any recording."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from seaglint.analysis.recording import Recording
from seaglint.base.conventions import FloatArray, Progress
from seaglint.base.errors import DataError, DomainError
from seaglint.base.free_form import Attributes
from seaglint.base.threads import single_threaded_algebra
from seaglint.cluster import Workers
from seaglint.cluster.job import ATTEMPTS
from seaglint.formats.recording.labelled_arrays import Source
from seaglint.instrument.bolometer import ThermalPixels, lag_weights
from seaglint.instrument.chain import Drawn, Exposure, SensorModel, require_radiance
from seaglint.instrument.detector import PhotonPixels
from seaglint.instrument.figures_of_merit import blur_px
from seaglint.instrument.transfer import require_divides, require_steady
from seaglint.optics.band import Band
from seaglint.scenario.model import Scenario
from seaglint.scenario.records.sensor_table import AGREEMENT
from seaglint.store.layout import Layout
from seaglint.store.provenance import provenance
from seaglint.store.sequence_store import Frame, check_output, write_sequence
from seaglint.store.writers import Share
from seaglint.studies.build.sensor_model import sensor_attributes, sensor_model
from seaglint.studies.sequence.memory import BASE, require_room
from seaglint.studies.sequence.sequence_work import spread_over
from seaglint.studies.study_requests import ReadingRequest

if TYPE_CHECKING:
    import xarray as xr

Fine = Callable[[int], NDArray[np.float32]]  #: Radiance of a frame, finer than the pixels [W m-2 sr-1, (rows, columns)].

Rates = Callable[[int], tuple[float, float]]  #: Movement of the line of sight in a frame, along and across rows [rad s-1].


DrawnOf = Callable[[int], Drawn]  #: Description of the picture of a frame.

Added = Callable[[int], NDArray[np.float32] | None]  #: Radiance that is added on the pixels of a frame [W m-2 sr-1, (rows, columns)].


def no_added_light(number: int) -> None:
    """Add no radiance."""
    return


def no_rates(number: int) -> tuple[float, float]:
    """Return the rates of a platform that does not turn."""
    return (0.0, 0.0)


@dataclass(frozen=True, eq=False)
class SensedFrames:
    """Frames of a sensor, each a function of its number."""

    model: SensorModel  #: The sensor.
    fine: Fine  #: ``fine(number)`` is the radiance of a frame.
    oversampling: int  #: Fine pixels along a pixel's side.
    first: int = 0  #: Number of the earliest frame: before it a thermal detector has seen the same image.
    rates: Rates = no_rates  #: ``rates(number)`` is the movement of the line of sight by the platform.
    added: Added = no_added_light  #: ``added(number)`` is the radiance added on the pixels; None adds none.
    #: ``drawn(number)`` describes a picture of this program (``focal_plane``); None for others.
    drawn: DrawnOf | None = None
    _seen: OrderedDict[int, NDArray[np.float32]] = field(default_factory=OrderedDict, repr=False)

    def exposure(self, number: int) -> Exposure:
        """Return a frame with its noise."""
        detector = self.model.detector
        if not isinstance(detector, ThermalPixels) or detector.time_constant == 0.0:
            return self.model.expose(self.seen(number), number)
        # A thermal detector adds earlier frames with exponentially falling weights.
        weights = lag_weights(detector.time_constant, self.model.frame_interval)
        lagged = np.zeros(1, np.float64)
        # The frame itself comes last, so that it is cached for its labels.
        for back in range(len(weights) - 1, -1, -1):
            lagged = lagged + weights[back] * self._cached(max(number - back, self.first), len(weights))
        return self.model.expose(lagged.astype(np.float32), number)

    def seen(self, number: int) -> NDArray[np.float32]:
        """Return the radiance on each pixel of a frame alone [W m-2 sr-1, (rows, columns)]; the latest are cached."""
        return self._cached(number, max(len(self._seen), 1))

    def _focal_plane(self, number: int) -> NDArray[np.float32]:
        drawn = None if self.drawn is None else self.drawn(number)
        return self.model.focal_plane(self.fine(number), self.oversampling, self.rates(number), self.added(number), drawn=drawn)

    def _cached(self, number: int, most: int) -> NDArray[np.float32]:
        if number not in self._seen:
            self._seen[number] = self._focal_plane(number)
        self._seen.move_to_end(number)
        cached = self._seen[number]
        while len(self._seen) > most:
            self._seen.popitem(last=False)
        return cached

    def images(self, number: int, requested: tuple[str, ...]) -> dict[str, NDArray[Any]]:
        """Return the stored arrays of a frame: ``signal``, ``electrons`` where requested, ``saturated_share``."""
        exposed = self.exposure(number)
        out: dict[str, NDArray[Any]] = {"signal": exposed.signal, "saturated_share": np.float32(exposed.saturated_share)}  # type: ignore[dict-item]
        if "electrons" in requested:
            out["electrons"] = exposed.units
        return out


def require_electrons(scenario: Scenario, electrons: bool) -> None:
    """Refuse electrons of a detector that has none.

    Raises
    ------
    DataError
        A thermal detector.
    """
    if electrons and scenario.sensor.detector is not None and scenario.sensor.detector.kind == "thermal":
        raise DataError("electrons: a detector of sensor.detector.kind = 'thermal' absorbs power and has no electrons; leave electrons out")


def sense(
    recording: Recording,
    scenario: Scenario,
    output: str | Path,
    *,
    source: Source | None = None,
    seed: int | None = None,
    oversampling: int | None = None,
    electrons: bool = False,
    resume: bool = False,
    overwrite: bool = False,
    progress: Progress | None = None,
    share: Share | None = None,
    workers: Workers | None = None,
    reopen: Reopen | None = None,
) -> Path | str:
    """Apply a scenario's sensor to a recording of radiance and store its counts.

    Parameters
    ----------
    recording : Recording
        Radiance at the aperture [W m-2 sr-1]; the size of the detector follows from its size.
    scenario : Scenario
        With ``[sensor.optics]`` and ``[sensor.detector]``.
    output : path
        Store to make, customarily ``*.zarr``.
    source : Source, optional
        Band and pixels that the recording states.
    seed : int, optional
        Of the noise; the scenario's by default.
    oversampling : int, optional
        Pixels of the recording along each side of the detector's; from the recording's pixels if it states them, else 1.
    electrons : bool
        Whether electrons are written beside counts.
    resume, overwrite : bool
        Continue an unfinished store, or replace a store.
    progress : callable, optional
        Called with (frames done, frames in all).
    share : Share, optional
        Make the units of the share alone, in a store that other shares write too;
        ``seaglint.store.sequence_store.finish_sequence`` names it.
    workers : Workers, optional
        Workers that make the frames; this process by default. They read the recording themselves, which needs ``reopen``.
    reopen : Reopen, optional
        Parameters with which workers open the recording.

    Raises
    ------
    SeaglintError
        No sensor, a picture that the oversampling does not divide, values that are no radiances, a store that is there already.
    """
    check_output(output, resume=resume, overwrite=overwrite, share=share)
    if workers is not None and reopen is None:
        raise DataError(f"{recording.source}: is in this process alone; give workers a file, or none")
    with single_threaded_algebra():
        frames, layout = prepare_sense(recording, scenario, source=source, seed=seed, oversampling=oversampling, electrons=electrons)
        frames.fine(frames.first)  # values that are no radiances are refused before anything is written
        settings = (reopen, scenario, seed, oversampling, electrons)
        return write_sequence(
            output, layout, partial(frames.images, requested=layout.variables), resume=resume, overwrite=overwrite, progress=progress,
            share=share, spread=spread_over(workers, _reopened_frames, settings), attempts=ATTEMPTS,
        )  # fmt: skip


@dataclass(frozen=True)
class Reopen:
    """A recording by name, for other processes."""

    path: Path
    reading: ReadingRequest = field(default_factory=ReadingRequest)


def _reopened_frames(settings: tuple[Reopen, Scenario, int | None, int | None, bool]) -> tuple[Layout, Frame]:
    """Return layout and frames in another process."""
    from seaglint.formats.recording.labelled_arrays import source_of

    file, scenario, seed, oversampling, electrons = settings
    opened, known = file.reading.opened(str(file.path)), source_of(file.path)
    frames, layout = prepare_sense(opened, scenario, source=known, seed=seed, oversampling=oversampling, electrons=electrons)
    return layout, partial(frames.images, requested=layout.variables)


def prepare_sense(
    recording: Recording,
    scenario: Scenario,
    *,
    source: Source | None = None,
    seed: int | None = None,
    oversampling: int | None = None,
    electrons: bool = False,
) -> tuple[SensedFrames, Layout]:
    """Return the frames that ``sense`` writes, and their layout; arguments are the arguments of ``sense``."""
    require_electrons(scenario, electrons)
    known = source or Source()
    model = sensor_model(scenario, seed)
    if recording.frame_rate:
        model = replace(model, frame_interval=1.0 / recording.frame_rate)
        if model.exposure_time > model.frame_interval * (1.0 + 1e-9):
            raise DataError(
                f"{recording.source}: its frames are {model.frame_interval:g} s apart, and sensor.detector.integration_time_s is "
                f"{model.exposure_time:g} s, longer than a frame; shorten it, or give frame_rate"
            )
    if known.band is not None:
        _require_band(known.band, model.photons.band)
    times = _oversampling(model, known, oversampling)
    try:
        rows, columns = shape = require_divides((recording.rows, recording.columns), times)
    except DomainError as error:
        raise DataError(f"{recording.source}: {error}") from error
    _require_blur(model, shape, times, recording.source)
    # A recording narrower than the scenario's picture is no full turn.
    model = replace(model, circle=model.circle and columns == scenario.sensor.pixels[0])

    # Frames of this program's files retain their numbers, on which the noise depends.
    numbers = range(recording.frames) if known.frames is None or len(known.frames) != recording.frames else known.frames

    def fine(number: int) -> NDArray[np.float32]:
        index = number - numbers.start
        radiance: NDArray[np.float32] = recording.read(index, index + 1)[0]
        if recording.offset:
            radiance = np.asarray(radiance + recording.offset, np.float32)
        require_radiance(radiance, f"{recording.source}, frame {number}: radiance")
        return radiance

    azimuth, elevation = _directions(scenario, model, known, (rows, columns), times)
    layout = Layout(
        azimuth_deg=azimuth,
        elevation_deg=elevation,
        frames=numbers,
        frame_rate=1.0 / model.frame_interval,
        band=model.photons.band,
        variables=("signal", *(("electrons",) if electrons else ())),
        per_frame=("saturated_share",),
        details={"signal": signal_attributes(model)},
        attributes=provenance(
            "Infrared image sequence of a detector",
            scenario.model_dump_json(exclude_none=True),
            scenario.seed,
            **sensor_attributes(model, times),
            radiance_source=recording.source,
        ),
    ).in_units(recording.frames)
    # A file has no sparkles apart.
    drawn = (lambda number: Drawn()) if known.step is not None and known.band is not None else None
    return SensedFrames(_require_radiance(model, recording), fine, times, numbers.start, drawn=drawn), layout


def signal_attributes(model: SensorModel) -> Attributes:
    """Return the attributes of the variable ``signal``: the line to radiance."""
    line = model.readout
    return {
        "gain": line.gain,
        "offset": line.offset,
        "gain_units": "electrons per count" if isinstance(model.detector, PhotonPixels) else "nanowatts per count",
        "radiance_scale": line.radiance_scale,
        "radiance_offset": line.radiance_offset,
        "saturation_counts": float(line.counts(line.full_scale)),
        "sensor_blur_px": blur_px(model),
    }


def sensed_dataset(frames: SensedFrames, layout: Layout) -> xr.Dataset:
    """Return all frames in memory, with the labels of a store."""
    import xarray as xr

    from seaglint.base.schema import VARIABLES
    from seaglint.store.netcdf import plain_attributes

    pixels = len(layout.frames) * layout.elevation_deg.shape[0] * layout.azimuth_deg.shape[-1]
    each = sum(np.dtype(VARIABLES[name].dtype).itemsize for name in layout.variables)
    what = f"{len(layout.frames)} frames of {layout.azimuth_deg.shape[-1]} x {layout.elevation_deg.shape[0]} pixels in memory"
    require_room(BASE + 2 * each * pixels, what, "give output, a store on the disk, or fewer frames")  # single frames and all together
    # All frames are in memory at once, which was checked above.
    images: list[Mapping[str, Any]] = [frames.images(number, layout.variables) for number in layout.frames]
    data: dict[str, Any] = {
        name: (("time", "y", "x"), np.stack([f[name] for f in images]), {**VARIABLES[name].attributes, **layout.details.get(name, {})})
        for name in layout.variables
    }
    for name in layout.per_frame:
        data[name] = ("time", np.array([f[name] for f in images], np.float32), VARIABLES[name].attributes)
    numbers = np.asarray(layout.frames, np.int64)
    coordinates = {
        "time": ("time", numbers / layout.frame_rate, VARIABLES["time"].attributes),
        "frame": ("time", numbers, VARIABLES["frame"].attributes),
        "azimuth": ("x", layout.azimuth_deg, VARIABLES["azimuth"].attributes),
        "elevation": ("y", layout.elevation_deg, VARIABLES["elevation"].attributes),
    }
    return xr.Dataset(data, coords=coordinates, attrs=plain_attributes(layout.all_attributes))


def _require_radiance(model: SensorModel, recording: Recording) -> SensorModel:
    """Return the model, or refuse a recording whose values are no radiances."""
    units = (recording.units or "").strip()
    if units in {"K", "kelvin", "degC", "count", "counts", "DN", "1"}:
        raise DataError(
            f"{recording.source}: its values are in '{units}'; a sensor is put on radiance at the aperture, W m-2 sr-1: give another "
            "variable, or convert it"
        )
    return model


def _require_band(given: Band, own: Band) -> None:
    if abs(given.min_um - own.min_um) > 1e-3 * own.min_um or abs(given.max_um - own.max_um) > 1e-3 * own.max_um:
        raise DataError(
            f"the radiance is that of {given.min_um:g} to {given.max_um:g} um, and the scenario's band that of {own.min_um:g} to "
            f"{own.max_um:g} um; set band.min_um and band.max_um to the radiance's, or render it anew"
        )


def _oversampling(model: SensorModel, known: Source, given: int | None) -> int:
    """Return the given oversampling, or the oversampling of the recording's pixels."""
    if given is not None or known.step is None:
        return 1 if given is None else given
    # The step between rows is taken, which no scan changes.
    ratio = model.ifov / known.step[1]
    nearest = max(round(ratio), 1)
    if abs(ratio / nearest - 1.0) > AGREEMENT:
        raise DataError(
            f"pixels of the radiance are {1e3 * known.step[1]:.5g} mrad and those of the sensor {1e3 * model.ifov:.5g} mrad, no whole "
            "number of them; give oversampling, or correct sensor.optics"
        )
    return nearest


def _require_blur(model: SensorModel, shape: tuple[int, int], oversampling: int, source: str) -> None:
    """Refuse a recording too small for the sensor's jitter, or too large for the memory."""
    try:
        require_steady(model.optics.jitter / model.ifov, shape)
    except DomainError as error:
        raise DataError(f"{source}: sensor.optics.jitter_urad = {1e6 * model.optics.jitter:g}: {error}") from error
    what = f"{source}: blur of {shape[1]} x {shape[0]} pixels, {oversampling} x {oversampling} finer,"
    require_room(BASE + model.transfer_bytes(shape, oversampling), what, "cut the recording, or lower jitter, drift or oversampling")


def _directions(
    scenario: Scenario, model: SensorModel, known: Source, shape: tuple[int, int], oversampling: int
) -> tuple[FloatArray, FloatArray]:
    """Return azimuth and elevation of the detector's pixels [deg]: averages of the recording's, or about the scenario's line of sight."""
    rows, columns = shape
    if known.azimuth_deg is not None and known.elevation_deg is not None:
        return (known.azimuth_deg.reshape(columns, oversampling).mean(axis=1), known.elevation_deg.reshape(rows, oversampling).mean(axis=1))
    step = np.degrees(model.ifov)
    azimuth = scenario.sensor.azimuth_deg + (np.arange(columns) - 0.5 * (columns - 1)) * step
    return azimuth, scenario.sensor.elevation_deg - (np.arange(rows) - 0.5 * (rows - 1)) * step
