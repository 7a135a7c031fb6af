"""The declarations of the firmware's sources, which are beside their code
(firmware/core/declare.h)."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

Constant = int | str

_DECLARATION = re.compile(r"^DECL_(\w+)\((.*?)\);", re.DOTALL | re.MULTILINE)
_ARGUMENT = re.compile(r'\s*((?:"(?:[^"\\]|\\.)*"\s*)+|[^,"]+?)\s*(?:,|$)', re.DOTALL)
_LITERAL = re.compile(r'"((?:[^"\\]|\\.)*)"')
_SIGNATURES = {
    "COMMAND": 3,
    "REPORT": 1,
    "SHUTDOWN_REASON": 2,
    "CONSTANT": 2,
    "ENUMERATION": 3,
    "ENUMERATION_RANGE": 4,
    "START": 1,
    "TASK": 2,
    "ON_SHUTDOWN": 1,
    "ON_CLEAR_SHUTDOWN": 1,
    "ON_POOL_EMPTY": 1,
    "WATCH": 1,
}
# The phases of the firmware's tasks, in the order in which they run.
TASK_PHASES = ("EVERY_PASS", "DEVICES", "MOTORS", "INPUTS", "BUSES", "SHUTDOWN")


class DeclarationError(ValueError):
    """A declaration is invalid; the message names the file and the declaration."""


@dataclass(frozen=True, slots=True)
class Command:
    """A command: its C function, its format, and its flags as written in C."""

    handler: str
    format: str
    flags: str


@dataclass(frozen=True, slots=True)
class Hook:
    """A C function that lower modules call. `kind` is the suffix of DECL_<kind>, `file` the name of
    the source file. For a task, `phase` is one of TASK_PHASES; otherwise it is empty."""

    kind: str
    function: str
    file: str
    phase: str = ""


@dataclass(slots=True)
class Declarations:
    """All declarations of a set of sources, in their order."""

    commands: list[Command] = field(default_factory=list[Command])
    reports: list[str] = field(default_factory=list[str])
    shutdowns: dict[str, str] = field(default_factory=dict[str, str])
    constants: dict[str, Constant] = field(default_factory=dict[str, Constant])
    enumerations: dict[str, dict[str, int | tuple[int, int]]] = field(
        default_factory=dict[str, dict[str, int | tuple[int, int]]]
    )
    hooks: list[Hook] = field(default_factory=list[Hook])

    def called(self, kind: str, phases: Sequence[str] = ("",)) -> list[str]:
        """The functions of the hooks of a kind (for tasks: of these phases) in the order of
        execution: by phase, then by file name, then in the order of declaration."""
        hooks = [hook for hook in self.hooks if hook.kind == kind and hook.phase in phases]
        hooks.sort(key=lambda hook: (phases.index(hook.phase), hook.file))
        return [hook.function for hook in hooks]


def gather(sources: Iterable[Path]) -> Declarations:
    """Reads the declarations of C sources. Raises DeclarationError for one that is malformed or
    contradicts another."""
    found = Declarations()
    for source in sources:
        for match in _DECLARATION.finditer(source.read_text(encoding="utf-8")):
            kind, arguments = match.group(1), _arguments(match.group(2))
            where = f"{source.name}: DECL_{kind}({', '.join(map(str, arguments))})"
            if _SIGNATURES.get(kind) != len(arguments):
                raise DeclarationError(f"{where}: unknown, or not as many arguments as it takes")
            _add(found, kind, arguments, source.name, where)
    return found


def _arguments(text: str) -> list[Constant]:
    """Strings without their quotes (adjacent ones joined), numbers, and names as written."""
    arguments: list[Constant] = []
    for match in _ARGUMENT.finditer(text):
        argument = match.group(1)
        if argument.startswith('"'):
            arguments.append("".join(_LITERAL.findall(argument)).replace('\\"', '"'))
        elif re.fullmatch(r"(0x[0-9a-fA-F]+|\d+)[uUlL]*", argument):
            arguments.append(int(argument.rstrip("uUlL"), 0))
        else:
            arguments.append(argument)
    return arguments


def _add(found: Declarations, kind: str, arguments: list[Constant], file: str, where: str) -> None:
    match kind, arguments:
        case "COMMAND", [handler, text, flags]:
            if any(message_name(c.format) == message_name(str(text)) for c in found.commands):
                raise DeclarationError(f"{where}: the command is declared twice")
            found.commands.append(Command(str(handler), str(text), str(flags)))
        case "REPORT", [text]:
            if any(message_name(r) == message_name(str(text)) for r in found.reports):
                raise DeclarationError(f"{where}: the report is declared twice")
            found.reports.append(str(text))
        case "SHUTDOWN_REASON", [name, text]:
            if name in found.shutdowns:
                raise DeclarationError(f"{where}: the reason is declared twice")
            found.shutdowns[str(name)] = str(text)
        case "CONSTANT", [name, value]:
            if found.constants.get(str(name), value) != value:
                raise DeclarationError(f"{where}: the constant has another value elsewhere")
            found.constants[str(name)] = value
        case "ENUMERATION", [name, key, int(value)]:
            _enumerate(found, str(name), str(key), value, where)
        case "ENUMERATION_RANGE", [name, key, int(first), int(count)]:
            _enumerate(found, str(name), str(key), (first, count), where)
        case "TASK", [str(function), str(phase)]:
            if phase not in TASK_PHASES:
                raise DeclarationError(f"{where}: the phase is not one of {', '.join(TASK_PHASES)}")
            _hook(found, Hook(kind, function, file, phase), where)
        case _, [str(function)]:
            _hook(found, Hook(kind, function, file), where)
        case _:
            raise DeclarationError(f"{where}: an argument has the wrong type")


def _hook(found: Declarations, hook: Hook, where: str) -> None:
    if not hook.function.isidentifier():
        raise DeclarationError(f"{where}: '{hook.function}' is not the name of a function")
    if hook.function in (other.function for other in found.hooks if other.kind == hook.kind):
        raise DeclarationError(f"{where}: the function is declared twice")
    found.hooks.append(hook)


def _enumerate(
    found: Declarations, name: str, key: str, value: int | tuple[int, int], where: str
) -> None:
    if found.enumerations.setdefault(name, {}).setdefault(key, value) != value:
        raise DeclarationError(f"{where}: the key has another value elsewhere")


def message_name(text: str) -> str:
    """The name of a message, without its parameters."""
    return text.split(" ", 1)[0]
