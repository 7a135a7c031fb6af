"""SET_SERVO: servos by their names."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.servos import servo_output, share_of
from passo.errors import CommandError
from passo.gcode.parameters import number, text
from passo.gcode.registry import Subject, When, command
from passo.printer.commands.lacking import NamedParts
from passo.printer.stand_ins import SERVOS

if TYPE_CHECKING:
    from passo import _core
    from passo.config.machine import MachineConfig
    from passo.config.servos import Servo
    from passo.gcode.command import Command
    from passo.printer.commands.outputs import Outputs
    from passo.printer.skipped_commands import SkippedCommands
    from passo.printer.stand_ins import StandIns
    from passo.printer.wait_requests import Reply

_LACKS = "The machine file has no servo ([servos])."


class Servos:
    """The servos that the program of one job turns. `widths_us` are the last commanded lengths of
    the pulses; 0: no signal."""

    def __init__(
        self,
        machine: MachineConfig,
        job: _core.Job,
        outputs: Outputs,
        stand_ins: StandIns,
        omitted: SkippedCommands,
    ) -> None:
        self._servos, self._outputs = machine.servos, outputs
        self._named = NamedParts(self._servos, _LACKS, SERVOS, job, stand_ins, omitted)
        self.widths_us = {name: _start_us(servo) for name, servo in self._servos.items()}

    def reset(self, *, adopted: bool) -> None:
        """Call this after the boards have started: servos turn to their angle of the start."""
        for name, servo in self._servos.items():
            if adopted or servo.start_deg is not None:
                self.turn(name, _start_us(servo), at_once=True)

    def turn(self, name: str, width_us: float, *, at_once: bool = False) -> None:
        """Sets the length of a servo's pulses when the moves so far are done, or at once."""
        share = share_of(width_us)
        if self._outputs.set_output(servo_output(name), share, at_once=at_once):
            self.widths_us[name] = width_us

    @command(
        "SET_SERVO",
        Subject.OUTPUTS,
        When.PLANNED,
        "Turns a servo to an ANGLE, or sets the WIDTH of its pulses; 0 s switches its signal off.",
        text("SERVO", "the name of the servo"),
        number("ANGLE", "the angle, from 0", "°", 0),
        number("WIDTH", "the length of the pulses", "s", 0, 0.003),
        lacks=_LACKS,
    )
    def _set_servo(self, command: Command, reply: Reply) -> None:
        name = self._named.find(command, "SERVO", reply)
        if name is None:
            return
        servo, width_s = self._servos[name], command.value("WIDTH", None)
        if width_s is None:
            degrees = command.value("ANGLE")
            if degrees > servo.max_deg:
                raise CommandError.bad_value("ANGLE", degrees, f"0 to {servo.max_deg:g}°")
            self.turn(name, servo.width_us(degrees))
            return
        width_us = width_s * 1e6
        if width_us and not servo.min_pulse_us - 0.5 <= width_us <= servo.max_pulse_us + 0.5:
            least, most = servo.min_pulse_us / 1e6, servo.max_pulse_us / 1e6
            raise CommandError.bad_value("WIDTH", width_s, f"0, or {least:g} to {most:g} s")
        self.turn(name, width_us)


def _start_us(servo: Servo) -> float:
    return 0.0 if servo.start_deg is None else servo.width_us(servo.start_deg)
