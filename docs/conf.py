"""Sphinx configuration; ``./run docs`` builds with warnings as errors."""

import os
import sys
from pathlib import Path

# Kernels then are plain functions, with signatures and docstrings that autodoc can read.
os.environ["NUMBA_DISABLE_JIT"] = "1"
sys.path.insert(0, str(Path(__file__).parent / "_ext"))
sys.path.insert(0, str(Path(__file__).parents[1] / "tools"))

import seaglint

project = "seaglint"
author = "The seaglint developers"
copyright = "The seaglint developers, BSD-3-Clause"
release = version = seaglint.__version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.mathjax",
    "numpydoc_once",
    "sphinx_design",
    "plain_pages",
    "reference",
    "saved_files",
    "sidebar",
]
exclude_patterns = ["_build"]

html_theme = "furo"
html_title = f"seaglint {release}"
html_copy_source = False
html_static_path = ["_static"]
html_css_files = ["phone.css"]

myst_enable_extensions = ["dollarmath", "deflist", "colon_fence"]
myst_heading_anchors = 3

autosummary_generate = False  # reference.py writes the pages
autodoc_typehints = "none"  # numpydoc's Parameters sections name types, units and shapes
autodoc_use_type_comments = False  # parses every function anew; there are none
autodoc_member_order = "bysource"
numpydoc_show_class_members = False
numpydoc_xref_param_type = False


def no_signature(app, what, *others):
    """Data have no signature: numpydoc reads one from the docstring of the type that an alias stands for."""
    return () if what == "data" else None


def setup(app):
    """Connect before numpydoc."""
    app.connect("autodoc-process-signature", no_signature, priority=400)
