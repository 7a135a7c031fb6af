"""The data dictionary of the simulated board, as a real board would carry it."""

from __future__ import annotations

import json
import zlib
from typing import Any

from passo import __version__, _core
from passo.board.description import BoardDescription, bare

ADC_MAX = 1023
PWM_MAX = 255
RECEIVE_WINDOW = 192


def pin_numbers(board: BoardDescription) -> dict[str, int]:
    """Numbers of the pins that the description names, in the order of their names."""
    return {name: i for i, name in enumerate(sorted({bare(pin) for pin in board.pins}))}


def compressed_dictionary(board: BoardDescription) -> bytes:
    """zlib-compressed JSON; the same bytes for the same description."""
    raw: dict[str, Any] = {
        "app": "Passo virtual board",
        "version": __version__,
        "license": "Apache-2.0",
        "build_versions": "",
        "commands": {text: number for number, text in _core.board_commands()},
        "responses": {text: number for number, text in _core.board_reports()},
        "enumerations": {
            "pin": pin_numbers(board),
            "static_string_id": {
                text: number for number, text in enumerate(_core.board_faults()) if text
            },
        },
        "config": {
            "CLOCK_FREQ": board.clock_hz,
            "MCU": board.mcu,
            "ADC_MAX": ADC_MAX,
            "PWM_MAX": PWM_MAX,
            "RECEIVE_WINDOW": RECEIVE_WINDOW,
            "STATS_SUMSQ_BASE": 256,
        },
    }
    return zlib.compress(json.dumps(raw, sort_keys=True).encode(), 9)
