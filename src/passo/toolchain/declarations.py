"""What the firmware's sources declare beside their code (firmware/core/declare.h)."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

Constant = int | str

_DECLARATION = re.compile(r"^DECL_(\w+)\((.*?)\);", re.DOTALL | re.MULTILINE)
_ARGUMENT = re.compile(r'\s*((?:"(?:[^"\\]|\\.)*"\s*)+|[^,"]+?)\s*(?:,|$)', re.DOTALL)
_LITERAL = re.compile(r'"((?:[^"\\]|\\.)*)"')
_SIGNATURES = {
    "COMMAND": 3,
    "REPORT": 1,
    "SHUTDOWN": 2,
    "CONSTANT": 2,
    "ENUMERATION": 3,
    "ENUMERATION_RANGE": 4,
}


class DeclarationError(ValueError):
    """A declaration that cannot be used; the message names file and declaration."""


@dataclass(frozen=True, slots=True)
class Command:
    """A command: its C function, its format, and the flags as they stand in C."""

    handler: str
    format: str
    flags: str


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
            _add(found, kind, arguments, where)
    return found


def _arguments(text: str) -> list[Constant]:
    """Strings without their quotes (adjacent ones joined), numbers, and names as they stand."""
    arguments: list[Constant] = []
    for match in _ARGUMENT.finditer(text):
        argument = match.group(1)
        if argument.startswith('"'):
            arguments.append("".join(_LITERAL.findall(argument)))
        elif re.fullmatch(r"(0x[0-9a-fA-F]+|\d+)[uUlL]*", argument):
            arguments.append(int(argument.rstrip("uUlL"), 0))
        else:
            arguments.append(argument)
    return arguments


def _add(found: Declarations, kind: str, arguments: list[Constant], where: str) -> None:
    match kind, arguments:
        case "COMMAND", [handler, text, flags]:
            if any(message_name(c.format) == message_name(str(text)) for c in found.commands):
                raise DeclarationError(f"{where}: the command is declared twice")
            found.commands.append(Command(str(handler), str(text), str(flags)))
        case "REPORT", [text]:
            if any(message_name(r) == message_name(str(text)) for r in found.reports):
                raise DeclarationError(f"{where}: the report is declared twice")
            found.reports.append(str(text))
        case "SHUTDOWN", [name, text]:
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
        case _:
            raise DeclarationError(f"{where}: an argument has the wrong type")


def _enumerate(
    found: Declarations, name: str, key: str, value: int | tuple[int, int], where: str
) -> None:
    if found.enumerations.setdefault(name, {}).setdefault(key, value) != value:
        raise DeclarationError(f"{where}: the key has another value elsewhere")


def message_name(text: str) -> str:
    """The name of a message, without its parameters."""
    return text.split(" ", 1)[0]
