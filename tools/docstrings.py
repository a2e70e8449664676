"""Docstrings of the whole package, internals included, as numpydoc and docutils read them: ``./run check`` calls this program.

The reference renders public names only. Here every docstring is parsed: known sections in numpydoc's order, parameters that exist, all of
them where one is described, and markup without errors. The codes are those of numpydoc's validation; the others ask for sections that the
house omits. A function of physics with a page describes its result where it describes its parameters.
"""

from __future__ import annotations

import importlib
import inspect
import os
import pkgutil
import sys
import warnings
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

sys.path.append(str(Path(__file__).resolve().parents[1] / "docs" / "_ext"))

from docutils import nodes, utils
from docutils.frontend import get_default_settings
from docutils.parsers.rst import Directive, Parser, directives, roles
from numpydoc.docscrape_sphinx import SphinxClassDoc, SphinxFunctionDoc
from numpydoc.validate import validate

import reference
import seaglint

CODES = {
    *(f"GL{number:02}" for number in (1, 2, 3, 5, 6, 7, 9, 10)),  # blank lines, tabs, sections and their order
    *("PR02", "PR05", "PR06", "PR10", "RT05"),  # parameters that exist, and their types
    *("SS01", "SS02", "SS03", "SS04"),  # summaries
}
"""Codes of numpydoc's validation that are errors here; a description may begin with a symbol or a file's name."""

SHOWN = {f"{module}.{name}" for modules in reference.physics_pages().values() for module, names in modules.items() for name in names}
"""Functions and classes of physics that the reference shows."""

ROLES = ("func", "data", "meth", "mod", "class", "attr", "obj", "exc")


class Text(Directive):
    """Directive of Sphinx whose body is read as text."""

    has_content = True
    optional_arguments = 1
    final_argument_whitespace = True
    option_spec = None

    def run(self) -> list[nodes.Node]:
        """Return nothing: its body is not shown."""
        return []


def modules() -> Iterator[ModuleType]:
    """Yield the modules of the package."""
    yield seaglint
    for found in pkgutil.walk_packages(seaglint.__path__, "seaglint."):
        yield importlib.import_module(found.name)


def documented(module: ModuleType) -> Iterator[tuple[str, Any]]:
    """Yield the classes, methods and functions of a module that have docstrings, by full name."""
    for name, value in vars(module).items():
        if getattr(value, "__module__", None) != module.__name__ or not (inspect.isclass(value) or inspect.isfunction(value)):
            continue
        inner = vars(value).items() if inspect.isclass(value) else ()
        methods = ((f"{name}.{key}", part) for key, part in inner if inspect.isfunction(part))
        for each, part in ((name, value), *methods):
            text = vars(part).get("__doc__") if inspect.isclass(part) else part.__doc__
            if text and part.__module__ == module.__name__ and not text.startswith(f"{name}("):  # dataclasses and tuples write one
                yield f"{module.__name__}.{each}", part


def markup_errors(text: str) -> list[str]:
    """Return what docutils reports of a text."""
    settings = get_default_settings(Parser())
    settings.report_level, settings.halt_level, settings.warning_stream = 2, 5, False
    document = utils.new_document("", settings)
    document.reporter.stream = None
    messages: list[str] = []
    document.reporter.attach_observer(lambda message: messages.append(message.astext()) if message["level"] >= 2 else None)
    Parser().parse(text, document)
    return messages


def rendered(name: str, value: Any) -> str:
    """Return a docstring as numpydoc renders it."""
    kind = SphinxClassDoc if inspect.isclass(value) else SphinxFunctionDoc
    return str(kind(value, config={"show_class_members": False}))


def faults_of(name: str, value: Any) -> Iterator[str]:
    """Yield the errors that numpydoc finds in a docstring."""
    text = inspect.getdoc(value) or ""
    described = "Parameters\n----------\n" in text
    codes = CODES | ({"PR01"} if described else set()) | ({"RT01"} if described and name in SHOWN else set())
    with warnings.catch_warnings(record=True) as noted:
        warnings.simplefilter("always")
        for code, message in validate(name)["errors"]:
            if code in codes:
                yield f"{name}: {code} {message}"
    for warning in noted:
        if "Unknown section" in str(warning.message):
            yield f"{name}: {str(warning.message).splitlines()[0]}"


def errors_of(module: ModuleType) -> Iterator[str]:
    """Yield the errors in the docstrings of a module."""
    for message in markup_errors(inspect.getdoc(module) or ""):
        yield f"{module.__name__}: {message}"
    for name, value in documented(module):
        if "<locals>" not in name and "._" not in name:
            yield from faults_of(name, value)
        for message in markup_errors(rendered(name, value)):
            yield f"{name}: {message}"


def main() -> int:
    """Print all errors and return how many there are, at most 1."""
    os.environ["NUMBA_DISABLE_JIT"] = "1"  # kernels then are plain functions with docstrings
    for role in ROLES:
        roles.register_generic_role(role, nodes.literal)
    for name in ("code-block", "seealso", "versionadded", "only"):
        directives.register_directive(name, Text)
    found = [error for module in modules() for error in errors_of(module)]
    print(*found, f"{len(found)} errors in docstrings", sep="\n")
    return bool(found)


if __name__ == "__main__":
    sys.exit(main())
