"""Microcontrollers: their pins and the functions of each pin, from `chips/*.toml`. The files
`numberings/*.toml` have the numbers that are printed next to pins on boards.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field

from passo.config.types import Model

_HERE = Path(__file__).parent
_TIMES_STEPS = "times steps"
_RANGE = re.compile(r"(.*?)(\d+)(?:-(\d+))?")


class Timer(Model):
    """A timer with the pins that each of its channels can pulse. `firmware` is the use of the timer
    by the firmware, if any."""

    bits: Literal[8, 16, 32]
    firmware: str = ""
    outputs: dict[str, list[str]] = {}


class Uart(Model):
    """A UART that the firmware can use for its console, and its pins. It divides `hz` by whole
    numbers; on an AVR `hz` is an eighth of the board's clock."""

    hz: Annotated[int, Field(gt=0)] | None = None
    receive: list[str]
    send: list[str]


class _Data(Model):
    name: str
    core: Literal["avr", "cortex-m0plus", "cortex-m3", "cortex-m4"]
    flash_bytes: Annotated[int, Field(gt=0)]
    flash_start: Annotated[int, Field(ge=0)] = 0
    ram_bytes: Annotated[int, Field(gt=0)]
    ram_start: Annotated[int, Field(ge=0)]
    adc_bits: Literal[10, 12]
    alarm: str = "SysTick"
    uarts: dict[str, Uart]
    uart_divisor: Annotated[int, Field(ge=1)] = 1
    pins: list[str]
    adc: list[str] = []
    adc_channels: dict[str, int] = {}
    timers: dict[str, Timer] = {}


@dataclass(frozen=True, slots=True)
class Pulse:
    """A timer's channel that can pulse a pin."""

    timer: str
    channel: str


@dataclass(frozen=True)
class Chip:
    """A microcontroller. `pins` are in the order of its ports; `adc` gives the channel of each
    analog input, `pwm` the timers' channels that reach a pin; `alarm` wakes the firmware. The
    divisors of `uarts` are at least `uart_divisor`. Sizes and addresses are in bytes."""

    key: str
    name: str
    core: str
    flash_bytes: int
    flash_start: int
    ram_bytes: int
    ram_start: int
    adc_bits: int
    alarm: str
    uarts: dict[str, Uart]
    uart_divisor: int
    pins: tuple[str, ...]
    adc: dict[str, int]
    timers: dict[str, Timer]
    pwm: dict[str, tuple[Pulse, ...]]

    @property
    def compare_units(self) -> tuple[str, ...]:
        """The units that can time a motor's steps, such as TIMER3A; empty if the chip's alarm times
        them all."""
        units = (
            f"{name}{channel}"
            for name, timer in self.timers.items()
            if timer.firmware == _TIMES_STEPS
            for channel in timer.outputs
        )
        return tuple(unit for unit in units if unit != self.alarm)


def expanded(items: Iterable[str]) -> list[str]:
    """`PA0-2`, `PB1` as PA0, PA1, PA2, PB1."""
    pins: list[str] = []
    for item in items:
        match = _RANGE.fullmatch(item)
        if match is None:
            raise ValueError(f"{item!r} names no pins")
        stem, first = match[1], int(match[2])
        pins += [f"{stem}{i}" for i in range(first, int(match[3] or first) + 1)]
    return pins


def chip_names() -> list[str]:
    """The names of the supported chips, sorted."""
    return sorted(path.stem for path in (_HERE / "chips").glob("*.toml"))


@cache
def chip(name: str) -> Chip:
    """The chip with the name that boards have in `mcu`. Raises KeyError if it is not supported."""
    if name not in chip_names():
        raise KeyError(name)
    data = _Data.model_validate(tomllib.loads((_HERE / "chips" / f"{name}.toml").read_text()))
    pwm: dict[str, tuple[Pulse, ...]] = {}
    for timer, content in data.timers.items():
        for channel, pins in content.outputs.items():
            for pin in pins:
                pwm[pin] = (*pwm.get(pin, ()), Pulse(timer, channel))
    return Chip(
        key=name,
        name=data.name,
        core=data.core,
        flash_bytes=data.flash_bytes,
        flash_start=data.flash_start,
        ram_bytes=data.ram_bytes,
        ram_start=data.ram_start,
        adc_bits=data.adc_bits,
        alarm=data.alarm,
        uarts=data.uarts,
        uart_divisor=data.uart_divisor,
        pins=tuple(expanded(data.pins)),
        adc=data.adc_channels or {pin: i for i, pin in enumerate(expanded(data.adc))},
        timers=data.timers,
        pwm=pwm,
    )


def numberings() -> list[str]:
    """The names of the known numberings of pins, sorted."""
    return sorted(path.stem for path in (_HERE / "numberings").glob("*.toml"))


@cache
def numbering(name: str) -> dict[str, str]:
    """The pin of the chip for each printed number, such as D54 → PF0. Raises KeyError if the
    numbering is unknown."""
    if name not in numberings():
        raise KeyError(name)
    text = (_HERE / "numberings" / f"{name}.toml").read_text()
    tables: dict[str, list[str]] = tomllib.loads(text)
    return {f"{prefix}{i}": pin for prefix, pins in tables.items() for i, pin in enumerate(pins)}
