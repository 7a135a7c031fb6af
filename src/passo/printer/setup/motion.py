"""Builds the parts that move the machine and find its position."""

from __future__ import annotations

from dataclasses import dataclass

from passo.motion.bed_correction import BedCorrection
from passo.motion.homing import Homer
from passo.motion.lone_motors import LoneMotors
from passo.motion.offsets import Offsets
from passo.motion.predefined_moves import PredefinedMoves
from passo.motion.probing import Prober
from passo.motion.resonance_test import ResonanceTest
from passo.motion.stall_homing import StallDrivers, StallHoming
from passo.motion.triggered_moves import TriggeredMoves
from passo.printer.commands.motor_moves import MotorMoves
from passo.printer.commands.predefined_moves import PredefinedMoveCommands
from passo.printer.commands.resonance import ResonanceCommands
from passo.printer.commands.steps_and_offsets import MotionCommands
from passo.printer.live_rig import LiveRig
from passo.printer.state import State


@dataclass(frozen=True, slots=True)
class Motion:
    """The motion of one printer. `settings` has the steps, limits and offsets that commands change,
    `predefined` the predefined moves, and `predefined_commands` their commands."""

    offsets: Offsets
    triggered: TriggeredMoves
    correction: BedCorrection
    prober: Prober
    lone_motors: LoneMotors
    homer: Homer
    predefined: PredefinedMoves
    settings: MotionCommands
    predefined_commands: PredefinedMoveCommands
    handlers: list[object]  # the parts that handle commands

    def reset(self) -> None:
        """Call this after the boards have restarted."""
        self.triggered.reset()
        self.correction.reset()
        self.prober.restarted()
        self.homer.reset()
        self.offsets.restarted()


def build_motion(rig: LiveRig, state: State, drivers: StallDrivers) -> Motion:
    """Builds the motion of a connected machine."""
    machine = rig.machine
    offsets, triggered = Offsets(machine), TriggeredMoves(rig, state)
    correction = BedCorrection(rig, lambda: bool(state.halted))
    prober = Prober(rig, state, triggered, correction)
    lone_motors = LoneMotors(rig, state, triggered)
    seeks = triggered, correction
    stalls = StallHoming(rig, state, triggered, drivers)
    homer = Homer(rig, state, offsets, rig.problem, *seeks, lone_motors, prober, stalls)
    predefined = PredefinedMoves(rig, state, triggered, rig.problem)
    settings = MotionCommands(rig, offsets, homer)
    predefined_commands = PredefinedMoveCommands(machine, predefined)
    handlers: list[object] = [settings, predefined_commands, MotorMoves(rig, state, *seeks, homer)]
    if machine.accelerometer is not None:
        test = ResonanceTest(rig, state, *seeks, rig.problem)
        handlers.append(ResonanceCommands(rig, state, machine.accelerometer, test))
    return Motion(
        offsets,
        *seeks,
        prober,
        lone_motors,
        homer,
        predefined,
        settings,
        predefined_commands,
        handlers,
    )
