"""``seaglint atmosphere``: what is understood of a sounding, the air of a scenario as a file, MODTRAN's files written and read."""

from __future__ import annotations

from datetime import UTC, datetime
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from seaglint.cli.terminal.messages import files_read, log, naming_file

if TYPE_CHECKING:
    from seaglint.air.profile.band_numbers import Spectroscopy

atmosphere = typer.Typer(help="The air: soundings, files of it, and MODTRAN's files.", no_args_is_help=True)


SEA_KELVIN = 288.15
"""Temperature of the sea in a scenario that says none [K]."""


class DeckFormat(StrEnum):
    """Kinds of decks."""

    TAPE5 = "tape5"
    TAPE5_LOWTRAN7 = "tape5-lowtran7"
    MODTRAN6_JSON = "modtran6-json"


@atmosphere.callback()
def _atmosphere() -> None:
    pass


@atmosphere.command()
def export(
    scenario: Annotated[Path, typer.Argument(metavar="SCENARIO.toml", help="scenario file")],
    output: Annotated[Path, typer.Option("-o", "--output", help="file to write: .nc NetCDF, .csv text")],
    overwrite: Annotated[bool, typer.Option("--overwrite", help="replace what stands at the output")] = False,
) -> None:
    """Write the air of a scenario's sensor height and band.

    Transmittance, radiance and sunlight: a start for an atmosphere file of your own.
    """
    from seaglint.files.air.air_file import require_kind, write_atmosphere
    from seaglint.files.outputs import refuse_existing
    from seaglint.scenario.load import load_scenario

    require_kind(output)
    loaded = load_scenario(scenario)
    refuse_existing(output, overwrite=overwrite, inputs=files_read(scenario, loaded))
    from seaglint.studies.prepare.air_export import export_air

    with naming_file(scenario, loaded):
        air = export_air(loaded)
    write_atmosphere(air, output, overwrite=overwrite)
    log(f'{output} written; in a scenario: [atmosphere] source = "file", path = "{output.name}"')


@atmosphere.command()
def write(
    scenario: Annotated[Path, typer.Argument(metavar="SCENARIO.toml", help="scenario file")],
    output: Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="folder for the deck and its manifest; it is made")],
    form: Annotated[
        DeckFormat, typer.Option("--format", help="tape5: MODTRAN 4 and 5; tape5-lowtran7: LOWTRAN7; modtran6-json: MODTRAN 6")
    ] = DeckFormat.TAPE5,
    scattered: Annotated[bool, typer.Option(help="ask for sunlight scattered by the air, where the Sun is up")] = True,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="replace files that stand in the folder")] = False,
) -> None:
    """Write a MODTRAN deck of a scenario's lines of sight.

    Run it, then read its output with 'seaglint atmosphere read DIR'.
    """
    from seaglint.scenario.load import load_scenario

    loaded = load_scenario(scenario)
    from seaglint.studies.prepare.modtran_decks import write_decks

    with naming_file(scenario, loaded):
        decks = write_decks(loaded, output, form.value, scattered=scattered, overwrite=overwrite)
    what = (
        "no scattered sunlight" if decks.solar_zenith_deg is None else f"sunlight scattered under a Sun at {decks.solar_zenith_deg:g} deg"
    )
    log(f"{decks.deck} written, {decks.cases} cases, {what}; run it in {output}, then: seaglint atmosphere read {output} -o air.nc")


@atmosphere.command()
def read(
    files: Annotated[
        list[Path],
        typer.Argument(
            metavar="FILE...", help="tape7, .tp7, .7sc, CSV or JSON of LOWTRAN7 or MODTRAN 4-6, or the folder of atmosphere write"
        ),
    ],
    output: Annotated[Path, typer.Option("-o", "--output", help="file to write: .nc NetCDF, .csv text")],
    overwrite: Annotated[bool, typer.Option("--overwrite", help="replace what stands at the output")] = False,
) -> None:
    """Make a file of air from what MODTRAN or LOWTRAN7 computed.

    For atmosphere.source = "file" of a scenario; path, sky, Sun and scattered sunlight apart.
    """
    from seaglint.files.air.air_file import require_kind, write_atmosphere
    from seaglint.files.outputs import refuse_existing

    require_kind(output)
    refuse_existing(output, overwrite=overwrite, inputs=[path for path in files if path.is_file()])
    from seaglint.files.modtran.reading import read_air

    air = read_air(files)
    write_atmosphere(air, output, overwrite=overwrite)
    sizes = ", ".join(f"{air.sizes[name]} {what}" for name, what in _HELD.items() if name in air.sizes)
    sun = f"; scattered sunlight of a Sun at {air.attrs['solar_zenith_deg']:g} deg" if "solar_zenith_deg" in air.attrs else ""
    if "cases_without_azimuth" in air.attrs:
        log(
            f"scattered sunlight of {air.attrs['cases_without_azimuth']} cases is left out: their azimuth from the Sun is not known; "
            "run them with IPARM = 2"
        )
    log(
        f"{output} written: sensor.height_m = {air.attrs['sensor_height_m']:g}, {sizes}{sun}; "
        f'in a scenario: [atmosphere] source = "file", path = "{output.name}"'
    )


@atmosphere.command()
def info(
    source: Annotated[
        str, typer.Argument(metavar="SOUNDING|MODEL", help="file of a sounding, or a model atmosphere such as midlatitude-summer")
    ],
    sea_temperature: Annotated[
        float, typer.Option("--sea-temperature", metavar="K", help="temperature of the sea to compare with")
    ] = SEA_KELVIN,
    model: Annotated[str, typer.Option("--model", help="model atmosphere that continues a sounding")] = "midlatitude-summer",
    place: Annotated[
        str | None, typer.Option("--place", metavar="LAT,LON", help="place in a file that holds several, in degrees north and east")
    ] = None,
    time: Annotated[
        str | None, typer.Option("--time", metavar="ISO", help="time in a file that holds several, such as 2024-07-01T06:00Z; UTC")
    ] = None,
    plot: Annotated[Path | None, typer.Option("--plot", metavar="F.png", help="draw temperature, humidity and refractivity")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="print JSON")] = False,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="replace what stands at the output")] = False,
) -> None:
    """Print what is understood of a sounding.

    Levels, water vapour, hydrostatic misfit, the lowest air, refraction and ducts; the same of a model atmosphere.
    """
    import json

    from seaglint.base.errors import DataError
    from seaglint.files.outputs import refuse_existing
    from seaglint.files.soundings.air_summary import summarise_air

    if not 200.0 <= sea_temperature <= 350.0:
        raise DataError(f"--sea-temperature {sea_temperature:g}: give a temperature of 200 to 350 K")
    if plot is not None:
        if plot.suffix.lower() not in (".png", ".pdf", ".svg"):
            raise DataError(f"{plot}: a picture is .png, .pdf or .svg; give a name that ends so")
        refuse_existing(plot, overwrite=overwrite, inputs=[Path(source)])
    summary = summarise_air(source, sea_temperature, model, _place(place), _time(time))
    if place is not None and summary.kind not in _WITH_PLACES:
        log(f"--place {place} is not used: a file of this kind ({summary.kind}) holds one place")
    typer.echo(json.dumps(summary.as_dict(), indent=2) if as_json else "\n".join(summary.lines))
    if plot is not None:
        from seaglint.plot.air_figure import write_air_plot

        write_air_plot(summary, plot)
        log(f"{plot} written")


@atmosphere.command("path")
def path_command(
    temperature_k: Annotated[float, typer.Option("--temperature-k", help="temperature of the air in kelvin")],
    pressure_hpa: Annotated[float, typer.Option("--pressure-hpa", help="pressure of the air in hectopascals")],
    vapour_pressure_hpa: Annotated[float, typer.Option("--vapour-pressure-hpa", help="pressure of its water vapour in hectopascals")],
    length_km: Annotated[float, typer.Option("--length-km", help="length of the path in kilometres")],
    band_um: Annotated[str, typer.Option("--band-um", metavar="MIN-MAX", help="band in micrometres, such as 3.7-4.2")],
    co2_ppmv: Annotated[float, typer.Option("--co2-ppmv", help="carbon dioxide, parts per million of dry air")] = 0.0,
    o3_ppmv: Annotated[float, typer.Option("--o3-ppmv", help="ozone, parts per million of dry air")] = 0.0,
    n2o_ppmv: Annotated[float, typer.Option("--n2o-ppmv", help="nitrous oxide, parts per million of dry air")] = 0.0,
    co_ppmv: Annotated[float, typer.Option("--co-ppmv", help="carbon monoxide, parts per million of dry air")] = 0.0,
    ch4_ppmv: Annotated[float, typer.Option("--ch4-ppmv", help="methane, parts per million of dry air")] = 0.0,
    spectroscopy: Annotated[str, typer.Option("--spectroscopy", help="absorption: lblrtm or lowtran7")] = "lblrtm",
    haze: Annotated[str, typer.Option("--haze", help="aerosol, as atmosphere.haze of a scenario")] = "none",
    output: Annotated[Path | None, typer.Option("-o", "--output", metavar="F.csv", help="file for the spectrum")] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="replace what stands at the output")] = False,
) -> None:
    """Print the transmittance of a path through even air.

    The mean over the band, weighted with the blackbody at that temperature. Besides the gases given the air is nitrogen, oxygen and
    water; nitrogen absorbs in 3.7-4.2 um only, where RRTMGP's tables have it.
    """
    from seaglint.air.profile.hazes import HazeWeather
    from seaglint.air.profile.homogeneous_path import homogeneous_spectrum
    from seaglint.base.errors import DataError
    from seaglint.cli.terminal.logs import show_logs
    from seaglint.files.outputs import refuse_existing, require_ending

    show_logs()
    if output is not None:
        refuse_existing(require_ending(output, (".csv",), "a table is .csv"), overwrite=overwrite, inputs=[])
    try:
        low, high = (float(part) for part in band_um.split("-"))
    except ValueError:
        raise DataError(f"--band-um {band_um}: give the shortest and the longest wavelength in micrometres, as 3.7-4.2") from None
    found = homogeneous_spectrum(
        temperature_k=temperature_k,
        pressure_hpa=pressure_hpa,
        vapour_pressure_hpa=vapour_pressure_hpa,
        length_km=length_km,
        band_um=(low, high),
        ppmv={"CO2": co2_ppmv, "O3": o3_ppmv, "N2O": n2o_ppmv, "CO": co_ppmv, "CH4": ch4_ppmv},
        spectroscopy=cast("Spectroscopy", spectroscopy),
        haze=HazeWeather(haze),
    )
    typer.echo(f"transmittance {found.mean:.4f} of {low:g}-{high:g} um, {length_km:g} km")
    if output is not None:
        from seaglint.files.tables.columns import write_columns

        write_columns({"wavenumber_cm": found.wavenumber_cm, "transmittance": found.transmittance}, output, overwrite=overwrite)
        log(f"{output} written")


_WITH_PLACES = ("ERA5 pressure levels", "bufkit's list")
"""Kinds of files that may hold several places."""


def _place(text: str | None) -> tuple[float, float] | None:
    """Latitude and longitude of an option."""
    from seaglint.base.errors import DataError

    if text is None:
        return None
    try:
        latitude, longitude = (float(part) for part in text.split(","))
    except ValueError:
        latitude = longitude = float("nan")
    if not (abs(latitude) <= 90.0 and abs(longitude) <= 360.0):
        raise DataError(f"--place {text}: give latitude and longitude in degrees, -90 to 90 and -360 to 360, as 54.2,7.9")
    return latitude, longitude


def _time(text: str | None) -> datetime | None:
    """Time of an option, UTC where it says no zone."""
    from seaglint.base.errors import DataError

    if text is None:
        return None
    try:
        when = datetime.fromisoformat(text)
    except ValueError:
        raise DataError(f"--time {text}: give a time as 2024-07-01T06:00Z") from None
    return when.replace(tzinfo=UTC) if when.tzinfo is None else when.astimezone(UTC)


_HELD = {
    "range_m": "paths",
    "sky_zenith_deg": "angles of sky from the sea",
    "sensor_sky_zenith_deg": "from the sensor",
    "sun_zenith_deg": "of the Sun",
    "azimuth_from_sun_deg": "azimuths",
}
