"""Moves of homing: towards endstops until they trigger, and away from them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from passo._core import Within
from passo.errors import CommandError
from passo.motion.endstops import Switch, is_actuator

if TYPE_CHECKING:
    from passo.board.endstops import Endstops
    from passo.config.machine import MachineConfig
    from passo.motion.homing_parts import HomingPart
    from passo.motion.rig import Rig
    from passo.motion.triggered_moves import Interrupts, TriggeredMoves

LOST = "machine.switch-lost"  # boards have lost each other
SLOW_OVERRUN = 2.0  # the slow approach covers this multiple of the retraction


class EndstopSearch:
    """Moves axes or arms of one printer to their endstops. While `joints` is set, positions of the
    plan are those of actuators. Methods raise CommandError, MachineError, and Stopped after M108 or
    M410."""

    def __init__(self, rig: Rig, interrupts: Interrupts, triggered: TriggeredMoves) -> None:
        self._rig, self._interrupts, self._triggered = rig, interrupts, triggered
        self.joints = False

    @property
    def _machine(self) -> MachineConfig:
        return self._rig.machine

    @property
    def _endstops(self) -> Endstops:
        return self._triggered.endstops

    async def again(self, homings: Sequence[HomingPart], behind: Mapping[str, float]) -> None:
        """Moves back from the endstops, which must open, and then slowly to them. An axis that was
        `behind` its endstops moves on in the same steps until they open."""
        pressed, steps = list(homings), 0
        while pressed:
            await self.go([-w.config.retract for w in pressed], pressed)
            steps += 1
            for homing in [*pressed]:
                stuck = [s for s in homing.switches if self._endstops.pressed(s.name)]
                if not stuck:
                    pressed.remove(homing)
                elif steps * homing.config.retract >= behind[homing.name] + homing.config.retract:
                    far = steps * homing.config.retract
                    raise self.problem("machine.switch-stuck", stuck[0], far)
        slow = [SLOW_OVERRUN * w.config.retract for w in homings]
        await self.seek(homings, slow, [w.config.slow for w in homings])

    async def seek(
        self, homings: Sequence[HomingPart], travel: Sequence[float], speeds: Sequence[float]
    ) -> None:
        """Moves all axes at the same time, each at its own speed, until all their endstops are
        triggered."""
        rig = self._rig
        finest = max(speed * self._steps(w) for speed, w in zip(speeds, homings, strict=True))
        times = [t / v for t, v in zip(travel, speeds, strict=True)]

        def move() -> None:
            passed = 0.0
            for end in sorted(set(times)):
                target: dict[int, float] = {}
                square = 0.0
                for homing, time, speed in zip(homings, times, speeds, strict=True):
                    if time >= end:
                        target[homing.slot] = self._at(homing.slot) + homing.sign * speed * (
                            end - passed
                        )
                        square += speed * speed
                rig.queue.move(target, math.sqrt(square), Within.ANYTHING)
                passed = end

        switches = [switch for homing in homings for switch in homing.switches]
        overshoot = await self._triggered.run(switches, finest, move, joints=self.joints)
        self._interrupts.raise_if_interrupted()
        for homing in homings:
            for switch in homing.switches:
                if switch.name in self._endstops.expired:
                    raise self.problem(LOST, switch, 0.0)
                if switch.name not in self._endstops.hit:
                    far = travel[list(homings).index(homing)]
                    missed = "machine.stall-missed" if switch.watched else "machine.switch-missed"
                    raise self.problem(missed, switch, far)
        overshoot.measure(switches)
        for homing in homings:
            rig.job.axes.set([(homing.axis, homing.home)], triggered=True)
        rig.job.axes.set(overshoot.places())

    async def go(self, by: Sequence[float], homings: Sequence[HomingPart]) -> None:
        """Moves these axes together, each by its distance towards its endstops."""
        rig = self._rig
        target: dict[int, float] = {}
        square = 0.0
        for homing, distance in zip(homings, by, strict=True):
            target[homing.slot] = self._at(homing.slot) + homing.sign * distance
            square += homing.config.fast**2
        rig.queue.move(target, math.sqrt(square), Within.ANYTHING)
        rig.queue.flush()
        await self._triggered.standstill()
        self._interrupts.raise_if_interrupted()

    def place(self, homing: HomingPart, at: float) -> None:
        """Sets its position in the plan, without a move."""
        self._rig.job.axes.set([(homing.axis, at)])

    def problem(self, code: str, switch: Switch, limit: float) -> CommandError:
        """The error of an endstop, with a distance in mm or degrees."""
        geometry, home = self._machine.geometry, switch.home
        arm = is_actuator(self._machine, home)
        turns = arm and home in geometry.rotary
        unit = " degrees" if turns else " mm"
        return CommandError.of(
            code,
            axis=f"{'arm' if turns else 'carriage' if arm else 'axis'} {home.upper()}",
            value=f"{'driver' if switch.watched else 'switch'} {switch.label} at {switch.pin}",
            limit=f"{round(limit, 2):g}{unit}",
            position=f"{self._machine.homing[home].position:g}{unit}",
        )

    def _steps(self, homing: HomingPart) -> float:
        return max(self._machine.steppers[s].steps_per_unit for s in homing.steppers)

    def _at(self, slot: int) -> float:
        return self._rig.job.machine_position[slot]
