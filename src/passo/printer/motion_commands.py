"""Limits, scales, offsets and overrides of motion."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from passo.config.drives import axis_order
from passo.errors import CommandError
from passo.printer.faults import problem_of
from passo.printer.waits import Handler, Reply, Still, Wait
from passo.printer.words import Command

if TYPE_CHECKING:
    from passo.printer.printer import Printer

_PERCENT = (10.0, 1000.0)  # of M220


class MotionCommands:
    """Settings of motion of one printer. Limits and the feed rate override take their place among
    the moves of the program, or of the line, that they stand in. What a console sends beside a
    print is live, M221 too: it acts at once on what the board does not have yet. M220 and M290 in
    lines of their own are live from every console."""

    def __init__(self, printer: Printer) -> None:
        self._printer = printer
        self._machine = printer.machine
        self._axes = axis_order(self._machine.axes)
        homed = [a for a in self._axes if not self._machine.axes[a].extruder]
        self.home_offset_mm = dict.fromkeys(homed, 0.0)
        self.babysteps_mm = dict.fromkeys("xyz", 0.0)  # live ones, since the axis was homed
        self.immediate: dict[str, Handler] = {
            "M220": lambda c, r: self._speed(c, r, live=True),
            "M221": lambda c, r: self._flow(c, r, live=True),
            "M290": self._babystep,
        }
        self.beside_only = frozenset({"M221"})  # of the immediate ones
        self.planned: dict[str, Handler] = {
            "M92": self._scales,
            "M200": lambda c, r: self._say(r, *self.filament_lines()),
            "G60": self._saved,
            "M209": lambda c, r: self._say(r, f"M209 S{int(printer.job.auto_retract)}"),
            "M201": lambda c, r: self._axis_limits(c, r, "accel"),
            "M203": lambda c, r: self._axis_limits(c, r, "speed"),
            "M204": self._accelerations,
            "M205": self._junction,
            "M206": self._home_offsets,
            "M218": self._tool_offset,
            "M220": lambda c, r: self._speed(c, r, live=False),
            "M221": lambda c, r: self._flow(c, r, live=False),
            "M290": lambda c, r: self._printer.commands.run(c),
            "M603": lambda c, r: self._say(r, *self.change_lines()),
        }

    # -- scales and limits ------------------------------------------------------------------------

    def _places(self, letter: str) -> list[int]:
        """Numbers, in the core's order, of the motors that a letter means."""
        rows = self._machine.core_spec()["steppers"]
        name = letter.lower()
        if name == "e" and self._machine.extruders:
            tools = self._machine.tools
            extruder = next(iter(self._machine.extruders))
            if tools and tools[self._printer.job.tool].extruder:
                extruder = str(tools[self._printer.job.tool].extruder)
            name = extruder
        names = {*self._machine.geometry.actuators, *self._axes, *self._machine.extruders}
        if name not in names:
            return []
        wanted = self._machine.drivable.by_name.get(name)
        found: list[int] = []
        for i, row in enumerate(rows):
            stepper = self._machine.steppers[row["name"]]
            if wanted and self._machine.drivable.of(row["name"], stepper.drives) == wanted:
                found.append(i)
        return found

    def _scales(self, command: Command, reply: Reply) -> Wait | None:
        words = command.words()
        if not words:
            reply.say(self.scale_line())
            return None
        changes: list[tuple[int, float]] = []
        for letter, value in words.items():
            if letter == "T":
                continue
            if not 1e-3 < value < 1e6:
                raise CommandError.bad_value(letter, value, "steps per mm above 0")
            changes += [(i, value) for i in self._places(letter)]
        return Still(lambda: self._rescale(changes))

    def _rescale(self, changes: list[tuple[int, float]]) -> None:
        for i, value in changes:
            self._printer.job.set_steps_per_unit(i, value)

    def scale_line(self) -> str:
        """The scales as a command, each motor's by the letter of what it drives."""
        words: list[str] = []
        seen: set[object] = set()
        for row in self._printer.job.steppers():
            stepper = self._machine.steppers[row["name"]]
            driven = self._machine.drivable.of(row["name"], stepper.drives)
            name = row["name"].rstrip("0123456789") if driven else row["name"]
            if driven in seen or (name == "e" and any(w.startswith("E") for w in words)):
                continue
            seen.add(driven)
            words.append(f"{name.upper()}{row['steps_per_unit']:.10g}")
        return f"M92 {' '.join(words)}"

    def _axis_limits(self, command: Command, reply: Reply, what: str) -> Wait | None:
        words = command.words()
        if not words:
            reply.say(self.axis_limit_line(what))
            return None
        live = self._printer.beside(reply)
        for letter, value in words.items():
            if value > 0:
                self._printer.job.set_axis_limit(letter.lower(), what, value, live)
        if live:
            self._printer.drive.replan()
        return None

    def axis_limit_line(self, what: str) -> str:
        """M201 or M203 with what holds now."""
        job = self._printer.job
        words = [f"{a.upper()}{job.axis_limit(a, what):.10g}" for a in self._axes]
        words += [f"E{job.axis_limit(e, what):.10g}" for e in list(self._machine.extruders)[:1]]
        return f"{'M203' if what == 'speed' else 'M201'} {' '.join(words)}"

    def _accelerations(self, command: Command, reply: Reply) -> Wait | None:
        words = command.words()
        if not words:
            reply.say(self.acceleration_line())
            return None
        live = self._printer.beside(reply)
        self._printer.commands.accelerations(words, live=live)
        if live:
            self._printer.drive.replan()
        return None

    def acceleration_line(self) -> str:
        """M204 with what holds now."""
        p, r, t = (self._printer.job.limit(f"{k}_accel") for k in ("print", "retract", "travel"))
        return f"M204 P{p:.10g} R{r:.10g} T{t:.10g}"

    def _junction(self, command: Command, reply: Reply) -> Wait | None:
        words = command.words()
        if not words:
            reply.say(self.junction_line())
            return None
        deviation = words.get("J")
        if deviation is not None:
            if not 0.001 <= deviation <= 0.3:
                raise CommandError.bad_value("J", deviation, "0.001 to 0.3 mm")
            live = self._printer.beside(reply)
            self._printer.job.set_limit("junction_deviation", deviation, live)
            if live:
                self._printer.drive.replan()
        return None

    def junction_line(self) -> str:
        """M205 with what holds now."""
        return f"M205 J{self._printer.job.limit('junction_deviation'):.10g}"

    def _say(self, reply: Reply, *lines: str) -> Wait | None:
        """Answers a question; with words the interpreter has carried the command out."""
        for line in lines:
            reply.say(line)
        return None

    def filament_lines(self) -> Iterator[str]:
        """M200 for each tool where E is a volume, else that it is a length."""
        diameters = self._printer.job.filament_diameters
        if diameters is None:
            yield "M200 S0"
            return
        for tool, row in enumerate(self._machine.core_spec()["tools"]):
            if row["extruder"] >= 0:
                yield f"M200 T{tool} D{diameters[row['extruder']]:.10g}"

    def change_lines(self) -> Iterator[str]:
        """M603 for each tool."""
        lengths = self._printer.job.filament_changes
        for tool, row in enumerate(self._machine.core_spec()["tools"]):
            extruder: int = row["extruder"]
            if extruder >= 0:
                load, unload = lengths[extruder]
                yield f"M603 T{tool} L{load:.10g} U{unload:.10g}"

    def retraction_lines(self) -> Iterator[str]:
        """M207 to M209 with what holds now."""
        job = self._printer.job
        mm, feed, hop, extra, back, swap, swap_extra = job.retraction
        yield f"M207 S{mm:.10g} F{feed * 60:.10g} Z{hop:.10g} R{extra:.10g} W{swap:.10g}"
        if back > 0:
            yield f"M208 S{extra:.10g} F{back * 60:.10g} W{swap_extra:.10g}"
        elif swap_extra:
            yield f"M208 W{swap_extra:.10g}"
        yield f"M209 S{int(job.auto_retract)}"

    # -- offsets ----------------------------------------------------------------------------------

    def _home_offsets(self, command: Command, reply: Reply) -> Wait | None:
        words = command.words()
        if not words:
            reply.say(self.home_offset_line())
        offsets = {a: words[a.upper()] for a in self.home_offset_mm if a.upper() in words}
        for name, mm in offsets.items():
            axis = self._machine.axes[name]
            longest = axis.max_mm - axis.min_mm
            if abs(mm) > longest:
                raise CommandError.bad_value(
                    name.upper(), mm, f"at most the {longest:g} mm of the axis"
                )
        self.home_offset_mm |= offsets
        return None

    def home_offset_line(self) -> str:
        """M206 with what holds now."""
        words = [f"{a.upper()}{mm:.10g}" for a, mm in self.home_offset_mm.items()]
        return f"M206 {' '.join(words)}"

    def _saved(self, command: Command, reply: Reply) -> Wait | None:
        """G60; the interpreter has saved the position."""
        *axes, e = self._printer.job.program_position
        places = zip([a.upper() for a in self._axes], axes, strict=True)
        where = " ".join(f"{letter}:{at + 0.0:.2f}" for letter, at in places)
        reply.say(f"Saved position {command.text}<-{where} E:{e + 0.0:.2f}")
        return None

    def _tool_offset(self, command: Command, reply: Reply) -> Wait | None:
        words = command.words()
        offsets = self._printer.job.tool_offsets
        tool = int(words.get("T", words.get("H", self._printer.job.tool)))
        if not 0 <= tool < len(offsets):
            raise CommandError.bad_value("T", tool, f"a tool below {len(offsets)}")
        axes = {letter: value for letter, value in words.items() if letter in "XYZ"}
        if not axes:
            for line in self.tool_offset_lines():
                reply.say(line)
        for letter, value in axes.items():
            self._printer.job.set_tool_offset(tool, "XYZ".index(letter), value)
        return None

    def tool_offset_lines(self) -> Iterator[str]:
        """M218 for each tool but the first."""
        for tool, (x, y, z) in enumerate(self._printer.job.tool_offsets):
            if tool > 0:
                yield f"M218 T{tool} X{x:.10g} Y{y:.10g} Z{z:.10g}"

    def _flow(self, command: Command, reply: Reply, *, live: bool) -> Wait | None:
        found = self._printer.commands.flow(command)
        if found is None:
            return None
        tool, extruder, factor = found
        if factor is None:
            reply.say(f"echo:E{tool} Flow: {self._printer.job.flows[extruder] * 100:g}%")
        elif live:
            self._printer.drive.scale_flow(extruder, factor)
        else:
            self._printer.job.set_flow(extruder, factor)
        return None

    def _babystep(self, command: Command, _: Reply) -> Wait | None:
        if self._printer.homer.active:
            raise CommandError.of("input.homing", axis=command.code)
        for axis, mm in self._printer.commands.babysteps(command):
            if not self._printer.drive.shift(axis, mm):
                raise CommandError([problem_of(self._printer.job, "")])
            self.babysteps_mm["xyz"[axis]] += mm
        return None

    def homed(self, axes: Iterable[str]) -> None:
        """These axes are at home: how far they were shifted means nothing any more."""
        self.babysteps_mm |= {axis: 0.0 for axis in axes if axis in self.babysteps_mm}

    # -- overrides --------------------------------------------------------------------------------

    def _speed(self, command: Command, reply: Reply, *, live: bool) -> Wait | None:
        words = command.words()
        job = self._printer.job
        if "S" not in words:
            reply.say(f"Speed factor override: {job.speed_factor * 100:g}")
            return None
        low, high = _PERCENT
        if words["S"] <= 0:
            raise CommandError.bad_value("S", words["S"], f"{low:g} to {high:g} percent")
        job.set_speed_factor(min(max(words["S"], low), high) / 100, live)
        if live:
            self._printer.drive.replan()
        return None

    def tell_drivers(self, reply: Reply) -> None:
        """What the machine file says of the drivers' inputs."""
        reply.say("Reporting Stepper control")
        for row in self._machine.core_spec()["steppers"]:
            reply.say(
                f" {row['name'].upper()} dir:{'false' if row['invert'] else 'true'}"
                f" pulse(us):{row['pulse_s'] * 1e6:g} delay(us):{row['dir_setup_s'] * 1e6:g}"
            )
