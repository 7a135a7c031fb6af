"""The head for the use by its probe: moves without the limits of the plan, pulses of a servo, and
waits."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo._core import Within
from passo.board.connection import LEAD_S
from passo.config.probing import PROBE, SERVO
from passo.motion.axis_slots import X, Y, Z

if TYPE_CHECKING:
    from passo.motion.rig import Rig
    from passo.motion.triggered_moves import Interrupts, TriggeredMoves


class ProbeHead:
    """The head of one printer. Call it with the motion lock held and the machine idle. After each
    call, the machine is idle again. Methods raise MachineError, and after M108 and M410 they raise
    Stopped unless `heeds_stops` is false."""

    def __init__(self, rig: Rig, interrupts: Interrupts, triggered: TriggeredMoves) -> None:
        self._rig, self._interrupts, self._triggered = rig, interrupts, triggered
        self.heeds_stops = True

    def triggered(self) -> bool:
        """Asks the board whether the probe is triggered. Lets time pass."""
        return self._triggered.endstops.pressed(PROBE)

    @property
    def z_mm(self) -> float:
        """The Z of the nozzle in machine coordinates, mm."""
        return self._rig.job.machine_position[Z]

    async def move(
        self,
        speed_mm_s: float,
        *,
        x: float | None = None,
        y: float | None = None,
        z: float | None = None,
    ) -> None:
        """Moves the nozzle in a straight line to machine coordinates, mm; an axis without a value
        stays."""
        queue = self._rig.queue
        target = {slot: mm for slot, mm in ((X, x), (Y, y), (Z, z)) if mm is not None}
        queue.move(target, speed_mm_s, Within.ANYTHING)
        queue.flush()
        if self.heeds_stops:
            await self._triggered.standstill()
            self._interrupts.raise_if_interrupted()
        else:
            await queue.until(lambda: queue.standing or bool(self._interrupts.halted))

    async def sleep(self, seconds: float) -> None:
        """Waits; a stop in the meantime takes effect after the wait."""
        queue = self._rig.queue
        end = queue.now + seconds * queue.hz
        await queue.until(lambda: queue.now >= end or bool(self._interrupts.halted))
        if self.heeds_stops:
            self._interrupts.raise_if_interrupted()

    async def pulse(self, width_us: float, seconds: float) -> None:
        """Sends servo pulses of `width_us` for `seconds`."""
        self.pulse_at_start(width_us, seconds)
        # Wait for the end of these pulses, before the next ones can be sent.
        await self.sleep(LEAD_S + seconds + LEAD_S / 2)

    def pulse_at_start(self, width_us: float, seconds: float) -> None:
        """Like `pulse`, on boards that have just started; does not wait."""
        self._rig.connection.pulse(SERVO, width_us * 1e-6, seconds, LEAD_S)
