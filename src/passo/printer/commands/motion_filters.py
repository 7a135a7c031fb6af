"""M593, M900, M572, the equivalent Klipper commands, and SET_JERK_LIMIT: input shapers, pressure
advance and the limit of jerk."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from passo import _core
from passo.config.advance import cost, half_smooth_s, smooth_s
from passo.config.jerk import MAX_JERK, box_s, least_jerk
from passo.config.motion import MAX_ADVANCE_S, MAX_SMOOTH_S, MIN_SMOOTH_S
from passo.config.shapers import (
    DEFAULT_DAMPING,
    DEFAULT_TYPE,
    MAX_HZ,
    MIN_HZ,
    SHAPER_FORMS,
    impulses,
    max_damping,
    shaper_form,
)
from passo.errors import CommandError
from passo.gcode.command import Command, numeral
from passo.gcode.parameters import TOOL, ignored, integer, number, text
from passo.gcode.registry import Subject, When, command
from passo.printer.commands.extruder_words import extruder_of
from passo.printer.status import AdvanceStatus, ShaperStatus
from passo.printer.wait_requests import Wait, WaitForMoves

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.printer.wait_requests import Reply

_AXES = "XYZ"


@dataclass(frozen=True, slots=True)
class Shaper:
    """The shaper of one axis; with 0 Hz the axis is not shaped."""

    kind: str = DEFAULT_TYPE
    frequency_hz: float = 0.0
    damping: float = DEFAULT_DAMPING


class MotionFilters:
    """The filters of one job. A new shaper, smoothing time or limit of jerk takes effect at
    standstill, after the moves before the command. A new pressure advance takes effect from the
    next move on, without a stop."""

    def __init__(self, machine: MachineConfig, job: _core.Job) -> None:
        self._machine, self._job = machine, job
        self.shapers = {letter: Shaper() for letter in _AXES}
        for name, given in machine.shaping.items():
            self.shapers[name.upper()] = Shaper(given.type, given.frequency_hz, given.damping)
        self._extruders = list(machine.extruders)
        self._made = list(machine.extruders.values())
        self.smooth_s = [smooth_s(machine.path_limits, extruder) for extruder in self._made]
        self._smooths = [
            half_smooth_s(machine.path_limits, extruder) > 0 for extruder in self._made
        ]
        self.jerk_mm_s3 = machine.limits.jerk_mm_s3 or 0.0  # 0: no limit

    # -- shapers ----------------------------------------------------------------------------------

    @command(
        "M593",
        Subject.SPEED,
        When.PLANNED,
        "Sets the input shaper of axes, X and Y if none is named: the frequency (F0: none), the"
        f" damping ratio (D or S) and the type ({SHAPER_FORMS}). The machine stops"
        " for a change.",
        number("X Y Z", "an axis to shape; by default X and Y", alone=True),
        number("F", "the frequency", "Hz", MIN_HZ, MAX_HZ, off=True),
        number("D S", "the damping ratio", low=0, high=1),
        text("P", f"the type: {SHAPER_FORMS}"),
    )
    def _shape(self, command: Command, reply: Reply) -> Wait | None:
        named = [letter for letter in _AXES if command.has(letter)]
        kind = command.string("P") if command.has("P") else None
        damping = command.value("D", command.value("S", None))
        frequency = command.value("F", None)
        if kind is None and damping is None and frequency is None:
            for line in self.shaper_lines():
                reply.say(line)
            return None
        changed: dict[str, Shaper] = {}
        for axis in named or _AXES[:2]:
            changed[axis] = _shaper(self.shapers[axis], kind, frequency, damping)
        return self._set_shapers(changed)

    @command(
        "SET_INPUT_SHAPER",
        Subject.SPEED,
        When.PLANNED,
        "Sets input shapers, as M593.",
        number(
            "SHAPER_FREQ_X SHAPER_FREQ_Y SHAPER_FREQ_Z",
            "the frequency",
            "Hz",
            MIN_HZ,
            MAX_HZ,
            off=True,
        ),
        text(
            "SHAPER_TYPE SHAPER_TYPE_X SHAPER_TYPE_Y SHAPER_TYPE_Z",
            f"the type, of all axes or of one: {SHAPER_FORMS}",
        ),
        number(
            "DAMPING_RATIO_X DAMPING_RATIO_Y DAMPING_RATIO_Z", "the damping ratio", low=0, high=1
        ),
    )
    def _shape_by_names(self, command: Command, reply: Reply) -> Wait | None:
        if not command.text.strip():
            for line in self.shaper_lines():
                reply.say(line)
            return None
        changed: dict[str, Shaper] = {}
        for axis in _AXES:
            own = f"SHAPER_TYPE_{axis}"
            given = next((key for key in (own, "SHAPER_TYPE") if command.has(key)), None)
            kind = None if given is None else command.string(given)
            frequency = command.value(f"SHAPER_FREQ_{axis}", None)
            damping = command.value(f"DAMPING_RATIO_{axis}", None)
            if frequency is None and damping is None and kind is None:
                continue
            changed[axis] = _shaper(self.shapers[axis], kind, frequency, damping)
        return self._set_shapers(changed)

    def use_shapers(self, changed: dict[str, Shaper]) -> None:
        """Sets shapers at once, by axis in upper case. Call it only at standstill. Raises
        CommandError."""
        wait = self._set_shapers(changed)
        if wait is not None and wait.then is not None:
            wait.then()

    def _set_shapers(self, changed: dict[str, Shaper]) -> WaitForMoves | None:
        changed = {axis: new for axis, new in changed.items() if new != self.shapers[axis]}
        for new in changed.values():
            if new.frequency_hz > 0 and self._machine.laser is not None:
                limit = "0, as the power of the laser of this machine follows the plan"
                raise CommandError.bad_value("frequency", new.frequency_hz, limit)
        self.shapers |= changed
        if not changed:
            return None

        def apply() -> None:
            for axis, new in changed.items():
                shapes = new.frequency_hz > 0
                found = impulses(new.kind, new.frequency_hz, new.damping) if shapes else []
                numbers = [number for impulse in found for number in impulse]
                self._job.filters.set("shapers", _AXES.index(axis), numbers)

        return WaitForMoves(apply)

    def shaper_lines(self) -> list[str]:
        """SET_INPUT_SHAPER for each axis with the current values."""
        return [
            f"SET_INPUT_SHAPER SHAPER_FREQ_{axis}={numeral(shaper.frequency_hz)}"
            f" SHAPER_TYPE_{axis}={shaper.kind} DAMPING_RATIO_{axis}={numeral(shaper.damping)}"
            for axis, shaper in self.shapers.items()
        ]

    # -- jerk -------------------------------------------------------------------------------------

    @command(
        "SET_JERK_LIMIT",
        Subject.SPEED,
        When.PLANNED,
        "Sets the maximum change of the acceleration of X, Y and Z in a second (mm/s³), 0 for no"
        " limit. The machine stops for a change.",
        number("JERK", "the change of the acceleration; 0: no limit", "mm/s³", 0, MAX_JERK),
    )
    def _limit_jerk(self, command: Command, reply: Reply) -> Wait | None:
        jerk = command.value("JERK", None)
        if jerk is None:
            reply.say(self.jerk_line())
            return None
        if jerk == self.jerk_mm_s3:
            return None
        if jerk > 0 and self._machine.laser is not None:
            limit = "0, as the power of the laser of this machine follows the plan"
            raise CommandError.bad_value("JERK", jerk, limit)
        if jerk != 0:
            least = least_jerk(self._machine.largest_accel_mm_s2)
            if jerk < least:
                limits = f"0 (no limit), or {least:.0f} to {MAX_JERK:g} mm/s³"
                raise CommandError.bad_value("JERK", jerk, limits)
        self.jerk_mm_s3 = jerk
        return WaitForMoves(lambda: self._job.filters.set("box_s", 0, [self.box_s]))

    def jerk_line(self) -> str:
        """SET_JERK_LIMIT with the current value."""
        return f"SET_JERK_LIMIT JERK={numeral(self.jerk_mm_s3)}"

    @property
    def box_s(self) -> float:
        """The time over which all positions are averaged, s; 0 without a limit of jerk."""
        return box_s(self._machine.largest_accel_mm_s2, self.jerk_mm_s3)

    # -- pressure advance -------------------------------------------------------------------------

    @command(
        "M900",
        Subject.FILAMENT,
        When.PLANNED,
        "Sets the pressure advance of an extruder, the tool's in use if T names none.",
        number("K", "the advance", "s", 0),
        TOOL,
        ignored("L S"),
    )
    def _advance(self, command: Command, reply: Reply) -> Wait | None:
        extruder = self._extruder(extruder_of(self._machine, command.words(), self._job.tool))
        advance = command.value("K", None)
        if advance is None:
            if extruder is not None:
                reply.say(f"Advance K={self._job.filters.advance(extruder):g}")
                self._say_knees(extruder, reply)
            return None
        # a slicer may send the K of Linear Advance 1.0 as well as that of 1.5
        if advance > MAX_ADVANCE_S:
            reply.note("M900", f"M900: K{advance:g} is of Linear Advance 1.0 and has no effect")
            return None
        return None if extruder is None else self._set_advance(extruder, advance)

    @command(
        "M572",
        Subject.FILAMENT,
        When.PLANNED,
        "Sets the pressure advance (S) of the extruder D, 0 if it is not given.",
        integer("D", "the extruder", 0, default=0),
        number("S", "the advance", "s", 0, MAX_ADVANCE_S),
    )
    def _advance_of_drive(self, command: Command, reply: Reply) -> Wait | None:
        drive, advance = command.integer("D"), command.value("S", None)
        if drive not in range(len(self._extruders)):
            raise CommandError.bad_value("D", drive, f"an extruder below {len(self._extruders)}")
        if advance is None:
            advance = self._job.filters.advance(drive)
            reply.say(f"Extruder {drive} pressure advance: {advance:g} s")
            self._say_knees(drive, reply)
            return None
        return self._set_advance(drive, advance)

    @command(
        "SET_PRESSURE_ADVANCE",
        Subject.FILAMENT,
        When.PLANNED,
        "Sets the pressure advance of an extruder and the time over which it is smoothed, in s. For"
        f" a change of SMOOTH_TIME the machine stops. Below {MIN_SMOOTH_S:g} s it is that; a note"
        " says what a short time costs.",
        text("EXTRUDER", "the name of the extruder, by default the one in use"),
        number("ADVANCE", "the advance", "s", 0, MAX_ADVANCE_S),
        number("SMOOTH_TIME", "the time over which it is smoothed", "s", 0, MAX_SMOOTH_S),
    )
    def _advance_by_name(self, command: Command, reply: Reply) -> Wait | None:
        extruder = self._named(command.string("EXTRUDER") if command.has("EXTRUDER") else None)
        if extruder is None:
            return None
        advance, smooth = command.value("ADVANCE", None), command.value("SMOOTH_TIME", None)
        if advance is None and smooth is None:
            reply.say(f"pressure_advance: {self._job.filters.advance(extruder):.6f}")
            reply.say(f"pressure_advance_smooth_time: {self.smooth_s[extruder]:.6f}")
            self._say_knees(extruder, reply)
            return None
        if advance is None:
            advance = self._job.filters.advance(extruder)
        if smooth is not None:
            self._note_cost(extruder, advance, smooth, reply)
            smooth = max(smooth, MIN_SMOOTH_S)
        return self._set_advance(extruder, advance, smooth)

    def _note_cost(self, extruder: int, advance: float, smooth: float, reply: Reply) -> None:
        """Notes that a smoothing time is too short, and what it costs."""
        used = max(smooth, MIN_SMOOTH_S)
        costs = cost(self._machine.path_limits, self._made[extruder], advance, used)
        if smooth < MIN_SMOOTH_S:
            costs = f"it counts as {MIN_SMOOTH_S:g} s" + (f"; {costs}" if costs else "")
        if costs:
            reply.note("SMOOTH_TIME", f"SMOOTH_TIME {smooth:g}: {costs}", again=True)

    def knees(self, extruder: int, advance_s: float) -> list[tuple[float, float]]:
        """The knees of an extruder whose advance is `advance_s`: the speed of the filament in mm/s,
        and the advance in s above this speed."""
        made = self._made[extruder]
        scale = advance_s / (made.advance_s or 1.0)
        return [(speed, value * scale) for speed, value in made.advance_knees]

    def advanced_mm(self, extruder: int, advance_s: float, speed: float) -> float:
        """The mm by which the filament leads at a speed in mm/s."""
        mm, slope = advance_s * speed, advance_s
        for knee, less in self.knees(extruder, advance_s):
            mm -= (slope - less) * max(speed - knee, 0.0)
            slope = less
        return mm

    def _say_knees(self, extruder: int, reply: Reply) -> None:
        for speed, value in self.knees(extruder, self._job.filters.advance(extruder)):
            reply.say(f"above {speed:g} mm/s of filament: {value:g} s")

    def _set_advance(
        self, extruder: int, advance: float, smooth: float | None = None
    ) -> Wait | None:
        """Sets the advance of an extruder. From its first advance on, the extruder is smoothed,
        which changes the delay of all motors. This change waits for standstill."""
        smooth = self.smooth_s[extruder] if smooth is None else smooth
        other = smooth != self.smooth_s[extruder]
        self.smooth_s[extruder] = smooth
        if not (other if self._smooths[extruder] else advance > 0):
            self._job.filters.set_advance(extruder, advance)
            return None
        self._smooths[extruder] = True

        def apply() -> None:
            self._job.filters.set("smooth_s", extruder, [smooth / 2])
            self._job.filters.set_advance(extruder, advance)

        return WaitForMoves(apply)

    def _named(self, name: str | None) -> int | None:
        """The extruder with this name (Klipper's or the machine file's); without a name, the active
        one. Raises CommandError."""
        if name is None:
            return self._extruder(extruder_of(self._machine, {}, self._job.tool))
        known = {_klipper_name(i): i for i in range(len(self._extruders))}
        known |= {own: i for i, own in enumerate(self._extruders)}
        if name not in known:
            limit = ", ".join(known) or "none on this machine"
            raise CommandError.of("command.value", axis="EXTRUDER", value=name, limit=limit)
        return known[name]

    def _extruder(self, name: str | None) -> int | None:
        return None if name is None else self._extruders.index(name)

    def advance_lines(self) -> list[str]:
        """SET_PRESSURE_ADVANCE for each extruder with the current values."""
        several = len(self._extruders) > 1
        lines: list[str] = []
        for i, seconds in enumerate(self.smooth_s):
            named = f" EXTRUDER={_klipper_name(i)}" if several else ""
            values = f"ADVANCE={numeral(self._job.filters.advance(i))}"
            smooth = f"SMOOTH_TIME={numeral(seconds)}"
            lines.append(f"SET_PRESSURE_ADVANCE{named} {values} {smooth}")
        return lines

    def shapes_filament(self, extruder: int) -> bool:
        """Whether the filament of this extruder follows a shaper of X or Y."""
        shaped = any(self.shapers[axis].frequency_hz > 0 for axis in _AXES[:2])
        return shaped and extruder < len(self._made) and self._made[extruder].shaped

    @property
    def delay_s(self) -> float:
        """The delay of all motors relative to the plan, s: a whole number of ticks."""
        return self._job.filters.delay_s

    def shaper_status(self) -> dict[str, ShaperStatus]:
        """The shapers by axis, in lower case."""
        return {
            axis.lower(): ShaperStatus(shaper.kind, shaper.frequency_hz, shaper.damping)
            for axis, shaper in self.shapers.items()
        }

    def advance_status(self) -> tuple[AdvanceStatus, ...]:
        """The advance of each extruder."""
        advance = self._job.filters.advance
        return tuple(AdvanceStatus(advance(i), s) for i, s in enumerate(self.smooth_s))

    def lines(self) -> Iterator[str]:
        """All filters as commands."""
        yield from self.shaper_lines()
        yield self.jerk_line()
        yield from self.advance_lines()


def _klipper_name(extruder: int) -> str:
    return "extruder" + (str(extruder) if extruder else "")


def _shaper(
    old: Shaper, kind: str | None, frequency_hz: float | None, damping: float | None
) -> Shaper:
    """A copy of the shaper with these values; None keeps a value. Raises CommandError."""
    if kind is not None:
        try:
            old = replace(old, kind=shaper_form(kind))
        except ValueError:
            raise CommandError.of(
                "command.value", axis="type", value=kind or "missing", limit=SHAPER_FORMS
            ) from None
    if frequency_hz is not None:
        old = replace(old, frequency_hz=frequency_hz)
    if damping is not None:
        old = replace(old, damping=damping)
    most = max_damping(old.kind)
    if not old.damping <= most:
        limit = f"0 to {most:g} for the type {old.kind}"
        raise CommandError.bad_value("damping ratio", old.damping, limit)
    return old
