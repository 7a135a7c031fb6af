"""The names of extruders in commands."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from passo.errors import CommandError
from passo.gcode.command import numeral

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig


def extruders(machine: MachineConfig) -> Iterator[tuple[str, str]]:
    """For each extruder, the words that select it in a command, and its name: just E if the machine
    has only one."""
    tools = [tool.extruder for tool in machine.all_tools]
    for name in machine.extruders:
        if len(machine.extruders) == 1:
            yield "", name
        elif name in tools:
            yield f"T{tools.index(name)} ", name


def with_extruders(
    machine: MachineConfig, code: str, words: list[str], e: Callable[[str], float]
) -> list[str]:
    """A line with the words of the axes, then a line for each extruder with its value of `e`. If
    there is only one extruder, its word is in the first line."""
    own = [(where, f"E{numeral(e(name))}") for where, name in extruders(machine)]
    if len(own) == 1 and not own[0][0]:
        return [" ".join([code, *words, own[0][1]])]
    return [" ".join([code, *words]), *(f"{code} {where}{word}" for where, word in own)]


def extruder_of(machine: MachineConfig, words: dict[str, float], active: int) -> str | None:
    """The extruder that E selects: that of tool T, else that of the active tool, else the first
    extruder. Raises CommandError for a tool that does not exist."""
    tools = machine.all_tools
    tool = words.get("T", active)
    if "T" in words and tool not in range(len(tools)):
        raise CommandError.bad_value("T", tool, f"a tool below {len(tools)}")
    own = tools[int(tool)].extruder if tools else None
    return own if own or "T" in words else next(iter(machine.extruders), None)
