"""The command ``seaglint compare``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from seaglint.base.errors import DataError
from seaglint.cli.terminal.messages import files_read, log, naming_file, print_lines, show_logs
from seaglint.cli.terminal.options import Overwrite


def compare(
    spectrum: Annotated[
        Path, typer.Argument(metavar="SPECTRUM.csv", help="CSV with wavenumber_cm or wavelength_um, and a radiance with its unit")
    ],
    scenario: Annotated[Path, typer.Argument(metavar="SCENARIO.toml", help="scenario of the place: sea, air, Sun, height of the sensor")],
    output: Annotated[Path | None, typer.Option("-o", "--output", metavar="F.png", help="picture to write: .png, .pdf or .svg")] = None,
    csv: Annotated[Path | None, typer.Option("--csv", metavar="F.csv", help="file for both spectra as compared")] = None,
    zenith_deg: Annotated[float | None, typer.Option("--zenith-deg", help="zenith angle of the sky looked at; the camera's axis")] = None,
    depression_deg: Annotated[
        float | None, typer.Option("--depression-deg", help="angle below the horizontal at which the sea is looked at; 90 is the nadir")
    ] = None,
    resolution_cm: Annotated[
        float | None, typer.Option("--resolution-cm", help="full width at half maximum of the spectrum in cm-1; default: the file's")
    ] = None,
    spectroscopy: Annotated[
        str | None, typer.Option("--spectroscopy", help="absorption of the air, lblrtm or lowtran7; default: the scenario's")
    ] = None,
    overwrite: Overwrite = False,
) -> None:
    """Compare a measured spectrum with a scenario's spectrum.

    Prints temperatures and differences by band.

    Columns of radiance are radiance_w_m2_sr_cm, radiance_mw_m2_sr_cm, radiance_w_cm2_sr_cm, likewise with _um per wavelength, and
    brightness_temperature_k. A column or comment resolution_cm states the resolution. A measured spectrum finer than 20 cm-1 is averaged
    to 20 cm-1; for a coarser one the computed spectrum is averaged.
    """
    from seaglint.scenario.load import load_scenario
    from seaglint.store.outputs import refuse_existing, require_ending

    show_logs()
    loaded = load_scenario(scenario)
    inputs = [spectrum, *files_read(scenario, loaded)]
    for path, endings, what in ((output, (".png", ".pdf", ".svg"), "a picture is .png, .pdf or .svg"), (csv, (".csv",), "a table is .csv")):
        if path is not None:
            if not path.suffix:
                raise DataError(f"{path}: {what}; give a name that ends so")
            refuse_existing(require_ending(path, endings, what), overwrite=overwrite, inputs=inputs)
    from seaglint.studies.measured.compare_spectrum import compare_spectrum, stated_spectrum

    light = stated_spectrum(spectrum)
    with naming_file(scenario, loaded):
        result = compare_spectrum(
            light, loaded, resolution_cm=resolution_cm, zenith_deg=zenith_deg, depression_deg=depression_deg, spectroscopy=spectroscopy
        )
    for note in result.notes:
        log(note)
    print_lines(result.lines())
    if csv is not None:
        from seaglint.formats.tables.table_text import write_columns

        write_columns(result.columns(), csv, overwrite=overwrite)
        log(f"{csv} written")
    if output is not None:
        from seaglint.plot.sensor_and_spectra import write_beside

        write_beside([result.beside()], output)
        log(f"{output} written")
