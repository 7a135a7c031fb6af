"""APrinter's run-time options by their names: M925 tells one, M926 notes a new value, M930 applies
what was noted."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, NamedTuple

from passo import _core
from passo.config.sensors import Thermistor
from passo.errors import CommandError
from passo.heat.rules import M301_FULL_POWER
from passo.printer.waits import Handler, Reply, Silence, Still, Wait
from passo.printer.words import Command

if TYPE_CHECKING:
    from passo.printer.printer import Printer

_ARGUMENTS = re.compile(r"\s*[Ii](\S+)(?:\s+[Vv](\S+))?")
_KINDS = {"hotend": "ExtruderHeater", "bed": "BedHeater", "chamber": "ChamberHeater"}


class Option(NamedTuple):
    """A value that can be told, and the command that sets it, with `{}` in the place of the value;
    empty where only the machine file does."""

    name: str
    value: Callable[[], float]
    command: str = ""
    scale: float = 1.0  # from the option's unit to the command's


class OptionCommands:
    """M925, M926 and M930 of one printer."""

    def __init__(self, printer: Printer) -> None:
        self._printer = printer
        self._options = {option.name.lower(): option for option in self._all()}
        self._defaults = {name: option.value() for name, option in self._options.items()}
        self.pending: dict[str, float] = {}  # by name in lower case
        self.immediate: dict[str, Handler] = {"M925": self._tell, "M926": self._note}
        self.planned: dict[str, Handler] = {"M930": self._apply}

    def pending_lines(self) -> Iterator[str]:
        """What was noted and is not yet applied, as commands behind a `;`."""
        for name, value in self.pending.items():
            yield f"; pending until M930: M926 I{self._options[name].name} V{value:.10g}"

    # -- commands ---------------------------------------------------------------------------------

    def _named(self, command: Command) -> tuple[Option, str | None]:
        match = _ARGUMENTS.match(command.text)
        option = self._options.get(match[1].lower()) if match else None
        if match is None or option is None:
            name = match[1] if match else "nothing"
            raise CommandError.of("option.unknown", value=name)
        return option, match[2]

    def _tell(self, command: Command, reply: Reply) -> Wait | None:
        option, _ = self._named(command)
        reply.say(f"{option.value():.10g}")
        return None

    def _note(self, command: Command, _: Reply) -> Wait | None:
        option, text = self._named(command)
        if not option.command:
            raise CommandError.of("command.fixed", value=option.name)
        name = option.name.lower()
        try:
            value = self._defaults[name] if text is None else float(text)
        except ValueError:
            raise CommandError.of("command.value", axis="V", value=text, limit="a number") from None
        self.pending[name] = value
        return None

    def _apply(self, _: Command, reply: Reply) -> Wait | None:
        return Still(lambda: self._apply_now(reply))

    def _apply_now(self, reply: Reply) -> None:
        pending, self.pending = self.pending, {}
        for name, value in pending.items():
            option = self._options[name]
            before = option.value()
            line = option.command.format(f"{value * option.scale:.10g}")
            self._printer.take_setting(line, Silence())
            if option.value() == before != value:
                reply.say(f"echo:{option.name} stays at {before:.10g}; {line} was not taken")

    # -- the table --------------------------------------------------------------------------------

    def _all(self) -> Iterator[Option]:
        printer, machine = self._printer, self._printer.machine
        yield Option("InactiveTime", lambda: printer.motors.idle_s, "M84 S{}")
        yield Option("MinExtrusionTemp", lambda: printer.heat.cold_c, "M302 S{}")
        for axis in machine.axes:
            yield from self._axis(axis)
        for extruder in list(machine.extruders)[:1]:
            yield from self._moved(extruder, "E")
        yield Option("EStepsPerUnit", lambda: self._scale("e"), "M92 E{}")
        for name in machine.heaters:
            yield from self._heater(name)

    def _moved(self, name: str, letter: str) -> Iterator[Option]:
        """What axes and extruders have."""
        printer = self._printer
        yield Option(
            f"{letter}MaxSpeed",
            lambda: printer.job.axis_limit(name, "speed"),
            f"M203 {letter}{{}}",
        )
        yield Option(
            f"{letter}MaxAccel",
            lambda: printer.job.axis_limit(name, "accel"),
            f"M201 {letter}{{}}",
        )

    def _axis(self, name: str) -> Iterator[Option]:
        printer = self._printer
        axis, letter = printer.machine.axes[name], name.upper()
        yield from self._moved(name, letter)
        if name in printer.machine.steppers:
            yield Option(f"{letter}StepsPerUnit", lambda: self._scale(name), f"M92 {letter}{{}}")
        yield Option(f"{letter}CorneringDistance", lambda: axis.cornering_distance_steps)
        if axis.extruder:
            return
        yield Option(f"{letter}MinPos", lambda: axis.min_mm)
        yield Option(f"{letter}MaxPos", lambda: axis.max_mm)
        yield Option(
            f"{letter}HomeOffset",
            lambda: printer.motion.home_offset_mm[name],
            f"M206 {letter}{{}}",
        )
        homing = printer.machine.homing.get(name)
        if homing is not None:
            yield Option(f"{letter}HomeDir", lambda: float(homing.direction == "max"))
            yield Option(f"{letter}HomeFastSpeed", lambda: homing.fast)
            yield Option(f"{letter}HomeSlowSpeed", lambda: homing.slow)
            yield Option(f"{letter}HomeRetractDist", lambda: homing.retract)

    def _scale(self, stepper: str) -> float:
        rows = {row["name"]: row["steps_per_unit"] for row in self._printer.job.steppers()}
        return rows.get(stepper, 0.0)

    def _heater(self, name: str) -> Iterator[Option]:
        printer = self._printer
        config = printer.machine.heaters[name]
        same = [n for n, h in printer.machine.heaters.items() if h.kind == config.kind]
        prefix = f"{_KINDS[config.kind]}{same.index(name)}"
        number = printer.tunes.number_of(name)
        yield Option(f"{prefix}MinSafeTemp", lambda: config.min_c)
        yield Option(f"{prefix}MaxSafeTemp", lambda: config.max_c)
        for letter, key in (("P", "kp"), ("I", "ki"), ("D", "kd")):
            yield Option(
                f"{prefix}Pid{letter}",
                lambda key=key: self._gain(name, key),
                f"M301 H{number} {letter}{{}}",
                M301_FULL_POWER,
            )
        for option, letter, key in (
            ("TempR0", "A", "r25_ohm"),
            ("TempBeta", "B", "beta_k"),
            ("TempResistorR", "R", "pullup_ohm"),
        ):
            if isinstance(config.sensor, Thermistor):
                yield Option(
                    f"{prefix}{option}",
                    lambda key=key: float(getattr(printer.tunes.sensors[name], key)),
                    f"M305 H{number} {letter}{{}}",
                )

    def _gain(self, name: str, key: str) -> float:
        control = self._printer.connection.heaters[name].control
        return float(getattr(control, key)) if isinstance(control, _core.PidControl) else 0.0
