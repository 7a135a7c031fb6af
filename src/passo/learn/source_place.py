"""Finds the code that a lesson names."""

from __future__ import annotations

import ast
import re
from dataclasses import dataclass
from pathlib import Path

import passo
from passo.learn.lesson import Source

_PACKAGE = Path(passo.__file__).parent
_ROOT = _PACKAGE.parents[1]
_MAX_LINES = 40  # of an excerpt


@dataclass(frozen=True, slots=True)
class SourcePlace:
    """The first line of the symbol, from 1, and its code; 0 and empty if this installation lacks
    the file: a wheel has only the sources in Python."""

    line: int = 0
    code: str = ""


def source_place(source: Source) -> SourcePlace:
    """Where the code is now. Raises LookupError if the file lacks the symbol."""
    path = _path(source.file)
    if not path.is_file():
        return SourcePlace()
    text = path.read_text(encoding="utf-8")
    first, last = _in_python(text, source) if path.suffix == ".py" else _in_c(text, source)
    lines = text.splitlines()[first - 1 : min(last, first - 1 + _MAX_LINES)]
    return SourcePlace(first, "\n".join(lines))


def _path(file: str) -> Path:
    inside = Path(file)
    if inside.parts[:2] == ("src", "passo"):
        return _PACKAGE.joinpath(*inside.parts[2:])
    return _ROOT / inside


def _in_python(text: str, source: Source) -> tuple[int, int]:
    nodes: list[ast.stmt] = ast.parse(text).body
    first = last = 0
    for name in source.symbol.split("."):
        for node in nodes:
            match node:
                case ast.FunctionDef() | ast.AsyncFunctionDef() | ast.ClassDef():
                    named = node.name == name
                case ast.Assign(targets=[ast.Name(id=target)]):
                    named = target == name
                case ast.AnnAssign(target=ast.Name(id=target)):
                    named = target == name
                case _:
                    named = False
            if named:
                first, last = node.lineno, node.end_lineno or node.lineno
                nodes = getattr(node, "body", [])
                break
        else:
            raise LookupError(f"{source.file} does not define {source.symbol}")
    return first, last


def _in_c(text: str, source: Source) -> tuple[int, int]:
    """The definition of a function, a type or a macro, up to the end of its block."""
    name = re.escape(source.symbol.rpartition("::")[2])
    defined = re.compile(
        rf"^(?:#define {name}\b|[ \t]*(?:class|struct|enum(?: class)?) {name}\b(?!;)"
        rf"|[ \t]*(?!return\b|else\b|//)[\w:<>,&*\[\] ]+[ &*:]{name}\()",
        re.MULTILINE,
    )
    found = defined.search(text)
    if found is None:
        raise LookupError(f"{source.file} does not define {source.symbol}")
    lines = text.splitlines()
    first = text.count("\n", 0, found.start()) + 1
    indent = len(lines[first - 1]) - len(lines[first - 1].lstrip())
    for i in range(first, len(lines)):
        if lines[i].startswith(" " * indent + "}"):
            return first, i + 1
    return first, first
