"""How ``seaglint --help`` is ordered."""

from __future__ import annotations

from typing import Any, Final

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
