"""Frames of stored runs written as files of other programs, one frame after the other: one file per family of formats."""

from seaglint.files.export.endings import write_stack
from seaglint.files.export.stack import Exported, Stack, select

__all__ = ["Exported", "Stack", "select", "write_stack"]
