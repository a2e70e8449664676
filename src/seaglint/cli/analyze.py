"""``seaglint analyze``: a recording's clutter statistics and false alarms, as text, JSON or a report."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from seaglint.cli.terminal.messages import print_lines
from seaglint.cli.terminal.options import ProgressOption
from seaglint.cli.terminal.progress import ProgressMode
from seaglint.cli.terminal.record_options import takes_records
from seaglint.studies.study_requests import AnalysisRequest

if TYPE_CHECKING:
    from seaglint.analysis import Analysis
    from seaglint.analysis.region import AlarmSummary
    from seaglint.clutter.fits import Fit


@takes_records(
    order="recording as_json report frame_rate units mask no_glint regions rows filter kernel signature thresholds scope detectors "
    "time_limit variable channel axes missing saturation border raw seed"
)
def analyze(
    recording: Annotated[
        str, typer.Argument(metavar="INPUT", help="sequence or image: Zarr, NetCDF, PNG, TIFF, FITS, NumPy, HDF5, video, raw")
    ],
    request: AnalysisRequest,
    as_json: Annotated[bool, typer.Option("--json", help="print JSON")] = False,
    report: Annotated[Path | None, typer.Option("--report", metavar="OUT.html", help="write a report, one file")] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="replace the report that is there")] = False,
    show: ProgressOption = ProgressMode.AUTO,
) -> None:
    """Clutter statistics and false alarms of a recording, by region."""
    from seaglint.analysis import analyze as run
    from seaglint.base.reports import absent_numbers
    from seaglint.cli.terminal.progress import patient_progress

    if report is not None:
        refuse_report(report, overwrite, [recording, *request.files])
    _require_words(request)
    opened = request.opened(recording)
    with absent_numbers():
        with request.ready() as options, patient_progress(show, "frames") as progress:
            analysis = run(opened, options, progress)
        if report is not None:
            from seaglint.plot.analysis_report import write_report

            write_report(analysis, report, overwrite=overwrite)
    if report is not None:
        typer.echo(f"{report} written", err=True)
    if as_json:
        import json

        typer.echo(json.dumps(analysis.as_dict(), indent=2, ensure_ascii=False, allow_nan=False))
    else:
        print_lines(lines(analysis))


def refuse_report(report: Path, overwrite: bool, inputs: list[Any]) -> None:
    """Refuse a report that is not an HTML file, or that would replace a file."""
    from seaglint.base.errors import DataError
    from seaglint.store.outputs import refuse_existing

    if report.suffix.lower() not in (".html", ".htm"):
        raise DataError(f"--report {report}: a report is an HTML file; give a name that ends in .html")
    refuse_existing(report, overwrite=overwrite, inputs=inputs)


def _require_words(request: AnalysisRequest) -> None:
    """Refuse thresholds and words outside the allowed ones, by their names on the command line."""
    from seaglint.base.errors import DataError

    for value in request.thresholds:
        if not 0.0 < value < 100.0:
            raise DataError(f"--threshold {value:g}: give standard deviations above 0 and below 100")
    if request.scope not in ("frame", "sequence", "local"):
        raise DataError(f"--sigma {request.scope}: allowed are frame, sequence, local")
    if request.border not in ("auto", "keep", "drop"):
        raise DataError(f"--border {request.border}: allowed are auto, keep, drop")


def lines(analysis: Analysis) -> list[str]:
    """Return the results as a few lines of text."""
    recording, regions = analysis.recording, analysis.regions
    rate, units = recording.frame_rate, recording.units or "units not known"
    out = [
        f"{recording.source}: {recording.frames} frame{'s' * (recording.frames != 1)} of {recording.columns} x {recording.rows}, {units}, "
        + (f"{rate:g} Hz" if rate else "frame rate not known")
    ]
    if recording.frames > 1:
        out.append(f"blur of the frames: {recording.blur}")
    for name in analysis.names:
        if name not in regions:
            if analysis.options.no_glint:
                continue
            single = "; glint all over the picture counts as background" if name == "glint" else ""
            out.append(f"{name}: no region of its own{single}")
            continue
        region = regions[name]
        if name == "background" and "glint" not in regions and region.pixels == regions["all"].pixels:
            out.append("background: the same as all")
            continue
        moments, spatial, reason = region.moments, region.spatial, region.length_reason
        cut = f", {100 * region.saturated:.3g} % saturated" if region.saturated > 0.0 else ""
        out.append(
            f"{name}: {region.pixels} pixels, mean {_resolved(region.mean, moments.std)}, std {_short(moments.std)}, "
            f"skewness {_short(moments.skewness)}, excess kurtosis {_short(moments.excess_kurtosis)}{cut}"
        )
        out.append(
            f"  correlation length {_short(spatial.length_x)} x {_short(spatial.length_y)} px{f' ({reason})' if reason else ''}, "
            f"time {_short(region.correlation_time_s)} s; {_best(region.fits)}"
        )
        out.extend(f"  {_alarm(alarm)}" for alarm in region.false_alarms)
        out.extend(f"  note: {note}" for note in region.notes)
    out.extend(f"note: {note}" for note in analysis.notes)
    return out


def _alarm(alarm: AlarmSummary) -> str:
    known = alarm.rate_low is not None
    interval = f"{_short(alarm.rate_low)} to {_short(alarm.rate_high)}" if known else "no interval"
    note = f": {alarm.note}" if alarm.note and not known else f"; {alarm.note}" if alarm.note else ""
    return (
        f"{alarm.filter} > {alarm.threshold_sigma:g} sigma: {_short(alarm.rate)} per pixel ({interval}{note}), "
        f"{_short(alarm.ratio)} x Gaussian, correlation time {_short(alarm.correlation_time_s)} s"
    )


#: Smallest level of the goodness bootstrap, 1 in 200, rounded up: at it no draw was as far from the fit as the data.
FLOOR = 0.0051


def _best(fits: dict[str, Fit]) -> str:
    """Return the family nearest to the data, with the level of its fit."""
    from seaglint.clutter.fits import FEWEST_JUDGED

    tests = {name: fit.goodness for name, fit in fits.items() if fit.goodness is not None}
    if not tests:
        return "best fit none"
    name = min(tests, key=lambda family: tests[family].ks)
    fit, test = fits[name], tests[name]
    shape = "" if fit.shape is None else f"shape {_short(fit.shape)}, "
    nearest = f"{name} ({shape}scale {_short(fit.scale)}, KS {_short(test.ks)}"
    count = f"{fit.effective_count:.0f} independent values"
    if fit.effective_count < FEWEST_JUDGED:
        return f"{count}, too few (below {FEWEST_JUDGED}) to say which family fits; nearest: {nearest})"
    levels = [tested.ks_p for tested in tests.values() if math.isfinite(tested.ks_p)]
    verdict = "none of the families fits; nearest:" if levels and max(levels) <= FLOOR else "best fit"
    level = f"p <= {FLOOR:.1g}" if test.ks_p <= FLOOR else f"p {_short(test.ks_p)}" if math.isfinite(test.ks_p) else "p not known"
    return f"{verdict} {nearest}, {level} of {count})"


def _resolved(mean: float, std: float) -> str:
    """Return a mean with as many digits as its spread requires: counts on a high level differ in the last ones."""
    if not (std > 0.0 and abs(mean) >= 100.0 * std):
        return _short(mean)
    return f"{mean:.{min(len(str(int(abs(mean) / std))) + 3, 15)}g}"


def _short(value: float | None) -> str:
    """Return a number with four digits, or a dash for one that does not exist."""
    return "-" if value is None or not math.isfinite(value) else f"{value:.4g}"
