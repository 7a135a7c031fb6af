"""Commands for the motors' drivers: currents, modes, status."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from math import floor
from typing import TYPE_CHECKING

from passo.board.drivers import DriverState
from passo.board.trinamic import DriverSettings, speed_of, threshold_of
from passo.config.trinamic import CHIPS
from passo.errors import CommandError
from passo.gcode.command import Command, numeral
from passo.gcode.parameters import TOOL, axes, integer, refused
from passo.gcode.registry import Kind, Subject, When, command
from passo.printer.commands.driver_registers import change
from passo.printer.wait_requests import Reply, Wait
from passo.printer.watch.driver_report import mode_of, problems_of, status_of

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.printer.commands.motors import Motors
    from passo.printer.watch.driver_status import DriverWatch

_MOTORS = "XYZABCUVWE"  # letters of axes, actuators and extruders


def _check_modes(command: Command, _: object) -> None:
    """M569. Raises CommandError for values of the machine file."""
    if command.words() and not command.has("S"):
        raise CommandError.of("command.fixed", value="steppers")


class DriverCommands:
    """M350, M569, M906, M911 to M913, M917 and the driver lines of M122 and M503 of one printer."""

    def __init__(self, machine: MachineConfig, watch: DriverWatch, motors: Motors) -> None:
        self._machine, self._watch, self._all_motors = machine, watch, motors

    # -- settings ---------------------------------------------------------------------

    @command(
        "M906",
        Subject.MOTORS,
        When.PLANNED,
        "Sets the currents of drivers with registers.",
        axes("X Y Z E", "the current of a motor", "mA", 0, but="I"),
        integer("I", "which motor of the axis", 0),
        TOOL,
        kind=Kind.SERVED,
    )
    def _currents(self, command: Command, reply: Reply) -> Wait | None:
        words = command.words()
        index, tool = words.pop("I", None), words.pop("T", None)
        if not words:
            for motor, state in self._watch.states.items():
                reply.say(f"{motor.upper()} driver current: {state.settings.run_a * 1000:.0f}")
            return None
        wanted = {
            motor: self._with_current(motor, letter, milliampere)
            for letter, milliampere in words.items()
            for motor in self._motors(letter, reply, index, tool)
        }
        return change(self._watch, wanted)

    def _with_current(self, motor: str, letter: str, milliampere: float) -> DriverSettings:
        """The settings with another run current. The hold current keeps its ratio to the run
        current. Raises CommandError if the driver does not support one of them."""
        settings = self._watch.states[motor].settings
        share = settings.hold_a / settings.run_a
        law = CHIPS[settings.chip].currents
        most = floor(law.largest_ma(settings.resistor_ohm) / max(1.0, share))
        least = law.least_ma(settings.resistor_ohm)
        if not least <= milliampere <= most:
            limit = f"{least} to {most} mA"
            raise CommandError.bad_value(letter, milliampere, limit)
        run_a = milliampere / 1000
        return replace(settings, run_a=run_a, hold_a=run_a * share)

    @command(
        "M350",
        Subject.MOTORS,
        When.PLANNED,
        "Reports the microsteps of drivers with registers.",
        refused("ABCDEFGHIJKLMNOPQRSTUVWXYZ", "steppers"),
        kind=Kind.QUIET,
    )
    def _microsteps(self, _: Command, reply: Reply) -> Wait | None:
        """M350 does not change microsteps: they determine the steps per mm, and both are in the
        machine file."""
        for motor, state in self._watch.states.items():
            reply.say(f"{motor.upper()} microsteps: {state.settings.microsteps}")
        return None

    @command(
        "M569",
        Subject.MOTORS,
        When.PLANNED,
        "Reports the modes of drivers with registers. S1 selects stealthChop, S0 spreadCycle.",
        integer("S", "1: stealthChop, 0: spreadCycle", 0, 1),
        axes("X Y Z E", "the motors, by default all", alone=True, but="I"),
        integer("I", "which motor of the axis", 0),
        TOOL,
        kind=Kind.SERVED,
        valid=_check_modes,
    )
    def _modes(self, command: Command, reply: Reply) -> Wait | None:
        """M569. Without S it reports the drivers' settings in the machine file."""
        words = command.words()
        if "S" not in words:
            self._tell_inputs(reply)
            for motor, state in self._watch.states.items():
                reply.say(f"{motor.upper()} driver mode: {mode_of(state)}")
            return None
        letters = [letter for letter in command.letters() if letter not in "SIT"]
        motors = list(self._watch.states)
        if letters:
            which = words.get("I"), words.get("T")
            motors = [m for letter in letters for m in self._motors(letter, reply, *which)]
        wanted: dict[str, DriverSettings] = {}
        for motor in motors:
            threshold = self._stealth_threshold(motor) if words["S"] else None
            settings = self._watch.states[motor].settings
            if CHIPS[settings.chip].mode:
                wanted[motor] = replace(settings, threshold=threshold)
            elif letters:
                reply.say(f"echo:{motor.upper()} has one mode: its {settings.chip} is spreadCycle")
        return change(self._watch, wanted)

    @command(
        "M913",
        Subject.MOTORS,
        When.PLANNED,
        "Sets the speeds below which drivers use stealthChop, as in Marlin.",
        axes("X Y Z E", "the speed of the motor", "units/s", 0, but="I"),
        integer("I", "which motor of the axis", 0),
        TOOL,
        kind=Kind.SERVED,
    )
    def _thresholds(self, command: Command, reply: Reply) -> Wait | None:
        """M913. A motor in spreadCycle keeps its mode."""
        words = command.words()
        index, tool = words.pop("I", None), words.pop("T", None)
        if not words:
            for motor in self._watch.states:
                speed = self._speed(motor)
                below = f"{speed:g} units/s" if speed else "any speed" if speed == 0 else "off"
                reply.say(f"{motor.upper()} stealthChop below: {below}")
            return None
        wanted: dict[str, DriverSettings] = {}
        for letter, speed in words.items():
            for motor in self._motors(letter, reply, index, tool):
                settings = self._watch.states[motor].settings
                if settings.threshold is None:
                    reply.say(f"echo:{motor.upper()} is in spreadCycle: M569 S1 {letter} first")
                    continue
                wanted[motor] = replace(settings, threshold=self._threshold(motor, speed))
        return change(self._watch, wanted)

    @command(
        "M917",
        Subject.MOTORS,
        When.PLANNED,
        "Sets the currents at standstill, as in RepRapFirmware.",
        axes("X Y Z E", "the part of the run current", "%", 0, 100, but="I"),
        integer("I", "which motor of the axis", 0),
        TOOL,
        kind=Kind.SERVED,
    )
    def _hold_currents(self, command: Command, reply: Reply) -> Wait | None:
        words = command.words()
        index, tool = words.pop("I", None), words.pop("T", None)
        if not words:
            for motor, state in self._watch.states.items():
                reply.say(f"{motor.upper()} standstill current: {_percent(state):.0f} %")
            return None
        wanted: dict[str, DriverSettings] = {}
        for letter, percent in words.items():
            for motor in self._motors(letter, reply, index, tool):
                settings = self._watch.states[motor].settings
                law = CHIPS[settings.chip].currents
                if not law.hold:
                    reply.say(f"echo:{motor.upper()} has one current: a {settings.chip}")
                    continue
                least_a = law.least_ma(settings.resistor_ohm) / 1000
                hold_a = max(settings.run_a * percent / 100, least_a)
                wanted[motor] = replace(settings, hold_a=hold_a)
        return change(self._watch, wanted)

    def _threshold(self, motor: str, speed: float) -> int:
        """TPWMTHRS for a speed in units/s; 0 is any speed."""
        stepper, chip = self._machine.steppers[motor], self._watch.states[motor].settings.chip
        steps_s = speed * stepper.steps_per_unit
        return threshold_of(chip, steps_s, stepper.microsteps) if speed else 0

    def _speed(self, motor: str) -> float | None:
        """The speed of the threshold of a motor, units/s; 0 is any speed, None spreadCycle."""
        settings, stepper = self._watch.states[motor].settings, self._machine.steppers[motor]
        if not settings.threshold:
            return settings.threshold
        steps_s = speed_of(settings.chip, settings.threshold, stepper.microsteps)
        return float(f"{steps_s / stepper.steps_per_unit:.5g}")

    def _tell_inputs(self, reply: Reply) -> None:
        """Reports the settings of the drivers' inputs in the machine file."""
        reply.say("Reporting Stepper control")
        for row in self._machine.core_spec()["steppers"]:
            reply.say(
                f" {row['name'].upper()} dir:{'false' if row['invert'] else 'true'}"
                f" pulse(us):{row['pulse_s'] * 1e6:g} delay(us):{row['dir_setup_s'] * 1e6:g}"
            )

    def _stealth_threshold(self, motor: str) -> int:
        """The threshold of the machine file; without one, the driver uses stealthChop at any
        speed."""
        tmc = self._machine.steppers[motor].tmc
        below = (tmc.stealthchop_below_mm_s or tmc.stealthchop_below_deg_s) if tmc else None
        return self._threshold(motor, below or 0.0)

    def _motors(
        self, letter: str, reply: Reply, index: float | None = None, tool: float | None = None
    ) -> Iterable[str]:
        """The motors of a letter that have drivers with registers, or only the one with `index`;
        the index of an extruder is its tool."""
        named = self._all_motors.named(letter)
        if letter == "E" and tool is not None:
            index = tool
        if index is not None:
            named = named[int(index) : int(index) + 1] if index >= 0 else []
        found = [motor for motor in named if motor in self._watch.states]
        if not found:
            reply.say(f"echo:{letter} has no driver that can be set up")
        return found

    @property
    def states(self) -> Mapping[str, DriverState]:
        """The drivers that can be set up, by motor."""
        return self._watch.states

    def setting_lines(self) -> Iterator[str]:
        """M906 and M569 for each driver, by its letter and, if the letter has several motors, its
        index."""
        for words, state in self._words():
            axis, *tool = reversed(words.split())
            where = "".join(f"{word} " for word in tool)
            yield f"M906 {where}{axis}{numeral(state.settings.run_a * 1000)}"
            yield f"M569 {where}S{int(state.settings.threshold is not None)} {axis}"
            motor = state.link.motor
            if state.settings.threshold not in (None, self._stealth_threshold(motor)):
                yield f"M913 {where}{axis}{numeral(self._speed(motor) or 0.0)}"
            tmc = self._machine.steppers[motor].tmc
            given = tmc and (tmc.hold_current_a or tmc.run_current_a) / tmc.run_current_a * 100
            if given is not None and abs(_percent(state) - given) > 0.05:
                yield f"M917 {where}{axis}{numeral(round(_percent(state), 1))}"

    def _words(self) -> Iterator[tuple[str, DriverState]]:
        groups = {letter: self._all_motors.named(letter) for letter in _MOTORS}
        for motor, state in self._watch.states.items():
            letter = min((x for x in groups if motor in groups[x]), key=lambda x: len(groups[x]))
            index = groups[letter].index(motor)
            if letter == "E":
                yield f"T{index} E", state
            else:
                yield f"I{index} {letter}" if len(groups[letter]) > 1 else letter, state

    # -- status -----------------------------------------------------------------------------

    def status_lines(self) -> Iterator[str]:
        """One or more lines for each driver; the status is at most about a second old."""
        for motor, state in self._watch.states.items():
            found = status_of(motor, state)
            line = (
                f"{motor.upper()} {found.chip} {found.run_a:.2f} A running,"
                f" {found.hold_a:.2f} A standing, {found.microsteps} microsteps, {found.mode}"
            )
            if found.temperature_c is not None and found.supply_v is not None:
                line += f", {found.temperature_c:.0f} °C, {found.supply_v:.1f} V"
            yield line
            yield from (f"  {problem}" for problem in problems_of(motor, state))

    @command(
        "M911",
        Subject.MOTORS,
        When.PLANNED,
        "Reports which drivers had a temperature warning.",
        kind=Kind.QUIET,
    )
    def _prewarnings(self, _: Command, reply: Reply) -> Wait | None:
        for motor in self._watch.states:
            hot = motor in self._watch.prewarned
            reply.say(f"{motor.upper()} temperature prewarn triggered: {str(hot).lower()}")
        return None

    @command(
        "M912",
        Subject.MOTORS,
        When.PLANNED,
        "Clears the temperature warnings of drivers.",
        axes("X Y Z E", "the motors, by default all", alone=True),
        kind=Kind.QUIET,
    )
    def _forget_prewarnings(self, command: Command, reply: Reply) -> Wait | None:
        letters = command.letters()
        if not letters:
            self._watch.prewarned.clear()
        for letter in letters:
            self._watch.prewarned.difference_update(self._motors(letter, reply))
        return None


def _percent(state: DriverState) -> float:
    """The current at standstill in percent of the run current."""
    return 100 * state.settings.hold_a / state.settings.run_a
