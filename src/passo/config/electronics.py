"""The board and what is wired to it besides motors and heaters: fans, a laser."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from passo.config.base import Fraction, Letter, Model, Name, Pin, Positive


class Fan(Model):
    """A fan; `number` is the P of M106 and M107."""

    pin: Pin
    number: Annotated[int, Field(ge=0, le=255)] = 0
    max_power: Fraction = 1.0


class Laser(Model):
    """A laser or a spindle. S of M3 and M4 at full power is `full_scale`. The two letters are
    APrinter's words of a G1 (energy in W·s, density in W·s/mm); only if given do they belong to a
    move."""

    pin: Pin
    full_scale: Positive = 255.0
    energy_letter: Letter | None = None
    density_letter: Letter | None = None


class Socket(Model):
    """The pins of a board's place for a stepper driver."""

    step: Pin
    direction: Pin
    enable: Pin


class Board(Model):
    """A controller board. `base` names a shipped board whose values hold unless given here.

    Tools that wire a machine speak of `sockets` and of the names in `pins`; both lead to pins of
    the microcontroller. `compression_tolerance_us` bounds how far a step may be from its ideal
    time; `move_count` is the number of commands that the board can hold. A simulated board is a
    model of one ("virtual") or runs Passo's firmware ("passo"): to the tick the same, but slower.
    """

    base: str | None = None
    name: str
    mcu: str
    link: Literal["simulated"] = "simulated"
    firmware: Literal["virtual", "passo"] = "virtual"
    clock_hz: Annotated[int, Field(ge=1_000_000, le=1_000_000_000)]
    move_count: Annotated[int, Field(ge=16, le=65_535)]
    compression_tolerance_us: Annotated[float, Field(gt=0, le=25)] = 2.0
    sockets: dict[str, Socket] = {}
    pins: dict[str, Pin] = {}


Fans = dict[Name, Fan]
