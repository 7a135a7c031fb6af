"""The boards of these tests: a RAMPS and a Melzi, and motors on them that belong to no socket."""

from __future__ import annotations

import functools
from collections.abc import Callable
from hashlib import sha256
from pathlib import Path

from tests.support import kept

from passo.board.description import BoardDescription, Stepper
from passo.toolchain.avr import AvrBoard, Motor, build
from passo.toolchain.image import Image

from .bench import AvrBench
from .host import AvrConnection

HZ = 16_000_000
FIRMWARE = Path(__file__).parents[3] / "firmware"
RAMPS_PINS = (("PF0", "PF1"), ("PF6", "PF7"), ("PL3", "PL1"), ("PA4", "PA6"))
MELZI_PINS = (("PD7", "PC5"), ("PC6", "PC7"), ("PB3", "PB2"), ("PB1", "PB0"))
OTHER_PINS = (("PA1", "PA0"), ("PC0", "PC2"), ("PL0", "PL2"))
RAMPS = AvrBoard("atmega2560", tuple(Motor(*pins) for pins in RAMPS_PINS))
MELZI = AvrBoard("atmega1284p", tuple(Motor(*pins) for pins in MELZI_PINS))


@functools.cache
def image(board: AvrBoard, make: Callable[..., Image] = build) -> Image:
    """The board's image; built once."""
    how = repr((board, make.__module__))
    return kept.kept(
        f"image-{sha256(how.encode()).hexdigest()[:12]}",
        (how, *kept.FIRMWARE),
        ["avr-gcc"],
        lambda folder: make(board, FIRMWARE, folder, "test"),
    )


def bench(board: AvrBoard = RAMPS, make: Callable[..., Image] = build) -> AvrBench:
    return AvrBench(image(board, make).elf, board.mcu, board.clock_hz)


def motors(
    count: int,
    board: AvrBoard = RAMPS,
    pins: tuple[tuple[str, str], ...] = RAMPS_PINS,
    pulse_ticks: int = 32,
) -> AvrConnection:
    """A connected board with so many motors, m0 on; their step pins are watched."""
    steppers = tuple(
        Stepper(f"m{i}", step, direction, pulse_ticks=pulse_ticks)
        for i, (step, direction) in enumerate(pins[:count])
    )
    chip = bench(board)
    connection = AvrConnection(BoardDescription(HZ, steppers, mcu=board.mcu), chip)
    connection.connect()
    chip.watch(step for step, _ in pins[:count])
    return connection
