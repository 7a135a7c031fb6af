"""The parts of the machine."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from msgspec import Struct

from passo.config.heater_numbers import heater_of
from passo.config.inputs import button_input, sensor_input
from passo.web.call import Call
from passo.web.operation import operation
from passo.web.roles import Role

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig


class HeaterOfMachine(Struct):
    """A heater. `max_c` is the temperature above which it is switched off."""

    kind: Literal["hotend", "bed", "chamber"]
    max_c: float


class ToolOfMachine(Struct):
    """A tool: its extruder and its heater, null without one."""

    extruder: str | None
    heater: str | None


class OutputOfMachine(Struct):
    """An output that commands set; with `pwm` it also takes values between off and on."""

    pwm: bool


class LightOfMachine(Struct):
    """A coloured light: the number of its LEDs, and its `colors`, some of R, G, B and W."""

    count: int
    colors: str


class ServoOfMachine(Struct):
    """A servo: its largest angle, and the lengths of its pulses at 0° and at `max_deg`."""

    max_deg: float
    min_pulse_us: float
    max_pulse_us: float


class InputOfMachine(Struct):
    """The input of a filament sensor or a button on its pin. `part` is the name of the part in the
    machine file; `length_mm` is that of a motion sensor: at most this much filament passes between
    two pulses."""

    kind: Literal["switch", "motion", "button"]
    part: str
    pin: str
    length_mm: float | None = None


class Machine(Struct):
    """The machine as described by its file. `fans` are those that commands set; `tools` are those
    that T0, T1, … select; `accelerometer`: it has one, which measures resonances. `inputs` have the
    names of the status; `stall_axes` are those that home by the stall of a motor."""

    name: str
    description: str
    axes: list[str]
    heaters: dict[str, HeaterOfMachine]
    fans: list[str]
    tools: list[ToolOfMachine]
    accelerometer: bool
    outputs: dict[str, OutputOfMachine]
    inputs: dict[str, InputOfMachine]
    lights: dict[str, LightOfMachine]
    servos: dict[str, ServoOfMachine]
    stall_axes: list[str]


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
        outputs={
            name: OutputOfMachine(output.pwm != "none")
            for name, output in config.outputs.items()
            if not output.fixed
        },
        inputs=_inputs(config),
        lights={n: LightOfMachine(light.count, light.colors) for n, light in config.lights.items()},
        servos={
            name: ServoOfMachine(servo.max_deg, servo.min_pulse_us, servo.max_pulse_us)
            for name, servo in config.servos.items()
        },
        stall_axes=[name for name, home in config.homing.items() if home.stall],
    )


def _inputs(config: MachineConfig) -> dict[str, InputOfMachine]:
    found: dict[str, InputOfMachine] = {}
    for name, one in config.filament_sensors.items():
        if one.kind == "width":  # on analog inputs
            continue
        length_mm = one.length_mm if one.kind == "motion" else None
        found[sensor_input(name)] = InputOfMachine(one.kind, name, one.pin, length_mm)
    for name, button in config.buttons.items():
        found[button_input(name)] = InputOfMachine("button", name, button.pin)
    return found
