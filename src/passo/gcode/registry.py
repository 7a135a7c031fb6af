"""Declarations of commands: each is written once, beside its handler. The parser's checks, the
help, the reference page, and live and offline printing use it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from enum import Enum
from importlib.util import find_spec
from typing import Any, TypeVar

from passo.gcode.parameters import Form, Parameter, shown

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


@dataclass(frozen=True, slots=True)
class Declaration:
    """A command: its code or name, the section of the reference, when it takes effect from a
    console, one sentence that describes it, and its parameters."""

    code: str
    subject: Subject
    when: When
    text: str
    parameters: tuple[Parameter, ...] = ()
    kind: Kind = Kind.PRINTER
    # on a machine without the part, this text explains why the command has no effect; else `text`
    lacks: str = ""
    forced: bool = False  # with F, a line from a console acts at once
    in_turn: bool = False  # immediate on a console, but in a file it acts after the moves before it
    only_during_print: bool = False  # immediate only during a print; otherwise planned
    while_halted: bool = True  # if immediate, it also acts while the printer is halted
    package: str = ""  # a Python package that the command needs, and that may not be installed
    not_in_files: bool = False  # it controls prints from files, so a file must not contain it
    # raises CommandError for parameters that are wrong on a machine: the command, the machine
    valid: Callable[[Any, Any], object] | None = None

    by_name: dict[str, Parameter] = field(default_factory=dict[str, Parameter], init=False)
    """The parameters by letter or key."""

    def __post_init__(self) -> None:
        """Fills `by_name`; a letter of its own counts before one of all axes."""
        for parameter in self.parameters:
            self.by_name.update(dict.fromkeys(parameter.names, parameter))
        for parameter in self.parameters:
            for letter in parameter.also:
                self.by_name.setdefault(letter, parameter)

    @property
    def takes_text(self) -> bool:
        """Whether the rest of the line is a text, not words."""
        return any(parameter.form is Form.REST for parameter in self.parameters)

    @property
    def takes_anything(self) -> bool:
        """Whether every letter is accepted, with or without a number."""
        return any(parameter.form is Form.ANYTHING for parameter in self.parameters)

    @property
    def usage(self) -> str:
        """The parameters in one line."""
        return " ".join(parameter.usage for parameter in shown(self.parameters))

    @property
    def help(self) -> str:
        """What the command does, and its parameters."""
        return f"{self.text} Parameters: {self.usage}" if self.usage else self.text

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
    text: str,
    *parameters: Parameter,
    kind: Kind = Kind.PRINTER,
    lacks: str = "",
    forced: bool = False,
    in_turn: bool = False,
    only_during_print: bool = False,
    while_halted: bool = True,
    package: str = "",
    not_in_files: bool = False,
    valid: Callable[[Any, Any], object] | None = None,
) -> Callable[[_Method], _Method]:
    """Declares a command, and marks the method that executes it; the arguments are the fields of
    Declaration. Raises ValueError for a code that is declared already."""
    declare(
        Declaration(
            *(code, subject, when, text, parameters, kind, lacks, forced, in_turn),
            *(only_during_print, while_halted, package, not_in_files, valid),
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
