"""Keeps the journal of prints from files, and resumes an interrupted print."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from passo.errors import CardError, PassoError
from passo.gcode.command import Command
from passo.job.live.files import Files
from passo.job.live.job_state import JobState
from passo.job.live.journal import Change, Journal, Moment, Program
from passo.job.live.objects import PrintObjects
from passo.job.live.overrides import Overrides, Settings
from passo.job.live.resume_after_power_loss import Recovery
from passo.job.live.runner import Runner
from passo.printer.status import InterruptedPrint
from passo.printer.wait_requests import Stopped

if TYPE_CHECKING:
    from passo.printer.control import Control
    from passo.printer.machine_parts import MachineParts

_log = logging.getLogger(__name__)

EVERY_S = 1.0  # print time between two records
Z_MM = 0.02  # record earlier if Z matters and has moved by a tenth of a usual layer
_SAME_Z_MM = 1e-5
# A command that was sent this long ago is executed, because a board receives it at most 125 ms
# before it is due. It is unknown whether later ones are.
_UNHEARD_S = 0.1


class JournalKeeper:
    """Records the prints of one printer in `directory`."""

    def __init__(
        self,
        control: Control,
        parts: MachineParts,
        runner: Runner,
        files: Files,
        objects: PrintObjects,
        directory: Path,
    ) -> None:
        self._control, self._parts, self._motion = control, parts, parts.motion
        self._runner, self._files = runner, files
        self._journal = Journal(directory)
        self._overrides = Overrides(control, runner)
        self._settings = Settings(
            control, parts.settings, runner, self._follows, self._set_by_console
        )
        self._recorded = Moment(0, 0.0)
        self._seen_z_mm = 0.0
        self._settlings = 0
        self._interrupted = self._journal.read()
        self._program: Program | None = None  # the last program that was begun
        self._instead = ""  # reported with the offer
        objects.watchers.append(self._object_cancelled)
        runner.watchers.append(self._job_changed)
        control.state.greetings.append(self.offer)
        control.state.status_parts.append(lambda status: replace(status, interrupted=self._shown()))
        control.lifetime.as_time_passes(self._time_passed)
        control.lifetime.at_end(self._journal.leave)

    def offer(self) -> str:
        """The message about an interrupted print for a console that opens; empty if there is
        none."""
        found = self._shown()
        if found is None:
            return ""
        where = f"line {found.line}" if found.line else "its beginning"
        place = f" {found.way}" if found.way else ""
        return (
            f"echo:The print of {found.path} was interrupted at {where}."
            f" M1000 resumes it{place}, M1000 C forgets it{self._instead}"
        )

    def offer_instead(self, skipped: str) -> None:
        """Reports with the offer that `skipped` was not started because of it."""
        self._instead = f". {skipped} was not started"

    def _shown(self) -> InterruptedPrint | None:
        if self._interrupted is None:
            return None
        program, moment = self._interrupted
        if moment.line == 0:
            place = "from there"
        elif self._control.rig.positions.held and moment.origins:
            place = "from where the board has stopped"
        else:
            place = self._by_hand()
        return InterruptedPrint(program.path, moment.line, place)

    def _by_hand(self) -> str:
        """The manual steps before a resume, for a machine that cannot home all axes."""
        if self._control.machine.homing:
            return ""
        x, y, _ = self._control.machine.home_point
        return f"from X {x:g} Y {y:g}: without switches it must be moved there by hand first"

    def _job_changed(self, was: JobState, state: JobState) -> None:
        if state.prints and not was.prints:
            if not (was is JobState.PAUSED and self._journal.open):
                self._begin()
        elif was.active and not state.active:
            self._over()

    def _over(self) -> None:
        """Called when no print is running any more. A print that has stopped at a failed line can
        still be resumed, even after a power cut; without any move so far, it restarts."""
        if not self._journal.open or self._interrupted is not None:
            return
        if self._control.state.halted:
            self._journal.leave()
            self._interrupted = self._journal.read()
        elif not (self._runner.stands and self._has_moved()):
            self._end()

    def _has_moved(self) -> bool:
        """Whether a move of the print has started, or will start although the print is stopped."""
        control = self._control
        line = self._recorded.line or control.rig.job.history.line_at(control.rig.queue.passed)
        return line > 1 or not control.rig.queue.standing

    def _begin(self) -> None:
        """Starts the journal, before the first line of a print is read."""
        reader = self._runner.file.reader
        if reader is None or self._runner.file.loops.used:
            return
        followed = self._journal.open or self._interrupted is not None
        self._interrupted = None
        self._seen_z_mm = self._z()
        self._control.rig.positions.confirm()
        self._settlings = self._control.rig.positions.settlings
        self._overrides.reset()
        self._settings.reset()
        # A print that has stopped at a failed line continues after the line.
        line = (
            self._control.rig.job.history.line_at(self._control.rig.queue.passed)
            or self._runner.file.first_line
        )
        self._recorded = self._moment(line, self._seen_z_mm)
        read = reader.tell()  # more bytes are read than planned
        try:
            control, runner = self._control, self._runner
            program = Program.of(control.machine.uuid, runner.path, reader)
            if self._program is None or self._program != program or runner.offset == 0:
                begun = program.begun(self._control, self._parts.settings)
                self._program = replace(begun, allow=runner.skips.allowed, run=runner.run)
            elif not followed:  # a line has failed before the first move
                self._program.changes.append(self._settings.held())
            program = self._program  # a resumed print keeps its start state
            self._begin_journal(program, self._recorded)
        except CardError as error:
            self._end()  # the record of an older print is invalid in any case
            self._warn(f"No journal of this print: {error}")
        finally:
            reader.seek(read)

    def _time_passed(self) -> None:
        control, active = self._control, self._runner.active
        if not active:
            self._over()
        waits = None if active else self._interrupted
        if not (waits or self._journal.open) or self._motion.homer.active:
            return
        if control.rig.connection.unacknowledged_s > _UNHEARD_S:
            return
        if waits is not None:
            self._keep_z(*waits)
        elif self._runner.file.loops.used:
            self._end()
            self._warn("This print cannot be resumed after a power cut: it repeats its lines")
        else:
            self._follow_print()

    def _follow_print(self) -> None:
        control = self._control
        queue = control.rig.queue
        # Use the time up to which targets are set; otherwise the line of a later move would be
        # recorded with an earlier target. This call drops past lines, so make it often.
        line = control.rig.job.history.line_at(queue.passed)
        before, self._seen_z_mm = self._seen_z_mm, self._z()
        settlings = control.rig.positions.settlings
        elsewhere, self._settlings = settlings != self._settlings, settlings
        early = queue.passed / queue.hz < self._recorded.print_s + EVERY_S
        if early and not elsewhere and not self._z_matters(before):
            return
        last = self._recorded
        moment = self._moment(line or last.line, self._seen_z_mm)
        # Heaters that are switched off during a pause must heat again for the print.
        if self._runner.state is JobState.PAUSED:
            moment = replace(moment, line=last.line, print_s=last.print_s, targets_c=last.targets_c)
        elif not self._runner.active:
            wanted = {n: c or last.targets_c.get(n, 0.0) for n, c in moment.targets_c.items()}
            moment = replace(moment, targets_c=wanted)
        if replace(moment, print_s=last.print_s) != last:
            self._record(moment)

    def _keep_z(self, program: Program, moment: Moment) -> None:
        """Records the Z of the machine if it moves before an interrupted print is resumed, in case
        of another interruption."""
        if "z" not in self._control.rig.positions.known or self._control.state.halted:
            return
        before, self._seen_z_mm = self._seen_z_mm, self._z()
        self._recorded = moment
        if not self._z_matters(before):
            return
        moment = replace(moment, z_mm=round(self._seen_z_mm, 6))
        self._interrupted = program, moment
        if self._journal.open:
            self._record(moment)
        elif self._journal.path.exists():  # not if an earlier write has failed
            self._begin_journal(program, moment)

    def _begin_journal(self, program: Program, moment: Moment) -> None:
        try:
            self._journal.begin(program, moment)
        except OSError as error:
            self._warn(f"No journal of this print: {error.strerror}")

    def _follows(self) -> bool:
        """Whether the journal belongs to the current print, which runs or has stopped at a failed
        line."""
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
        """Whether Z has moved far, or has stopped at another position, since the last record. If Z
        moves independently, a resumed print uses this Z without homing it."""
        if self._control.machine.geometry.lifts_together:
            return False
        distance_mm = abs(self._seen_z_mm - self._recorded.z_mm)
        return distance_mm >= Z_MM or (distance_mm > _SAME_Z_MM and self._seen_z_mm == before_mm)

    def _record(self, moment: Moment) -> None:
        self._recorded = moment
        self._write(lambda: self._journal.record(moment))

    def _write(self, record: Callable[[], None]) -> None:
        try:
            record()
        except OSError as error:
            # Remove the journal, which would soon be outdated.
            self._end()
            self._warn(f"This print cannot be resumed after a power cut: {error.strerror}")

    def _end(self) -> None:
        try:
            self._journal.end()
        except OSError as error:
            self._warn(f"The journal of the print stays: {error.strerror}")

    def _warn(self, text: str) -> None:
        self._control.state.announce(_log, logging.WARNING, text)

    def _z(self) -> float:
        job = self._control.rig.job
        return (job.history.position_at(self._control.rig.queue.passed) or job.machine_position)[2]

    def _moment(self, line: int, z_mm: float) -> Moment:
        control = self._control
        babysteps_mm = self._motion.offsets.of_program_mm(suspended=control.rig.job.stops.suspended)
        return Moment(
            line if line > 1 else 0,
            round(control.rig.queue.passed / control.rig.queue.hz, 3),
            round(z_mm, 6),
            {n: h.target for n, h in control.rig.connection.heaters.items()},
            self._overrides.held,
            {axis: mm for axis, mm in babysteps_mm.items() if mm},
            control.rig.positions.origins(),
        )

    def interrupted(self) -> tuple[Program, Moment] | None:
        """The interrupted print that can be resumed, and its last moment."""
        return self._interrupted

    def forget(self) -> None:
        """Discards the interrupted print."""
        self._interrupted = None
        self._end()

    async def resume(self, program: Program, moment: Moment) -> None:
        """Moves the machine to the position of the interruption, and starts the print there. Call
        it with the motion lock held. Raises CommandError, CardError, InputError, MachineError,
        Stopped."""
        self._files.open(program.path)
        reader = self._runner.file.reader
        assert reader is not None
        self._program = program
        try:
            recovery = Recovery(self._control, self._parts, program, moment, reader)
            with self._runner.keep() as seek:
                offset = await recovery.run()
                seek(offset)
            if offset == 0:  # the seek to the beginning has reset the cancelled objects
                for line in (line for _, lines in program.changes for line in lines):
                    code, _, words = line.partition(" ")
                    if code == "M486":
                        self._control.rig.commands.run(Command(0, "M", 486, 0, "", words))
            # Settings that were made after more of the file had been read apply before the next
            # line now.
            changes = [(min(at, offset), lines) for at, lines in program.changes]
            self._program = replace(program, changes=changes)
        except (PassoError, Stopped):
            self._runner.seek(0)
            self._control.targets.switch_off(self._control.machine.heaters)
            raise
