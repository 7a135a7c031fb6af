"""Stops a printer: the halt until M999, and the stop that discards all planned moves."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence

from passo.errors import MachineError, PassoError
from passo.gcode.command import Command
from passo.gcode.registry import in_program
from passo.printer.live_rig import LiveRig
from passo.printer.setup.outputs import Outputs
from passo.printer.state import State
from passo.printer.wait_requests import Reply, Wait

_log = logging.getLogger(__name__)

_MAKE_SAFE = "Make the printer safe, then send M999"  # shown after M112


class Stops:
    """The stops of one printer. `halt_listeners` are called at each request to halt, even if the
    printer is halted already. `restart_listeners` are called when a halted printer has to
    restart."""

    def __init__(self, rig: LiveRig, state: State, outputs: Outputs) -> None:
        self._rig, self._state, self._outputs = rig, state, outputs
        self.halt_listeners: list[Callable[[], None]] = []
        self.restart_listeners: list[Callable[[], None]] = []

    def halt(self, cause: PassoError, reason: str = "") -> None:
        """Switches heaters, motors and all other outputs off at once, until M999. `reason` is
        shown; the default is the text of the cause."""
        for listener in self.halt_listeners:
            listener()
        if self._state.halted:
            return
        self._state.halt(cause, reason)
        self._outputs.targets.plan_forgotten()
        self._rig.connection.switch_heaters_off()
        self._rig.connection.emergency_stop()
        self._rig.queue.await_answer()

    def emergency_stop(self) -> None:
        """M112: halts the printer."""
        stop = MachineError.of("machine.emergency-stop", hint=_MAKE_SAFE)
        self.halt(stop, stop.problems[0].sentence)

    def request_restart(self) -> None:
        """M999: a halted printer restarts, cold and not homed."""
        if self._state.halted:
            for listener in self.restart_listeners:
                listener()

    def restart(self) -> None:
        """FIRMWARE_RESTART: switches all outputs off at once, then restarts as M999."""
        self.halt(MachineError.of("machine.restart"))
        self.request_restart()

    @in_program("M112")
    def _halt_by_line(self, _: Command, __: Reply) -> Wait | None:
        """M112 that no console has detected, because it is in a file or after another command."""
        self.emergency_stop()
        return None

    @in_program("M410")
    def _stop_by_line(self, _: Command, __: Reply) -> Wait | None:
        self.stop_all("M410")
        return None

    def stop_by_endstop(self, names: Sequence[str]) -> None:
        """Called when an endstop triggers during a move: brakes, ends a running print, and switches
        all heaters off. A host that prints is asked to pause."""
        self.stop_all(f"endstop {', '.join(names)} was triggered")
        if not self._state.halted:
            self._outputs.targets.switch_off()
            off = "Heaters are off: an endstop was triggered during a move (M540)"
            self._state.announce(_log, logging.WARNING, off)
            self._state.tell("// action:pause")

    def stop_all(self, reason: str) -> None:
        """M410: brakes to a stop on the path and discards all planned moves. A running print ends,
        because it could not continue correctly. Does nothing on a halted machine."""
        if self._state.halted:
            return
        self.stop()
        for listener in self._state.stop_listeners:
            listener(reason)

    def stop(self) -> None:
        """Brakes to a stop on the path and discards all planned moves."""
        self._rig.queue.stop()
        self._rig.commands.outputs.plan_forgotten()
        self._rig.commands.follow_tool()
        self._outputs.lights.plan_forgotten()
        self._rig.commands.lights.plan_forgotten(self._outputs.lights.shown)
        self._outputs.targets.plan_forgotten()
        self._outputs.beeper.forget()
        self._outputs.laser.off()
        self._state.ended = True
