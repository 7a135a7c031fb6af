"""Monitors the motor drivers that have registers."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING

from passo.board.drivers import Drivers, DriverState
from passo.board.trinamic import DriverSettings, Finding, findings
from passo.board.trinamic.stall import stall_settings, stall_threshold
from passo.errors import MachineError
from passo.motion.motion_queue import TICK_S
from passo.printer.watch.driver_report import with_drivers

if TYPE_CHECKING:
    from passo.board.boards import Boards
    from passo.errors import Problem
    from passo.motion.rig import Rig
    from passo.motion.stall_homing import Detection
    from passo.printer.commands.motors import Motors
    from passo.printer.state import State

_log = logging.getLogger(__name__)

_LOOK_S = 1.0  # interval of status questions to a driver
# Findings that a new set-up of the driver clears: lost settings, or the flag of a past fault.
_LATCHED = ("driver.reset", "driver.undervoltage", "driver.stopped")


class DriverWatch:
    """Reads the status of each driver of one printer every second. While the motors are on, a
    failed driver halts the printer. While they are off, a driver that has lost its settings, or
    whose supply was too low, is set up again. The machine does not move while a driver does not
    answer."""

    def __init__(
        self, rig: Rig, state: State, motors: Motors, halt: Callable[[MachineError], None]
    ) -> None:
        self._rig, self._state, self._motors, self._halt = rig, state, motors, halt
        self.prewarned: set[str] = set()  # motors whose drivers were hot since M912
        self._set: dict[str, DriverSettings] = {}  # set by commands; kept over a reset of the board
        self._held: dict[str, DriverSettings] = {}  # from before a detection of stalls
        self._begun: list[Callable[[], bool]] = []  # reads and writes: whether each is over
        self._reported: set[tuple[str, str]] = set()
        self._next_look = 0
        state.status_parts.append(lambda status: with_drivers(status, self.states))

    def set_up(self, boards: Boards) -> None:
        """Call this after the boards have restarted: sets up their drivers. Lets time pass; raises
        MachineError."""
        self._boards = boards
        self._of_boards = [Drivers(connection) for connection in boards.connections]
        for motor, settings in self._set.items():
            self.states[motor].settings = settings
        self._reported.clear()
        self._begun.clear()
        self._next_look = 0
        for drivers in self._of_boards:
            drivers.configure()

    async def reconnected(self) -> None:
        """Call this when the board is back after a lost link: sets up the working drivers again,
        because a setting may have been lost. Raises MachineError."""
        for drivers in self._of_boards:
            drivers.interrupt()
            for motor in drivers.states:
                drivers.begin_status(motor)
        await self._answered()
        if not self._state.halted:
            for motor in self.states:
                self._of(motor).begin_configure(motor)
            await self._answered()

    async def _answered(self) -> None:
        """Waits for all answers, and handles them."""
        while not self._state.halted and not all(drivers.idle for drivers in self._of_boards):
            await asyncio.sleep(TICK_S)
            self._rig.queue.look()
            for drivers in self._of_boards:
                drivers.poll()
        for motor, state in self.states.items():
            self._look_at(motor, state)

    def _of(self, motor: str) -> Drivers:
        return next(drivers for drivers in self._of_boards if motor in drivers.states)

    @property
    def states(self) -> dict[str, DriverState]:
        """The drivers by their motors."""
        return {m: state for drivers in self._of_boards for m, state in drivers.states.items()}

    def set(self, motor: str, settings: DriverSettings, *, keep: bool = True) -> None:
        """Changes the settings of a driver: writes the registers that differ, without waiting for
        the exchange with the driver. With `keep`, a restart of the board keeps the settings."""
        if keep:
            self._set[motor] = settings
        if settings != self.states[motor].settings:
            self._begin(self._of(motor).begin_change(motor, settings))

    def read(self, motor: str, register: str, done: Callable[[int], None]) -> None:
        """Reads a register of a driver by its name, without waiting: calls `done` with its
        value."""
        self._begin(self._of(motor).begin_read(motor, register, done))

    async def settled(self) -> None:
        """Waits until all reads and writes that were begun are over. A driver that fails halts the
        printer if its motor is on."""
        await self._over()
        for motor, state in self.states.items():
            self._look_at(motor, state)

    def _begin(self, over: Callable[[], bool]) -> None:
        self._begun = [*(one for one in self._begun if not one()), over]

    async def _over(self) -> None:
        begun, self._begun = self._begun, []
        await self._rig.queue.until(
            lambda: bool(self._state.halted) or all(over() for over in begun)
        )

    def initialise(self, motor: str) -> None:
        """Writes the settings of a driver again, without waiting for the exchange with it."""
        self._begin(self._of(motor).begin_configure(motor, self.states[motor].settings))

    async def detect_stalls(self, wanted: Mapping[str, Detection]) -> None:
        """Lets these motors' drivers detect stalls, until `end_detection`. Raises MachineError."""
        states = self.states
        self._held = {motor: states[motor].settings for motor in wanted}
        await self._write(
            {
                motor: stall_settings(
                    states[motor].settings,
                    stall_threshold(states[how.like].settings),
                    *(how.microsteps_s, how.current_a, how.pin),
                )
                for motor, how in wanted.items()
            }
        )

    async def end_detection(self) -> None:
        """Gives the drivers back the settings from before. Raises MachineError."""
        held, self._held = self._held, {}
        if not self._state.halted:  # a restart sets all drivers up
            await self._write(held)

    async def _write(self, settings: Mapping[str, DriverSettings]) -> None:
        """Writes and verifies settings, which are not kept over a restart. Lets time pass; raises
        MachineError."""
        for motor, wanted in settings.items():
            self._begin(self._of(motor).begin_configure(motor, wanted))
        await self._over()
        for motor in settings:
            failure = self.states[motor].failure
            if failure is not None:
                raise MachineError([failure.problem])

    def failures(self) -> Iterator[Problem]:
        """The drivers that do not answer."""
        for state in self.states.values():
            if state.failure is not None:
                yield state.failure.problem

    def before_motion(self) -> None:
        """Halts the printer if a driver is not set up, because its motor would not move
        correctly."""
        for problem in self.failures():
            self._halt(MachineError([problem]))

    def time_passed(self) -> None:
        """Asks the next questions, and handles the answers."""
        if not self.states or self._state.halted:
            return
        for drivers in self._of_boards:
            drivers.poll()
        for motor, state in self.states.items():
            self._look_at(motor, state)
        boards = self._boards
        if boards.now >= self._next_look and all(drivers.idle for drivers in self._of_boards):
            self._next_look = boards.now + int(_LOOK_S * boards.board.clock_hz)
            for motor, state in self.states.items():
                if state.failure is None:
                    self._of(motor).begin_status(motor)
                else:
                    self._of(motor).begin_configure(motor)

    def _look_at(self, motor: str, state: DriverState) -> None:
        on = motor in self._motors.on
        if state.failure is not None:
            if on:
                self._halt(MachineError([state.failure.problem]))
            else:
                self._tell_once(motor, "failure", state.failure.problem)
            return
        if (motor, "failure") in self._reported:
            self._reported.discard((motor, "failure"))
            self._state.tell(f"echo:The driver of motor {motor} is set up")
            _log.info("The driver of motor %s is set up", motor)
        if state.fresh and state.reading is not None:
            state.fresh = False
            self._judge(motor, findings(motor, state.settings.chip, state.reading), on=on)

    def _judge(self, motor: str, found: list[Finding], *, on: bool) -> None:
        grave = [f.problem for f in found if f.stops]
        if grave and on:
            self._halt(MachineError([grave[0]]))
        elif any(problem.code in _LATCHED for problem in grave):
            self._of(motor).begin_configure(motor)
        for finding in found:
            code = finding.problem.code
            if code == "driver.hot":
                self.prewarned.add(motor)
            self._tell_once(motor, code, finding.problem)
        codes = {finding.problem.code for finding in found} | {"failure"}
        self._reported = {
            (who, what) for who, what in self._reported if who != motor or what in codes
        }

    def _tell_once(self, motor: str, what: str, problem: Problem) -> None:
        """Reports a condition once, when it begins."""
        if (motor, what) not in self._reported:
            self._reported.add((motor, what))
            self._state.tell(f"echo:{problem}")
            _log.warning("%s", problem, extra=problem.log_fields)
