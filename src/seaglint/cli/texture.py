"""``seaglint texture``: statistical textures fitted to recordings, sampled as endless sequences, compared, laid on the sea."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from seaglint.cli.analyze import refuse_report
from seaglint.cli.terminal.messages import files_read, log, log_notes, naming_file, print_json, print_lines
from seaglint.cli.terminal.options import ProgressOption
from seaglint.cli.terminal.progress import ProgressMode
from seaglint.cli.terminal.record_options import Without, takes_records
from seaglint.studies.study_requests import CompareRequest, FitRequest, PlaceRequest, ReadingRequest, SampleRequest

if TYPE_CHECKING:
    from seaglint.analysis.recording import Recording
    from seaglint.base.free_form import JsonObject
    from seaglint.studies.texture.texture_sequences import DataLikelihood, Fitted
    from seaglint.textures.quality import TextureDistances

texture = typer.Typer(rich_markup_mode=None, no_args_is_help=True, help="Statistical textures: fit, sample, compare, lay on the sea.")


Input = Annotated[str, typer.Argument(metavar="INPUT", help="what 'seaglint analyze' reads: Zarr, NetCDF, PNG, TIFF, FITS, NumPy, video")]
Reading = Annotated[ReadingRequest, Without(("saturation",))]


@texture.command()
@takes_records(
    order="recording output model tails region any_region detrend mask keep_defects product order isotropic levels method "
    "keep_histogram report as_json frame_rate units variable channel axes missing raw"
)
def fit(
    recording: Input,
    output: Annotated[Path, typer.Option("-o", "--output", help="texture to write, e.g. model.json")],
    request: FitRequest,
    reading: Reading,
    report: Annotated[Path | None, typer.Option("--report", metavar="F.html", help="write data and sample side by side")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="print the texture's file")] = False,
) -> None:
    """Fit a texture to a recording and report its quality."""
    from seaglint.base.errors import DataError
    from seaglint.store.outputs import refuse_existing
    from seaglint.store.texture_file import check_name, write_texture
    from seaglint.studies.texture.texture_sequences import fit as fitted

    refuse_existing(check_name(output), overwrite=request.overwrite, inputs=[recording])
    if report is not None:
        refuse_report(report, request.overwrite, [recording, output])
    if request.model == "autobinomial" and request.tails not in ("auto", "gaussian"):
        raise DataError(f"--tails {request.tails}: an autobinomial texture has the histogram of its picture; leave --tails out")
    opened = reading.opened(recording)
    log_notes(recording, opened)
    result = fitted(opened, request)
    write_texture(result.stored, output, overwrite=request.overwrite)
    log(f"{output} written")
    if report is not None:
        from seaglint.plot.texture_report import write_comparison

        about = [*model_lines(result.stored.to_dict()), *result.stored.notes]
        write_comparison(
            result.comparison, result.data, result.sample, report, gaussian=result.gaussian, about=about, overwrite=request.overwrite
        )
        log(f"{report} written")
    if as_json:
        print_json(result.stored.to_dict())
    else:
        print_lines(fit_lines(result))


@texture.command()
@takes_records(order="model output")
def sample(
    model: Annotated[Path, typer.Argument(metavar="MODEL.json", help="texture of 'seaglint texture fit'")],
    output: Annotated[Path, typer.Option("-o", "--output", help="Zarr store or video to write, e.g. loop.zarr or loop.mp4")],
    request: SampleRequest,
    show: ProgressOption = ProgressMode.AUTO,
) -> None:
    """Draw a sample, periodic in rows, columns and time."""
    from seaglint.cli.terminal.progress import patient_progress
    from seaglint.store.texture_file import read_texture
    from seaglint.studies.texture.texture_sequences import loop
    from seaglint.studies.texture.texture_sequences import sample as sampled

    stored = read_texture(model)
    with patient_progress(show, "frames") as report:
        if output.suffix.lower() in (".mp4", ".gif"):
            from seaglint.plot.run_export import export_run
            from seaglint.store.outputs import refuse_existing

            refuse_existing(output, overwrite=request.overwrite, inputs=[model])
            export_run(loop(stored, request), output, overwrite=request.overwrite, progress=report)
        else:
            sampled(stored, output, request, progress=report)
    what = f"a loop of {request.frames} frames" if request.frames > 1 else "1 frame"
    log(f"{output}: {what} of {request.size[0]} x {request.size[1]} pixels, periodic along every axis")


@texture.command()
@takes_records(order="first second regions report as_json")
def compare(
    first: Annotated[str, typer.Argument(metavar="A", help="the data: a recording")],
    second: Annotated[str, typer.Argument(metavar="B", help="recording to judge, or a texture .json to draw a sample from")],
    reading: Reading,
    request: CompareRequest,
    report: Annotated[Path | None, typer.Option("--report", metavar="F.html", help="write both side by side")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="print JSON")] = False,
) -> None:
    """Compare two textures in numbers.

    Filtered false alarms, values, spectra, correlations and co-occurrence.
    """
    from seaglint.base.errors import DataError
    from seaglint.studies.texture.texture_sequences import compare_textures

    if len(request.regions) > 2:
        raise DataError(f"--region is given {len(request.regions)} times; give one for A and one for B")
    if report is not None:
        refuse_report(report, request.overwrite, [first, second])

    def opened(path: str | Path) -> Recording:
        recording = reading.opened(path)
        log_notes(path, recording)
        return recording

    comparison, one, other, likelihood, notes = compare_textures(first, second, opened, request)
    if report is not None:
        from seaglint.plot.texture_report import write_comparison

        write_comparison(comparison, one, other, report, about=notes, overwrite=request.overwrite)
        log(f"{report} written")
    if as_json:
        print_json({**comparison.as_dict(), "likelihood": None if likelihood is None else asdict(likelihood), "notes": list(notes)})
    else:
        print_lines(comparison_lines(comparison.distances, likelihood) + [f"note: {note}" for note in notes])


@texture.command()
@takes_records(order="model scenario output")
def place(
    model: Annotated[Path, typer.Argument(metavar="MODEL.json", help="Gauss-Markov texture of 'seaglint texture fit'")],
    scenario: Annotated[Path, typer.Argument(metavar="SCENARIO.toml", help="scenario file: camera, horizon, mean and contrast")],
    output: Annotated[Path, typer.Option("-o", "--output", help="Zarr store to write")],
    request: PlaceRequest,
    show: ProgressOption = ProgressMode.AUTO,
) -> None:
    """Lay a texture on the sea of a scenario, instead of rendering."""
    from dataclasses import replace

    from seaglint.cli.terminal.options import parse_frames
    from seaglint.cli.terminal.progress import patient_progress
    from seaglint.scenario.load import load_scenario
    from seaglint.store.sequence_store import check_output, open_sequence
    from seaglint.store.stored_images import summarise
    from seaglint.store.texture_file import read_texture
    from seaglint.studies.texture.perspective import place as placed

    stored, loaded = read_texture(model), load_scenario(scenario)
    check_output(output, overwrite=request.overwrite, inputs=[*files_read(scenario, loaded), model])
    numbered = replace(request, frames=parse_frames(request.frames, loaded.sensor.frames))
    with naming_file(scenario, loaded), patient_progress(show, "frames") as report:
        placed(stored, loaded, output, numbered, progress=report)
    with open_sequence(output) as dataset:
        log(f"{output}: {summarise(dataset).line}")
        if dataset.attrs["texture_contrast"] == "model":
            log("the texture's standard deviation is scaled with the sea's radiance: fit it to a sea of this band and light")


def fit_lines(result: Fitted) -> list[str]:
    """Return a fitted texture as a few lines of text."""
    out = model_lines(result.stored.to_dict())
    held_out = result.held_out
    if held_out.log_pseudo_likelihood is None:
        out.append(f"held-out pseudo-likelihood: none ({held_out.reason})")
    else:
        value, alone = held_out.log_pseudo_likelihood, held_out.independent_pixels
        gain = "" if held_out.gain is None else f"; {held_out.gain:+.4g} nat by the neighbours"
        out.append(
            f"held-out log pseudo-likelihood per pixel {value:.4g} (independent pixels {alone:.4g}{gain}){_outside(held_out.outside)}"
        )
    out += comparison_lines(result.comparison.distances)
    for entry in () if result.gaussian is None else result.gaussian.distances.filtered_rates:
        out.append(f"  a Gaussian field, {entry.threshold_sigma:g} sigma: {entry.ratio.text} times the data's rate")
    return out + [f"note: {note}" for note in result.stored.notes]


def model_lines(stored: JsonObject) -> list[str]:
    """Return the model, its parameters and the data of a fit as lines of text."""
    from seaglint.textures.gaussian_texture import NAMES, GaussianTexture

    model, source = stored["model"], stored["source"]
    out = [f"{source['input']}: {_frames(source['frames'])} of {source['columns']} x {source['rows']} pixels, region {source['region']}"]
    if model["kind"] == "gauss-markov":
        slow = model["modulation"]
        shape = "" if "shape" not in model["marginal"] else f" of shape {model['marginal']['shape']:.3g}"
        law = GaussianTexture.from_dict(model).law
        lengths = "" if slow is None else ", ".join(f"{length:.3g}" for length in slow["lengths"][1:])
        out.append(
            f"Gauss-Markov field of {len(model['offsets'])} neighbour pairs: {NAMES[law.tails]}{shape}"
            + ("" if slow is None else f", times a slow gamma field of shape {slow['shape']:.3g} and lengths {lengths} px (rows, columns)")
        )
        out.append(f"correlations of samples agree with the data's to {max(stored['fit']['correlation_error'], 1e-9):.1g} of the variance")
    else:
        errors = stored["fit"]["standard_errors"]
        parameters = [f"{v:.4g}" + ("" if e is None else f" +- {e:.2g}") for v, e in zip(stored["fit"]["parameters"], errors, strict=True)]
        out.append(f"autobinomial field of {model['levels']} levels: alpha {parameters[0]}; beta {', '.join(parameters[1:])}")
        out.append(f"couplings by {stored['fit']['method']}, samples by {model['sampler']}")
    return out


def comparison_lines(distances: TextureDistances, likelihood: DataLikelihood | None = None) -> list[str]:
    """Return a comparison as a few lines of text."""
    from seaglint.clutter.rate_ratios import VERDICTS

    values = distances.marginal
    out = [f"{distances.second} against {distances.first}:"]
    for entry in distances.filtered_rates:
        out.append(
            f"  filtered > {entry.threshold_sigma:g} sigma: {entry.first:.3g} and {entry.second:.3g} per pixel "
            f"({entry.first_over_gaussian:.3g} and {entry.second_over_gaussian:.3g} x Gaussian), "
            f"ratio {entry.ratio.text}: {VERDICTS[entry.verdict]}"
        )
    out.append(
        f"  values: KS {values.ks:.3g}, Wasserstein {values.wasserstein_std:.3g} standard deviations, "
        f"skewness {values.first.skewness:.3g} and {values.second.skewness:.3g}"
    )
    time = distances.time_correlation_distance
    out.append(
        f"  spectra {distances.spectrum_distance_db:.3g} dB, correlations in space {distances.correlation_distance:.3g}"
        + ("" if time is None else f", in time {time:.3g}")
    )
    features = ", ".join(f"{name} {pair.first:.3g} / {pair.second:.3g}" for name, pair in distances.cooccurrence.items())
    out.append(f"  co-occurrence: {features}")
    if likelihood is not None and likelihood.log_pseudo_likelihood is None:
        out.append(f"  log pseudo-likelihood per pixel of the data: none ({likelihood.reason})")
    elif likelihood is not None:
        gain = "" if likelihood.gain is None else f" ({likelihood.gain:+.4g} nat by the neighbours)"
        value = f"{likelihood.log_pseudo_likelihood:.4g}{gain}{_outside(likelihood.outside)}"
        out.append(f"  log pseudo-likelihood per pixel of the data: {value}")
    out += [f"  fails: {sentence}" for sentence in distances.fails]
    if not distances.fails:
        out.append("  no difference is beyond its limit" if distances.undecided else "  all differences are within their limits")
    return out


def _outside(share: float | None) -> str:
    return f", without {100.0 * share:.2g} % of the pixels, which the distribution excludes" if share else ""


def _frames(count: int) -> str:
    return f"{count} frame{'s' * (count != 1)}"
