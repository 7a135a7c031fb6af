"""Reads JSON with the line of each value, and the options that were stored after it was written."""

from __future__ import annotations

import json
import re
from bisect import bisect_left
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from passo.config.importing.draft import Place, bad
from passo.config.importing.numbers import NUMBER, Read, in_range, number_of
from passo.errors import ConfigError

if TYPE_CHECKING:
    from pathlib import Path

_TOKEN = re.compile(  # a sign, or a scalar
    r'[ \t\r\n]*([{}\[\]:,]|"(?:[^"\\\n]|\\.)*"|-?[\d.][\d.eE+-]*|true|false|null|\Z)'
)
_OPTION = re.compile(r"(?:M926 I)?([A-Za-z]\w*)(?:=| V)(\S*)")
_MAX_DEPTH = 40
KIND = "_compoundName"  # the key that names the kind of an object
Scalar = str | float | int | bool | None


@dataclass
class Node:
    """A value of the document. An object has `fields`, an array has `items`, any other value is the
    `scalar`."""

    place: Place
    scalar: Scalar = None
    fields: dict[str, Node] = field(default_factory=dict[str, "Node"])
    items: list[Node] = field(default_factory=list["Node"])

    @property
    def kind(self) -> str:
        """The kind of the object."""
        return self.text(KIND)

    def get(self, *path: str) -> Node | None:
        """The value below; None if it is not there."""
        found: Node | None = self
        for key in path:
            found = found.fields.get(key) if found else None
        return found

    def text(self, *path: str) -> str:
        """The text below; empty if there is none."""
        found = self.get(*path)
        return found.scalar if found and isinstance(found.scalar, str) else ""

    def flag(self, *path: str) -> bool:
        """Whether the value below is true."""
        found = self.get(*path)
        return found is not None and found.scalar is True

    def within(self, *path: str) -> Node:
        """The object below. Raises ConfigError if it is missing."""
        found = self.get(*path)
        if found is None:
            raise missing(self.place, ".".join(path))
        return found

    def each(self, *path: str) -> list[Node]:
        """The elements of an array below."""
        found = self.get(*path)
        return found.items if found else []


def missing(place: Place, key: str) -> ConfigError:
    """The error of a key that a configuration needs."""
    limit = "the key that APrinter needs"
    return ConfigError.of("config.missing-key", place.file, place.line, key=key, limit=limit)


@dataclass
class Stored:
    """Options by name, from aprinter.cfg or an answer to M503, with their places. If a file has an
    option twice, the last value counts."""

    options: dict[str, tuple[str, Place]] = field(default_factory=dict[str, tuple[str, Place]])
    used: set[str] = field(default_factory=set[str])

    def number(self, node: Node, key: str, option: str = "") -> Read | None:
        """A number of the document, or its stored `option`; None if neither is there. Raises
        ConfigError."""
        self.used.add(option)
        if option in self.options:
            text, place = self.options[option]
            try:
                return Read(number_of(text), option, place)
            except ValueError:
                raise bad(place, option, text[:40], NUMBER) from None
        found = node.get(key)
        if found is None:
            return None
        if not isinstance(found.scalar, int | float) or not in_range(found.scalar):
            raise bad(found.place, key, str(found.scalar)[:40], NUMBER)
        return Read(float(found.scalar), key, found.place)

    def needed(self, node: Node, key: str, option: str = "") -> Read:
        """Like `number`, but raises ConfigError also if neither is there."""
        found = self.number(node, key, option)
        if found is None:
            raise missing(node.place, key)
        return found

    def flag(self, node: Node, key: str, option: str = "") -> bool:
        """A flag of the document, or its stored option, which is 0 or 1."""
        self.used.add(option)
        if option in self.options:
            return self.options[option][0] not in ("0", "0.0")
        return node.flag(key)


def stored_options(text: str, name: str) -> Stored:
    """The options of aprinter.cfg (`Name=value`), or of an answer to M503 (`M926 IName Vvalue`).
    Other lines are left out, as APrinter does."""
    stored = Stored()
    for number, line in enumerate(text.splitlines(), 1):
        found = _OPTION.fullmatch(line.strip())
        if found:
            stored.options[found[1]] = found[2], Place(name, number)
    return stored


def document(text: str, path: Path) -> Node:
    """The document of a JSON text. Raises ConfigError with the line of the error."""
    return _Reader(text, path).whole()


class _Reader:
    """Reads JSON by recursive descent, with the line of each value."""

    def __init__(self, text: str, path: Path) -> None:
        self._text, self._name, self._at = text, path.name, 0
        self._ends = [found.start() for found in re.finditer("\n", text)]

    def whole(self) -> Node:
        """The only value of the text."""
        node = self._value(self._take(), 0)
        if self._take():
            raise self._wrong(self._at - 1)
        return node

    def _take(self) -> str:
        """The next sign or scalar; empty at the end."""
        found = _TOKEN.match(self._text, self._at)
        if found is None:
            raise self._wrong(self._at)
        self._at = found.end()
        return found[1]

    def _value(self, token: str, depth: int) -> Node:
        start = self._at - len(token)
        node = Node(self._place(start))
        if depth == _MAX_DEPTH:
            raise self._wrong(start)
        if token not in ("{", "["):
            node.scalar = self._scalar(token)
            return node
        end, token = {"{": "}", "[": "]"}[token], self._take()
        while token != end:
            if end == "]":
                node.items.append(self._value(token, depth + 1))
            else:
                key = self._scalar(token)
                if not isinstance(key, str) or self._take() != ":":
                    raise self._wrong(self._at - 1)
                node.fields[key] = self._value(self._take(), depth + 1)
            token = self._take()
            if token == ",":
                token = self._take()
            elif token != end:
                raise self._wrong(self._at - len(token))
        return node

    def _scalar(self, token: str) -> Scalar:
        try:
            return json.loads(token)
        except ValueError:
            raise self._wrong(self._at - len(token)) from None

    def _place(self, at: int) -> Place:
        return Place(self._name, bisect_left(self._ends, at) + 1)

    def _wrong(self, at: int) -> ConfigError:
        at += len(self._text[at:]) - len(self._text[at:].lstrip(" \t\r\n"))
        value = self._text[at : at + 20].split("\n")[0]
        limit = "JSON, as APrinter's editor exports it"
        return bad(self._place(at), "the document", value, limit)
