"""The objects of a printer for clients of Klipper's socket."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from passo.config.exporting.settings import Sections
from passo.gcode.registry import When
from passo.printer.klipper.machine import webhooks
from passo.printer.klipper.objects import Object, Objects, objects

if TYPE_CHECKING:
    from passo.printer.status import Status
    from passo.web.bridge import Bridge, Snapshot
    from passo.web.klippy.subscriptions import Lookup

_HALTED = (When.IMMEDIATE, When.AHEAD)  # commands that a halted printer still executes
_MEMORY = Path("/proc/meminfo")


class PrinterObjects:
    """The objects of one printer. `endstops` has the states of the last query, True if
    triggered."""

    def __init__(self, bridge: Bridge) -> None:
        self._bridge, self._sections = bridge, Sections(bridge.machine)
        self.endstops: dict[str, bool] = {}

    @property
    def names(self) -> list[str]:
        """The names of all objects that have values."""
        return [*self._of_printer(self._bridge.latest().status), *self._of_socket()]

    def lookup(self, snapshot: Snapshot | None = None) -> Lookup:
        """A function that returns the object of a name, from this snapshot or as it is now; empty
        for an unknown name."""
        status = (snapshot or self._bridge.latest()).status
        found = self._of_printer(status) | self._of_socket()
        made: dict[str, Object] = {}

        def find(name: str) -> Object:
            if name not in made:
                made[name] = found[name]() if name in found else {}
            return made[name]

        return find

    def _of_printer(self, status: Status) -> Objects:
        return objects(self._bridge.machine, self._sections, status, status.macros)

    def _of_socket(self) -> dict[str, Any]:
        return {
            "gcode": self._gcode,
            # Numbers, as in Klipper: clients take any text for a triggered endstop.
            "query_endstops": lambda: {"last_query": {n: int(p) for n, p in self.endstops.items()}},
            "system_stats": _system_stats,
        }

    def _gcode(self) -> Object:
        ready = webhooks(self._bridge.latest().status)["state"] == "ready"
        rows = self._bridge.commands
        macros = self._bridge.machine.macros
        commands = {row.code: {"help": row.help} for row in rows if ready or row.when in _HALTED}
        own = {name.upper(): {"help": macro.description} for name, macro in macros.items()}
        return {"commands": commands | (own if ready else {})}


def _system_stats() -> Object:
    """The load of this computer, the processor time of this process in s, and free memory in kB."""
    free = 0
    if _MEMORY.exists():
        lines = _MEMORY.read_text().splitlines()
        free = next((int(line.split()[1]) for line in lines if line.startswith("MemAvail")), 0)
    times = os.times()
    return {
        "sysload": round(os.getloadavg()[0], 2),
        "cputime": round(times.user + times.system, 3),
        "memavail": free,
    }
