"""The journal of prints from the card, and M1000 that goes on with one that was interrupted."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from passo.console.card_commands import CardCommands
from passo.errors import CommandError, PassoError
from passo.job.journal import Journal, Moment, Program
from passo.job.recovery import Recovery
from passo.job.runner import Runner, State
from passo.printer.printer import Stopped
from passo.printer.waits import Handler, Procedure, Reply, Wait
from passo.printer.words import Command

if TYPE_CHECKING:
    from passo.printer.printer import Printer

EVERY_S = 1.0  # of print time between two records


class RecoveryCommands:
    """Records the prints of one printer in `directory`."""

    def __init__(
        self, printer: Printer, runner: Runner, files: CardCommands, directory: Path
    ) -> None:
        self._printer, self._runner, self._files = printer, runner, files
        self._journal = Journal(directory)
        self._recorded_s = self._recorded_z_mm = 0.0
        self._interrupted = self._journal.read()
        self.planned: dict[str, Handler] = {"M1000": self._go_on}
        runner.watchers.append(self._job_changed)
        printer.watchers.append(self._time_passed)
        printer.closers.append(self._journal.leave)

    def offer(self) -> str:
        """What to tell who comes: a print that was interrupted; empty if there is none."""
        if self._interrupted is None:
            return ""
        program, moment = self._interrupted
        return (
            f"echo:The print of {program.path} was interrupted at line {moment.line}."
            " M1000 goes on with it, M1000 C forgets it"
        )

    def _job_changed(self, state: State) -> None:
        if state is State.PRINTING:
            if not self._journal.open:
                self._begin()
        elif state is not State.PAUSED:
            if self._printer.halted:
                self._journal.leave()
                self._interrupted = self._journal.read()
            elif self._journal.open:
                self._journal.end()

    def _begin(self) -> None:
        """Before the first line of a print is read."""
        reader = self._runner.reader
        if reader is None:
            return
        self._interrupted = None
        program = Program.of(self._printer.machine.uuid, self._runner.path, reader)
        reader.seek(self._runner.offset)
        try:
            self._journal.begin(program, self._moment(self._runner.first_line, self._z()))
        except OSError as error:
            self._printer.tell(f"echo:No journal of this print: {error.strerror}")
        self._recorded_s = 0.0

    def _time_passed(self) -> None:
        drive = self._printer.drive
        if not self._journal.open or self._runner.state is not State.PRINTING:
            return
        line, z_mm = self._printer.job.line_at(drive.now)  # asked often: it forgets what is past
        # A resumed print keeps Z without homing it, so every step of Z is recorded as it begins.
        if z_mm == self._recorded_z_mm and drive.now_s < self._recorded_s + EVERY_S:
            return
        self._recorded_s, self._recorded_z_mm = drive.now_s, z_mm
        try:
            self._journal.record(self._moment(line or self._runner.first_line, z_mm))
        except OSError as error:
            self._journal.leave()
            self._printer.tell(f"echo:The journal of this print ends here: {error.strerror}")

    def _z(self) -> float:
        return self._printer.job.machine_position[2]

    def _moment(self, line: int, z_mm: float) -> Moment:
        printer, job = self._printer, self._printer.job
        return Moment(
            line if line > 1 else 0,
            round(printer.drive.now_s, 3),
            round(z_mm, 6),
            {n: h.target for n, h in printer.connection.heaters.items()},
            dict(printer.commands.fans),
            job.speed_factor,
            job.flow,
        )

    def _go_on(self, command: Command, reply: Reply) -> Wait | None:
        if self._interrupted is None:
            raise CommandError.of("job.nothing-interrupted")
        program, moment = self._interrupted
        if "C" in command.text.upper():
            self._interrupted = None
            self._journal.end()
            return None
        if program.machine != self._printer.machine.uuid:
            raise CommandError.of("job.other-machine", program.path)
        return Procedure(lambda: self._recover(program, moment, reply))

    async def _recover(self, program: Program, moment: Moment, reply: Reply) -> None:
        self._files.open(program.path)
        reader = self._runner.reader
        assert reader is not None
        if moment.line == 0:
            self._runner.start()
            return
        try:
            offset = await Recovery(self._printer, program, moment, reader).run()
        except (PassoError, Stopped):
            self._runner.seek(0)
            for heater in self._printer.heaters:
                self._printer.set_target(heater, 0.0, at_once=True)
            raise
        self._runner.seek(offset, moment.line)
        reply.say(f"echo:Printing {self._runner.name} from line {moment.line}")
        self._runner.start()
