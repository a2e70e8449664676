"""Completion of commands and options in the user's shell.

Typer's own options take no shell: they look for the one that started them, and find another from within make, tmux or a script.
"""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated, Any, Final

import typer
from typer._completion_classes import completion_init
from typer.completion import install_callback, show_callback


class Shell(StrEnum):
    """Shells that complete."""

    BASH = "bash"
    ZSH = "zsh"
    FISH = "fish"
    POWERSHELL = "powershell"


SHELLS: Final = ", ".join(Shell)


def _install(ctx: typer.Context, param: typer.CallbackParam, shell: Shell | None) -> Any:
    return install_callback(ctx, param, shell)


def _show(ctx: typer.Context, param: typer.CallbackParam, shell: Shell | None) -> Any:
    return show_callback(ctx, param, shell)


InstallCompletion = Annotated[
    Shell | None,
    typer.Option(
        "--install-completion", metavar="SHELL", callback=_install, is_eager=True, help=f"let a shell complete commands: {SHELLS}"
    ),
]
ShowCompletion = Annotated[
    Shell | None,
    typer.Option("--show-completion", metavar="SHELL", callback=_show, is_eager=True, help="print what that would add, and leave"),
]

# Answers what the shells ask on a press of the tab key, in Typer's form.
completion_init()
