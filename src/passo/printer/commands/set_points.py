"""M104 to M191, M116, M145, G10 P, TEMPERATURE_WAIT: temperatures that a program sets and waits
for."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING, Protocol

from passo import _core
from passo.config.heater_numbers import heater_of
from passo.config.klipper_names import temperature_objects
from passo.config.part_names import found_name
from passo.errors import CommandError
from passo.gcode.command import Command
from passo.gcode.parameters import AT_ONCE, ignored, integer, number, text
from passo.gcode.registry import Subject, When, command, in_program
from passo.printer.commands.klipper_commands import heater_named
from passo.printer.commands.material_presets import Presets
from passo.printer.wait_requests import Reply, Wait, WaitForReading, WaitForTemperatures

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig

_KINDS = {"T": "hotend", "P": "hotend", "B": "bed", "C": "chamber"}


class Heat(Protocol):
    """The destination of temperature targets."""

    def set_target(self, heater: str, celsius: float, *, at_once: bool = False) -> None:
        """Sets a heater's target when the moves so far are done, or at once; 0 is off."""


class NoHeat:
    """A plan without heaters: temperatures count as reached."""

    def set_target(self, heater: str, celsius: float, *, at_once: bool = False) -> None:
        """Ignores the target."""


class SetPoints:
    """The temperatures of one job; `presets` has those of materials."""

    def __init__(self, machine: MachineConfig, job: _core.Job, heat: Heat) -> None:
        self._machine, self._job, self._heat = machine, job, heat
        self.presets = Presets(machine)
        self.targets_c: dict[str, float] = {}  # the last commanded targets; 0 is off
        self._tool = 0
        self._tool_c: dict[int, tuple[float | None, float | None]] = {}  # active, standby

    def heater(self, kind: str, number: int | None = None) -> str:
        """The heater of a kind: a hotend by the number of its tool (default: the active tool),
        other heaters by their own number. Raises CommandError if there is none."""
        index = number if number is not None else self._job.tool if kind == "hotend" else 0
        found = heater_of(self._machine, kind, index)
        if found is None:
            there = sum(heater.kind == kind for heater in self._machine.heaters.values())
            raise CommandError.of("heat.unknown", axis=kind, value=index, limit=there)
        return found

    def _exists(self, kind: str, words: dict[str, float]) -> bool:
        """Whether the command must be executed: the machine has a heater of this kind, or the
        command has a number, which is checked later. Otherwise it is ignored."""
        there = any(heater.kind == kind for heater in self._machine.heaters.values())
        return there or _number(words) is not None

    def _heat_to(self, name: str, target: float | None, *, at_once: bool = False) -> None:
        """Sets a target; None switches the heater off. A target outside the safe range switches it
        off at once and raises CommandError."""
        heater = self._machine.heaters[name]
        self.targets_c[name] = max(target or 0.0, 0.0)
        if target is None or target <= 0:
            self._heat.set_target(name, 0.0, at_once=at_once)
        elif heater.min_c <= target <= heater.max_c:
            self._heat.set_target(name, target, at_once=at_once)
        else:
            self._heat.set_target(name, 0.0, at_once=True)
            self._heat.set_target(name, 0.0)  # a queued target must not switch it on again
            limit = f"{heater.min_c:g} to {heater.max_c:g}"
            raise CommandError.of("heat.unsafe-target", axis=name, value=target, limit=limit)

    def _celsius(self, words: dict[str, float], kind: str) -> float | None:
        """The temperature that a command gives: by material I of M145, S or R. Raises
        CommandError."""
        if "I" in words and kind in ("hotend", "bed"):
            return self.presets.celsius(words["I"], kind)
        return words.get("S", words.get("R"))

    # -- set --------------------------------------------------------------------------------------

    @command(
        "M104",
        Subject.HEATERS,
        When.PLANNED,
        "Sets the temperature of a hotend, by S or by a material I of M145. Without them the hotend"
        " is off. F: at once.",
        number("S", "the temperature; 0 or nan: off", "°C", nan=True),
        integer("I", "a material of M145", 0, 2),
        integer("T P", "the tool, by default the one in use"),
        AT_ONCE,
        forced=True,
    )
    def _set_hotend(self, command: Command, _: Reply) -> None:
        self._set(command, "hotend")

    @command(
        "M140",
        Subject.HEATERS,
        When.PLANNED,
        "Sets the temperature of the bed, by S or by a material I of M145. F: at once.",
        number("S", "the temperature; 0 or nan: off", "°C", nan=True),
        integer("I", "a material of M145", 0, 2),
        integer("P", "the number of the bed"),
        AT_ONCE,
        ignored("T"),
        forced=True,
    )
    def _set_bed(self, command: Command, _: Reply) -> None:
        self._set(command, "bed")

    @command(
        "M141",
        Subject.HEATERS,
        When.PLANNED,
        "Sets the temperature of the chamber. F: at once.",
        number("S", "the temperature; 0 or nan: off", "°C", nan=True),
        integer("P", "the number of the chamber"),
        AT_ONCE,
        ignored("T"),
        forced=True,
    )
    def _set_chamber(self, command: Command, _: Reply) -> None:
        self._set(command, "chamber")

    def _set(self, command: Command, kind: str) -> None:
        words = command.words()
        if self._exists(kind, words):
            name = self.heater(kind, _number(words))
            at_once = command.has("F")
            self._heat_to(name, self._celsius(words, kind), at_once=at_once)

    # -- wait -------------------------------------------------------------------------------------

    @command(
        "M109",
        Subject.HEATERS,
        When.EXCLUSIVE,
        "Sets the temperature of a hotend, by S, R or a material I of M145, and waits for it. R"
        " also waits while it cools.",
        number("S", "the temperature; 0 or nan: off", "°C", nan=True),
        number("R", "as S, and it also waits while the heater cools", "°C"),
        integer("I", "a material of M145", 0, 2),
        integer("T P", "the tool, by default the one in use"),
        ignored("F"),
    )
    def _reach_hotend(self, command: Command, _: Reply) -> Wait | None:
        return self._reach(command, "hotend")

    @command(
        "M190",
        Subject.HEATERS,
        When.EXCLUSIVE,
        "Sets the temperature of the bed, by S, R or a material I of M145, and waits for it. R also"
        " waits while it cools.",
        number("S", "the temperature; 0 or nan: off", "°C", nan=True),
        number("R", "as S, and it also waits while the heater cools", "°C"),
        integer("I", "a material of M145", 0, 2),
        integer("P", "the number of the bed"),
        ignored("F T"),
    )
    def _reach_bed(self, command: Command, _: Reply) -> Wait | None:
        return self._reach(command, "bed")

    @command(
        "M191",
        Subject.HEATERS,
        When.EXCLUSIVE,
        "Sets the temperature of the chamber, and waits for it. R also waits while it cools."
        " Without a chamber heater it waits until the sensor with the letter C is so warm.",
        number("S", "the temperature; 0 or nan: off", "°C", nan=True),
        number("R", "as S, and it also waits while the heater cools", "°C"),
        integer("P", "the number of the chamber"),
        ignored("F T"),
    )
    def _reach_chamber(self, command: Command, _: Reply) -> Wait | None:
        return self._reach(command, "chamber")

    def _reach(self, command: Command, kind: str) -> Wait | None:
        words = command.words()
        if not self._exists(kind, words):
            return self._soak(words) if kind == "chamber" else None
        name = self.heater(kind, _number(words))
        target = self._celsius(words, kind)
        if target is not None:
            self._heat_to(name, target)
        return WaitForTemperatures((name,), cooling="R" in words)

    def _soak(self, words: dict[str, float]) -> Wait | None:
        """M191 of a machine without a chamber heater: waits until the sensor of the chamber, whose
        letter is C, is as warm as this."""
        sensors = self._machine.sensors
        chamber = next((name for name, one in sensors.items() if one.letter == "C"), None)
        target = self._celsius(words, "chamber")
        if chamber is None or target is None or target <= 0:
            return None
        return WaitForReading(chamber, target, inf)

    @command(
        "M116",
        Subject.HEATERS,
        When.EXCLUSIVE,
        "Waits until these heaters have their temperatures: hotends (T or P), bed, chamber. Without"
        " letters it waits for all.",
        integer("T P", "a tool, for its hotend", alone=True, repeats=True),
        integer("B", "a bed", alone=True, repeats=True),
        integer("C", "a chamber", alone=True, repeats=True),
    )
    def _reach_all(self, command: Command, _: Reply) -> Wait | None:
        names = [
            self.heater(_KINDS[letter], int(number or 0))
            for letter, number, _ in _core.split_text(command.text)
            if letter in _KINDS
        ]
        return WaitForTemperatures(tuple(names or self._machine.heaters), cooling=True)

    # -- materials and tools ----------------------------------------------------------------------

    @command(
        "M145",
        Subject.HEATERS,
        When.IMMEDIATE,
        "Sets hotend (H), bed (B) and fan (F) of material S, 0 to 2, for I of M104, M109, M140 and"
        " M190. Without S it reports all materials.",
        integer("S", "the material", 0, 2),
        number("H", "the temperature of the hotend", "°C", 0, clamped=True),
        number("B", "the temperature of the bed", "°C", 0, clamped=True),
        number("F", "the speed of the fan", low=0, high=255, clamped=True),
    )
    def _preset(self, command: Command, reply: Reply) -> None:
        words = command.words()
        if note := self.presets.set(words):
            reply.note("M145", note, again=True)
        for line in () if "S" in words else self.presets.lines():
            reply.say(line)

    @command(
        "TEMPERATURE_WAIT",
        Subject.HEATERS,
        When.EXCLUSIVE,
        "Waits until the temperature of a heater or a sensor is within these limits. It does not"
        " wait for a heater that stays below them.",
        text("SENSOR", "the name of the heater or the sensor"),
        number("MINIMUM", "the lowest temperature", "°C"),
        number("MAXIMUM", "the highest temperature", "°C"),
    )
    def _await(self, command: Command, _: Reply) -> Wait | None:
        low, high = command.value("MINIMUM", -inf), command.value("MAXIMUM", inf)
        sensors = temperature_objects(self._machine)
        shown = found_name(sensors, command.string("SENSOR"))
        if shown is not None:
            return WaitForReading(sensors[shown], low, high)
        name = heater_named(self._machine, command, "SENSOR")
        target = self.targets_c.get(name, 0.0)
        if low == -inf and target <= high < inf:
            return WaitForReading(name, low, high)
        if target <= 0 or not low <= target <= high:
            return None
        return WaitForReading(name, low, high, heats=True)

    @in_program("G10")
    def _tool_temperatures(self, command: Command, _: Reply) -> None:
        """G10 P: the active (S) and the standby (R) temperature of a tool. The active tool takes S
        at once, any other tool takes R."""
        tool = command.integer("P", self._job.tool)
        work, standby = self._tool_c.get(tool, (None, None))
        work, standby = command.value("S", work), command.value("R", standby)
        self._tool_c[tool] = (work, standby)
        at_once = work if tool == self._job.tool or standby is None else standby
        self._heat_tool(tool, at_once)

    def _heat_tool(self, tool: int, celsius: float | None) -> None:
        if celsius is not None and self._exists("hotend", {}):
            self._heat_to(self.heater("hotend", tool), celsius)

    def take_tool_temperatures(self, other: SetPoints) -> None:
        """Copies the G10 temperatures of another job of the same machine; heaters stay as they
        are."""
        self._tool_c |= other._tool_c

    def follow_tool(self) -> None:
        """Call this when the active tool has changed without a command."""
        self._tool = self._job.tool

    def tool_changed(self, tool: int) -> None:
        """Sets the old tool to its standby temperature, and the new tool to its active
        temperature."""
        before, self._tool = self._tool, tool
        standby, work = (self._tool_c.get(t, (None, None))[i] for t, i in ((before, 1), (tool, 0)))
        if tool != before:
            self._heat_tool(before, standby)
            self._heat_tool(tool, work)  # the new tool last, because both may share a hotend


def _number(words: dict[str, float]) -> int | None:
    number = words.get("T", words.get("P"))
    return None if number is None else int(number)
