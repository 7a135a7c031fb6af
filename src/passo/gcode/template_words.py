"""The words of template errors: no class names of the source."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import cast

_LISTED = 12  # names at most in a message
_KINDS: Mapping[str, str] = {
    "str": "a text",
    "int": "a number",
    "float": "a number",
    "bool": "a truth value",
    "NoneType": "None",
    "list": "a list",
    "tuple": "a list",
    "set": "a set",
    "range": "a range",
    "dict": "a table",
    "PrinterTree": "printer",
    "Coord": "a position",
    "_Missing": "a name without a value",
    "Macro": "a macro of the template",
    "Namespace": "a namespace",
    "Cycler": "a cycler",
    "Joiner": "a joiner",
    "LoopContext": "loop",
    "method": "a function",
    "function": "a function",
    "builtin_function_or_method": "a function",
    "generator": "a list that is read once",
}
_OF_SOURCE = ("_Missing", "PrinterTree", "Coord", "Macro", "Namespace", "Cycler", "Joiner")
_CLASS = re.compile(rf"'(?:\w+\.)*({'|'.join(_OF_SOURCE)})'|\b(_Missing|PrinterTree)\b")
_FILTER = re.compile(r"\b(?:sync_)?do_(\w+)\(\)")  # a filter by the name of its function


def kind_of(value: object) -> str:
    """What a value is, in words."""
    return _KINDS.get(type(value).__name__, "this value")


def in_words(text: str) -> str:
    """An error of Python or Jinja2, with words in place of the names of classes."""
    text = _CLASS.sub(lambda found: _KINDS[found[1] or found[2]], text)
    return _FILTER.sub(r"the filter \1", text)


def known_names(value: object) -> str:
    """The names in a table, as a continuation of a sentence; empty for other values and for long
    tables."""
    if not isinstance(value, Mapping):
        return ""
    names = [str(name) for name in cast("Mapping[object, object]", value)]
    if not names:
        return ": it is empty"
    return f"; it has {', '.join(names)}" if len(names) <= _LISTED else ""
