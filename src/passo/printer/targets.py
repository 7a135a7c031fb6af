"""Sets targets of heaters, in order with the moves or at once."""

from __future__ import annotations

from collections.abc import Iterable

from passo.motion.rig import Rig
from passo.printer.power import Power


class Targets:
    """The targets of one printer's heaters. `cooled_c` has the targets, °C by heater, of heaters
    that a long pause or a fault has switched off; they are set again before the print resumes."""

    def __init__(self, rig: Rig, power: Power) -> None:
        self._rig, self._power = rig, power
        self._heaters = list(rig.machine.heaters)
        self.cooled_c: dict[str, float] = {}
        self._commanded_c: dict[str, float] = {}  # the last targets, including queued ones

    def set_target(self, heater: str, celsius: float, *, at_once: bool = False) -> None:
        """Sets a heater's target when the moves so far are done, or at once. Raises CommandError if
        the power supply is off."""
        if celsius > 0:
            self._power.require()
        self.cooled_c.pop(heater, None)
        self._commanded_c[heater] = celsius
        if at_once:
            self._rig.connection.set_target(heater, celsius)
            return
        self._rig.queue.before_moves()
        self._rig.job.outputs.mark(self._heaters.index(heater), round(celsius * 100))
        self._rig.queue.after_moves()

    def mark_reached(self, index: int, value: int) -> bool:
        """Handles a mark that print time has reached. Returns True if it belongs to a heater."""
        if index >= len(self._heaters):
            return False
        self._rig.connection.set_target(self._heaters[index], value / 100)
        return True

    def switch_off(self, heaters: Iterable[str] | None = None) -> None:
        """Switches these heaters (default: all) off at once, and again after the moves so far,
        because a queued target may switch them on until then."""
        for name in self._heaters if heaters is None else heaters:
            self.set_target(name, 0.0, at_once=True)
            self.set_target(name, 0.0)

    def switch_off_at_once(self) -> None:
        """Switches all heaters off at once, at standstill."""
        for name in self._heaters:
            self.set_target(name, 0.0, at_once=True)

    def wanted_c(self) -> dict[str, float]:
        """The targets above 0 after the moves so far, °C by heater; those of heaters that are off
        until the print resumes are included."""
        set_c = {name: loop.target for name, loop in self._rig.connection.heaters.items()}
        now_c = set_c | self._commanded_c | self.cooled_c
        return {name: celsius for name, celsius in now_c.items() if celsius > 0}

    def heat_again(self, targets_c: dict[str, float]) -> None:
        """Sets targets at once, for a print that continues; it waits for them before its next
        move."""
        for name, celsius in targets_c.items():
            self.set_target(name, celsius, at_once=True)
        self.cooled_c |= targets_c

    def plan_forgotten(self) -> None:
        """Call this when the plan is discarded, and its targets with it."""
        self.cooled_c.clear()
        self._commanded_c.clear()

    def cool(self, heater: str) -> None:
        """Switches a heater off until the print resumes."""
        self.cooled_c[heater] = self._rig.connection.heaters[heater].target
        self._rig.connection.set_target(heater, 0.0)

    def rearm_failed(self) -> None:
        """Rearms the failed heaters for which a print is paused. Call it when the user, who was
        informed, resumes the print."""
        for name in self.cooled_c:
            if self._rig.connection.heaters[name].fault is not None:
                self._rig.connection.heaters[name].rearm()
