"""A controller board, as described by its file. `passo.config.load` and `load_board` make it."""

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
    klippers_budget,
)
from passo.config.chips import Chip, chip, chip_names
from passo.config.klippers_firmware import ASSUMED_CLOCK_HZ, runs_klippers
from passo.config.pin_names import bare
from passo.config.types import Model, Pin, Positive

WIPER_MAX = 255  # the last position of a digital potentiometer


class Socket(Model):
    """A socket for a stepper driver."""

    step: Pin
    """The step pin."""
    direction: Pin
    """The direction pin."""
    enable: Pin
    """The enable pin."""
    compare: str | None = None
    """The compare unit of the chip that times the steps."""
    select: Pin | None = None
    """The chip select of drivers with SPI."""
    uart: Pin | None = None
    """The pin of the UART of drivers that have one."""
    uart_send: Pin | None = None
    """The pin that sends to the UART, if that is another one."""
    address: Annotated[int, Field(ge=0, le=3)] = 0
    """The address of a TMC2209 in this socket, on boards with one UART for several."""
    microstep: list[Pin] = []
    """The pins MS1 and MS2 of the driver."""
    current: int | None = None
    """The channel of the `current_setter`."""


class CurrentSetter(Model):
    """An AD5206 on an SPI bus, a digital potentiometer with a channel for each driver, whose
    position limits the current of the phases."""

    kind: Literal["AD5206"]
    """A digital potentiometer with a channel for each driver."""
    cs_pin: Pin
    """The chip select."""
    clock_pin: Pin
    """The clock of the SPI bus."""
    mosi_pin: Pin
    """The data to the potentiometer."""
    miso_pin: Pin
    """A pin for the data from the bus, which is not used."""
    steps_per_ma: Positive
    """Positions, of 255, per mA of peak current."""

    def word(self, channel: int, ampere: float) -> bytes:
        """The bytes to send for a channel's peak current in A: the address, then the position."""
        return bytes([channel, round(ampere * 1000 * self.steps_per_ma)])


class Console(Model):
    """The port of the host."""

    connector: Literal["serial", "usb", "any"]
    """The connector of the console. The firmware does not speak USB."""
    uart: str | None = None
    """The UART of the chip."""
    pins: Annotated[list[Pin], Field(max_length=2)] = []
    """The pins that receive and send."""
    baud: Annotated[int, Field(ge=9600, le=4_000_000)]
    """The baud rate."""


class Flash(Model):
    """How firmware gets onto the board."""

    method: Literal["avrdude", "bossac", "openocd", "teensy_loader_cli", "uf2"]
    """The program that flashes the board."""
    part: str = ""
    """The name of the chip, for avrdude."""
    programmer: str = ""
    """The programmer, for avrdude."""
    baud: int = 0
    """The baud rate of the boot loader."""
    target: str = ""
    """The target, for openocd."""
    touch: bool = False
    """Whether the port is opened at 1200 baud first, which starts the boot loader."""
    volume: str = ""
    """The name of the drive that appears, for UF2."""
    before: list[str] = []
    """Manual steps before flashing."""
    after: list[str] = []
    """Manual steps after flashing."""


class Function(Model):
    """An output of the board and the input of its sensor, as the makers of the board named them."""

    output: Pin
    """The output."""
    sensor: Pin | None = None
    """The input of the sensor."""


class Board(Model):
    """A controller board. `base` names a shipped board whose values apply unless given here.
    Machine files use the names of `sockets` and pins. After loading, `pins` maps *all* names
    (printed numbers, `outputs`, `thermistors`, `endstops`, `X_STEP` and so on) to pins of the
    microcontroller. Without a `budget` the planner assumes that the board is fast enough; for a
    board with the firmware of Klipper, the budget follows from the clock. A real board runs the
    firmware of Passo unless `firmware` is "klipper".
    """

    base: str | None = None
    """A [shipped board](boards.md) whose values apply unless given here, or `klipper`."""
    name: str
    """The name of the board, in texts."""
    description: str = ""
    """One line about the board."""
    notes: list[str] = []
    """Notes for the user of this board."""
    mcu: str
    """The microcontroller: a file of `src/passo/config/chips/`, without its ending."""
    link: Literal["simulated", "serial", "tcp"] = "simulated"
    """How the board is connected."""
    port: str | None = None
    """The serial device, or host:port."""
    baud: Annotated[int, Field(ge=1200, le=4_000_000)] = 250_000
    """The baud rate of the serial device. If not given, that of the console."""
    firmware: Literal["virtual", "passo", "klipper"] = "virtual"
    """The firmware of the board. A simulated board is a model (`virtual`) or runs the firmware
    itself (`passo`): the same to the tick, but slower."""
    drift_ppm: Annotated[float, Field(ge=-500, le=500)] = 0.0
    """The deviation of the clock of a further simulated board."""
    start_s: Annotated[float, Field(ge=0, le=1e6)] = 0.0
    """The clock at which a further simulated board starts."""
    clock_hz: Annotated[int, Field(ge=1_000_000, le=1_000_000_000)] = ASSUMED_CLOCK_HZ
    """The frequency of the clock. If not given for a board with the firmware of Klipper,
    `passo serve` reads it from the firmware, and other commands assume 16 MHz. Every other board
    needs it."""
    move_count: Annotated[int, Field(ge=16, le=65_535)]
    """The capacity of the move queue, in commands."""
    compression_tolerance_us: Annotated[float, Field(gt=0, le=25)] = 2.0
    """The maximum distance of a step from its ideal time. Where the budget is short, it widens up
    to 25 µs."""
    budget: Budget | None = None
    """The maximum load of processor and link. If not given for a board with the firmware of
    Klipper, it follows from `clock_hz`."""
    numbering: str | None = None
    """The numbers that are printed beside the pins: a file of `src/passo/config/numberings/`."""
    dictionary: str | None = None
    """The data dictionary of a firmware of Klipper, a file relative to the machine file."""
    console: Console | None = None
    """The port for the host."""
    flash: Flash | None = None
    """How firmware gets onto the board."""
    sockets: dict[str, Socket] = {}
    """The sockets of stepper drivers, by name."""
    microstep_levels: dict[str, list[Literal[0, 1]]] = {}
    """The levels of the pins MS1 and MS2, by microsteps."""
    current_setter: CurrentSetter | None = None
    """The chip that sets the currents of the drivers."""
    outputs: dict[str, Pin] = {}
    """Names of outputs."""
    thermistors: dict[str, Pin] = {}
    """Names of the inputs of thermistors."""
    endstops: dict[str, Pin] = {}
    """Names of the inputs of endstops."""
    pullup_ohm: Positive | None = None
    """The pull-up resistors of the inputs of thermistors."""
    pins: dict[str, Pin] = {}
    """Further names of pins."""
    card: dict[str, Pin] = {}
    """The pins of the socket for an SD card."""
    displays: dict[str, dict[str, Pin]] = {}
    """The pins of displays, by name."""
    reserved: dict[str, list[Pin]] = {}
    """Pins that belong to the board itself."""
    status_led: Pin | None = None
    """An LED that blinks once a second while the board is configured."""
    fitted: list[str] = []
    """Parts that are plugged in: `card`, or a name of `displays`."""
    variant: str | None = None
    """The name of the variant whose `functions` apply."""
    variants: dict[str, dict[str, Function]] = {}
    """The output and the sensor input of each part, by variant."""
    functions: dict[str, Function] = {}
    """Which output and input are for which part: `hotend0`, `bed`, `fan0`, …"""

    def budget_spec(self, pulse_us: float = 0.0) -> dict[str, Any] | None:
        """The budget for the core: rates per second of all motors together, a burst in commands.
        `bound` names the limit of the rate of commands: the link, the processor's time for
        "commands", or the move queue. `pulse_us` is the longest step pulse of its motors. None if
        neither rate has a limit."""
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
        """Steps and commands per second that the processor can take; infinite without a budget. The
        processor waits during a step pulse. Klipper's firmware instead ends a long pulse in a
        separate event, which costs as much as a step."""
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
    def knows_clock(self) -> bool:
        """Whether a file gives the clock; if not, `clock_hz` is an assumption."""
        return "clock_hz" in self.model_fields_set

    def with_clock(self, clock_hz: int) -> Board:
        """The board with the clock that its firmware, which is Klipper's, reports."""
        assumed = klippers_budget(ASSUMED_CLOCK_HZ)
        given = self.budget.model_dump(exclude_unset=True) if self.budget else {}
        stated = {key: value for key, value in given.items() if value != assumed.get(key)}
        budget = Budget.model_validate({**klippers_budget(clock_hz), **stated})
        return self.model_copy(update={"clock_hz": clock_hz, "budget": budget})

    @property
    def is_klippers(self) -> bool:
        """Whether the board runs Klipper's firmware."""
        return runs_klippers({"base": self.base, "mcu": self.mcu, "firmware": self.firmware})

    @property
    def survives(self) -> bool:
        """Whether motion is sent in commits, because the board can brake without the host: it runs,
        or is assumed to run, Passo's firmware."""
        if self.link == "simulated":
            return self.firmware == "passo"
        return not self.is_klippers

    @property
    def ahead_s(self) -> float:
        """The print time, in seconds, for which commands are on the board in advance."""
        return COMMITTED_S if self.survives else AHEAD_S

    @property
    def link_bytes_s(self) -> float:
        """The rate of the link in bytes/s; infinite without a limit. A port of Klipper's firmware
        may be USB, whose rate does not follow from its baud rate."""
        serial = BYTES_PER_BAUD * self.baud if self.link == "serial" else inf
        stated = self.budget.link_bytes_s if self.budget else None
        if stated is None:
            return serial
        return stated if self.is_klippers else min(stated, serial)

    @property
    def commit_bytes_s(self) -> float:
        """The part of the link's rate that commits use without their tails, in bytes/s: at most
        half."""
        return min(COMMIT_BYTES / COMMIT_S, self.link_bytes_s / 2) if self.survives else 0.0

    @property
    def chip(self) -> Chip | None:
        """The microcontroller; None if Passo does not support it."""
        return chip(self.mcu) if self.mcu in chip_names() else None

    @property
    def incomplete(self) -> str:
        """The feature that Passo's firmware lacks for this board: `usb`, or an empty text."""
        return "usb" if self.console and self.console.connector == "usb" else ""

    def pin(self, name: str) -> str:
        """The microcontroller's pin for a name, with the marks of both as prefix; two inversions
        cancel."""
        return pin_behind(self.pins, name)


def pin_behind(names: Mapping[str, object], written: str) -> str:
    """The microcontroller's pin for a name on a board with these names, with the marks of both as
    prefix; two inversions cancel."""
    name = bare(written)
    return joined_marks(written, str(names.get(name, name)))


def joined_marks(outer: str, inner: str) -> str:
    """The pin of `inner` with the marks of both: `!D10` where D10 is `!PB4` is PB4."""
    name = bare(inner)
    marks = outer[: len(outer) - len(bare(outer))] + inner[: len(inner) - len(name)]
    kept = ("!" if marks.count("!") % 2 else "") + "".join(m for m in "^~" if m in marks)
    return kept + name
