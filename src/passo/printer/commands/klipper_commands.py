"""Klipper's commands that are translated to numbered commands. The resulting lines are read next,
like the lines of a macro."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from passo.config.heater_numbers import number_of
from passo.config.klipper_names import extruder_object, fan_object, heater_object
from passo.config.part_names import found_name
from passo.errors import CommandError
from passo.gcode.command import Command
from passo.gcode.parameters import flag, number, text
from passo.gcode.registry import Subject, When, command, in_program
from passo.printer.stand_ins import FANS, HEATERS
from passo.printer.status import RetractionStatus
from passo.printer.wait_requests import without_effect

if TYPE_CHECKING:
    from passo import _core
    from passo.config.machine import MachineConfig
    from passo.printer.stand_ins import StandIns
    from passo.printer.wait_requests import Reply

_OF_PAGES = "_ui_"  # prefix of states that web pages save before manual moves, which are in mm
_DEFAULT = "default"  # name of a state that is saved without a name
_SETS = {"hotend": ("M104", "T"), "bed": ("M140", "P"), "chamber": ("M141", "P")}
_FULL_FAN = 255
_NOT_DRIVEN = "Passo does not drive this part, which the machine file keeps for macros."
_TUNED = "a heater that H of M303 means"


@dataclass(frozen=True, slots=True)
class _Saved:
    """The state for RESTORE_GCODE_STATE: commands that restore the modes (without the tool), the
    factors, and the program's position, mm."""

    modes: tuple[str, ...]
    speed_factor: float
    flows: tuple[float, ...]
    program_mm: tuple[float, float, float]
    filament_mm: float


class KlipperCommands:
    """Translates the Klipper commands of one job."""

    def __init__(
        self,
        machine: MachineConfig,
        job: _core.Job,
        babysteps_mm: dict[str, float],
        stand_ins: StandIns,
    ) -> None:
        """`babysteps_mm` are those of the program so far; SET_GCODE_OFFSET changes them."""
        self._machine, self._job, self._babysteps_mm = machine, job, babysteps_mm
        self._stand_ins = stand_ins
        self._saved: dict[str, _Saved] = {}
        self.unrestored: dict[str, None] = {}
        """The states that were saved and not restored yet, oldest first; a caller may clear it."""

    def _become(self, *lines: str | Command) -> None:
        """Reads these lines next. They mean the built-in commands, also where a macro replaces
        one, because such a macro often calls the command that becomes these lines."""
        self._job.program.insert("".join(f"{self._built_in(line)}\n" for line in lines).encode())

    def _built_in(self, line: str | Command) -> str:
        text = line if isinstance(line, str) else f"{line.code} {line.text}"
        code, _, words = text.partition(" ")
        name = self._machine.macro_names.get(code)
        other = self._machine.macros[name].rename_existing if name else None
        return f"{other or code} {words}".rstrip()

    # -- modes of reading -----------------------------------------------------------------------

    @command(
        "SAVE_GCODE_STATE",
        Subject.MACROS,
        When.PLANNED,
        "Saves modes, units, feedrate, factors and position, for RESTORE_GCODE_STATE. After a NAME"
        " that begins with _ui_, as pages have it, lines count in mm (G21).",
        text("NAME", "the name of the state, by default `default`"),
    )
    def _save(self, command: Command, _: Reply) -> None:
        job = self._job
        at = job.program_position
        name = command.string("NAME", _DEFAULT)
        self.unrestored[name] = None
        self._saved[name] = _Saved(
            modes=tuple(mode for mode in job.modes.gcode.split("\n") if not mode.startswith("T")),
            speed_factor=job.limits.speed_factor,
            flows=tuple(job.filament.flows),
            program_mm=(at[0], at[1], at[2]),
            filament_mm=at[-1],
        )
        if name.startswith(_OF_PAGES):
            self._become("G21")

    @command(
        "RESTORE_GCODE_STATE",
        Subject.MACROS,
        When.PLANNED,
        "Restores what SAVE_GCODE_STATE has saved, but not tool, babysteps and the zero of X, Y and"
        " Z. With MOVE=1 it returns to the position.",
        text("NAME", "the name of the state, by default `default`"),
        flag("MOVE", "returns to the position"),
        number("MOVE_SPEED", "the speed of the return", "mm/s", 0, above=True),
    )
    def _restore(self, command: Command, _: Reply) -> None:
        job, name = self._job, command.string("NAME", _DEFAULT)
        saved = self._saved.get(name)
        if saved is None:
            limit = ", ".join(self._saved) or "a name that SAVE_GCODE_STATE has given"
            raise CommandError.of("command.value", axis="NAME", value=name, limit=limit)
        self.unrestored.pop(name, None)
        lines: list[str | Command] = ["G21"]
        if job.program_position[-1] != saved.filament_mm and self._machine.extruders:
            lines.append(Command.call("G92", E=saved.filament_mm))
        if job.limits.speed_factor != saved.speed_factor:
            lines.append(Command.call("M220", S=100 * saved.speed_factor))
        for tool, part in enumerate(self._machine.all_tools):
            index = list(self._machine.extruders).index(part.extruder) if part.extruder else None
            if index is not None and job.filament.flows[index] != saved.flows[index]:
                lines.append(Command.call("M221", T=tool, S=100 * saved.flows[index]))
        if command.flag("MOVE"):
            place = dict(zip("XYZ", saved.program_mm, strict=True))
            speed = _lettered(command, {"F": ("MOVE_SPEED", 60)})
            lines += ["G90", Command.call("G1", **place, **speed)]
        self._become(*lines, *saved.modes)

    @in_program("SET_GCODE_OFFSET")
    def _shift(self, command: Command, _: Reply) -> None:
        steps = offset_steps(command, self._babysteps_mm)
        job = self._job
        for slot, (name, mm) in enumerate(steps.items()):
            self._babysteps_mm[name] += mm
            job.modes.keep_offset(slot, mm)
            homed = slot not in job.locked_axes
            if mm and homed and not job.plan.shift(slot, mm):
                job.modes.shift_zero(slot, mm)  # at a limit, where the next move may lead away

    # -- heaters, fans, tools ---------------------------------------------------------------------

    @command(
        "SET_HEATER_TEMPERATURE",
        Subject.HEATERS,
        When.PLANNED,
        "Sets the temperature of a heater by its name. Without TARGET it switches the heater off.",
        text("HEATER", "the name of the heater"),
        number("TARGET", "the temperature", "°C", default=0),
    )
    def _heat(self, command: Command, reply: Reply) -> None:
        driven = self._stand_ins.named(HEATERS, command.string("HEATER")) is None
        if not driven and not command.value("TARGET"):
            reply.note(command.code, without_effect(command.code, _NOT_DRIVEN))
            return
        self._become(*self.numbered(command))

    @command(
        "TURN_OFF_HEATERS",
        Subject.HEATERS,
        When.PLANNED,
        "Switches all heaters off.",
    )
    def _all_off(self, command: Command, _: Reply) -> None:
        self._become(*self.numbered(command))

    @command(
        "PID_CALIBRATE",
        Subject.HEATERS,
        When.PLANNED,
        "Tunes a heater by its name, as M303 with U1.",
        text("HEATER", "the name of the heater"),
        number("TARGET", "the temperature", "°C"),
    )
    def _tune(self, command: Command, _: Reply) -> None:
        name = heater_named(self._machine, command, "HEATER")
        found = number_of(self._machine, name)
        if found is None:
            raise CommandError.of("command.value", axis="HEATER", value=name, limit=_TUNED)
        self._become(Command.call("M303", H=found, S=command.value("TARGET"), U=1))

    def _heating(self, name: str, celsius: float) -> Command:
        """The numbered command that sets a heater."""
        kind = self._machine.heaters[name].kind
        if kind == "hotend":
            index = number_of(self._machine, name) or 0
        else:
            same = [n for n, heater in self._machine.heaters.items() if heater.kind == kind]
            index = same.index(name)
        code, letter = _SETS[kind]
        return Command.call(code, **{letter: index}, S=celsius)

    @command(
        "SET_FAN_SPEED",
        Subject.OUTPUTS,
        When.PLANNED,
        "Sets the speed of a fan by its name, as M106.",
        text("FAN", "the name of the fan"),
        number("SPEED", "the speed", default=0, low=0, high=1, clamped=True),
    )
    def _fan(self, command: Command, reply: Reply) -> None:
        if (state := self._stand_ins.named(FANS, command.string("FAN"))) is not None:
            state["speed"] = command.value("SPEED")
            reply.note(command.code, without_effect(command.code, _NOT_DRIVEN))
            return
        self._become(*self.numbered(command))

    def numbered(self, command: Command) -> list[Command]:
        """The numbered commands that set the heaters or the fan of a command of `TRANSLATED`; any
        other command is itself. Raises CommandError."""
        translated = TRANSLATED.get(command.code)
        return [command] if translated is None else translated(self, command)

    def heated(self, command: Command) -> list[Command]:
        """SET_HEATER_TEMPERATURE as a numbered command. Raises CommandError."""
        name = heater_named(self._machine, command, "HEATER")
        return [self._heating(name, command.value("TARGET"))]

    def off(self, _: Command) -> list[Command]:
        """TURN_OFF_HEATERS as numbered commands."""
        return [self._heating(name, 0) for name in self._machine.heaters]

    def blown(self, command: Command) -> list[Command]:
        """SET_FAN_SPEED as a numbered command. Raises CommandError."""
        fans = self._machine.fans
        named = {
            fan_object(self._machine, name).removeprefix("fan_generic "): name
            for name, fan in fans.items()
            if fan.commanded
        }
        index = fans[_one_of(command.string("FAN"), "FAN", named)].number
        return [Command.call("M106", P=index, S=_FULL_FAN * command.value("SPEED"))]

    @command(
        "ACTIVATE_EXTRUDER",
        Subject.FILAMENT,
        When.PLANNED,
        "Selects the tool of an extruder by its name: extruder is T0, extruder1 is T1.",
        text("EXTRUDER", "the name of the extruder"),
    )
    def _tool(self, command: Command, _: Reply) -> None:
        tools = range(len(self._machine.all_tools))
        named = {extruder_object(tool): str(tool) for tool in tools}
        self._become(f"T{_one_of(command.string('EXTRUDER'), 'EXTRUDER', named)}")

    @command(
        "SET_RETRACTION",
        Subject.FILAMENT,
        When.PLANNED,
        "Sets how G10 and G11 retract, as M207 and M208; speeds in mm/s.",
        number("RETRACT_LENGTH", "the length", "mm", 0),
        number("RETRACT_SPEED", "the speed", "mm/s", 0, above=True),
        number("UNRETRACT_EXTRA_LENGTH", "the extra length of G11", "mm"),
        number("UNRETRACT_SPEED", "the speed of G11", "mm/s", 0),
    )
    def _retraction(self, command: Command, _: Reply) -> None:
        into = _lettered(command, {"S": ("RETRACT_LENGTH", 1), "F": ("RETRACT_SPEED", 60)})
        out = _lettered(command, {"S": ("UNRETRACT_EXTRA_LENGTH", 1), "F": ("UNRETRACT_SPEED", 60)})
        calls = [Command.call(code, **words) for code, words in (("M207", into), ("M208", out))]
        self._become(*(call for call in calls if call.values))

    @command(
        "GET_RETRACTION",
        Subject.FILAMENT,
        When.PLANNED,
        "Reports how G10 and G11 retract; speeds in mm/s.",
    )
    def _report_retraction(self, _: Command, reply: Reply) -> None:
        now = RetractionStatus.of(self._job)
        reply.say(
            f"RETRACT_LENGTH={now.length_mm:.5f} RETRACT_SPEED={now.speed_mm_s:.5f}"
            f" UNRETRACT_EXTRA_LENGTH={now.extra_mm:.5f} UNRETRACT_SPEED={now.return_mm_s:.5f}"
        )

    # -- reports and settings ---------------------------------------------------------------------

    @command(
        "QUERY_ENDSTOPS",
        Subject.MOTORS,
        When.PLANNED,
        "Reports which endstops are triggered, as M119.",
    )
    def _endstops(self, _: Command, __: Reply) -> None:
        self._become("M119")

    @command(
        "SAVE_CONFIG",
        Subject.SETTINGS,
        When.PLANNED,
        "Stores the settings, as M500.",
    )
    def _store(self, _: Command, __: Reply) -> None:
        self._become("M500")


TRANSLATED: Mapping[str, Callable[[KlipperCommands, Command], list[Command]]] = {
    "SET_HEATER_TEMPERATURE": KlipperCommands.heated,
    "TURN_OFF_HEATERS": KlipperCommands.off,
    "SET_FAN_SPEED": KlipperCommands.blown,
}
"""Commands that set heaters and fans by their names, as numbered commands."""


def offset_steps(command: Command, done_mm: Mapping[str, float]) -> dict[str, float]:
    """SET_GCODE_OFFSET: the babystep of X, Y and Z, mm by axis, that leads from `done_mm` to the
    new offset. Raises CommandError."""
    found: dict[str, float] = {}
    for name in "xyz":
        by = command.value(f"{name.upper()}_ADJUST", 0.0)
        if command.has(name.upper()):
            by = command.value(name.upper()) - done_mm[name]
        found[name] = by
    return found


def heater_named(machine: MachineConfig, command: Command, key: str) -> str:
    """The heater with this Klipper name. Raises CommandError."""
    kind = "heater_generic "
    named = {heater_object(machine, name).removeprefix(kind): name for name in machine.heaters}
    return _one_of(command.string(key).removeprefix(kind), key, named)


def _one_of(written: str, key: str, named: Mapping[str, str]) -> str:
    """The value of a name, in any case. Raises CommandError."""
    name = found_name(named, written)
    if name is None:
        limit = ", ".join(named) or "none on this machine"
        raise CommandError.of("command.value", axis=key, value=written or "missing", limit=limit)
    return named[name]


def _lettered(command: Command, letters: Mapping[str, tuple[str, float]]) -> dict[str, float]:
    """The words of a numbered command, from KEY=VALUE parameters; each key has a letter and a
    factor."""
    return {
        letter: factor * command.value(key)
        for letter, (key, factor) in letters.items()
        if command.has(key)
    }
