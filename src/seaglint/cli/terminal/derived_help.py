"""Help texts that list the library's formats, which are looked up when the help page is printed and not before."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from typer.core import TyperCommand, TyperOption


def derived_help(**texts: Callable[[], str]) -> type[TyperCommand]:
    """Return a class of commands whose options may have ``{NAME}`` in their help, for which ``texts[NAME]()`` is printed.

    Command modules are imported to complete words, where no library may be loaded.
    """

    class DerivedHelp(TyperCommand):
        """Command that fills in its help texts."""

        def format_help(self, ctx: Any, formatter: Any) -> None:
            """Write the help page."""
            for option in self.params:
                if isinstance(option, TyperOption) and option.help and "{" in option.help:
                    option.help = option.help.format_map({name: text() for name, text in texts.items()})
            super().format_help(ctx, formatter)

    return DerivedHelp


def listed(words: tuple[str, ...], last: str = "or") -> str:
    """Return words as a list of prose.

    >>> listed((".mp4", ".gif")), listed(("a", "b", "c"), "and"), listed(("a",))
    ('.mp4 or .gif', 'a, b and c', 'a')
    """
    return f"{', '.join(words[:-1])} {last} {words[-1]}" if len(words) > 1 else "".join(words)
