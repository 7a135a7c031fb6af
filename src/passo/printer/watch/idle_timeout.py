"""Idle timeouts: switch motors, heaters and laser off; M85 halts the printer."""

from __future__ import annotations

import logging
from collections.abc import Callable

from passo.errors import MachineError
from passo.printer.commands.user_prompts import UserPrompts
from passo.printer.live_rig import LiveRig
from passo.printer.motion_lock import MotionLock
from passo.printer.setup.outputs import Outputs
from passo.printer.state import State
from passo.printer.wait_runner import WaitRunner

_log = logging.getLogger(__name__)

LASER_OFF_S = 3.0  # standstill with the laser on, without a print


class IdleWatch:
    """The idle timeouts of one printer: `[idle]` of the machine file, M84 S, M85 and
    SET_IDLE_TIMEOUT."""

    def __init__(
        self,
        rig: LiveRig,
        state: State,
        motion_lock: MotionLock,
        outputs: Outputs,
        prompts: UserPrompts,
        waits: WaitRunner,
        halt: Callable[[MachineError, str], None],
    ) -> None:
        self._rig, self._state, self._motion_lock = rig, state, motion_lock
        self._motors, self._laser = outputs.motors, outputs.laser
        self._targets = outputs.targets
        self._prompts, self._waits, self._halt = prompts, waits, halt

    def time_passed(self) -> None:
        """Call this as time passes: switches off parts that have been idle for too long."""
        rig, waits = self._rig, self._waits
        idle_s, heaters_off_s = rig.queue.idle_s, self._motors.heaters_off_s
        heaters = rig.connection.heaters
        waits_for_user = (rig.job.stops.suspended or waits.person) and not waits.heating
        if waits_for_user and 0 < heaters_off_s < idle_s:
            self._cool_hotends()
        if self._state.busy() or self._motion_lock.locked:
            return
        # While a heater is on, a host may have paused its print, which must not lose the position.
        warm = any(heater.target > 0 for heater in heaters.values())
        motors_off = 0 < self._motors.idle_s < idle_s and bool(self._motors.on) and not warm
        if rig.commands.outputs.laser_stays_on and (idle_s > LASER_OFF_S or motors_off):
            self._laser.off()
            self._note("Laser off after an idle time; M3 switches it on again")
            return
        if motors_off:
            self._motors.all_off()
            self._note("Motors off after an idle time; home before the next move")
        if 0 < self._prompts.kill_s < idle_s:
            idle = MachineError.of("machine.idle", value=self._prompts.kill_s)
            self._halt(idle, idle.problems[0].sentence)
        if 0 < heaters_off_s < idle_s:
            for name, heater in heaters.items():
                if heater.target > 0:
                    self._targets.set_target(name, 0.0, at_once=True)
                    self._note(f"Heater {name} off after an idle time")

    def _cool_hotends(self) -> None:
        """Switches the hotends off in a long pause, so that filament does not degrade. The bed
        stays warm, because it holds the part."""
        for name, config in self._rig.machine.heaters.items():
            if config.kind == "hotend" and self._rig.connection.heaters[name].target > 0:
                self._targets.cool(name)
                self._note(
                    f"Heater {name} off in a long pause; it warms up before the print resumes"
                )

    def _note(self, text: str) -> None:
        self._state.announce(_log, logging.INFO, text)
