"""The exceptions of Passo: each holds problems, and each problem is a row of the catalogue."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from string import Formatter
from typing import Any, Self

from passo.catalogue import CATALOGUE, Entry, ExitStatus

_LOGGED = ("axis", "value", "limit")  # values of a problem that are logged
_LONGEST_VALUE = 500  # characters; users write lines of any length
_STEERS = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f]")  # C0 and C1 (ECMA-48), but tab and line feed


def _escaped(character: re.Match[str]) -> str:
    return f"\\x{ord(character[0]):02x}"


def printable(text: str) -> str:
    """The text with the control characters of terminals as their numbers."""
    return _STEERS.sub(_escaped, text)


class _Sentence(Formatter):
    """Formats a sentence with values. Long values are cut, and control characters of terminals are
    removed; line ends stay, because a compiler may print several lines."""

    def format_field(self, value: object, format_spec: str) -> str:
        """The value as text, at most `_LONGEST_VALUE` characters and an ellipsis."""
        text = printable(str(super().format_field(value, format_spec)))
        return text if len(text) <= _LONGEST_VALUE else text[:_LONGEST_VALUE] + "…"


@dataclass(frozen=True, slots=True)
class Problem:
    """One problem: a code of the catalogue, its position in a file, and its values."""

    code: str
    file: str = ""
    line: int | None = None
    values: Mapping[str, Any] = field(default_factory=dict[str, Any])
    hint: str = ""

    @property
    def entry(self) -> Entry:
        """The row of the catalogue."""
        return CATALOGUE[self.code]

    @property
    def sentence(self) -> str:
        """The problem as a sentence, with its values."""
        return _Sentence().vformat(self.entry.says, (), self.values)

    @property
    def advice(self) -> str:
        """What to do next."""
        return self.hint or self.entry.action

    @property
    def place(self) -> str:
        """`file:line`, as editors understand it; empty without a file."""
        if not self.file or self.line is None:
            return self.file
        return f"{self.file}:{self.line}"

    def __str__(self) -> str:
        """One line: place, sentence, hint or next action."""
        head = f"{self.place}: " if self.place else ""
        end = "" if self.advice.endswith("?") else "."
        return f"{head}{self.sentence}. {self.advice}{end}"

    @property
    def log_fields(self) -> dict[str, Any]:
        """The problem for the `extra` of a log record: its code, the part of Passo or of the
        printer that it concerns, and its values."""
        about: dict[str, Any] = {"code": self.code, "part": self.entry.part}
        if self.file:
            about["file"] = self.file
        if self.line is not None:
            about["line"] = self.line
        return about | {name: self.values[name] for name in _LOGGED if name in self.values}

    def as_dict(self) -> dict[str, Any]:
        """The problem for `--json`: code, part, message, file, line, values, action."""
        return {
            "code": self.code,
            "part": self.entry.part,
            "message": str(self),
            "file": self.file,
            "line": self.line,
            "values": dict(self.values),
            "action": self.advice,
        }


class PassoError(Exception):
    """The base of errors that the user must fix. It has every problem that was found, not only the
    first. `status` is the exit status of the command line.
    """

    def __init__(self, problems: Sequence[Problem]) -> None:
        if not problems:
            raise ValueError("an error needs at least one problem")
        super().__init__("\n".join(str(problem) for problem in problems))
        self.problems = tuple(problems)
        self.status: ExitStatus = problems[0].entry.status

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickles the problems."""
        # The default pickles only the text, but another process needs the problems too.
        return _restored, (type(self), self.problems), self.__dict__

    @classmethod
    def of(
        cls,
        code: str,
        file: str = "",
        line: int | None = None,
        /,
        *,
        hint: str = "",
        **values: object,
    ) -> Self:
        """An error with one problem: a code of the catalogue, its place in a file, its values."""
        return cls([Problem(code, file, line, values, hint)])


def _restored(cls: type[PassoError], problems: Sequence[Problem]) -> PassoError:
    """Rebuilds a pickled error, independent of the arguments of its constructor."""
    error = cls.__new__(cls)
    PassoError.__init__(error, problems)
    return error


class ConfigError(PassoError):
    """A machine file or its name is wrong."""


class InputError(PassoError):
    """A G-code file is unreadable, not G-code, or demands what the machine cannot do."""


class CommandError(PassoError):
    """A command could not be executed; the printer itself has no fault."""

    @classmethod
    def bad_value(cls, word: str, value: float, limit: str) -> Self:
        """The error for a word of a command whose value is outside its limit."""
        return cls.of("command.value", axis=word, value=f"{value:g}", limit=limit)


class WordError(CommandError):
    """A word of a command is invalid: its number is missing or too large."""


class MachineError(PassoError):
    """The printer or its board failed."""


class FirmwareError(PassoError):
    """Firmware cannot be built or flashed."""


class CardError(PassoError):
    """A card or a file on it cannot be used as requested."""


class WebError(PassoError):
    """A request to the web interface is refused."""


class HubError(PassoError):
    """The hub of a farm cannot do what is asked."""


def in_words(error: BaseException) -> PassoError:
    """Returns a PassoError unchanged, and any other error as the cause of a PassoError that reports
    a fault of the program."""
    if isinstance(error, PassoError):
        return error
    fault = MachineError.of("machine.program", value=f"{type(error).__name__}: {error}")
    fault.__cause__ = error
    return fault
