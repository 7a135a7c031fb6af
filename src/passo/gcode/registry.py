"""Declarations of commands: each is written once, beside its handler. The parser's checks, the
help, the reference page, and live and offline printing use it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import Enum
from importlib.util import find_spec
from math import inf
from typing import Any, NamedTuple, TypeVar

_Method = TypeVar("_Method", bound=Callable[..., Any])


class Kind(Enum):
    """The part that executes a command in a print without consoles."""

    MOTION = "motion"  # the interpreter in the core
    PRINTER = "printer"  # a handler of the job
    USER = "user"  # none: the command waits for the user, which takes no time here
    QUIET = "quiet"  # none: the command has no effect in such a print
    SERVED = "served"  # none, with a warning: the command only sets up a served printer
    PROBED = "probed"  # a served printer with simulated boards, if it has a probe; else as `SERVED`
    NOT_BUILT = "not built"  # none, with a warning; a console receives the reason


class When(Enum):
    """When a command from a console takes effect."""

    IMMEDIATE = "immediate"  # at once, even while another source moves the machine
    PLANNED = "planned"  # in order with the moves
    EXCLUSIVE = "exclusive"  # at standstill, while no other source may move the machine
    AHEAD = "ahead"  # before all lines that still wait


class Subject(Enum):
    """The section of the reference page that lists a command."""

    MOVES = "Moves"
    POSITIONS = "Positions, units and planes"
    DRILLING = "Drilling and sub-programs"
    MACROS = "Macros"
    FILAMENT = "Filament and tools"
    SPEED = "Speed and acceleration"
    HEATERS = "Heaters"
    OUTPUTS = "Fans, laser, power supply, beeper"
    MOTORS = "Motors, drivers and endstops"
    LEVELLING = "Probe and bed levelling"
    CARD = "SD card"
    PRINTS = "Prints"
    STOPS = "Stop and restart"
    SETTINGS = "Settings"
    CONSOLES = "Consoles"
    SIMULATION = "Simulation"
    NO_EFFECT = "Commands without an effect"


ANY = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"
AXES = "ABCDEHIJKUVWXYZ"  # and letters of motors


class Bounds(NamedTuple):
    """The bounds of the numbers of some letters; `limit` states them for the user."""

    letters: str
    low: float
    high: float
    limit: str


NOT_NEGATIVE_S = (Bounds("S", 0.0, inf, "0 s or more"),)


@dataclass(frozen=True, slots=True)
class Declaration:
    """A command: its code or name, the section of the reference, when it takes effect from a
    console, its parameters with units, and one sentence that describes it."""

    code: str
    subject: Subject
    when: When
    parameters: str
    text: str
    kind: Kind = Kind.PRINTER
    # letters that need no number; None: the rest of the line is a text, not words
    bare: str | None = ""
    nan: bool = False  # `S nan` is not a number, and switches the heater off
    repeats: str = ""  # letters that may be repeated
    # on a machine without the part, this text explains why the command has no effect; else `text`
    lacks: str = ""
    forced: bool = False  # with F, a line from a console acts at once
    in_turn: bool = False  # immediate on a console, but in a file it acts after the moves before it
    only_during_print: bool = False  # immediate only during a print; otherwise planned
    while_halted: bool = True  # if immediate, it also acts while the printer is halted
    package: str = ""  # a Python package that the command needs, and that may not be installed

    bounds: tuple[Bounds, ...] = ()
    # letters of values that only the machine file sets, and its table with them
    fixed: tuple[str, str] = "", ""
    not_in_files: bool = False  # it controls prints from files, so a file must not contain it

    @property
    def lacks_package(self) -> bool:
        """Whether the Python package that the command needs is not installed."""
        return bool(self.package) and find_spec(self.package) is None


class Role(Enum):
    """Which of the two handlers of a command a method is."""

    DECLARED = "declared"  # acts as the declaration says
    IN_PROGRAM = "in program"  # acts in order within a program or a line of several commands


_declared: dict[str, Declaration] = {}
_roles: dict[Callable[..., Any], tuple[tuple[str, Role], ...]] = {}
_load: list[Callable[[], object]] = []  # functions that import all modules with commands


def declare(*declarations: Declaration) -> None:
    """Adds commands that need no handler. Raises ValueError for a code that is declared already."""
    for declaration in declarations:
        if declaration.code in _declared:
            raise ValueError(f"{declaration.code} is declared twice")
        _declared[declaration.code] = declaration


def command(
    code: str,
    subject: Subject,
    when: When,
    parameters: str,
    text: str,
    *,
    kind: Kind = Kind.PRINTER,
    bare: str | None = "",
    nan: bool = False,
    repeats: str = "",
    lacks: str = "",
    forced: bool = False,
    in_turn: bool = False,
    only_during_print: bool = False,
    while_halted: bool = True,
    package: str = "",
    bounds: tuple[Bounds, ...] = (),
    fixed: tuple[str, str] = ("", ""),
    not_in_files: bool = False,
) -> Callable[[_Method], _Method]:
    """Declares a command, and marks the method that executes it; the arguments are the fields of
    Declaration. Raises ValueError for a code that is declared already."""
    declare(
        Declaration(
            *(code, subject, when, parameters, text, kind, bare, nan, repeats, lacks),
            *(forced, in_turn, only_during_print, while_halted, package, bounds, fixed),
            not_in_files,
        )
    )
    return _marked(Role.DECLARED, code)


def in_program(*codes: str) -> Callable[[_Method], _Method]:
    """Marks a method that executes these commands in order within a program. Needed if the handler
    beside the declaration acts at once, or works only on a live printer."""
    return _marked(Role.IN_PROGRAM, *codes)


def _marked(role: Role, *codes: str) -> Callable[[_Method], _Method]:
    def mark(method: _Method) -> _Method:
        _roles[method] = (*_roles.get(method, ()), *((code, role) for code in codes))
        return method

    return mark


def commands_of(part: type) -> Iterator[tuple[str, Role, str]]:
    """The commands that the methods of a class execute: code, role and name of the method."""
    for name, method in vars(part).items():
        if callable(method):
            for code, role in _roles.get(method, ()):
                yield code, role, name


def load_with(load: Callable[[], object]) -> None:
    """Registers `load`, which imports every module that declares commands. It is called before the
    whole table is read, and when a command is not found in it."""
    _load[:] = [load]


def _complete() -> None:
    while _load:
        _load.pop()()


def row_of(code: str) -> Declaration | None:
    """The declaration of a command; None for an unknown one. G1.1 is not G1."""
    if code not in _declared:
        _complete()
    return _declared.get(code)


def table() -> dict[str, Declaration]:
    """All commands by their codes: G codes, M codes, then names."""
    _complete()
    return dict(sorted(_declared.items(), key=lambda item: _order(item[0])))


def _order(code: str) -> tuple[bool, str, float, str]:
    letter, number = code[:1], code[1:]
    numbered = number.replace(".", "", 1).isdigit()
    return (not numbered, letter, float(number), "") if numbered else (True, "", 0.0, code)
