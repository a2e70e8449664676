"""Formulas as MathML, made when the site is built: they need neither a network nor JavaScript.

A formula that cannot be converted is a warning, by which ``./run docs`` fails.
"""

from __future__ import annotations

from html import escape
from typing import Any

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.application import Sphinx
from sphinx.util import logging
from sphinx.util.math import get_node_equation_number

logger = logging.getLogger(__name__)


def mathml(formula: str, display: str) -> str:
    r"""Return a formula of LaTeX as a ``<math>`` element, displayed ``inline`` or as a ``block``.

    Raises
    ------
    ValueError
        Where the converter leaves a command of LaTeX as text, as it does with names that it does not know.
    """
    lines = r"\\" in formula and r"\begin" not in formula  # Sphinx aligns such blocks for LaTeX likewise
    result = convert(rf"\begin{{align*}}{formula}\end{{align*}}" if lines else formula, display=display)
    if "\\" in result:
        raise ValueError("a command is not known")
    return result


def element(node: nodes.Element, display: str) -> str:
    """Return the element of a formula; where it has errors, warn and return its source."""
    try:
        return mathml(node.astext(), display)
    except Exception as error:  # the converter has a class of errors for each mistake
        logger.warning("formula cannot be converted to MathML (%s): %s", error or type(error).__name__, node.astext(), location=node)
        return f"<code>{escape(node.astext())}</code>"


def visit_inline(self: Any, node: nodes.math) -> None:
    """Write a formula within a line."""
    self.body.append(self.starttag(node, "span", "", CLASS="math") + element(node, "inline") + "</span>")
    raise nodes.SkipNode


def visit_block(self: Any, node: nodes.math_block) -> None:
    """Write a formula on its own line, after its number where it has one."""
    self.body.append(self.starttag(node, "div", CLASS="math"))
    if node["number"]:
        self.body.append(f'<span class="eqno">({get_node_equation_number(self, node)})')
        self.add_permalink_ref(node, "Link to this equation")
        self.body.append("</span>")
    self.body.append(element(node, "block") + "</div>\n")
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, bool]:
    """Add the renderer."""
    app.add_html_math_renderer("mathml", (visit_inline, None), (visit_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
