"""The parts that are wired to a board, as plain data: enough to configure and drive the board. Pins
are names of the board's dictionary; the prefix `!` inverts a pin, and `^` turns its pull-up on.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, fields, replace
from functools import partial
from typing import Literal, TypeAlias, TypeVar

from passo import _core
from passo.board.trinamic.settings import DriverSettings
from passo.config.i2c_sensors import I2cKind
from passo.config.pin_names import named_on
from passo.resonance.measurement import AccelerometerChip

Control: TypeAlias = _core.PidControl | _core.OnOffControl | _core.ModelControl


@dataclass(frozen=True, slots=True)
class Stepper:
    """A motor driver. `invert` (or `!` before the direction pin) turns the motor around. Two steps
    are at least `apart_ticks` apart, and at least `turning_ticks` where the direction changes."""

    name: str
    step_pin: str
    dir_pin: str
    invert: bool = False
    pulse_ticks: int = 32
    apart_ticks: int = 64
    turning_ticks: int = 64


@dataclass(frozen=True, slots=True)
class Kick:
    """The kickstart of a fan: it runs at `power` for some ticks if it was off, or if its power
    rises by more than `rise`. Both are fractions of full power, 0 to 1."""

    ticks: int
    power: float
    rise: float


@dataclass(frozen=True, slots=True)
class Output:
    """A pin that is switched.

    A `digital` output with `cycle_ticks` 0 is on or off (values 0 and 1). With a cycle, the board's
    software pulses it, and its value is the number of ticks that it is on in each cycle. The
    hardware pulses a `pwm` output, whose value is 0 to PWM_MAX. While an output is on, the host
    must renew it within `max_duration_ticks` (0: never), or the board shuts down. `start` and
    `at_halt` are its values after the start and after a shutdown, as fractions of fully on; only a
    `pwm` output can have others than 0 and 1 there. An output that `blinks` is on for half of each
    cycle, until the board shuts down. `kick` is the kickstart for changes on the
    timeline.
    """

    name: str
    pin: str
    kind: Literal["digital", "pwm"] = "digital"
    cycle_ticks: int = 0
    max_duration_ticks: int = 0
    start: float = 0.0
    at_halt: float = 0.0
    blinks: bool = False
    kick: Kick | None = None


@dataclass(frozen=True, slots=True)
class UartPins:
    """A one-wire UART: the board receives on `rx_pin` and sends on `tx_pin`, often the same."""

    rx_pin: str
    tx_pin: str

    @property
    def pins(self) -> tuple[str, ...]:
        """Each pin once."""
        one = bare(self.rx_pin) == bare(self.tx_pin)
        return (self.rx_pin,) if one else (self.rx_pin, self.tx_pin)


@dataclass(frozen=True, slots=True)
class SpiPins:
    """A device on an SPI bus that other devices may share. It is selected while `cs_pin` is low;
    `mode` is the SPI mode, 0 to 3; `hz` is the frequency of the clock. With `bus`, the board knows
    the other pins by that name; then `cs_pin` may be empty."""

    cs_pin: str
    clock_pin: str
    mosi_pin: str
    miso_pin: str
    mode: int = 3
    hz: int = 100_000
    bus: str = ""

    @property
    def pins(self) -> tuple[str, ...]:
        """All pins that are given."""
        pins = (self.cs_pin, self.clock_pin, self.mosi_pin, self.miso_pin)
        return tuple(pin for pin in pins if pin)


@dataclass(frozen=True, slots=True)
class I2cPins:
    """A device with an `address` on an I2C bus; `hz` is the frequency of the clock. With `bus`, the
    board knows the pins by that name."""

    scl_pin: str
    sda_pin: str
    address: int
    hz: int = 400_000
    bus: str = ""

    @property
    def pins(self) -> tuple[str, ...]:
        """All pins that are given."""
        return tuple(pin for pin in (self.scl_pin, self.sda_pin) if pin)


@dataclass(frozen=True, slots=True)
class Sensor:
    """A temperature sensor on an analog input, or on a converter chip that `pin` selects on the bus
    `spi`; then ratios refer to the full scale of the converter. The board sends the bytes of
    `setup` before the first sample, and those of `clears_faults`, if any, at each fault. `table`
    holds pairs (°C, fraction of the ADC's full scale) by ascending °C; the fraction strictly rises
    or falls. Beyond the ends of the table the sensor is broken: open above the largest fraction and
    shorted below the smallest, or the other way round if not `open_is_high`. Outside `min_ratio` to
    `max_ratio` the board shuts down, unless the host has switched the heater off before. A sensor
    `of_chip` is in the microcontroller; its table is that of the chip that the firmware names.
    """

    name: str
    pin: str
    table: tuple[tuple[float, float], ...]
    min_ratio: float = 0.0
    max_ratio: float = 1.0
    open_is_high: bool = True
    converter: _core.Converter = _core.Converter.NONE
    spi: SpiPins | None = None
    setup: tuple[bytes, ...] = ()
    clears_faults: bytes = b""
    of_chip: bool = False


@dataclass(frozen=True, slots=True)
class I2cSensor:
    """A chip of this kind that measures the temperature, each `period_s`. `ambient_c` is what it
    measures on a simulated board."""

    name: str
    kind: I2cKind
    wire: I2cPins
    period_s: float = 2.0
    ambient_c: float = 25.0


@dataclass(frozen=True, slots=True)
class Setting:
    """Bytes that the board sends to an SPI device at its start, and again after a lost link."""

    spi: SpiPins
    words: tuple[bytes, ...]


@dataclass(frozen=True, slots=True)
class Accelerometer:
    """An accelerometer; an ADXL345 is on SPI. `axes` has, for X, Y and Z of the machine, the axis
    of the chip (0 to 2) and its sign. `rate_hz` is the number of samples a second; 0: as many as it
    can."""

    chip: AccelerometerChip
    wire: SpiPins | I2cPins
    axes: tuple[tuple[int, int], ...] = ((0, 1), (1, 1), (2, 1))
    rate_hz: int = 0


@dataclass(frozen=True, slots=True)
class Eddy:
    """An LDC1612, which measures the frequency of a coil above the bed, as an endstop `name` that
    triggers at a frequency. `hz` is the clock of the chip, and `divider` divides the frequency of
    the coil. The chip reports a new value on `intb_pin`, if there is one."""

    name: str
    wire: I2cPins
    hz: int = 12_000_000
    divider: int = 2
    intb_pin: str = ""


@dataclass(frozen=True, slots=True)
class Heater:
    """A heating output and its sensor. The outputs `further` switch with `output`. `limits` are its
    protections. The protection against model deviation needs the thermal `model`, unless `control`
    is model-predictive and has its own. `fan` names the output that cools the heater, for the
    model. `arrival` defines when a target is reached.
    """

    name: str
    output: str
    sensor: str
    control: Control
    further: tuple[str, ...] = ()
    limits: _core.ProtectionLimits = field(default_factory=_core.ProtectionLimits)
    model: _core.HeatModel | None = None
    fan: str | None = None
    max_power: float = 1.0
    arrival: _core.Arrival = field(default_factory=_core.Arrival)

    @property
    def outputs(self) -> tuple[str, ...]:
        """All outputs of the heater."""
        return (self.output, *self.further)


@dataclass(frozen=True, slots=True)
class Endstop:
    """A switch on an input pin."""

    name: str
    pin: str


@dataclass(frozen=True, slots=True)
class Input:
    """A digital input that the board reports when it changes. It is active while the pin is high,
    or low if the pin is inverted."""

    name: str
    pin: str


@dataclass(frozen=True, slots=True)
class AnalogInput:
    """An analog input that the board reports every `period_s` seconds. Each of the `ranges` (name,
    from, below: fractions of full scale) is an input that is active while the reading is in it. In
    the simulation, the reading is `rest`."""

    name: str
    pin: str
    ranges: tuple[tuple[str, float, float], ...] = ()
    period_s: float = 0.02
    rest: float = 1.0

    def range_at(self, share: float) -> int:
        """The number of the range of a reading, -1 for none."""
        found = (i for i, (_, low, high) in enumerate(self.ranges) if low <= share < high)
        return next(found, -1)


@dataclass(frozen=True, slots=True)
class Counter:
    """A digital input whose changes the board counts, every `poll_s` seconds. It reports the count
    once a second."""

    name: str
    pin: str
    poll_s: float = 0.0015


_Bus = TypeVar("_Bus", bound="SpiPins | I2cPins")


@dataclass(frozen=True, slots=True)
class Light:
    """A light that the board sends frames to: a chain of `count` LEDs and `size` bytes on a data
    pin with the timing of the WS2812, or a device on a bus. The board sends the bytes of `setup` to
    an I2C device before the first frame."""

    name: str
    wire: str | SpiPins | I2cPins
    size: int
    count: int = 1
    setup: tuple[bytes, ...] = ()


@dataclass(frozen=True, slots=True)
class Driver:
    """The driver chip of the motor `stepper`, set up over UART or SPI. `address` distinguishes the
    drivers on one UART."""

    stepper: str
    wire: UartPins | SpiPins
    settings: DriverSettings
    address: int = 0


@dataclass(frozen=True, slots=True)
class BoardDescription:
    """A board and its wiring. In messages, a stepper or an output has its number in
    `stepper_targets` or `output_targets`; by default, its index in `steppers` or `outputs`.
    `endstops_elsewhere` names the endstops of other boards that stop steppers of this one.

    `clock_hz` is the nominal frequency of the board's clock; `move_count` the number of commands
    that it can hold (a simulated board has as many, a real one reports its own). `survives`: True
    accepts only Passo's firmware, False only other firmware, None both.
    """

    clock_hz: int
    steppers: tuple[Stepper, ...] = ()
    outputs: tuple[Output, ...] = ()
    sensors: tuple[Sensor, ...] = ()
    heaters: tuple[Heater, ...] = ()
    endstops: tuple[Endstop, ...] = ()
    inputs: tuple[Input, ...] = ()
    analog_inputs: tuple[AnalogInput, ...] = ()
    counters: tuple[Counter, ...] = ()
    lights: tuple[Light, ...] = ()
    i2c_sensors: tuple[I2cSensor, ...] = ()
    drivers: tuple[Driver, ...] = ()
    settings: tuple[Setting, ...] = ()
    accelerometers: tuple[Accelerometer, ...] = ()
    eddies: tuple[Eddy, ...] = ()
    move_count: int = 1024
    mcu: str = "atmega2560"
    survives: bool | None = None
    endstops_elsewhere: tuple[str, ...] = ()
    stepper_targets: tuple[int, ...] = ()
    output_targets: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        """Raises ValueError for wiring that no board can have."""
        for part, names in (
            ("stepper", [s.name for s in self.steppers]),
            ("output", [o.name for o in self.outputs]),
            ("sensor", [s.name for s in self.sensors]),
            ("heater", [h.name for h in self.heaters]),
            ("endstop", [e.name for e in self.endstops]),
            ("input", self.input_names),
            ("analog input", [a.name for a in self.analog_inputs]),
            ("counter", [c.name for c in self.counters]),
            ("light", [light.name for light in self.lights]),
            ("sensor on I2C", [s.name for s in self.i2c_sensors]),
        ):
            _unique(f"{part} name", names)
        if not self.stepper_targets:
            object.__setattr__(self, "stepper_targets", tuple(range(len(self.steppers))))
        if not self.output_targets:
            object.__setattr__(self, "output_targets", tuple(range(len(self.outputs))))
        _unique("pin", [bare(pin) for pin in self.pins])
        outputs = {o.name: o for o in self.outputs}
        sensors = {s.name for s in self.sensors}
        for heater in self.heaters:
            if not outputs.keys() >= {*heater.outputs} or heater.sensor not in sensors:
                raise ValueError(f"heater {heater.name}: its output or sensor is not described")
            if heater.fan is not None and heater.fan not in outputs:
                raise ValueError(f"heater {heater.name}: its fan is not described")
            if any(outputs[o].max_duration_ticks <= 0 for o in heater.outputs):
                raise ValueError(f"heater {heater.name}: its output needs a maximum duration")

    @property
    def shown(self) -> tuple[Sensor, ...]:
        """The sensors that no heater uses."""
        used = {heater.sensor for heater in self.heaters}
        return tuple(sensor for sensor in self.sensors if sensor.name not in used)

    @property
    def input_names(self) -> list[str]:
        """The inputs with a level: those of pins, and the ranges of analog inputs."""
        names = [entry.name for entry in self.inputs]
        return names + [name for entry in self.analog_inputs for name, _, _ in entry.ranges]

    @property
    def uarts(self) -> tuple[UartPins, ...]:
        """The drivers' UARTs, each once."""
        return tuple(dict.fromkeys(d.wire for d in self.drivers if isinstance(d.wire, UartPins)))

    @property
    def spi_devices(self) -> tuple[SpiPins, ...]:
        """All devices on SPI buses."""
        wires = (
            *(d.wire for d in self.drivers),
            *(s.spi for s in self.sensors),
            *(s.spi for s in self.settings),
            *(a.wire for a in self.accelerometers),
            *(light.wire for light in self.lights),
        )
        return tuple(wire for wire in wires if isinstance(wire, SpiPins))

    @property
    def i2c_devices(self) -> tuple[I2cPins, ...]:
        """All devices on I2C buses."""
        parts = (*self.accelerometers, *self.lights, *self.i2c_sensors, *self.eddies)
        wires = (part.wire for part in parts)
        return tuple(wire for wire in wires if isinstance(wire, I2cPins))

    @property
    def chains(self) -> tuple[Light, ...]:
        """The lights on data pins."""
        return tuple(light for light in self.lights if isinstance(light.wire, str))

    @property
    def pins(self) -> tuple[str, ...]:
        """All pins in use, as written; a shared pin appears once."""
        return (
            *(pin for s in self.steppers for pin in (s.step_pin, s.dir_pin)),
            *(o.pin for o in self.outputs),
            *(s.pin for s in self.sensors if s.spi is None),
            *(e.pin for e in self.endstops),
            *(i.pin for i in self.inputs),
            *(a.pin for a in self.analog_inputs),
            *(c.pin for c in self.counters),
            *(light.wire for light in self.lights if isinstance(light.wire, str)),
            *(e.intb_pin for e in self.eddies if e.intb_pin),
            *{
                bare(pin): pin
                for wire in (*self.uarts, *self.spi_devices, *self.i2c_devices)
                for pin in wire.pins
            }.values(),
        )


def together(boards: Mapping[str, BoardDescription]) -> BoardDescription:
    """Describes all boards of a machine as one board with the clock of the main board, which is the
    first. Steppers and outputs are in the order of their numbers; pins have the names of their
    boards."""
    main, *others = boards.values()
    if not others:
        return main
    steppers: dict[int, Stepper] = {}
    outputs: dict[int, Output] = {}
    sensors: list[Sensor] = []
    endstops: list[Endstop] = []
    inputs: list[Input] = []
    analog_inputs: list[AnalogInput] = []
    counters: list[Counter] = []
    lights: list[Light] = []
    for name, board in boards.items():
        named = partial(named_on, name)
        for i, s in zip(board.stepper_targets, board.steppers, strict=True):
            steppers[i] = replace(s, step_pin=named(s.step_pin), dir_pin=named(s.dir_pin))
        for i, o in zip(board.output_targets, board.outputs, strict=True):
            outputs[i] = replace(o, pin=named(o.pin))
        sensors += [
            replace(s, pin=named(s.pin), spi=s.spi and _bus_on(name, s.spi)) for s in board.sensors
        ]
        endstops += [replace(e, pin=named(e.pin)) for e in board.endstops]
        inputs += [replace(i, pin=named(i.pin)) for i in board.inputs]
        analog_inputs += [replace(a, pin=named(a.pin)) for a in board.analog_inputs]
        counters += [replace(c, pin=named(c.pin)) for c in board.counters]
        for light in board.lights:
            wire = light.wire
            wire = named(wire) if isinstance(wire, str) else _bus_on(name, wire)
            lights.append(replace(light, wire=wire))
    order = [outputs[i].name for i in sorted(outputs)]
    heaters = (h for board in boards.values() for h in board.heaters)
    return replace(
        main,
        steppers=tuple(steppers[i] for i in sorted(steppers)),
        outputs=tuple(outputs[i] for i in sorted(outputs)),
        sensors=tuple(sensors),
        heaters=tuple(sorted(heaters, key=lambda h: order.index(h.output))),
        endstops=tuple(endstops),
        inputs=tuple(inputs),
        analog_inputs=tuple(analog_inputs),
        counters=tuple(counters),
        lights=tuple(lights),
        i2c_sensors=tuple(sensor for board in boards.values() for sensor in board.i2c_sensors),
        eddies=tuple(eddy for board in boards.values() for eddy in board.eddies),
        endstops_elsewhere=(),
        stepper_targets=(),
        output_targets=(),
    )


def _bus_on(board: str, bus: _Bus) -> _Bus:
    """The pins of the bus with the name of their board."""
    pins = {f.name: getattr(bus, f.name) for f in fields(bus) if f.name.endswith("_pin")}
    return replace(bus, **{key: pin and named_on(board, pin) for key, pin in pins.items()})


def bare(pin: str) -> str:
    """The pin's name without `!`, `^` and `~`."""
    return pin.lstrip("!^~")


def inverted(pin: str) -> bool:
    """Whether the pin has the prefix `!`."""
    return "!" in pin


def _unique(what: str, names: Iterable[str]) -> None:
    seen: set[str] = set()
    for name in names:
        if name in seen:
            raise ValueError(f"{what} {name} is used twice")
        seen.add(name)
