"""What is wired to a board, as plain data: what the host must know to configure and drive it.

Pins are names of the board's dictionary; `!` in front inverts a pin, `^` asks for its pull-up.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Literal, TypeAlias

from passo import _core
from passo.board.trinamic.settings import DriverSettings
from passo.config.pin_names import named_on

Control: TypeAlias = _core.PidControl | _core.OnOffControl | _core.ModelControl


@dataclass(frozen=True, slots=True)
class Stepper:
    """A motor driver. `invert` (or `!` before the direction pin) turns the motor around. Its steps
    are at least `apart_ticks` apart, and `turning_ticks` where it turns."""

    name: str
    step_pin: str
    dir_pin: str
    invert: bool = False
    pulse_ticks: int = 32
    apart_ticks: int = 64
    turning_ticks: int = 64


@dataclass(frozen=True, slots=True)
class Kick:
    """How a fan is started: at `power` for so many ticks, where it stood still or its power is to
    rise by more than `rise`. Both are shares of full power."""

    ticks: int
    power: float
    rise: float


@dataclass(frozen=True, slots=True)
class Output:
    """A pin that is switched.

    `digital` with `cycle_ticks` 0 is on or off (values 0 and 1); with a cycle it is pulsed by the
    board's software, its value being the ticks on of each cycle. `pwm` is pulsed by hardware, its
    value 0 to PWM_MAX. While on, it must be renewed within `max_duration_ticks` (0: never), or the
    board shuts down; then, as at the start, it is fully on or off as `default_on` says. One that
    `blinks` is on for half of each cycle, until the board shuts down. `kick` is for what the
    timeline tells it.
    """

    name: str
    pin: str
    kind: Literal["digital", "pwm"] = "digital"
    cycle_ticks: int = 0
    max_duration_ticks: int = 0
    default_on: bool = False
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
    """A device on an SPI bus, which it may share. It is selected while `cs_pin` is low; `mode` is
    the bus's for it, 0 to 3."""

    cs_pin: str
    clock_pin: str
    mosi_pin: str
    miso_pin: str
    mode: int = 3

    @property
    def pins(self) -> tuple[str, ...]:
        """All pins."""
        return (self.cs_pin, self.clock_pin, self.mosi_pin, self.miso_pin)


@dataclass(frozen=True, slots=True)
class Sensor:
    """A temperature sensor on an analog input, or behind a converter that is selected by `pin` on
    the bus `spi`; then a share is that of the converter's full scale. Before it is asked it is told
    the words of `setup`, and `clears_faults`, if not empty, whenever it has a fault.

    `table` holds (°C, share of the ADC's full scale) by ascending °C, the share strictly rising or
    falling; beyond its ends the sensor is broken: open above the greatest share and shorted below
    the least, or the other way round if not `open_is_high`. Outside `min_ratio`…`max_ratio` the
    board shuts down, unless the host has switched the heater off before.
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


@dataclass(frozen=True, slots=True)
class Setting:
    """What a device on an SPI bus is told when the board begins, and after a lost link."""

    spi: SpiPins
    words: tuple[bytes, ...]


@dataclass(frozen=True, slots=True)
class Heater:
    """An output that heats what a sensor measures.

    `limits` are its protections; one of them, the model deviation, needs a `model` of what is
    heated (that of a model-predictive `control` is known without). `fan` names the output that
    cools it, for the model. `arrival` says when a target is reached.
    """

    name: str
    output: str
    sensor: str
    control: Control
    limits: _core.ProtectionLimits = field(default_factory=_core.ProtectionLimits)
    model: _core.HeatModel | None = None
    fan: str | None = None
    max_power: float = 1.0
    arrival: _core.Arrival = field(default_factory=_core.Arrival)


@dataclass(frozen=True, slots=True)
class Endstop:
    """A switch on an input pin."""

    name: str
    pin: str


@dataclass(frozen=True, slots=True)
class Driver:
    """The driver of the motor `stepper`, set up over a wire; `address` tells those on one UART
    apart."""

    stepper: str
    wire: UartPins | SpiPins
    settings: DriverSettings
    address: int = 0


@dataclass(frozen=True, slots=True)
class BoardDescription:
    """A board and its wiring. The order of `steppers` and of `outputs` is that of message targets,
    unless `stepper_targets` and `output_targets` number them: on one of several boards. There
    `endstops_elsewhere` are the names of endstops of other boards that stop steppers of this one.

    `clock_hz` is the nominal frequency of the board's clock; `move_count` the number of commands
    that it can hold (a simulated board has as many, a real one reports its own). One that
    `survives` is taken to run Passo's firmware, and one that does not, not to; None: either.
    """

    clock_hz: int
    steppers: tuple[Stepper, ...] = ()
    outputs: tuple[Output, ...] = ()
    sensors: tuple[Sensor, ...] = ()
    heaters: tuple[Heater, ...] = ()
    endstops: tuple[Endstop, ...] = ()
    drivers: tuple[Driver, ...] = ()
    settings: tuple[Setting, ...] = ()
    move_count: int = 1024
    mcu: str = "atmega2560"
    survives: bool | None = None
    endstops_elsewhere: tuple[str, ...] = ()
    stepper_targets: tuple[int, ...] = ()
    output_targets: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        """Raises ValueError for what no board could be wired like."""
        for part, names in (
            ("stepper", [s.name for s in self.steppers]),
            ("output", [o.name for o in self.outputs]),
            ("sensor", [s.name for s in self.sensors]),
            ("heater", [h.name for h in self.heaters]),
            ("endstop", [e.name for e in self.endstops]),
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
            if heater.output not in outputs or heater.sensor not in sensors:
                raise ValueError(f"heater {heater.name}: its output or sensor is not described")
            if heater.fan is not None and heater.fan not in outputs:
                raise ValueError(f"heater {heater.name}: its fan is not described")
            if outputs[heater.output].max_duration_ticks <= 0:
                raise ValueError(f"heater {heater.name}: its output needs a maximum duration")

    @property
    def uarts(self) -> tuple[UartPins, ...]:
        """The drivers' UARTs, each once."""
        return tuple(dict.fromkeys(d.wire for d in self.drivers if isinstance(d.wire, UartPins)))

    @property
    def spi_devices(self) -> tuple[SpiPins, ...]:
        """All that is selected on an SPI bus."""
        wires = (
            *(d.wire for d in self.drivers),
            *(s.spi for s in self.sensors),
            *(s.spi for s in self.settings),
        )
        return tuple(wire for wire in wires if isinstance(wire, SpiPins))

    @property
    def pins(self) -> tuple[str, ...]:
        """All pins in use, as written; those that are shared once."""
        return (
            *(pin for s in self.steppers for pin in (s.step_pin, s.dir_pin)),
            *(o.pin for o in self.outputs),
            *(s.pin for s in self.sensors if s.spi is None),
            *(e.pin for e in self.endstops),
            *{
                bare(pin): pin for wire in (*self.uarts, *self.spi_devices) for pin in wire.pins
            }.values(),
        )


def together(boards: Mapping[str, BoardDescription]) -> BoardDescription:
    """All boards of a machine as one, the main one first, with its clock: steppers and outputs in
    the order of their numbers, pins with the names of their boards."""
    main, *others = boards.values()
    if not others:
        return main
    steppers: dict[int, Stepper] = {}
    outputs: dict[int, Output] = {}
    sensors: list[Sensor] = []
    endstops: list[Endstop] = []
    for name, board in boards.items():
        named = partial(named_on, name)
        for i, s in zip(board.stepper_targets, board.steppers, strict=True):
            steppers[i] = replace(s, step_pin=named(s.step_pin), dir_pin=named(s.dir_pin))
        for i, o in zip(board.output_targets, board.outputs, strict=True):
            outputs[i] = replace(o, pin=named(o.pin))
        sensors += [replace(s, pin=named(s.pin)) for s in board.sensors]
        endstops += [replace(e, pin=named(e.pin)) for e in board.endstops]
    order = [outputs[i].name for i in sorted(outputs)]
    heaters = (h for board in boards.values() for h in board.heaters)
    return replace(
        main,
        steppers=tuple(steppers[i] for i in sorted(steppers)),
        outputs=tuple(outputs[i] for i in sorted(outputs)),
        sensors=tuple(sensors),
        heaters=tuple(sorted(heaters, key=lambda h: order.index(h.output))),
        endstops=tuple(endstops),
        endstops_elsewhere=(),
        stepper_targets=(),
        output_targets=(),
    )


def bare(pin: str) -> str:
    """The pin's name without `!`, `^` and `~`."""
    return pin.lstrip("!^~")


def inverted(pin: str) -> bool:
    """Whether `!` stands before the pin's name."""
    return "!" in pin


def _unique(what: str, names: Iterable[str]) -> None:
    seen: set[str] = set()
    for name in names:
        if name in seen:
            raise ValueError(f"{what} {name} is used twice")
        seen.add(name)
