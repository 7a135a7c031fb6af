"""Moves that an endstop or a probe stops on the boards."""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Protocol

from passo.board.endstops import Endstops
from passo.motion.trigger_overshoot import TriggerOvershoot

if TYPE_CHECKING:
    from passo.motion.endstops import Switch
    from passo.motion.rig import Rig

_REST_S = 0.001  # the board samples an endstop at least this often
_FASTEST_REST_S = 5e-5
_ARMED_S = 0.005  # endstops are armed this long before the first step


def sampling_s(steps_s: float) -> float:
    """The interval at which a board samples an endstop while a motor makes `steps_s` steps a
    second: that of its steps, within bounds."""
    return min(_REST_S, max(1.0 / steps_s, _FASTEST_REST_S))


class Interrupts(Protocol):
    """Requests to end the current wait. `halted` is the reason why the printer is halted, or
    empty."""

    halted: str

    @property
    def interrupted(self) -> bool:
        """Whether M108, M410 or a halt has ended the current wait."""
        ...

    def raise_if_interrupted(self) -> None:
        """Raises Stopped after M108, M410 or a halt."""


class TriggeredMoves:
    """Executes triggered moves of one printer. The caller must hold the motion lock. `starts` are
    called before the endstops are needed.
    """

    def __init__(self, rig: Rig, interrupts: Interrupts) -> None:
        self._rig, self._interrupts = rig, interrupts
        self._order = [row["name"] for row in rig.machine.core_spec()["steppers"]]
        self._active = False
        self.starts: list[Callable[[], None]] = []
        self.reset()

    def reset(self) -> None:
        """Call this after the boards have been replaced."""
        self.endstops = Endstops(self._rig.connection)
        self._active = False

    @property
    def active(self) -> bool:
        """Whether homing or probing is in progress. Filters are off during these moves, because the
        motors must be at the plan's position when an endstop stops them. Set it only while the
        machine is idle."""
        return self._active

    @active.setter
    def active(self, active: bool) -> None:
        """Switches the filters off or on again, except while the printer is halted."""
        self._active = active
        if not self._interrupts.halted:
            self._rig.job.filters.use(not active)

    @contextmanager
    def prepared(self) -> Generator[None]:
        """Within the block, endstops may stop motors: no other part uses the motors, and no board
        brakes after a link loss."""
        for start in self.starts:
            start()
        self._rig.queue.use_commits(False)
        try:
            yield
        finally:
            if not self._interrupts.halted:
                self._rig.queue.use_commits(True)

    async def run(
        self,
        switches: Sequence[Switch],
        steps_s: float,
        move: Callable[[], None],
        *,
        joints: bool = False,
        opening: bool = False,
    ) -> TriggerOvershoot:
        """Adds moves to the plan by `move`, and executes them until each endstop has stopped its
        motors. `steps_s` is the maximum step rate, at which the boards sample the endstops (1 to 20
        kHz). With `joints`, positions of the plan are actuator positions; with `opening`, endstops
        stop motors when they open. Afterwards the machine is idle, also after M108, M410 or a halt,
        which end the moves early. `endstops` then has the triggered endstops, and `positions.lost`
        the steps that were cut off. Raises MachineError.
        """
        rig, queue = self._rig, self._rig.queue
        if not rig.positions.settled:
            rig.positions.settle()
        queue.before_moves()
        overshoot = TriggerOvershoot(rig, self.endstops, joints=joints)
        start = queue.base + int(rig.job.clock - _ARMED_S * queue.hz)
        rest_s = sampling_s(steps_s)
        stopped, also = ({s.name: s.steppers for s in switches}, {s.name: s.also for s in switches})
        self.endstops.arm(stopped, start, rest_s, opening=opening, also=also)
        move()
        queue.flush()
        try:
            await queue.until(
                lambda: self._all_hit(overshoot) or queue.standing or self._interrupts.interrupted
            )
            if not queue.standing:
                queue.stop(program=False)
                await queue.until(lambda: queue.standing or bool(self._interrupts.halted))
            self._all_hit(overshoot)
        finally:
            self.endstops.disarm()
            moved = {stepper for switch in switches for stepper in switch.steppers}
            rig.job.motors.renew([self._order.index(stepper) for stepper in moved])
        if not self._interrupts.halted:
            rig.positions.settle()
        return overshoot

    async def standstill(self) -> None:
        """Waits until the machine is idle; a stop may end the moves early."""
        queue = self._rig.queue
        await queue.until(lambda: queue.standing or self._interrupts.interrupted)
        if not queue.standing:
            queue.stop(program=False)
            await queue.until(lambda: queue.standing or bool(self._interrupts.halted))

    def _all_hit(self, overshoot: TriggerOvershoot) -> bool:
        """Whether all endstops are triggered, or one of them cannot be: its boards have lost each
        other, or its sensor has failed."""
        done = self.endstops.all_hit() or bool(self.endstops.expired or self.endstops.failed)
        overshoot.look()
        return done
