"""``seaglint detect``: probabilities of detection and false alarm of a detector on a recording, from injected objects."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from seaglint.cli.analyze import RAW_HELP, filter_of, raw_layout, weights
from seaglint.cli.detect_scene import SceneArguments, run_scenario
from seaglint.cli.numbers import between, contrasts_of
from seaglint.cli.options import Overwrite, Progress
from seaglint.cli.progress import ProgressMode
from seaglint.cli.sensor import SensorPreset
from seaglint.cli.workers import DaskOption, DaskSlurmOption, WorkersOption, chosen, done_here

if TYPE_CHECKING:
    from seaglint.detection.spot import Shape

Law = Literal["sigma", "frame", "fixed", "design"]
Placement = Literal["random", "centre"]
Pointing = Literal["least-squares", "centroid"]


def detect(
    recording: Annotated[
        str,
        typer.Argument(
            metavar="INPUT", help="SCENARIO.toml, or a sequence without objects: Zarr, NetCDF, PNG, TIFF, FITS, NumPy, HDF5, video, raw"
        ),
    ],
    contrast: Annotated[
        str | None,
        typer.Option(
            "--contrast",
            help="what an object centred on a pixel adds to it: 4, several 1,2,4, or FIRST:LAST:STEP [units of INPUT]; "
            "of a scenario the in-band contrast at the aperture [W m-2 sr-1]",
        ),
    ] = None,
    detector: Annotated[
        str,
        typer.Option(
            "--detector",
            help="threshold, matched, matched-global, matched-local, log, top-hat, max-mean, max-median, patch-image, ca-cfar, os-cfar, "
            "os-cfar-exponential, temporal-profile, track-before-detect, frame-difference, integration, or package.module:function",
        ),
    ] = "threshold",
    filter_name: Annotated[
        str,
        typer.Option(
            "--filter", help="before the detector: laplacian, difference-of-gaussians, median-subtraction, top-hat, matched, none"
        ),
    ] = "none",
    kernel: Annotated[Path | None, typer.Option("--kernel", help="CSV or .npy of filter weights of your own, instead of --filter")] = None,
    signature: Annotated[Path | None, typer.Option("--signature", help="CSV or .npy of the target for --filter matched")] = None,
    object_sigma_px: Annotated[
        float | None, typer.Option("--object-sigma-px", help="standard deviation of the object's Gaussian blur [px]; 0.8 without --psf")
    ] = None,
    psf: Annotated[Path | None, typer.Option("--psf", help="CSV or .npy of the object's point spread, one value a pixel, instead")] = None,
    threshold: Annotated[float, typer.Option("--threshold", help="in the unit of --threshold-law")] = 4.0,
    threshold_law: Annotated[
        Law,
        typer.Option(
            "--threshold-law",
            help="'sigma': standard deviations above the mean of all frames; 'frame': of each frame; 'fixed': the statistic's unit; "
            "'design': rate of false alarms for which the detector is designed",
        ),
    ] = "sigma",
    injections: Annotated[int, typer.Option("--injections", min=1, help="objects of each contrast")] = 2000,
    placement: Annotated[Placement, typer.Option("--placement", help="'random' within pixels, or at the 'centre' of pixels")] = "random",
    match_radius: Annotated[
        float, typer.Option("--match-radius", help="largest distance of a detection from the object's pixel [px]")
    ] = 1.0,
    velocity: Annotated[str, typer.Option("--velocity", metavar="X,Y", help="motion to the right and down [px a frame]")] = "0,0",
    duration: Annotated[
        int, typer.Option("--duration", min=0, help="frames for which the object is there, up to the one judged; 0: all the detector sees")
    ] = 0,
    pointing: Annotated[
        Pointing, typer.Option("--pointing", help="place of detections by 'least-squares' or 'centroid'")
    ] = "least-squares",
    seed: Annotated[int, typer.Option("--seed", min=0, help="of the places")] = 0,
    level: Annotated[float, typer.Option("--level", help="of the intervals")] = 0.95,
    time_limit: Annotated[float, typer.Option("--time-limit", help="longest time of a call of your own detector [s]")] = 60.0,
    as_json: Annotated[bool, typer.Option("--json", help="print JSON")] = False,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", metavar="RESULT", help="writes RESULT.json, RESULT.csv (or .parquet), RESULT_roc.csv, RESULT_roc.png"
        ),
    ] = None,
    frame_rate: Annotated[float | None, typer.Option("--frame-rate", help="frames per second, where the file does not say [Hz]")] = None,
    pixel_mrad: Annotated[float | None, typer.Option("--pixel-mrad", help="angle of a pixel, where the file does not say [mrad]")] = None,
    units: Annotated[str | None, typer.Option("--units", help="units of the values, where the file does not say")] = None,
    variable: Annotated[str | None, typer.Option("--variable", help="which array of a file that holds several")] = None,
    channel: Annotated[str | None, typer.Option("--channel", help="mean, red, green or blue of true colour images")] = None,
    axes: Annotated[
        str | None, typer.Option("--axes", help="order of an array of three axes: tyx (time first, the default) or yxt")
    ] = None,
    saturation: Annotated[float | None, typer.Option("--saturation", help="value from which on the sensor is saturated")] = None,
    raw: Annotated[str | None, typer.Option("--raw", help=RAW_HELP)] = None,
    overwrite: Overwrite = False,
    show: Progress = ProgressMode.AUTO,
    objects_are: Annotated[
        str | None, typer.Option("--objects", help="of a scenario: point, gaussian, or the name of one of its [[objects]]")
    ] = None,
    temperature_difference: Annotated[
        str | None, typer.Option("--temperature-difference", help="instead of --contrast: apparent, to the field's mean [K]")
    ] = None,
    intensity: Annotated[str | None, typer.Option("--intensity", help="instead of --contrast: of a point at --range-m [W/sr]")] = None,
    range_m: Annotated[float | None, typer.Option("--range-m", help="range of that point [m]")] = None,
    object_height_m: Annotated[float | None, typer.Option("--object-height-m", help="its height; 5 where nothing is said [m]")] = None,
    seas: Annotated[int | None, typer.Option("--frames", min=1, help="independent seas at most; 32 where nothing is said")] = None,
    vary: Annotated[
        list[str] | None,
        typer.Option("--vary", metavar="KEY=A,B,C", help="values of a scenario's key, of detector, filter or threshold; repeatable"),
    ] = None,
    cases: Annotated[Path | None, typer.Option("--cases", metavar="F.csv", help="a case a row, keys as headings")] = None,
    report: Annotated[Path | None, typer.Option("--report", metavar="F.html", help="report with pictures")] = None,
    precision: Annotated[float | None, typer.Option("--precision", help="half width of the interval of P_d that is enough")] = None,
    precision_fa: Annotated[float | None, typer.Option("--precision-fa", help="the same of P_fa, as a share of it")] = None,
    time_budget: Annotated[float | None, typer.Option("--time-budget", min=0.0, help="longest time for all cases [s]")] = None,
    resume: Annotated[bool, typer.Option("--resume", help="go on with what is kept beside RESULT")] = False,
    design: Annotated[
        bool, typer.Option("--design", help="contrast for P_d 0.9 at one false alarm per hour and field, and the loss against white noise")
    ] = False,
    p_fa: Annotated[float | None, typer.Option("--p-fa", help="for --design and --range: rate per pixel instead")] = None,
    alarms_per_hour: Annotated[float | None, typer.Option("--alarms-per-hour", help="or so many false alarms an hour")] = None,
    wanted_p_d: Annotated[float | None, typer.Option("--p-d", help="for --design and --range: P_d wanted instead of 0.9")] = None,
    find_range: Annotated[bool, typer.Option("--range", help="range up to which an object of the scenario is detected")] = False,
    object_name: Annotated[str | None, typer.Option("--object", metavar="NAME", help="which of the [[objects]], for --range")] = None,
    range_limits: Annotated[str | None, typer.Option("--range-limits", metavar="NEAR:FAR", help="ranges tried; 500:40000 [m]")] = None,
    bearings: Annotated[
        str | None, typer.Option("--bearings", help="for --range: from the Sun's azimuth, clockwise, e.g. 0:330:30 [deg]")
    ] = None,
    sensor_preset: SensorPreset = None,
    workers: WorkersOption = None,
    dask: DaskOption = None,
    dask_slurm: DaskSlurmOption = None,
) -> None:
    """Probabilities of detection and false alarm, and errors of place, of a detector on a recording or in rendered scenes."""
    import warnings

    from seaglint.cli.messages import log, print_json
    from seaglint.cli.progress import patient_progress
    from seaglint.detection.trials import Objects
    from seaglint.errors import DataError
    from seaglint.io.detection_files import DetectionFiles
    from seaglint.io.recording import open_recording
    from seaglint.pipeline.detect import Options
    from seaglint.pipeline.detect import detect as run

    scene = SceneArguments(
        objects_are,
        temperature_difference,
        intensity,
        range_m,
        object_height_m,
        seas,
        tuple(vary or ()),
        cases,
        report,
        precision,
        precision_fa,
        time_budget,
        resume,
        design,
        p_fa,
        alarms_per_hour,
        wanted_p_d,
        find_range,
        object_name,
        range_limits,
        bearings,
        sensor_preset,
    )
    if Path(recording).suffix.lower() == ".toml":
        theirs = {
            "--raw": raw,
            "--variable": variable,
            "--channel": channel,
            "--axes": axes,
            "--units": units,
            "--saturation": saturation,
            "--frame-rate": frame_rate,
            "--pixel-mrad": pixel_mrad,
        }
        wrong = [name for name, value in theirs.items() if value is not None]
        if wrong:
            raise DataError(f"{', '.join(wrong)}: says something of a recording, which a scenario says itself; leave it out")
        given = None if contrast is None else contrasts_of(contrast)
        shape = _shape(object_sigma_px, psf) if psf is not None or object_sigma_px is not None or objects_are == "gaussian" else None
        template = Objects(
            _shape(object_sigma_px, psf), (1.0,), injections, placement, match_radius, _velocity(velocity), pointing, seed, duration
        )
        judged = Options(
            template, detector, filter_of(filter_name, kernel, signature), threshold, threshold_law, level, None, None, time_limit
        )
        if output is None and (dask is not None or dask_slurm is not None):
            raise DataError("workers on other machines keep frames beside the result; give -o RESULT in a folder that they see too")
        with chosen(workers, dask, dask_slurm) as team:
            run_scenario(
                Path(recording), scene, judged, given, shape, output, overwrite=overwrite, as_json=as_json, show=show, workers=team
            )
        return
    done_here(workers, dask, dask_slurm, "a recording is judged")
    if scene.given:
        raise DataError(f"{', '.join(scene.given)}: for scenarios, and {recording} is a recording; give SCENARIO.toml, or leave it out")
    if contrast is None:
        raise DataError("--contrast is missing: what an object adds to its pixel, in the recording's units; give e.g. --contrast 4")
    inputs = [path for path in (recording, kernel, signature, psf) if path is not None]
    files = None if output is None else DetectionFiles.at(output, overwrite=overwrite, inputs=inputs)
    opened = open_recording(
        recording,
        frame_rate=frame_rate,
        units=units,
        raw=raw_layout(raw),
        variable=variable,
        channel=channel,
        axes=axes,
        saturation=saturation,
    )
    objects = Objects(
        _shape(object_sigma_px, psf),
        contrasts_of(contrast),
        injections,
        placement,
        match_radius,
        _velocity(velocity),
        pointing,
        seed,
        duration,
    )
    options = Options(
        objects,
        detector,
        filter_of(filter_name, kernel, signature),
        threshold,
        threshold_law,
        level=level,
        frame_rate=opened.frame_rate,
        pixel_deg=_pixel(recording, pixel_mrad),
        time_limit=time_limit,
    )
    with warnings.catch_warnings():
        # Of numbers that do not exist (a detector that divides by 0): the result says what is absent and why.
        warnings.simplefilter("ignore", RuntimeWarning)
        with patient_progress(show, "frames and objects") as progress:
            found = run(opened, options, name=opened.source, progress=progress)
    result = found.as_dict() | {"units": opened.units, "frame_rate_hz": opened.frame_rate}
    result["notes"] += list(opened.notes)
    if files is not None:
        import numpy as np

        from seaglint.detection.roc import joined
        from seaglint.plot.detection import draw_roc

        curves = [found.characteristic(k) for k in range(len(objects.contrasts))]
        title, rate = f"{found.detector.name}, filter {options.filter.name}", found.alarms.per_pixel.rate
        files.write(
            result,
            found.rows(),
            {"contrast": np.repeat(objects.contrasts, [c.threshold.size for c in curves]), **joined(curves)},
            lambda path: draw_roc(path, title, objects.contrasts, curves, found.detections, rate),
        )
        log(f"{', '.join(str(path) for path in files.paths)} written")
    if as_json:
        print_json(result)
    else:
        typer.echo("\n".join(lines(result)))


def _shape(sigma: float | None, psf: Path | None) -> Shape:
    from seaglint.detection.spot import GaussianSpot, SampledSpot
    from seaglint.errors import DataError

    if psf is None:
        return GaussianSpot(0.8 if sigma is None else sigma)
    if sigma is not None:
        raise DataError("--psf and --object-sigma-px are two shapes of one object; give one of them")
    return SampledSpot(weights(psf))


def _velocity(text: str) -> tuple[float, float]:
    """Rows and columns a frame, of X,Y."""
    from seaglint.errors import DataError

    try:
        right, down = (float(part) for part in text.split(","))
    except ValueError:
        raise DataError(f"--velocity {text}: give X,Y in pixels a frame, to the right and down, e.g. 0.5,0") from None
    return down, right


def _pixel(recording: str, pixel_mrad: float | None) -> tuple[float, float] | None:
    """Angle between rows and between columns [deg], as far as it is known."""
    from math import degrees

    from seaglint.errors import DataError
    from seaglint.io.recording.source import source_of

    if pixel_mrad is not None:
        if not 0 < pixel_mrad < 1000:
            raise DataError(f"--pixel-mrad {pixel_mrad:g}: give an angle above 0 and below 1000 mrad")
        return (degrees(1e-3 * pixel_mrad),) * 2
    source = source_of(Path(recording))
    return None if source is None or source.step is None else (degrees(source.step[1]), degrees(source.step[0]))


def lines(result: dict[str, Any]) -> list[str]:
    """The result as a few lines of text."""
    unit = f" {result['units']}" if result["units"] else ""
    out = [
        f"{result['source']}: {result['frames']} frames of {result['columns']} x {result['rows']}, detector {result['detector']}, "
        f"filter {result['filter']}, threshold {result['threshold_sigma']:.4g} sigma above the mean",
        f"P_fa {result['p_fa']:.4g} per pixel and frame{between(result['p_fa_interval'])}, "
        f"{result['false_alarms']['events_per_frame']:.4g} events a frame",
    ]
    for entry in result["sweep"]:
        error = entry["pointing_error"]
        place = (
            f"; error of place x {error['column']['std_px']:.3g}, y {error['row']['std_px']:.3g} px"
            if error["row"]["std_px"] is not None
            else ""
        )
        out.append(
            f"contrast {entry['contrast']:g}{unit}: P_d {entry['p_d']:.4g}{between(entry['p_d_interval'])} of {entry['injections']}{place}"
        )
    for rare in result["tail"]["rare"]:
        doubt = "" if rare["believed"] else ", not to be believed"
        out.append(
            f"P_fa {rare['p_fa']:.1g} at {rare['threshold_sigma']:.4g} sigma{between(rare['p_fa_interval'])}, by extrapolation{doubt}"
        )
    if result["tail"]["note"]:
        out.append(f"tail: {result['tail']['note']}")
    return [*out, *(f"note: {note}" for note in result["notes"])]
