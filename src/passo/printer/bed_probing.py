"""Measures the simulated bed for the commands of a print without consoles that need a probe."""

from __future__ import annotations

import asyncio
import logging
import math
import time
from collections.abc import Callable, Coroutine, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeVar

from passo import config
from passo.clock import VirtualLoop
from passo.errors import CommandError, MachineError, Problem
from passo.gcode.registry import Kind, row_of
from passo.motion.axis_slots import X, Y, Z
from passo.motion.travel import go_back
from passo.printer.print_objects import covered, objects_of
from passo.printer.printer import Printer
from passo.printer.setup.simulated_world import with_calibrated_probe
from passo.printer.wait_requests import NullReply, Stopped, Wait, WaitForMoves
from passo.probes.base import SensingProbe

if TYPE_CHECKING:
    from passo import _core
    from passo.config.machine import MachineConfig
    from passo.gcode.command import Command
    from passo.printer.commands.program import Commands
    from passo.printer.status import Status

_log = logging.getLogger(__name__)
_T = TypeVar("_T")

# These change or use the correction of the bed. Without a measurement in the file, that is the
# correction that a served printer has stored, which a print does not have.
_AFTER = {
    *("ATTACH_PROBE", "BED_MESH_CLEAR", "DETACH_PROBE", "G42", "M376", "M401", "M402", "M420"),
    *("M421", "M561"),
}


class _Answers(NullReply):
    """Collects the replies to one command: texts for the log, and problems."""

    def __init__(self, code: str) -> None:
        self._code = code
        self.problems: list[Problem] = []

    def say(self, text: str) -> None:
        """Writes the line to the log."""
        _log.info("%s: %s", self._code, text)

    def fail(self, text: str, problems: Sequence[Problem] = ()) -> None:
        """Adds the reason of the failure to `problems`."""
        self.problems += problems or [Problem("command.failed", values={"value": text})]


class BedProbing:
    """Executes the commands of a job that need a probe on a second printer: a served printer of the
    same machine, with simulated boards, in virtual time. The job gets the results: the bed
    correction, the geometry, and the position of the nozzle. Each command begins at the position
    where the plan of the job ends. The second printer starts, homed, at the first such command.
    Like homing, probing takes no print time. Not thread-safe; close it.

    `placed` is called after each command with the real position of each motor minus its position
    in the plan, mm or degrees. `cpu_s` is the processor time that probing has used so far.
    """

    def __init__(
        self, machine: MachineConfig, job: _core.Job, placed: Callable[[Mapping[str, float]], None]
    ) -> None:
        self._machine = with_calibrated_probe(config.on_simulated_boards(machine))
        self._job, self._placed = job, placed
        self._printer: Printer | None = None
        self._loop: VirtualLoop | None = None
        self._thread: ThreadPoolExecutor | None = None
        self._task: asyncio.Task[None] | None = None
        self.cpu_s = 0.0

    @property
    def going(self) -> bool:
        """Whether the second printer has started; then it must home whenever the job homes."""
        return self._printer is not None

    def wait_for(self, command: Command, commands: Commands) -> Wait | None:
        """The wait of a command that needs a probe; None if it is skipped. The command is executed
        at the end of the plan, at standstill. Its end raises CommandError and MachineError."""
        if not self._takes(command):
            return None

        def probe() -> None:
            self._call(lambda: self._carried_out(command))
            self._placed(self._taken_over(commands))

        return WaitForMoves(probe)

    def _takes(self, command: Command) -> bool:
        if not isinstance(self._machine.probe, SensingProbe):
            return False
        row = row_of(command.code)
        probed = row is not None and row.kind is Kind.PROBED
        return probed and (self.going or command.code not in _AFTER)

    def home(self, letters: str, start: Sequence[float], commands: Commands) -> Mapping[str, float]:
        """Call this after the job has homed: homes at the simulated endstops, starting at this
        machine position. Returns what `placed` receives. Raises CommandError, MachineError."""
        self._call(lambda: self._homed(letters, start))
        return self._taken_over(commands)

    def shown(self, status: Status) -> Status:
        """The status of the job, with the bed as the second printer has measured it."""
        if self._printer is None:
            return status
        printer = self._printer
        return replace(
            status,
            bed=printer.levelling.bed.status(),
            gantry_level=printer.levelling.gantry.level if printer.levelling.gantry else None,
            screws=printer.levelling.screws.measured if printer.levelling.screws else (),
            screws_limit_mm=printer.levelling.screws.exceeded_mm
            if printer.levelling.screws
            else None,
        )

    def close(self) -> None:
        """Ends the second printer."""
        if self._loop is not None and self._thread is not None:
            self._thread.submit(self._end).result()
            self._thread.shutdown()

    # -- the printer, in its own thread: an event loop may already run in that of the caller ------

    def _call(self, make: Callable[[], Coroutine[Any, Any, _T]]) -> _T:
        if self._thread is None:
            self._thread = ThreadPoolExecutor(1, thread_name_prefix="probing")
        return self._thread.submit(self._run, make).result()

    def _run(self, make: Callable[[], Coroutine[Any, Any, _T]]) -> _T:
        begin_s = time.thread_time()
        try:
            if self._loop is None:
                self._loop = VirtualLoop()
            return self._loop.run_until_complete(make())
        except Stopped as stop:
            cause = self._printer.state.cause if self._printer else None
            raise cause or MachineError.of("machine.stopped") from stop
        finally:
            self.cpu_s += time.thread_time() - begin_s

    def _end(self) -> None:
        assert self._loop is not None
        self._loop.run_until_complete(_all_cancelled())
        if self._printer is not None:
            self._printer.close()
        self._loop.close()

    async def _ready(self) -> Printer:
        """Returns the printer. The first call starts it, and homes it if the job is homed."""
        if self._printer is None:
            self._printer = printer = Printer(
                self._machine, free=True, printed_area=lambda: covered(objects_of(self._job))
            )
            printer.report_start()
            self._task = asyncio.get_running_loop().create_task(printer.run())
            if not self._lost:
                await printer.motion.homer.home("XYZ")
        return self._printer

    @property
    def _lost(self) -> set[int]:
        return {X, Y, Z} & set(self._job.locked_axes)

    async def _carried_out(self, command: Command) -> None:
        printer, answers = await self._ready(), _Answers(command.code)
        await printer.motion_lock.acquire()
        try:
            if not self._lost:
                await self._go(self._job.machine_position)
                printer.rig.job.adopt(self._job)
            wait = printer.dispatch.run_command(command, answers)
            await printer.dispatch.finish(wait, answers)
        finally:
            printer.motion_lock.release()
        if answers.problems:
            raise CommandError(answers.problems)

    async def _homed(self, letters: str, start: Sequence[float]) -> None:
        printer = await self._ready()
        await self._go(start)
        await printer.motion.homer.home(letters)

    async def _go(self, to: Sequence[float]) -> None:
        printer = await self._ready()
        go_back(printer.rig, {slot: to[slot] for slot in (X, Y, Z)}, math.inf)
        printer.rig.queue.flush()
        await printer.motion.triggered.standstill()
        printer.state.raise_if_interrupted()

    # -- the job ----------------------------------------------------------------------------------

    def _taken_over(self, commands: Commands) -> Mapping[str, float]:
        assert self._printer is not None
        printer, job = self._printer, self._job
        machine = printer.rig.machine
        if machine.geometry != commands.machine.geometry:
            job.axes.set_geometry(machine.geometry.spec())
            commands.use_geometry(machine)
        printer.motion.correction.apply_to(job.bed)
        if not self._lost:
            job.axes.set_position(
                [(slot, printer.rig.job.machine_position[slot]) for slot in (X, Y, Z)]
            )
        board = printer.board
        assert board is not None
        return {
            row["name"]: board.position(row["name"]) - row["count"] / row["steps_per_unit"]
            for row in printer.rig.job.motors.statistics()
        }


async def _all_cancelled() -> None:
    tasks = asyncio.all_tasks() - {asyncio.current_task()}
    for task in tasks:
        task.cancel()
    await asyncio.gather(*tasks, return_exceptions=True)
