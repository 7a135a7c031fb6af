"""Commands that name a part which the machine may lack."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.part_names import found_name
from passo.errors import CommandError
from passo.printer.skipped_commands import SkippedCommand
from passo.printer.wait_requests import without_effect

if TYPE_CHECKING:
    from collections.abc import Collection

    from passo import _core
    from passo.gcode.command import Command
    from passo.printer.skipped_commands import SkippedCommands
    from passo.printer.stand_ins import StandIns
    from passo.printer.wait_requests import Reply


def report_lack(job: _core.Job, command: Command, reply: Reply, lacks: str) -> None:
    """Reports that the machine lacks a part. Macros, which are written for other printers,
    continue."""
    if job.program.macro_depth:
        reply.note(command.code, without_effect(command.code, lacks))
    else:
        reply.no_part(command.code, lacks)


class NamedParts:
    """The parts of one kind that commands of a job name. `sections` are those of the parts that
    the machine file only keeps for macros; a command for one of these is counted in `omitted`."""

    def __init__(
        self,
        names: Collection[str],
        lacks: str,
        sections: tuple[str, ...],
        job: _core.Job,
        stand_ins: StandIns,
        omitted: SkippedCommands,
    ) -> None:
        self._names, self._lacks, self._sections = names, lacks, sections
        self._job, self._stand_ins, self._omitted = job, stand_ins, omitted

    def find(self, command: Command, key: str, reply: Reply) -> str | None:
        """The part that the parameter `key` names. None for one that the machine does not have.
        Raises CommandError if the machine has others."""
        written = command.string(key)
        name = found_name(self._names, written)
        if name is not None:
            return name
        if self._stand_ins.named(self._sections, written) is not None:
            self._omitted.count(SkippedCommand.NOT_BUILT, command.code, command.line)
        elif self._names:
            limit = ", ".join(self._names)
            raise CommandError.of(
                "command.value", axis=key, value=written or "missing", limit=limit
            )
        else:
            report_lack(self._job, command, reply, self._lacks)
        return None
