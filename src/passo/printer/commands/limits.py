"""M201 to M205 and SET_VELOCITY_LIMIT: limits of speed, acceleration and corners."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from passo.config.motor_roles import axis_order
from passo.config.square_corner import deviation_mm
from passo.config.types import MIN_ACCEL, MIN_SPEED
from passo.errors import CommandError
from passo.gcode.command import Command, numeral
from passo.gcode.parameters import LARGEST, TOOL, axes, ignored, number
from passo.gcode.registry import Subject, When, command
from passo.printer.commands.extruder_words import extruder_of, with_extruders

if TYPE_CHECKING:
    from passo import _core
    from passo.config.machine import MachineConfig
    from passo.printer.commands.plan import Plan
    from passo.printer.wait_requests import Reply

_ROUNDING = 1e-6  # relative rounding of a value with ten digits
_DEVIATION = (1e-5, 0.3)  # range of M205 J, mm
_CORNERS = {
    "deviation": "the machine's corners use the junction deviation (J)",
    "square_corner": "the machine's corners use the speed at right angles"
    " (SET_VELOCITY_LIMIT SQUARE_CORNER_VELOCITY)",
    "cornering_distance": "the machine's corners use the cornering distances of its file",
    "jerk": "the machine's corners use the jerk of each axis (X Y Z E)",
}
_LEAST = {"speed": (MIN_SPEED, "mm/s"), "accel": (MIN_ACCEL, "mm/s²"), "jerk": (0.0, "mm/s")}
_OF_VELOCITY_LIMIT = {"VELOCITY": "speed", "ACCEL": "accel"}
_KLIPPERS_CORNER = "SQUARE_CORNER_VELOCITY"


class Limits:
    """The limits of one job. They apply to later moves; limits from a console during a print apply
    to all moves that can be replanned. A note reports values above the machine's limits, and words
    without an effect."""

    def __init__(self, machine: MachineConfig, job: _core.Job, plan: Plan) -> None:
        self._machine, self._job, self._plan = machine, job, plan
        self._axes = axis_order(machine.axes)

    def _set(self, reply: Reply, notes: Iterable[str], *, again: bool = False) -> None:
        """Replans if settings from this source are live, and sends the notes."""
        if note := ". ".join(note for note in notes if note):
            reply.note(note, note, again=again)
        if self._plan.live(reply):
            self._plan.replan()

    # -- axes -------------------------------------------------------------------------------------

    @command(
        "M201",
        Subject.SPEED,
        When.PLANNED,
        "Sets the maximum accelerations of axes, at most those of the machine file.",
        axes("X Y Z E", "the acceleration of an axis", "mm/s²", MIN_ACCEL, but="H"),
        TOOL,
    )
    def _axis_accelerations(self, command: Command, reply: Reply) -> None:
        self._set_axes(command, reply, "accel")

    @command(
        "M203",
        Subject.SPEED,
        When.PLANNED,
        "Sets the maximum speeds of axes, at most those of the machine file.",
        axes("X Y Z E", "the speed of an axis", "mm/s", MIN_SPEED, but="H"),
        TOOL,
    )
    def _axis_speeds(self, command: Command, reply: Reply) -> None:
        self._set_axes(command, reply, "speed")

    def _set_axes(self, command: Command, reply: Reply, what: str) -> None:
        words = command.words()
        if not words:
            _report(reply, self.axis_lines(command.code, what))
            return
        live = self._plan.live(reply)
        self._set(reply, self._axis_limits(command.code, words, what, live=live), again=True)

    def _axis_limits(
        self, code: str, words: dict[str, float], what: str, *, live: bool
    ) -> list[str]:
        """Sets limits of axes and extruders. Returns a note for each value above the machine's.
        Raises CommandError."""
        given = {letter: value for letter, value in words.items() if letter != "T"}
        known = [name.upper() for name in self._axes]
        for letter in given:
            if letter != "E" and letter not in known:
                raise CommandError.of("command.nothing-moves", axis=letter, limit=", ".join(known))
        notes: list[str] = []
        for letter, value in given.items():
            e = letter == "E"
            name = extruder_of(self._machine, words, self._job.tool) if e else letter.lower()
            if name is not None:
                self._job.limits.set_of_axis(name, what, value, live)
                taken, unit = self._job.limits.of_axis(name, what), _LEAST[what][1]
                if taken < value * (1 - _ROUNDING):
                    above = f"{letter} {value:g} {unit} is above the machine's limit"
                    notes.append(f"{code}: {above}, {taken:g} {unit} is applied")
        return notes

    def axis_lines(self, code: str, what: str) -> list[str]:
        """M201 ("accel"), M203 ("speed") or M205 ("jerk") with the current values."""
        job = self._job
        words = [f"{a.upper()}{numeral(job.limits.of_axis(a, what))}" for a in self._axes]
        return with_extruders(
            self._machine, code, words, lambda name: job.limits.of_axis(name, what)
        )

    # -- path -------------------------------------------------------------------------------------

    @command(
        "M204",
        Subject.SPEED,
        When.PLANNED,
        "Sets accelerations: S of print and travel moves, P of print moves, R of retractions, T or"
        " V of travel moves.",
        number("S", "of print and travel moves", "mm/s²", MIN_ACCEL),
        number("P", "of print moves", "mm/s²", MIN_ACCEL),
        number("R", "of retractions", "mm/s²", MIN_ACCEL),
        number("T V", "of travel moves", "mm/s²", MIN_ACCEL),
    )
    def _accelerations(self, command: Command, reply: Reply) -> None:
        words = command.words()
        if not words:
            reply.say(self.acceleration_line())
            return
        for letter, names in (
            ("S", ("print_accel", "travel_accel")),
            ("P", ("print_accel",)),
            ("V", ("travel_accel",)),
            ("T", ("travel_accel",)),
            ("R", ("retract_accel",)),
        ):
            if letter in words:
                for name in names:
                    self._job.limits.set(name, words[letter], self._plan.live(reply))
        notes: list[str] = []
        for letter in "SPTVR":
            axes = self._machine.extruders if letter == "R" else ("x", "y")
            notes.append(self._bounded("M204", letter, words.get(letter, 0.0), "accel", axes))
        self._set(reply, notes)

    def acceleration_line(self) -> str:
        """M204 with the current values."""
        p, r, t = (self._job.limits.value(f"{k}_accel") for k in ("print", "retract", "travel"))
        return f"M204 P{numeral(p)} R{numeral(r)} T{numeral(t)}"

    def _bounded(self, code: str, word: str, value: float, what: str, names: Iterable[str]) -> str:
        """A note if a limit of the path is above that of the machine file for these axes or
        extruders, which also limits moves; else nothing."""
        parts = {**self._machine.axes, **self._machine.extruders}
        own = {n: parts[n].accel_mm_s2 if what == "accel" else parts[n].speed_mm_s for n in names}
        if value >= LARGEST or not any(limit < value for limit in own.values()):
            return ""
        applied = ", ".join(f"{n.upper()} {self._job.limits.of_axis(n, what):g}" for n in own)
        bounds = "M201" if what == "accel" else "M203"
        return f"{code}: {word} {value:g} is above the limits of {bounds}, which apply: {applied}"

    # -- corners ----------------------------------------------------------------------------------

    @command(
        "M205",
        Subject.SPEED,
        When.PLANNED,
        "Sets the speed in corners: the junction deviation (J), or the jerk of each axis up to the"
        " machine's limit. The machine file selects which of the two. Minimum speeds do not exist.",
        number("J", "the junction deviation", "mm", *_DEVIATION),
        axes("X Y Z E", "the jerk of an axis", "mm/s", but="BH"),
        number("T", "the tool of E"),
        ignored("B S V"),
    )
    def _junction(self, command: Command, reply: Reply) -> None:
        words = command.words()
        if not words:
            _report(reply, self.junction_lines() or [self.velocity_line()])
            return
        live = self._plan.live(reply)
        jerk = {letter: value for letter, value in words.items() if letter not in "BJSV"}
        if jerk.keys() <= {"T"}:
            jerk = {}  # here T is the minimum travel speed, not a tool
        law, deviation = self._machine.limits.junction, words.get("J")
        if law == "deviation" and deviation is not None:
            self._job.limits.set("junction_deviation", deviation, live)
        above = self._axis_limits("M205", jerk, "jerk", live=live) if law == "jerk" else []
        acts = {"deviation": {"J"}, "jerk": jerk.keys()}.get(law, set[str]())
        # Without a limit, as after S0, any speed and any segment is allowed.
        idle = [k for k, value in words.items() if k not in acts and (value or k not in "BSTV")]
        without = f"M205: {_no_effect(idle)}, because {_CORNERS[law]}" if idle else ""
        self._set(reply, (*above, without))

    def junction_lines(self) -> list[str]:
        """M205 with the current values; nothing if it sets none."""
        law = self._machine.limits.junction
        if law == "jerk":
            return self.axis_lines("M205", "jerk")
        if law == "square_corner":
            return []
        return [f"M205 J{numeral(self._job.limits.value('junction_deviation'))}"]

    # -- Klipper ----------------------------------------------------------------------------------

    @command(
        "SET_VELOCITY_LIMIT",
        Subject.SPEED,
        When.PLANNED,
        "Sets limits of speed, acceleration and corners.",
        number("VELOCITY", "the speed of a move", "mm/s", MIN_SPEED),
        number("ACCEL", "the acceleration of print and travel moves", "mm/s²", MIN_ACCEL),
        number(
            "MINIMUM_CRUISE_RATIO", "the share of a move at constant speed, below 1", low=0, high=1
        ),
        number("SQUARE_CORNER_VELOCITY", "the speed in a corner of 90°", "mm/s", 0, above=True),
        ignored("ACCEL_TO_DECEL"),
    )
    def _velocity_limit(self, command: Command, reply: Reply) -> None:
        known = (key for key in command.pairs() if key not in command.unknown())
        values = {key: command.value(key) for key in known}
        corner, ratio = values.get(_KLIPPERS_CORNER), values.get("MINIMUM_CRUISE_RATIO")
        if ratio == 1:
            raise CommandError.bad_value("MINIMUM_CRUISE_RATIO", ratio, "0 to less than 1")
        job, live = self._job, self._plan.live(reply)
        if "VELOCITY" in values:
            job.limits.set("speed", values["VELOCITY"], live)
        if "ACCEL" in values:
            job.limits.set("print_accel", values["ACCEL"], live)
            job.limits.set("travel_accel", values["ACCEL"], live)
        if ratio is not None:
            job.limits.set("minimum_cruise_ratio", ratio, live)
        law = self._machine.limits.junction
        if corner is not None and law == "deviation":
            low, high = _DEVIATION
            deviation = min(max(deviation_mm(corner, job.limits.value("print_accel")), low), high)
            job.limits.set("junction_deviation", deviation, live)
        elif corner is not None and law == "square_corner":
            job.limits.set("square_corner", max(corner, MIN_SPEED), live)
        acts = {*_OF_VELOCITY_LIMIT, "MINIMUM_CRUISE_RATIO"}
        if law in ("deviation", "square_corner"):
            acts.add(_KLIPPERS_CORNER)
        idle = [key for key in values if key not in acts]
        why = f", because {_CORNERS[law]}" if _KLIPPERS_CORNER in idle else ""
        without = f"{command.code}: {_no_effect(idle)}{why}" if idle else ""
        above = [
            self._bounded(command.code, key, values.get(key, 0.0), what, ("x", "y"))
            for key, what in _OF_VELOCITY_LIMIT.items()
        ]
        self._set(reply, (*above, without))

    def velocity_line(self) -> str:
        """SET_VELOCITY_LIMIT with the settings that no other command has; 1e9 mm/s means no
        limit."""
        speed, ratio = (self._job.limits.value(k) for k in ("speed", "minimum_cruise_ratio"))
        speed, ratio = numeral(min(speed, LARGEST)), numeral(ratio)
        line = f"SET_VELOCITY_LIMIT VELOCITY={speed} MINIMUM_CRUISE_RATIO={ratio}"
        if self._machine.limits.junction != "square_corner":
            return line
        return f"{line} {_KLIPPERS_CORNER}={numeral(self._job.limits.value('square_corner'))}"


def _no_effect(words: Sequence[str]) -> str:
    return f"{' '.join(words)[:100]} {'has' if len(words) == 1 else 'have'} no effect"


def _report(reply: Reply, lines: Iterable[str]) -> None:
    for line in lines:
        reply.say(line)
