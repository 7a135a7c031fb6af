"""A board that runs Klipper's firmware, as far as a host sees it: in plain Python, on a pty and in
real time, in the words and numbers of a dictionary of that firmware. Nothing of Passo is in it."""

from __future__ import annotations

import json
import os
import select
import threading
import time
import tty
import zlib
from pathlib import Path
from typing import Any

from tests.oracles.wire import crc16, frame, vlq

# Commands, reports and their numbers: of a build of Klipper of September 2025, for a chip where
# `reset` is known by that name. Constants and pins: of one for an ATmega2560.
DICTIONARY: dict[str, Any] = json.loads((Path(__file__).parent / "klipper.json").read_text())
NEWER_SENSORS = {
    "query_analog_in oid=%c clock=%u sample_ticks=%u sample_count=%c rest_ticks=%u min_value=%hu"
    " max_value=%hu range_check_count=%c": "query_analog_in oid=%c clock=%u sample_ticks=%u"
    " sample_count=%c rest_ticks=%u bytes_per_report=%c min_value=%hu max_value=%hu"
    " range_check_count=%c",
    "analog_in_state oid=%c next_clock=%u value=%hu": "analog_in_state oid=%c next_clock=%u"
    " values=%*s",
}
# Of another chip: its constants and pins.
STM32 = {
    "config": {
        "ADC_MAX": 4095,
        "CLOCK_FREQ": 72_000_000,
        "MCU": "stm32f103xe",
        "PWM_MAX": 255,
        "RECEIVE_WINDOW": 192,
        "RESERVE_PINS_USB": "PA11,PA12",
        "STATS_SUMSQ_BASE": 256,
        "STEPPER_STEP_BOTH_EDGE": 1,
    },
    "pin": {"PA0": [0, 16], "PB0": [16, 16], "PC0": [32, 16]},
}
_RANGES = {"%c": (0, 255), "%hu": (0, 65_535), "%hi": (-32_768, 32_767), "%u": (0, 2**32 - 1)}
_MOVES = 459
_TICK_S = 0.002


def dictionary(*, stm32: bool, newer: bool) -> dict[str, Any]:
    """The dictionary of such a board; `newer` in how it speaks of sensors."""
    made = json.loads(json.dumps(DICTIONARY))
    if stm32:
        made["config"] = STM32["config"]
        made["enumerations"]["pin"] = STM32["pin"]
    if newer:
        for part in ("commands", "responses"):
            made[part] = {NEWER_SENSORS.get(text, text): n for text, n in made[part].items()}
    return made


class KlipperBoard:
    """Hosts open the device `path`. `said` are all commands with their values; `wrong` is what no
    host may say. `analog` is what every analog input reads."""

    def __init__(self, told: dict[str, Any], folder: Path, analog: int) -> None:
        self.told = told
        self.analog = analog
        self.said: list[tuple[str, dict[str, int | bytes]]] = []
        self.wrong: list[str] = []
        self._identify = zlib.compress(json.dumps(told).encode())
        self._commands = {n: _format(text) for text, n in told["commands"].items()}
        self._reports = {
            _format(text)[0]: (n, _format(text)[1]) for text, n in told["responses"].items()
        }
        self._hz = told["config"]["CLOCK_FREQ"]
        self._pins = {
            first + i for first, count in told["enumerations"]["pin"].values() for i in range(count)
        }
        self._master, self._slave = os.openpty()
        tty.setraw(self._slave)
        self.path = str(folder / "board")
        Path(self.path).symlink_to(os.ttyname(self._slave))
        self._start = time.monotonic()
        self._rest = b""
        self.resets = 0
        self._begin_anew()
        self._on = True
        self._thread = threading.Thread(target=self._run)
        self._thread.start()

    def _begin_anew(self) -> None:
        self._next = 0
        self.oids, self.crc, self.is_config, self.is_shutdown = 0, 0, 0, 0
        self.of_oid: dict[int, str] = {}
        self.steps: dict[int, int] = {}
        self._direction: dict[int, int] = {}
        self._sensors: dict[int, tuple[float, float, int]] = {}  # when next, period, samples

    def close(self) -> None:
        self._on = False
        self._thread.join()
        os.close(self._master)
        os.close(self._slave)

    def _clock(self) -> int:
        return round((time.monotonic() - self._start) * self._hz)

    def _run(self) -> None:
        while self._on:
            if select.select([self._master], [], [], _TICK_S)[0]:
                self._rest += os.read(self._master, 4096)
                self._take_frames()
            self._report_sensors()

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
                self._write(b"")
                self._obey(whole[2:-3])
            else:
                self._write(b"")

    def _write(self, payload: bytes) -> None:
        os.write(self._master, frame(payload, self._next))

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
            self._act(name, values)

    def _demand(self, kept: bool, text: str) -> None:
        if not kept:
            self.wrong.append(text)

    def _act(self, name: str, values: dict[str, Any]) -> None:
        oid = values.get("oid", 0)
        if name.startswith("config_"):
            self._demand(not self.is_config and oid < self.oids and oid not in self.of_oid, name)
            self.of_oid[oid] = name
        elif "oid" in values:
            self._demand(oid in self.of_oid, f"{name}: nothing has the oid {oid}")
        match name:
            case "identify":
                data = self._identify[values["offset"] :][: values["count"]]
                self._report("identify_response", offset=values["offset"], data=data)
            case "get_uptime":
                self._report("uptime", high=self._clock() >> 32, clock=self._clock() % 2**32)
            case "get_clock":
                self._report("clock", clock=self._clock() % 2**32)
            case "get_config":
                state = {"is_config": self.is_config, "crc": self.crc}
                moves = _MOVES if self.is_config else 0
                self._report("config", **state, is_shutdown=self.is_shutdown, move_count=moves)
            case "allocate_oids":
                self._demand(self.oids == 0, "oids twice")
                self.oids = values["count"]
            case "finalize_config":
                self._demand(len(self.of_oid) == self.oids, "oids without an object")
                self.is_config, self.crc = 1, values["crc"]
            case "emergency_stop":
                self.is_shutdown = 1
                why = self.told["enumerations"]["static_string_id"]["Command request"]
                self._report("shutdown", clock=self._clock() % 2**32, static_string_id=why)
            case "reset":
                self.resets += 1
                self._begin_anew()
            case "query_analog_in":
                period = values["rest_ticks"] / self._hz
                self._sensors[oid] = (time.monotonic() + period, period, values["sample_count"])
            case "set_next_step_dir":
                self._direction[oid] = 1 if values["dir"] else -1
            case "queue_step":
                self._demand(values["count"] > 0, "no steps")
                self.steps[oid] = self.steps.get(oid, 0) + values["count"] * self._direction.get(
                    oid, 0
                )
            case "stepper_get_position":
                self._report("stepper_position", oid=oid, pos=self.steps.get(oid, 0))
            case "endstop_query_state":
                self._report("endstop_state", oid=oid, homing=0, next_clock=0, pin_value=0)
            case _:
                pass

    def _report_sensors(self) -> None:
        newer = any(key == "values" for key, _ in self._reports["analog_in_state"][1])
        for oid, (due, period, samples) in self._sensors.items():
            if time.monotonic() < due:
                continue
            self._sensors[oid] = (due + period, period, samples)
            total = samples * self.analog
            value = {"values": total.to_bytes(2, "little")} if newer else {"value": total}
            self._report("analog_in_state", oid=oid, next_clock=self._clock() % 2**32, **value)


def _format(text: str) -> tuple[str, list[tuple[str, str]]]:
    name, *words = text.split(" ")
    return name, [tuple(word.split("=")) for word in words]


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
