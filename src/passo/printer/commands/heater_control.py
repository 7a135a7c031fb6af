"""Controllers and sensors of heaters: gains, models, thermistors, limits."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, TypeAlias, TypeVar

from pydantic import BaseModel, ValidationError

from passo import _core
from passo.config.gains import doubt
from passo.config.heat import HeatModel
from passo.config.heater_numbers import KINDS, heater_of, number_of
from passo.config.model_findings import expected
from passo.config.sensor_tables import converter_of, reads_within, sensor_table, step_c
from passo.config.sensors import Thermistor
from passo.errors import CommandError
from passo.gcode.command import Command, numeral
from passo.gcode.parameters import ignored, integer, number
from passo.gcode.registry import Kind, Subject, When, command
from passo.heat.rules import FULL_POWER, Gains
from passo.printer.live_rig import LiveRig
from passo.printer.setup.sensors import sensor_of
from passo.printer.wait_requests import Reply, Wait

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig

Control: TypeAlias = _core.PidControl | _core.OnOffControl | _core.ModelControl | _core.RelayControl
_Table = TypeVar("_Table", bound=BaseModel)

_SENSOR_KEYS = {
    "A": "r25_ohm",
    "B": "beta_k",
    "C": "c_per_k",
    "R": "pullup_ohm",
    "L": "adc_offset_low",
    "O": "adc_offset_high",
}
_MODEL_KEYS = {
    "A": "rise_c",
    "C": "time_constant_s",
    "D": "sensor_lag_s",
    "F": "fan_loss",
    "R": "ambient_c",
}


HEATER = number("H", "the heater; -1 is the bed", default=0, also="E")


def heater_in(command: Command, machine: MachineConfig) -> str:
    """The heater that H (or E) of a command selects. Raises CommandError without such a heater."""
    return _heater(machine, command.integer("H", command.integer("E", 0)))


def _heater(machine: MachineConfig, index: int) -> str:
    """The heater with this H number. Raises CommandError without such a heater."""
    kind = KINDS.get(index, "hotend")
    found = heater_of(machine, kind, max(index, 0))
    if found is None:
        there = sum(heater.kind == kind for heater in machine.heaters.values())
        raise CommandError.of("heat.unknown", axis=kind, value=max(index, 0), limit=there)
    return found


def _check_pid(command: Command, machine: MachineConfig) -> None:
    """M306 on this machine. Raises CommandError."""
    name = heater_in(command, machine)
    if command.words().keys() - {"A", "B", "E", "H"}:
        raise CommandError.of("command.fixed", value=f"heaters.{name}")
    if command.has("A", "B") and machine.heaters[name].control.kind != "pid":
        raise CommandError.of("heat.no-pid", axis=name)


def _check_model(command: Command, machine: MachineConfig) -> None:
    """M307 on this machine. Raises CommandError."""
    name = heater_in(command, machine)
    if machine.heaters[name].control.kind != "model":
        raise CommandError.of("heat.no-model", axis=name)


class ControlCommands:
    """M301 and M304 to M307 of one printer."""

    def __init__(self, rig: LiveRig) -> None:
        self._rig = rig
        self._machine = rig.machine
        # The controllers and models to restore after a tune.
        self._borrowed: dict[str, tuple[Control, _core.HeatModel | None]] = {}
        self.sensors = {name: h.sensor for name, h in self._machine.heaters.items()}

    # -- which heater, and its controller
    # -----------------------------------------------------------

    def number_of(self, name: str) -> int | None:
        """The H number of a heater; None if it has none."""
        return number_of(self._machine, name)

    def _numbered(self, names: Sequence[str]) -> Iterator[tuple[int, str]]:
        """The heaters of these names (default: all) that have a number, with the number."""
        for name in names or self._machine.heaters:
            if (index := self.number_of(name)) is not None:
                yield index, name

    def control(self, name: str) -> Control:
        """The controller of a heater; during a tune, the one that the heater gets back
        afterwards."""
        if name in self._borrowed:
            return self._borrowed[name][0]
        return self._rig.connection.heaters[name].control

    def set_control(self, name: str, control: Control) -> None:
        """Sets the controller at once or, during a tune of the heater, after the tune."""
        if name in self._borrowed:
            model = control.model if isinstance(control, _core.ModelControl) else None
            self._borrowed[name] = control, model or self._borrowed[name][1]
        else:
            self._rig.connection.heaters[name].set_control(control)

    def lent(self, name: str) -> bool:
        """Whether a tune of the heater is in progress."""
        return name in self._borrowed

    def lend(self, name: str) -> None:
        """Call this at the start of a tune: stores the heater's controller and model."""
        heater = self._rig.connection.heaters[name]
        self._borrowed[name] = heater.control, heater.model

    def take_back(self, name: str) -> None:
        """Call this at the end of a tune: restores the heater's controller and model."""
        borrowed = self._borrowed.pop(name, None)
        if borrowed is not None:
            heater = self._rig.connection.heaters[name]
            heater.model = borrowed[1]
            heater.set_control(borrowed[0])

    def step_c(self, name: str, celsius: float) -> float:
        """How much the temperature of a heater changes from one reading of its sensor to the next,
        near this temperature, °C."""
        sensor = self.sensors[name]
        converter = converter_of(sensor)
        if converter == _core.Converter.NONE:
            connection = self._rig.connection.connection_of("heaters", name)
            steps = int(connection.dictionary.number("ADC_MAX", 1023))
        else:
            steps = _core.converter_full(converter)
        return step_c(sensor_table(sensor), celsius, steps)

    # -- gains ------------------------------------------------------------------------------------

    @command(
        "M301",
        Subject.HEATERS,
        When.IMMEDIATE,
        "Sets the PID gains of heater H, in 1/255 of full power as in the machine file; H-1 is"
        " the bed.",
        HEATER,
        number("P I D", "a gain, in 1/255 of full power", low=0),
        ignored("C L"),
        kind=Kind.SERVED,
        valid=heater_in,
    )
    def _gains(self, command: Command, reply: Reply) -> Wait | None:
        return self._set_gains(heater_in(command, self._machine), command.words(), reply)

    @command(
        "M304",
        Subject.HEATERS,
        When.IMMEDIATE,
        "As M301 for the bed.",
        number("P I D", "a gain, in 1/255 of full power", low=0),
        ignored("C L"),
        kind=Kind.SERVED,
    )
    def _bed_gains(self, command: Command, reply: Reply) -> Wait | None:
        return self._set_gains(_heater(self._machine, -1), command.words(), reply)

    def _set_gains(self, name: str, words: dict[str, float], reply: Reply) -> Wait | None:
        given = {k: v for k, v in words.items() if k in "PID"}
        if words.keys() & {"C", "L"}:
            reply.note("M301 C", "M301 adds nothing for extrusion (C, L)")
        if not given:
            for line in self.gain_lines(name):
                reply.say(line)
            return None
        old = self.control(name)
        if not isinstance(old, _core.PidControl):
            raise CommandError.of("heat.no-pid", axis=name)
        gains = Gains(given.get("P", old.kp), given.get("I", old.ki), given.get("D", old.kd))
        self.set_control(name, with_gains(old, gains))
        keys = {f"k{letter.lower()}": value for letter, value in given.items()}
        if asked := doubt(self._machine.heaters[name].kind, keys):
            letter = asked.key[-1].upper()
            value = f"{letter} is {asked.value:g}: {asked.usual}. {asked.hint}".rstrip()
            reply.say(f"echo:The gains are in force, but {value}")
        return None

    def gain_lines(self, *names: str) -> Iterator[str]:
        """M301 for each of these heaters (default: all) that has gains."""
        for index, name in self._numbered(names):
            control = self.control(name)
            if isinstance(control, _core.PidControl):
                p, i, d = map(numeral, (control.kp, control.ki, control.kd))
                yield f"M301 H{index} P{p} I{i} D{d}"

    # -- models -----------------------------------------------------------------------------------

    @command(
        "M307",
        Subject.HEATERS,
        When.IMMEDIATE,
        "Sets the thermal model of heater H: rise in °C, time constant in s, sensor lag in s,"
        " loss by the fan, ambient temperature.",
        HEATER,
        number("A", "the rise at full power", "°C", 0, above=True),
        number("C", "the time constant", "s", 0, above=True),
        number("D", "the lag of the sensor", "s", 0, above=True),
        number("F", "the loss by the fan", low=0),
        number("R", "the temperature of the surroundings", "°C"),
        kind=Kind.SERVED,
        valid=_check_model,
    )
    def _model(self, command: Command, reply: Reply) -> Wait | None:
        words = command.words()
        name = heater_in(command, self._machine)
        old = self.control(name)
        if not isinstance(old, _core.ModelControl):
            raise CommandError.of("heat.no-model", axis=name)
        given = {k: v for k, v in words.items() if k in _MODEL_KEYS}
        if not given:
            for line in self.model_lines(name):
                reply.say(line)
            return None
        held = {key: getattr(old.model, key) for key in _MODEL_KEYS.values()}
        m = _with_words(HeatModel, held, _MODEL_KEYS, given)
        model = _core.HeatModel(
            m.rise_c, m.time_constant_s, m.sensor_lag_s, m.fan_loss, m.ambient_c
        )
        self.set_control(name, _core.ModelControl(model, old.horizon_s))
        return None

    def model_lines(self, *names: str) -> Iterator[str]:
        """M307 for each of these heaters (default: all) that has a model-predictive controller."""
        for index, name in self._numbered(names):
            control = self.control(name)
            if isinstance(control, _core.ModelControl):
                words = (
                    f"{k}{numeral(getattr(control.model, key))}" for k, key in _MODEL_KEYS.items()
                )
                yield f"M307 H{index} {' '.join(words)}"

    # -- sensors and limits -----------------------------------------------------------------------

    @command(
        "M305",
        Subject.HEATERS,
        When.IMMEDIATE,
        "Sets the thermistor of heater H: R25, beta, C, pull-up, offsets.",
        HEATER,
        number("A", "the resistance at 25 °C", "ohm"),
        number("B", "β", "K", 100, 20_000),
        number("C", "C of the Steinhart-Hart equation", "1/K", 0, 1e-5),
        number("R", "the pull-up", "ohm"),
        number("L O", "an offset of the ADC"),
        ignored("T P"),
        kind=Kind.SERVED,
        valid=heater_in,
    )
    def _sensor(self, command: Command, reply: Reply) -> Wait | None:
        words = command.words()
        name = heater_in(command, self._machine)
        sensor = self.sensors[name]
        given = {k: v for k, v in words.items() if k in _SENSOR_KEYS}
        if not isinstance(sensor, Thermistor):
            raise CommandError.of("heat.no-thermistor", axis=name)
        if words.keys() & {"T", "P"}:
            reply.note("M305 T", "M305 sets neither type nor pin; the machine file has them")
        if not given:
            for line in self.sensor_lines(name):
                reply.say(line)
            return None
        new = _with_words(Thermistor, sensor.model_dump(), _SENSOR_KEYS, given)
        config = self._machine.heaters[name].model_copy(update={"sensor": new})
        if not reads_within(sensor_table(new), config.min_c, config.max_c):
            limit = f"{config.min_c:g} to {config.max_c:g}"
            raise CommandError.of("heat.reads-nothing", axis=name, limit=limit)
        self._rig.connection.set_sensor(name, sensor_of(self._machine, name, config))
        self.sensors[name] = new
        return None

    def sensor_lines(self, *names: str) -> Iterator[str]:
        """M305 for each of these heaters (default: all) that has a thermistor."""
        for index, name in self._numbered(names):
            s = self.sensors[name]
            if isinstance(s, Thermistor):
                yield (
                    f"M305 H{index} A{numeral(s.r25_ohm)} B{numeral(s.beta_k)}"
                    f" C{numeral(s.c_per_k)} R{numeral(s.pullup_ohm)} L{numeral(s.adc_offset_low)}"
                    f" O{numeral(s.adc_offset_high)}"
                )

    @command(
        "M306",
        Subject.HEATERS,
        When.IMMEDIATE,
        "Sets the limits of a PID's integral, in 1/255. Without parameters it reports all limits"
        " of the heater.",
        integer("H E", "the heater; -1 is the bed", default=0),
        number(
            "A", "the least output of the integral, in 1/255 of full power", low=0, high=FULL_POWER
        ),
        number("B", "the largest", low=0, high=FULL_POWER),
        kind=Kind.SERVED,
        valid=_check_pid,
    )
    def _limits(self, command: Command, reply: Reply) -> Wait | None:
        words = command.words()
        name = heater_in(command, self._machine)
        given = {k: v for k, v in words.items() if k in "AB"}
        h, old = self._machine.heaters[name], self.control(name)
        if given:
            self._set_drive(name, given)
            return None
        pid = isinstance(old, _core.PidControl)
        drive = f" {_drive(old)}" if pid else ""
        reply.say(
            f"M306 H{self.number_of(name)}{drive} L{h.min_c:g} O{h.max_c:g}"
            f" C{h.max_power * FULL_POWER:g} U{int(pid)} T1"
        )
        return None

    def _set_drive(self, name: str, given: dict[str, float]) -> None:
        old = self.control(name)
        if not isinstance(old, _core.PidControl):
            raise CommandError.of("heat.no-pid", axis=name)
        low = given["A"] / FULL_POWER if "A" in given else old.drive_min
        high = given["B"] / FULL_POWER if "B" in given else old.drive_max
        if low >= high:
            least = f"more than A, {numeral(low * FULL_POWER)}"
            raise CommandError.bad_value("B", high * FULL_POWER, least)
        self.set_control(
            name,
            _core.PidControl(old.kp, old.ki, old.kd, old.filter_s, low, high, old.range_c),
        )

    def drive_lines(self) -> Iterator[str]:
        """M306 for each heater whose controller limits its integral."""
        for index, name in self._numbered(()):
            control = self.control(name)
            if isinstance(control, _core.PidControl):
                yield f"M306 H{index} {_drive(control)}"


def _drive(control: _core.PidControl) -> str:
    low, high = control.drive_min * FULL_POWER, control.drive_max * FULL_POWER
    return f"A{numeral(low)} B{numeral(high)}"


def with_gains(old: _core.PidControl, gains: Gains) -> _core.PidControl:
    """A copy of a controller with other gains."""
    return _core.PidControl(
        gains.kp, gains.ki, gains.kd, old.filter_s, old.drive_min, old.drive_max, old.range_c
    )


def _with_words(
    kind: type[_Table], held: dict[str, object], keys: Mapping[str, str], given: dict[str, float]
) -> _Table:
    """A table of the machine file with values replaced by those of a command, by letter. Raises
    CommandError with the first invalid value."""
    try:
        return kind.model_validate(held | {keys[k]: value for k, value in given.items()})
    except ValidationError as error:
        first = error.errors()[0]
        letter = next(k for k, key in keys.items() if key in first["loc"])
        raise CommandError.bad_value(letter, given[letter], expected(first)) from None
