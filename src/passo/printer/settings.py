"""The settings of a printer as the commands that restore them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from passo.gcode.command import numeral
from passo.printer.commands.drivers import DriverCommands
from passo.printer.commands.stalls import StallCommands
from passo.printer.commands.user_prompts import UserPrompts
from passo.printer.inputs.filament_sensors import FilamentSensors
from passo.printer.live_rig import LiveRig
from passo.printer.setup.heat import Heat
from passo.printer.setup.levelling import Levelling
from passo.printer.setup.motion import Motion
from passo.printer.setup.outputs import Outputs
from passo.printer.watch.endstops import EndstopWatch


@dataclass(frozen=True, slots=True)
class Settings:
    """The settings of one printer: values of the machine file, and values that commands have
    changed."""

    rig: LiveRig
    outputs: Outputs
    motion: Motion
    heat: Heat
    levelling: Levelling
    sensors: FilamentSensors
    drivers: DriverCommands
    prompts: UserPrompts
    endstops: EndstopWatch
    stalls: StallCommands

    def lines(self) -> Iterator[str]:
        """All settings as commands."""
        for _, commands in self.groups():
            yield from commands

    def groups(self) -> Iterator[tuple[str, list[str]]]:
        """All settings by heading, as commands that restore them. A part that the machine does not
        have has no heading."""
        motion, filament = self.motion.settings, bool(self.rig.machine.extruders)
        yield from self._motion()
        yield "Home offset", [motion.home_offset_line()]
        if self.rig.machine.moves:
            yield "Predefined moves", list(self.motion.predefined_commands.setting_lines())
        if self.rig.job.tools.offsets:
            yield "Tool offsets", list(motion.tool_offset_lines())
        yield from self._levelling()
        yield from self._heat()
        if filament:
            yield "Filament", list(motion.filament_lines())
            yield "Firmware retraction", list(motion.retraction_lines())
            yield "Filament change", list(motion.change_lines())
        if sensors := list(self.sensors.setting_lines()):
            yield "Filament sensors", sensors
        if drivers := list(self.drivers.setting_lines()):
            yield "Motor drivers", drivers
        if stalls := list(self.stalls.setting_lines()):
            yield "Stall detection", stalls
        idle = f"M84 S{numeral(self.outputs.motors.idle_s)}"
        yield "Idle times", [idle, self.prompts.kill_line()]
        yield "Endstops", [self.endstops.stop_line()]
        yield "Cold extrusion", list(self.heat.settings.cold_lines())

    def _motion(self) -> Iterator[tuple[str, list[str]]]:
        commands = self.rig.commands
        limits, filters, backlash = commands.limits, commands.filters, commands.backlash
        yield "Steps per unit", self.motion.settings.scale_lines()
        yield "Maximum feedrates (units/s)", limits.axis_lines("M203", "speed")
        yield "Maximum acceleration (units/s2)", limits.axis_lines("M201", "accel")
        yield "Acceleration (units/s2)", [limits.acceleration_line()]
        if corners := limits.junction_lines():
            yield "Corners", corners
        yield "Speed of the path (units/s), share of cruise", [limits.velocity_line()]
        yield "Input shapers", filters.shaper_lines()
        yield "Limit of jerk (units/s3)", [filters.jerk_line()]
        if self.rig.machine.extruders:
            yield "Pressure advance", filters.advance_lines()
        if backlash.gaps_mm:
            yield "Backlash compensation", [backlash.line()]

    def _levelling(self) -> Iterator[tuple[str, list[str]]]:
        levelling = self.levelling
        if self.rig.machine.probe:
            yield "Probe and bed levelling", list(levelling.bed.setting_lines())
        if levelling.twist:
            yield "Twist of the axes", list(levelling.twist.setting_lines())
        if levelling.delta:
            yield "Geometry of the delta", list(levelling.delta.setting_lines())
        if levelling.z_endstops:
            yield "Endstops of the motors of Z", list(levelling.z_endstops.setting_lines())
        if levelling.skew:
            yield "Skew of the axes", list(levelling.skew.setting_lines())

    def _heat(self) -> Iterator[tuple[str, list[str]]]:
        controls = self.heat.controls
        yield "Heater sensors", list(controls.sensor_lines())
        yield "Heater PID", list(controls.gain_lines())
        yield "Heater PID's bounds", list(controls.drive_lines())
        if models := list(controls.model_lines()):
            yield "Heater models", models
        yield "Material presets", list(self.rig.commands.set_points.presets.lines())
