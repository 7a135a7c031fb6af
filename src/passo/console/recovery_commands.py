"""M1000: resumes an interrupted print."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.errors import CommandError
from passo.gcode.command import Command
from passo.gcode.parameters import flag
from passo.gcode.registry import Kind, Subject, When, command
from passo.job.live.journal import Moment, Program
from passo.job.live.journal_keeper import JournalKeeper
from passo.job.live.runner import Runner
from passo.printer.wait_requests import Reply, Wait, WaitForProcedure

if TYPE_CHECKING:
    from passo.printer.control import Control


class RecoveryCommands:
    """M1000 of one printer."""

    def __init__(self, control: Control, runner: Runner, journal: JournalKeeper) -> None:
        self._control, self._runner, self._keeper = control, runner, journal

    @command(
        "M1000",
        Subject.PRINTS,
        When.EXCLUSIVE,
        "Resumes a print that was interrupted; C drops it.",
        flag("C", "drops it"),
        kind=Kind.SERVED,
    )
    def _go_on(self, command: Command, reply: Reply) -> Wait | None:
        found = self._keeper.interrupted()
        if found is None:
            raise CommandError.of("job.nothing-interrupted")
        program, moment = found
        if command.flag("C"):
            self._keeper.forget()
            return None
        if program.machine != self._control.machine.uuid:
            raise CommandError.of("job.other-machine", program.path)
        return WaitForProcedure(lambda: self._resume(program, moment, reply))

    async def _resume(self, program: Program, moment: Moment, reply: Reply) -> None:
        await self._keeper.resume(program, moment)
        where = f"line {moment.line}" if moment.line else "its beginning"
        reply.say(f"echo:Printing {self._runner.name} from {where}")
        self._runner.start(skips=self._control.skips.allowing(program.allow), run=program.run)
