"""M500 to M504: settings as commands that bring them back."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from passo.console.options import OptionCommands
from passo.errors import CommandError
from passo.job.settings import Store
from passo.printer.waits import Handler, Reply, Silence, Still, Wait
from passo.printer.words import Command, numeral

if TYPE_CHECKING:
    from passo.printer.printer import Printer


class SettingsCommands:
    """The settings of one printer; `store` keeps them, None: nothing does."""

    def __init__(self, printer: Printer, store: Store | None, options: OptionCommands) -> None:
        self._printer, self._store, self._options = printer, store, options
        self._defaults = list(self.lines())
        self.planned: dict[str, Handler] = {
            "M500": self._save,
            "M501": self._load,
            "M502": self._reset,
            "M503": self._report,
            "M504": self._check,
        }

    def groups(self) -> Iterator[tuple[str, list[str]]]:
        """Headings, each with the commands that bring its settings back."""
        motion, heat, job = self._printer.motion, self._printer.heat, self._printer.job
        yield "Steps per unit", motion.scale_lines()
        yield "Maximum feedrates (units/s)", motion.axis_limit_lines("speed")
        yield "Maximum acceleration (units/s2)", motion.axis_limit_lines("accel")
        yield "Acceleration (units/s2)", [motion.acceleration_line()]
        yield "Corners", motion.junction_lines()
        yield "Speed of the path (units/s), share of cruise", [motion.velocity_line()]
        yield "Home offset", [motion.home_offset_line()]
        if job.tool_offsets:
            yield "Tool offsets", list(motion.tool_offset_lines())
        controls = self._printer.controls
        yield "Heater sensors", list(controls.sensor_lines())
        yield "Heater PID", list(controls.gain_lines())
        yield "Heater PID's bounds", list(controls.drive_lines())
        models = list(controls.model_lines())
        if models:
            yield "Heater models", models
        yield "Material presets", list(self._printer.commands.presets.lines())
        if self._printer.machine.extruders:
            yield "Filament", list(motion.filament_lines())
            yield "Firmware retraction", list(motion.retraction_lines())
            yield "Filament change", list(motion.change_lines())
        if self._printer.drivers.states:
            yield "Motor drivers", list(self._printer.driver_commands.setting_lines())
        idle = f"M84 S{numeral(self._printer.motors.idle_s)}"
        yield "Idle times", [idle, self._printer.person.kill_line()]
        yield "Endstops", [self._printer.endstops.stop_line()]
        yield "Cold extrusion", list(heat.cold_lines())

    def lines(self) -> Iterator[str]:
        """All settings as commands."""
        for _, commands in self.groups():
            yield from commands

    def restore(self, lines: list[str]) -> None:
        """Carries out stored commands. Whoever calls has the turn, and the machine stands."""
        for line in lines:
            self._printer.take_setting(line, Silence())

    def load_at_start(self) -> None:
        """Takes the stored settings; what must not be used is told, and the defaults stay."""
        try:
            stored = self._store.load() if self._store else None
        except CommandError as error:
            self._printer.tell(f"echo:{error}")
            return
        if stored is not None:
            self.restore(stored)

    def _needed(self) -> Store:
        if self._store is None:
            raise CommandError.of("settings.nowhere")
        return self._store

    def store(self) -> int:
        """Stores the settings; returns their checksum. Raises CommandError."""
        return self._needed().save(list(self.lines()))

    def _save(self, _: Command, reply: Reply) -> Wait | None:
        lines = list(self.lines())
        crc = self.store()
        size = sum(len(line) + 1 for line in lines)
        reply.say(f"echo:Settings Stored ({size} bytes; crc {crc})")
        return None

    def _load(self, _: Command, reply: Reply) -> Wait | None:
        self._printer.motion.require_scales("M501")
        stored = self._needed().load()
        if stored is None:
            raise CommandError.of("settings.none")
        told = f"echo:Stored settings retrieved ({len(stored)} commands)"
        return Still(lambda: self._take("M501", stored, reply, told))

    def _reset(self, _: Command, reply: Reply) -> Wait | None:
        self._printer.motion.require_scales("M502")
        told = "echo:Factory Settings Loaded"
        return Still(lambda: self._take("M502", self._defaults, reply, told))

    def _take(self, code: str, lines: list[str], reply: Reply, told: str) -> None:
        self._printer.motion.require_scales(code)  # a pause may have come meanwhile
        self.restore(lines)
        reply.say(told)

    def _report(self, command: Command, reply: Reply) -> Wait | None:
        headings = command.words().get("S", 1) != 0
        for heading, lines in self.groups():
            if headings:
                reply.say(f"; {heading}")
            for line in lines:
                reply.say(line)
        for line in self._options.pending_lines():
            reply.say(line)
        return None

    def _check(self, _: Command, reply: Reply) -> Wait | None:
        stored = self._needed().load()
        if stored is None:
            raise CommandError.of("settings.none")
        reply.say(f"echo:Stored settings are sound ({len(stored)} commands)")
        return None
