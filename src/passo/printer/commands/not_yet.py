"""Commands of Klipper that Passo does not have yet, and that a print must not leave out."""

from __future__ import annotations

from passo.errors import CommandError
from passo.gcode.command import Command
from passo.gcode.registry import Subject, When, command
from passo.printer.wait_requests import Reply

_SYNC = "One motor pushes the filament of each tool; no other motor can follow it yet."
_LOOP = "Files are read once, from begin to end; a macro can repeat its lines with for."


class NotYet:
    """Refuses commands, each with its reason."""

    @command(
        "SYNC_EXTRUDER_MOTION",
        Subject.FILAMENT,
        When.PLANNED,
        "EXTRUDER MOTION_QUEUE",
        f"Is refused. {_SYNC}",
        bare=None,
        lacks=_SYNC,
    )
    def _sync(self, command: Command, _: Reply) -> None:
        raise _refused(command, _SYNC)

    @command(
        "SDCARD_LOOP_BEGIN",
        Subject.PRINTS,
        When.PLANNED,
        "COUNT",
        f"Is refused. {_LOOP}",
        bare=None,
        lacks=_LOOP,
    )
    @command(
        "SDCARD_LOOP_END",
        Subject.PRINTS,
        When.PLANNED,
        "",
        f"Is refused. {_LOOP}",
        bare=None,
        lacks=_LOOP,
    )
    def _loop(self, command: Command, _: Reply) -> None:
        raise _refused(command, _LOOP)


def _refused(command: Command, why: str) -> CommandError:
    return CommandError.of("command.not-yet", axis=command.code, value=why.rstrip("."))
