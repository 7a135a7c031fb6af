"""Commands of Klipper that Passo does not have yet, and that a print must not leave out."""

from __future__ import annotations

from passo.errors import CommandError
from passo.gcode.command import Command
from passo.gcode.parameters import rest
from passo.gcode.registry import Subject, When, command
from passo.printer.wait_requests import Reply

_SYNC = "One motor pushes the filament of each tool; no other motor can follow it yet."


class NotYet:
    """Refuses commands, each with its reason."""

    @command(
        "SYNC_EXTRUDER_MOTION",
        Subject.FILAMENT,
        When.PLANNED,
        f"Is refused. {_SYNC}",
        rest("EXTRUDER MOTION_QUEUE", "the extruder, and that which it follows"),
        lacks=_SYNC,
    )
    def _sync(self, command: Command, _: Reply) -> None:
        raise _refused(command, _SYNC)


def _refused(command: Command, why: str) -> CommandError:
    return CommandError.of("command.not-yet", axis=command.code, value=why.rstrip("."))
