"""A board that runs Klipper's firmware, as far as a host sees it, on a pty and in real time, in the
words and numbers of a dictionary of that firmware; and a machine on such a board."""

from __future__ import annotations

import json
import os
import re
import select
import threading
import time
import tty
from pathlib import Path
from typing import Any

from tests.oracles.klipper_mcu import KlipperMcu

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
NEWER_I2C = {
    "i2c_write oid=%c data=%*s": "i2c_transfer oid=%c write=%*s read_len=%u",
    "i2c_read_response oid=%c response=%*s": "i2c_response oid=%c i2c_bus_status=%c response=%*s",
}
I2C_STATUS = ("SUCCESS", "NACK", "BUS_TIMEOUT", "START_NACK", "START_READ_NACK")
OLDER_I2C = "i2c_read oid=%c reg=%*s read_len=%u"
# Words of builds for chips that may have an accelerometer; the numbers are ours.
ACCELEROMETERS = {
    "commands": {
        "config_adxl345 oid=%c spi_oid=%c": 80,
        "query_adxl345 oid=%c rest_ticks=%u": 81,
        "query_adxl345_status oid=%c": 82,
        "config_lis2dw oid=%c bus_oid=%c bus_oid_type=%c lis_chip_type=%c": 83,
        "query_lis2dw oid=%c rest_ticks=%u": 84,
        "query_lis2dw_status oid=%c": 85,
    },
    "responses": {
        "sensor_bulk_data oid=%c sequence=%hu data=%*s": 86,
        "sensor_bulk_status oid=%c clock=%u query_ticks=%u next_sequence=%hu buffered=%u"
        " possible_overflows=%hu": 87,
    },
}
# Words of builds with eddy current sensors: those of all, and those of 2026 in place of a trigger
# for this chip alone.
EDDIES = {
    "config_ldc1612 oid=%c i2c_oid=%c": 90,
    "config_ldc1612_with_intb oid=%c i2c_oid=%c intb_pin=%c": 91,
    "query_ldc1612 oid=%c rest_ticks=%u": 92,
    "query_status_ldc1612 oid=%c": 93,
}
OLDER_TRIGGER = {
    "ldc1612_setup_home oid=%c clock=%u threshold=%u trsync_oid=%c trigger_reason=%c"
    " error_reason=%c": 94,
}
TRIGGERS = {
    "ldc1612_attach_trigger_analog oid=%c trigger_analog_oid=%c": 94,
    "config_sos_filter oid=%c max_sections=%c": 95,
    "sos_filter_set_offset_scale oid=%c offset=%i scale=%i scale_frac_bits=%c auto_offset=%c": 96,
    "config_trigger_analog oid=%c sos_filter_oid=%c": 97,
    "trigger_analog_set_raw_range oid=%c raw_min=%i raw_max=%i": 98,
    "trigger_analog_set_trigger oid=%c trigger_analog_type=%c trigger_value=%i": 99,
    "trigger_analog_home oid=%c trsync_oid=%c trigger_reason=%c error_reason=%c clock=%u"
    " monitor_ticks=%u monitor_max=%u": 100,
    "trigger_analog_query_state oid=%c": 101,
}
TRIGGER_STATE = {"trigger_analog_state oid=%c homing=%c homing_clock=%u": 102}
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
    "pin": {f"P{port}0": [16 * i, 16] for i, port in enumerate("ABCDE")} | {"ADC_TEMPERATURE": 254},
}
# The same parts on the pins of a RAMPS.
# A process on a Linux computer, and a PRU of a BeagleBone: they have no `reset`, their pins other
# names, and one of these has a name of two parts.
LINUX = {
    "config": {
        "ADC_MAX": 4095,
        "CLOCK_FREQ": 50_000_000,
        "MCU": "linux",
        "PWM_MAX": 32768,
        "STATS_SUMSQ_BASE": 256,
    },
    "pin": {
        "analog0": [4096, 8],
        "gpio0": [0, 288],
        **{f"gpiochip{i}/gpio0": [288 * i, 288] for i in range(9)},
        **{f"pwmchip{i}/pwm0": [8192 + 16 * i, 16] for i in range(8)},
    },
}
PRU = {
    "config": {
        "ADC_MAX": 4095,
        "CLOCK_FREQ": 200_000_000,
        "MCU": "pru",
        "RECEIVE_WINDOW": 495,
        "STATS_SUMSQ_BASE": 256,
    },
    "pin": {"AIN0": [128, 8], **{f"gpio{i}_0": [32 * i, 32] for i in range(4)}},
}
_OTHERS = {"stm32": STM32, "linux": LINUX, "pru": PRU}
AVR_PINS = {
    "PB0": "PF0",
    "PB1": "PF1",
    "PB2": "PD7",
    "PB3": "PF6",
    "PB4": "PF7",
    "PB5": "PF2",
    "PB6": "PL3",
    "PB7": "PL1",
    "PB8": "PK0",
    "PB9": "PA4",
    "PB10": "PA6",
    "PB11": "PC3",
    "PA5": "PB4",
    "PA0": "PK5",
    "PA6": "PH5",
    "PA1": "PK6",
    "PA7": "PH6",
    "PA8": "PE5",
    "PA9": "PJ1",
    "PA10": "PD3",
    "PB12": "PG5",
    "PB13": "PG1",
    "PB14": "PL5",
    "PB15": "PL7",
    "PA2": "PL6",
}
_TICK_S = 0.002


def dictionary(*, chip: str, newer: bool) -> dict[str, Any]:
    """The dictionary of such a board with the chip `avr`, `stm32`, `linux` or `pru`; `newer` in how
    it speaks of sensors and I2C."""
    made = json.loads(json.dumps(DICTIONARY))
    if chip in _OTHERS:
        made["config"] = _OTHERS[chip]["config"]
        made["enumerations"]["pin"] = _OTHERS[chip]["pin"]
    if chip in ("linux", "pru"):
        commands = {text.replace("pin=%c", "pin=%u"): n for text, n in made["commands"].items()}
        commands["config_reset"] = commands.pop("reset")
        made["commands"] = commands
    made["enumerations"]["i2c_bus"] = {"i2c1_PB6_PB7": 0, "i2c2": 1, "twi": 2}
    made["enumerations"]["static_string_id"]["I2C NACK"] = 250
    if newer:
        made["enumerations"]["i2c_bus_status"] = {name: i for i, name in enumerate(I2C_STATUS)}
        for part in ("commands", "responses"):
            words = {**NEWER_SENSORS, **NEWER_I2C}
            made[part] = {words.get(text, text): n for text, n in made[part].items()}
            made[part].pop(OLDER_I2C, None)
            made[part] |= ACCELEROMETERS[part]
        made["commands"] |= EDDIES | TRIGGERS
        made["responses"] |= TRIGGER_STATE
        made["enumerations"]["trigger_analog_type"] = {"abs_ge": 0, "gt": 1, "diff_peak_gt": 2}
    return made


class KlipperBoard(KlipperMcu):
    """Hosts open the device `path`."""

    def __init__(self, told: dict[str, Any], folder: Path, analog: int) -> None:
        super().__init__(told, analog)
        self.path = str(folder / "board")
        self._open()
        self._start = time.monotonic()
        self._on = True
        self._lock = threading.Lock()
        self._thread = threading.Thread(target=self._run)
        self._thread.start()

    def _open(self) -> None:
        self._port = self.ports
        self._master, self._slave = os.openpty()
        tty.setraw(self._slave)
        Path(self.path).unlink(missing_ok=True)
        Path(self.path).symlink_to(os.ttyname(self._slave))

    def close(self) -> None:
        self._on = False
        self._thread.join()
        self._hang_up()

    def _hang_up(self) -> None:
        os.close(self._master)
        os.close(self._slave)

    @property
    def steps(self) -> dict[int, int]:
        """Steps forward less steps backward, by motors' oids."""
        with self._lock:
            self.advance(self._clock())
            return {oid: motor.position for oid, motor in self.motors.items()}

    def _clock(self) -> int:
        return round((time.monotonic() - self._start) * self.hz)

    def _run(self) -> None:
        while self._on:
            data = b""
            if select.select([self._master], [], [], _TICK_S)[0]:
                data = os.read(self._master, 4096)
            with self._lock:
                self.feed(data, self._clock())
                said = self.poll(self._clock())
            if self._port != self.ports:
                self._hang_up()
                time.sleep(0.2)  # the process starts
                self._open()
            os.write(self._master, said)


def on_its_pins(text: str, told: dict[str, Any]) -> str:
    """The text of a machine with other pins if the board's chip asks for them."""
    names = {"atmega2560": AVR_PINS.get, "linux": _on_linux, "pru": _on_pru}
    name = names.get(told["config"]["MCU"], str)
    return re.sub(r'(?<="|!|\^)P[AB]\d+(?=")', lambda pin: name(pin[0]) or "", text)


def _on_linux(pin: str) -> str:
    if pin in ("PA0", "PA1"):
        return f"analog{pin[2:]}"
    return f"gpiochip0/gpio{pin[2:]}" if pin[1] == "A" else f"gpiochip1/gpio{pin[2:]}"


def _on_pru(pin: str) -> str:
    if pin in ("PA0", "PA1"):
        return f"AIN{pin[2:]}"
    return f"gpio0_{pin[2:]}" if pin[1] == "A" else f"gpio1_{pin[2:]}"
