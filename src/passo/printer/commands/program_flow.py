"""Commands that start, position, stop and end a program."""

from __future__ import annotations

import re
from math import nan
from typing import TYPE_CHECKING

from passo import _core
from passo.config.predefined_moves import PredefinedMove, hooked
from passo.errors import CommandError
from passo.gcode.command import Command
from passo.gcode.parameters import anything, axes, flag, integer, rest
from passo.gcode.registry import Subject, When, command, in_program
from passo.motion.axis_slots import SLOTS
from passo.motion.predefined_moves import named, not_made, target_of
from passo.motion.set_position import place_of_actuators, place_of_axes
from passo.printer.commands.kinematic_position import positions
from passo.printer.input_errors import problem_of
from passo.printer.skipped_commands import SkippedCommand, SkippedCommands
from passo.printer.wait_requests import Reply, Stop, Wait, WaitForHoming, WaitForMoves

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.printer.commands.outputs import Outputs

# The text that the interpreter gives its own events. A program cannot produce it, because the lexer
# removes trailing blanks.
_BY_INTERPRETER = re.compile(r"([A-Z]-?\d+\.\d{6} )+")
MAX_BABYSTEP_MM = 2.0  # maximum of one command


def by_interpreter(command: Command) -> bool:
    """Whether the interpreter itself has produced this command: G92 of motors as G92.1, which a
    program cannot write."""
    return _BY_INTERPRETER.fullmatch(command.text) is not None


def babysteps(command: Command) -> list[tuple[int, float]]:
    """M290: the distances, mm, by axis number; S means Z."""
    words = command.words()
    words.setdefault("Z", words.get("S", 0.0))
    return [(i, words[letter]) for i, letter in enumerate("XYZ") if words.get(letter)]


def require_babystep(letter: str, mm: float) -> None:
    """Raises CommandError for a distance that is too long for one babystep."""
    if abs(mm) > MAX_BABYSTEP_MM:
        raise CommandError.bad_value(letter, mm, f"at most {MAX_BABYSTEP_MM:g} mm")


class ProgramFlow:
    """The program flow of one job. `omitted` counts skipped commands. `ended` is True after a
    command that ends the program."""

    def __init__(
        self, machine: MachineConfig, job: _core.Job, outputs: Outputs, omitted: SkippedCommands
    ) -> None:
        self._machine, self._job, self._outputs = machine, job, outputs
        self._omitted = omitted
        self.ended = False
        self.babysteps_mm = dict.fromkeys("xyz", 0.0)
        """The babysteps of the program so far, by axis."""

    def use_geometry(self, machine: MachineConfig) -> None:
        """Replaces the machine by one with another geometry."""
        self._machine = machine

    # -- positions --------------------------------------------------------------------------------

    @command(
        "G28",
        Subject.POSITIONS,
        When.EXCLUSIVE,
        "Homes these axes, without letters all. O homes only axes that are not homed, B returns to"
        " the position before. Without consoles it sets the axes to their home positions.",
        axes("X Y Z", "an axis to home"),
        flag("O", "homes only axes that are not homed"),
        flag("B", "returns to the position before"),
        anything(),
    )
    def _home(self, command: Command, _: Reply) -> Wait:
        self._outputs.laser_off()  # homing moves over the workpiece
        return WaitForHoming(command.text)

    def homed(self) -> None:
        """Call this after all axes have homed in a print without consoles: adds the predefined
        moves after homing."""
        for name, move in hooked(self._machine.moves, "after_homing"):
            self._make(name, move)

    @in_program("MOVE_TO")
    def _move_to(self, command: Command, _: Reply) -> Wait:
        name = command.string("NAME")
        move = named(self._machine.moves, name)
        return WaitForMoves(lambda: self._make(name, move))

    def _make(self, name: str, move: PredefinedMove) -> None:
        """Raises CommandError."""
        target = target_of(move, self._machine, self._job.machine_position)
        places = [target.get(slot, nan) for slot in range(SLOTS)]
        if not self._job.plan.move_to(places, move.speed_mm_s, _core.Within.LIMITS):
            raise not_made(name, problem_of(self._job, "", self._machine.geometry))

    @in_program("G92")
    def _set_position(self, command: Command, _: Reply) -> Wait:
        return self._placed(place_of_axes(command, self._machine, self._job))

    @in_program("G92.1")
    def _set_actuators(self, command: Command, _: Reply) -> Wait | None:
        if not by_interpreter(command):
            self._omitted.count(SkippedCommand.UNKNOWN, command.code, command.line)
            return None
        places = place_of_actuators(command, self._machine, self._job)
        return self._placed(places) if places else None

    @in_program("SET_KINEMATIC_POSITION")
    def _set_kinematic_position(self, command: Command, _: Reply) -> Wait:
        return self._placed(positions(command, self._machine, self._job).places)

    def _placed(self, places: dict[int, float]) -> Wait:
        """Sets positions at standstill, because a plan in progress cannot be replanned with
        them."""
        return WaitForMoves(lambda: self._job.axes.set(list(places.items())))

    @in_program("M290")
    def _babystep(self, command: Command, _: Reply) -> None:
        for axis, mm in babysteps(command):
            if not self._job.plan.shift(axis, mm):
                raise CommandError([problem_of(self._job, "", self._machine.geometry)])
            self.babysteps_mm["xyz"[axis]] += mm

    # -- waits, stops and ends --------------------------------------------------------------------

    @in_program("M18", "M84")
    @command(
        "M400",
        Subject.MOVES,
        When.EXCLUSIVE,
        "Waits until all moves are done and the machine is at standstill.",
    )
    def _finish_moves(self, _: Command, __: Reply) -> Wait:
        return WaitForMoves()

    @command(
        "SDCARD_LOOP_BEGIN",
        Subject.PRINTS,
        When.PLANNED,
        "Begins lines of a file that are printed COUNT times, with 0 until SDCARD_LOOP_DESIST.",
        integer("COUNT", "how often; 0: until SDCARD_LOOP_DESIST", 0, required=True),
    )
    @command(
        "SDCARD_LOOP_END",
        Subject.PRINTS,
        When.PLANNED,
        "Ends the lines of SDCARD_LOOP_BEGIN. Loops may be within each other.",
    )
    def _loop(self, command: Command, _: Reply) -> None:
        """Refuses a loop outside of a file, whose reader carries it out."""
        raise CommandError.of("command.only-in-file", axis=command.code)

    @in_program("M112", "M410")
    def _stop(self, command: Command, _: Reply) -> Wait:
        self._omitted.count(SkippedCommand.STOP, command.code, command.line)
        return Stop(command.code, command.line)

    @in_program("M30")
    @command(
        "EOF",
        Subject.DRILLING,
        When.EXCLUSIVE,
        "Ends the program.",
    )
    @command(
        "M2",
        Subject.DRILLING,
        When.EXCLUSIVE,
        "Ends the program.",
    )
    def _end(self, _: Command, __: Reply) -> Wait:
        self.ended = True
        return WaitForMoves()

    # -- sub-programs, cycles, objects ------------------------------------------------------------

    @command(
        "M98",
        Subject.DRILLING,
        When.PLANNED,
        "Calls the sub-program with this O number, or from this N number on, up to M99. In a file"
        " sub-programs come after the M30, M2 or M99 of the main program. At most 10 levels.",
        integer("P", "the O or N number"),
        integer("L", "repeats", 0),
        rest(),
    )
    def _call(self, command: Command, _: Reply) -> None:
        """M98: skips the call of a missing sub-program, if that is allowed."""
        self._omitted.count(SkippedCommand.UNKNOWN, f"M98 {command.text}", command.line)

    @command(
        "M99",
        Subject.DRILLING,
        When.EXCLUSIVE,
        "Ends a sub-program, and in the main program the program. With axes it has no effect: M425"
        " sets backlash compensation.",
        anything(),
    )
    def _return(self, command: Command, reply: Reply) -> Wait | None:
        """M99 outside of a sub-program is refused, because other machines restart the program
        there."""
        if command.text:
            self._omitted.count(SkippedCommand.NOT_BUILT, "M99", command.line)
            return None
        self._omitted.count(SkippedCommand.REPEAT, "M99", command.line)
        return self._end(command, reply)

    @in_program("M486")
    def _cancel_objects(self, command: Command, _: Reply) -> None:
        """Cancels objects by number, when a part of a print is read again after a console has
        cancelled them."""
        action = _core.ObjectAction
        for what, number, _name in _core.object_orders(command.code, command.text):
            if what in (action.CANCEL, action.RESTORE) and number >= 0:
                self._job.objects.cancel(number, what == action.CANCEL)
