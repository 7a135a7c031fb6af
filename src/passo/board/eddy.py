"""An eddy current sensor on a board: sets up the chip, collects its frequencies while time passes,
and lets the board stop motors at one of them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.board.bulk_samples import BulkSamples
from passo.board.chip_registers import I2cRegisters, NotAcknowledgedError
from passo.board.configuration import has_triggers
from passo.errors import CommandError

if TYPE_CHECKING:
    from passo.board.connection import Connection
    from passo.board.description import Eddy

RATE_HZ = 400  # values a second
_SETTLE_S = 0.005
_SAMPLE_BYTES = 4
_LOOK_S, _LOOKS = 0.04, 10  # until a value has arrived
_CURRENT_S = 0.1  # until the chip has found its current
_MONITOR_MAX = 3  # intervals of values that may pass without one while motors move
_MOST_RAW = 0x03FFFFFF
_UNREAD, _ERRORS, _VALUE = 0xFFFF, 0xE, 0x0FFFFFFF
# Errors of the boards while motors move, in the order of their numbers.
_TRIGGER_ERRORS = (
    "its value is out of range",
    "its value is too large",
    "it gives no values",
)
_READ_ERRORS = (
    "it reports an error of its coil",
    "its status cannot be read over I2C",
    "its values cannot be read over I2C",
    "it gives impossible values",
)
_CHIP_ERRORS = {8: "a frequency below its range", 4: "a frequency above its range"}
_NO_COIL = "that its coil does not swing"

# Registers and values of the LDC1612; Texas Instruments, SNOSCY9.
_COUNT, _OFFSET, _SETTLE, _DIVIDERS = 0x08, 0x0C, 0x10, 0x14
_ERROR_CONFIG, _CONFIG, _MUX, _CURRENT = 0x19, 0x1A, 0x1B, 0x1E
_IDENTITY = ((0x7E, 0x5449), (0x7F, 0x3055))
_REPORT_ALL = (0x1F << 11) | 1  # errors within values, new values on INTB
_ONE_CHANNEL = 0x0208 | 0x05  # filter of 10 MHz
_RUN, _RUN_ALONE, _SLEEP = 0x1601, 0x0201, 0x2001
_CURRENT_SHIFT, _FOUND_SHIFT = 11, 6


class EddyReader:
    """Reads the sensor `part` of a board: `start`, then `poll` at least each second while time
    passes, then `stop`. Calls that ask the board let time pass. They raise CommandError if the chip
    does not answer, and MachineError. `drive_current` is 0 to 31, and `threshold_hz` the frequency
    at which motors stop."""

    def __init__(self, connection: Connection, part: Eddy) -> None:
        self._connection, self._part = connection, part
        self._oid = connection.oids.eddies[part.name]
        self._registers = I2cRegisters(connection, part.wire, 2)
        self._samples = BulkSamples(_SAMPLE_BYTES)
        self._taken = self._base = 0
        self.drive_current, self.threshold_hz = 0, 0.0
        self.running = False

    @property
    def place(self) -> str:
        """The bus of the chip, for messages."""
        wire = self._part.wire
        return self._connection.named(wire.bus or f"{wire.scl_pin} and {wire.sda_pin}")

    @property
    def _unit_hz(self) -> float:
        """The frequency of the value 1."""
        return self._part.hz * self._part.divider / (1 << 28)

    def start(self, base: int) -> None:
        """Sets up the chip, and starts the reports. `base` is the main board's clock at print time
        0."""
        for register, wanted in _IDENTITY:
            if (found := self._read(register)) != wanted:
                raise CommandError.of(
                    "probe.other-chip", value=self.place, found=found, wanted=wanted
                )
        hz = self._part.hz
        for register, value in (
            (_CONFIG, _SLEEP),
            (_COUNT, round(hz / (16 * RATE_HZ))),
            (_OFFSET, 0),
            (_SETTLE, round(_SETTLE_S * hz / 16)),
            (_DIVIDERS, self._part.divider << 12 | 1),
            (_ERROR_CONFIG, _REPORT_ALL),
            (_MUX, _ONE_CHANNEL),
            (_CURRENT, self.drive_current << _CURRENT_SHIFT),
            (_CONFIG, _RUN),
        ):
            self._write(register, value)
        self._connection.take_responses("sensor_bulk_data", "sensor_bulk_status")
        self._samples, self._taken, self._base = BulkSamples(_SAMPLE_BYTES), 0, base
        self._query(round(self._connection.board.clock_hz / (2 * RATE_HZ)))
        self.running = True
        self.poll()

    def poll(self) -> None:
        """Takes what has arrived, and asks for the state of the chip's clock."""
        self._samples.take(self._connection, self._oid, self._base)
        old = self._connection.dictionary.takes("query_ldc1612_status", "oid")
        name = "query_ldc1612_status" if old else "query_status_ldc1612"
        self._connection.command(f"{name} oid={self._oid}")

    def values(self) -> list[tuple[float, float]]:
        """The values since the last call: print time in s, and Hz. Empty until their times are
        known. Raises CommandError for an error of the chip."""
        start, per_tick = self._samples.times()
        if not per_tick:
            return []
        hz = self._connection.wire.hz
        fresh = [self._hz(sample) for sample in self._samples.since(self._taken)]
        first, self._taken = self._taken, self._taken + len(fresh)
        return [((start + (first + i) / per_tick) / hz, f) for i, f in enumerate(fresh)]

    def stop(self) -> None:
        """Stops the reports and the chip."""
        self.cancel()
        self._write(_CONFIG, _SLEEP)

    def cancel(self) -> None:
        """Stops the reports, if the board still takes commands."""
        self.running = False
        self._query(0)

    def frequency_now(self) -> float:
        """A present frequency, also while the reports are off. Lets time pass."""
        alone = not self.running
        if alone:
            self.start(0)
        try:
            self.poll()
            before = self._samples.count
            for _ in range(_LOOKS):
                self._connection.pass_time(self._connection.now + self._connection.ticks(_LOOK_S))
                self._samples.take(self._connection, self._oid, self._base)
                if self._samples.count > before:
                    return self._hz(self._samples.since(self._samples.count - 1)[0])
            raise self._failure(_TRIGGER_ERRORS[-1])
        finally:
            if alone:
                self.cancel()

    def near(self) -> bool:
        """Whether the frequency is above the threshold. Lets time pass."""
        return self.frequency_now() > self.threshold_hz

    def find_current(self) -> int:
        """The current of the coil that the chip itself chooses here. Lets time pass."""
        self.start(0)
        try:
            self._write(_CONFIG, _SLEEP)
            self._write(_CONFIG, _RUN_ALONE)
            self._connection.pass_time(self._connection.now + self._connection.ticks(_CURRENT_S))
            return self._read(_CURRENT) >> _FOUND_SHIFT & 0x1F
        finally:
            self.stop()

    def arm(self, trsync_oid: int, reason: int, error_reason: int, clock: int) -> None:
        """From `clock` of the board on, a frequency above the threshold triggers this trsync with
        `reason`; an error of the sensor triggers it with a number from `error_reason` on."""
        raw, at = int(self.threshold_hz / self._unit_hz + 0.5), clock & 0xFFFFFFFF
        board = self._connection
        if not has_triggers(board.dictionary):
            board.command(
                f"ldc1612_setup_home oid={self._oid} clock={at} threshold={raw}"
                f" trsync_oid={trsync_oid} trigger_reason={reason} error_reason={error_reason}"
            )
            return
        name = self._part.name
        trigger, filtered = board.oids.triggers[name], board.oids.filters[name]
        ticks = int(board.board.clock_hz / RATE_HZ)
        for command in (
            f"trigger_analog_set_raw_range oid={trigger} raw_min=0 raw_max={_MOST_RAW}",
            f"trigger_analog_set_trigger oid={trigger} trigger_analog_type=gt trigger_value={raw}",
            f"sos_filter_set_offset_scale oid={filtered} offset=0 scale=1 scale_frac_bits=0"
            " auto_offset=0",
            f"trigger_analog_home oid={trigger} trsync_oid={trsync_oid} trigger_reason={reason}"
            f" error_reason={error_reason} clock={at} monitor_ticks={ticks}"
            f" monitor_max={_MONITOR_MAX}",
        ):
            board.command(command)

    def disarm(self) -> None:
        """The sensor stops no motor any more."""
        board = self._connection
        if has_triggers(board.dictionary):
            board.command(
                f"trigger_analog_home oid={board.oids.triggers[self._part.name]} trsync_oid=0"
                " trigger_reason=0 error_reason=0 clock=0 monitor_ticks=0 monitor_max=0"
            )
        else:
            board.command(
                f"ldc1612_setup_home oid={self._oid} clock=0 threshold=0 trsync_oid=0"
                " trigger_reason=0 error_reason=0"
            )

    def error(self, number: int) -> CommandError:
        """The error that the board has reported as `error_reason` + `number`."""
        texts = _READ_ERRORS
        if has_triggers(self._connection.dictionary):
            texts = (*_TRIGGER_ERRORS, *_READ_ERRORS)
        return self._failure(texts[number] if number < len(texts) else f"error {number}")

    def _query(self, rest_ticks: int) -> None:
        self._connection.command(f"query_ldc1612 oid={self._oid} rest_ticks={rest_ticks}")

    def _hz(self, sample: bytes) -> float:
        raw = int.from_bytes(sample, "big")
        if raw >> 16 == _UNREAD:
            error = raw & 0xFFFF
            text = _READ_ERRORS[error] if error < len(_READ_ERRORS) else f"error {error}"
            raise self._failure(text)
        bits, value = raw >> 28, raw & _VALUE
        if bits & _ERRORS or not value:
            found = next((text for bit, text in _CHIP_ERRORS.items() if bits & bit), _NO_COIL)
            raise self._failure(f"it reports {found}")
        return value * self._unit_hz

    def _read(self, register: int) -> int:
        try:
            return self._registers.read(register)
        except NotAcknowledgedError as error:
            raise self._no_answer(error) from None

    def _write(self, register: int, value: int) -> None:
        try:
            self._registers.send(register, value)
        except NotAcknowledgedError as error:
            raise self._no_answer(error) from None

    def _no_answer(self, error: NotAcknowledgedError) -> CommandError:
        return CommandError.of(
            "probe.no-answer",
            value=self.place,
            address=self._part.wire.address,
            found=str(error),
        )

    def _failure(self, text: str) -> CommandError:
        return CommandError.of("probe.sensor", value=self.place, found=text)
