"""Report of an analysis: one HTML file with its tables and pictures inside, which loads nothing from the network."""

from __future__ import annotations

from html import escape
from pathlib import Path
from typing import Final

from seaglint.analysis import Analysis
from seaglint.base.conventions import Progress
from seaglint.base.free_form import JsonObject
from seaglint.clutter.segmentation import LEAST_CONTRAST, LEAST_SYMMETRY, SHARPEST_BORDER
from seaglint.plot.clutter_pictures import FAMILY_NAMES, PICTURES, unit_of
from seaglint.plot.figures_and_pages import ABSENT, all_numbers, bullets, figure, interval, notes, number, page, png, section, table
from seaglint.store.outputs import refuse_existing, write_text
from seaglint.version import __version__

_SIGMA: Final = {
    "frame": "the mean and standard deviation of the region in the same frame",
    "sequence": "the mean and standard deviation of the region over the whole sequence",
    "local": "the mean and standard deviation around each pixel",
}


def write_report(analysis: Analysis, path: str | Path, *, overwrite: bool = False, progress: Progress = lambda done, total: None) -> Path:
    """Write the report of an analysis; the same analysis gives the same bytes.

    Parameters
    ----------
    analysis : Analysis
        From ``seaglint.analysis.analyze``.
    path : path
        File to write, usually ``.html``.
    overwrite : bool
        Flag: an existing file may be replaced.
    progress : callable
        Called with the numbers of pictures: drawn, and in all.

    Returns
    -------
    Path
        The path.

    Raises
    ------
    DataError
        The file exists, or its folder does not.
    StorageError
        No room or no rights; nothing is left behind.
    """
    output = refuse_existing(path, overwrite=overwrite)
    write_text(report(analysis, progress), output)
    return output


def report(analysis: Analysis, progress: Progress = lambda done, total: None) -> str:
    """Return the report as HTML text."""
    results = analysis.as_dict()
    images: dict[str, str] = {}
    for done, (name, picture) in enumerate(PICTURES.items(), start=1):
        images[name] = figure(png(picture.draw(analysis)), picture.title, picture.caption)
        progress(done, len(PICTURES))
    title = f"Clutter and false alarms: {analysis.recording.source}"
    body = [
        f"<h1>{escape(title)}</h1>",
        f'<p class="facts">{escape(_facts(analysis))}</p>',
        _notes(analysis),
        section("False alarms", _summary(analysis), images["rates"]),
        section("Regions", f"<p>{escape(_segmentation(results))}</p>", images["regions"], _moments(results)),
        section("Exceedances and events", images["exceedances"], _events(analysis), images["slices"]),
        section("Beyond the data", _tails(analysis)),
        section("Distributions", images["histograms"], *_fits(analysis)),
        section("Correlation, spectrum, stationarity", _memory(results), images["memory"]),
        section("How it was done", *_methods(analysis)),
        all_numbers(results),
    ]
    return page(title, body)


def _facts(analysis: Analysis) -> str:
    recording = analysis.recording
    rate, frames = recording.frame_rate, recording.frames
    facts = [
        "1 frame" if frames == 1 else f"{frames} frames",
        f"{recording.columns} × {recording.rows} pixels",
        f"{rate:g} Hz" if rate is not None else "frame rate not known",
        f"units {unit_of(recording.units)}" if recording.units else "units not known",
        f"filter {analysis.options.filter.name}",
        "blur not known" if recording.blur_px is None else f"blur {recording.blur_px:.2g} px" if recording.blur_px else "no blur",
        f"seaglint {__version__}",
    ]
    return " · ".join(facts)


def _notes(analysis: Analysis) -> str:
    own = [f"{name}: {note}" for name, region in analysis.regions.items() for note in region.notes]
    return notes([*analysis.notes, *own], "Nothing unusual was found in the data.")


def _alarms(analysis: Analysis) -> list[tuple[str, JsonObject]]:
    """Regions' names with the plain numbers of their false alarms."""
    return [(name, alarm.as_dict()) for name, region in analysis.regions.items() for alarm in region.false_alarms]


def _summary(analysis: Analysis) -> str:
    timed = analysis.recording.frame_rate is not None
    rows = []
    for name, alarm in _alarms(analysis):
        notes = [text for text in (alarm["note"], alarm["correlation_note"]) if text]
        row = [name, alarm["filter"], *(number(alarm[key]) for key in ("threshold_sigma", "exceedances", "rate"))]
        row += [interval([alarm["rate_low"], alarm["rate_high"]]), *(number(alarm[key]) for key in ("gaussian_rate", "ratio", "inflation"))]
        rows.append([*row, number(alarm[f"correlation_time_{'s' if timed else 'frames'}"]), "; ".join(dict.fromkeys(notes))])
    head = ["region", "filter or detector", "threshold [σ]", "false alarms", "rate per pixel", "95 % interval", "Gaussian tail"]
    head += ["rate / Gaussian", "variance / independent", f"correlation time [{'s' if timed else 'frames'}]", "remarks"]
    return table(head, rows, words=(10,))


def _segmentation(results: JsonObject) -> str:
    result = results["segmentation"]
    text = f"Method: {result['method']}."
    if result["symmetry"] is not None:
        text += (
            f" A peak about the vertical axis at column {number(result['axis_column'])} explains {100 * result['symmetry']:.0f} % of the "
        )
        text += f"variation along rows (of a corridor at least {100 * LEAST_SYMMETRY[0]:.0f} %), contrast {number(result['contrast'])} "
        text += f"standard deviations of the background (at least {LEAST_CONTRAST[0]:g})"
        step, fine = result["border_step"], result["sparkle"]
        text += "." if step is None else f", {100 * step:.0f} % of the step at the border (at most {100 * SHARPEST_BORDER[0]:.0f} %)."
        if fine["structure_ratio"] is not None:
            text += (
                f" Fine structure {number(fine['structure_ratio'])} times the background's, skewness {number(fine['skewness_within'], 2)} "
            )
            text += f"within and {number(fine['skewness_beside'], 2)} beside."
    if result["reason"]:
        text += f" No corridor: {result['reason']}."
    if result["sky_pixels"]:
        text += f" {number(result['sky_pixels'])} pixels lie in smooth rows on top, sky or far sea, and belong to neither region."
    return text


def _present(results: JsonObject) -> JsonObject:
    """Results of the regions that exist, by name."""
    return {name: region for name, region in results["regions"].items() if region is not None}


def _moments(results: JsonObject) -> str:
    unit = unit_of(results["units"])
    keys = ("pixels", 3), ("values", 3), ("mean", 5), ("std", 5), ("minimum", 5), ("maximum", 5), ("skewness", 3), ("excess_kurtosis", 3)
    rows = [
        [name, *(number(r[key], digits) for key, digits in keys), number(100.0 * r["saturated"])] for name, r in _present(results).items()
    ]
    head = ["region", "pixels", "values", f"mean [{unit}]", f"standard deviation [{unit}]", f"minimum [{unit}]", f"maximum [{unit}]"]
    return table([*head, "skewness", "excess kurtosis", "saturated [%]"], rows)


def _events(analysis: Analysis) -> str:
    keys = "threshold_sigma", "events", "events_per_frame", "event_duration_s"
    rows = [[name, alarm["filter"], *(number(alarm[key]) for key in keys)] for name, alarm in _alarms(analysis)]
    head = ["region", "filter or detector", "threshold [σ]", "events", "events per frame", "mean duration [s]"]
    return "<p>An event is a set of exceeding pixels that touch in a frame or from one frame to the next.</p>" + table(head, rows)


def _tails(analysis: Analysis) -> str:
    rows = []
    for name, alarm in _alarms(analysis):
        tail = alarm["tail"]
        if tail is None:
            continue
        if tail["reason"] is not None:
            rows.append([name, alarm["filter"], *[ABSENT] * 8, tail["reason"]])
            continue
        row = [name, alarm["filter"], *(number(tail[key]) for key in ("from_sigma", "events", "shape")), interval(tail["shape_interval"])]
        rows.append([*row, *(number(tail[key]) for key in ("scale_sigma", "goodness_p", "trusted_to_sigma", "trusted_to_rate")), ""])
    head = ["region", "filter or detector", "from [σ]", "events", "shape ξ", "95 % interval", "scale β [σ]", "goodness p"]
    head += ["trusted to [σ]", "trusted to rate", "remarks"]
    text = (
        "<p>rate(m) = rate(u) (1 + ξ (m − u)/β)<sup>−1/ξ</sup> above u, each event counted as one observation. ξ above 0 is a power law, "
        "0 an exponential, below 0 a tail that ends. The rate is trusted while its 95 % interval spans less than a factor of ten, "
        "and not below one exceedance in ten such data sets; both given that the form of the tail holds.</p>"
    )
    return text + table(head, rows, words=(10,))


def _fits(analysis: Analysis) -> list[str]:
    unit = unit_of(analysis.recording.units)
    head = ["family", "shape", "95 % interval", f"scale [{unit}]", "95 % interval", f"loc [{unit}]", "KS", "level", "AD", "level"]
    head += ["log likelihood per value", "independent values", "remarks"]
    parts = []
    for name, region in analysis.regions.items():
        rows = []
        for family, fit in region.fits.items():
            f = fit.as_dict()
            remark = f["reason"] or (f"{100 * fit.excluded:.2g} % of the values, not above loc, left out" if fit.excluded else "")
            least = None if fit.goodness is None else 1.0 / (fit.goodness.replicates + 1)
            row = [FAMILY_NAMES.get(family, family), number(f["shape"], 4), interval(f["shape_interval"]), number(f["scale"], 4)]
            row += [interval(f["scale_interval"]), number(f["loc"], 4), number(f["ks"]), _level(f["ks_p"], least), number(f["ad"])]
            row += [_level(f["ad_p"], least), number(f["log_likelihood_per_value"], 5), number(f["effective_count"], 4), remark]
            rows.append(row)
        parts += [f"<h3>{escape(name)}</h3>", table(head, rows, words=(12,))]
    return parts


def _level(p: float | None, least: float | None) -> str:
    """Return a level as text; the smallest level of the bootstrap is an upper bound."""
    # A thousandth allows for rounding of the smallest level, 1 / (replicates + 1).
    return f"≤\u00a0{number(p, 2)}" if p is not None and least is not None and p <= 1.001 * least else number(p, 2)


def _memory(results: JsonObject) -> str:
    rows = []
    for name, r in _present(results).items():
        length, still, verdict = r["correlation_length_px"], r["stationarity"], r["stationary"]
        block = " × ".join(map(str, still["block_px"])) if min(still["block_px"]) > 0 else ABSENT
        row = [name, number(length["x"]), number(length["y"]), number(r["correlation_time_s"]), number(r["correlation_time_frames"])]
        row += ["not decidable" if verdict is None else number(verdict), number(still["p_mean"], 2), number(still["p_variance"], 2)]
        rows.append([*row, block, still["reason"] or ""])
    head = ["region", "length x [px]", "length y [px]", "time [s]", "time [frames]", "stationary", "p, means", "p, variances"]
    blur = f"<p>Blur of the frames: {escape(results['blur'])}.</p>"
    return blur + table([*head, "blocks, rows × columns [px]", "remarks"], rows, words=(9,))


def _made(analysis: Analysis) -> str:
    """Return how the regions were made."""
    options = analysis.options
    if options.regions is not None:
        return f"given: {', '.join(analysis.names[1:])}"
    return "all pixels (no_glint)" if options.no_glint else "segmented" if options.mask is None else "mask given"


def _methods(analysis: Analysis) -> list[str]:
    options = analysis.options
    first, last = options.rows
    done = [
        f"Filter: {options.filter.name}, applied to whole frames; the nearest pixel is repeated beyond the border, and the pixels that see "
        f"it are {'counted' if analysis.border_included else 'left out of sigma and rates'}.",
        f"Thresholds are on the bright side, in standard deviations of the filtered image above its mean: {_SIGMA[options.scope]}.",
        "A rate is the number of pixels above the threshold over the number of pixels looked at. Its interval has an "
        "effective number of pixels, from the scatter of counts between tiles and times at this threshold and at a lower one.",
        "Correlation times of exceedances and of brightness are where the correlation falls to 1/e; lengths likewise.",
        "Fits are by maximum likelihood with location 0 (Gaussian: fitted); intervals come from blocks some correlation lengths wide where "
        "there are enough of them, else from the number of independent values. Levels of KS (Kolmogorov-Smirnov) and AD "
        "(Anderson-Darling) come from a parametric bootstrap with that number, so that neither fitted parameters nor correlated pixels "
        "make a fit look worse than it is. A small level speaks against the family; a large one does not prove it.",
        f"Stationarity: {next((region.stationarity.method for region in analysis.regions.values()), '')}.",
        f"Regions: {analysis.segmentation.method}.",
    ]
    if options.detectors:
        names = ", ".join(d.name + (" (promises its own rate)" if d.calibrated else "") for d in options.detectors)
        done.append(f"Detectors judged by the same counting: {names}.")
    used = [
        ["source", analysis.recording.source],
        ["filter", options.filter.name],
        ["thresholds beside 3.0 and 3.5", ", ".join(f"{t:g}" for t in options.thresholds) or "none"],
        ["sigma of", options.scope],
        ["rows", "all" if (first, last) == (0.0, 1.0) else f"{first:g} to {last:g} of the height"],
        ["regions", _made(analysis)],
        ["detectors", ", ".join(d.name for d in options.detectors) or "none"],
        ["seed", str(options.seed)],
        ["seaglint", __version__],
    ]
    return [bullets(done), table(["option", "value"], used, words=(1,))]
