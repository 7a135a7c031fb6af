"""M408: the printer's state as one line of JSON, by the keys of RepRapFirmware."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from passo.console.aprinter_options import OptionCommands
from passo.console.job_commands import JobCommands
from passo.gcode.command import Command
from passo.job.live.runner import Runner, State
from passo.printer.wait_requests import Handler, Reply, Wait

if TYPE_CHECKING:
    from passo.printer.printer import Printer

_OFF, _ACTIVE, _FAULT = 0, 2, 3  # states of a heater
_WITH_MACHINE, _WITH_PRINT = 2, 3  # S


class JsonStatus:
    """M408 of one printer."""

    def __init__(
        self, printer: Printer, runner: Runner, jobs: JobCommands, options: OptionCommands
    ) -> None:
        self._printer, self._runner = printer, runner
        self._jobs, self._options = jobs, options
        self.handlers: dict[str, Handler] = {"M408": self._say}

    def _say(self, command: Command, reply: Reply) -> Wait | None:
        kind = command.words().get("S", 0)
        status = self.status()
        if kind == _WITH_MACHINE:
            status |= self._machine()
        elif kind == _WITH_PRINT:
            status |= self._print()
        reply.say(json.dumps(status, separators=(",", ":")))
        return None

    def status(self) -> dict[str, Any]:
        """What all forms of the answer have. Positions in mm, temperatures in °C, time in s;
        `pending` are options that M926 has noted and M930 would apply, in their own units."""
        printer, job = self._printer, self._printer.job
        *axes, e = printer.positions.program
        hotends = [n for n, h in printer.machine.heaters.items() if h.kind == "hotend"]
        temps: dict[str, Any] = {
            kind: dict(zip(("current", "active", "state"), self._heater(name), strict=True))
            for name, kind in ((n, h.kind) for n, h in printer.machine.heaters.items())
            if kind != "hotend"
        }
        columns = list(zip(*(self._heater(name) for name in hotends), strict=True)) or [()] * 3
        temps["heads"] = dict(zip(("current", "active", "state"), columns, strict=True))
        return {
            "status": self._letter(),
            "coords": {
                "axesHomed": [int(i not in job.locked_axes) for i in range(len(axes))],
                "extr": [round(e, 4) + 0.0],
                "xyz": [round(at, 3) + 0.0 for at in axes],
            },
            "currentTool": job.tool,
            "params": {
                "atxPower": int(printer.mains.on),
                "fanPercent": [
                    round(100 * printer.commands.fans.get(name, 0.0), 1)
                    for name in printer.machine.fans
                ],
                "speedFactor": round(100 * job.speed_factor, 1),
                "extrFactors": [round(100 * flow, 1) for flow in job.flows],
            },
            "temps": temps,
            "time": round(max(printer.drive.now_s, 0.0), 1),
            "pending": self._options.pending_values(),
        }

    def _letter(self) -> str:
        """Halted, printing, paused (A), busy or idle."""
        printer = self._printer
        if printer.halted:
            return "H"
        if self._runner.state is State.PAUSED:
            return "A"
        if self._runner.active:
            return "P"
        return "B" if printer.turn.taken or not printer.drive.standing else "I"

    def _heater(self, name: str) -> tuple[float, float, int]:
        heater = self._printer.connection.heaters[name]
        state = _FAULT if heater.fault else _ACTIVE if heater.target > 0 else _OFF
        celsius = self._printer.connection.reading(name)
        return round(celsius, 1), round(heater.target, 1), state

    def _machine(self) -> dict[str, Any]:
        machine = self._printer.machine
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

    def _print(self) -> dict[str, Any]:
        statistics = self._printer.job.statistics()
        return {
            "currentLayer": self._printer.job.layer,
            "extrRaw": [round(mm, 1) for mm in statistics["filament_mm"]],
            "fractionPrinted": round(100 * (self._jobs.share_done() or 0.0), 1),
        }
