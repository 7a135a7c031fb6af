"""MOVE_TO and SET_MOVE: the moves that the machine file names."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from pydantic import ValidationError

from passo.errors import CommandError
from passo.gcode.command import Command, numeral
from passo.gcode.parameters import number, text
from passo.gcode.registry import Kind, Subject, When, command
from passo.motion.predefined_moves import PredefinedMoves, named
from passo.printer.wait_requests import Reply, Wait, WaitForProcedure

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig


class PredefinedMoveCommands:
    """The commands of the moves of one printer."""

    def __init__(self, machine: MachineConfig, moves: PredefinedMoves) -> None:
        self._machine, self._moves = machine, moves

    @command(
        "MOVE_TO",
        Subject.MOVES,
        When.EXCLUSIVE,
        "Makes the move of that name in `[moves]` of the machine file. Its hook makes it without a"
        " command.",
        text("NAME", "the name of the move"),
    )
    def _move(self, command: Command, _: Reply) -> Wait | None:
        name = command.string("NAME")
        named(self._moves.moves, name)
        return WaitForProcedure(lambda: self._moves.run(name))

    @command(
        "SET_MOVE",
        Subject.MOVES,
        When.EXCLUSIVE,
        "Changes a move of `[moves]`, as M926 does by APrinter's names (`Move1X`); M500 stores it."
        " Only axes that the move has can be given.",
        text("NAME", "the name of the move"),
        number("ENABLED", "0: it is not made"),
        number("SPEED", "its speed", "mm/s", 0, above=True),
        number("X Y Z", "its end", "mm"),
        kind=Kind.SERVED,
    )
    def _set(self, command: Command, _: Reply) -> Wait | None:
        name = command.string("NAME")
        move = named(self._moves.moves, name)
        position_mm = {
            axis: command.value(axis.upper(), mm) for axis, mm in move.position_mm.items()
        }
        for axis, mm in position_mm.items():
            low, high = self._machine.axes[axis].min_mm, self._machine.axes[axis].max_mm
            if move.relative:
                low, high = low - high, high - low
            if not low <= mm <= high:
                raise CommandError.bad_value(axis.upper(), mm, f"{low:g} to {high:g} mm")
        speed_mm_s = command.value("SPEED", move.speed_mm_s)
        values = {
            "position_mm": position_mm,
            "speed_mm_s": speed_mm_s,
            "enabled": command.value("ENABLED", float(move.enabled)) != 0,
        }
        try:
            changed = type(move).model_validate({**move.model_dump(), **values})
        except ValidationError as error:
            limit = error.errors()[0]["msg"]
            raise CommandError.bad_value("SPEED", speed_mm_s, limit) from None
        self._moves.moves[name] = changed
        return None

    def setting_lines(self) -> Iterator[str]:
        """The commands that restore the moves."""
        for name, move in self._moves.moves.items():
            words = [f"{axis.upper()}={numeral(mm)}" for axis, mm in move.position_mm.items()]
            words += [f"ENABLED={int(move.enabled)}", f"SPEED={numeral(move.speed_mm_s)}"]
            yield f"SET_MOVE NAME={name} {' '.join(words)}"
