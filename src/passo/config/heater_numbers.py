"""The numbers of heaters in commands: a hotend has the number of the tool that it serves."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig

KINDS = {-1: "bed", -2: "chamber"}  # H of M301 to M307; 0 and up: hotends


def heater_of(machine: MachineConfig, kind: str, index: int) -> str | None:
    """The heater of a kind: a hotend by its tool's number, others by their own; None if there is
    none. Tools may share a hotend. Without tools, and after the last tool, hotends are numbered in
    the order of the file."""
    names = [name for name, heater in machine.heaters.items() if heater.kind == kind]
    if kind == "hotend" and 0 <= index < len(machine.tools):
        own = machine.tools[index].heater
        if own is not None:
            return own
        if len(names) == 1:
            return names[0]
    return names[index] if 0 <= index < len(names) else None


def number_of(machine: MachineConfig, name: str) -> int | None:
    """The H number of a heater: 0 and up for hotends, -1 for the bed, -2 for a chamber; None for a
    heater without a number, such as a second bed."""
    for number in range(max(len(machine.heaters), len(machine.tools))):
        if heater_of(machine, "hotend", number) == name:
            return number
    for number, kind in KINDS.items():
        if heater_of(machine, kind, 0) == name:
            return number
    return None
