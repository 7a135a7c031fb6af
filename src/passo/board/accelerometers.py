"""An accelerometer on a board: sets up the chip, and collects its samples while time passes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from passo.board.bulk_samples import BulkSamples
from passo.board.chip_registers import I2cRegisters, NotAcknowledgedError, SpiRegisters
from passo.board.description import I2cPins, SpiPins
from passo.errors import CommandError
from passo.resonance.measurement import SAMPLE_BYTES, AccelerometerChip, Measurement

if TYPE_CHECKING:
    from passo.board.connection import Connection
    from passo.board.description import Accelerometer

_RESTS = 4  # the board empties the FIFO of the chip each time it has this number of samples


@dataclass(frozen=True, slots=True)
class Chip:
    """A kind of accelerometer: the register and the value of its identity, its rates in samples a
    second with the register and the value of each, the registers for its setup, and the register
    and the value that stop it. The writes of `measure`, or of the rate if `measure` is empty, start
    the chip."""

    identity: tuple[int, int]
    rates: Mapping[int, tuple[int, int]]
    setup: tuple[tuple[int, int], ...]
    measure: tuple[tuple[int, int], ...]
    stop: tuple[int, int]


# ADXL345: POWER_CTL 0x2D, DATA_FORMAT 0x31 (full resolution, 16 g), FIFO_CTL 0x38 (stream), BW_RATE
# 0x2C; Analog Devices, rev. G. LIS2DW: CTRL1 0x20 (rate, high performance), CTRL2 0x21 (addresses
# count on), CTRL6 0x25 (16 g, low noise), FIFO_CTRL 0x2E (continuous); ST, DocID030836.
CHIPS: dict[AccelerometerChip, Chip] = {
    "adxl345": Chip(
        (0x00, 0xE5),
        {3200: (0x2C, 0x0F), 1600: (0x2C, 0x0E), 800: (0x2C, 0x0D)},
        ((0x2D, 0x00), (0x31, 0x0B), (0x38, 0x00), (0x38, 0x90)),
        ((0x2D, 0x08),),
        (0x2D, 0x00),
    ),
    "lis2dw": Chip(
        (0x0F, 0x44),
        {1600: (0x20, 0x94), 800: (0x20, 0x84)},
        ((0x20, 0x00), (0x21, 0x04), (0x25, 0x34), (0x2E, 0x00), (0x2E, 0xC0)),
        (),
        (0x20, 0x00),
    ),
}


class AccelerometerReader:
    """Reads the accelerometer `part` of a board: `start`, then `poll` at least each second while
    time passes, then `stop`. `base` is the main board's clock at print time 0. Calls that ask the
    board let time pass. They raise CommandError if the chip does not answer, and MachineError."""

    def __init__(self, connection: Connection, part: Accelerometer, base: int) -> None:
        self._connection, self._part, self._base = connection, part, base
        self._chip = CHIPS[part.chip]
        self._sample_bytes = SAMPLE_BYTES[part.chip]
        self._rate_hz = part.rate_hz or max(self._chip.rates)
        self._oid = connection.oids.accelerometers[part.wire]
        self._registers = (
            SpiRegisters(connection, part.wire)
            if isinstance(part.wire, SpiPins)
            else I2cRegisters(connection, part.wire)
        )
        self._samples = BulkSamples(self._sample_bytes)

    @property
    def lost(self) -> int:
        """The samples that did not arrive."""
        return self._samples.lost

    @property
    def overflows(self) -> int:
        """The overflows of the FIFO of the chip: each has lost a sample."""
        return self._samples.overflows

    @property
    def place(self) -> str:
        """The pin or the bus of the chip, for messages."""
        wire = self._part.wire
        if isinstance(wire, SpiPins):
            return self._connection.named(wire.cs_pin or wire.bus)
        return self._connection.named(wire.bus or f"{wire.scl_pin} and {wire.sda_pin}")

    def start(self) -> None:
        """Sets up the chip and starts it."""
        address, wanted = self._chip.identity
        found = self._register(address)
        if found != wanted:
            code = "resonance.silent" if found in (0x00, 0xFF) else "resonance.other-chip"
            raise CommandError.of(
                code, value=self._part.chip.upper(), limit=self.place, found=found, wanted=wanted
            )
        for register, value in self._chip.setup:
            self._write(register, value)
        self._connection.take_responses("sensor_bulk_data", "sensor_bulk_status")
        self._samples = BulkSamples(self._sample_bytes)
        *first, last = (self._chip.rates[self._rate_hz], *self._chip.measure)
        for register, value in first:
            self._write(register, value)
        # The chip starts before the board reads it: an empty FIFO would give an invalid sample.
        # Over I2C, whose writes wait for the board, it would be full by then, and an empty one
        # gives none.
        fast = isinstance(self._part.wire, SpiPins)
        if fast:
            self._send(*last)
        self._query(round(_RESTS / self._rate_hz * self._connection.board.clock_hz))
        if not fast:
            self._send(*last)
        self._check(*last)

    def poll(self) -> None:
        """Takes what has arrived, and asks for the state of the chip's clock."""
        self._take()
        self._connection.command(f"query_{self._part.chip}_status oid={self._oid}")

    def stop(self) -> Measurement:
        """Stops the chip, and returns its samples. Raises CommandError for fewer than two."""
        self._write(*self._chip.stop)
        self._query(0)
        self._take()
        data = self._samples.data
        count = len(data) // self._sample_bytes
        start_ticks, per_tick = self._samples.times()
        hz = self._connection.wire.hz
        start, rate_hz = start_ticks / hz, per_tick * hz
        if count < 2 or rate_hz <= 0:
            raise CommandError.of("resonance.short", value=count, limit=2)
        return Measurement(self._part.chip, self._part.axes, data, start, rate_hz)

    def cancel(self) -> None:
        """Stops the board's reports, if the board still takes commands."""
        self._query(0)

    def _query(self, rest_ticks: int) -> None:
        """Lets the board read the chip each `rest_ticks`; 0: no more."""
        name = f"query_{self._part.chip}"
        at = ""
        if self._connection.dictionary.takes(name, "clock"):  # Klipper's firmware of 2023
            at = f" clock={self._connection.clock_after(0.0) & 0xFFFFFFFF}"
        self._connection.command(f"{name} oid={self._oid}{at} rest_ticks={rest_ticks}")

    def _take(self) -> None:
        self._samples.take(self._connection, self._oid, self._base)

    def _register(self, address: int) -> int:
        try:
            return self._registers.read(address)
        except NotAcknowledgedError as error:
            raise self._no_answer(error) from None

    def _send(self, register: int, value: int) -> None:
        try:
            self._registers.send(register, value)
        except NotAcknowledgedError as error:
            raise self._no_answer(error) from None

    def _no_answer(self, error: NotAcknowledgedError) -> CommandError:
        wire = self._part.wire
        assert isinstance(wire, I2cPins)
        return CommandError.of(
            "resonance.no-acknowledge",
            value=self._part.chip.upper(),
            address=wire.address,
            limit=self.place,
            found=str(error),
        )

    def _write(self, register: int, value: int) -> None:
        self._send(register, value)
        self._check(register, value)

    def _check(self, register: int, value: int) -> None:
        """Raises CommandError if the chip does not have a value in a register."""
        found = self._register(register)
        if found != value:
            raise CommandError.of(
                "resonance.deaf",
                value=self._part.chip.upper(),
                register=register,
                found=found,
                wanted=value,
            )
