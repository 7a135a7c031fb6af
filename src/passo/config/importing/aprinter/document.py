"""Reads JSON with the line of each value, and the options that were stored after it was written."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from passo.config.importing.draft import Place, bad
from passo.config.importing.numbers import NUMBER, Read, in_range, number_of
from passo.errors import ConfigError

if TYPE_CHECKING:
    from pathlib import Path

_SPACE = re.compile(r"[ \t\r\n]*")
_SCALAR = re.compile(r'"(?:[^"\\\n]|\\.)*"|-?[\d.][\d.eE+-]*|true|false|null')
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
    """Reads JSON by recursive descent, counting lines."""

    def __init__(self, text: str, path: Path) -> None:
        self._text, self._name, self._at = text, path.name, 0
        self._line, self._counted = 1, 0

    def whole(self) -> Node:
        """The only value of the text."""
        node = self._value(0)
        self._skip()
        if self._at != len(self._text):
            raise self._wrong()
        return node

    def _place(self) -> Place:
        self._line += self._text.count("\n", self._counted, self._at)
        self._counted = self._at
        return Place(self._name, self._line)

    def _wrong(self) -> ConfigError:
        place = self._place()
        value = self._text[self._at : self._at + 20].split("\n")[0]
        return bad(place, "the document", value, "JSON, as APrinter's editor exports it")

    def _skip(self) -> str:
        """The next character that is not a space; empty at the end."""
        space = _SPACE.match(self._text, self._at)
        self._at = space.end() if space else self._at
        return self._text[self._at : self._at + 1]

    def _take(self, sign: str) -> None:
        if self._skip() != sign:
            raise self._wrong()
        self._at += 1

    def _value(self, depth: int) -> Node:
        first = self._skip()
        if depth == _MAX_DEPTH:
            raise self._wrong()
        node = Node(self._place())
        if first == "{":
            self._at += 1
            while self._skip() != "}":
                key = self._scalar()
                if not isinstance(key, str):
                    raise self._wrong()
                self._take(":")
                node.fields[key] = self._value(depth + 1)
                self._comma("}")
            self._at += 1
        elif first == "[":
            self._at += 1
            while self._skip() != "]":
                node.items.append(self._value(depth + 1))
                self._comma("]")
            self._at += 1
        else:
            node.scalar = self._scalar()
        return node

    def _comma(self, end: str) -> None:
        if self._skip() == ",":
            self._at += 1
        elif self._skip() != end:
            raise self._wrong()

    def _scalar(self) -> Scalar:
        self._skip()
        found = _SCALAR.match(self._text, self._at)
        try:
            if found is None:
                raise ValueError
            value = json.loads(found[0])
        except ValueError:
            raise self._wrong() from None
        self._at = found.end()
        return value
