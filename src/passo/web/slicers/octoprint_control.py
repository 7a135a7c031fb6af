"""OctoPrint's interface: moves and temperatures. Source: OctoPrint's REST API documentation."""

from __future__ import annotations

from collections.abc import Mapping
from numbers import Real
from typing import cast

from starlette.responses import Response

from passo.errors import WebError
from passo.gcode.command import Command
from passo.web.call import Call
from passo.web.operation import operation
from passo.web.roles import Role
from passo.web.slicers.printing import posted, soon

_AXES = ("x", "y", "z")
_STATE = "_ui_octoprint"  # name under which SAVE_GCODE_STATE saves the modes
_SPEED_MM_MIN = {"x": 6000.0, "y": 6000.0, "z": 600.0}  # if the request has none
_Object = Mapping[str, object]


@operation("octoprint.printhead", "POST", "/api/printer/printhead", Role.OPERATOR, root="")
async def printhead(call: Call) -> Response:
    """Moves axes by distances in mm, with a speed in mm/min, or homes them."""
    wanted = await posted(call)
    match wanted.get("command"):
        case "home":
            axes = wanted.get("axes")
            if not isinstance(axes, list) or not set(cast("list[object]", axes)) <= set(_AXES):
                raise _malformed(f"axes is {axes!r}")
            names = [str(axis).upper() for axis in cast("list[object]", axes)]
            await soon(call.command("G28", **dict.fromkeys(names, True)))
        case "jog":
            by_mm = {axis: _number(wanted, axis) for axis in _AXES if wanted.get(axis)}
            slowest = min((_SPEED_MM_MIN[axis] for axis in by_mm), default=0.0)
            speed = _number(wanted, "speed") if wanted.get("speed") else slowest
            if by_mm:
                await soon(
                    call.commands(*_jog(by_mm, speed, absolute=bool(wanted.get("absolute"))))
                )
        case command:
            raise _malformed(f"{command!r} is not a command")
    return Response(status_code=204)


@operation("octoprint.tool", "POST", "/api/printer/tool", Role.OPERATOR, root="")
async def tool(call: Call) -> Response:
    """Sets targets of hotends, in °C, at once."""
    targets = (await _target_of(call)).get("targets")
    if not isinstance(targets, dict):
        raise _malformed("it has no targets")
    by_name = cast("dict[str, object]", targets)
    for name in by_name:
        number = name.removeprefix("tool")
        if not (number.isascii() and number.isdigit() and len(number) < 3):
            raise _malformed(f"{name} is not a tool")
        await call.command("M104", T=int(number), S=_number(by_name, name))
    return Response(status_code=204)


@operation("octoprint.bed", "POST", "/api/printer/bed", Role.OPERATOR, root="")
async def bed(call: Call) -> Response:
    """Sets the target of the bed, in °C, at once."""
    await call.command("M140", S=_number(await _target_of(call), "target"))
    return Response(status_code=204)


async def _target_of(call: Call) -> _Object:
    wanted = await posted(call)
    if wanted.get("command") != "target":
        raise _malformed(f"{wanted.get('command')!r} is not a command")
    return wanted


def _jog(by_mm: Mapping[str, float], speed_mm_min: float, *, absolute: bool) -> list[Command]:
    """Moves to absolute positions, or by relative distances, whatever the modes are."""
    given = {axis.upper(): mm for axis, mm in by_mm.items()}
    relative = {} if absolute else {"R": "".join(given)}
    return [
        Command.call("SAVE_GCODE_STATE", NAME=_STATE),
        *([Command.call("G90"), Command.call("G21")] if absolute else []),
        Command.call("G1", **given, **relative, F=speed_mm_min),
        Command.call("RESTORE_GCODE_STATE", NAME=_STATE),
    ]


def _number(of: _Object, name: str) -> float:
    value = of.get(name)
    if isinstance(value, bool) or not isinstance(value, Real):
        raise _malformed(f"{name} is {value!r}: expected a number")
    return float(value)


def _malformed(what: str) -> WebError:
    return WebError.of("web.malformed", value=what)
