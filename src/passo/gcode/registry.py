"""Declarations of commands: each is written once, beside its handler. The parser's checks, the
help, the reference page, and live and offline printing use it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import Enum
from typing import Any, TypeVar

_Method = TypeVar("_Method", bound=Callable[..., Any])


class Kind(Enum):
    """The part that carries a command out in a print without consoles."""

    MOTION = "motion"  # the interpreter in the core
    PRINTER = "printer"  # a handler of the job
    USER = "user"  # none: the command waits for the user, which takes no time
    QUIET = "quiet"  # none, and nothing is missing
    SERVED = "served"  # none, with a warning: the command sets up a served printer
    NOT_BUILT = "not built"  # none, with a warning; a console receives the reason


class When(Enum):
    """When a command of a console acts."""

    IMMEDIATE = "immediate"  # as soon as its line is reached, also while another source moves
    PLANNED = "planned"  # in its place among the moves
    EXCLUSIVE = "exclusive"  # at standstill; no other source moves the machine meanwhile
    AHEAD = "ahead"  # before all lines that wait


class Subject(Enum):
    """The part of the reference page that a command is in."""

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
AXES = "ABCDEHIJKUVWXYZ"  # also letters of motors


@dataclass(frozen=True, slots=True)
class Declaration:
    """A command: its code or name, where the reference lists it, when it acts on a console, its
    parameters with their units, and one sentence."""

    code: str
    subject: Subject
    when: When
    parameters: str
    text: str
    kind: Kind = Kind.PRINTER
    bare: str | None = ""  # letters that need no number; None: what follows is not read as words
    nan: bool = False  # `S nan` is not a number, and switches the heater off
    repeats: str = ""  # letters that may come more than once
    lacks: str = ""  # why it has no effect on a machine without the part; otherwise `text`
    forced: bool = False  # with F a console's line acts at once
    in_turn: bool = (
        False  # immediate, but in a file, which is read ahead, after the moves before it
    )
    only_during_print: bool = False  # immediate only during a print; otherwise planned
    while_halted: bool = True  # if immediate, it acts while the printer is halted, too


class Role(Enum):
    """Which of a command's handlers a method is."""

    DECLARED = "declared"  # acts as the declaration says
    IN_PROGRAM = "in program"  # acts in its place in a program or in a line of several commands


_declared: dict[str, Declaration] = {}
_roles: dict[Callable[..., Any], tuple[tuple[str, Role], ...]] = {}
_load: list[Callable[[], object]] = []  # imports all modules that declare commands


def declare(*declarations: Declaration) -> None:
    """Adds commands that need no handler. Raises ValueError for a code that is there already."""
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
) -> Callable[[_Method], _Method]:
    """Declares a command, and marks the method that carries it out; the fields are those of
    Declaration. Raises ValueError for a code that is declared already."""
    declare(
        Declaration(
            *(code, subject, when, parameters, text, kind, bare, nan, repeats, lacks),
            *(forced, in_turn, only_during_print, while_halted),
        )
    )
    return _marked(Role.DECLARED, code)


def in_program(*codes: str) -> Callable[[_Method], _Method]:
    """Marks a method that carries these commands out in their place in a program, if the handler
    beside their declaration acts at once, or is that of a live printer."""
    return _marked(Role.IN_PROGRAM, *codes)


def _marked(role: Role, *codes: str) -> Callable[[_Method], _Method]:
    def mark(method: _Method) -> _Method:
        _roles[method] = (*_roles.get(method, ()), *((code, role) for code in codes))
        return method

    return mark


def commands_of(part: type) -> Iterator[tuple[str, Role, str]]:
    """The commands that the methods of a class carry out: code, role and name of the method."""
    for name, method in vars(part).items():
        if callable(method):
            for code, role in _roles.get(method, ()):
                yield code, role, name


def load_with(load: Callable[[], object]) -> None:
    """`load` imports every module that declares commands. It is called when a command is looked up
    that no module has declared so far, and before the whole table is read."""
    _load[:] = [load]


def _complete() -> None:
    while _load:
        _load.pop()()


def row_of(code: str) -> Declaration | None:
    """The declaration of a command, None for one that is unknown. G1.1 is not G1."""
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
