"""M408: the status of the printer as one line of JSON, with the keys of RepRapFirmware."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from passo.board.reading import ABSOLUTE_ZERO_C
from passo.console.aprinter_options import OptionCommands
from passo.gcode.command import Command
from passo.gcode.parameters import ignored, number
from passo.gcode.registry import Kind, Subject, When, command
from passo.printer.status import HeaterStatus, Status
from passo.printer.status_reader import StatusReader
from passo.printer.wait_requests import Reply, Wait

if TYPE_CHECKING:
    from passo.printer.live_rig import LiveRig
    from passo.printer.power import Power

_OFF, _ACTIVE, _FAULT = 0, 2, 3  # states of a heater
_WITH_MACHINE, _WITH_PRINT = 2, 3  # S


class JsonStatus:
    """M408 of one printer."""

    def __init__(
        self, rig: LiveRig, power: Power, reader: StatusReader, options: OptionCommands
    ) -> None:
        self._rig, self._power, self._reader, self._options = rig, power, reader, options

    @command(
        "M408",
        Subject.CONSOLES,
        When.IMMEDIATE,
        "Reports the state of the printer as JSON; S2 adds the machine, S3 the print.",
        number("S", "2: also the machine, 3: also the print", default=0),
        ignored("R P"),
        kind=Kind.QUIET,
    )
    def _say(self, command: Command, reply: Reply) -> Wait | None:
        kind = command.value("S")
        status = self._reader.read()
        answer = self._common(status)
        if kind == _WITH_MACHINE:
            answer |= self._machine()
        elif kind == _WITH_PRINT:
            answer |= self._print(status)
        reply.say(json.dumps(answer, separators=(",", ":")))
        return None

    def _common(self, status: Status) -> dict[str, Any]:
        """The keys of all forms of the answer. Positions in mm, temperatures in °C, time in s;
        `pending` has the values of M926 that M930 would apply, in the units of the options."""
        rig, job = self._rig, self._rig.job
        *axes, e = rig.positions.program
        hotends = [n for n, h in rig.machine.heaters.items() if h.kind == "hotend"]
        temps: dict[str, Any] = {
            kind: dict(
                zip(("current", "active", "state"), _heater(status.heaters[name]), strict=True)
            )
            for name, kind in ((n, h.kind) for n, h in rig.machine.heaters.items())
            if kind != "hotend"
        }
        heads = [_heater(status.heaters[name]) for name in hotends]
        columns = list(zip(*heads, strict=True)) or [()] * 3
        temps["heads"] = dict(zip(("current", "active", "state"), columns, strict=True))
        return {
            "status": status.state.value,
            "coords": {
                "axesHomed": [int(i not in job.locked_axes) for i in range(len(axes))],
                "extr": [round(e, 4) + 0.0],
                "xyz": [round(at, 3) + 0.0 for at in axes],
            },
            "currentTool": status.tool,
            "params": {
                "atxPower": int(self._power.on),
                "fanPercent": [round(100 * share, 1) for share in status.fans.values()],
                **({"fanRPM": _rpm(status)} if status.fan_rpm else {}),
                "speedFactor": round(100 * status.speed_factor, 1),
                "extrFactors": [round(100 * flow, 1) for flow in status.flow_factors],
            },
            "temps": temps,
            "time": round(status.time_s, 1),
            "pending": self._options.pending_values(),
        }

    def _machine(self) -> dict[str, Any]:
        machine = self._rig.machine
        hotends = [n for n, h in machine.heaters.items() if h.kind == "hotend"]
        tools = machine.core_spec()["tools"]
        return {
            "geometry": machine.geometry.kind,
            "name": machine.name,
            "tools": [
                {
                    "number": i,
                    "heaters": [min(i, len(hotends) - 1) + 1] if hotends else [],
                    "drives": [tool["extruder"]] if tool["extruder"] >= 0 else [],
                }
                for i, tool in enumerate(tools)
            ],
        }

    def _print(self, status: Status) -> dict[str, Any]:
        statistics = self._rig.job.results.statistics()
        return {
            "currentLayer": status.job.layer if status.job else self._rig.job.program.layer,
            "extrRaw": [round(mm, 1) for mm in statistics["filament_mm"]],
            "fractionPrinted": round(100 * (status.progress or 0.0), 1),
        }


def _heater(heater: HeaterStatus) -> tuple[float, float, int]:
    """The reading, target and state of a heater. The reading is -273.1 while the sensor
    reports nothing."""
    state = _FAULT if heater.fault else _ACTIVE if heater.target_c > 0 else _OFF
    celsius = ABSOLUTE_ZERO_C if heater.current_c is None else heater.current_c
    return round(celsius, 1), round(heater.target_c, 1), state


def _rpm(status: Status) -> list[int]:
    """The revolutions per minute of all fans; -1 without a reading, as in RepRapFirmware."""
    found = (status.fan_rpm.get(name) for name in status.fans)
    return [-1 if rpm is None else round(rpm) for rpm in found]
