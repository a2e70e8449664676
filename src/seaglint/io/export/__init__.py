"""Frames of stored runs written as files of other programs, one frame after the other: one file per family of formats."""

from seaglint.io.export.stack import Exported, Stack, select
from seaglint.io.export.write import write_stack

__all__ = ["Exported", "Stack", "select", "write_stack"]
