"""``seaglint analyze``: a recording's clutter statistics and false alarms, as text, JSON or a report."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from seaglint.cli.terminal.messages import tell
from seaglint.cli.terminal.options import ProgressOption
from seaglint.cli.terminal.progress import ProgressMode
from seaglint.cli.terminal.record_options import takes_records
from seaglint.studies.study_requests import AnalysisRequest

if TYPE_CHECKING:
    from seaglint.analysis.summary import AlarmSummary, AnalysisSummary, FitSummary


@takes_records(
    order="recording as_json report frame_rate units mask rows filter kernel signature thresholds scope detectors "
    "variable channel axes missing saturation border raw seed"
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
    from seaglint.base.errors import DataError
    from seaglint.base.reports import absent_numbers
    from seaglint.cli.terminal.progress import patient_progress
    from seaglint.store.outputs import refuse_existing

    if report is not None:
        if report.suffix.lower() not in (".html", ".htm"):
            raise DataError(f"--report {report}: a report is an HTML file; give a name that ends in .html")
        refuse_existing(report, overwrite=overwrite, inputs=[recording, *request.files])
    _require_words(request)
    opened, options = request.opened(recording), request.options()
    with absent_numbers():
        with patient_progress(show, "frames") as progress:
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
        tell(lines(analysis.summary()))


def _require_words(request: AnalysisRequest) -> None:
    """Refuse thresholds and words that cannot be, as they are written on the command line."""
    from seaglint.base.errors import DataError

    for value in request.thresholds:
        if not 0.0 < value < 100.0:
            raise DataError(f"--threshold {value:g}: give standard deviations above 0 and below 100")
    if request.scope not in ("frame", "sequence", "local"):
        raise DataError(f"--sigma {request.scope}: allowed are frame, sequence, local")
    if request.border not in ("auto", "keep", "drop"):
        raise DataError(f"--border {request.border}: allowed are auto, keep, drop")


def lines(result: AnalysisSummary) -> list[str]:
    """The result as a few lines of text."""
    rate = result.frame_rate_hz
    units = result.units or "units not known"
    out = [
        f"{result.source}: {result.frames} frame{'s' * (result.frames != 1)} of {result.columns} x {result.rows}, {units}, "
        + (f"{rate:g} Hz" if rate else "frame rate not known")
    ]
    if result.frames > 1:
        out.append(f"blur of the frames: {result.blur}")
    regions = result.regions
    for name, region in regions.items():
        if region is None:
            single = "; glint all over the picture counts as background" if name == "glint" else ""
            out.append(f"{name}: no region of its own{single}")
            continue
        if name == "background" and regions["glint"] is None and region.pixels == result.present["all"].pixels:
            out.append("background: the same as all")
            continue
        out.append(
            f"{name}: {region.pixels} pixels, mean {_resolved(region.mean, region.std)}, std {_short(region.std)}, "
            f"skewness {_short(region.skewness)}, excess kurtosis {_short(region.excess_kurtosis)}{_cut(region.saturated)}"
        )
        lengths, reason = region.correlation_length_px, region.correlation_length_reason
        out.append(
            f"  correlation length {_short(lengths.x)} x {_short(lengths.y)} px{f' ({reason})' if reason else ''}, "
            f"time {_short(region.correlation_time_s)} s; {_best(region.fits)}"
        )
        out.extend(f"  {_alarm(entry)}" for entry in region.false_alarms)
        out.extend(f"  note: {note}" for note in region.notes)
    out.extend(f"note: {note}" for note in result.notes)
    return out


def _cut(saturated: float) -> str:
    """Share of saturated values, where there are any."""
    return f", {100 * saturated:.3g} % saturated" if saturated > 0.0 else ""


def _alarm(entry: AlarmSummary) -> str:
    known = entry.rate_low is not None
    interval = f"{_short(entry.rate_low)} to {_short(entry.rate_high)}" if known else "no interval"
    note = f": {entry.note}" if entry.note and not known else f"; {entry.note}" if entry.note else ""
    return (
        f"{entry.filter} > {entry.threshold_sigma:g} sigma: {_short(entry.rate)} per pixel ({interval}{note}), "
        f"{_short(entry.ratio)} x Gaussian, correlation time {_short(entry.correlation_time_s)} s"
    )


FLOOR = 0.0051  #: Level of the goodness bootstrap's smallest answer, 1 in 200: not one of its draws was as far from the fit.


#: Independent values below which no family is called the best, as in :mod:`seaglint.clutter.fits`, which is slow to import.
FEWEST_JUDGED = 50


def _best(fits: dict[str, FitSummary]) -> str:
    valid = {name: fit for name, fit in fits.items() if fit.ks is not None}
    if not valid:
        return "best fit none"
    name = min(valid, key=lambda n: valid[n].ks or 0.0)
    fit = valid[name]
    shape = "" if fit.shape is None else f"shape {_short(fit.shape)}, "
    count = fit.effective_count
    if count is not None and count < FEWEST_JUDGED:
        return (
            f"{count:.0f} independent values, too few (below {FEWEST_JUDGED}) to say which family fits; "
            f"nearest: {name} ({shape}scale {_short(fit.scale)}, KS {_short(fit.ks)})"
        )
    judged = [f.ks_p for f in valid.values() if f.ks_p is not None]
    what = "none of the families fits; nearest:" if judged and max(judged) <= FLOOR else "best fit"
    level = "p not known" if fit.ks_p is None else f"p <= {FLOOR:.1g}" if fit.ks_p <= FLOOR else f"p {_short(fit.ks_p)}"
    of = "" if count is None else f" of {count:.0f} independent values"
    return f"{what} {name} ({shape}scale {_short(fit.scale)}, KS {_short(fit.ks)}, {level}{of})"


def _resolved(mean: float | None, std: float | None) -> str:
    """A mean with as many digits as its spread asks for: counts on a high level differ in the last ones."""
    if mean is None or not std or abs(mean) < 100.0 * std:
        return _short(mean)
    return f"{mean:.{min(len(str(int(abs(mean) / std))) + 3, 15)}g}"


def _short(value: float | None) -> str:
    return "-" if value is None else f"{value:.4g}"
