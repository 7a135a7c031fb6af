"""What moves one machine: its boards, its job and its motion queue, replaced as a whole by M999."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from passo import _core
from passo.board.boards import Boards
from passo.config.machine import MachineConfig
from passo.config.motor_roles import axis_order
from passo.motion.motion_queue import MotionQueue
from passo.motion.positions import Positions


class Rig:
    """Parts of a printer keep the rig and ask it for the others each time, since a restart of the
    boards replaces them: `connect` first, then `plan`. To be used within one event loop.

    `connection`: the boards. `job`: the interpreter and the plan. `queue`: the motion queue.
    `positions`: where the machine is.
    """

    connection: Boards
    job: _core.Job
    queue: MotionQueue
    positions: Positions

    def __init__(self, machine: MachineConfig, *, free: bool) -> None:
        self.machine = machine
        self._free = free

    def connect(self, connection: Boards) -> None:
        """These are the boards from now on; they have just been configured, or were adopted."""
        self.connection = connection

    def plan(self, on_mark: Callable[[int, int], None]) -> None:
        """An empty plan for the boards. `on_mark` is called with the number and the value of each
        mark that print time reaches."""
        self.job = _core.Job(self.machine.core_spec(), True, False, False)
        self.queue = MotionQueue(self.connection, self.job, free=self._free, on_mark=on_mark)
        self.positions = Positions(
            self.machine, self.connection, self.job, lambda: self.queue.passed
        )

    def lock(self, axes: Iterable[str]) -> None:
        """The positions of these axes are unknown from now on."""
        axes = list(axes)
        self.positions.known.difference_update(axes)
        if self.machine.unhomed_moves == "refuse":
            order = axis_order(self.machine.axes)
            for name in axes:
                self.job.lock_axis(order.index(name), True)
