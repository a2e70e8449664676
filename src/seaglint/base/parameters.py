"""Description of a parameter of a request, from which the command line makes an option and Python a keyword."""

from __future__ import annotations

import inspect
import re
import textwrap
from collections.abc import Callable, Mapping
from dataclasses import fields
from types import MappingProxyType
from typing import Any, Final, NamedTuple, TypeVar, get_args, get_type_hints

#: Headings of the parameters of requests, in the order of a help page that has headings.
GROUPS: Final = ("Object", "Detector", "Recording", "Scenes", "Design", "Range", "Results", "Run")

LINE: Final = "{request}"  #: Line of a docstring for which ``documented`` writes the parameters of a request.

Function = TypeVar("Function", bound=Callable[..., Any])


class Parameter(NamedTuple):
    """Description of one parameter, besides its type and default in a record."""

    help: str  #: Meaning with unit, in a line; names of other parameters are in backticks.
    group: str = ""  #: Heading of the parameter on a help page, one of ``GROUPS``.
    #: Form of its text on a command line: "numbers" (``1,2,4`` or ``FIRST:LAST:STEP``), "pair" (``X,Y``), "limits"
    #: (``NEAR:FAR``), "size" (``COLUMNSxROWS``), "frames" (``37:38``), "every" (``0:100:2``), "shares" (``0.2:0.8``), "weights" (file of
    #: numbers), "mask" (image), "regions" (image or JSON), "raw" (layout of a raw file), "switch" (auto, always or never), "name" and
    #: "names" (words for objects in Python); empty where the type determines it.
    form: str = ""
    metavar: str = ""  #: Placeholder of the value on a help page; empty for the placeholder of the type.
    least: float | None = None  #: Smallest value allowed.
    option: str = ""  #: Option that sets it, if its name differs from the parameter's.
    subject: str = ""  #: Words before the help in documentation, in place of the option's name on a help page.
    detail: str = ""  #: Sentences that documentation adds to the help.
    #: Sentences in documentation in place of the help, for an object in Python that is a file or a text on a command line.
    python: str = ""


def described(record: type) -> dict[str, Parameter]:
    """Return the descriptions of a record's fields by name; fields without a description are omitted."""
    hints = get_type_hints(record, include_extras=True)
    descriptions = {
        field.name: [extra for extra in get_args(hints[field.name]) if isinstance(extra, Parameter)] for field in fields(record)
    }
    return {name: extras[0] for name, extras in descriptions.items() if extras}


def documented(*records: type, **words: str) -> Callable[[Function], Function]:
    """Return a decorator that writes the parameters of requests into a function's docstring, at a line ``{request}``.

    Names, types and defaults come from the signature of the function. For a parameter of several records the text of the first one is used.
    ``words`` replace ``{name}`` and ``NAME``. Without records the parameters of a request are written into its docstring.
    """

    def document(function: Function) -> Function:
        if function.__doc__:  # none under python -OO
            texts = {name: text for record in reversed(records or (function,)) for name, text in described(record).items()}
            entries = [
                f"{name} : {_type(annotation)}\n{_indented(sentences(name, texts[name], words))}"
                for name, annotation in _annotations(function).items()
                if name in texts
            ]
            indent = re.search(rf"^([ \t]*){re.escape(LINE)}", function.__doc__, flags=re.MULTILINE)
            before = indent[1] if indent else ""
            function.__doc__ = function.__doc__.replace(before + LINE, textwrap.indent("\n".join(entries), before))
        return function

    return document


def _annotations(function: Callable[..., Any]) -> dict[str, str]:
    """Return the types of parameters as texts; types of a record's fields without their descriptions."""
    if isinstance(function, type):
        return {name: inspect.formatannotation(hint) for name, hint in get_type_hints(function).items()}
    return {name: str(parameter.annotation) for name, parameter in inspect.signature(function).parameters.items()}


def sentences(name: str, parameter: Parameter, words: Mapping[str, str] = MappingProxyType({})) -> str:
    """Return the meaning of a parameter in documentation: help and detail as sentences.

    >>> sentences("seed", Parameter("of the samples", detail="Any integer."))
    'Seed of the samples. Any integer.'
    """
    if parameter.python:
        return parameter.python
    text = re.sub(r"`(\w+)`", r"``\1``", parameter.help)
    text = re.sub(r"\{(\w+)\}|\b([A-Z]{3,})\b", lambda match: words.get(match[1] or match[2], match[0]), text)
    text = text.removesuffix("; repeatable")
    subject = parameter.subject or (name.replace("_", " ") if text.startswith("of ") else "")
    text = f"{subject} {text}".strip()
    return f"{text[0].upper()}{text[1:]}. {parameter.detail}".strip()


def _indented(text: str) -> str:
    """Return a text as the lines below a parameter's name and type."""
    return textwrap.indent("\n".join(textwrap.wrap(text, 130, break_long_words=False)), "    ")


def _type(annotation: str) -> str:
    """Return a type in the words of documentation.

    >>> _type("int | Workers | None"), _type("Literal['uint16', 'float32'] | None"), _type("tuple[float, float]")
    ('int or Workers, optional', "{'uint16', 'float32'}, optional", '(float, float)')
    >>> _type("Sequence[float]"), _type("tuple[str, ...]"), _type("str | Filter"), _type("ArrayLike | None")
    ('sequence of float', 'tuple of str', 'str or Filter', 'array_like, optional')
    """
    text, optional = annotation.removesuffix(" | None"), annotation.endswith(" | None")
    text = re.sub(r"Literal\[([^\]]*)\]", r"{\1}", text)
    text = re.sub(r"tuple\[(\w+), \.\.\.\]", r"tuple of \1", text)
    text = re.sub(r"tuple\[([^\]]*)\]", r"(\1)", text)
    text = re.sub(r"Sequence\[([^\]]*)\]", r"sequence of \1", text)
    return text.replace(" | ", " or ").replace("ArrayLike", "array_like") + (", optional" if optional else "")
