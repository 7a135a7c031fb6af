"""Keeps the journal of the prints of files, and resumes one that was interrupted."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from passo.errors import CardError, PassoError
from passo.gcode.command import Command
from passo.job.live.job_state import JobState
from passo.job.live.journal import Change, Journal, Moment, Program
from passo.job.live.library import Library
from passo.job.live.objects import PrintObjects
from passo.job.live.overrides import Overrides, Settings
from passo.job.live.resume_after_power_loss import Recovery
from passo.job.live.runner import Runner
from passo.printer.wait_requests import Stopped

if TYPE_CHECKING:
    from passo.printer.printer import Printer

_log = logging.getLogger(__name__)

EVERY_S = 1.0  # of print time between two records
Z_MM = 0.02  # or earlier, if Z must be kept and has moved by a tenth of a usual layer
_NO_WAY_MM = 1e-5
# A board had 125 ms to execute a command that was sent so long ago; whether it has later ones is
# unknown.
_UNHEARD_S = 0.1


class JournalKeeper:
    """Records the prints of one printer in `directory`."""

    def __init__(
        self,
        printer: Printer,
        runner: Runner,
        library: Library,
        objects: PrintObjects,
        directory: Path,
    ) -> None:
        self._printer, self._runner, self._library = printer, runner, library
        self._journal = Journal(directory)
        self._overrides = Overrides(printer, runner)
        self._settings = Settings(printer, runner, self._follows, self._set_by_console)
        self._recorded = Moment(0, 0.0)
        self._seen_z_mm = 0.0
        self._settlings = 0
        self._interrupted = self._journal.read()
        self._program: Program | None = None  # that was begun last
        self.instead = ""  # reported with the offer: what was not done because of it
        objects.watchers.append(self._object_cancelled)
        runner.watchers.append(self._job_changed)
        printer.watchers.append(self._time_passed)
        printer.closers.append(self._journal.leave)

    def offer(self) -> str:
        """The greeting for a console: a print that was interrupted; empty if there is none."""
        if self._interrupted is None:
            return ""
        program, moment = self._interrupted
        if moment.line == 0:
            where, way = "its beginning", " from there"
        else:
            held = self._printer.positions.held and moment.origins
            where = f"line {moment.line}"
            way = " from where the board has stopped" if held else self._by_hand()
        return (
            f"echo:The print of {program.path} was interrupted at {where}."
            f" M1000 resumes it{way}, M1000 C forgets it{self.instead}"
        )

    def _by_hand(self) -> str:
        """What the user has to do first for a machine that cannot find its position."""
        if self._printer.machine.homing:
            return ""
        x, y, _ = self._printer.machine.home_point
        return f" from X {x:g} Y {y:g}: without switches it must be moved there by hand first"

    def _job_changed(self, was: JobState, state: JobState) -> None:
        if state.prints and not was.prints:
            if not (was is JobState.PAUSED and self._journal.open):
                self._begin()
        elif was.active and not state.active:
            self._over()

    def _over(self) -> None:
        """No print is running. One that has stopped at a failed line can still be resumed, also
        after a power cut; if nothing has moved yet, it restarts."""
        if not self._journal.open or self._interrupted is not None:
            return
        if self._printer.halted:
            self._journal.leave()
            self._interrupted = self._journal.read()
        elif not (self._runner.stands and self._has_moved()):
            self._end()

    def _has_moved(self) -> bool:
        """Whether a move of the print has begun, or will begin although it is stopped."""
        printer = self._printer
        line = self._recorded.line or printer.job.line_at(printer.queue.passed)
        return line > 1 or not printer.queue.standing

    def _begin(self) -> None:
        """Begins the journal before the first line of a print is read."""
        reader = self._runner.reader
        if reader is None:
            return
        followed = self._journal.open or self._interrupted is not None
        self._interrupted = None
        self._seen_z_mm = self._z()
        self._printer.positions.trust()
        self._settlings = self._printer.positions.settlings
        self._overrides.begin()
        self._settings.begin()
        # A print that was stopped by a line continues after that line.
        line = self._printer.job.line_at(self._printer.queue.passed) or self._runner.first_line
        self._recorded = self._moment(line, self._seen_z_mm)
        read = reader.tell()  # more than was planned of it
        try:
            printer, runner = self._printer, self._runner
            program = Program.of(printer.machine.uuid, runner.path, reader)
            if self._program is None or self._program != program or runner.offset == 0:
                self._program = program.begun(printer)
            elif not followed:  # a line has failed before anything moved
                self._program.changes.append(self._settings.held())
            program = self._program  # as it was begun, if it resumes
            self._begin_journal(program, self._recorded)
        except CardError as error:
            self._end()  # an older print is over in any case
            self._warn(f"No journal of this print: {error}")
        finally:
            reader.seek(read)

    def _time_passed(self) -> None:
        printer, active = self._printer, self._runner.active
        if not active:
            self._over()
        waits = None if active else self._interrupted
        if not (waits or self._journal.open) or printer.homer.active:
            return
        if printer.connection.unheard_s > _UNHEARD_S:
            return
        if waits is not None:
            self._keep_z(*waits)
        else:
            self._follow_print()

    def _follow_print(self) -> None:
        printer = self._printer
        queue = printer.queue
        # The time up to which targets have been set: otherwise the line of a later move would be
        # recorded with a heater's earlier target. Call it often: it drops past lines.
        line = printer.job.line_at(queue.passed)
        before, self._seen_z_mm = self._seen_z_mm, self._z()
        settlings = printer.positions.settlings
        elsewhere, self._settlings = settlings != self._settlings, settlings
        early = queue.passed / queue.hz < self._recorded.print_s + EVERY_S
        if early and not elsewhere and not self._z_matters(before):
            return
        last = self._recorded
        moment = self._moment(line or last.line, self._seen_z_mm)
        # Heaters that are switched off meanwhile must heat again for the print.
        if self._runner.state is JobState.PAUSED:
            moment = replace(moment, line=last.line, print_s=last.print_s, targets_c=last.targets_c)
        elif not self._runner.active:
            wanted = {n: c or last.targets_c.get(n, 0.0) for n, c in moment.targets_c.items()}
            moment = replace(moment, targets_c=wanted)
        if replace(moment, print_s=last.print_s) != last:
            self._record(moment)

    def _keep_z(self, program: Program, moment: Moment) -> None:
        """Z has moved while an interrupted print waits to be resumed: records Z, in case of another
        interruption."""
        if "z" not in self._printer.positions.known or self._printer.halted:
            return
        before, self._seen_z_mm = self._seen_z_mm, self._z()
        self._recorded = moment
        if not self._z_matters(before):
            return
        moment = replace(moment, z_mm=round(self._seen_z_mm, 6))
        self._interrupted = program, moment
        if self._journal.open:
            self._record(moment)
        elif self._journal.path.exists():  # not if it could not be written before
            self._begin_journal(program, moment)

    def _begin_journal(self, program: Program, moment: Moment) -> None:
        try:
            self._journal.begin(program, moment)
        except OSError as error:
            self._warn(f"No journal of this print: {error.strerror}")

    def _follows(self) -> bool:
        """Whether the recorded print is running, or has stopped at a failed line."""
        return self._journal.open and self._interrupted is None

    def _set_by_console(self, change: Change) -> None:
        assert self._program is not None
        self._program.changes.append(change)
        self._write(lambda: self._journal.record_change(change))

    def _object_cancelled(self, number: int, cancelled: bool) -> None:
        if self._follows():
            order = f"M486 {'P' if cancelled else 'U'}{number}"
            self._set_by_console((self._runner.offset, [order]))

    def _z_matters(self, before_mm: float) -> bool:
        """Whether Z has moved far since the last record, or has stopped at another position. A
        print that resumes keeps Z without homing if Z moves alone."""
        if self._printer.machine.geometry.lifts_together:
            return False
        way_mm = abs(self._seen_z_mm - self._recorded.z_mm)
        return way_mm >= Z_MM or (way_mm > _NO_WAY_MM and self._seen_z_mm == before_mm)

    def _record(self, moment: Moment) -> None:
        self._recorded = moment
        self._write(lambda: self._journal.record(moment))

    def _write(self, record: Callable[[], None]) -> None:
        try:
            record()
        except OSError as error:
            # Its content would soon be outdated.
            self._end()
            self._warn(f"This print cannot be resumed after a power cut: {error.strerror}")

    def _end(self) -> None:
        try:
            self._journal.end()
        except OSError as error:
            self._warn(f"The journal of the print stays: {error.strerror}")

    def _warn(self, text: str) -> None:
        self._printer.state.announce(_log, logging.WARNING, text)

    def _z(self) -> float:
        job = self._printer.job
        return (job.position_at(self._printer.queue.passed) or job.machine_position)[2]

    def _moment(self, line: int, z_mm: float) -> Moment:
        printer = self._printer
        babysteps_mm = printer.offsets.of_program_mm(suspended=printer.job.suspended)
        return Moment(
            line if line > 1 else 0,
            round(printer.queue.passed / printer.queue.hz, 3),
            round(z_mm, 6),
            {n: h.target for n, h in printer.connection.heaters.items()},
            self._overrides.held,
            {axis: mm for axis, mm in babysteps_mm.items() if mm},
            printer.positions.origins(),
        )

    def interrupted(self) -> tuple[Program, Moment] | None:
        """The print that can be resumed, and its position."""
        return self._interrupted

    def forget(self) -> None:
        """The interrupted print will not be resumed."""
        self._interrupted = None
        self._end()

    async def resume(self, program: Program, moment: Moment) -> None:
        """Brings the machine to where the print was interrupted, and starts it there; the caller
        holds the motion lock. Raises CommandError, CardError, InputError, MachineError, Stopped."""
        self._library.open(program.path)
        reader = self._runner.reader
        assert reader is not None
        self._program = program
        try:
            recovery = Recovery(self._printer, program, moment, reader)
            with self._runner.keep() as seek:
                offset = await recovery.run()
                seek(offset)
            if offset == 0:  # seeking the beginning has reset which objects are cancelled
                for line in (line for _, lines in program.changes for line in lines):
                    code, _, words = line.partition(" ")
                    if code == "M486":
                        self._printer.commands.run(Command(0, "M", 486, 0, "", words))
            # Settings that were made after more of the file had been read apply before the next
            # line.
            changes = [(min(at, offset), lines) for at, lines in program.changes]
            self._program = replace(program, changes=changes)
        except (PassoError, Stopped):
            self._runner.seek(0)
            self._printer.targets.switch_off(self._printer.machine.heaters)
            raise
