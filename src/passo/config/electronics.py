"""The board and what is wired to it besides motors and heaters: fans, a laser."""

from __future__ import annotations

from math import inf
from typing import Annotated, Any, Literal

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


class Budget(Model):
    """What a board's processor and its link take; the planner keeps to it.

    Steps may take `step_share` of the processor's time at `cycles_per_step`, commands
    `command_share` at `cycles_per_command`, frames and all. `cpu_hz` is the board's clock unless
    given. `link_bytes_s` is what the link carries in bytes/s; without it, a serial link carries 95
    of 100 bytes that fit its `baud`, and others bound nothing.
    """

    cpu_hz: Annotated[int, Field(ge=1_000_000, le=10_000_000_000)] | None = None
    cycles_per_step: Positive
    cycles_per_command: Positive
    step_share: Annotated[float, Field(gt=0, le=1)] = 0.65
    command_share: Annotated[float, Field(gt=0, le=1)] = 0.3
    link_bytes_s: Annotated[float, Field(ge=100)] | None = None


# Bytes on the wire of a command, with its share of the frame and of changes of direction: 8.05 to
# 8.28 on sliced files of 1.6 million commands.
_COMMAND_BYTES = 8.3
_BYTES_PER_BAUD = 0.095  # ten bits a byte; some are repeated or come late
# A burst of so many seconds of commands may come ahead, but never more than half of the slots.
_BURST_S = 0.1


class Board(Model):
    """A controller board. `base` names a shipped board whose values hold unless given here.

    Tools that wire a machine speak of `sockets` and of the names in `pins`; both lead to pins of
    the microcontroller. `link` says where the board is: simulated, on the serial device `port` at
    `baud`, or at the network address `port` (host:port). A simulated board is a model of one
    ("virtual") or runs Passo's firmware ("passo"): to the tick the same, but slower.
    `compression_tolerance_us` bounds how far a step may be from its ideal time, unless the board's
    budget asks for more; `move_count` is the number of commands that the board can hold. Without a
    `budget` the planner takes the board and its link to be fast enough.
    """

    base: str | None = None
    name: str
    mcu: str
    link: Literal["simulated", "serial", "tcp"] = "simulated"
    port: str | None = None
    baud: Annotated[int, Field(ge=1200, le=4_000_000)] = 250_000
    firmware: Literal["virtual", "passo"] = "virtual"
    clock_hz: Annotated[int, Field(ge=1_000_000, le=1_000_000_000)]
    move_count: Annotated[int, Field(ge=16, le=65_535)]
    compression_tolerance_us: Annotated[float, Field(gt=0, le=25)] = 2.0
    budget: Budget | None = None
    sockets: dict[str, Socket] = {}
    pins: dict[str, Pin] = {}

    def budget_spec(self) -> dict[str, Any] | None:
        """The budget for the core: rates per second of all motors together, a burst in commands."""
        budget = self.budget
        if budget is None:
            return None
        cpu_hz = budget.cpu_hz or self.clock_hz
        by_board = budget.command_share * cpu_hz / budget.cycles_per_command
        serial = _BYTES_PER_BAUD * self.baud if self.link == "serial" else inf
        by_link = (budget.link_bytes_s or serial) / _COMMAND_BYTES
        commands_s = min(by_board, by_link)
        return {
            "steps_s": budget.step_share * cpu_hz / budget.cycles_per_step,
            "commands_s": commands_s,
            "burst": min(_BURST_S * commands_s, self.move_count / 2),
            "by_link": by_link < by_board,
        }


Fans = dict[Name, Fan]
