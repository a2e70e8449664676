"""Sphinx configuration; ``./run docs`` builds with warnings as errors."""

import os
import sys
from pathlib import Path

# Kernels then are plain functions, with signatures and docstrings that autodoc can read.
os.environ["NUMBA_DISABLE_JIT"] = "1"
sys.path.insert(0, str(Path(__file__).parent / "_ext"))
sys.path.insert(0, str(Path(__file__).parents[1] / "tools"))

import reference
import seaglint

project = "seaglint"
author = "The seaglint developers"
copyright = "The seaglint developers, BSD-3-Clause"
release = version = seaglint.__version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.intersphinx",
    "cards",
    "dark_pages",
    "keywords",
    "leftovers",
    "makers",
    "mathml",
    "numpydoc_once",
    "plain_pages",
    "reference",
    "saved_files",
    "sidebar",
]
exclude_patterns = ["_build"]

html_theme = "furo"
html_title = f"seaglint {release}"
html_copy_source = False
html_use_index = html_domain_indices = False  # the lists of the reference and the search are better doors
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_js_files = [("site.js", {"defer": "defer"})]
html_logo = html_favicon = "_static/logo.svg"
html_math_renderer = "mathml"
html_search_scorer = str(Path(__file__).parent / "_ext" / "search_scorer.js")
html_show_search_summary = False  # each would read its whole page, and from a disk browsers refuse to

myst_enable_extensions = ["dollarmath", "deflist"]
myst_heading_anchors = 3
myst_html_meta = {
    "description": "What an infrared camera sees at sea: calibrated image sequences, glint, clutter, detector counts and detection ranges."
}

nitpicky = True  # a role that leads nowhere is an error
# The names that the reference uses, without a network: tools/inventories.py.
intersphinx_mapping = {
    "python": ("https://docs.python.org/3", "_inventories/python.inv"),
    "numpy": ("https://numpy.org/doc/stable", "_inventories/numpy.inv"),
    "xarray": ("https://docs.xarray.dev/en/stable", "_inventories/xarray.inv"),
}

autosummary_generate = False  # numpydoc brings it; reference.py writes the pages
autodoc_typehints = "none"  # numpydoc's Parameters sections name types, units and shapes
autodoc_use_type_comments = False  # parses every function anew; there are none
autodoc_member_order = "bysource"
python_maximum_signature_line_length = 88  # longer ones have a line for each parameter
numpydoc_show_class_members = False
numpydoc_xref_param_type = True
numpydoc_xref_ignore = "all"  # words of a type that are no names
numpydoc_xref_aliases = {
    **reference.class_names(),
    **{name: f":obj:`{name}`" for name in ("bool", "dict", "float", "int", "list", "None", "range", "str", "tuple")},
    **{name: f":obj:`{name}`" for name in ("xarray.DataArray", "xarray.Dataset")},
    **{name.rpartition(".")[2]: name for name in ("collections.abc.Callable", "collections.abc.Iterator", "pathlib.Path")},
    **{name.rpartition(".")[2].lower(): name for name in ("collections.abc.Mapping", "collections.abc.Sequence", "pathlib.Path")},
    **{name.rpartition(".")[2]: name for name in ("numpy.ndarray", "datetime.datetime")},
    "array_like": "numpy.typing.ArrayLike",
    "callable": "collections.abc.Callable",
    "iterator": "collections.abc.Iterator",
    "Dataset": "xarray.Dataset",
    "SceneInput": "seaglint.scenario.model.Scenario",
    "Workers": "seaglint.cluster.local.LocalProcesses",
}


def no_signature(app, what, *others):
    """Data have no signature: numpydoc reads one from the docstring of the type that an alias stands for."""
    return () if what == "data" else None


def setup(app):
    """Connect before numpydoc."""
    app.connect("autodoc-process-signature", no_signature, priority=400)
