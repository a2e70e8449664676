"""The scenario workbench: a form, and pictures of what it says."""

from seaglint.viewer.workbench.bench import page

__all__ = ["page"]
