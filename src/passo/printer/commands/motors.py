"""Switches motors on and off, and keeps the homing state that depends on it."""

from __future__ import annotations

from collections.abc import Sequence

from passo.config.klipper_names import motors_by_name, stepper_object
from passo.config.part_names import found_name
from passo.errors import CommandError
from passo.gcode.command import Command
from passo.gcode.parameters import axes, ignored, integer, number, text
from passo.gcode.registry import Kind, Subject, When, command
from passo.motion.endstops import axes_lost, named_motors
from passo.motion.rig import Rig
from passo.printer.laser import Laser
from passo.printer.setup.board_outputs import enable_outputs
from passo.printer.wait_requests import Reply, Wait, WaitForMoves

_MAX_S = 1e9


class Motors:
    """The enable pins of one printer's drivers. A move switches all motors on. An axis whose motors
    are switched off is no longer homed."""

    def __init__(self, rig: Rig, laser: Laser) -> None:
        self._rig, self._laser = rig, laser
        self._machine = rig.machine
        self._outputs = enable_outputs(self._machine)
        self.on: set[str] = set()
        self.idle_s = self._machine.idle.motors_off_s
        self.heaters_off_s = self._machine.idle.heaters_off_s

    def all_on(self) -> None:
        """Switches all motors on, before a move."""
        if len(self.on) < len(self._machine.steppers):
            self._set(list(self._machine.steppers), on=True)

    def all_off(self) -> None:
        """Switches all motors off. Call it only at standstill."""
        self._set(list(self._machine.steppers), on=False)

    def forget(self) -> None:
        """Call this when the board restarts, which switches all motors off."""
        self.on.clear()

    def renew(self) -> None:
        """Sends the states of the motors again, because the board may not have received the last
        ones."""
        for name, output in self._outputs.items():
            self._rig.connection.switch(output, self.live(name))

    def _set(self, steppers: Sequence[str], *, on: bool) -> None:
        for name in steppers:
            was_live = self.live(name)
            (self.on.add if on else self.on.discard)(name)
            if name in self._outputs and self.live(name) != was_live:
                self._rig.connection.switch(self._outputs[name], on)
        if not on:
            if not set(steppers) <= set(self.named("E")):
                self._rig.positions.invalidate()
            self._rig.lock(self.axes_lost(steppers))

    def live(self, name: str) -> bool:
        """Whether the enable output of a motor is on. A shared output is on while any of its motors
        is."""
        return any(self._outputs.get(other) == self._outputs.get(name) for other in self.on)

    def axes_lost(self, steppers: Sequence[str]) -> set[str]:
        """The axes with an endstop that are no longer homed when these motors are off."""
        return axes_lost(self._machine, steppers)

    def named(self, text: str) -> list[str]:
        """The motors that a command names by letters of axes, actuators or E; without letters, all
        motors."""
        return named_motors(self._machine, text)

    @command(
        "M17",
        Subject.MOTORS,
        When.PLANNED,
        "Switches motors on. Moves switch them on, too.",
        axes("X Y Z E", "an axis or a motor", alone=True),
        ignored("R S"),
        kind=Kind.QUIET,
    )
    def _switch_on(self, command: Command, _: Reply) -> Wait | None:
        self._set(self.named(command.text), on=True)
        return None

    @command(
        "M18",
        Subject.MOTORS,
        When.EXCLUSIVE,
        "Switches motors off at standstill. S sets the idle time after which all motors go off,"
        " if no heater is on.",
        axes("X Y Z E", "an axis or a motor", alone=True),
        number("S", "the idle time after which all motors go off; 0: never", "s", 0),
    )
    @command(
        "M84",
        Subject.MOTORS,
        When.EXCLUSIVE,
        "As M18.",
        axes("X Y Z E", "an axis or a motor", alone=True),
        number("S", "the idle time after which all motors go off; 0: never", "s", 0),
    )
    def _switch_off(self, command: Command, _: Reply) -> Wait | None:
        if (idle_s := command.value("S", None)) is not None:  # 0 means never
            self.idle_s = idle_s
            return None
        steppers = self.named(command.text)
        self._laser.off()
        return WaitForMoves(lambda: self._set(steppers, on=False))

    @command(
        "SET_STEPPER_ENABLE",
        Subject.MOTORS,
        When.EXCLUSIVE,
        "Switches one motor on or off at standstill. Off, its axis is no longer homed.",
        text("STEPPER", "the name of the motor: stepper_x, extruder", required=True),
        integer("ENABLE", "1: on, 0: off", low=0, high=1, default=1),
    )
    def _switch_one(self, command: Command, _: Reply) -> Wait:
        written, on = command.string("STEPPER"), bool(command.value("ENABLE", 1))
        named = motors_by_name(self._machine, self._machine.steppers)
        found = found_name(named, written)
        if found is None:
            limit = ", ".join(stepper_object(self._machine, one) for one in self._machine.steppers)
            raise CommandError.of("command.value", axis="STEPPER", value=written, limit=limit)
        return WaitForMoves(lambda: self._set([named[found]], on=on))

    @command(
        "SET_IDLE_TIMEOUT",
        Subject.MOTORS,
        When.PLANNED,
        "Sets the idle time after which motors and heaters go off, until the next restart.",
        number("TIMEOUT", "the time", "s", 0, _MAX_S, above=True, required=True),
        kind=Kind.SERVED,
    )
    def _idle_timeout(self, command: Command, _: Reply) -> None:
        self.idle_s = self.heaters_off_s = command.value("TIMEOUT")
