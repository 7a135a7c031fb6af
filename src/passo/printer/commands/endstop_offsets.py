"""M666: offsets of endstops, for the towers of a delta or for the motors of Z."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.errors import CommandError
from passo.gcode.command import Command
from passo.gcode.parameters import integer, number
from passo.gcode.registry import Kind, Subject, When, command
from passo.printer.wait_requests import Reply, Wait, WaitForMoves

if TYPE_CHECKING:
    from passo.printer.commands.delta_calibration import DeltaCommands
    from passo.printer.commands.z_motors import EndstopOffsets

NO_OFFSETS = "This machine has one endstop for each axis."
_MOST_MM = 50.0


class EndstopCommands:
    """M666 of one printer, for the towers of its delta or for its Z motors."""

    def __init__(self, delta: DeltaCommands | None, motors: EndstopOffsets | None) -> None:
        self._delta, self._motors = delta, motors

    @command(
        "M666",
        Subject.LEVELLING,
        When.EXCLUSIVE,
        "Sets how much endstops are off. X, Y and Z are the towers of a delta: as Marlin has it, at"
        ' most 0, and lower for a higher endstop; with levelling.dialect = "rrf" higher for a'
        " higher endstop. On other machines Z is the endstop of motor S of Z (2), and higher for a"
        " higher endstop. Without parameters it reports them.",
        number("X Y Z", "the offset", "mm", -_MOST_MM, _MOST_MM),
        integer("S", "the motor of Z", 1, default=2),
        kind=Kind.PROBED,
        lacks=NO_OFFSETS,
    )
    def _offsets(self, command: Command, reply: Reply) -> Wait | None:
        words = command.words()
        if self._delta is not None:
            if words.keys() & set("XYZ"):
                delta = self._delta
                return WaitForMoves(lambda: delta.move_endstops(words))
            reply.say(f"  {self._delta.endstop_line()}")
        elif self._motors is not None:
            if "Z" in words:
                return self._motor(self._motors, words)
            for line in self._motors.setting_lines():
                reply.say(f"  {line}")
        return None

    def _motor(self, motors: EndstopOffsets, words: dict[str, float]) -> Wait:
        names, n, mm = list(motors.offsets), words.get("S", 2.0), words["Z"]
        if n not in range(1, len(names) + 1):
            raise CommandError.bad_value("S", n, f"1 to {len(names)}")
        return WaitForMoves(lambda: motors.use(motors.offsets | {names[int(n) - 1]: mm}))
