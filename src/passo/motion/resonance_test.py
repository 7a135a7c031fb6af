"""Vibrates the head along a line, while an accelerometer measures it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from math import hypot
from typing import TYPE_CHECKING

from passo._core import Within
from passo.board.accelerometers import AccelerometerReader
from passo.config.motor_roles import axis_order
from passo.config.shapers import Impulses
from passo.errors import CommandError
from passo.motion.axis_slots import E, X, Y, Z, slot_of_axis
from passo.resonance.excitation import Excitation, shaped, swings
from passo.resonance.measurement import Measurement

if TYPE_CHECKING:
    from passo.errors import Problem
    from passo.motion.bed_correction import BedCorrection
    from passo.motion.rig import Rig
    from passo.motion.triggered_moves import Interrupts, TriggeredMoves

_Piece = tuple[float, list[list[float]]]

_UNSHAPED: Impulses = [(1.0, 0.0)]
_MOVE_MM_S = 50.0
_BRAKE_MM_S2 = 3000.0
_SETTLE_S = 0.5  # before the vibration
_AHEAD_S = 0.7  # of planned motion: a stop comes so late, and Python may stall so long
_SEGMENTS = 64  # added at once
_POLL_S = 0.1
_MAX_LOST = 0.02  # of all samples


@dataclass(frozen=True, slots=True)
class Direction:
    """The axis of a measurement, as the command names it, and its unit vector."""

    name: str
    x: float
    y: float
    z: float


def direction(text: str) -> Direction:
    """The direction that AXIS names: x, y, z, or DX,DY or DX,DY,DZ. Raises CommandError."""
    name = text.lower()
    if name in ("x", "y", "z"):
        return Direction(name, *(float(name == axis) for axis in "xyz"))
    try:
        parts = [float(part) for part in text.split(",")]
    except ValueError:
        parts = []
    length = hypot(*parts)
    if len(parts) not in (2, 3) or not 0 < length < float("inf"):
        limit = "X, Y, Z, or a direction such as 1,-1"
        raise CommandError.of("command.value", axis="AXIS", value=text or "missing", limit=limit)
    x, y, z = (part / length for part in [*parts, 0.0][:3])
    return Direction(f"axis={','.join(f'{part:.3f}' for part in (x, y, z))}", x, y, z)


class ResonanceTest:
    """Makes measurements on one printer. The caller must hold the motion lock, and the machine must
    be idle. `problem` returns the error at which the job stopped. Methods raise CommandError,
    Stopped after M108 or M410, and MachineError."""

    def __init__(
        self,
        rig: Rig,
        interrupts: Interrupts,
        triggered: TriggeredMoves,
        correction: BedCorrection,
        problem: Callable[[], Problem],
    ) -> None:
        self._rig, self._interrupts = rig, interrupts
        self._triggered, self._correction = triggered, correction
        self._problem = problem

    async def still(self, seconds: float) -> Measurement:
        """Measures while nothing moves."""
        reader = self._reader()
        try:
            reader.start()
            await self._rig.queue.catch_up()
            start_s = self._rig.queue.now_s
            await self._pass(reader, seconds)
            return self._taken(reader, start_s, self._rig.queue.now_s)
        except BaseException:
            reader.cancel()
            raise

    async def go_to(self, point: Sequence[float]) -> None:
        """Moves the nozzle to X, Y, Z of `point`, mm."""
        rig = self._rig
        order = axis_order(rig.machine.axes)
        for name in "xyz":
            if order.index(name) in rig.job.locked_axes:
                raise CommandError.of("input.not-homed", axis=name.upper())
        if not rig.queue.move(dict(zip((X, Y, Z), point, strict=True)), _MOVE_MM_S, Within.LIMITS):
            raise CommandError([self._problem()])
        rig.queue.flush()
        await self._triggered.standstill()
        self._interrupts.raise_if_interrupted()

    async def vibrate(
        self, along: Direction, excitation: Excitation, shapers: Mapping[str, Impulses]
    ) -> Measurement:
        """Vibrates the head around its present position, and returns the measurement. `shapers` are
        those of axes that shape the motion."""
        rig, queue = self._rig, self._rig.queue
        self._check_reach(along, excitation)
        reader = self._reader()
        self._triggered.active = True
        try:
            with self._correction.suspended(), self._triggered.prepared():
                reader.start()
                await queue.catch_up()
                await self._pass(reader, _SETTLE_S)
                queue.before_moves()
                from_s = rig.job.clock / queue.hz
                await self._run(reader, self._pieces(along, excitation, shapers))
                until_s = rig.job.clock / queue.hz
                await self._triggered.standstill()
                self._interrupts.raise_if_interrupted()
                await self._pass(reader, _POLL_S)
                return self._taken(reader, from_s, until_s)
        except BaseException:
            reader.cancel()
            raise
        finally:
            self._triggered.active = False

    def _reader(self) -> AccelerometerReader:
        """The reader of the accelerometer, wherever it is."""
        connections = self._rig.connection.connections
        connection, part = next((c, a) for c in connections for a in c.board.accelerometers)
        return AccelerometerReader(connection, part, self._rig.queue.base)

    def _taken(self, reader: AccelerometerReader, start_s: float, end_s: float) -> Measurement:
        """Stops the reader, and returns the samples of a span. Raises CommandError if too many are
        missing."""
        found = reader.stop()
        for code, lost in (
            ("resonance.lost", reader.lost),
            ("resonance.overflow", reader.overflows),
        ):
            if lost > _MAX_LOST * found.count:
                limit = f"{_MAX_LOST:.0%}"
                raise CommandError.of(code, value=lost, all=found.count, limit=limit)
        return found.between(start_s, end_s)

    async def _pass(self, reader: AccelerometerReader, seconds: float) -> None:
        """Lets time pass while the reader collects samples."""
        end_s = self._rig.queue.now_s + seconds
        while (left := end_s - self._rig.queue.now_s) > 0:
            await self._wait(min(_POLL_S, left))
            self._interrupts.raise_if_interrupted()
            reader.poll()

    async def _wait(self, seconds: float) -> None:
        queue = self._rig.queue
        end = queue.now + seconds * queue.hz
        await queue.until(lambda: queue.now >= end or bool(self._interrupts.halted))

    def _check_reach(self, along: Direction, excitation: Excitation) -> None:
        """Raises CommandError if the vibration leaves the range of an axis."""
        reach = excitation.reach_mm
        position = self._rig.job.machine_position
        for slot, (name, share) in enumerate(zip("xyz", (along.x, along.y, along.z), strict=True)):
            axis, needs, at = self._rig.machine.axes[name], reach * abs(share), position[slot]
            for limit, room in ((axis.min_mm, at - axis.min_mm), (axis.max_mm, axis.max_mm - at)):
                if needs > room:
                    raise CommandError.of(
                        "resonance.reach",
                        axis=name.upper(),
                        value=needs,
                        position=round(at, 3),
                        limit=limit,
                    )

    def _pieces(
        self, along: Direction, excitation: Excitation, shapers: Mapping[str, Impulses]
    ) -> Iterator[_Piece]:
        """The motion in the form of the core: seconds, then a quadratic for each axis and for E."""
        job = self._rig.job
        position = job.machine_position
        slots = [slot_of_axis(i) for i in range(len(self._rig.machine.axes))]
        used = [shapers.get(name, _UNSHAPED) for name in "xyz"]
        share = (along.x, along.y, along.z)
        for seconds, laws in shaped(list(swings(excitation)), used):
            rows = [[position[slot]] for slot in (*slots, E)]
            for axis, (law, part) in enumerate(zip(laws, share, strict=True)):
                if part:
                    rows[axis] = [c * part for c in law]
                    rows[axis][0] += position[axis]
            yield seconds, rows

    async def _run(self, reader: AccelerometerReader, pieces: Iterator[_Piece]) -> None:
        """Plans the motion a little ahead of time. After M410 or M108 the head brakes."""
        queue = self._rig.queue
        last: _Piece | None = None
        while True:
            while queue.ahead_s < _AHEAD_S:
                chunk = list(islice(pieces, _SEGMENTS))
                if not chunk:
                    queue.flush()
                    return
                queue.on_motion()
                self._add(chunk)
                last = chunk[-1]
            await self._wait(_POLL_S)
            if self._interrupts.halted:
                return
            if self._interrupts.interrupted and last is not None:
                self._add(_brake(last))
                queue.flush()
                return
            reader.poll()

    def _add(self, pieces: list[_Piece]) -> None:
        try:
            self._rig.job.plan.add_pieces(pieces)
        except ValueError as error:  # too fast for a motor, or out of reach of an arm
            raise CommandError.of("resonance.motion", value=str(error)) from None


def _brake(last: _Piece) -> list[_Piece]:
    """A stop after a piece."""
    seconds, rows = last
    ends: list[tuple[float, float]] = []
    for row in rows:
        mm, mm_s, half = [*row, 0.0, 0.0][:3]
        ends.append((mm + seconds * (mm_s + seconds * half), mm_s + 2 * seconds * half))
    speed = hypot(*(mm_s for _, mm_s in ends))
    stop_s = speed / _BRAKE_MM_S2
    if not stop_s:
        return []
    return [(stop_s, [[mm, mm_s, -mm_s / (2 * stop_s)] for mm, mm_s in ends])]
