"""Builds the parts that switch motors, heaters, the laser and other outputs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from passo.printer.commands.beeper import Beeper
from passo.printer.commands.motors import Motors
from passo.printer.commands.power_supply import PowerSupply
from passo.printer.laser import Laser
from passo.printer.lights import LightFrames
from passo.printer.live_rig import LiveRig
from passo.printer.power import Power
from passo.printer.state import State
from passo.printer.targets import Targets


@dataclass(frozen=True, slots=True)
class Outputs:
    """The outputs of one printer. `targets` are those of its heaters."""

    power: Power
    laser: Laser
    motors: Motors
    targets: Targets
    power_supply: PowerSupply
    beeper: Beeper
    lights: LightFrames
    handlers: list[object]  # the parts that handle commands


def build_outputs(rig: LiveRig, state: State, progress: Callable[[], float | None]) -> Outputs:
    """Builds the outputs, before the boards are connected. `progress` gives the fraction of the
    print that is done."""
    power, laser = Power(), Laser(rig, state)
    motors, targets = Motors(rig, laser), Targets(rig, power)
    supply = PowerSupply(rig, power, laser, motors, targets)
    beeper = Beeper(rig, state)
    handlers: list[object] = [supply, motors]
    if rig.machine.beeper is not None:
        handlers.append(beeper)
    lights = LightFrames(rig, state, progress)
    return Outputs(power, laser, motors, targets, supply, beeper, lights, handlers)
