"""Packages of the extras, imported where they are needed."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from seaglint.base.errors import BackendError


def optional(module: str, purpose: str, extra: str) -> Any:
    """Import a module of an extra.

    Raises
    ------
    BackendError
        It is not installed; the message names the extra.

    Examples
    --------
    >>> optional("no_such_reader", "this file", "recordings")
    Traceback (most recent call last):
    seaglint.base.errors.BackendError: this file needs no_such_reader, which is not installed; pip install 'seaglint[recordings]'
    """
    try:
        return import_module(module)
    except ImportError as error:
        package = module.split(".")[0]
        raise BackendError(f"{purpose} needs {package}, which is not installed; pip install 'seaglint[{extra}]'") from error
