"""Commands ``seaglint atmosphere ...``: soundings, files of a scenario's air, MODTRAN's files, transmittance and sky."""

from __future__ import annotations

import json
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from seaglint.base.errors import DataError
from seaglint.cli.terminal.messages import contrasts_of, files_read, log, naming_file, show_logs
from seaglint.cli.terminal.options import AsJson, Overwrite, ScenarioArgument, two_numbers

if TYPE_CHECKING:
    import xarray as xr

    from seaglint.air.profile.band_laws import Spectroscopy

atmosphere = typer.Typer(help="The air: soundings, files of it, and MODTRAN's files.", no_args_is_help=True)


AirFile = Annotated[Path, typer.Option("-o", "--output", help="file to write: .nc NetCDF, .csv text")]
NumbersFile = Annotated[Path | None, typer.Option("-o", "--output", help="file for the numbers: .nc NetCDF with spectra, or .csv")]

SEA_KELVIN = 288.15  #: Temperature of the sea in a scenario without one [K].


#: Reader of the shortest and the longest wavelength of a band [um].
_band = two_numbers("-", "the shortest and the longest wavelength in micrometres, as 3.7-4.2")


class DeckFormat(StrEnum):
    """Formats of MODTRAN decks."""

    TAPE5 = "tape5"
    TAPE5_LOWTRAN7 = "tape5-lowtran7"
    MODTRAN6_JSON = "modtran6-json"


@atmosphere.callback()
def _atmosphere() -> None:
    pass


@atmosphere.command()
def export(scenario: ScenarioArgument, output: AirFile, overwrite: Overwrite = False) -> None:
    """Write the air of a scenario's sensor height and band.

    Transmittance, radiance and sunlight: a start for your own atmosphere file.
    """
    from seaglint.formats.air_file import require_kind, write_atmosphere
    from seaglint.scenario.load import load_scenario
    from seaglint.store.outputs import refuse_existing

    require_kind(output)
    loaded = load_scenario(scenario)
    refuse_existing(output, overwrite=overwrite, inputs=files_read(scenario, loaded))
    from seaglint.studies.air_files import export_air

    with naming_file(scenario, loaded):
        air = export_air(loaded)
    write_atmosphere(air, output, overwrite=overwrite)
    log(f'{output} written; in a scenario: [atmosphere] source = "file", path = "{output.name}"')


@atmosphere.command()
def write(
    scenario: ScenarioArgument,
    output: Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="folder for the deck and its manifest; it is made")],
    form: Annotated[
        DeckFormat, typer.Option("--format", help="tape5: MODTRAN 4 and 5; tape5-lowtran7: LOWTRAN7; modtran6-json: MODTRAN 6")
    ] = DeckFormat.TAPE5,
    scattered: Annotated[bool, typer.Option(help="request sunlight scattered by the air, where the Sun is up")] = True,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="replace existing files in the folder")] = False,
) -> None:
    """Write a MODTRAN deck of a scenario's lines of sight.

    Run it, then read its output with 'seaglint atmosphere read DIR'.
    """
    from seaglint.scenario.load import load_scenario

    loaded = load_scenario(scenario)
    from seaglint.studies.air_files import write_decks

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
    output: AirFile,
    overwrite: Overwrite = False,
) -> None:
    """Make a file of air from what MODTRAN or LOWTRAN7 computed.

    For atmosphere.source = "file" of a scenario; path, sky, Sun and scattered sunlight apart.
    """
    from seaglint.formats.air_file import require_kind, write_atmosphere
    from seaglint.store.outputs import refuse_existing

    require_kind(output)
    refuse_existing(output, overwrite=overwrite, inputs=[path for path in files if path.is_file()])
    from seaglint.formats.modtran.modtran_air import read_air

    air = read_air(files)
    write_atmosphere(air, output, overwrite=overwrite)
    sizes = ", ".join(f"{air.sizes[name]} {what}" for name, what in _DIMENSION_NAMES.items() if name in air.sizes)
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
    as_json: AsJson = False,
    overwrite: Overwrite = False,
) -> None:
    """Levels, water vapour and refraction of a sounding.

    Levels, water vapour, hydrostatic misfit, the lowest air, refraction and ducts; the same of a model atmosphere.
    """
    from seaglint.formats.soundings.air_summary import moment_of, place_of_air, summarise_air
    from seaglint.store.outputs import refuse_existing

    if plot is not None:
        if plot.suffix.lower() not in (".png", ".pdf", ".svg"):
            raise DataError(f"{plot}: a picture is .png, .pdf or .svg; give a name that ends so")
        refuse_existing(plot, overwrite=overwrite, inputs=[Path(source)])
    summary = summarise_air(source, sea_temperature, model, place_of_air(place), moment_of(time))
    if place is not None and summary.kind not in _WITH_PLACES:
        log(f"--place {place} is not used: a file of this kind ({summary.kind}) holds one place")
    typer.echo(json.dumps(summary.as_dict(), indent=2) if as_json else "\n".join(summary.lines))
    if plot is not None:
        from seaglint.plot.environment_charts import write_air_plot

        write_air_plot(summary, plot)
        log(f"{plot} written")


SceneArgument = Annotated[
    Path | None, typer.Argument(metavar="[SCENARIO.toml]", help="scenario whose air, band and sensor height are taken")
]


@atmosphere.command("path")
def path_command(
    scenario: SceneArgument = None,
    range_m: Annotated[
        str | None, typer.Option("--range-m", metavar="A,B,...", help="arcs along the sea from the sensor's foot [m]; or FIRST:LAST:STEP")
    ] = None,
    target_height_m: Annotated[
        str, typer.Option("--target-height-m", metavar="A,B,...", help="heights of the points above the mean sea; 0 is the sea")
    ] = "0",
    temperature_k: Annotated[float | None, typer.Option("--temperature-k", help="even air: temperature in kelvin")] = None,
    pressure_hpa: Annotated[float | None, typer.Option("--pressure-hpa", help="even air: pressure in hectopascals")] = None,
    vapour_pressure_hpa: Annotated[
        float | None, typer.Option("--vapour-pressure-hpa", help="even air: pressure of its water vapour in hectopascals")
    ] = None,
    length_km: Annotated[float | None, typer.Option("--length-km", help="even air: length of the path in kilometres")] = None,
    band_um: Annotated[
        str | None, typer.Option("--band-um", metavar="MIN-MAX", help="even air: band in micrometres, such as 3.7-4.2")
    ] = None,
    co2_ppmv: Annotated[float, typer.Option("--co2-ppmv", help="even air: carbon dioxide, parts per million of dry air")] = 0.0,
    o3_ppmv: Annotated[float, typer.Option("--o3-ppmv", help="even air: ozone, parts per million of dry air")] = 0.0,
    n2o_ppmv: Annotated[float, typer.Option("--n2o-ppmv", help="even air: nitrous oxide, parts per million of dry air")] = 0.0,
    co_ppmv: Annotated[float, typer.Option("--co-ppmv", help="even air: carbon monoxide, parts per million of dry air")] = 0.0,
    ch4_ppmv: Annotated[float, typer.Option("--ch4-ppmv", help="even air: methane, parts per million of dry air")] = 0.0,
    spectroscopy: Annotated[str, typer.Option("--spectroscopy", help="even air: absorption, lblrtm or lowtran7")] = "lblrtm",
    haze: Annotated[str, typer.Option("--haze", help="even air: aerosol, as atmosphere.haze of a scenario")] = "none",
    output: NumbersFile = None,
    overwrite: Overwrite = False,
) -> None:
    """Transmittance of paths through the air.

    Through the air of a scenario, from its sensor to points at --range-m: the mean over the band, weighted with the blackbody of the water,
    and the thermal radiance of the path. Without a scenario through even air of one temperature, weighted with the blackbody at that
    temperature; besides the gases given the air is nitrogen, oxygen and water, and nitrogen absorbs in 3.7-4.2 um only, where RRTMGP's
    tables have it.
    """
    from seaglint.studies.air_paths import even_path, require_one_kind

    show_logs()
    numbers = {
        "temperature_k": temperature_k,
        "pressure_hpa": pressure_hpa,
        "vapour_pressure_hpa": vapour_pressure_hpa,
        "length_km": length_km,
    }
    require_one_kind(scenario is not None, range_m is not None, {**numbers, "band_um": band_um})
    if scenario is not None and range_m is not None:
        from seaglint.scenario.load import load_scenario
        from seaglint.studies.air_paths import path_air

        loaded = load_scenario(scenario)
        _refuse_table(output, overwrite, files_read(scenario, loaded))
        with naming_file(scenario, loaded):
            result = path_air(loaded, contrasts_of(range_m, "--range-m"), contrasts_of(target_height_m, "--target-height-m"))
        typer.echo(f"{'range [m]':>12} {'height [m]':>12} {'transmittance':>14} {'path radiance [W m-2 sr-1]':>27}")
        for (height, arc), value in _flat(result.transmittance):
            glow = float(result.path_radiance.sel(target_height_m=height, range_m=arc))
            # A ray whose lowest point lies below the sea does not reach the target.
            hidden = "  behind the horizon" if float(result.lowest_height.sel(target_height_m=height, range_m=arc)) < 0.0 else ""
            typer.echo(f"{arc:>12g} {height:>12g} {value:>14.4f} {glow:>27.5g}{hidden}")
    else:
        _refuse_table(output, overwrite, [])
        gases = {"CO2": co2_ppmv, "O3": o3_ppmv, "N2O": n2o_ppmv, "CO": co_ppmv, "CH4": ch4_ppmv}
        low, high = _band(str(band_um), "--band-um")
        result = even_path(numbers, (low, high), gases, cast("Spectroscopy", spectroscopy), haze)
        typer.echo(f"transmittance {float(result.transmittance):.4f} of {low:g}-{high:g} um, {length_km:g} km")
    _write_table(result, output, overwrite)


@atmosphere.command("sky")
def sky_command(
    scenario: Annotated[Path, typer.Argument(metavar="SCENARIO.toml", help="scenario whose air, band, Sun and sensor height are taken")],
    zenith_deg: Annotated[
        str, typer.Option("--zenith-deg", metavar="A,B,...", help="zenith angles looked at from the sensor, in degrees; or FIRST:LAST:STEP")
    ],
    azimuth_deg: Annotated[
        str | None, typer.Option("--azimuth-deg", metavar="A,B,...", help="azimuths, clockwise from north; default: the sensor's")
    ] = None,
    output: NumbersFile = None,
    overwrite: Overwrite = False,
) -> None:
    """Radiance and apparent temperature of the clear sky.

    As the sensor of a scenario sees it: emission of the air and sunlight that it scatters.
    """
    from seaglint.scenario.load import load_scenario
    from seaglint.studies.air_paths import sky_air

    show_logs()
    loaded = load_scenario(scenario)
    _refuse_table(output, overwrite, files_read(scenario, loaded))
    azimuths = None if azimuth_deg is None else contrasts_of(azimuth_deg, "--azimuth-deg")
    with naming_file(scenario, loaded):
        result = sky_air(loaded, contrasts_of(zenith_deg, "--zenith-deg"), azimuths)
    typer.echo(f"{'zenith [deg]':>12} {'azimuth [deg]':>14} {'radiance [W m-2 sr-1]':>22} {'scattered':>11} {'apparent [K]':>13}")
    for (zenith, azimuth), value in _flat(result.radiance):
        direction = {"zenith_deg": zenith, "azimuth_deg": azimuth}
        kelvin, light = (float(result[name].sel(direction)) for name in ("apparent_temperature", "scattered_radiance"))
        typer.echo(f"{zenith:>12g} {azimuth:>14g} {value:>22.5g} {light:>11.4g} {kelvin:>13.2f}")
    _write_table(result, output, overwrite)


def _flat(values: xr.DataArray) -> list[tuple[tuple[float, ...], float]]:
    """Return pairs of coordinates and value for all elements of an array."""
    from itertools import product

    axes = [values[name].to_numpy().tolist() for name in values.dims]
    return list(zip(product(*axes), values.to_numpy().ravel().tolist(), strict=True))


def _refuse_table(output: Path | None, overwrite: bool, inputs: list[Path]) -> None:
    from seaglint.store.outputs import refuse_existing, require_ending

    if output is not None:
        refuse_existing(
            require_ending(output, (".nc", ".nc4", ".csv"), "numbers are written as .nc or .csv"), overwrite=overwrite, inputs=inputs
        )


def _write_table(result: xr.Dataset, output: Path | None, overwrite: bool) -> None:
    """Write a dataset as NetCDF, or its numbers as columns of a CSV file; a CSV file has spectra only where there is nothing else."""
    if output is None:
        return
    if output.suffix.lower() == ".csv":
        from seaglint.formats.tables.table_text import write_columns

        if set(result.dims) == {"wavenumber_cm"}:
            numbers = result[["spectral_transmittance"]].rename(spectral_transmittance="transmittance")
        else:
            numbers = result.drop_dims("wavenumber_cm")
        frame = numbers.to_dataframe().reset_index()
        write_columns({str(name): column.to_numpy() for name, column in frame.items()}, output, overwrite=overwrite)
    else:
        from seaglint.store.netcdf import write_netcdf

        write_netcdf(result, output, overwrite=overwrite)
    log(f"{output} written")


_WITH_PLACES = ("ERA5 pressure levels", "bufkit's list")  #: Kinds of files that may hold several places.


#: Dimensions of a file of air, with their names in messages.
_DIMENSION_NAMES = {
    "range_m": "paths",
    "sky_zenith_deg": "angles of sky from the sea",
    "sensor_sky_zenith_deg": "from the sensor",
    "sun_zenith_deg": "of the Sun",
    "azimuth_from_sun_deg": "azimuths",
}
