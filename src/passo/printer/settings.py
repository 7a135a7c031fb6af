"""The settings of a printer as the commands that restore them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

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


class Group(NamedTuple):
    """Settings under a heading, as commands that restore them. Settings of a `temporary` group are
    often changed by files, macros and pages for a while: M500 stores them with the others, but
    their change alone is no reason to ask for it."""

    heading: str
    lines: list[str]
    temporary: bool = False


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
        for group in self.groups():
            yield from group.lines

    def groups(self) -> Iterator[Group]:
        """All settings by heading, as commands that restore them. A part that the machine does not
        have has no heading."""
        motion, filament = self.motion.settings, bool(self.rig.machine.extruders)
        yield from self._motion()
        yield Group("Home offset", [motion.home_offset_line()])
        if self.rig.machine.moves:
            yield Group("Predefined moves", list(self.motion.predefined_commands.setting_lines()))
        if self.rig.job.tools.offsets:
            yield Group("Tool offsets", list(motion.tool_offset_lines()))
        yield from self._levelling()
        yield from self._heat()
        if filament:
            yield Group("Filament", list(motion.filament_lines()), temporary=True)
            yield Group("Firmware retraction", list(motion.retraction_lines()), temporary=True)
            yield Group("Filament change", list(motion.change_lines()))
        if sensors := list(self.sensors.setting_lines()):
            yield Group("Filament sensors", sensors, temporary=True)
        if drivers := list(self.drivers.setting_lines()):
            yield Group("Motor drivers", drivers, temporary=True)
        if stalls := list(self.stalls.setting_lines()):
            yield Group("Stall detection", stalls)
        idle = f"M84 S{numeral(self.outputs.motors.idle_s)}"
        yield Group("Idle times", [idle, self.prompts.kill_line()], temporary=True)
        yield Group("Endstops", [self.endstops.stop_line()], temporary=True)
        yield Group("Cold extrusion", list(self.heat.settings.cold_lines()), temporary=True)

    def _motion(self) -> Iterator[Group]:
        commands = self.rig.commands
        limits, filters, backlash = commands.limits, commands.filters, commands.backlash
        yield Group("Steps per unit", self.motion.settings.scale_lines())
        speeds, accels = limits.axis_lines("M203", "speed"), limits.axis_lines("M201", "accel")
        yield Group("Maximum feedrates (units/s)", speeds, temporary=True)
        yield Group("Maximum acceleration (units/s2)", accels, temporary=True)
        yield Group("Acceleration (units/s2)", [limits.acceleration_line()], temporary=True)
        if corners := limits.junction_lines():
            yield Group("Corners", corners, temporary=True)
        path = "Speed of the path (units/s), share of cruise"
        yield Group(path, [limits.velocity_line()], temporary=True)
        yield Group("Input shapers", filters.shaper_lines())
        yield Group("Limit of jerk (units/s3)", [filters.jerk_line()], temporary=True)
        if self.rig.machine.extruders:
            yield Group("Pressure advance", filters.advance_lines(), temporary=True)
        if backlash.gaps_mm:
            yield Group("Backlash compensation", [backlash.line()])

    def _levelling(self) -> Iterator[Group]:
        levelling = self.levelling
        if self.rig.machine.probe:
            yield Group("Probe and bed levelling", list(levelling.bed.setting_lines()))
        if levelling.twist:
            yield Group("Twist of the axes", list(levelling.twist.setting_lines()))
        if levelling.eddy:
            yield Group("Eddy current probe", list(levelling.eddy.setting_lines()))
        if levelling.delta:
            yield Group("Geometry of the delta", list(levelling.delta.setting_lines()))
        if levelling.z_endstops:
            yield Group("Endstops of the motors of Z", list(levelling.z_endstops.setting_lines()))
        if levelling.skew:
            yield Group("Skew of the axes", list(levelling.skew.setting_lines()))

    def _heat(self) -> Iterator[Group]:
        controls = self.heat.controls
        yield Group("Heater sensors", list(controls.sensor_lines()))
        yield Group("Heater PID", list(controls.gain_lines()))
        yield Group("Heater PID's bounds", list(controls.drive_lines()))
        if models := list(controls.model_lines()):
            yield Group("Heater models", models)
        yield Group("Material presets", list(self.rig.commands.set_points.presets.lines()))
