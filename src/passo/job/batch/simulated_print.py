"""A whole print in virtual time: the file through plan, link and board."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING, Protocol

from passo import _core
from passo.board.drivers import Drivers
from passo.board.faults import HeaterFault
from passo.errors import InputError, MachineError, Problem
from passo.gcode.registry import Kind, table
from passo.job.batch.first_layer import FirstLayerWatch
from passo.job.batch.policy import Policy
from passo.job.batch.program import heated, refuse_stop, run_program, with_option
from passo.job.batch.rehearsal import RehearsedCommands
from passo.job.batch.result import PrintResult, process_peak_rss_mb, thread_cpu_s
from passo.printer.bed_probing import BedProbing
from passo.printer.commands.motion_filters import MotionFilters
from passo.printer.commands.program import FILTER_COMMANDS, Commands
from passo.printer.macros import Macros
from passo.printer.setup.connections import connect_simulated
from passo.printer.setup.simulated_world import nozzle_gap
from passo.printer.wait_requests import Wait, WaitForHoming, WaitForMoves

if TYPE_CHECKING:
    from passo.board.boards import Boards
    from passo.config.machine import MachineConfig

_LEAD_S = 0.25  # delay of the plan after a wait
_HORIZON_S = 0.2  # commands are sent to the board at most this long before they are due
_LOOK_S = 0.5  # interval of the checks of filament that may be cold
_SLICE_S = 0.5  # interval of temperature readings during a wait
_TIMEOUT_S = 3600.0  # a heater that takes longer is broken
_TOO_EARLY = 0.01  # smaller fractions of a file cannot predict the rest


@dataclass(frozen=True, slots=True)
class Progress:
    """The progress of a print: the fraction of the file that is done, the layer, the print time and
    its part for heating; for each heater its temperature and target (0: off), °C, and its power, 0
    to 1."""

    share: float
    layer: int
    print_s: float
    heat_s: float
    celsius: dict[str, float]
    target_c: dict[str, float]
    power: dict[str, float]

    @property
    def left_s(self) -> float | None:
        """The remaining print time, extrapolated from the finished part without its heating; None
        at the beginning."""
        if self.share <= _TOO_EARLY:
            return None
        return (self.print_s - self.heat_s) * (1 - self.share) / self.share


class StepWatch(Protocol):
    """Follows the steps of a print while the simulated boards execute them."""

    def begin(self, base: int) -> None:
        """The job begins, at the home position and this clock of the main board."""
        ...

    def placed(self, errors_mm: Mapping[str, float] | None = None) -> None:
        """The position at the end of the plan has changed without a move; see
        `FirstLayerWatch.placed`."""
        ...

    def look(self) -> None:
        """The boards have run."""
        ...

    def end(self) -> None:
        """The print has ended."""
        ...


class _StepWatches:
    """The watches of one print. It has no reference to the print; see `_Targets`."""

    def __init__(self) -> None:
        self.all: list[StepWatch] = []

    def placed(self, errors_mm: Mapping[str, float] | None) -> None:
        """See `StepWatch.placed`."""
        for watch in self.all:
            watch.placed(errors_mm)


class _Targets:
    """Sets the targets of a print's heaters. It has no reference to the print, so that both are
    freed without the garbage collector."""

    def __init__(self, job: _core.Job, connection: Boards, heaters: list[str]) -> None:
        self._job, self._connection, self._heaters = job, connection, heaters

    def set_target(self, heater: str, celsius: float, *, at_once: bool = False) -> None:
        """Sets a heater's target when the moves so far are done, or at once."""
        if at_once:
            self._connection.set_target(heater, celsius)
        else:
            self._job.outputs.mark(self._heaters.index(heater), round(celsius * 100))


class Print:
    """One print on a simulated board of the machine. Runs once; not thread-safe."""

    def __init__(
        self,
        machine: MachineConfig,
        policy: Policy | None = None,
        progress: Callable[[Progress], None] | None = None,
        every_s: float = inf,
    ) -> None:
        """`progress` is called whenever the board has executed the plan so far, and every `every_s`
        of print time in between; it may set `every_s`."""
        begin_s = thread_cpu_s()
        self._machine = machine
        self._policy = policy or Policy()
        self._progress = progress
        self._hz = machine.board.clock_hz
        self.every_s = every_s
        self._heaters = list(machine.heaters)
        self.connection, self.board = connect_simulated(machine)
        for connection in self.connection.connections:
            Drivers(connection).require()
        outputs = self.connection.board.outputs
        self.job = _core.Job(
            machine.core_spec(), True, self._policy.clamp, self._policy.ignore_tools
        )
        full = [self.connection.full_scale(output.name) for output in outputs]
        targets = _Targets(self.job, self.connection, self._heaters)
        self.first_layer: FirstLayerWatch | None = None
        self._step_watches = _StepWatches()
        self._probing = probing = BedProbing(machine, self.job, self._step_watches.placed)
        left_out = frozenset[str]()
        if self._policy.motion_only:
            probed = {code for code, row in table().items() if row.kind is Kind.PROBED}
            left_out = FILTER_COMMANDS | probed
        self._checks: RehearsedCommands | None = None
        if self._policy.checked:
            self._checks = RehearsedCommands(
                *(machine, self.job, targets, full, self.connection.heaters),
                probing=probing,
                left_out=left_out,
            )
        self._commands = self._checks or Commands(
            machine, self.job, targets, full, probing=probing, left_out=left_out
        )
        # steps of filament motors so far, while filament may be cold
        self._filament: dict[str, int] | None = None
        self.base = 0  # board clock at which the job starts
        self._wire_cpu_s = 0.0
        self._heat_s = 0.0
        # Line, fraction of the file, and layer: up to which the file was read before, and is read
        # now.
        self._from = self._to = (0, 0.0, 0)
        self._watch: Callable[[], None] = lambda: None
        self._trace_s = 0.0
        self._path = ""
        self._cpu_s = thread_cpu_s() - begin_s

    @property
    def macros(self) -> Macros:
        """The macros of the program."""
        return self._commands.macros

    @property
    def filters(self) -> MotionFilters:
        """The filters that are set by the lines read so far."""
        return self._commands.filters

    def watch(self, watcher: Callable[[], None]) -> None:
        """Sets a function that is called whenever the plan has grown. Call it before `run`."""
        self._watch = watcher

    def watch_steps(self, watch: StepWatch) -> None:
        """Lets a part follow the steps of the print. Call it before `run`."""
        self._step_watches.all.append(watch)

    def trace_until(self, seconds: float) -> None:
        """Makes the simulated board record its steps up to this print time, in seconds. Call it
        before `run`."""
        self._trace_s = seconds

    def wait_for(self, heaters: list[str]) -> None:
        """Stops the machine and lets time pass until these heaters have reached their targets.

        Raises MachineError if one takes longer than an hour.
        """
        self.job.flush()
        start = self.job.clock
        self._run_to(start)
        self._apply_marks(float("inf"))
        waited = 0.0
        loops = {name: self.connection.heaters[name] for name in heaters}
        warm = [n for n, h in loops.items() if h.celsius > h.target + h.arrival.window_c]
        heaters = [name for name in heaters if name not in warm]  # wait only for heating
        while any(self._on_its_way(name) for name in heaters):
            if waited >= _TIMEOUT_S:
                raise self._too_slow(heaters)
            self._run(self.connection.now + round(_SLICE_S * self._hz))
            waited += _SLICE_S
        ready = self.connection.now - self.base + round(_LEAD_S * self._hz)
        if waited > 0:
            self.job.plan.wait_until(ready)
            self._heat_s += (self.job.clock - start) / self._hz

    def run(
        self,
        path: str | os.PathLike[str],
        end: int | None = None,
        result: PrintResult | None = None,
    ) -> PrintResult:
        """Prints the file to its end, or to the line before `end`. Raises InputError and
        MachineError, also for M112 and M410, which end a print as soon as they are read. After an
        error, a given `result` has the warnings and the cost so far."""
        result = result or PrintResult(file=str(path), machine=self._machine.name)
        begin_s = thread_cpu_s()
        self.connection.set_on_fault(self._heater_failed)
        try:
            self._print(path, end)
            self._fill(result)
        finally:
            self._cpu_s += thread_cpu_s() - begin_s
            self._fill_cost(result, str(path))
            self._part()
        return result

    def _part(self) -> None:
        """Removes all references back to the print, which would keep it in memory until the garbage
        collector runs."""
        self.connection.set_on_fault(None)
        self._probing.close()
        self._progress, self._watch = None, lambda: None

    def _print(self, path: str | os.PathLike[str], end: int | None) -> None:
        checks, self._path = self._checks, str(path)
        self.base = self.connection.start_job(self.job)
        warm = heated(self.job, self.wait_for)

        def settle(wait: Wait) -> None:
            refuse_stop(wait, str(path))
            start = self.job.machine_position
            if isinstance(wait, WaitForMoves) and wait.executed:
                self.job.flush()
                self._run_to(self.job.clock)
            warm(wait)
            if isinstance(wait, WaitForHoming):
                self._homed(wait.letters, start)
            if checks is not None:
                checks.guard(self.connection.now - self.base)

        self._watch_first_layer()
        for watch in self._step_watches.all:
            watch.begin(self.base)
        if self._trace_s > 0:
            for stepper in self.connection.board.steppers:
                self.board.trace_steps(stepper.name, 0, self.base + round(self._trace_s * self._hz))
        if checks is not None:
            self.job.history.line_at(0)  # record the lines of moves from here on
            checks.guard(0)
        skips = self._policy.skips.on(self._machine)
        for share in run_program(self.job, self._commands, path, settle, skips, end):
            self._watch()
            if self.job.line > self._to[0]:
                self._from, self._to = self._to, (self.job.line, share, self.job.program.layer)
            self._run_to(self.job.plan.handed_out - _HORIZON_S * self._hz)
            self.job.plan.passed(self.job.clock)  # moves are never replanned
            for watch in self._step_watches.all:
                watch.look()
        self._run_to(self.job.clock)
        self._apply_marks(float("inf"))
        kick_s = max((fan.kick_start_s for fan in self._machine.fans.values()), default=0.0)
        self._run(self.connection.now + round((_LEAD_S + kick_s) * self._hz))
        for watch in self._step_watches.all:
            watch.end()

    def _homed(self, letters: str, start: Sequence[float]) -> None:
        """Call this after the job has homed, starting at this machine position."""
        probing = self._probing
        errors_mm = probing.home(letters, start, self._commands) if probing.going else None
        self._step_watches.placed(errors_mm)

    def _watch_first_layer(self) -> None:
        """Not on a machine that prints nothing, and while the boards keep steps for others."""
        if self._trace_s > 0 or not self._machine.extruders:
            return
        follows = nozzle_gap(self._machine, self.board)
        self.first_layer = FirstLayerWatch(self._machine, self.job, follows)
        self._step_watches.all.append(self.first_layer)

    def _run_to(self, job_clock: float) -> None:
        """Runs the board up to a clock of the job, and sets heaters at their marks."""
        if self._checks is not None:
            now = self.connection.now - self.base
            self.job.history.line_at(now)  # drops past lines, so call it often
            self._checks.guard(now)
        while (mark := self.job.outputs.next_mark) is not None and mark[0] <= job_clock:
            self._run(self.base + mark[0])
            self._apply_marks(mark[0])
        self._run(self.base + round(job_clock))
        if self._checks is not None:
            self._checks.guard(self.connection.now - self.base)

    def _apply_marks(self, until: float) -> None:
        while (mark := self.job.outputs.next_mark) is not None and mark[0] <= until:
            self.job.outputs.pop_mark()
            self.connection.set_target(self._heaters[mark[1]], mark[2] / 100)

    def _run(self, clock: int) -> None:
        while self.connection.now < clock:
            before, looks = thread_cpu_s(), self._must_check_filament()
            stretch_s = min(self.every_s, _LOOK_S) if looks else self.every_s
            self.connection.run(round(min(clock, self.connection.now + stretch_s * self._hz)))
            self._wire_cpu_s += thread_cpu_s() - before
            if looks:
                self._check_filament()
            if self._progress:
                self._progress(self._where())

    def _must_check_filament(self) -> bool:
        """Whether the next moves on the board may move filament in a hotend that is below its
        minimum temperature."""
        checks = self._checks
        if checks is None or self.connection.now - self.base >= checks.unsure_until:
            self._filament = None
            return False
        if self._filament is None:
            self._filament = {name: self.board.steps(name) for name, _ in checks.cold_filament()}
        return True

    def _check_filament(self) -> None:
        """Raises InputError if filament that is too cold has moved."""
        assert self._checks is not None
        assert self._filament is not None
        for name, cold in self._checks.cold_filament():
            before, self._filament[name] = self._filament[name], self.board.steps(name)
            if cold and self._filament[name] != before:
                line = self.job.history.line_at(self.connection.now - self.base)
                raise InputError([with_option(Problem("input.cold", self._path, line or None))])

    def _where(self) -> Progress:
        clock = self.connection.now - self.base
        (begin, share, layer), (end, to_share, to_layer) = self._from, self._to
        done = self.job.history.line_at(clock) - 1 if clock < self.job.clock else end
        part = min(max(done - begin, 0) / max(end - begin, 1), 1.0)
        heaters = {name: self.connection.heaters[name] for name in self._heaters}
        return Progress(
            share + (to_share - share) * part,
            layer + int((to_layer - layer) * part),
            max(clock, 0) / self._hz,
            self._heat_s,
            {name: heater.celsius for name, heater in heaters.items()},
            {name: heater.target for name, heater in heaters.items()},
            {name: heater.power for name, heater in heaters.items()},
        )

    def _on_its_way(self, name: str) -> bool:
        heater = self.connection.heaters[name]
        return heater.target > 0 and not heater.settled and heater.fault is None

    def _goes_on_without(self, name: str) -> bool:
        return self._machine.heaters[name].on_fault == "heater"

    def _heater_failed(self, name: str, fault: HeaterFault) -> None:
        """Continues a print without a heater only if the machine file allows it."""
        if self._goes_on_without(name):
            return
        if self._machine.heaters[name].on_fault == "machine":
            self.connection.emergency_stop()
        for heater in self._heaters:
            self.connection.set_target(heater, 0.0)
        with suppress(MachineError):  # a stopped board raises
            self.connection.run(self.connection.now + round(_SLICE_S * self._hz))
        raise MachineError([fault.problem])

    def _too_slow(self, heaters: list[str]) -> MachineError:
        name = next(name for name in heaters if self._on_its_way(name))
        heater = self.connection.heaters[name]
        return MachineError.of(
            "machine.slow-heater", axis=name, value=heater.celsius, limit=heater.target
        )

    def _fill(self, result: PrintResult) -> None:
        machine, job = self._machine, self.job
        links = [connection.link for connection in self.connection.connections]
        spec = machine.core_spec()
        result.heat_time_s = self._heat_s
        axes, extruders = ([row["name"] for row in spec[key]] for key in ("axes", "extruders"))
        result.take_plan(job, axes, extruders, machine)
        result.take_steps(job, self._hz)
        result.first_layer = self.first_layer.layer if self.first_layer else None
        steppers = [row["name"] for row in spec["steppers"]]
        result.steps = {s: self.board.steps(s) for s in steppers}
        result.final_steps = {s: self.board.net_steps(s) for s in steppers}
        result.queue_step_commands = sum(link.queue_steps for link in links)
        result.wire_bytes = sum(link.wire_bytes for link in links)
        result.stream_hash = "-".join(f"{link.stream_hash:016x}" for link in links)
        result.errors = [
            f"stepper {s}: the board made {result.final_steps[s]} net steps, expected {wanted}"
            for s, wanted in result.net_steps_expected.items()
            if result.final_steps[s] != wanted
        ]

    def _fill_cost(self, result: PrintResult, name: str) -> None:
        result.warnings = self._commands.warnings(name)
        result.warnings += [
            str(f) for f in self.connection.faults if self._goes_on_without(f.heater)
        ]
        wire = self.connection.main.wire
        board = self._wire_cpu_s * (wire.device_share if isinstance(wire, _core.Pump) else 0.0)
        result.cpu_s = self.job.results.cpu() | {
            "wire": self._wire_cpu_s - board,
            "board": board,
            "total": self._cpu_s + self._probing.cpu_s,
        }
        result.process_peak_rss_mb = process_peak_rss_mb()
