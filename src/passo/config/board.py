"""A controller board as its file describes it. Made by `passo.config.load` and `load_board`."""

from __future__ import annotations

from collections.abc import Mapping
from math import inf, isinf
from typing import Annotated, Any, Literal

from pydantic import Field

from passo.config.budget import (
    AHEAD_S,
    BURST_S,
    BYTES_PER_BAUD,
    COMMAND_BYTES,
    COMMIT_BURST_S,
    COMMIT_BYTES,
    COMMIT_S,
    COMMITTED_S,
    LINK_BURST_S,
    Budget,
)
from passo.config.chips import Chip, chip, chip_names
from passo.config.pin_names import bare
from passo.config.types import Model, Pin, Positive

WIPER_MAX = 255  # the last position of a digital potentiometer


class Socket(Model):
    """A place for a stepper driver. `compare` is the compare unit that times its steps, `select`
    its chip select where drivers are set up by SPI, `microstep` its pins MS1 and MS2, `current` its
    channel of the board's current setter."""

    step: Pin
    direction: Pin
    enable: Pin
    compare: str | None = None
    select: Pin | None = None
    microstep: list[Pin] = []
    current: int | None = None


class CurrentSetter(Model):
    """An AD5206 on an SPI bus, a digital potentiometer with a channel for each driver: at the
    position of so many steps of 255 for each mA a driver limits its phases to that."""

    kind: Literal["AD5206"]
    cs_pin: Pin
    clock_pin: Pin
    mosi_pin: Pin
    miso_pin: Pin
    steps_per_ma: Positive

    def word(self, channel: int, ampere: float) -> bytes:
        """What it is told: the address, then the position."""
        return bytes([channel, round(ampere * 1000 * self.steps_per_ma)])


class Console(Model):
    """The port that the host talks to. With the connector `usb` the chip itself would have to speak
    USB; the firmware speaks on `pins` (receive, transmit) of `uart`."""

    connector: Literal["serial", "usb", "any"]
    uart: str | None = None
    pins: Annotated[list[Pin], Field(max_length=2)] = []
    baud: Annotated[int, Field(ge=9600, le=4_000_000)]


class Flash(Model):
    """How firmware gets onto the board. `part`, `programmer`, `baud` and `target` are what the tool
    wants to hear; with `touch` the port is opened at 1200 baud first; `volume` is the name of the
    drive that appears. `before` and `after` are what hands must do."""

    method: Literal["avrdude", "bossac", "openocd", "teensy_loader_cli", "uf2"]
    part: str = ""
    programmer: str = ""
    baud: int = 0
    target: str = ""
    touch: bool = False
    volume: str = ""
    before: list[str] = []
    after: list[str] = []


class Function(Model):
    """What the board's makers meant an output for, and the sensor that belongs to it."""

    output: Pin
    sensor: Pin | None = None


class Board(Model):
    """A controller board. `base` names a shipped board whose values hold unless given here.

    Machines speak of `sockets` and of names; once loaded, `pins` holds *all* names (printed
    numbers, `outputs`, `thermistors`, `endstops`, `X_STEP` and the like) with the pin of the
    microcontroller behind each, and every other pin is the microcontroller's too. `variant` chooses
    one of the `variants` as the board's `functions`. `fitted` lists what is plugged in besides:
    `card`, or one of the `displays`. `reserved` pins belong to the board itself. `microstep_levels`
    are the levels of a socket's microstep pins for so many microsteps, and `current_setter` sets
    the currents of the drivers whose sockets have a channel of it.
    `pullup_ohm` are the resistors above its thermistors, for sensors that name none of their own.
    `status_led` blinks once a second while the board is configured and not shut down.

    `link` says where the board is: simulated, on the serial device `port` at `baud` (the console's
    unless given; the console's too if given), or at the network address `port` (host:port).

    `compression_tolerance_us` bounds how far a step may be from its ideal time, unless the board's
    budget asks for more; `move_count` is the number of commands that the board can hold. Without a
    `budget` the planner takes the board to be fast enough; a board with Klipper's firmware has the
    one that its clock suggests. A real board runs Passo's firmware unless `firmware` is "klipper";
    a simulated one is a model ("virtual") or runs Passo's ("passo"): to the tick the same, but
    slower. A simulated board beside the main one begins at the clock `start_s`, which runs
    `drift_ppm` faster than the main board's. `dictionary` is the file of a data dictionary as
    Klipper's build leaves it, for boards of the kind `klipper`.
    """

    base: str | None = None
    name: str
    description: str = ""
    notes: list[str] = []
    mcu: str
    link: Literal["simulated", "serial", "tcp"] = "simulated"
    port: str | None = None
    baud: Annotated[int, Field(ge=1200, le=4_000_000)] = 250_000
    firmware: Literal["virtual", "passo", "klipper"] = "virtual"
    drift_ppm: Annotated[float, Field(ge=-500, le=500)] = 0.0
    start_s: Annotated[float, Field(ge=0, le=1e6)] = 0.0
    clock_hz: Annotated[int, Field(ge=1_000_000, le=1_000_000_000)]
    move_count: Annotated[int, Field(ge=16, le=65_535)]
    compression_tolerance_us: Annotated[float, Field(gt=0, le=25)] = 2.0
    budget: Budget | None = None
    numbering: str | None = None
    dictionary: str | None = None
    console: Console | None = None
    flash: Flash | None = None
    sockets: dict[str, Socket] = {}
    microstep_levels: dict[str, list[Literal[0, 1]]] = {}
    current_setter: CurrentSetter | None = None
    outputs: dict[str, Pin] = {}
    thermistors: dict[str, Pin] = {}
    endstops: dict[str, Pin] = {}
    pullup_ohm: Positive | None = None
    pins: dict[str, Pin] = {}
    card: dict[str, Pin] = {}
    displays: dict[str, dict[str, Pin]] = {}
    reserved: dict[str, list[Pin]] = {}
    status_led: Pin | None = None
    fitted: list[str] = []
    variant: str | None = None
    variants: dict[str, dict[str, Function]] = {}
    functions: dict[str, Function] = {}

    def budget_spec(self, pulse_us: float = 0.0) -> dict[str, Any] | None:
        """The budget for the core: rates per second of all motors together, a burst in commands.
        `bound` is what bounds the rate of commands: the link, the processor's time for "commands",
        or the slots. `pulse_us` is the longest pulse of its motors. None where nothing bounds
        either rate."""
        steps_s, by_board = self._processor_rates(pulse_us)
        by_link = (self.link_bytes_s - self.commit_bytes_s) / COMMAND_BYTES
        burst_s = COMMIT_BURST_S if self.survives else LINK_BURST_S
        if isinf(by_board) and isinf(by_link):
            return None
        rates = {"link": by_link, "commands": by_board, "slots": self.move_count / self.ahead_s}
        bound = min(rates, key=lambda name: rates[name])
        commands_s = rates[bound]
        return {
            "steps_s": steps_s,
            "commands_s": commands_s,
            "burst": min(BURST_S * commands_s, burst_s * by_link, self.move_count / 2),
            "bound": bound,
            "commits_s": 1 / COMMIT_S if self.survives else 0.0,
        }

    def _processor_rates(self, pulse_us: float) -> tuple[float, float]:
        """Steps and commands per second that the processor takes; infinite without a budget. It
        waits while a step's pulse lasts, but for Klipper's: that has each longer pulse end in an
        event of its own, which costs what a step does."""
        budget = self.budget
        if budget is None:
            return inf, inf
        cpu_hz = budget.cpu_hz or self.clock_hz
        per_step = budget.cycles_per_step
        if pulse_us > budget.pulse_us:
            waits = (pulse_us - budget.pulse_us) * 1e-6 * cpu_hz
            per_step += budget.cycles_per_step if self.is_klippers else waits
        steps_s = budget.step_share * cpu_hz / per_step
        return steps_s, budget.command_share * cpu_hz / budget.cycles_per_command

    @property
    def is_klippers(self) -> bool:
        """Whether the board runs Klipper's firmware."""
        return "klipper" in (self.base, self.mcu, self.firmware)

    @property
    def survives(self) -> bool:
        """Whether motion comes in commits, as the board can stop by itself: one that runs, or is
        taken to run, Passo's firmware."""
        if self.link == "simulated":
            return self.firmware == "passo"
        return not self.is_klippers

    @property
    def ahead_s(self) -> float:
        """Commands for so long ahead are on the board."""
        return COMMITTED_S if self.survives else AHEAD_S

    @property
    def link_bytes_s(self) -> float:
        """What the link carries, bytes/s; infinite without a bound. A port of Klipper's firmware
        may be USB, whose rate is not its baud."""
        serial = BYTES_PER_BAUD * self.baud if self.link == "serial" else inf
        stated = self.budget.link_bytes_s if self.budget else None
        if stated is None:
            return serial
        return stated if self.is_klippers else min(stated, serial)

    @property
    def commit_bytes_s(self) -> float:
        """What commits take of that without their tails, bytes/s: never more than half of it."""
        return min(COMMIT_BYTES / COMMIT_S, self.link_bytes_s / 2) if self.survives else 0.0

    @property
    def chip(self) -> Chip | None:
        """The microcontroller, if Passo knows it."""
        return chip(self.mcu) if self.mcu in chip_names() else None

    @property
    def incomplete(self) -> str:
        """What a real board of this kind still lacks: `usb`, or nothing."""
        return "usb" if self.console and self.console.connector == "usb" else ""

    def pin(self, name: str) -> str:
        """The microcontroller's pin behind a name, with the marks of both in front; two inversions
        are none."""
        return pin_behind(self.pins, name)


def pin_behind(names: Mapping[str, object], written: str) -> str:
    """The microcontroller's pin behind a name on a board whose names these are, with the marks of
    both in front; two inversions are none."""
    name = bare(written)
    return joined_marks(written, str(names.get(name, name)))


def joined_marks(outer: str, inner: str) -> str:
    """The pin of `inner` with the marks of both: `!D10` where D10 is `!PB4` is PB4."""
    name = bare(inner)
    marks = outer[: len(outer) - len(bare(outer))] + inner[: len(inner) - len(name)]
    kept = ("!" if marks.count("!") % 2 else "") + "".join(m for m in "^~" if m in marks)
    return kept + name
