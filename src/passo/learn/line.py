"""A line of a program as the interpreter reads it: its number, its commands, their words."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from passo.gcode.dialect import Kind, row_of

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig

_NUMBERED = re.compile(r"[Nn]([-+]?(?:\d+\.?\d*|\.\d+))([^*]*)(?:\*\s*(\d+).*)?$", re.DOTALL)
_NAME = re.compile(r"[A-Za-z][A-Za-z_][\w.]*|_\S*", re.ASCII)
_WORD = re.compile(r"(\S)[ \t]*([-+]?(?:\d+\.?\d*|\.\d+))?")
_OF_TEXT = {16, 20, 23, 28, 30, 32, 36, 38, 98, 115, 117, 118, 486, 550, 587, 600, 862, 928}
_BEFORE_MOVES = {"G17", "G18", "G19", "G20", "G21", "G90", "G91"}  # what follows them is a move


class Word(NamedTuple):
    """A letter (upper case) with its number, None without one, and where both stand."""

    letter: str
    number: float | None
    begin: int
    end: int

    def __str__(self) -> str:
        return self.letter if self.number is None else f"{self.letter}{self.number:.10g}"

    @property
    def whole(self) -> bool:
        """It has a number without decimals."""
        return self.number is not None and self.number.is_integer()


@dataclass(frozen=True, slots=True)
class Spoken:
    """One command of a line: its code (empty: a move in the way of the last one) and its words."""

    code: str
    words: list[str]

    @property
    def meaning(self) -> str:
        """One sentence, of the dialect table where the code is there."""
        if not self.code:
            return "A move in the way of the last one before, G1 if there was none."
        if self.code == "S":
            return "S: The power of laser or spindle."
        row = row_of("T" if re.fullmatch(r"T-?\d+", self.code) else self.code)
        return f"{self.code}: {row.text if row else 'unknown here, skipped.'}"


@dataclass(frozen=True, slots=True)
class Line:
    """A line's number and checksum, empty where it has none, and its commands in order."""

    number: str
    checksum: str
    commands: list[Spoken]


def read_line(text: str, machine: MachineConfig) -> Line:
    """Reads a line that the interpreter takes on this machine, by the rules of its reference."""
    text = text.strip()
    number = checksum = ""
    if text.startswith(("%", ";")):
        return Line("", "", [])
    if found := _NUMBERED.match(text):
        number, text, checksum = found[1], found[2].strip(), found[3] or ""
    text = _without_comments(text)
    if not text:
        return Line(number, checksum, [])
    if found := _NAME.match(text):
        name, words = found[0], text[found.end() :].split()
        return Line(number, checksum, [Spoken(name if name[0] == "_" else name.upper(), words)])
    words = [
        Word(m[1].upper(), None if m[2] is None else float(m[2]), *m.span())
        for m in _WORD.finditer(text)
    ]
    return Line(number, checksum, list(_Reader(text, words, machine).commands()))


def _without_comments(text: str) -> str:
    """Parentheses, which may be nested, become blanks; what follows `;` outside of them goes."""
    kept: list[str] = []
    depth = 0
    for char in text:
        if char == ";" and depth == 0:
            break
        depth += char == "("
        kept.append(" " if depth else char)
        depth -= char == ")" and depth > 0
    return "".join(kept).strip()


class _Reader:
    """Shares the words of a line among its commands."""

    def __init__(self, text: str, words: list[Word], machine: MachineConfig) -> None:
        self._text, self._words = text, words
        self._tools = len(machine.all_tools)
        axes = {row["name"].upper() for row in machine.core_spec()["axes"]}
        self._of_moves = axes | ({"E"} if machine.extruders else set[str]()) | set("FIJ")
        laser = machine.laser
        letters = (laser.energy_letter, laser.density_letter) if laser else ()
        self._m_is_value = "M" in letters

    def commands(self) -> list[Spoken]:
        """All of them, in order."""
        found: list[Spoken] = []
        words, at = self._words, 0
        while at < len(words):
            before: list[Word] = []
            if not (_begins(words[at]) or _is_tool(words[at])):
                to = next((i for i in range(at, len(words)) if _begins(words[i])), len(words))
                before, at = words[at:to], to
                if any(word.letter in self._of_moves for word in before):
                    found.append(Spoken("", [str(word) for word in before]))
                    before = []
                elif at == len(words) and not found:
                    found.append(Spoken(str(before[0]), [str(word) for word in before[1:]]))
                if at == len(words):
                    break
            word = words[at]
            at += 1
            if _is_tool(word):
                found.append(Spoken(str(word), []))
            elif word.letter == "M" and word.number in _OF_TEXT:
                text = self._text[word.end :].strip()
                return [*found, Spoken(str(word), [text] if text else [])]
            else:
                to = self._end_of(word, at)
                code = _code(word)
                row = row_of(code)
                if row is not None and row.kind is Kind.MOTION:
                    before = []  # the interpreter's own commands have only words behind them
                own = [str(w) for w in before + words[at:to]]
                if row is not None and row.bare is None and at < to:
                    text = self._text[word.end : words[to - 1].end].strip()
                    own = [*(str(w) for w in before), text]
                if code in _BEFORE_MOVES:
                    found.append(Spoken(code, []))
                    found += [Spoken("", own)] if own else []
                else:
                    found.append(Spoken(code, own))
                at = to
        return found

    def _end_of(self, command: Word, at: int) -> int:
        """Where the command's words end: an M or T behind G0 to G3 may be one of them."""
        moves = command.letter == "G" and command.number in (0, 1, 2, 3)
        for i in range(at, len(self._words)):
            word = self._words[i]
            value = moves and word.letter == "M" and (self._m_is_value or not word.whole)
            if _begins(word) and not value:
                return i
            if moves and _is_tool(word) and 0 <= (word.number or 0) < self._tools:
                return i
        return len(self._words)


def _begins(word: Word) -> bool:
    return word.letter in "GM" and word.number is not None


def _is_tool(word: Word) -> bool:
    return word.letter == "T" and word.whole


def _code(word: Word) -> str:
    """As the dialect table writes it: G1, M862.3."""
    whole, _, minor = f"{word.number or 0:.1f}".partition(".")
    return f"{word.letter}{whole}" + (f".{minor}" if minor != "0" else "")
