"""Commands for the registers of motor drivers, in Klipper's words."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from passo.board.trinamic import DriverSettings, threshold_of
from passo.config.findings import did_you_mean
from passo.config.klipper_names import motors_by_name, stepper_object
from passo.config.part_names import found_name
from passo.config.trinamic import CHIPS, Register
from passo.errors import CommandError
from passo.gcode.command import Command
from passo.gcode.parameters import integer, number, text
from passo.gcode.registry import Kind, Subject, When, command
from passo.printer.wait_requests import Reply, Wait, WaitForProcedure

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.printer.watch.driver_status import DriverWatch

_STEPPER = text("STEPPER", "the name of the motor: stepper_x, extruder", required=True)
_THRESHOLDS = ("tpwmthrs", "tcoolthrs", "thigh")


def change(watch: DriverWatch, wanted: Mapping[str, DriverSettings]) -> Wait | None:
    """Waits for the moves so far, writes these settings, and waits until the drivers have them: so
    they have them from this place of the program on."""
    changed = {m: new for m, new in wanted.items() if new != watch.states[m].settings}

    def begin() -> None:
        for motor, settings in changed.items():
            watch.set(motor, settings)

    async def run() -> None:
        begin()
        await watch.settled()

    return WaitForProcedure(run, begin) if changed else None


class DriverRegisterCommands:
    """SET_TMC_CURRENT, SET_TMC_FIELD, INIT_TMC and DUMP_TMC of one printer."""

    def __init__(self, machine: MachineConfig, watch: DriverWatch) -> None:
        self._machine, self._watch = machine, watch

    def _motor(self, command: Command) -> str:
        """The motor of STEPPER. Raises CommandError."""
        named = motors_by_name(self._machine, self._watch.states)
        written = command.string("STEPPER")
        found = found_name(named, written)
        if found is None:
            limit = ", ".join(stepper_object(self._machine, motor) for motor in self._watch.states)
            limit = limit or "a motor whose driver has registers: none here"
            raise CommandError.of("command.value", axis="STEPPER", value=written, limit=limit)
        return named[found]

    @command(
        "SET_TMC_CURRENT",
        Subject.MOTORS,
        When.PLANNED,
        "Sets the currents of a driver with registers; without a current it reports them.",
        _STEPPER,
        number("CURRENT", "the RMS current of the moving motor", "A", 0),
        number("HOLDCURRENT", "the RMS current at standstill", "A", 0),
        kind=Kind.SERVED,
    )
    def _set_current(self, command: Command, reply: Reply) -> Wait | None:
        motor = self._motor(command)
        settings = self._watch.states[motor].settings
        chip, law = settings.chip, CHIPS[settings.chip].currents
        given = {key: command.value(key, None) for key in ("CURRENT", "HOLDCURRENT")}
        if given["HOLDCURRENT"] is not None and not law.hold:
            raise CommandError.of(
                "command.value", axis="HOLDCURRENT", value=f"{given['HOLDCURRENT']:g}",
                limit=f"no such parameter: a {chip} has one current",
            )  # fmt: skip
        ohm = settings.resistor_ohm
        least_a, most_a = law.least_ma(ohm) / 1000, law.largest_ma(ohm) / 1000
        for key, ampere in given.items():
            if ampere is not None and not least_a <= ampere <= most_a:
                raise CommandError.bad_value(key, ampere, f"{least_a:g} to {most_a:g} A")
        run_a, hold_a = given["CURRENT"], given["HOLDCURRENT"]
        if run_a is None and hold_a is None:
            made = settings.currents
            reply.say(f"Run Current: {made.run_a:.2f}A Hold Current: {made.hold_a:.2f}A")
            return None
        run_a = settings.run_a if run_a is None else run_a
        hold_a = min(settings.hold_a, run_a) if hold_a is None else hold_a
        return change(self._watch, {motor: replace(settings, run_a=run_a, hold_a=hold_a)})

    @command(
        "SET_TMC_FIELD",
        Subject.MOTORS,
        When.PLANNED,
        "Sets a field of a driver's registers.",
        _STEPPER,
        text("FIELD", "the name of the field in the data sheet", required=True),
        integer("VALUE", "the value of the field"),
        number("VELOCITY", "the speed of the motor for a threshold", "mm/s", 0),
        kind=Kind.SERVED,
    )
    def _set_field(self, command: Command, _: Reply) -> Wait | None:
        motor, field = self._motor(command), command.string("FIELD").lower()
        settings = self._watch.states[motor].settings
        chip = CHIPS[settings.chip]
        value, speed = command.integer("VALUE", None), command.value("VELOCITY", None)
        if (value is None) == (speed is None):
            raise CommandError.of(
                "command.value", axis="VALUE", value="missing" if value is None else str(value),
                limit="one of VALUE and VELOCITY",
            )  # fmt: skip
        if speed is not None:
            if field not in _THRESHOLDS:
                limit = f"VALUE for {field}: only {', '.join(_THRESHOLDS)} have a speed"
                raise CommandError.bad_value("VELOCITY", speed, limit)
            stepper = self._machine.steppers[motor]
            steps_s = speed * stepper.steps_per_unit
            value = threshold_of(settings.chip, steps_s, stepper.microsteps) if speed else 0
        assert value is not None
        if chip.mode and field in (chip.mode, "tpwmthrs"):
            threshold = _mode(chip.mode, field, value, settings.threshold)
            return change(self._watch, {motor: replace(settings, threshold=threshold)})
        settable = chip.runtime
        if field not in settable:
            owner = chip.owner(field)
            hint = did_you_mean(field, settable)
            limit = f"SET_TMC_CURRENT for {field}" if "current" in owner else (
                f"{owner} of the machine file" if owner else f"a field of a {settings.chip}. {hint}"
            )  # fmt: skip
            raise CommandError.of("command.value", axis="FIELD", value=field, limit=limit)
        least, most = chip.bounds(field)
        if not least <= value <= most:
            raise CommandError.bad_value("VALUE", value, f"{least} to {most} for {field}")
        fields = {**settings.fields, field: value}
        return change(self._watch, {motor: replace(settings, fields=fields)})

    @command(
        "INIT_TMC",
        Subject.MOTORS,
        When.PLANNED,
        "Writes the settings of a driver with registers again, as after its power was off.",
        _STEPPER,
        kind=Kind.SERVED,
    )
    def _initialise(self, command: Command, _: Reply) -> Wait | None:
        motor = self._motor(command)

        async def run() -> None:
            self._watch.initialise(motor)
            await self._watch.settled()

        return WaitForProcedure(run)

    @command(
        "DUMP_TMC",
        Subject.MOTORS,
        When.PLANNED,
        "Reports the registers of a driver: those that Passo writes, and those that it reads.",
        _STEPPER,
        text("REGISTER", "only this register"),
        kind=Kind.SERVED,
    )
    def _dump(self, command: Command, reply: Reply) -> Wait | None:
        motor = self._motor(command)
        registers = CHIPS[self._watch.states[motor].settings.chip].registers
        written = command.string("REGISTER")
        chosen = [found_name(registers, written)] if written else list(registers)
        names = [name for name in chosen if name]
        if not names:
            limit = ", ".join(registers)
            raise CommandError.of("command.value", axis="REGISTER", value=written, limit=limit)

        async def run() -> None:
            read: dict[str, int] = {}
            for name in names:
                if "r" in registers[name].access:
                    self._watch.read(
                        motor, name, lambda value, name=name: read.update({name: value})
                    )
            await self._watch.settled()
            state = self._watch.states[motor]
            if state.failure is not None:
                raise CommandError([state.failure.problem])
            made = state.settings.registers()
            if not written:
                reply.say("========== Write-only registers ==========")
            for name in names:
                if name in made and name not in read:
                    reply.say(_line(registers[name], made[name]))
            if not written:
                reply.say("========== Queried registers ==========")
            for name, value in read.items():
                reply.say(_line(registers[name], value))

        return WaitForProcedure(run)


def _mode(mode: str, field: str, value: int, before: int | None) -> int | None:
    """The threshold of stealthChop after one of its two fields was set; None for spreadCycle."""
    if field == "tpwmthrs":
        return None if before is None else value
    stealth = bool(value) == (mode == "en_pwm_mode")
    return (before or 0) if stealth else None


def _line(register: Register, value: int) -> str:
    """A register as in Klipper: its value, and the fields that are not 0."""
    fields = " ".join(f"{n}={v}" for n, v in register.unpack(value).items() if v)
    return f"{register.name + ':':<11} {value:08x} {fields}".rstrip()
