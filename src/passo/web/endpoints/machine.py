"""The parts of the machine."""

from __future__ import annotations

from typing import Literal

from msgspec import Struct

from passo.config.heater_numbers import heater_of
from passo.web.call import Call
from passo.web.operation import operation
from passo.web.roles import Role


class HeaterOfMachine(Struct):
    """A heater. `max_c` is the temperature above which it is switched off."""

    kind: Literal["hotend", "bed", "chamber"]
    max_c: float


class ToolOfMachine(Struct):
    """A tool: its extruder and its heater, null without one."""

    extruder: str | None
    heater: str | None


class Machine(Struct):
    """The machine as described by its file. `fans` are those that commands set; `tools` are those
    that T0, T1, … select; `accelerometer`: it has one, which measures resonances."""

    name: str
    description: str
    axes: list[str]
    heaters: dict[str, HeaterOfMachine]
    fans: list[str]
    tools: list[ToolOfMachine]
    accelerometer: bool


@operation("machine.get", "GET", "/machine", Role.VIEWER)
async def machine(call: Call) -> Machine:
    """The parts of the machine. They do not change while the machine is served."""
    config = call.bridge.machine
    return Machine(
        name=config.name,
        description=config.description,
        axes=list(config.axes),
        heaters={
            name: HeaterOfMachine(heater.kind, heater.max_c)
            for name, heater in config.heaters.items()
        },
        fans=[name for name, fan in config.fans.items() if fan.commanded],
        tools=[
            ToolOfMachine(tool.extruder, heater_of(config, "hotend", number))
            for number, tool in enumerate(config.all_tools)
        ],
        accelerometer=config.accelerometer is not None,
    )
