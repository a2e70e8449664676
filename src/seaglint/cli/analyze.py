"""``seaglint analyze``: a recording's clutter statistics and false alarms, as text, JSON or a report."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from seaglint.cli.terminal.progress import ProgressMode

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from seaglint.analysis import AnalysisOptions
    from seaglint.clutter.filters import Filter

RAW_NAMES = ("rows", "columns", "dtype", "byte_order", "offset", "frame_header")
RAW_HELP = "layout of a raw file, e.g. rows=512,columns=640,dtype=uint16,offset=0,frame_header=0"


def analyze(
    recording: Annotated[
        str, typer.Argument(metavar="INPUT", help="sequence or image: Zarr, NetCDF, PNG, TIFF, FITS, NumPy, HDF5, video, raw")
    ],
    as_json: Annotated[bool, typer.Option("--json", help="print JSON")] = False,
    report: Annotated[Path | None, typer.Option("--report", metavar="OUT.html", help="write a report, one file")] = None,
    frame_rate: Annotated[float | None, typer.Option("--frame-rate", help="frames per second, where the file does not say [Hz]")] = None,
    units: Annotated[str | None, typer.Option("--units", help="units of the values, where the file does not say")] = None,
    mask: Annotated[
        Path | None, typer.Option("--mask", help="image or .npy, not zero where the sea glints; instead of the segmentation")
    ] = None,
    rows: Annotated[str, typer.Option("--rows", help="part of the rows to analyse, as shares from the top: 0.45: or 0.2:0.8")] = ":",
    filter_name: Annotated[
        str, typer.Option("--filter", help="laplacian, difference-of-gaussians, median-subtraction, top-hat, matched, none")
    ] = "laplacian",
    kernel: Annotated[Path | None, typer.Option("--kernel", help="CSV or .npy of filter weights of your own, instead of --filter")] = None,
    signature: Annotated[Path | None, typer.Option("--signature", help="CSV or .npy of the target for --filter matched")] = None,
    threshold: Annotated[
        list[float] | None, typer.Option("--threshold", help="thresholds beside 3.0 and 3.5, in standard deviations; repeatable")
    ] = None,
    sigma: Annotated[
        str, typer.Option("--sigma", help="standard deviation of each 'frame', of the whole 'sequence', or 'local'")
    ] = "frame",
    detector: Annotated[
        list[str] | None,
        typer.Option(
            "--detector",
            help="ca-cfar, os-cfar, os-cfar-exponential, frame-difference, integration, or package.module:function; repeatable",
        ),
    ] = None,
    variable: Annotated[str | None, typer.Option("--variable", help="which array of a file that holds several")] = None,
    channel: Annotated[str | None, typer.Option("--channel", help="mean, red, green or blue of true colour images")] = None,
    axes: Annotated[
        str | None, typer.Option("--axes", help="order of an array of three axes: tyx (time first, the default) or yxt (time last)")
    ] = None,
    saturation: Annotated[float | None, typer.Option("--saturation", help="value from which on the sensor is saturated")] = None,
    border: Annotated[
        str,
        typer.Option(
            "--border", help="'keep' or 'drop' filtered pixels that see repeated ones beyond the border; 'auto': keep in one image"
        ),
    ] = "auto",
    raw: Annotated[str | None, typer.Option("--raw", help=RAW_HELP)] = None,
    seed: Annotated[int, typer.Option("--seed", min=0, help="of the samples that are drawn")] = 0,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="replace the report that is there")] = False,
    show: Annotated[
        ProgressMode, typer.Option("--progress", help="bar on a terminal, log lines elsewhere, or nothing")
    ] = ProgressMode.AUTO,
) -> None:
    """Clutter statistics and false alarms of a recording, by region."""
    from seaglint.analysis import analyze as run
    from seaglint.base.errors import DataError
    from seaglint.cli.terminal.progress import patient_progress
    from seaglint.files.outputs import refuse_existing
    from seaglint.files.recording import open_recording

    if report is not None:
        if report.suffix.lower() not in (".html", ".htm"):
            raise DataError(f"--report {report}: a report is an HTML file; give a name that ends in .html")
        refuse_existing(report, overwrite=overwrite, inputs=[path for path in (recording, mask, kernel, signature) if path is not None])
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
    options = _options(filter_name, kernel, signature, threshold or [], sigma, rows, mask, detector or [], seed, border)
    import warnings

    with warnings.catch_warnings():
        # Of numbers that do not exist (a constant frame, a detector that divides by 0): the result says what is absent and why.
        warnings.simplefilter("ignore", RuntimeWarning)
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
        typer.echo("\n".join(lines(analysis.as_dict())))


def _options(
    filter_name: str,
    kernel: Path | None,
    signature: Path | None,
    thresholds: list[float],
    sigma: str,
    rows: str,
    mask: Path | None,
    detectors: list[str],
    seed: int,
    border: str,
) -> AnalysisOptions:
    from seaglint.analysis import AnalysisOptions
    from seaglint.base.errors import DataError
    from seaglint.detection.named_detectors import named

    for value in thresholds:
        if not 0.0 < value < 100.0:
            raise DataError(f"--threshold {value:g}: give standard deviations above 0 and below 100")
    if sigma not in ("frame", "sequence", "local"):
        raise DataError(f"--sigma {sigma}: allowed are frame, sequence, local")
    if border not in ("auto", "keep", "drop"):
        raise DataError(f"--border {border}: allowed are auto, keep, drop")
    return AnalysisOptions(
        filter=filter_of(filter_name, kernel, signature),
        thresholds=tuple(thresholds),
        scope=sigma,  # type: ignore[arg-type]
        rows=_part(rows),
        mask=None if mask is None else read_mask(mask),
        detectors=tuple(named(name) for name in detectors),
        seed=seed,
        border=border,  # type: ignore[arg-type]
    )


def filter_of(name: str, kernel: Path | None, signature: Path | None) -> Filter:
    """Filter by name, or of the user's own weights or target."""
    from seaglint.base.errors import DataError
    from seaglint.clutter.filters import Kernel, MatchedFilter, named

    if kernel is not None:
        return Kernel(weights(kernel), name=kernel.stem)
    if name == "matched":
        if signature is None:
            raise DataError("--filter matched needs the target's signature: --signature FILE (CSV or .npy)")
        return MatchedFilter(weights(signature))
    return named(name)


def weights(path: Path) -> NDArray[np.float64]:
    """Numbers of a small CSV or NumPy file."""
    import numpy as np

    from seaglint.base.errors import DataError
    from seaglint.files.text_file import read_text

    try:
        if path.suffix == ".npy":
            return np.asarray(np.load(path, allow_pickle=False), dtype=np.float64)
        text = read_text(path, "give a CSV or .npy file").replace(";", " ").replace(",", " ")
        return np.loadtxt(text.splitlines(), dtype=np.float64, ndmin=2)
    except (OSError, ValueError) as error:
        raise DataError(f"{path}: cannot be read as rows of numbers ({str(error).splitlines()[0]}); give a CSV or .npy file") from error


def read_mask(path: Path) -> NDArray[np.bool_]:
    """Mask from an image or a NumPy file: true where it is not zero."""
    import numpy as np

    from seaglint.base.errors import DataError
    from seaglint.files.recording import open_recording

    opened = open_recording(path, channel=None)
    if opened.frames != 1:
        raise DataError(f"{path}: a mask is one image, this has {opened.frames} frames")
    return np.asarray(np.nan_to_num(opened.read(0, 1)[0]) != 0.0)


def _part(text: str) -> tuple[float, float]:
    from seaglint.base.errors import DataError

    first, colon, last = text.partition(":")
    try:
        if not colon:
            raise ValueError
        return float(first or 0.0), float(last or 1.0)
    except ValueError:
        raise DataError(f"--rows {text}: give FIRST:LAST as shares of the height from the top, e.g. 0.45: or 0.2:0.8") from None


def raw_layout(text: str | None) -> Any:
    """Layout of a raw file from ``name=value`` pairs; None where nothing is said."""
    if text is None:
        return None
    from seaglint.base.errors import DataError
    from seaglint.files.recording import RawLayout

    table: dict[str, Any] = {}
    for pair in text.split(","):
        name, sign, value = (part.strip() for part in pair.partition("="))
        if not sign:
            raise DataError(f"--raw {text}: give name=value pairs of {', '.join(RAW_NAMES)}, separated by commas")
        table[name] = _typed(value)
    return RawLayout.of(table, "--raw")


def _typed(value: str) -> int | float | str:
    """A whole number, a number, or text."""
    for kind in (int, float):
        try:
            return kind(value)
        except ValueError:
            continue
    return value


def lines(result: dict[str, Any]) -> list[str]:
    """The result as a few lines of text."""
    rate = result["frame_rate_hz"]
    units = result["units"] or "units not known"
    out = [
        f"{result['source']}: {result['frames']} frames of {result['columns']} x {result['rows']}, {units}, "
        + (f"{rate:g} Hz" if rate else "frame rate not known")
    ]
    regions = result["regions"]
    for name, region in regions.items():
        if region is None:
            out.append(f"{name}: none")
            continue
        if name == "background" and regions["glint"] is None and region["pixels"] == regions["all"]["pixels"]:
            out.append("background: the same as all")
            continue
        out.append(
            f"{name}: {region['pixels']} pixels, mean {_resolved(region['mean'], region['std'])}, std {_short(region['std'])}, "
            f"skewness {_short(region['skewness'])}, excess kurtosis {_short(region['excess_kurtosis'])}{_cut(region['saturated'])}"
        )
        lengths, reason = region["correlation_length_px"], region["correlation_length_reason"]
        out.append(
            f"  correlation length {_short(lengths['x'])} x {_short(lengths['y'])} px{f' ({reason})' if reason else ''}, "
            f"time {_short(region['correlation_time_s'])} s; {_best(region['fits'])}"
        )
        out.extend(f"  {_alarm(entry)}" for entry in region["false_alarms"])
        out.extend(f"  note: {note}" for note in region["notes"])
    out.extend(f"note: {note}" for note in result["notes"])
    return out


def _cut(saturated: float) -> str:
    """Share of saturated values, where there are any."""
    return f", {100 * saturated:.3g} % saturated" if saturated > 0.0 else ""


def _alarm(entry: dict[str, Any]) -> str:
    known = entry["rate_low"] is not None
    interval = f"{_short(entry['rate_low'])} to {_short(entry['rate_high'])}" if known else "no interval"
    note = f": {entry['note']}" if entry["note"] and not known else f"; {entry['note']}" if entry["note"] else ""
    return (
        f"{entry['filter']} > {entry['threshold_sigma']:g} sigma: {_short(entry['rate'])} per pixel ({interval}{note}), "
        f"{_short(entry['ratio'])} x Gaussian, correlation time {_short(entry['correlation_time_s'])} s"
    )


FLOOR = 0.0051
"""Level of the goodness bootstrap's smallest answer, 1 in 200: not one of its draws was as far from the fit."""


FEWEST_JUDGED = 50
"""Independent values below which no family is called the best, as in :mod:`seaglint.clutter.goodness`, which is slow to import."""


def _best(fits: dict[str, Any]) -> str:
    valid = {name: fit for name, fit in fits.items() if fit["ks"] is not None}
    if not valid:
        return "best fit none"
    name = min(valid, key=lambda n: float(valid[n]["ks"]))
    fit = valid[name]
    shape = "" if fit["shape"] is None else f"shape {_short(fit['shape'])}, "
    count = fit["effective_count"]
    if count is not None and count < FEWEST_JUDGED:
        return (
            f"{count:.0f} independent values, too few (below {FEWEST_JUDGED}) to say which family fits; "
            f"nearest: {name} ({shape}scale {_short(fit['scale'])}, KS {_short(fit['ks'])})"
        )
    judged = [f["ks_p"] for f in valid.values() if f["ks_p"] is not None]
    what = "none of the families fits; nearest:" if judged and max(judged) <= FLOOR else "best fit"
    level = "p not known" if fit["ks_p"] is None else f"p <= {FLOOR:.1g}" if fit["ks_p"] <= FLOOR else f"p {_short(fit['ks_p'])}"
    of = "" if count is None else f" of {count:.0f} independent values"
    return f"{what} {name} ({shape}scale {_short(fit['scale'])}, KS {_short(fit['ks'])}, {level}{of})"


def _resolved(mean: float | None, std: float | None) -> str:
    """A mean with as many digits as its spread asks for: counts on a high level differ in the last ones."""
    if mean is None or not std or abs(mean) < 100.0 * std:
        return _short(mean)
    return f"{mean:.{min(len(str(int(abs(mean) / std))) + 3, 15)}g}"


def _short(value: float | None) -> str:
    return "-" if value is None else f"{value:.4g}"
