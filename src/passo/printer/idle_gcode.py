"""Delayed G-code of the machine file that runs when the printer has been idle."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from passo.printer.background_gcode import BackgroundGcode
    from passo.printer.commands.motors import Motors
    from passo.printer.control import Control


class IdleGcode:
    """Runs each entry with `when_idle` once when the heaters go off after an idle time, and again
    only after something else has moved or commanded the printer."""

    def __init__(self, control: Control, motors: Motors, background: BackgroundGcode) -> None:
        self._control, self._motors, self._background = control, motors, background
        self._idle_s = 0.0
        self._done = self._running = False
        control.lifetime.as_time_passes(self._time_passed)

    def _time_passed(self) -> None:
        if self._running:
            return
        control, idle_s = self._control, self._control.rig.queue.idle_s
        if idle_s < self._idle_s:
            self._done = False
        self._idle_s = idle_s
        busy = control.state.busy() or control.state.halted or control.motion_lock.locked
        if not self._done and not busy and 0 < self._motors.heaters_off_s < idle_s:
            self._done = self._running = True
            self._background.spawn(self._run())

    async def _run(self) -> None:
        for name, delayed in self._control.machine.delayed_gcode.items():
            if delayed.when_idle:
                await self._background.run(f"delayed_gcode.{name}", delayed.gcode)
        self._running, self._idle_s = False, 0.0
