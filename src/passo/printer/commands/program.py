"""What the commands outside of the motion state do to the printer and to the plan."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from math import inf, nan, sqrt
from typing import TYPE_CHECKING, ClassVar, NamedTuple, Protocol, Self

from passo import _core
from passo.config.heater_numbers import heater_of
from passo.config.motor_roles import axis_order
from passo.config.types import MIN_ACCEL, MIN_SPEED
from passo.errors import CommandError, Problem, WordError
from passo.gcode.command import LARGEST, Command
from passo.gcode.dialect import Kind, row_of
from passo.gcode.stray import stray_of
from passo.motion.set_position import place_of_actuators, place_of_axes
from passo.printer.commands.material_presets import Presets
from passo.printer.commands.ranges import beyond
from passo.printer.commands.speed_factor import SpeedFactor
from passo.printer.input_errors import problem, problem_of
from passo.printer.macros import Macros, Respond
from passo.printer.skipped_commands import SkippedCommand, SkippedCommands
from passo.printer.status import Status, planned_status
from passo.printer.unfit_commands import ALL
from passo.printer.wait_requests import (
    Stop,
    Wait,
    WaitForHoming,
    WaitForMoves,
    WaitForTemperatures,
    WaitForUser,
)

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig


_OF_FANS = re.compile(r"[UIHLXT]", re.IGNORECASE | re.ASCII)  # settings of M106
_LETTERED = re.compile(r"([TPBC])\s*(-?\d+)?", re.IGNORECASE | re.ASCII)
_AT_ONCE = re.compile(r"(?<![A-Z])F", re.IGNORECASE | re.ASCII)
# Of a whole line of a console, which must hold nothing that has to wait for its turn.
_FORCED = re.compile(
    r"(?=.*F)(?:\s*(?:[STPR]\s*[-+]?(?:\d+\.?\d*|\.\d+)|S\s*nan\b|F(?!\s*[-+.\d])))*\s*",
    re.IGNORECASE,
)
_BY_INTERPRETER = re.compile(r"([A-Z]-?\d+\.\d{6} )+")  # words of its events
_BABYSTEP_MM = 2.0  # at most, with one command
_FLOW = (1.0, 1000.0)  # percent of M221
_ROUNDING = 1e-6  # of a value that was written with ten digits
_FULL_FAN = 255  # S of M106
_DEVIATION = (1e-5, 0.3)  # mm, of M205 J
_CORNERS = {
    "deviation": "the machine's corners use the junction deviation (J)",
    "cornering_distance": "the machine's corners use the cornering distances of its file",
    "jerk": "the machine's corners use the jerk of each axis (X Y Z E)",
}
_LEAST = {"speed": (MIN_SPEED, "mm/s"), "accel": (MIN_ACCEL, "mm/s²"), "jerk": (0.0, "mm/s")}
_OF_VELOCITY_LIMIT = {"VELOCITY": "speed", "ACCEL": "accel"}
_KLIPPERS_CORNER = "SQUARE_CORNER_VELOCITY"
_MAY_BE_FORCED = ("M104", "M140", "M141", "M106", "M107")
_KINDS = {"T": "hotend", "P": "hotend", "B": "bed", "C": "chamber"}


def forced(command: Command) -> bool:
    """A console's line that sets a heater or a fan at once (F), whoever moves the machine."""
    return command.code in _MAY_BE_FORCED and _FORCED.fullmatch(command.text) is not None


class FanOrder(NamedTuple):
    """What M106 and M107 say: the fan's number, the share of its power (None: they only set it up,
    which the machine file does), and whether it acts at once. `note` says what is applied where S
    is beyond its range."""

    number: float | None
    share: float | None
    at_once: bool
    note: str = ""


class FlowOrder(NamedTuple):
    """What M221 says: the tool, its extruder, and the factor (None: the command asks for it).
    `note` says what is applied where S is beyond its range."""

    tool: int
    extruder: int
    factor: float | None
    note: str = ""


class Heat(Protocol):
    """Where temperatures are set."""

    def set_target(self, heater: str, celsius: float, *, at_once: bool = False) -> None:
        """Sets a heater's target when the moves so far are done, or at once; 0 is off."""


class NoHeat:
    """Nothing heats in a plan: temperatures are taken as reached."""

    def set_target(self, heater: str, celsius: float, *, at_once: bool = False) -> None:
        """Forgets it."""


class Commands:
    """Carries out what the job's interpreter hands out. One object a job; not thread-safe.

    `omitted` counts what it leaves out.
    """

    @classmethod
    def of_plan(cls, machine: MachineConfig, job: _core.Job) -> Self:
        """Those of a job that is only planned: without heat and without a board's outputs."""
        return cls(machine, job, NoHeat(), [1] * len(machine.timed_outputs))

    def __init__(
        self,
        machine: MachineConfig,
        job: _core.Job,
        heat: Heat,
        full_scale: list[int],
        macros: Macros | None = None,
    ) -> None:
        """`macros` are those of a printer; a program has its own."""
        self._machine, self._job, self._heat = machine, job, heat
        self.macros = macros or Macros(machine)
        names = machine.timed_outputs
        self._outputs = {name: (i, full_scale[i]) for i, name in enumerate(names)}
        self._tool = 0
        self._tool_c: dict[int, tuple[float | None, float | None]] = {}  # at work, on standby
        self.targets_c: dict[str, float] = {}  # as commands have set them; 0 is off
        self.fans: dict[str, float] = {}  # as last set, 0 to 1
        self._acts_at: dict[str, float] = {}  # clock from which what was planned of them acts
        self._spindle = 0.0
        self._spindle_mode = ""  # M3: as set, M4: with the speed, or off
        if machine.laser:
            job.set_laser(*self._outputs["laser"])
        self.presets = Presets(machine)
        self.speed = SpeedFactor(job)
        self.ended = False
        self.omitted = SkippedCommands()
        self.skips = ALL  # what a print without consoles may leave out

        def record(index: int, value: int) -> float:
            job.record(index, value)
            return inf

        # Without a living printer there is no such haste. Returns when it acts.
        self.record_at_once: Callable[[int, int], float] = record

    def run(self, command: Command) -> Wait | None:
        """Carries one command out, or counts it as unknown; returns what it waits for. Raises
        CommandError where it is refused, WordError for a word without a number."""
        if command.letter == "T":
            if command.minor:
                self.omitted.count(SkippedCommand.TOOL, f"T{command.number}", command.line)
            else:
                self.tool_changed(command.number)
            return None
        code = _key(command)
        command.check()
        handler = self._HANDLERS.get(code)
        if handler is not None:
            return handler(self, command)
        row = row_of(code)
        if row is None:
            self.omitted.count(SkippedCommand.UNKNOWN, code, command.line)
        elif row.kind is Kind.NOT_BUILT:
            self.omitted.count(SkippedCommand.NOT_BUILT, code, command.line)
        elif row.kind is Kind.SERVED:
            self.omitted.count(SkippedCommand.SERVED, code, command.line)
        elif row.kind is Kind.PERSON:
            self.omitted.count(SkippedCommand.PERSON, code, command.line)
            return WaitForUser(row.text)
        return None

    def expand(self, command: Command, respond: Respond, *, console: bool = False) -> None:
        """A macro is called: the job reads next what it becomes. See Macros.expand."""
        self.macros.expand(self._job, command, self.status(), respond, console=console)

    def status(self) -> Status:
        """The printer's, or that of the plan, for templates."""
        if self.macros.status is not None:
            return self.macros.status()
        return planned_status(self._machine, self._job, self.targets_c, self.fans)

    def knows(self, command: Command) -> bool:
        """Whether a command means anything, if only that it does nothing here."""
        if command.code == "G92.1":
            return _BY_INTERPRETER.fullmatch(command.text) is not None
        code = _key(command)
        return command.letter == "T" or code in self._HANDLERS or row_of(code) is not None

    def refuse(self, command: Command, error: CommandError, file: str) -> None:
        """A command of `file` that was not carried out, in a print that continues."""
        del file
        self.omitted.count(SkippedCommand.REFUSED, f"{command.code}: {error}", command.line)

    @property
    def machine(self) -> MachineConfig:
        """The machine that the commands are for."""
        return self._machine

    def problem(self, path: str = "") -> Problem:
        """The error that the job stopped at; `path` is the file."""
        return problem_of(self._job, path, self._machine.geometry)

    def warnings(self, file: str) -> list[str]:
        """One sentence for each code that meant nothing, waited for nobody, or was ignored, for
        each axis whose targets were moved to the limit, for moves that were left out, and for a
        file that was cut short."""
        return self.omitted.warnings(file, self._clamped())

    def _clamped(self) -> dict[str, tuple[int, int]]:
        geometry = self._machine.geometry
        problems = [(problem(error, "", geometry), times) for error, times in self._job.clamped]
        moved, left_out = "such targets were moved to the limit", "such moves were left out"
        return {
            f"{p.sentence}; {moved if p.code == 'input.out-of-range' else left_out}": (
                p.line or 0,
                times,
            )
            for p, times in problems
        }

    def _home(self, command: Command) -> Wait:
        self.laser_off()  # homing runs over what lies there
        return WaitForHoming(command.text)

    def _set_position(self, command: Command) -> Wait:
        return self._placed(place_of_axes(command, self._machine, self._job))

    def _set_actuators(self, command: Command) -> Wait | None:
        if not _BY_INTERPRETER.fullmatch(command.text):  # somebody has written G92.1
            self.omitted.count(SkippedCommand.UNKNOWN, command.code, command.line)
            return None
        places = place_of_actuators(command, self._machine, self._job)
        return self._placed(places) if places else None

    def _placed(self, places: dict[int, float]) -> Wait:
        """Once the machine stands: a plan that is under way could not be planned anew."""
        return WaitForMoves(lambda: self._job.set_axes(list(places.items())))

    def _end(self, _: Command) -> Wait:
        self.ended = True
        return WaitForMoves()

    def _call(self, command: Command) -> None:
        """M98 of a sub-program that is missing, where that may be left out."""
        self.omitted.count(SkippedCommand.UNKNOWN, f"M98 {command.text}", command.line)

    def _return(self, command: Command) -> Wait | None:
        """M99 outside of a sub-program: other machines begin again."""
        if command.text:
            self.omitted.count(SkippedCommand.NOT_BUILT, "M99", command.line)
            return None
        self.omitted.count(SkippedCommand.REPEAT, "M99", command.line)
        return self._end(command)

    def _stop(self, command: Command) -> Wait:
        self.omitted.count(SkippedCommand.STOP, command.code, command.line)
        return Stop(command.code, command.line)

    def fans_off(self) -> None:
        """All fans, as soon as the moves so far are done."""
        for fan in self.commanded_fans:
            self.set_output(fan, 0.0)

    def set_output(self, output: str, share: float, *, at_once: bool = False) -> None:
        """Sets an output, 0 to 1, when the moves so far are done, or at once: then until what is
        planned of it acts."""
        index, full = self._outputs[output]
        value, stays = round(min(max(share, 0.0), 1.0) * full), True
        if at_once:
            stays = self._acts_at.get(output, -inf) <= self.record_at_once(index, value)
        else:
            self._acts_at[output] = self._job.clock + self._job.queued_ticks
            self._job.record(index, value)
        if stays and output in self._machine.fans:
            self.fans[output] = share

    def _spindle_start(self, command: Command) -> None:
        self._spindle = command.words().get("S", self._spindle)
        self._spindle_mode = command.code
        self._laser()

    def _spindle_stop(self, _: Command) -> None:
        self.laser_off()

    def _spindle_power(self, command: Command) -> None:
        self._spindle = command.words().get("S", self._spindle)
        self._laser()

    def laser_off(self) -> None:
        """Laser or spindle off when the moves so far are done, until it is switched on again."""
        self._spindle_mode = ""
        self._laser()

    @property
    def lit(self) -> bool:
        """The laser is on also where the head stands."""
        return bool(self._machine.laser) and self._spindle_mode == "M3" and self._spindle > 0

    def shade(self, *, dark: bool) -> None:
        """The laser dark when the moves so far are done, or again as it is set."""
        if dark:
            self.set_output("laser", 0.0)
        else:
            self._laser()

    def _laser(self) -> None:
        if self._machine.laser:
            share = max(0.0, self._spindle / self._machine.laser.full_scale)
            self._job.follow_speed(share if self._spindle_mode == "M4" else 0.0)
            self.set_output("laser", share if self._spindle_mode == "M3" else 0.0)

    def heater(self, kind: str, number: int | None = None) -> str:
        """The heater of a kind: a hotend by its tool's number, the active tool's by default; others
        by their own. Raises CommandError if there is none."""
        index = number if number is not None else self._job.tool if kind == "hotend" else 0
        found = heater_of(self._machine, kind, index)
        if found is None:
            there = sum(heater.kind == kind for heater in self._machine.heaters.values())
            raise CommandError.of("heat.unknown", axis=kind, value=index, limit=there)
        return found

    def _numbered(self, words: dict[str, float]) -> int | None:
        number = words.get("T", words.get("P"))
        return None if number is None else int(number)

    def _exists(self, kind: str, words: dict[str, float]) -> bool:
        """A machine without such heaters lets a command pass that numbers none."""
        there = any(heater.kind == kind for heater in self._machine.heaters.values())
        return there or self._numbered(words) is not None

    def _heat_to(self, name: str, target: float | None, *, at_once: bool = False) -> None:
        """Sets a target. Without one the heater goes off; outside of the safe range too, at once,
        and CommandError is raised."""
        heater = self._machine.heaters[name]
        self.targets_c[name] = max(target or 0.0, 0.0)
        if target is None or target <= 0:
            self._heat.set_target(name, 0.0, at_once=at_once)
        elif heater.min_c <= target <= heater.max_c:
            self._heat.set_target(name, target, at_once=at_once)
        else:
            self._heat.set_target(name, 0.0, at_once=True)
            self._heat.set_target(name, 0.0)  # a target that is still queued is not the last word
            limit = f"{heater.min_c:g} to {heater.max_c:g}"
            raise CommandError.of("heat.unsafe-target", axis=name, value=target, limit=limit)

    def _celsius(self, words: dict[str, float], kind: str) -> float | None:
        """What a command asks for: the material I of M145, or S, or R. Raises CommandError."""
        if "I" in words and kind in ("hotend", "bed"):
            return self.presets.celsius(words["I"], kind)
        return words.get("S", words.get("R"))

    def _set_temperature(self, command: Command, kind: str) -> None:
        words = command.words()
        if self._exists(kind, words):
            name = self.heater(kind, self._numbered(words))
            at_once = _AT_ONCE.search(command.text) is not None
            self._heat_to(name, self._celsius(words, kind), at_once=at_once)

    def _reach_temperature(self, command: Command, kind: str) -> Wait | None:
        words = command.words()
        if not self._exists(kind, words):
            return None
        name = self.heater(kind, self._numbered(words))
        target = self._celsius(words, kind)
        if target is not None:
            self._heat_to(name, target)
        return WaitForTemperatures((name,), cooling="R" in words)

    def _reach_all(self, command: Command) -> Wait | None:
        """M116 waits for all heaters that it names, without letters for every one."""
        names = [
            self.heater(_KINDS[letter.upper()], int(number or 0))
            for letter, number in _LETTERED.findall(command.text)
        ]
        return WaitForTemperatures(tuple(names or self._machine.heaters), cooling=True)

    def _tool_temperatures(self, command: Command) -> None:
        """G10 P: the temperature of a tool at work (S) and on standby (R). The tool at work takes
        the one at once, another one the other."""
        words = command.words()
        tool = int(words.get("P", self._job.tool))
        work, standby = self._tool_c.get(tool, (None, None))
        work, standby = words.get("S", work), words.get("R", standby)
        self._tool_c[tool] = (work, standby)
        at_once = work if tool == self._job.tool or standby is None else standby
        self._heat_tool(tool, at_once)

    def _heat_tool(self, tool: int, celsius: float | None) -> None:
        if celsius is not None and self._exists("hotend", {}):
            self._heat_to(self.heater("hotend", tool), celsius)

    def take_tool_temperatures(self, other: Commands) -> None:
        """What G10 has said to others of the same machine holds here; heaters stay as they are."""
        self._tool_c |= other._tool_c

    def plan_forgotten(self) -> None:
        """Nothing that was planned acts any more."""
        self._acts_at.clear()

    def follow_tool(self) -> None:
        """Another tool is in use, without a command: the program stands aside, stops or resumes."""
        self._tool = self._job.tool

    def tool_changed(self, tool: int) -> None:
        """The tool that leaves goes on standby, the one that comes to work."""
        before, self._tool = self._tool, tool
        standby, work = (self._tool_c.get(t, (None, None))[i] for t, i in ((before, 1), (tool, 0)))
        if tool != before:
            self._heat_tool(before, standby)
            self._heat_tool(tool, work)  # last, where both share a hotend

    @property
    def commanded_fans(self) -> list[str]:
        """The fans that follow nothing else."""
        return [name for name, fan in self._machine.fans.items() if fan.commanded]

    def fan_order(self, command: Command) -> FanOrder:
        """What M106 and M107 say."""
        words = command.words()
        if command.code == "M107":
            share = 0.0
        elif "S" not in words and ("F" in words or _OF_FANS.search(command.text) is not None):
            share = None
        else:
            share = min(max(words.get("S", _FULL_FAN) / _FULL_FAN, 0.0), 1.0)
        at_once = "F" not in words and _AT_ONCE.search(command.text) is not None
        note = ""
        if share is not None and command.code == "M106":
            note = beyond("M106 S", words.get("S", _FULL_FAN), (0, _FULL_FAN))
        return FanOrder(words.get("P"), share, at_once, note)

    def set_fan(self, order: FanOrder) -> None:
        """Does what M106 or M107 says. Raises CommandError if P names no fan; a machine without
        fans lets the rest pass."""
        number, share, at_once, _ = order
        fans = self._machine.fans
        numbers = [fans[name].number for name in self.commanded_fans]
        if number is not None and number not in numbers:
            limit = ", ".join(map(str, numbers)) or "no fan"
            raise CommandError.bad_value("P", number, limit)
        fan = next((n for n in self.commanded_fans if fans[n].number == int(number or 0)), None)
        if fan is not None and share is not None:
            config = self._machine.fans[fan]
            share = share if share >= config.off_below else 0.0
            power = max(share * config.max_power, config.min_power if share > 0 else 0.0)
            self.set_output(fan, power, at_once=at_once)

    def _fan(self, command: Command) -> None:
        order = self.fan_order(command)
        self.set_fan(order)
        self._noted(order.note, command)

    def _noted(self, note: str, command: Command) -> None:
        if note:
            self.omitted.count(SkippedCommand.REFUSED, note, command.line)

    def _axis_limits(self, command: Command, what: str) -> None:
        self._noted(self.axis_limits(command.code, command.words(), what), command)

    def axis_limits(
        self, code: str, words: dict[str, float], what: str, *, live: bool = False
    ) -> str:
        """M201 and M203, and jerk of M205, for the moves that follow, or `live` for all that is
        planned anew. Returns a note on values above the machine's limits with what is applied, or
        nothing. Raises CommandError."""
        given = {letter: value for letter, value in words.items() if letter != "T"}
        known = [name.upper() for name in axis_order(self._machine.axes)]
        for letter, value in given.items():
            _at_least(letter, value, what)
            if letter != "E" and letter not in known:
                raise CommandError.of("command.nothing-moves", axis=letter, limit=", ".join(known))
        notes: list[str] = []
        for letter, value in given.items():
            name = self.extruder(words) if letter == "E" else letter.lower()
            if name is not None:
                self._job.set_axis_limit(name, what, value, live)
                taken, unit = self._job.axis_limit(name, what), _LEAST[what][1]
                if taken < value * (1 - _ROUNDING):
                    above = f"{letter} {value:g} {unit} is above the machine's limit"
                    notes.append(f"{code}: {above}, {taken:g} {unit} is applied")
        return ". ".join(notes)

    def extruder(self, words: dict[str, float]) -> str | None:
        """The extruder that E means: that of the tool T, without it that of the active one, or the
        first if that has none. Raises CommandError for a tool that does not exist."""
        tools = self._machine.all_tools
        tool = words.get("T", self._job.tool)
        if "T" in words and tool not in range(len(tools)):
            raise CommandError.bad_value("T", tool, f"a tool below {len(tools)}")
        own = tools[int(tool)].extruder if tools else None
        return own if own or "T" in words else next(iter(self._machine.extruders), None)

    def _bounded(self, code: str, word: str, value: float, what: str, names: Iterable[str]) -> str:
        """A note where a limit of the path is above the machine file's for these axes or extruders,
        which bound moves as well; else nothing."""
        parts = {**self._machine.axes, **self._machine.extruders}
        own = {n: parts[n].accel_mm_s2 if what == "accel" else parts[n].speed_mm_s for n in names}
        if value >= LARGEST or not any(limit < value for limit in own.values()):
            return ""
        applied = ", ".join(f"{n.upper()} {self._job.axis_limit(n, what):g}" for n in own)
        bounds = "M201" if what == "accel" else "M203"
        return f"{code}: {word} {value:g} is above the limits of {bounds}, which apply: {applied}"

    def _accelerations(self, command: Command) -> None:
        self._noted(self.accelerations(command.words()), command)

    def accelerations(self, words: dict[str, float], *, live: bool = False) -> str:
        """M204, for the moves that follow, or `live` for all that is planned anew. Returns a note
        on values above the limits of the axes, or nothing. Raises CommandError."""
        for letter in "SPVTR":
            if letter in words:
                _at_least(letter, words[letter], "accel")
        for letter, names in (
            ("S", ("print_accel", "travel_accel")),
            ("P", ("print_accel",)),
            ("V", ("travel_accel",)),
            ("T", ("travel_accel",)),
            ("R", ("retract_accel",)),
        ):
            if letter in words:
                for name in names:
                    self._job.set_limit(name, words[letter], live)
        notes: list[str] = []
        for letter in "SPTVR":
            axes = self._machine.extruders if letter == "R" else ("x", "y")
            notes.append(self._bounded("M204", letter, words.get(letter, 0.0), "accel", axes))
        return ". ".join(note for note in notes if note)

    def _junction(self, command: Command) -> None:
        self._noted(self.junction(command.words()), command)

    def junction(self, words: dict[str, float], *, live: bool = False) -> str:
        """M205, for the moves that follow, or `live` for all that is planned anew: what acts is the
        deviation or the jerk, as the machine's corners are. Returns a note on the words that do
        not, or nothing. Raises CommandError."""
        jerk = {letter: value for letter, value in words.items() if letter not in "BJSV"}
        if jerk.keys() <= {"T"}:
            jerk = {}  # least speed of travel, not the tool of E
        law, deviation = self._machine.limits.junction, words.get("J")
        if deviation is not None and not _DEVIATION[0] <= deviation <= _DEVIATION[1]:
            raise CommandError.bad_value("J", deviation, "{:g} to {:g} mm".format(*_DEVIATION))
        if law == "deviation" and deviation is not None:
            self._job.set_limit("junction_deviation", deviation, live)
        above = self.axis_limits("M205", jerk, "jerk", live=live) if law == "jerk" else ""
        acts = {"deviation": {"J"}, "jerk": jerk.keys()}.get(law, set[str]())
        # Without a limit, as with S0, no speed is too low and no segment too short.
        idle = [k for k, value in words.items() if k not in acts and (value or k not in "BSTV")]
        without = f"M205: {_no_effect(idle)}, because {_CORNERS[law]}" if idle else ""
        return ". ".join(note for note in (above, without) if note)

    def _speed(self, command: Command) -> None:
        factor, note = self.speed.asked(command)
        if factor is not None:
            self._job.set_speed_factor(factor)
        self._noted(note, command)

    def flow(self, command: Command) -> FlowOrder | None:
        """M221: the tool that it means, its extruder, and the factor that S gives. None where the
        tool in use has no extruder. Raises CommandError."""
        words = command.words()
        tools = self._machine.all_tools
        tool = words.get("T", self._job.tool)
        own = tools[int(tool)].extruder if tool in range(len(tools)) else None
        if own is None and "T" not in words:
            return None
        if own is None:
            raise CommandError.bad_value("T", tool, "a tool with an extruder")
        extruder = list(self._machine.extruders).index(own)
        if "S" not in words:
            return FlowOrder(int(tool), extruder, None)
        low, high = _FLOW
        if words["S"] <= 0:
            raise CommandError.bad_value("S", words["S"], f"{low:g} to {high:g} percent")
        note = beyond("M221", words["S"], _FLOW, "%")
        return FlowOrder(int(tool), extruder, min(max(words["S"], low), high) / 100, note)

    def _flow(self, command: Command) -> None:
        found = self.flow(command)
        if found is not None and found.factor is not None:
            self._job.set_flow(found.extruder, found.factor)
            self._noted(found.note, command)

    def babysteps(self, command: Command) -> list[tuple[int, float]]:
        """M290: numbers of axes with how far they go, mm; S is Z's. Raises CommandError."""
        words = command.words()
        words.setdefault("Z", words.get("S", 0.0))
        found = [(i, words[letter]) for i, letter in enumerate("XYZ") if words.get(letter)]
        for i, mm in found:
            if abs(mm) > _BABYSTEP_MM:
                raise CommandError.bad_value("XYZ"[i], mm, f"at most {_BABYSTEP_MM:g} mm")
        return found

    def _babystep(self, command: Command) -> None:
        for axis, mm in self.babysteps(command):
            if not self._job.shift(axis, mm):
                raise CommandError([self.problem()])

    def _velocity_limit(self, command: Command) -> None:
        self._noted(self.velocity_limit(command), command)

    def velocity_limit(self, command: Command, *, live: bool = False) -> str:
        """SET_VELOCITY_LIMIT, for the moves that follow, or `live` for all that is planned anew.
        Returns a note on the keys that do not act, or nothing. Raises CommandError."""
        values: dict[str, float] = {}
        for key, text in command.pairs().items():
            try:
                values[key] = float(text)
            except ValueError:
                values[key] = nan
            if not abs(values[key]) <= LARGEST:
                if (stray := stray_of(text, any_character=True)) is not None:
                    raise WordError([stray]) from None
                raise WordError.of("input.number", value=f"{key}={text[:30]}")
        for key, what in _OF_VELOCITY_LIMIT.items():
            if key in values:
                _at_least(key, values[key], what)
        corner = values.get(_KLIPPERS_CORNER)
        if corner is not None and not corner > 0:
            raise CommandError.bad_value(_KLIPPERS_CORNER, corner, "above 0 mm/s")
        ratio = values.get("MINIMUM_CRUISE_RATIO")
        if ratio is not None and not 0 <= ratio < 1:
            raise CommandError.bad_value("MINIMUM_CRUISE_RATIO", ratio, "0 to less than 1")
        job = self._job
        if "VELOCITY" in values:
            job.set_limit("speed", values["VELOCITY"], live)
        if "ACCEL" in values:
            job.set_limit("print_accel", values["ACCEL"], live)
            job.set_limit("travel_accel", values["ACCEL"], live)
        if ratio is not None:
            job.set_limit("minimum_cruise_ratio", ratio, live)
        law = self._machine.limits.junction
        if corner is not None and law == "deviation":
            # A right angle: v² = a δ s/(1 - s) with s = √½, so δ = v² (√2 - 1) / a.
            accel = job.limit("print_accel")
            low, high = _DEVIATION
            deviation = min(max(corner**2 * (sqrt(2) - 1) / accel, low), high)
            job.set_limit("junction_deviation", deviation, live)
        acts = {*_OF_VELOCITY_LIMIT, "MINIMUM_CRUISE_RATIO"}
        if law == "deviation":
            acts.add(_KLIPPERS_CORNER)
        idle = [key for key in values if key not in acts]
        why = f", because {_CORNERS[law]}" if _KLIPPERS_CORNER in idle else ""
        without = f"{command.code}: {_no_effect(idle)}{why}" if idle else ""
        above = [
            self._bounded(command.code, key, values.get(key, 0.0), what, ("x", "y"))
            for key, what in _OF_VELOCITY_LIMIT.items()
        ]
        return ". ".join(note for note in (*above, without) if note)

    # Of the class: an object that refers to itself would keep its job until it is found as garbage.
    def _cancel_objects(self, command: Command) -> None:
        """As a console has ordered it, by number, in the part of a print that is read again."""
        action = _core.ObjectAction
        for what, number, _ in _core.object_orders(command.code, command.text):
            if what in (action.CANCEL, action.RESTORE) and number >= 0:
                self._job.cancel_object(number, what == action.CANCEL)

    _HANDLERS: ClassVar[dict[str, Callable[[Commands, Command], Wait | None]]] = {
        "G28": _home,
        "G92": _set_position,
        "G92.1": _set_actuators,
        "M2": _end,
        "M30": _end,
        "EOF": _end,
        "M98": _call,
        "M99": _return,
        "M112": _stop,
        "M410": _stop,
        "M3": _spindle_start,
        "M4": _spindle_start,
        "M5": _spindle_stop,
        "S": _spindle_power,
        "M18": lambda self, _: WaitForMoves(),
        "M84": lambda self, _: WaitForMoves(),
        "M400": lambda self, _: WaitForMoves(),
        "M104": lambda self, c: self._set_temperature(c, "hotend"),
        "M140": lambda self, c: self._set_temperature(c, "bed"),
        "M141": lambda self, c: self._set_temperature(c, "chamber"),
        "M109": lambda self, c: self._reach_temperature(c, "hotend"),
        "M190": lambda self, c: self._reach_temperature(c, "bed"),
        "M191": lambda self, c: self._reach_temperature(c, "chamber"),
        "M116": _reach_all,
        "M145": lambda self, c: self._noted(self.presets.set(c.words()), c),
        "M106": _fan,
        "M107": _fan,
        "M201": lambda self, c: self._axis_limits(c, "accel"),
        "M203": lambda self, c: self._axis_limits(c, "speed"),
        "M204": _accelerations,
        "M205": _junction,
        "M220": _speed,
        "M221": _flow,
        "M290": _babystep,
        "G10": _tool_temperatures,
        "G80": lambda self, c: self.omitted.count(SkippedCommand.UNKNOWN, c.code, c.line),
        "SET_VELOCITY_LIMIT": _velocity_limit,
        "SET_GCODE_VARIABLE": lambda self, c: self.macros.set_variable(c),
        "M486": _cancel_objects,
    }


def _at_least(word: str, value: float, what: str) -> None:
    """Raises CommandError for a limit that no machine has."""
    least, unit = _LEAST[what]
    if value < least:
        raise CommandError.bad_value(word, value, f"at least {least:g} {unit}")


def _no_effect(words: Sequence[str]) -> str:
    return f"{' '.join(words)[:100]} {'has' if len(words) == 1 else 'have'} no effect"


def _key(command: Command) -> str:
    return "S" if command.letter == "S" else command.code
