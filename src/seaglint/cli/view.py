"""The command ``seaglint view``: sequences, maps, recordings and scenarios in a browser."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def view(
    inputs: Annotated[
        list[str] | None,
        typer.Argument(metavar="RUN.zarr|map.nc|SCENARIO.toml|RECORDING", help="files to look at; two sequences are shown side by side"),
    ] = None,
    port: Annotated[int | None, typer.Option("--port", min=1, max=65535, help="port to listen at; the first free one from 8420")] = None,
    host: Annotated[
        str, typer.Option("--host", help="address to listen at; beyond this machine a token becomes part of the address")
    ] = "127.0.0.1",
    browser: Annotated[bool, typer.Option("--browser/--no-browser", help="open the address in a browser")] = True,
    folder: Annotated[
        Path | None, typer.Option("--folder", help="folder from which other files may be chosen; default: the folder of INPUT")
    ] = None,
    variable: Annotated[str | None, typer.Option("--variable", help="which array of a file that holds several")] = None,
    channel: Annotated[str | None, typer.Option("--channel", help="a colour of true colour images, or the number of a channel")] = None,
    axes: Annotated[str | None, typer.Option("--axes", help="order of an array's axes, e.g. yxt where time is the last")] = None,
) -> None:
    """Look at sequences, maps and scenarios in a browser.

    Recordings of other programs too; on this machine alone. Play, scrub and zoom; values under the pointer; two sequences and their
    difference; histograms of regions, thresholds and false alarms. A scenario opens the workbench, which begins with a preset where
    nothing is given. The address is printed; Ctrl-C ends it.
    """
    from seaglint.base.errors import DataError
    from seaglint.viewer.server import require_installed

    require_installed()
    given = inputs or []
    scenarios = [name for name in given if name.lower().endswith(".toml")]
    others = [name for name in given if name not in scenarios]
    if len(scenarios) > 1:
        raise DataError(f"{len(scenarios)} scenarios are given; the workbench changes one: give one of them")
    from seaglint.viewer.library import Library
    from seaglint.viewer.server import serve, workbench

    if scenarios:
        from seaglint.viewer.workbench.scenario_draft import Draft

        Draft(scenarios[0])  # a file that is no scenario is refused here, not in the browser
    # With nothing to look at the workbench begins with a preset.
    pages = [workbench(scenarios[0] if scenarios else None)] if scenarios or (not given and folder is None) else []
    library = Library(others, folder if folder is not None or others else None, variable, channel, axes)
    serve(library, pages, host=host, port=port, browser=browser, announce=lambda where: typer.echo(f"{where}"))
