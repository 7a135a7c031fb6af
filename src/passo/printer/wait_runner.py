"""Runs the waits of commands, and ends them."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from passo.board.faults import HeaterFault
from passo.errors import CommandError
from passo.printer.wait_requests import (
    NullReply,
    Reply,
    Stopped,
    Wait,
    WaitForHoming,
    WaitForMoves,
    WaitForProcedure,
    WaitForQueue,
    WaitForReading,
    WaitForTemperatures,
    WaitForTuning,
    WaitForUser,
)

if TYPE_CHECKING:
    from passo._core import Heater
    from passo.motion.homing import Homer
    from passo.motion.predefined_moves import PredefinedMoves
    from passo.printer.commands.user_prompts import UserPrompts
    from passo.printer.laser import Laser
    from passo.printer.live_rig import LiveRig
    from passo.printer.state import State
    from passo.printer.targets import Targets
    from passo.printer.watch.sensors import SensorFault, SensorWatch

WARMING_S = 1.0  # print time between two lines of temperatures during a wait
# A heater that has cooled by less than this in this time has stopped cooling (values of StuFW).
_MIN_COOLING_C, _COOLING_S = 1.5, 60.0
_NO_READING_S = 10.0  # without one, a wait for a reading ends


class _Cooling:
    """Checks whether a heater still cools down during a wait, and reports once if it does not."""

    def __init__(self, name: str, reply: Reply) -> None:
        self._name, self._reply = name, reply
        # print time in s, and the temperature at that time
        self._seen: tuple[float, float] | None = None
        self._over = False

    def goes_on(self, now_s: float, celsius: float) -> bool:
        """Call this as time passes. Returns whether the heater still cools down."""
        before_s, was = self._seen = self._seen or (now_s, celsius)
        if not self._over and now_s >= before_s + _COOLING_S:
            self._seen = now_s, celsius
            self._over = was - celsius < _MIN_COOLING_C
            if self._over:
                text = f"echo:{self._name} stopped cooling at {celsius:.1f} °C; continuing"
                self._reply.say(text)
        return not self._over


class WaitRunner:
    """Runs the waits of one printer, one at a time. The caller must hold the motion lock."""

    def __init__(
        self,
        rig: LiveRig,
        state: State,
        homer: Homer,
        moves: PredefinedMoves,
        prompts: UserPrompts,
        laser: Laser,
        targets: Targets,
        sensors: SensorWatch,
        temperatures: Callable[[], str],
    ) -> None:
        self._rig, self._state, self._homer, self._moves = rig, state, homer, moves
        self._prompts, self._laser, self._targets = prompts, laser, targets
        self._sensors = sensors
        self._temperatures = temperatures  # gives them as a line
        self.heating = False  # a command waits for a temperature
        self.person = False  # a command waits for the user
        self.busy = False  # a command waits
        self.in_procedure = False  # a command moves the machine by itself, as for a probing
        self.for_room = False  # a line waits for free space in the plan
        self._skip_moves = False  # after M108: do not wait for queued moves either
        self._uninterruptible = False  # M108 does not end the current wait

    def go_on(self) -> None:
        """M108: ends the current wait for moves, time, temperatures or the user. Moves continue. If
        only a paused file waits for the user, the file resumes."""
        waited = self.busy
        self._rig.queue.skip_dwell()
        self.end()
        if not waited:
            for listener in self._state.go_on_listeners:
                listener()

    def end(self) -> None:
        """Ends the current wait, unless an action follows its moves. Moves and dwells continue."""
        if not self._uninterruptible:
            self._skip_moves = self._state.ended = True

    async def room(self, there: Callable[[], bool]) -> bool:
        """Waits until `there` is True, which means that a line can be read, or until `end` is
        called, after which the line is read anyway. Returns whether `end` was called."""
        rig, state = self._rig, self._state
        self._skip_moves, self.for_room = False, True

        def let_in() -> bool:
            if state.host_paused:
                self._skip_moves = False  # that M108 was for the pause
            return (
                there() or bool(state.halted) or (self._skip_moves and rig.job.program.at_boundary)
            )

        try:
            await rig.queue.until(let_in, idly=True)
        finally:
            self.for_room = False
        return self._skip_moves

    async def wait(
        self,
        wait: Wait,
        reply: Reply,
        *,
        ends: bool = False,
        suspended: Callable[[], bool] = lambda: False,
    ) -> bool:
        """Waits for the moves so far, and then for the condition of `wait`; does not wait if `ends`
        is True. Returns False if the moves are `suspended` before the wait has begun. Raises
        Stopped after a halt."""
        within_another, self.busy = self.busy, True
        if isinstance(wait, WaitForUser):
            self._prompts.ask(wait.message)
        try:
            return await self._wait(wait, reply, ends, suspended)
        finally:
            self.busy, self._uninterruptible = within_another, False
            if isinstance(wait, WaitForUser):
                self._prompts.answered()

    async def _wait(
        self, wait: Wait, reply: Reply, ends: bool, suspended: Callable[[], bool]
    ) -> bool:
        if isinstance(wait, WaitForQueue):
            await self._more()
            return True
        self._uninterruptible = isinstance(wait, WaitForMoves) and wait.then is not None
        self._state.ended = self._skip_moves = ends and not self._uninterruptible
        if isinstance(wait, WaitForMoves):
            if not await self._wait_for_moves(suspended):
                return False
            if wait.then is not None:
                self._raise_if_ended()
                wait.then()
        else:
            with self._laser.blanked():
                if not await self._wait_for_moves(suspended):
                    return False
                # After M108 has skipped the moves, the command after them still runs, except
                # homing.
                if isinstance(wait, WaitForHoming) or not self._skip_moves:
                    self._raise_if_ended()
                await self._at_rest(wait, reply)
        self._state.raise_if_halted()
        return True

    async def _more(self) -> None:
        """Waits until more of a line can be planned. Only a stop can end this wait."""
        rig, state = self._rig, self._state
        await rig.queue.until(
            lambda: not (rig.queue.full or state.host_paused) or bool(state.halted), idly=True
        )
        state.raise_if_halted()

    async def _wait_for_moves(self, suspended: Callable[[], bool]) -> bool:
        rig, state = self._rig, self._state
        rig.queue.flush()
        await rig.queue.until(
            lambda: rig.queue.standing or self._skip_moves or bool(state.halted) or suspended()
        )
        state.raise_if_halted()
        return not suspended()

    async def _at_rest(self, wait: Wait, reply: Reply) -> None:
        rig = self._rig
        if isinstance(wait, WaitForTemperatures):
            await self._reach(wait, reply)
        elif isinstance(wait, WaitForReading):
            await self._read(wait, reply)
        elif isinstance(wait, WaitForProcedure):
            await self._procedure(wait)
        elif isinstance(wait, WaitForTuning):
            await self._tune(wait)
        elif isinstance(wait, WaitForUser):
            await self._person(wait, reply)
        elif isinstance(wait, WaitForHoming):
            rig.job.abandon()
            letters = wait.letters
            await self._moves.around_homing(letters, lambda: self._homer.home(letters))

    async def _procedure(self, wait: WaitForProcedure) -> None:
        within_another, self.in_procedure = self.in_procedure, True
        try:
            await wait.run()
        finally:
            self.in_procedure = within_another

    def _raise_if_ended(self) -> None:
        if self._state.ended:
            self._rig.job.abandon()
            raise Stopped("it was stopped")

    async def _reach(self, wait: WaitForTemperatures, reply: Reply) -> None:
        rig, state = self._rig, self._state
        heaters = {name: rig.connection.heaters[name] for name in wait.heaters}
        told_s = rig.queue.now_s
        cooling = {name: _Cooling(name, reply) for name in heaters}

        cools: dict[tuple[str, float], bool] = {}  # whether the heater was too warm for this target

        def on_its_way(name: str, h: Heater) -> bool:
            if h.target <= 0 or h.settled:
                return False
            above = h.target + h.arrival.window_c < h.celsius <= h.limits.max_c
            began_above = cools.setdefault((name, h.target), above)
            if not above:
                return True
            if began_above and not wait.cooling:
                return False
            return cooling[name].goes_on(rig.queue.now_s, h.celsius)

        def there() -> bool:
            nonlocal told_s
            if rig.queue.now_s >= told_s + WARMING_S:
                told_s += WARMING_S
                reply.warming(f" {self._temperatures()} W:?")
            # Check each of them: they cool at the same time.
            left = [name for name, h in heaters.items() if on_its_way(name, h)]
            return state.interrupted or any(h.fault for h in heaters.values()) or not left

        self.heating = True
        try:
            await rig.queue.until(there)
        finally:
            self.heating = False
        # The link's thread may have found a fault that is not reported yet.
        for name, heater in heaters.items():
            if heater.fault is not None and not state.halted:
                raise CommandError([HeaterFault.of(name, heater.fault).problem])

    async def _read(self, wait: WaitForReading, reply: Reply) -> None:
        """Waits for a reading. Raises CommandError if the sensor is broken, or gives none."""
        rig, state, name = self._rig, self._state, wait.name
        told_s, heater = rig.queue.now_s, rig.connection.heaters.get(name)
        read_s = told_s  # when there was a reading, or the link was lost

        def fault() -> HeaterFault | SensorFault | None:
            if heater is None:
                return self._sensors.broken(name)
            return None if heater.fault is None else HeaterFault.of(name, heater.fault)

        def there() -> bool:
            nonlocal told_s, read_s
            if rig.queue.now_s >= told_s + WARMING_S:
                told_s += WARMING_S
                reply.warming(f" {self._temperatures()} W:?")
            celsius = self._sensors.celsius(name) if heater is None else heater.celsius
            near = celsius is not None and wait.low_c <= celsius <= wait.high_c
            if celsius is not None or rig.queue.interrupted:
                read_s = rig.queue.now_s
            return near or state.interrupted or silent() or fault() is not None

        def silent() -> bool:
            return rig.queue.now_s > read_s + _NO_READING_S

        self.heating = True
        try:
            await rig.queue.until(there)
        finally:
            self.heating = False
        if state.interrupted:
            return
        if (found := fault()) is not None:
            raise CommandError([found.problem])
        if silent():
            raise CommandError.of("sensor.no-reading", axis=name, value=_NO_READING_S)

    async def _tune(self, wait: WaitForTuning) -> None:
        self.heating = True
        try:
            # The client that has switched the heater off must not receive another line of heating.
            await self._rig.queue.until(lambda: self._state.interrupted or wait.step())
        finally:
            self.heating = False
            wait.finish()

    async def _person(self, wait: WaitForUser, reply: Reply) -> None:
        state, queue = self._state, self._rig.queue
        reply.say("echo:busy: paused for user")
        end = queue.now + wait.seconds * queue.hz
        self.person = True
        try:
            with self._prompts.waited_for(for_ever=wait.seconds <= 0):
                await queue.until(
                    lambda: state.interrupted or (wait.seconds > 0 and queue.now >= end),
                    idly=wait.seconds <= 0,
                )
        finally:
            self.person = False
        self._prompts.answered()
        state.raise_if_halted()
        await self.warm_again()

    async def warm_again(self) -> None:
        """Reheats the heaters that a long pause or a fault has switched off, unless their targets
        were changed since. A failed bed or chamber is ignored. Call it with the motion lock held.
        Raises Stopped, and CommandError if a hotend fails."""
        rig, targets = self._rig, self._targets
        cooled, targets.cooled_c = targets.cooled_c, {}
        for name, celsius in cooled.items():
            rig.connection.set_target(name, celsius)
        if cooled:
            rig.queue.before_moves()  # marks the machine as not idle
        waited: list[str] = list(cooled)
        while waited:
            try:
                await self.wait(WaitForTemperatures(tuple(waited)), NullReply())
                return
            except CommandError:
                failed = {n for n in waited if rig.connection.heaters[n].fault is not None}
                if not failed or any(rig.machine.heaters[n].kind == "hotend" for n in failed):
                    # so that another attempt waits again
                    targets.cooled_c = cooled | targets.cooled_c
                    raise
                waited = [n for n in waited if n not in failed]
