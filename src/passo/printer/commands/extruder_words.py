"""The names of extruders in commands."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from passo.errors import CommandError
from passo.gcode.command import numeral

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig


def extruders(machine: MachineConfig) -> Iterator[tuple[str, str]]:
    """The words that select an extruder in a command, and its name: only E if it is the only
    one."""
    tools = [tool.extruder for tool in machine.all_tools]
    for name in machine.extruders:
        if len(machine.extruders) == 1:
            yield "", name
        elif name in tools:
            yield f"T{tools.index(name)} ", name


def with_extruders(
    machine: MachineConfig, code: str, words: list[str], e: Callable[[str], float]
) -> list[str]:
    """A command with the words of the axes, and others for the extruders, each of which has its own
    value of `e`; a single extruder is in the line of the axes."""
    own = [(where, f"E{numeral(e(name))}") for where, name in extruders(machine)]
    if len(own) == 1 and not own[0][0]:
        return [" ".join([code, *words, own[0][1]])]
    return [" ".join([code, *words]), *(f"{code} {where}{word}" for where, word in own)]


def extruder_of(machine: MachineConfig, words: dict[str, float], active: int) -> str | None:
    """The extruder that E means: that of the tool T; without T that of the active tool, or the
    first extruder if that has none. Raises CommandError for a tool that does not exist."""
    tools = machine.all_tools
    tool = words.get("T", active)
    if "T" in words and tool not in range(len(tools)):
        raise CommandError.bad_value("T", tool, f"a tool below {len(tools)}")
    own = tools[int(tool)].extruder if tools else None
    return own if own or "T" in words else next(iter(machine.extruders), None)
