"""The defines of Configuration.h and the files in its folder, after the C preprocessor."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

from passo.config.importing.draft import Place, bad
from passo.config.importing.marlin.derived import derived
from passo.config.importing.marlin.expression import Number, Unreadable, value_of
from passo.config.importing.numbers import NUMBER, Read, in_range
from passo.config.importing.sources import Sources
from passo.errors import ConfigError

_QUIET = re.compile(  # comments, and the strings and characters in which none begins
    r'"(?:\\.|[^"\\\n])*"?|\'[^\'\n]{1,4}\'|//[^\n]*|/\*.*?(?:\*/|\Z)', re.DOTALL
)
_DIRECTIVE = re.compile(r"\s*#\s*(\w+)\s*(.*)", re.DOTALL)
_DEFINE = re.compile(r"([A-Za-z_]\w*)(\([^)]*\))?\s*(.*)", re.DOTALL)
_CONSTANT = re.compile(r"\s*(?:static\s+)?const\s+\w+\s+([A-Za-z_]\w*)\s*=\s*(.*?)\s*;?\s*")
_NAME = re.compile(r"[A-Za-z_]\w*")
_DERIVED = re.compile("HAS_|IS_|CORE_IS_|NUM_|NEED_|USE_")
_MAX_NEST = 100  # of #if


@dataclass
class _Branch:
    """An #if. `active`: the present part is read. `taken`: the present or an earlier part is read.
    `unknown` is the condition that cannot be decided; later parts are then left out."""

    active: bool
    taken: bool
    place: Place
    unknown: str = ""

    @property
    def open(self) -> bool:
        """Whether a later part may be read."""
        return not self.taken and not self.unknown


@dataclass
class Defines:
    """The defines of a configuration. `found` are those in effect, in the order of the files.
    `undecided` are those in parts that are left out because the #if around them cannot be decided.
    A method that takes several names uses the first one that is defined, because Marlin has changed
    names over the years."""

    found: dict[str, tuple[str, Place]] = field(default_factory=dict[str, tuple[str, Place]])
    undecided: dict[str, tuple[str, Place]] = field(default_factory=dict[str, tuple[str, Place]])
    used: set[str] = field(default_factory=set[str])
    files: list[Path] = field(default_factory=list[Path])

    def text_of(self, name: str) -> str | None:
        """The text of a define; None if it is not in effect."""
        entry = self.found.get(name)
        return None if entry is None else entry[0]

    def is_on(self, name: str) -> bool:
        """Marlin's ENABLED(): whether the name is defined without a value, as 1, or as true."""
        return self.text_of(name) in ("", "1", "true")

    def derived(self, name: str, argument: str | None) -> Number | None:
        """The value that Marlin's own files derive."""
        return derived(self, name, argument)

    def first(self, *names: str) -> str | None:
        """The first of these names that is defined. All count as read."""
        self.used.update(names)
        return next((name for name in names if name in self.found), None)

    def on(self, *names: str) -> bool:
        """Whether one of these is enabled. All count as read."""
        self.used.update(names)
        return any(self.is_on(name) for name in names)

    def place(self, name: str) -> Place:
        """The place of a define that is in effect."""
        return self.found[name][1]

    def text(self, *names: str) -> str | None:
        """The text of the first that is defined, without quotes; None if none is."""
        name = self.first(*names)
        return None if name is None else _resolved(self, name).strip('"')

    def number(self, *names: str) -> Read | None:
        """The number of the first that is defined, of an array its first; None if none is. Raises
        ConfigError."""
        name = self.first(*names)
        if name is None:
            return None
        text = next(iter(split(_resolved(self, name))), "")
        return Read(self._value(name, text), name, self.place(name))

    def numbers(self, *names: str) -> list[Read] | None:
        """The numbers of an array, or of one number; None if none is defined. Raises
        ConfigError."""
        name = self.first(*names)
        if name is None:
            return None
        parts = split(_resolved(self, name))
        return [Read(self._value(name, part), name, self.place(name)) for part in parts]

    def pairs(self, *names: str) -> list[tuple[float, float]] | None:
        """An array of arrays of two numbers, as places of the bed are written; None if none is
        defined. Raises ConfigError."""
        name = self.first(*names)
        if name is None:
            return None
        result: list[tuple[float, float]] = []
        for part in split(_resolved(self, name)):
            values = [self._value(name, one) for one in split(part)]
            if len(values) < 2:
                raise bad(self.place(name), name, part[:60], "two numbers in braces")
            result.append((values[0], values[1]))
        return result

    def _value(self, name: str, text: str) -> float:
        try:
            value = value_of(text, _Value(self))
        except Unreadable as error:
            limit = f"a number; {error.names[0]} is not defined" if error.names else NUMBER
            raise bad(self.place(name), name, text[:60], limit) from None
        if not in_range(value):
            raise bad(self.place(name), name, text[:60], NUMBER)
        return value


def _resolved(defines: Defines, name: str) -> str:
    """The text of a define, or of that which it names."""
    text = defines.found[name][0]
    for _ in range(_MAX_NEST):
        if text not in defines.found:
            break
        text = defines.found[text][0]
    return text


def split(text: str) -> list[str]:
    """The elements of `{ 1, (2 + 3), { 4 } }`; a text without braces is one element."""
    if not (text.startswith("{") and text.endswith("}")):
        return [text]
    parts, depth, start, body = list[str](), 0, 0, text[1:-1]
    for i, letter in enumerate(body):
        depth += (letter in "({") - (letter in ")}")
        if letter == "," and depth == 0:
            parts.append(body[start:i].strip())
            start = i + 1
    return [part for part in (*parts, body[start:].strip()) if part]


def read(path: Path, companions: Iterable[str]) -> Defines:
    """The defines of a file and of its `companions`, which are names in the same folder. Files
    that do not exist or were already included are left out. Raises ConfigError with file and
    line."""
    reader = _Preprocessor()
    reader.read(path, ())
    for name in companions:
        further = path.with_name(name)
        if further.is_file() and further.resolve() not in reader.defines.files:
            reader.read(further, ())
    return reader.defines


class _Preprocessor:
    """Carries out #define, #undef, #if and #include, line by line."""

    def __init__(self) -> None:
        self.defines = Defines()
        self._sources = Sources()

    def read(self, path: Path, within: tuple[Path, ...]) -> None:
        """Adds the defines of a file, and of those that it includes if they are there."""
        text = self._sources.read(path, within)
        self.defines.files.append(path.resolve())
        branches: list[_Branch] = []
        for number, line in _lines(text):
            place = Place(path.name, number)
            found = _DIRECTIVE.fullmatch(line)
            if found is None:
                constant = _CONSTANT.fullmatch(line)
                if constant and all(branch.active for branch in branches):
                    self.defines.found[constant[1]] = constant[2], place
                continue
            word, rest = found[1], found[2].strip()
            if word in ("if", "ifdef", "ifndef", "elif", "else", "endif"):
                self._branch(word, rest, branches, place)
            elif all(branch.active for branch in branches):
                self._carry_out(word, rest, path, (*within, path.resolve()), place)
            elif word == "define" and (unknown := _undecided(branches)):
                name = _NAME.match(rest)
                if name:
                    self.defines.undecided.setdefault(name[0], (unknown, place))
        if branches:
            place = branches[-1].place
            raise ConfigError.of("import.endif", place.file, place.line, value="#if")

    def _carry_out(
        self, word: str, rest: str, path: Path, within: tuple[Path, ...], place: Place
    ) -> None:
        if word == "define":
            found = _DEFINE.fullmatch(rest)
            if found and not found[2]:
                self.defines.found[found[1]] = " ".join(found[3].split()), place
        elif word == "undef":
            self.defines.found.pop(rest, None)
        elif word == "include":
            other = path.with_name(rest.strip('"<> '))
            if "/" not in rest and "\0" not in rest and other.is_file():
                self.read(other, within)

    def _branch(self, word: str, rest: str, branches: list[_Branch], place: Place) -> None:
        if word in ("if", "ifdef", "ifndef"):
            if len(branches) == _MAX_NEST:
                raise ConfigError.of("import.nest", place.file, place.line, limit=_MAX_NEST)
            within = all(branch.active for branch in branches)
            holds, unknown = self._holds(word, rest) if within else (False, "")
            branches.append(_Branch(holds, holds, place, unknown))
            return
        if not branches:
            raise ConfigError.of("import.endif", place.file, place.line, value=f"#{word}")
        branch = branches[-1]
        if word == "endif":
            branches.pop()
        elif word == "else":
            branch.active = branch.open and all(one.active for one in branches[:-1])
            branch.taken = True
        else:
            within = branch.open and all(one.active for one in branches[:-1])
            holds, unknown = self._holds("if", rest) if within else (False, "")
            branch.unknown = branch.unknown or unknown
            branch.active = holds
            branch.taken |= holds

    def _holds(self, word: str, rest: str) -> tuple[bool, str]:
        """Whether a condition is true. If that cannot be decided, returns False and the text of the
        condition."""
        if word != "if":
            name = _NAME.match(rest)
            defined = name is not None and name[0] in self.defines.found
            return defined == (word == "ifdef"), ""
        try:
            return bool(value_of(rest, _Condition(self.defines))), ""
        except Unreadable:
            return False, rest[:60] or "#if"


class _Value:
    """The names in a value, which count as read."""

    def __init__(self, defines: Defines) -> None:
        self.is_on, self.derived = defines.is_on, defines.derived
        self._defines = defines

    def text_of(self, name: str) -> str | None:
        """The text of a define."""
        self._defines.used.add(name)
        return self._defines.text_of(name)


class _Condition:
    """The names in a condition: what is not defined is 0, as in C, unless Marlin derives it."""

    def __init__(self, defines: Defines) -> None:
        self.text_of = defines.text_of
        self._defines = defines

    def is_on(self, name: str) -> bool:
        """Whether the option is enabled, or what Marlin derives holds."""
        if self._defines.text_of(name) is not None or not _DERIVED.match(name):
            return self._defines.is_on(name)
        found = derived(self._defines, name, None)
        if found is None:
            raise Unreadable(name)
        return bool(found)

    def derived(self, name: str, argument: str | None) -> Number | None:
        """The value that Marlin's own files derive, or 0."""
        found = derived(self._defines, name, argument)
        if found is None and argument is None and not _DERIVED.match(name):
            return 0
        return found


def _undecided(branches: list[_Branch]) -> str:
    """The undecided condition of an #if around this line; empty if there is none."""
    return next((branch.unknown for branch in branches if branch.unknown), "")


def _lines(text: str) -> Iterable[tuple[int, str]]:
    """The lines with their numbers, without comments, and joined after a backslash."""
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    plain = _QUIET.sub(_without_comment, text)
    joined, first = "", 0
    for number, line in enumerate(plain.split("\n"), 1):
        first = first or number
        if line.endswith("\\"):
            joined += line[:-1] + " "
            continue
        yield first, joined + line
        joined, first = "", 0
    if joined:
        yield first, joined


def _without_comment(match: re.Match[str]) -> str:
    found = match[0]
    return " " + "\n" * found.count("\n") if found[0] == "/" else found
