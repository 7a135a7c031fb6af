"""M280: servos by their numbers, and the servo of the probe."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.errors import CommandError
from passo.gcode.parameters import integer, number
from passo.gcode.registry import Kind, Subject, When, command
from passo.printer.wait_requests import WaitForProcedure

if TYPE_CHECKING:
    from passo.gcode.command import Command
    from passo.motion.probing import Prober
    from passo.printer.live_rig import LiveRig
    from passo.printer.wait_requests import Reply, Wait

_NO_SERVO = "The machine file has neither a servo with a number nor a probe with a servo."
_SHORTEST_US, _LONGEST_US = 500.0, 2500.0  # of the servo of a probe
_PULSES_S = 0.7


class ServoNumbers:
    """M280 of a printer: servos by their numbers. The servo of a probe, which has no signal while
    it rests, has the number 0 if no other servo has it."""

    def __init__(self, rig: LiveRig, prober: Prober | None) -> None:
        self._rig, self._prober = rig, prober
        servos = rig.machine.servos.items()
        self._names = {s.number: name for name, s in servos if s.number is not None}

    @command(
        "M280",
        Subject.OUTPUTS,
        When.EXCLUSIVE,
        "Turns a servo to an angle. P0 is the servo of the probe, unless a servo has this number;"
        " 10 to 160 are commands of a BLTouch. S of 544 or more is the length of the pulses.",
        integer("P", "the number of the servo", 0, default=0),
        number("S", "the angle, or from 544 on the length of the pulses in µs", "°", required=True),
        kind=Kind.SERVED,
        lacks=_NO_SERVO,
    )
    def _turn(self, command: Command, _: Reply) -> Wait | None:
        wanted, given = command.integer("P"), command.value("S")
        name = self._names.get(wanted)
        if name is not None:
            self._turn_named(name, given)
            return None
        prober = self._prober
        if prober is None or prober.carried.servo_pin is None or wanted != 0:
            limit = ", ".join(map(str, self._names)) or "0"
            raise CommandError.bad_value("P", wanted, limit)
        width_us = given if given >= prober.carried.width_us(0) else prober.carried.width_us(given)
        if not _SHORTEST_US <= width_us <= _LONGEST_US:
            raise CommandError.bad_value("S", given, "0 to 180° or 544 to 2500 µs")
        return WaitForProcedure(lambda: prober.pulse(width_us, _PULSES_S))

    def _turn_named(self, name: str, given: float) -> None:
        servo = self._rig.machine.servos[name]
        width_us = given if given >= _SHORTEST_US else servo.width_us(given)
        if not (given >= 0 and servo.min_pulse_us <= width_us <= servo.max_pulse_us):
            pulses = f"{servo.min_pulse_us:g} to {servo.max_pulse_us:g} µs"
            raise CommandError.bad_value("S", given, f"0 to {servo.max_deg:g}° or {pulses}")
        queue = self._rig.queue
        queue.before_moves()
        self._rig.commands.servos.turn(name, width_us)
        queue.after_moves()
