"""The commands ``seaglint sense`` and ``seaglint sensor``."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from seaglint.base.errors import DataError
from seaglint.cli.terminal.messages import files_read, log, log_notes, naming_file, print_json, print_lines
from seaglint.cli.terminal.options import AsJson, ShardOption, StoreOption, place_given
from seaglint.cli.terminal.program import only_numpy
from seaglint.cli.terminal.progress import patient_progress
from seaglint.cli.terminal.record_options import RunOptions, Without, report_share, takes_records
from seaglint.studies.study_requests import SenseRequest

if TYPE_CHECKING:
    import xarray as xr

    from seaglint.instrument.data_sheet import SensorDataSheet


ScenarioFile = Annotated[Path, typer.Argument(metavar="SCENARIO.toml", help="scenario file with [sensor.optics] and [sensor.detector]")]
SensorPreset = Annotated[
    str | None, typer.Option("--sensor", help="sensor of a data sheet instead of the scenario's: 'seaglint sensor --presets' lists them")
]


def _list_presets(requested: bool) -> None:
    if requested:
        from seaglint.scenario.presets import SENSORS

        for name, preset in SENSORS.items():
            typer.echo(f"{name:24} {preset.title}")
        raise typer.Exit


@takes_records(
    order="recording scenario output seed oversampling electrons sensor frame_rate variable channel axes missing "
    "resume overwrite show workers dask dask_slurm"
)
def sense(
    recording: Annotated[
        str, typer.Argument(metavar="INPUT", help="radiance at the aperture in W m-2 sr-1: Zarr, NetCDF, NumPy, TIFF and more")
    ],
    scenario: ScenarioFile,
    output: StoreOption,
    request: Annotated[SenseRequest, Without(("units", "saturation", "raw", "threads"))],
    run: Annotated[RunOptions, Without(("threads",))],
    sensor: SensorPreset = None,
    shard: ShardOption = None,
) -> None:
    """Put a sensor on recorded radiance: counts of its detector."""
    from seaglint.formats.recording.labelled_arrays import source_of
    from seaglint.scenario.load import load_scenario
    from seaglint.store.sequence_store import check_output, open_sequence
    from seaglint.store.writers import Share
    from seaglint.studies.sequence.sense import Reopen
    from seaglint.studies.sequence.sense import sense as sensed

    only_numpy()
    loaded = load_scenario(scenario, sensor=sensor)
    store, share = place_given(output), None if shard is None else Share.parse(shard)
    check_output(
        store, resume=request.resume, overwrite=request.overwrite, inputs=[*files_read(scenario, loaded), Path(recording)], share=share
    )
    opened = request.opened(recording)
    log_notes(recording, opened)
    with naming_file(scenario, loaded), run.chosen() as workers, patient_progress(run.show, "frames") as report:
        sensed(
            opened,
            loaded,
            store,
            source=source_of(Path(recording)),
            seed=request.seed,
            oversampling=request.oversampling,
            electrons=request.electrons,
            resume=request.resume,
            overwrite=request.overwrite,
            progress=report,
            share=share,
            workers=workers,
            reopen=Reopen(Path(recording), request),
        )
    if share is not None:
        report_share(store, share)
        return
    with open_sequence(store) as dataset:
        log(f"{store}: {line(dataset)}")


def line(dataset: xr.Dataset) -> str:
    """Return a line about a sequence of counts: size, range, and share of saturated pixels."""
    import numpy as np

    signal, share = dataset["signal"], dataset["saturated_share"].to_numpy()
    first = signal.isel(time=0).to_numpy()
    count = signal.sizes["time"]
    message = (
        f"{count} frame{'s' * (count != 1)} of {signal.sizes['x']} x {signal.sizes['y']} pixels, counts {first.min()} to {first.max()}"
    )
    if float(np.nanmax(share)) == 0.0:
        return f"{message} in the first; no pixel is saturated"
    worst = int(np.nanargmax(share))
    return f"{message} in the first; saturated {100 * float(np.nanmean(share)):.3g} % of the pixels, most in frame {worst}: " + (
        f"{100 * float(share[worst]):.3g} %"
    )


def sensor(
    scenario: ScenarioFile,
    as_json: AsJson = False,
    plot: Annotated[Path | None, typer.Option("--plot", metavar="F.png", help="draw MTF and noise budget")] = None,
    frequency: Annotated[
        list[float] | None, typer.Option("--frequency", min=0.0, help="frequencies of the MTF, in cycles/mrad; repeatable")
    ] = None,
    sensor: SensorPreset = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="replace the picture that is there")] = False,
    presets: Annotated[bool, typer.Option("--presets", callback=_list_presets, is_eager=True, help="list sensors and leave")] = False,
) -> None:
    """Figures of merit of a sensor: NETD, MTF, noise budget."""
    from seaglint.scenario.load import load_scenario
    from seaglint.store.outputs import refuse_existing
    from seaglint.studies.mean.sensor_figures import describe_sensor

    only_numpy()
    loaded = load_scenario(scenario, sensor=sensor)
    if plot is not None:
        if plot.suffix.lower() not in (".png", ".pdf", ".svg"):
            raise DataError(f"--plot {plot}: give a name that ends in .png, .pdf or .svg")
        refuse_existing(plot, overwrite=overwrite, inputs=files_read(scenario, loaded))
    with naming_file(scenario, loaded):
        described = describe_sensor(loaded, frequency or ())
    if described.air is not None and described.air.line is not None:
        log(described.air.line)
    if plot is not None:
        from seaglint.plot.sensor_and_spectra import write_sensor_plot

        write_sensor_plot(described.sheet, plot)
        log(f"{plot} written")
    if as_json:
        print_json(described.as_dict())
    else:
        print_lines(lines(described.sheet, described.from_netd))


def lines(sheet: SensorDataSheet, from_netd: Mapping[str, float]) -> list[str]:
    """Return the figures of merit as lines of text, and the keys of the detector that follow from a stated NETD."""
    from seaglint.instrument.figures_of_merit import MTF_POINTS

    unit, budget, mtf = sheet.unit, sheet.noise_budget, sheet.mtf
    low, high = sheet.band_um
    out = [
        f"{sheet.detector} detector, {low:g} to {high:g} um, F/{sheet.f_number:.3g}, focal length {1e3 * sheet.focal_length_m:.4g} mm",
        f"  IFOV                    {sheet.ifov_mrad:.5g} mrad, pictures drawn {sheet.oversampling} times finer",
        f"  NETD                    {1e3 * sheet.netd_k:.4g} mK at {sheet.background_k:g} K",
        *(f"    as stated, which gives {key} = {value:.4g}" for key, value in from_netd.items()),
        f"  SiTF                    {sheet.sitf_counts_per_k:.5g} counts/K",
        f"  gain                    {sheet.electrons_per_count or sheet.nw_per_count:.5g} {unit}/count",
        f"  NEI                     {sheet.nei_w_m2:.4g} W m-2 at the aperture",
        f"  point in its pixel      {sheet.point_response:.3g} of the contrast of a pixel full of its light "
        f"({100 * sheet.point_share:.3g} % of its light on the sensitive area)",
        f"  NEP                     {sheet.nep_w:.4g} W on the pixel",
    ]
    if sheet.dynamic_range_db is not None:
        out.append(f"  dynamic range           {sheet.dynamic_range_db:.4g} dB")
    if sheet.saturation_temperature_k is not None:
        out.append(f"  saturates at            {sheet.saturation_temperature_k:.5g} K")
    out.append(f"  MTF [cycles/mrad]       along   across  (Nyquist {mtf.nyquist_cycles_per_mrad:.4g})")
    # Of the default frequencies every fifth is printed; frequencies that the user gave are all printed.
    for i in range(0, len(mtf.along), 5 if len(mtf.along) == MTF_POINTS else 1):
        out.append(f"    {mtf.frequency_cycles_per_mrad[i]:<21.4g} {mtf.along[i]:<7.3f} {mtf.across[i]:.3f}")
    scene = budget.scene_apparent_temperature_k
    full = budget.scene_radiance > sheet.saturation_radiance
    out.append(
        f"  noise budget [{unit}] at the scene's mean of {budget.scene_radiance:.4g} W m-2 sr-1"
        + (f" ({scene:.4g} K)" if scene else "")
        + (": above saturation; the budget ignores that the well is full" if full else "")
    )
    for name, value in {"signal": budget.signal, **budget.noise}.items():
        if value or name in ("signal", "total_temporal"):
            out.append(f"    {name.replace('_', ' '):<21} {value:.5g}")
    parts = ", ".join(f"{name} {value:.4g}" for name, value in sheet.three_d_noise.items())
    out.append(f"  3-D noise [{unit}]  {parts}")
    error = sheet.conversion_error
    if sheet.detector == "photon":
        out.append(
            f"  conversion error  {100 * error.at_280_k:+.2f} % at 280 K, {100 * error.at_320_k:+.2f} % at 320 K, "
            f"{100 * error.sunlight:+.3g} % for sunlight"
        )
    return out
