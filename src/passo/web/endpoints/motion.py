"""Manual moves: jog, home, motors off."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta, Struct

from passo.config.klipper_names import stepper_object
from passo.errors import WebError
from passo.gcode.command import Command
from passo.web.call import Call
from passo.web.operation import operation
from passo.web.roles import Role


class Jog(Struct, forbid_unknown_fields=True):
    """The distances of axes, or of the extruder `e`, from the end of the last move, in mm, and the
    speed."""

    distances_mm: Annotated[
        dict[str, Annotated[float, Meta(ge=-10000, le=10000)]], Meta(min_length=1)
    ]
    speed_mm_s: Annotated[float, Meta(gt=0, le=1000)]


class AxesToHome(Struct, forbid_unknown_fields=True):
    """Axes to home; without any, all axes that have an endstop."""

    axes: list[str] = []


class MotorToTurn(Struct, forbid_unknown_fields=True):
    """A motor, by its name in the machine file."""

    motor: str


_STATE = "_ui_jog"  # name under which SAVE_GCODE_STATE saves the modes
_ERRORS = ("web.not-found", "command.halted", "command.failed", "input.not-homed", "input.cold")


@operation(
    "motion.jog",
    "POST",
    "/motion/jog",
    Role.OPERATOR,
    errors=(*_ERRORS, "input.out-of-range", "command.aside"),
)
async def jog(call: Call, body: Jog) -> None:
    """Moves axes by a distance, after the planned moves. Modes such as G91 and G20 stay as they
    are, and do not affect the distances. The answer comes when the move is planned."""
    for name in body.distances_mm:
        _require_axis(call, name, extruder=True)
    by_mm = {name.upper(): mm for name, mm in body.distances_mm.items()}
    await call.commands(
        Command.call("SAVE_GCODE_STATE", NAME=_STATE),
        Command.call("G1", **by_mm, R="".join(by_mm), F=body.speed_mm_s * 60),
        Command.call("RESTORE_GCODE_STATE", NAME=_STATE),
    )


@operation("motion.home", "POST", "/motion/home", Role.OPERATOR, errors=_ERRORS)
async def home(call: Call, body: AxesToHome) -> None:
    """Homes axes; answers when they are homed."""
    for name in body.axes:
        _require_axis(call, name, extruder=False)
    await call.command("G28", **dict.fromkeys((name.upper() for name in body.axes), True))


@operation("motion.turn_motor", "POST", "/motion/turn-motor", Role.OPERATOR, errors=_ERRORS)
async def turn_motor(call: Call, body: MotorToTurn) -> None:
    """Turns a motor 1 mm forth and back, ten times (STEPPER_BUZZ); its axis need not be homed.
    Answers when the motor is back."""
    if body.motor not in call.bridge.machine.steppers:
        raise WebError.of("web.not-found", value=f"motor {body.motor}")
    await call.command("STEPPER_BUZZ", STEPPER=stepper_object(call.bridge.machine, body.motor))


@operation("motion.wait", "POST", "/motion/wait", Role.OPERATOR, errors=("command.halted",))
async def wait(call: Call) -> None:
    """Waits until all planned moves are done (M400)."""
    await call.command("M400")


@operation(
    "motion.motors_off",
    "POST",
    "/motion/motors-off",
    Role.OPERATOR,
    errors=("command.halted", "command.failed"),
)
async def motors_off(call: Call) -> None:
    """Switches the motors off at standstill; axes are not homed any more."""
    await call.command("M18")


def _require_axis(call: Call, name: str, *, extruder: bool) -> None:
    machine = call.bridge.machine
    if name not in machine.axes and not (extruder and name == "e" and machine.extruders):
        raise WebError.of("web.not-found", value=f"axis {name}")
