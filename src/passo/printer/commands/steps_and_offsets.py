"""Commands for motion settings: scales, offsets, retraction, filament."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING

from passo.config.motor_roles import axis_order
from passo.config.types import MAX_SCALE, MIN_SCALE
from passo.errors import CommandError
from passo.gcode.command import Command, numeral
from passo.gcode.parameters import TOOL, axes, ignored, integer, number
from passo.gcode.registry import Kind, Subject, When, command, in_program
from passo.geometry.base import Unreachable
from passo.motion.axis_slots import Z
from passo.motion.homing import Homer
from passo.motion.offsets import Offsets
from passo.printer.commands.extruder_words import extruder_of, with_extruders
from passo.printer.commands.klipper_commands import offset_steps
from passo.printer.commands.program_flow import MAX_BABYSTEP_MM, babysteps, require_babystep
from passo.printer.live_rig import LiveRig
from passo.printer.wait_requests import Reply, Wait, WaitForMoves

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig


class MotionCommands:
    """The motion settings of one printer. Settings in a program apply to later moves. Lines of a
    console during a print are live: they also change the moves that the board does not have yet.
    M220 and M290 alone in a line are live from every console."""

    def __init__(self, rig: LiveRig, offsets: Offsets, homer: Homer) -> None:
        self._rig, self._homer = rig, homer
        self.offsets = offsets
        self._axes = axis_order(rig.machine.axes)

    @property
    def _machine(self) -> MachineConfig:
        return self._rig.machine

    # -- scales and limits ------------------------------------------------------------------------

    def _places(self, name: str | None) -> list[int]:
        """The numbers, in the core's order, of the motors that drive an actuator, axis or
        extruder."""
        wanted = self._machine.drivable.by_name.get(name or "")
        rows = self._rig.job.motors.statistics()
        driven_by = self._machine.driven_by
        return [i for i, r in enumerate(rows) if wanted and driven_by(r["name"]) == wanted]

    @command(
        "M92",
        Subject.MOTORS,
        When.EXCLUSIVE,
        "Sets the steps per millimetre or degree. H and L report which layer heights are whole"
        " steps of Z's motor.",
        axes("X Y Z E", "the scale", "microsteps per mm or degree", MIN_SCALE, MAX_SCALE, but="H"),
        TOOL,
        number("H", "microsteps, for the layers", low=1, high=256),
        number("L", "a layer height, to find whole steps near it", "mm"),
        kind=Kind.SERVED,
    )
    def _scales(self, command: Command, reply: Reply) -> Wait | None:
        words = command.words()
        if not words:
            return _report(reply, self.scale_lines())
        if "L" in words or "H" in words:
            reply.say(self._layers(words))
        changes: list[tuple[int, float]] = []
        for letter, value in words.items():
            if letter in "THL":
                continue
            name = letter.lower()
            if letter == "E":
                name = extruder_of(self._machine, words, self._rig.job.tool)
            places = self._places(name)
            if not places:
                names = (name.upper() for name in self._machine.drivable.by_name if len(name) == 1)
                limit = ", ".join(names)
                raise CommandError.of("command.nothing-moves", axis=letter, limit=limit)
            changes += [(i, value) for i in places]
        self.require_scales("M92")
        return WaitForMoves(lambda: self._rescale(changes))

    def _layers(self, words: dict[str, float]) -> str:
        """Layer heights that are whole full steps of the Z motor, where it holds best."""
        places = self._places("z")
        if not places:
            raise CommandError.of("command.value", axis="M92", value="H, L", limit="a motor of Z")
        row = self._rig.job.motors.statistics()[places[0]]
        microsteps = words.get("H", self._machine.steppers[row["name"]].microsteps)
        step_mm = microsteps / row["steps_per_unit"]
        wanted_mm = max(words.get("L", 0.0), 0.0)
        below = int(wanted_mm / step_mm + 1e-9)
        heights = f"{below * step_mm:.3f},{(below + 1) * step_mm:.3f}"
        return (
            f"echo:{{ micro steps:{microsteps:g}, minimum layer height:{step_mm:.3f},"
            f" layer:[{heights}] }}"
        )

    def require_scales(self, code: str) -> None:
        """Raises CommandError if a command must not change steps per mm now."""
        if self._rig.job.stops.suspended:
            raise CommandError.of("command.aside", value=code)

    def _rescale(self, changes: list[tuple[int, float]]) -> None:
        self.require_scales("M92")  # a pause may have begun in the meantime
        for i, value in changes:
            self._rig.job.motors.set_steps_per_unit(i, value)

    def scale_of(self, name: str) -> float:
        """Steps per mm or degree of the first motor that drives an actuator, axis or extruder; 0 if
        it has no motor."""
        rows = self._rig.job.motors.statistics()
        return next((float(rows[i]["steps_per_unit"]) for i in self._places(name)), 0.0)

    def scale_lines(self) -> list[str]:
        """The scales as commands."""
        driven = {
            self._machine.driven_by(row["name"]): None for row in self._rig.job.motors.statistics()
        }
        names = {d: name for name, d in self._machine.drivable.by_name.items()}
        words = [
            f"{names[d].upper()}{numeral(self.scale_of(names[d]))}"
            for d in driven
            if d is not None and d.drive != "extruder"
        ]
        return with_extruders(self._machine, "M92", words, self.scale_of)

    @command(
        "M200",
        Subject.FILAMENT,
        When.PLANNED,
        "Makes E a volume of filament of this diameter, in mm³. D0 or S0 makes E a length again."
        " Without parameters it reports the diameters.",
        number("D", "the diameter; 0: E is a length", "mm", 0),
        TOOL,
        number("S", "0: E is a length, 1: a volume"),
        kind=Kind.MOTION,
    )
    def _filament_diameters(self, _: Command, reply: Reply) -> None:
        """M200. A command with words is executed by the interpreter, like M209 and M603."""
        _report(reply, self.filament_lines())

    @command(
        "M209",
        Subject.FILAMENT,
        When.PLANNED,
        "S1: G1 moves of E alone, of 0.1 to 10 mm, retract and unretract as G10 and G11.",
        integer("S", "1: on, 0: off", 0, 1),
        kind=Kind.MOTION,
    )
    def _automatic_retraction(self, _: Command, reply: Reply) -> None:
        reply.say(f"M209 S{int(self._rig.job.modes.auto_retract)}")

    @command(
        "M603",
        Subject.FILAMENT,
        When.PLANNED,
        "Sets the lengths of filament that M701 loads and M702 unloads.",
        TOOL,
        number("L", "the length of M701", "mm", 0),
        number("U", "the length of M702", "mm", 0),
        kind=Kind.MOTION,
    )
    def _change_lengths(self, _: Command, reply: Reply) -> None:
        _report(reply, self.change_lines())

    def filament_lines(self) -> Iterator[str]:
        """M200 for each tool: the diameter if its E is a volume, else that E is a length."""
        diameters = self._rig.job.filament.diameters
        if diameters is None:
            yield "M200 S0"
            return
        for tool, row in enumerate(self._machine.core_spec()["tools"]):
            extruder = int(row["extruder"])
            if extruder >= 0:
                yield f"M200 T{tool} D{numeral(diameters[extruder])}"

    def change_lines(self) -> Iterator[str]:
        """M603 for each tool."""
        lengths = self._rig.job.filament.changes
        for tool, row in enumerate(self._machine.core_spec()["tools"]):
            extruder: int = row["extruder"]
            if extruder >= 0:
                load, unload = lengths[extruder]
                yield f"M603 T{tool} L{numeral(load)} U{numeral(unload)}"

    def retraction_lines(self) -> Iterator[str]:
        """M207 to M209 with the current values."""
        job = self._rig.job
        mm, feed, hop, extra, back, swap, swap_extra = job.modes.retraction
        into = {"S": mm, "F": feed * 60, "Z": hop, "R": extra, "W": swap}
        out = {"S": extra, "F": back * 60, "W": swap_extra}
        for code, words in (("M207", into), ("M208", out)):
            yield f"{code} {' '.join(k + numeral(value) for k, value in words.items())}"
        yield f"M209 S{int(job.modes.auto_retract)}"

    # -- offsets ----------------------------------------------------------------------------------

    @command(
        "M206",
        Subject.POSITIONS,
        When.PLANNED,
        "Sets offsets that are added to the home positions of axes.",
        number("X Y Z", "the offset", "mm"),
        ignored("T P"),
        kind=Kind.SERVED,
        valid=lambda command, machine: _check_offsets(machine, command.words()),
    )
    def _home_offsets(self, command: Command, reply: Reply) -> Wait | None:
        words = command.words()
        if not words:
            reply.say(self.home_offset_line())
        self.offsets.home_mm |= self.home_offsets(words)
        return None

    def home_offsets(self, words: dict[str, float]) -> dict[str, float]:
        """The offsets in the words of M206, mm by axis. Raises CommandError."""
        offsets = {a: words[a.upper()] for a in self.offsets.home_mm if a.upper() in words}
        _check_offsets(self._machine, offsets)
        machine, at_home = self._machine, self.offsets.home_mm | offsets
        x, y, z = (mm + at_home[a] for a, mm in zip("xyz", machine.home_point, strict=True))
        try:
            machine.geometry.inverse((x, y, z))
        except Unreachable as error:
            limit = f"a home within reach, but {error}"
            value = self.home_offset_line(at_home).removeprefix("M206 ")
            raise CommandError.of("command.value", axis="M206", value=value, limit=limit) from None
        return offsets

    def home_offset_line(self, offsets_mm: dict[str, float] | None = None) -> str:
        """M206 with these offsets, or with the current values."""
        offsets_mm = offsets_mm or self.offsets.home_mm
        words = [f"{a.upper()}{numeral(mm)}" for a, mm in offsets_mm.items()]
        return f"M206 {' '.join(words)}"

    @command(
        "G60",
        Subject.MOVES,
        When.PLANNED,
        "Saves the position in memory S, and reports it.",
        integer("S", "the memory", 0, 1, default=0),
        kind=Kind.MOTION,
    )
    def _saved(self, command: Command, reply: Reply) -> Wait | None:
        """G60: confirms that the interpreter has saved the position."""
        *axes, e = self._rig.job.program_position
        places = zip([a.upper() for a in self._axes], axes, strict=True)
        where = " ".join(f"{letter}:{at + 0.0:.2f}" for letter, at in places)
        reply.say(f"Saved position {command.text}<-{where} E:{e + 0.0:.2f}")
        return None

    @command(
        "M218",
        Subject.FILAMENT,
        When.PLANNED,
        "Sets the offset of a tool. For the tool in use, the next move of an axis carries it out.",
        integer("T H", "the tool, by default the one in use", 0),
        number("X Y Z", "the offset", "mm"),
        kind=Kind.SERVED,
    )
    def _tool_offset(self, command: Command, reply: Reply) -> Wait | None:
        words = command.words()
        tool, axes = self.tool_offset(words, self._rig.job.tool)
        if not axes:
            for line in self.tool_offset_lines():
                reply.say(line)
        for letter, value in axes.items():
            self._rig.job.tools.set_offset(tool, "XYZ".index(letter), value)
        return WaitForMoves(self._rig.job.bed.follow_tool) if self._rig.job.bed.is_apart else None

    def tool_offset(self, words: dict[str, float], active: int) -> tuple[int, dict[str, float]]:
        """The tool that M218 selects, and its offsets in X, Y, Z, mm. Raises CommandError."""
        tools = len(self._rig.job.tools.offsets)
        tool = int(words.get("T", words.get("H", active)))
        if not 0 <= tool < tools:
            raise CommandError.bad_value("T", tool, f"a tool below {tools}")
        return tool, {letter: value for letter, value in words.items() if letter in "XYZ"}

    def tool_offset_lines(self) -> Iterator[str]:
        """M218 for each tool."""
        for tool, (x, y, z) in enumerate(self._rig.job.tools.offsets):
            yield f"M218 T{tool} X{numeral(x)} Y{numeral(y)} Z{numeral(z)}"

    @command(
        "M290",
        Subject.POSITIONS,
        When.IMMEDIATE,
        "Babysteps: shifts all moves that are not done yet, at once.",
        number("X Y Z", "the step", "mm", -MAX_BABYSTEP_MM, MAX_BABYSTEP_MM),
        number("S", "as Z", "mm", -MAX_BABYSTEP_MM, MAX_BABYSTEP_MM),
        ignored("R P"),
        while_halted=False,
    )
    def _babystep(self, command: Command, _: Reply) -> Wait | None:
        self._require_no_homing(command)
        for axis, mm in babysteps(command):
            self._shift(axis, mm)
        return None

    def _require_no_homing(self, command: Command) -> None:
        if self._homer.active:
            raise CommandError.of("input.homing", axis=command.code)

    def _shift(self, axis: int, mm: float, *, at_rest: bool = False) -> None:
        """Shifts all moves that are not done yet. `at_rest`: if that is beyond a limit, only later
        moves. Raises CommandError."""
        if not self._rig.queue.shift(axis, mm):
            if not at_rest:
                raise CommandError([self._rig.commands.problem()])
            self._rig.job.modes.shift_zero(axis, mm)
        self.offsets.babysteps_mm["xyz"[axis]] += mm

    @command(
        "SET_GCODE_OFFSET",
        Subject.POSITIONS,
        When.IMMEDIATE,
        "Shifts all moves that are not done yet, as M290: X, Y and Z to this offset, the others by"
        " so much. The offset stays when the axis homes, and can be set before. MOVE has no"
        " meaning: the shift is a motion of its own.",
        number("X Y Z", "the offset", "mm"),
        number("X_ADJUST Y_ADJUST Z_ADJUST", "a change of the offset", "mm"),
        ignored("MOVE MOVE_SPEED"),
        while_halted=False,
    )
    def _offset(self, command: Command, _: Reply) -> Wait | None:
        self._require_no_homing(command)
        job, offsets = self._rig.job, self.offsets
        lost = job.locked_axes
        done_mm = {
            name: offsets.kept_mm[name] if slot in lost else mm
            for slot, (name, mm) in enumerate(offsets.babysteps_mm.items())
        }
        steps = offset_steps(command, done_mm)
        for slot, (name, mm) in enumerate(steps.items()):
            if mm and slot not in lost:
                require_babystep("XYZ"[slot], mm)
                self._shift(slot, mm, at_rest=self._rig.queue.idle and not job.stops.suspended)
            job.modes.keep_offset(slot, offsets.keep(name, done_mm[name] + mm))

    @in_program("M290", "SET_GCODE_OFFSET")
    def _babystep_in_place(self, command: Command, reply: Reply) -> Wait | None:
        return self._rig.commands.run(command, reply)

    @command(
        "Z_OFFSET_APPLY_ENDSTOP",
        Subject.POSITIONS,
        When.EXCLUSIVE,
        "Makes the babysteps of Z (M290, SET_GCODE_OFFSET) part of its home offset (M206), as Z"
        " counts from the endstop. No motor moves. M500 stores it.",
        kind=Kind.SERVED,
    )
    def _apply_to_endstop(self, command: Command, reply: Reply) -> Wait | None:
        homing = self._machine.homing.get("z")
        if homing is not None and homing.probe:
            limit = "Z_OFFSET_APPLY_PROBE, since the probe homes Z"
            raise CommandError.of("command.value", axis="it", value=command.code, limit=limit)
        return WaitForMoves(lambda: self._absorb_babysteps(reply))

    def _absorb_babysteps(self, reply: Reply) -> None:
        by, before = self.offsets.babysteps_mm["z"], self.offsets.home_mm["z"]
        if by == 0:
            reply.say("// Nothing to do: Z Offset is 0")
            return
        after = round(before - by, 6)
        self.offsets.home_mm |= self.home_offsets({"Z": after})
        # Z of the program stays: what the babysteps have added is now counted from the endstop.
        job = self._rig.job
        job.axes.set_position([(Z, job.machine_position[Z] - by)])
        job.plan.absorb_shift(Z, by)
        self._homer.offset_mm["z"] = after
        job.modes.keep_offset(Z, self.offsets.absorbed("z"))
        reply.say(f"// M206 Z: {before:.3f} -> {after:.3f}. M500 or SAVE_CONFIG stores it")


def _check_offsets(machine: MachineConfig, offsets_mm: Mapping[str, float]) -> None:
    """Raises CommandError for an offset that is longer than its axis."""
    for letter, mm in offsets_mm.items():
        axis = machine.axes.get(letter.lower())
        if axis is not None and abs(mm) > (longest := axis.max_mm - axis.min_mm):
            limit = f"at most the {longest:g} mm of the axis"
            raise CommandError.bad_value(letter.upper(), mm, limit)


def _report(reply: Reply, lines: Iterable[str]) -> None:
    for line in lines:
        reply.say(line)
