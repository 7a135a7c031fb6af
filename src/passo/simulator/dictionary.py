"""The data dictionary of the simulated board, in the format of a real board."""

from __future__ import annotations

import json
import zlib
from functools import cache
from pathlib import Path
from typing import Any, Literal, TypeAlias

from passo import _core
from passo.board.description import BoardDescription, bare
from passo.version import __version__

Firmware: TypeAlias = Literal["virtual", "passo"]

ADC_MAX = 1023
PWM_MAX = 255
RECEIVE_WINDOW = 192


def pin_numbers(board: BoardDescription) -> dict[str, int]:
    """Numbers of the pins that the description names, in the order of their names."""
    return {name: i for i, name in enumerate(sorted({bare(pin) for pin in board.pins}))}


def firmware_library() -> Path:
    """The path of the firmware as a library; the build of the package puts it next to the core."""
    return Path(_core.__file__).with_name("firmware_host.so")


def compressed_dictionary(board: BoardDescription, firmware: Firmware = "virtual") -> bytes:
    """zlib-compressed JSON; the same bytes for the same description."""
    raw = _virtual() if firmware == "virtual" else _firmware()
    raw["enumerations"]["pin"] = pin_numbers(board)
    raw["config"] |= {"CLOCK_FREQ": board.clock_hz, "MCU": board.mcu}
    return zlib.compress(json.dumps(raw, sort_keys=True).encode(), 9)


def firmware_faults() -> dict[int, str]:
    """The shutdown reasons of the firmware, by their numbers."""
    reasons = _firmware()["enumerations"]["static_string_id"]
    return {number: text for text, number in reasons.items()}


def _firmware() -> dict[str, Any]:
    """The declarations of the firmware's sources."""
    return json.loads(_declared(firmware_library()))


@cache
def _declared(library: Path) -> bytes:
    return zlib.decompress(_core.firmware_dictionary(str(library)))


def _virtual() -> dict[str, Any]:
    return {
        "app": "Passo virtual board",
        "version": __version__,
        "license": "Apache-2.0",
        "build_versions": "",
        "commands": {text: number for number, text in _core.board_commands()},
        "responses": {text: number for number, text in _core.board_reports()},
        "enumerations": {
            "static_string_id": {
                text: number for number, text in enumerate(_core.board_faults()) if text
            },
            "thermocouple_type": {"MAX31855": 0, "MAX31856": 1, "MAX31865": 2, "MAX6675": 3},
            "bus_oid_type": {"spi": 0, "i2c": 1},
            "i2c_bus_status": {
                "SUCCESS": 0,
                "NACK": 1,
                "BUS_TIMEOUT": 2,
                "START_NACK": 3,
                "START_READ_NACK": 4,
            },
            "lis_chip_type": {"LIS2DW": 0},
            "trigger_analog_type": {"abs_ge": 0, "gt": 1, "diff_peak_gt": 2},
        },
        "config": {
            "ADC_MAX": ADC_MAX,
            "PWM_MAX": PWM_MAX,
            "RECEIVE_WINDOW": RECEIVE_WINDOW,
            "STATS_SUMSQ_BASE": 256,
        },
    }
