"""Builds the parts that control heaters."""

from __future__ import annotations

from dataclasses import dataclass

from passo.printer.commands.heater_control import ControlCommands
from passo.printer.commands.heater_tuning import TuneCommands
from passo.printer.commands.temperature import HeatCommands
from passo.printer.commands.temperature_report import TemperatureReport
from passo.printer.live_rig import LiveRig
from passo.printer.state import State
from passo.printer.targets import Targets
from passo.printer.watch.sensors import SensorWatch


@dataclass(frozen=True, slots=True)
class Heat:
    """The heat of one printer: `controls` of its heaters, `settings` of cold extrusion, and the
    `report` of temperatures."""

    controls: ControlCommands
    settings: HeatCommands
    report: TemperatureReport
    handlers: list[object]  # the parts that handle commands


def build_heat(rig: LiveRig, state: State, targets: Targets, sensors: SensorWatch) -> Heat:
    """Builds the heat of a connected machine."""
    controls = ControlCommands(rig)
    settings = HeatCommands(rig, controls)
    tunes = TuneCommands(rig, state, targets, controls)
    report = TemperatureReport(rig, state, controls, sensors)
    return Heat(controls, settings, report, [controls, settings, tunes, report])
