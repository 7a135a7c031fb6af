"""Advances print time: sends moves to the boards, settles plans, ends waits."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from passo._core import Within
from passo.config.budget import COMMIT_S
from passo.errors import MachineError
from passo.motion.axis_slots import SLOTS

if TYPE_CHECKING:
    from passo import _core
    from passo.board.boards import Boards

TICK_S = 0.01  # host time between two checks of the board in real time
HORIZON_S = 0.16  # of print time ahead that is on the board and cannot be recalled
COMMITS_AHEAD_S = 0.2  # the same for motion in commits, minus the time to notice a link loss
_SHARE_OF_SLOTS = 4  # a commit takes at most 1/4 of the move queue
# a plan with less time left is settled for a stop, because Python may stall for 0.5 s
RUNNING_DRY_S = 0.9
TAKE_BACK_S = 1.0  # if more moves have arrived, that stop is cancelled at this distance
LEAD_S = 0.2  # from a command at standstill to its first step
SOON_S = 0.3  # for a fan, a time this near counts as now
MIN_LEAD_S = 0.05  # less than LEAD_S - GATHER_S
GATHER_S = 0.08  # host time at standstill to wait for more moves before the plan starts
BUFFER_S = 2.0  # of print time ahead; a console that sends more must wait
MAX_QUEUED = 2048  # moves that wait for look-ahead
_SAME_MM = 1e-6
_STRIDE_S = 0.25  # print time between two checks in free time


@dataclass(slots=True)
class Alarm:
    """An action that is due at a print time, in ticks."""

    clock: int
    action: Callable[[], None]


class MotionQueue:
    """Lets print time pass for the boards and the plan of one machine. One task runs `run`; other
    calls come from the same event loop.

    Print time follows the clock of a live board, or the event loop if boards are simulated. If time
    is `free`, it passes as fast as possible, but only while a command waits for it, or while moves
    are left and no host has just sent a line. It does not pass while a command waits only for the
    user.
    """

    def __init__(
        self,
        connection: Boards,
        job: _core.Job,
        *,
        free: bool,
        on_mark: Callable[[int, int], None],
    ) -> None:
        self._connection, self._job, self._free = connection, job, free
        self._on_mark = on_mark
        # called before moves are sent to the board
        self.on_motion: Callable[[], None] = lambda: None
        self.on_pass: Callable[[], None] = lambda: None  # whenever time has passed
        self.hz = connection.board.clock_hz
        self.horizon_s = HORIZON_S
        self.interrupted = False  # boards have braked without the host, at an unknown position
        # boards that lose the host brake, and keep their heaters on for a minute
        self.commits = False
        if connection.survives:
            self.horizon_s = COMMITS_AHEAD_S + TICK_S
            connection.use_commits(COMMITS_AHEAD_S)
        self.base = connection.start_job(job)
        self.use_commits(True)
        self._loop = asyncio.get_running_loop()
        self._start_s = self._loop.time()
        self._start_clock = connection.now
        # Print time, ticks, up to which boards and marks are processed. On a busy computer it lags
        # behind the wall clock.
        self.passed = self.now
        self._waiting: list[tuple[Callable[[], bool], asyncio.Future[None], bool]] = []
        self._alarms: list[Alarm] = []
        self._woken = _Wake()
        self._first_move_s: float | None = None
        self._stop_clock = -1.0  # end of a plan that was settled only because no more moves came
        self._heard_s = 0.0
        self._dirty = False
        self._awaited = False  # a task waits for an answer of the board
        self._closed = False

    @property
    def now(self) -> int:
        """Print time in ticks of the job's clock."""
        if self._free or self._connection.live:
            return self._connection.now - self.base
        passed = self._loop.time() - self._start_s
        return self._start_clock + int(passed * self.hz) - self.base

    @property
    def board_now(self) -> int:
        """The present time in ticks of the main board's clock, also while its link is lost."""
        return max(self.base + self.now, self._connection.now)

    @property
    def now_s(self) -> float:
        """Print time in seconds."""
        return self.now / self.hz

    @property
    def standing(self) -> bool:
        """Whether all moves are done, and all heater targets of the plan are set. It uses the print
        time that is processed already, because events after it have not happened yet."""
        job = self._job
        planned = job.plan.queued == 0 and job.clock <= self.passed and not job.stops.holds
        planned = planned and job.outputs.next_mark is None
        if not planned or not self._connection.survives:
            return planned
        # Moves that the board does not have yet will be late, and the board will report that.
        return not self.interrupted and self._connection.delivered

    @property
    def idle(self) -> bool:
        """Whether no move or dwell is in progress or planned. A command whose time is reserved, but
        whose first step is not due yet, counts as a move."""
        job, now = self._job, max(self.passed, 0)  # the job starts a moment after the boards
        if self.standing:
            return True
        if job.plan.queued > 0 or job.stops.holds or job.clock > now + LEAD_S * self.hz:
            return False
        at = job.history.position_at(now)
        return at is not None and math.dist(at, job.machine_position) < _SAME_MM

    @property
    def idle_s(self) -> float:
        """Host time in seconds since the last move or command; 0 during a move."""
        if not self.standing:
            self._heard_s = self._loop.time()
        return self._loop.time() - self._heard_s

    @property
    def ahead_s(self) -> float:
        """Print time from now to the end of the settled plan, seconds."""
        return (self._job.clock - self.now) / self.hz

    @property
    def full(self) -> bool:
        """Whether the plan reaches far enough ahead, so that callers must wait."""
        job = self._job
        ahead = job.clock - self.now + job.plan.queued_ticks
        return ahead > BUFFER_S * self.hz or job.plan.queued > MAX_QUEUED

    def before_moves(self) -> None:
        """Call this before adding to the plan: if the machine is idle, the plan restarts at the
        present time."""
        self._heard_s = self._loop.time()
        job = self._job
        if job.plan.queued == 0 and job.clock <= self.now + LEAD_S / 2 * self.hz:
            job.plan.wait_until(self.now + LEAD_S * self.hz)
            self._first_move_s = self._heard_s

    def after_moves(self) -> None:
        """Call after adding to the plan."""
        self._dirty = True
        self._woken.set()

    def move(
        self,
        target: Mapping[int, float],
        speed_mm_s: float,
        within: Within = Within.LIMITS,
    ) -> bool:
        """Adds a straight move to `target`: machine coordinates in mm by axis index; other axes
        stay. Returns False without a move if it is too long or, with `within`, beyond the limits;
        the error of the job has the reason."""
        places = [target.get(slot, math.nan) for slot in range(SLOTS)]
        self.before_moves()
        reached = self._job.plan.move_to(places, speed_mm_s, within)
        self.after_moves()
        return reached

    def flush(self) -> None:
        """Settles the whole plan: the machine stops at its end."""
        if self._job.plan.queued > 0:
            self.on_motion()
        self._begin_in_time()
        self._job.flush()
        self.after_moves()

    def replan(self) -> None:
        """Replans the moves that the board does not have yet, by the current limits."""
        self._job.plan.replan_from(self.first_changeable)
        self._replanned()

    def shift(self, axis: int, mm: float) -> bool:
        """Offsets all moves that the board does not have yet along an axis, by `mm`. Returns False
        if that is out of range; the error of the job has the reason."""
        self.before_moves()
        if self._job.plan.shift_from(self.first_changeable, axis, mm) is None:
            return False
        self._replanned()
        return True

    def scale_flow(self, extruder: int, factor: float) -> None:
        """Sets the flow factor of an extruder, for the moves that the board does not have yet and
        for all later ones."""
        self.before_moves()
        self._job.filament.scale_flow_from(self.first_changeable, extruder, factor)
        self._replanned()

    def scale_width(self, extruder: int, factor: float) -> None:
        """Like `scale_flow`, for the factor of the measured width of the filament."""
        self.before_moves()
        self._job.filament.scale_width_from(self.first_changeable, extruder, factor)
        self._replanned()

    def record_at_once(self, target: int, value: int) -> float:
        """Sets output number `target` at the earliest clock at which the board receives the command
        in time, or after the plan if the plan ends soon. Returns the clock."""
        job, clock = self._job, self.first_changeable
        if job.plan.queued == 0 and job.clock <= self.now + SOON_S * self.hz:
            clock = max(clock, job.clock + 1)
        job.outputs.record_at(clock, target, value)
        self.after_moves()
        return clock

    def skip_dwell(self) -> None:
        """Ends the current dwell at the earliest time that can still be changed."""
        if self._job.plan.skip_dwell_from(self.first_changeable) is not None:
            self._replanned()

    def hold(self) -> None:
        """Brakes to a stop on the path and suspends the rest of the plan. The laser is switched
        off."""
        self.before_moves()  # at standstill, the laser must not be switched off in the past
        self._job.stops.hold_from(self.first_changeable)
        self._replanned()

    def stop(self, *, program: bool = True) -> None:
        """Brakes to a stop on the path and discards the rest of the plan. With `program`, the
        retraction of the program is reset too. The laser is switched off."""
        self.before_moves()
        self._job.stops.stop_from(self.first_changeable, program)
        self._replanned()

    def use_commits(self, on: bool) -> None:
        """Sets whether boards that support it brake after a link loss. Switch it off while endstops
        stop motors, as in homing. Call it only while the machine is idle."""
        if not self._connection.survives:
            return
        if on:
            hz = self.hz
            most = self._connection.move_count // _SHARE_OF_SLOTS
            self._job.commits.use(int(COMMIT_S * hz), most)
        else:
            self._job.commits.stop()
        self._connection.arm(on)
        self.commits = on

    def recover_from(self, serial: int) -> bool:
        """Call this when the boards have braked without the host after commit `serial`: suspends
        the rest of the plan. False if the commit is unknown."""
        if self._job.commits.recover_from(serial) is None:
            return False
        self._replanned()
        return True

    def release(self) -> None:
        """Resumes the suspended plan."""
        if self._job.stops.holds:
            self.on_motion()
        self.before_moves()
        self._job.stops.release()
        self.after_moves()

    @property
    def first_changeable(self) -> float:
        """The clock from which on the moves can still be changed."""
        return self.now + self.horizon_s * self.hz

    def _replanned(self) -> None:
        self._stop_clock = -1.0
        self._dirty = True
        self._woken.set()

    async def until(self, condition: Callable[[], bool], *, idly: bool = False) -> None:
        """Waits until the condition is true; it is checked as time passes. With `idly`, the
        condition does not depend on print time, so free time need not pass once the machine is at
        standstill."""
        if self._closed:
            raise asyncio.CancelledError
        if condition():
            return
        future: asyncio.Future[None] = self._loop.create_future()
        entry = (condition, future, idly)
        self._waiting.append(entry)
        self._woken.set()
        try:
            await future
        finally:
            if entry in self._waiting:
                self._waiting.remove(entry)

    def call_after(self, seconds: float, action: Callable[[], None]) -> Alarm | None:
        """Calls an action once after `seconds` of print time, if print time runs as fast as
        possible. Otherwise returns None, and the caller must use a timer of the event loop."""
        if not self._free:
            return None
        alarm = Alarm(self.now + round(seconds * self.hz), action)
        self._alarms.append(alarm)
        return alarm

    def cancel(self, alarm: Alarm) -> None:
        """Cancels an alarm of `call_after` that is not due yet."""
        if alarm in self._alarms:
            self._alarms.remove(alarm)

    def close(self) -> None:
        """Ends the queue: cancels the tasks that wait for print time."""
        self._closed = True
        for _, future, _ in self._waiting:
            future.cancel()

    async def sleep(self, seconds: float) -> None:
        """Waits for print time to pass."""
        end = self.now + seconds * self.hz
        await self.until(lambda: self.now >= end)

    async def run(self) -> None:
        """Lets print time pass until cancelled. Raises MachineError when a board fails."""
        while True:
            if self._free:
                await self._free_stride()
            else:
                self._pass(self.now)
                self._woken.clear()
                idle = not self._waiting and self.standing and not self._dirty
                timeout = 10 * TICK_S if idle else TICK_S
                await self._woken.wait(timeout) if idle else await asyncio.sleep(timeout)

    async def _free_stride(self) -> None:
        quiet_s = self._loop.time() - self._heard_s
        moving = not self.standing or self._dirty
        wanted = self._awaited or not all(idly for _, _, idly in self._waiting)
        if wanted or (moving and (self._waiting or quiet_s >= GATHER_S / 2)):
            due = min((alarm.clock for alarm in self._alarms), default=math.inf)
            until = self.now + int(_STRIDE_S * self.hz)
            self._pass(until if due > until else max(int(due), self.now))
            await asyncio.sleep(0)
            return
        self._woken.clear()
        if self._waiting:
            self._pass(self.now)
            await self._woken.wait(TICK_S)
        else:
            await self._woken.wait(GATHER_S / 2 if moving else None)

    def await_answer(self) -> None:
        """Lets time pass, even if no command waits for it, until the board reports that it has
        stopped."""
        self._awaited = True
        self._woken.set()

    def look(self) -> None:
        """Lets time pass on the boards, without sending or settling moves. Raises MachineError."""
        self._run(self.now)

    async def await_shutdown(self) -> None:
        """Lets time pass only on the boards, until one of them reports its shutdown; then raises
        MachineError."""
        while True:
            self._run(self.now + int(TICK_S * self.hz))
            await asyncio.sleep(TICK_S)

    async def catch_up(self) -> None:
        """Waits until the time of the event loop reaches the time of simulated boards. Questions to
        these boards advance their time."""
        while (ahead := self._connection.now - self.base - self.now) > 0:
            await asyncio.sleep(ahead / self.hz)

    def wait(self) -> None:
        """Lets time pass on the boards even if links are lost. Raises MachineError when a board has
        shut down."""
        self._connection.wait(max(self.base + self.now, self._connection.now))

    def stand_by(self) -> None:
        """Lets time pass until the present time on boards that are shut down."""
        self._connection.stand_by(self.board_now)

    def live_on(self, seconds: float) -> None:
        """Lets `seconds` pass on the boards, in any state of the boards and their links."""
        boards, until = self._connection, self._connection.now
        if not boards.live:  # questions may have advanced it beyond the time of the loop
            until = max(until + int(seconds * self.hz), self.base + self.now)
        boards.live_on(until)

    def _pass(self, now: int) -> None:
        if self._job.plan.queued > 0:
            self.on_motion()
        self._settle(now)
        while (mark := self._job.outputs.next_mark) is not None and mark[0] <= now:
            # this may raise or stop the plan, so the mark is removed only afterwards
            self._run(mark[0])
            if self._job.outputs.next_mark == mark:
                self._job.outputs.pop_mark()
                self._on_mark(mark[1], mark[2])
        self._run(now)
        self.passed = now
        self._job.plan.passed(now)
        self.on_pass()
        for alarm in [alarm for alarm in self._alarms if alarm.clock <= now]:
            self._alarms.remove(alarm)
            alarm.action()
        self.end_waits()

    def _run(self, job_clock: int) -> None:
        until = self.base + job_clock
        if until > self._connection.now or self._connection.live:
            self._connection.run(until)  # a live board may send reports at any time

    def _settle(self, now: int) -> None:
        """Settles a plan that is about to run out of moves for a stop. Moves that arrive later
        cancel the stop, but as late as possible, because replanning repeats work."""
        job, stop = self._job, self._stop_clock
        # After many short moves, the stop is within the settled part.
        passed_by = job.clock > stop
        near = job.plan.queued > 0 and stop - now < TAKE_BACK_S * self.hz
        if stop > self.first_changeable and (passed_by or near):
            self.replan()
        if job.plan.queued == 0:
            if self._dirty:
                job.flush()  # the plan may contain a fan command
            self._dirty = False
            return
        self._begin_in_time()
        self._dirty = False
        if self._first_move_s is not None:
            if not self._free and self._loop.time() < self._first_move_s + GATHER_S:
                self._dirty = True
                return
            self._first_move_s = None
        if job.clock - now < RUNNING_DRY_S * self.hz:
            job.flush()
            self._stop_clock = job.clock

    def _begin_in_time(self) -> None:
        """After a stall of the program, delays moves from standstill that are due now."""
        job = self._job
        if job.plan.queued > 0 and job.plan.rests and job.clock < self.now + MIN_LEAD_S * self.hz:
            job.plan.wait_until(self.now + LEAD_S * self.hz)

    def end_waits(self) -> None:
        """Ends the waits whose conditions are true. If a condition raises an error, only its wait
        raises it. Raises MachineError."""
        for condition, future, _ in list(self._waiting):
            try:
                if not future.done() and condition():
                    future.set_result(None)
            except MachineError:
                raise
            except Exception as error:
                future.set_exception(error)


class _Wake:
    """Wakes the one task that waits for it, like an `asyncio.Event`; the end of a time limit costs
    less."""

    def __init__(self) -> None:
        self._is_set = False
        self._waiter: asyncio.Future[None] | None = None

    def set(self) -> None:
        """Wakes the task, now or when it begins to wait."""
        self._is_set = True
        if self._waiter is not None:
            _end(self._waiter)

    def clear(self) -> None:
        """Forgets the last `set`."""
        self._is_set = False

    async def wait(self, limit_s: float | None) -> None:
        """Waits for `set`, at most `limit_s` seconds."""
        if self._is_set:
            return
        loop = asyncio.get_running_loop()
        self._waiter = waiter = loop.create_future()
        limit = None if limit_s is None else loop.call_later(limit_s, _end, waiter)
        try:
            await waiter
        finally:
            self._waiter = None
            if limit is not None:
                limit.cancel()


def _end(waiter: asyncio.Future[None]) -> None:
    if not waiter.done():
        waiter.set_result(None)


async def either(event: asyncio.Event, timeout: float | None) -> None:
    """Waits for the event, at most `timeout` seconds."""
    try:
        async with asyncio.timeout(timeout):
            await event.wait()
    except TimeoutError:
        return
