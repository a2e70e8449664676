"""Syntax trees as text: what a source does, whatever its comments, docstrings and layout."""

from __future__ import annotations

import ast
import hashlib


def syntax_text(node: object, without: tuple[type[ast.AST], ...] = ()) -> str:
    r"""Return a syntax tree as text, the same for all versions of Python.

    Parameters
    ----------
    node : ast.AST
        Tree or part of one.
    without : tuple of types
        Kinds of nodes that are left out, besides docstrings.

    Returns
    -------
    str
        Names of nodes with their fields; fields without content are left out, because versions of Python differ in them.

    Examples
    --------
    >>> syntax_text(ast.parse("x = 1  # one")) == syntax_text(ast.parse("'''A number.'''\nx = 1"))
    True
    """
    match node:
        case None | ast.Expr(value=ast.Constant()):
            return ""
        case ast.AST():
            if isinstance(node, without):
                return ""
            fields = ((name, syntax_text(value, without)) for name, value in ast.iter_fields(node))
            return f"{type(node).__name__}({','.join(f'{name}={text}' for name, text in fields if text)})"
        case []:
            return ""
        case list():
            texts = ("-" if one is None else syntax_text(one, without) for one in node)
            return "[" + ",".join(text for text in texts if text) + "]"
    return repr(node)


def syntax_digest(source: bytes) -> str:
    """Return a digest of what a Python source does [20 hexadecimal digits]."""
    return hashlib.blake2b(syntax_text(ast.parse(source)).encode(), digest_size=10).hexdigest()
