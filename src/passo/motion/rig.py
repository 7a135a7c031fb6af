"""The parts that move one machine: boards, job and motion queue. M999 replaces them as a whole."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable
from contextlib import contextmanager

from passo import _core
from passo.board.boards import Boards
from passo.config.machine import MachineConfig
from passo.config.motor_roles import axis_order
from passo.geometry.base import Unreachable
from passo.motion.axis_slots import X, Y, Z
from passo.motion.motion_queue import MotionQueue
from passo.motion.positions import Positions

_SAME_MM = 1e-9  # positions that differ by less are the same


class Rig:
    """The current boards, job and queue of a printer. Other parts keep the rig and read these from
    it each time, because a restart of the boards replaces them: first by `connect`, then by `plan`.
    Use it within one event loop. `machine` is the machine file with the active geometry and
    endstops, `connection` the boards, `job` the interpreter and the plan, `queue` the motion queue,
    and `positions` the real position of the machine.
    """

    connection: Boards
    job: _core.Job
    queue: MotionQueue
    positions: Positions

    def __init__(self, machine: MachineConfig, *, free: bool) -> None:
        self.machine = machine
        self._free = free

    def connect(self, connection: Boards) -> None:
        """Sets the boards, which have just been configured or adopted."""
        self.connection = connection

    def plan(self, on_mark: Callable[[int, int], None]) -> None:
        """Makes an empty plan for the boards. `on_mark` is called with the number and the value of
        each mark when print time reaches it."""
        self.job = _core.Job(self.machine.core_spec(), True, False, False)
        self.queue = MotionQueue(self.connection, self.job, free=self._free, on_mark=on_mark)
        self.positions = Positions(
            self.machine, self.connection, self.job, lambda: self.queue.passed
        )

    def planned_s(self) -> float:
        """Print time of all motion and dwell that was planned so far, seconds."""
        plan = self.job.results.statistics()
        return plan["move_s"] + plan["dwell_s"]

    def use_geometry(self, machine: MachineConfig) -> None:
        """Activates `machine`, which may differ from the present one in the parameters of the
        geometry and the positions of the endstops. No motor moves: the new geometry gives new axis
        positions, and homed axes stay homed. Call it only while no move is queued. Raises
        Unreachable, without any change, if the motors of homed axes are at a position that the new
        geometry cannot have."""
        old, job = self.machine, self.job
        if machine.geometry == old.geometry and not machine.axes_of_arms:
            self.machine = self.positions.machine = machine
            return
        locked = set(job.locked_axes)
        x, y, z, *_ = job.machine_position
        nozzle = x, y, job.bed.nozzle_height(x, y, z)
        moved = [
            machine.homing[name].position - old.homing[name].position
            if name in old.geometry.arms and name in old.homing
            else 0.0
            for name in old.geometry.actuators
        ]
        home = machine.home_point
        try:
            joints = zip(old.geometry.inverse(nozzle), moved, strict=True)
            place = machine.geometry.forward([q + by for q, by in joints])
            # a delta's rods also meet at places that its nozzle must not reach
            machine.geometry.inverse(place)
        except Unreachable:
            if not locked & {X, Y, Z}:
                raise
            place = home
        self.machine = self.positions.machine = machine
        job.axes.set_geometry(machine.geometry.spec())
        if machine.axes_of_arms:
            job.axes.set(list(enumerate(home)), homed=True)
        x, y, height = place
        after = x, y, job.bed.plan_z(x, y, height)
        before = job.machine_position
        job.axes.set([(i, mm) for i, mm in enumerate(after) if abs(mm - before[i]) > _SAME_MM])
        for axis in locked:
            job.axes.lock(axis, True)

    @contextmanager
    def square(self, halted: Callable[[], bool]) -> Generator[None]:
        """Switches the skew off within the block: axis positions are those of the endstops."""
        skewed = self.machine
        square = skewed.geometry.square
        if square == skewed.geometry:
            yield
            return
        self.use_geometry(skewed.model_copy(update={"geometry": square}))
        try:
            yield
        finally:
            if halted():
                self.machine = skewed
            else:
                self.use_geometry(skewed)

    def lock(self, axes: Iterable[str]) -> None:
        """Marks these axes as not homed."""
        axes = list(axes)
        self.positions.known.difference_update(axes)
        if self.machine.unhomed_moves == "refuse":
            order = axis_order(self.machine.axes)
            for name in axes:
                self.job.axes.lock(order.index(name), True)
