"""Commands of the program: their groups in ``seaglint --help``, and the modules that are imported when a command is asked for.

Imports are deferred twice. The list of commands bears their summaries, so that a command's file is imported when the command is asked for.
That file in turn imports at its head what options and help pages are made of, and studies, files and plots inside the functions that run:
the libraries behind these (Numba, SciPy, xarray, zarr) take more than a second to import, for which ``--help``, completion and a mistyped
option would wait. ``seaglint.api`` does the same for ``import seaglint``. In the rooms below, imports stand at the head of a file, but for
what is optional or slow and not needed by every call.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import Any, Final

import typer
from typer.core import TyperCommand
from typer.main import get_command

from seaglint.cli.terminal.examples import add_examples


@dataclass(frozen=True)
class CommandEntry:
    """Where a command is defined, the first line of its help, which the list of commands shows without importing it, and its class."""

    place: str
    summary: str
    made_by: str | None = None


#: Commands by what a person wants.
GROUPS: Final[dict[str, dict[str, CommandEntry]]] = {
    "Begin": {
        "init": CommandEntry("scenario_file.init", "Write a commented scenario file."),
        "schema": CommandEntry("scenario_file.schema", "JSON Schema of scenario files."),
        "doctor": CommandEntry("facts.doctor", "Check the installation, or compile kernels ahead."),
    },
    "Look": {
        "view": CommandEntry("view.view", "Look at sequences, maps and scenarios in a browser."),
        "info": CommandEntry("facts.info", "Say what a file holds and how it was made."),
        "reproduce": CommandEntry("reproduce.reproduce", "Results of the source article, and measured spectra."),
    },
    "Compute": {
        "mean": CommandEntry("mean.mean", "Map mean radiance and apparent temperature over the view."),
        "render": CommandEntry("render.render", "Render the sequence: radiance, or counts of a detector."),
        "sense": CommandEntry("sensor.sense", "Put a sensor on recorded radiance: counts of its detector."),
        "sensor": CommandEntry("sensor.sensor", "Figures of merit of a sensor: NETD, MTF, noise budget."),
        "evaluate": CommandEntry("evaluate.evaluate", "Results for many cases: each row of a CSV file gets columns."),
        "sweep": CommandEntry("sweep_keys.sweep", "Compute one quantity over every combination of values of keys."),
        "atmosphere": CommandEntry("atmosphere.atmosphere", "The air: soundings, files of it, and MODTRAN's files."),
        "weather": CommandEntry("weather.weather", "Tables of weather: how often which conditions come."),
        "texture": CommandEntry("texture.texture", "Statistical textures: fit, sample, compare, lay on the sea."),
        "ensemble": CommandEntry("ensemble.ensemble", "Draw scenes from laws of a scenario's keys and render each."),
    },
    "Analyse": {
        "analyze": CommandEntry("analyze.analyze", "Clutter statistics and false alarms of a recording, by region."),
        "detect": CommandEntry("detect.detect", "Probabilities of detection and false alarm of a detector."),
        "compare": CommandEntry("compare.compare", "Compare a measured spectrum with that of a scenario."),
        "likelihood": CommandEntry("likelihood.likelihood", "How often glint is brighter than thresholds."),
    },
    "Share": {
        "export": CommandEntry("export.export", "Write frames of a run for another program.", "Command"),
        "export-sea": CommandEntry("export.export_sea", "Write heights, slopes and roughness of the sea at one time."),
        "labels": CommandEntry("labels.labels", "Write places, masks and contrasts of objects, by frame."),
        "dataset": CommandEntry("dataset.dataset", "Render labelled pictures of an ensemble: masks, boxes, tables.", "Command"),
    },
}

_ENTRIES: Final = {name: entry for members in GROUPS.values() for name, entry in members.items()}


def _made(name: str, entry: CommandEntry) -> Any:
    """Import a command, or a group of them."""
    module, _, attribute = entry.place.partition(".")
    defined = import_module(f"seaglint.cli.{module}")
    what = getattr(defined, attribute)
    program = typer.Typer(rich_markup_mode=None, callback=lambda: None)
    if isinstance(what, typer.Typer):
        program.add_typer(what, name=name)
    else:
        program.command(name, cls=getattr(defined, entry.made_by) if entry.made_by else None)(what)
    add_examples(program)
    commands: dict[str, Any] = get_command(program).commands  # type: ignore[attr-defined]
    return commands[name]


class Commands(Mapping[str, Any]):
    """Commands of the program by name, each imported when it is asked for.

    Examples
    --------
    >>> "render" in Commands(), Commands().get("rendre")
    (True, None)
    """

    def __init__(self) -> None:
        self._made: dict[str, Any] = {}

    def __getitem__(self, name: str) -> Any:
        if name not in self._made:
            self._made[name] = _made(name, _ENTRIES[name])
        return self._made[name]

    def __contains__(self, name: object) -> bool:
        return name in _ENTRIES

    def __iter__(self) -> Iterator[str]:
        return iter(_ENTRIES)

    def __len__(self) -> int:
        return len(_ENTRIES)


def write_groups(formatter: Any) -> None:
    """Write the commands under their headings."""
    limit = formatter.width - 6 - max(map(len, _ENTRIES))
    for heading, members in GROUPS.items():
        with formatter.section(heading):
            formatter.write_dl(
                [(name, TyperCommand(name, help=entry.summary).get_short_help_str(limit)) for name, entry in members.items()]
            )
