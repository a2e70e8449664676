"""How ``seaglint --help`` is ordered, and the example at the end of each command's help."""

from __future__ import annotations

from typing import Any, Final

import typer

GROUPS: Final[dict[str, tuple[str, ...]]] = {
    "Begin": ("init", "schema", "doctor"),
    "Look": ("view", "info", "reproduce"),
    "Compute": ("mean", "render", "sense", "sensor", "evaluate", "atmosphere", "weather", "texture", "ensemble"),
    "Analyse": ("analyze", "detect", "likelihood"),
    "Share": ("export", "export-sea", "labels", "dataset"),
}
"""Commands by what a person wants; those that are not installed are passed over."""

OTHER: Final = "Other"
"""Heading of commands that no group names."""

_SCENE = "seaglint init my.toml"
_RUN = (_SCENE, "seaglint render my.toml -o run.zarr --frames 0:8")
_FIT = (*_RUN, "seaglint texture fit run.zarr -o model.json")
_CASES = "printf 'wavelength_um,wind_speed_m_s,zenith_deg\\n4,5,70\\n' > cases.csv"

EXAMPLES: Final[dict[str, tuple[str, ...]]] = {
    "init": ("seaglint init my.toml --preset glint",),
    "schema": ("seaglint schema > scenario.schema.json",),
    "doctor": ("seaglint doctor --json",),
    "info": (*_RUN, "seaglint info run.zarr"),
    "reproduce headline": ("seaglint reproduce headline",),
    "mean": (_SCENE, "seaglint mean my.toml -o mean.nc --preview"),
    "render": (_SCENE, "seaglint render my.toml -o run.zarr --frames 0:8 --preview"),
    "sense": (*_RUN, "seaglint sense run.zarr my.toml --sensor mwir-insb-640 -o counts.zarr"),
    "sensor": (_SCENE, "seaglint sensor my.toml --sensor mwir-insb-640"),
    "evaluate emissivity": (_CASES, "seaglint evaluate emissivity cases.csv -o out.csv"),
    "atmosphere export": (_SCENE, "seaglint atmosphere export my.toml -o air.nc"),
    "weather info": ("seaglint weather info north-atlantic",),
    "texture fit": _FIT,
    "texture sample": (*_FIT, "seaglint texture sample model.json -o loop.zarr --size 256x256 --frames 32"),
    "texture compare": (*_FIT, "seaglint texture compare run.zarr model.json"),
    "texture place": (*_FIT, "seaglint texture place model.json my.toml -o placed.zarr"),
    "analyze": (*_RUN, "seaglint analyze run.zarr --report clutter.html"),
    "detect": (*_RUN, "seaglint detect run.zarr --contrast 0.05:0.4:0.05 --detector matched -o found"),
    "export": (*_RUN, "seaglint export run.zarr -o run.tif"),
    "export-sea": (_SCENE, "seaglint export-sea my.toml -o sea.nc"),
}
"""Lines that work one after the other in an empty folder, by command."""


def write_groups(ctx: Any, group: Any, formatter: Any) -> None:
    """The commands under their headings."""
    names = [name for name in group.list_commands(ctx) if not group.get_command(ctx, name).hidden]
    named = {name for members in GROUPS.values() for name in members}
    headed = {**GROUPS, OTHER: tuple(name for name in names if name not in named)}
    limit = formatter.width - 6 - max(map(len, names), default=0)
    for heading, members in headed.items():
        rows = [(name, group.get_command(ctx, name).get_short_help_str(limit)) for name in members if name in names]
        if rows:
            with formatter.section(heading):
                formatter.write_dl(rows)


def add_examples(app: typer.Typer, before: str = "") -> None:
    """End the help of each command that has an example with it."""
    for info in app.registered_commands:
        callback = info.callback.__name__ if info.callback is not None else ""
        lines = EXAMPLES.get(before + (info.name or callback.replace("_", "-")))
        if lines is not None:
            # \b keeps the lines as they are
            info.epilog = "\b\n" + "\n".join(["Example:", *(f"  {line}" for line in lines)])
    for group in app.registered_groups:
        if group.typer_instance is not None:
            add_examples(group.typer_instance, f"{before}{group.name} ")
