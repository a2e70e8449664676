"""``seaglint detect``: probabilities of detection and false alarm of a detector on a recording, from injected objects."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from seaglint.cli.analyze import RAW_HELP, filter_of, raw_layout, weights
from seaglint.cli.options import Overwrite, Progress
from seaglint.cli.progress import ProgressMode

if TYPE_CHECKING:
    from seaglint.detection.spot import Shape

MOST_CONTRASTS = 200

Law = Literal["sigma", "frame", "fixed", "design"]
Placement = Literal["random", "centre"]
Pointing = Literal["least-squares", "centroid"]


def detect(
    recording: Annotated[
        str, typer.Argument(metavar="INPUT", help="sequence without objects: Zarr, NetCDF, PNG, TIFF, FITS, NumPy, HDF5, video, raw")
    ],
    contrast: Annotated[
        str,
        typer.Option(
            "--contrast", help="what an object centred on a pixel adds to it: 4, several 1,2,4, or FIRST:LAST:STEP [units of INPUT]"
        ),
    ],
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
) -> None:
    """Probabilities of detection and false alarm, and errors of place, of a detector on a recording."""
    import warnings

    from seaglint.cli.messages import log, print_json
    from seaglint.cli.progress import patient_progress
    from seaglint.detection.trials import Objects
    from seaglint.io.detection_files import DetectionFiles
    from seaglint.io.recording import open_recording
    from seaglint.pipeline.detect import Options
    from seaglint.pipeline.detect import detect as run

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
        _contrasts(contrast),
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


def _contrasts(text: str) -> tuple[float, ...]:
    import numpy as np

    from seaglint.errors import DataError

    wrong = DataError(f"--contrast {text}: give a number, several as 1,2,4, or FIRST:LAST:STEP as 1:8:0.5, at most {MOST_CONTRASTS}")
    try:
        if ":" not in text:
            found = tuple(float(part) for part in text.split(","))
        else:
            first, last, step = (float(part) for part in text.split(":"))
            count = int((last - first) / step + 1.0 + 1e-9) if step and (last - first) / step < MOST_CONTRASTS else 0
            found = tuple(float(v) for v in np.round(first + step * np.arange(max(count, 0)), 12))
    except ValueError:
        raise wrong from None
    if not 0 < len(found) <= MOST_CONTRASTS:
        raise wrong
    return found


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
        f"P_fa {result['p_fa']:.4g} per pixel and frame{_between(result['p_fa_interval'])}, "
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
            f"contrast {entry['contrast']:g}{unit}: P_d {entry['p_d']:.4g}{_between(entry['p_d_interval'])} of {entry['injections']}{place}"
        )
    for rare in result["tail"]["rare"]:
        doubt = "" if rare["believed"] else ", not to be believed"
        out.append(
            f"P_fa {rare['p_fa']:.1g} at {rare['threshold_sigma']:.4g} sigma{_between(rare['p_fa_interval'])}, by extrapolation{doubt}"
        )
    if result["tail"]["note"]:
        out.append(f"tail: {result['tail']['note']}")
    return [*out, *(f"note: {note}" for note in result["notes"])]


def _between(ends: list[float] | None) -> str:
    return " (no interval)" if ends is None else f" ({ends[0]:.3g} to {ends[1]:.3g})"
