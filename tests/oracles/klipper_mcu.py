"""A microcontroller that runs Klipper's firmware, as far as a host sees it: in plain Python and on
any clock, in the words and numbers of a dictionary of that firmware. Nothing of Passo is in it."""

from __future__ import annotations

import json
import re
import zlib
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

from tests.oracles.trinamic import line_bits, line_bytes, packed
from tests.oracles.trinamic_chip import Chip
from tests.oracles.wire import crc16, frame, step_clocks, vlq

_RANGES = {"%c": (0, 255), "%hu": (0, 65_535), "%hi": (-32_768, 32_767), "%u": (0, 2**32 - 1)}
_MOVES = 459
_UART_LEAD_S = 200e-6
# What a board still takes that has shut down.
_IN_SHUTDOWN = {"identify", "get_config", "get_clock", "get_uptime", "emergency_stop", "reset"}
_IN_SHUTDOWN |= {"config_reset"}
_UART_TIMEOUT, _UART_TURN = 64, 12  # bits: without an answer, and before one begins


@dataclass
class Motor:
    """Executes what it was told; `trsync` is the group that stops it, if any. A motor that was
    stopped takes nothing more before its clock is set anew."""

    position: int = 0
    direction: int = -1  # of what is told next
    at: int = 0  # clock of the last step that it knows of
    coming: deque[tuple[int, int]] = field(default_factory=deque[tuple[int, int]])
    stopped: bool = False
    trsync: int | None = None

    def advance(self, clock: int) -> None:
        while self.coming and self.coming[0][0] <= clock:
            self.position += self.coming.popleft()[1]


@dataclass
class Trsync:
    armed: bool = False
    reason: int = 0
    expire_reason: int = 0
    report_at: int | None = None
    report_ticks: int = 0
    expires_at: int | None = None
    motors: list[int] = field(default_factory=list[int])


@dataclass
class Endstop:
    """`wakes_at` is when it looks next, `next_look` when it would have, had its first look at a
    pressed switch not been followed by others."""

    pin: int
    wakes_at: int | None = None
    next_look: int = 0
    homing: bool = False
    left: int = 0  # looks that must agree yet
    told: dict[str, int] = field(default_factory=dict[str, int])


@dataclass
class Uart:
    pin: int
    bit_ticks: int
    answers_at: int | None = None
    answer: bytes = b""


class KlipperMcu:
    """`said` are all commands with their values; `wrong` is what no host may say, and `late` what
    came too late to be done in time. `analog` is what every analog input reads.

    What hangs on the pins, by their numbers: `levels` of inputs, `uarts` with the chips that share
    one, by their select pins the chips on SPI, and by their addresses those on I2C.
    """

    def __init__(self, told: dict[str, Any], analog: int) -> None:
        self.told = told
        self.analog = analog
        self.said: list[tuple[str, dict[str, int | bytes]]] = []
        self.wrong: list[str] = []
        self.late: list[str] = []
        self.levels: dict[int, Callable[[], int]] = {}
        self.uarts: dict[int, list[Chip]] = {}
        self.spi: dict[int, Chip] = {}
        self.i2c: dict[int, Any] = {}
        self._identify = zlib.compress(json.dumps(told).encode())
        self._commands = {n: _format(text) for text, n in told["commands"].items()}
        self._reports = {
            _format(text)[0]: (n, _format(text)[1]) for text, n in told["responses"].items()
        }
        self._newer = any(key == "values" for key, _ in self._reports["analog_in_state"][1])
        self.hz: int = told["config"]["CLOCK_FREQ"]
        pins = told["enumerations"]["pin"]
        self._numbers = {name: n for name, n in pins.items() if isinstance(n, int)} | {
            f"{stem}{int(number) + i}": first + i
            for name, range_ in pins.items()
            if not isinstance(range_, int)
            for first, count in (range_,)
            for stem, number in re.findall(r"(.*?)(\d+)$", name)
            for i in range(count)
        }
        self._pins = set(self._numbers.values())
        self.now = 0
        self._rest = b""
        self._out = b""
        self.resets = 0
        self.ports = 1  # a Linux process has another one after each restart
        self._begin_anew()

    def pin(self, name: str) -> int:
        return self._numbers[name]

    def _begin_anew(self) -> None:
        self._next = 0
        self.oids, self.crc, self.is_config, self.is_shutdown = 0, 0, 0, 0
        self.of_oid: dict[int, str] = {}
        self.motors: dict[int, Motor] = {}
        self._trsyncs: dict[int, Trsync] = {}
        self._endstops: dict[int, Endstop] = {}
        self._lines: dict[int, Uart] = {}
        self._selects: dict[int, int] = {}
        self._addresses: dict[int, int] = {}
        self._sensors: dict[int, tuple[int, int, int]] = {}  # when next, period, samples

    def feed(self, data: bytes, clock: int) -> None:
        """These bytes have come at that clock."""
        self.advance(clock)
        self._rest += data
        self._take_frames()

    def poll(self, clock: int) -> bytes:
        """What it has said until then."""
        self.advance(clock)
        out, self._out = self._out, b""
        return out

    @property
    def next_deadline(self) -> int | None:
        """When it does something by itself next; its motors aside, which nobody hears."""
        return min((clock for clock, _ in self._due()), default=None)

    def advance(self, clock: int) -> None:
        """Time passes. What is due is done at its time, in the order of that."""
        while True:
            first = min(self._due(), key=lambda event: event[0], default=None)
            if first is None or first[0] > clock:
                break
            self.now = max(self.now, first[0])
            self._move()
            first[1]()
        self.now = max(self.now, clock)
        self._move()

    def _move(self) -> None:
        for motor in self.motors.values():
            motor.advance(self.now)

    def _due(self) -> Iterator[tuple[int, Callable[[], None]]]:
        for oid, (due, _, _) in self._sensors.items():
            yield due, lambda oid=oid: self._report_sensor(oid)
        for endstop in self._endstops.values():
            if endstop.wakes_at is not None:
                yield endstop.wakes_at, lambda it=endstop: self._look(it)
        for oid, group in self._trsyncs.items():
            if group.report_at is not None:
                yield group.report_at, lambda oid=oid, it=group: self._report_group(oid, it)
            if group.expires_at is not None:
                yield group.expires_at, lambda oid=oid, it=group: self._expire(oid, it)
        for oid, line in self._lines.items():
            if line.answers_at is not None:
                yield line.answers_at, lambda oid=oid, it=line: self._answer(oid, it)

    def _take_frames(self) -> None:
        while len(self._rest) >= 5:
            length = self._rest[0]
            if length < 5 or length > 64 or self._rest[1] & 0xF0 != 0x10:
                self._rest = self._rest.partition(b"\x7e")[2]
                self._write(b"")
                continue
            if len(self._rest) < length:
                return
            whole, self._rest = self._rest[:length], self._rest[length:]
            good = crc16(whole[:-3]).to_bytes(2, "big") == whole[-3:-1] and whole[-1] == 0x7E
            if good and whole[1] & 15 == self._next:
                self._next = (self._next + 1) % 16
                before = self.resets
                self._obey(whole[2:-3])
                if self.resets > before:
                    continue  # nobody is there to acknowledge it
            self._write(b"")

    def _write(self, payload: bytes) -> None:
        self._out += frame(payload, self._next)

    def _report(self, name: str, **values: int | bytes) -> None:
        number, parameters = self._reports[name]
        payload = vlq(number)
        for key, _ in parameters:
            value = values[key]
            payload += bytes([len(value)]) + value if isinstance(value, bytes) else vlq(value)
        self._write(payload)

    def _obey(self, payload: bytes) -> None:
        at = 0
        while at < len(payload):
            number, at = _number(payload, at)
            name, parameters = self._commands[number]
            values: dict[str, int | bytes] = {}
            for key, kind in parameters:
                if kind.endswith("s"):
                    values[key] = payload[at + 1 : at + 1 + payload[at]]
                    at += 1 + payload[at]
                    continue
                value, at = _number(payload, at)
                value = value % 2**32 if kind == "%u" else value
                low, high = _RANGES[kind]
                self._demand(low <= value <= high, f"{name}: {key}={value}")
                if key == "pin" or key.endswith("_pin"):
                    self._demand(value in self._pins, f"{name}: there is no pin {value}")
                values[key] = value
            self.said.append((name, values))
            if self.is_shutdown and name not in _IN_SHUTDOWN:
                self._report("is_shutdown", static_string_id=self._why)
            else:
                self._act(name, values)

    def _demand(self, kept: bool, text: str) -> None:
        if not kept:
            self.wrong.append(text)

    def _unwrapped(self, clock: int) -> int:
        """The clock of these 32 bits that is next to now."""
        return self.now + (clock - self.now + 2**31) % 2**32 - 2**31

    def _in_time(self, name: str, clock: int) -> int:
        due = self._unwrapped(clock)
        if due < self.now:
            self.late.append(f"{name}: {self.now - due} ticks")
        return due

    def _act(self, name: str, values: dict[str, Any]) -> None:
        oid = values.get("oid", 0)
        if name.startswith("config_") and name != "config_reset":
            self._demand(not self.is_config and oid < self.oids and oid not in self.of_oid, name)
            self.of_oid[oid] = name
        elif "oid" in values:
            self._demand(oid in self.of_oid, f"{name}: nothing has the oid {oid}")
        elif name == "config_reset" and not self.is_shutdown:
            self.wrong.append("config_reset only available when shutdown")
        action = getattr(self, f"_act_{name}", None)
        if action is not None:
            action(**values)

    # What the words mean, one method each; the others do nothing that a host hears of.

    def _act_identify(self, offset: int, count: int) -> None:
        data = self._identify[offset:][:count]
        self._report("identify_response", offset=offset, data=data)

    def _act_get_uptime(self) -> None:
        self._report("uptime", high=self.now >> 32, clock=self.now % 2**32)

    def _act_get_clock(self) -> None:
        self._report("clock", clock=self.now % 2**32)

    def _act_get_config(self) -> None:
        state = {"is_config": self.is_config, "crc": self.crc, "is_shutdown": self.is_shutdown}
        self._report("config", **state, move_count=_MOVES if self.is_config else 0)

    def _act_allocate_oids(self, count: int) -> None:
        self._demand(self.oids == 0, "oids twice")
        self.oids = count

    def _act_finalize_config(self, crc: int) -> None:
        self._demand(len(self.of_oid) == self.oids, "oids without an object")
        self.is_config, self.crc = 1, crc

    def _act_emergency_stop(self) -> None:
        self._shut_down("Command request")

    def _shut_down(self, why: str) -> None:
        self.is_shutdown = 1
        for motor in self.motors.values():
            motor.coming.clear()
            motor.stopped, motor.trsync = True, None
        for oid in self._trsyncs:
            self._trsyncs[oid] = Trsync()
        self._why = self.told["enumerations"]["static_string_id"][why]
        self._report("shutdown", clock=self.now % 2**32, static_string_id=self._why)

    def _act_reset(self) -> None:
        self.resets += 1
        self._begin_anew()
        self._report("starting")

    def _act_config_reset(self) -> None:
        """A Linux process starts again, on another pty; a PRU only forgets its configuration."""
        if self.told["config"]["MCU"] == "linux":
            self.ports += 1
            self._rest = self._out = b""
            self._act_reset()
            return
        number = self._next
        self.resets += 1
        self._begin_anew()
        self._next = number

    def _act_query_analog_in(self, oid: int, rest_ticks: int, sample_count: int, **_: int) -> None:
        self._sensors[oid] = (self.now + rest_ticks, rest_ticks, sample_count)

    def _report_sensor(self, oid: int) -> None:
        due, period, samples = self._sensors[oid]
        self._sensors[oid] = (due + period, period, samples)
        total = samples * self.analog
        value = {"values": total.to_bytes(2, "little")} if self._newer else {"value": total}
        self._report("analog_in_state", oid=oid, next_clock=(due + period) % 2**32, **value)

    def _act_config_stepper(self, oid: int, **_: int) -> None:
        self.motors[oid] = Motor()

    def _act_reset_step_clock(self, oid: int, clock: int) -> None:
        motor = self.motors[oid]
        self._demand(not motor.coming, "reset_step_clock of a motor that moves")
        motor.at, motor.stopped = self._unwrapped(clock), False

    def _act_set_next_step_dir(self, oid: int, dir: int) -> None:
        self.motors[oid].direction = 1 if dir else -1

    def _act_queue_step(self, oid: int, interval: int, count: int, add: int) -> None:
        motor = self.motors[oid]
        self._demand(count > 0, "no steps")
        if motor.stopped:
            return
        clocks = step_clocks(motor.at, interval, count, add)
        if clocks[0] < self.now:
            self.late.append(f"queue_step: {self.now - clocks[0]} ticks")
        motor.coming += [(clock, motor.direction) for clock in clocks]
        motor.at = clocks[-1]

    def _act_stepper_get_position(self, oid: int) -> None:
        self._report("stepper_position", oid=oid, pos=self.motors[oid].position)

    def _act_stepper_stop_on_trigger(self, oid: int, trsync_oid: int) -> None:
        motor, group = self.motors[oid], self._trsyncs[trsync_oid]
        self._demand(motor.trsync is None, "a motor that another group stops already")
        motor.trsync = trsync_oid
        group.motors.append(oid)

    def _act_config_trsync(self, oid: int) -> None:
        self._trsyncs[oid] = Trsync()

    def _act_trsync_start(
        self, oid: int, report_clock: int, report_ticks: int, expire_reason: int
    ) -> None:
        self._release(self._trsyncs[oid])
        group = self._trsyncs[oid] = Trsync(armed=True, expire_reason=expire_reason)
        if report_ticks:
            group.report_at = self._in_time("trsync_start", report_clock)
            group.report_ticks = report_ticks

    def _act_trsync_set_timeout(self, oid: int, clock: int) -> None:
        if self._trsyncs[oid].armed:
            self._trsyncs[oid].expires_at = self._in_time("trsync_set_timeout", clock)

    def _act_trsync_trigger(self, oid: int, reason: int) -> None:
        group = self._trsyncs[oid]
        self._trigger(group, reason)
        group.report_at = group.expires_at = None
        self._report_trsync(oid, group, 0)

    def _report_trsync(self, oid: int, group: Trsync, clock: int) -> None:
        state = {"can_trigger": int(group.armed), "trigger_reason": group.reason}
        self._report("trsync_state", oid=oid, **state, clock=clock % 2**32)

    def _report_group(self, oid: int, group: Trsync) -> None:
        assert group.report_at is not None
        group.report_at += group.report_ticks
        self._report_trsync(oid, group, self.now)

    def _expire(self, oid: int, group: Trsync) -> None:
        group.expires_at = None
        if self._trigger(group, group.expire_reason):
            self._report_trsync(oid, group, self.now)

    def _trigger(self, group: Trsync, reason: int) -> bool:
        if not group.armed:
            return False
        group.armed, group.reason = False, reason
        for oid in group.motors:
            self.motors[oid].coming.clear()
            self.motors[oid].stopped = True
        self._release(group)
        return True

    def _release(self, group: Trsync) -> None:
        for oid in group.motors:
            self.motors[oid].trsync = None
        group.motors = []

    def _act_config_endstop(self, oid: int, pin: int, **_: int) -> None:
        self._endstops[oid] = Endstop(pin)

    def _act_endstop_home(self, oid: int, clock: int, **told: int) -> None:
        endstop = self._endstops[oid]
        endstop.homing = told["sample_count"] > 0
        endstop.told, endstop.left = told, told["sample_count"]
        endstop.wakes_at = self._in_time("endstop_home", clock) if endstop.homing else None

    def _act_endstop_query_state(self, oid: int) -> None:
        it = self._endstops[oid]
        state = {"homing": int(it.homing), "next_clock": it.next_look % 2**32}
        self._report("endstop_state", oid=oid, **state, pin_value=self._level(it.pin))

    def _level(self, pin: int) -> int:
        return self.levels[pin]() if pin in self.levels else 0

    def _look(self, it: Endstop) -> None:
        assert it.wakes_at is not None
        first = it.left == it.told["sample_count"]
        if first:
            it.next_look = it.wakes_at + it.told["rest_ticks"]
        if self._level(it.pin) != it.told["pin_value"]:
            it.wakes_at, it.left = it.next_look, it.told["sample_count"]
            return
        it.left -= 1
        it.wakes_at += it.told["sample_ticks"]
        if it.left == 0:
            it.wakes_at = None
            oid = it.told["trsync_oid"]
            if self._trigger(self._trsyncs[oid], it.told["trigger_reason"]):
                self._report_trsync(oid, self._trsyncs[oid], self.now)

    def _act_config_tmcuart(self, oid: int, rx_pin: int, bit_time: int, **_: int) -> None:
        self._lines[oid] = Uart(rx_pin, bit_time)

    def _act_tmcuart_send(self, oid: int, write: bytes, read: int) -> None:
        line = self._lines[oid]
        self._demand(len(write) <= 10 and read <= 10, "tmcuart data too large")
        if line.answers_at is not None:
            return  # it is busy, and says nothing
        datagram = line_bytes(write)
        answers = [chip.datagram(datagram) for chip in self.uarts.get(line.pin, [])]
        heard = [packed(line_bits(answer)) for answer in answers if answer]
        self._demand(len(heard) <= 1, "two chips answer at once")
        line.answer = heard[0][:read] if heard and read else b""
        waits = _UART_TURN + 8 * read if heard else _UART_TIMEOUT
        bits = 8 * len(write) + (waits if read else 0)
        line.answers_at = self.now + round(_UART_LEAD_S * self.hz) + bits * line.bit_ticks

    def _answer(self, oid: int, line: Uart) -> None:
        line.answers_at = None
        self._report("tmcuart_response", oid=oid, read=line.answer)

    def _act_config_spi(self, oid: int, pin: int, **_: int) -> None:
        self._selects[oid] = pin

    def _act_spi_send(self, oid: int, data: bytes) -> bytes:
        chip = self.spi.get(self._selects[oid])
        return chip.transfer(data) if chip else bytes(len(data))

    def _act_spi_transfer(self, oid: int, data: bytes) -> None:
        self._report("spi_transfer_response", oid=oid, response=self._act_spi_send(oid, data))

    def _act_i2c_set_bus(self, oid: int, address: int, **_: int) -> None:
        self._addresses[oid] = address

    _act_i2c_set_sw_bus = _act_i2c_set_bus

    def _i2c(self, oid: int, write: bytes, count: int) -> tuple[str, bytes]:
        """How a transfer ends, and the bytes of the chip."""
        chip = self.i2c.get(self._addresses[oid])
        if write or not count:
            if chip is None or not chip.begin(False, self.now):
                return "START_NACK", bytes(count)
            if not all(chip.take(byte, self.now) for byte in write):
                return "NACK", bytes(count)
        if not count:
            return "SUCCESS", b""
        if chip is None or not chip.begin(True, self.now):
            return "START_READ_NACK", bytes(count)
        return "SUCCESS", bytes(chip.give(self.now) for _ in range(count))

    def _act_i2c_transfer(self, oid: int, write: bytes, read_len: int) -> None:
        status, data = self._i2c(oid, write, read_len)
        number = self.told["enumerations"]["i2c_bus_status"][status]
        self._report("i2c_response", oid=oid, i2c_bus_status=number, response=data)

    def _act_i2c_write(self, oid: int, data: bytes) -> None:
        status, _ = self._i2c(oid, data, 0)
        if status != "SUCCESS":
            self._shut_down("I2C NACK")

    def _act_i2c_read(self, oid: int, reg: bytes, read_len: int) -> None:
        status, data = self._i2c(oid, reg, read_len)
        if status != "SUCCESS":
            self._shut_down("I2C NACK")
        else:
            self._report("i2c_read_response", oid=oid, response=data)


def _format(text: str) -> tuple[str, list[tuple[str, str]]]:
    name, *words = text.split(" ")
    return name, [(key, kind) for key, _, kind in (word.partition("=") for word in words)]


def _number(data: bytes, at: int) -> tuple[int, int]:
    """The number at a place, and the place after it."""
    first = data[at]
    value = first & 0x7F
    if first & 0x60 == 0x60:
        value -= 128
    while data[at] & 0x80:
        at += 1
        value = value << 7 | data[at] & 0x7F
    return value, at + 1
