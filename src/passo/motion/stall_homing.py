"""Prepares motors whose drivers detect the end of the travel, and observes how far they move."""

from __future__ import annotations

from collections.abc import AsyncGenerator, Mapping, Sequence
from contextlib import asynccontextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from passo.motion.endstops import Switch
    from passo.motion.rig import Rig
    from passo.motion.triggered_moves import Interrupts, TriggeredMoves

_FLAG_S, _LOOK_S = 2.5, 0.25  # a driver shows a past stall for 2 s


@dataclass(frozen=True, slots=True)
class Detection:
    """How a driver detects stalls: with the threshold of the motor `like`, while its motor makes
    about this many microsteps per second, with another current if one is given. `pin` is the key of
    its input in the machine file."""

    like: str
    microsteps_s: float
    current_a: float | None
    pin: str


class StallDrivers(Protocol):
    """The drivers of a printer."""

    async def detect_stalls(self, wanted: Mapping[str, Detection]) -> None:
        """Writes the registers of these motors' drivers, and reads them back. Raises
        MachineError."""
        ...

    async def end_detection(self) -> None:
        """Gives the drivers back the settings from before. Raises MachineError."""
        ...


class StallHoming:
    """The stall detection of one printer, for homing. Call it with the motion lock held, while the
    machine is idle."""

    def __init__(
        self, rig: Rig, interrupts: Interrupts, triggered: TriggeredMoves, drivers: StallDrivers
    ) -> None:
        self._rig, self._interrupts = rig, interrupts
        self._triggered, self._drivers = triggered, drivers

    @asynccontextmanager
    async def detecting(self, speeds: Mapping[Switch, float]) -> AsyncGenerator[None]:
        """Within the block, the drivers of these endstops detect stalls of motors that move at
        about these speeds, in mm/s or degrees/s. Afterwards they have their settings again, also
        after an error. Raises MachineError."""
        machine, wanted = self._rig.machine, dict[str, Detection]()
        for switch, speed in speeds.items():
            stall = machine.homing[switch.home].stall
            for motor in switch.watched:
                stepper = machine.steppers[motor]
                wanted[motor] = Detection(
                    switch.watched[0],
                    speed * stepper.steps_per_unit,
                    stall.current_a if stall else None,
                    stepper.tmc.stall_key if stepper.tmc else "",
                )
        if not wanted:
            yield
            return
        try:
            await self._drivers.detect_stalls(wanted)
            yield
        finally:
            await self._drivers.end_detection()

    async def still_shown(self, switches: Sequence[Switch]) -> Switch | None:
        """Waits until no driver shows a past stall any more. Returns an endstop that is still
        triggered then. Raises MachineError, and Stopped after M108 or M410."""
        tries = int(_FLAG_S / _LOOK_S)
        for look in range(tries + 1):
            stuck = next((switch for switch in switches if self._shown(switch)), None)
            if stuck is None or look == tries:
                return stuck
            await self._rig.queue.sleep(_LOOK_S)
            self._interrupts.raise_if_interrupted()
        return None

    def _shown(self, switch: Switch) -> bool:
        return any(self._triggered.endstops.pressed(name) for name in (switch.name, *switch.also))

    def counts(self, switches: Sequence[Switch]) -> dict[str, int]:
        """The steps that the watched motors have made, forward minus backward. Asks the boards."""
        motors = {motor for switch in switches for motor in switch.watched}
        return {motor: self._rig.connection.net_steps(motor) for motor in sorted(motors)}

    def travel(self, switches: Sequence[Switch], since: Mapping[str, int]) -> float:
        """How far the watched motors have moved since these counts, mm or degrees. Asks the
        boards."""
        steppers = self._rig.machine.steppers
        return max(
            abs(count - since[motor]) / steppers[motor].steps_per_unit
            for motor, count in self.counts(switches).items()
        )
