"""A simulated AVR on a bench: its image runs cycle by cycle, its pins can be watched and driven."""

from __future__ import annotations

import ctypes
import functools
import subprocess
import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

SOURCE = Path(__file__).with_name("bench.c")
FLAGS = ["-O2", "-Wall", "-Wextra", "-std=gnu11", "-shared", "-fPIC"]
ROOM = 1 << 20
NOTHING, EDGES, RISES = range(3)


class Edge(NamedTuple):
    cycle: int
    pin: str
    level: int


class _Edge(ctypes.Structure):
    _fields_ = [
        ("cycle", ctypes.c_uint64),
        ("pin", ctypes.c_uint16),
        ("level", ctypes.c_uint16),
    ]


@functools.cache
def _library() -> ctypes.CDLL:
    folder = tempfile.TemporaryDirectory(prefix="passo-bench-")
    path = Path(folder.name) / "bench.so"
    subprocess.run(["gcc", *FLAGS, SOURCE, "-lsimavr", "-lelf", "-o", path], check=True)
    library = ctypes.CDLL(str(path))
    folder.cleanup()
    number, pointer, text = ctypes.c_uint64, ctypes.c_void_p, ctypes.c_char_p
    position = ctypes.c_int64
    signatures = {
        "new": (pointer, [text, text, ctypes.c_uint32, ctypes.c_uint32]),
        "free": (None, [pointer]),
        "run": (ctypes.c_int, [pointer, number]),
        "cycle": (number, [pointer]),
        "send": (None, [pointer, text, ctypes.c_int]),
        "receive": (ctypes.c_int, [pointer, pointer, ctypes.c_int]),
        "watch": (None, [pointer, ctypes.c_int, ctypes.c_int]),
        "set_pin": (None, [pointer, ctypes.c_int, ctypes.c_int]),
        "level": (ctypes.c_int, [pointer, ctypes.c_int]),
        "set_voltage": (None, [pointer, ctypes.c_int, ctypes.c_int]),
        "interrupt_cycles": (number, [pointer]),
        "rises": (number, [pointer, ctypes.c_int]),
        "high_cycles": (number, [pointer, ctypes.c_int]),
        "add_carriage": (
            ctypes.c_int,
            [pointer, ctypes.c_int, ctypes.c_int, position, ctypes.c_int, position, ctypes.c_int],
        ),
        "position": (position, [pointer, ctypes.c_int]),
        "edges": (ctypes.POINTER(_Edge), [pointer, ctypes.POINTER(ctypes.c_uint32)]),
        "edges_lost": (number, [pointer]),
        "entries": (number, [pointer]),
        "rescues": (number, [pointer]),
        "revivals": (number, [pointer]),
        "siblings": (number, [pointer]),
        "channels": (number, [pointer]),
        "hang": (ctypes.c_int, [pointer]),
        "ram": (ctypes.c_uint8, [pointer, ctypes.c_int]),
    }
    for name, (result, arguments) in signatures.items():
        function = getattr(library, f"bench_{name}")
        function.restype, function.argtypes = result, arguments
    return library


def pin_number(name: str) -> int:
    """`PB3` is 11: eight pins a port, from port A on."""
    return "ABCDEFGHIJKL".index(name[1]) * 8 + int(name[2])


def pin_name(number: int) -> str:
    return f"P{'ABCDEFGHIJKL'[number // 8]}{number % 8}"


class AvrBench:
    """One chip that runs an image; time is counted in its cycles and passes in `run` only.

    The defects of the simulator that it makes up for are listed in bench.c. `entries`, `rescues`,
    `revivals`, `siblings` and `channels` count how often it did.
    """

    def __init__(self, image: Path, mcu: str = "atmega2560", hz: int = 16_000_000) -> None:
        self._library = _library()
        self._bench = self._library.bench_new(str(image).encode(), mcu.encode(), hz, ROOM)
        if not self._bench:
            raise ValueError(f"{image} does not run on a simulated {mcu}")
        self._buffer = ctypes.create_string_buffer(1 << 16)
        self.hz = hz

    def close(self) -> None:
        self._library.bench_free(self._bench)
        self._bench = None

    def __enter__(self) -> AvrBench:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def cycle(self) -> int:
        return self._library.bench_cycle(self._bench)

    @property
    def interrupt_cycles(self) -> int:
        """Cycles spent in interrupts since the start, from entry to return."""
        return self._library.bench_interrupt_cycles(self._bench)

    @property
    def entries(self) -> int:
        return self._library.bench_entries(self._bench)

    @property
    def rescues(self) -> int:
        return self._library.bench_rescues(self._bench)

    @property
    def revivals(self) -> int:
        return self._library.bench_revivals(self._bench)

    @property
    def siblings(self) -> int:
        return self._library.bench_siblings(self._bench)

    @property
    def channels(self) -> int:
        return self._library.bench_channels(self._bench)

    def run(self, until: int) -> None:
        """Until a cycle; raises AssertionError if the chip crashes."""
        assert self._library.bench_run(self._bench, until), f"crashed at cycle {self.cycle}"

    def run_for(self, cycles: int) -> None:
        self.run(self.cycle + cycles)

    def send(self, data: bytes) -> None:
        self._library.bench_send(self._bench, data, len(data))

    def receive(self) -> bytes:
        count = self._library.bench_receive(self._bench, self._buffer, len(self._buffer))
        return self._buffer.raw[:count]

    def watch(self, pins: Iterable[str], what: int = EDGES) -> None:
        """Traces all edges of these pins, or `RISES` or `NOTHING` of them."""
        for pin in pins:
            self._library.bench_watch(self._bench, pin_number(pin), what)

    def rises(self, pin: str) -> int:
        """Rising edges since the start."""
        return self._library.bench_rises(self._bench, pin_number(pin))

    def edges(self) -> list[Edge]:
        """The edges of the watched pins since the last call; none may have been lost."""
        count = ctypes.c_uint32()
        edges = self._library.bench_edges(self._bench, ctypes.byref(count))
        assert self._library.bench_edges_lost(self._bench) == 0
        return [Edge(e.cycle, pin_name(e.pin), e.level) for e in edges[: count.value]]

    def set_pin(self, pin: str, level: bool) -> None:
        self._library.bench_set_pin(self._bench, pin_number(pin), level)

    def level(self, pin: str) -> int:
        return self._library.bench_level(self._bench, pin_number(pin))

    def set_voltage(self, channel: int, volts: float) -> None:
        """What an analog input sees; full scale is 5 V."""
        self._library.bench_set_voltage(self._bench, channel, round(volts * 1000))

    def high_cycles(self, pin: str) -> int:
        """Cycles for which the pin has been high since the start."""
        return self._library.bench_high_cycles(self._bench, pin_number(pin))

    def add_carriage(
        self,
        step_pin: str,
        dir_pin: str,
        position: int = 0,
        switch_pin: str | None = None,
        pressed_below: int = 0,
        pressed_level: int = 1,
    ) -> int:
        """A carriage `position` steps from zero whose switch is pressed below `pressed_below`."""
        return self._library.bench_add_carriage(
            self._bench,
            pin_number(step_pin),
            pin_number(dir_pin),
            position,
            -1 if switch_pin is None else pin_number(switch_pin),
            pressed_below,
            pressed_level,
        )

    def position(self, carriage: int) -> int:
        """Where a carriage is, in steps."""
        return self._library.bench_position(self._bench, carriage)

    def ram(self, address: int, size: int = 1) -> int:
        """A little-endian number in the chip's memory."""
        parts = (self._library.bench_ram(self._bench, address + i) for i in range(size))
        return sum(byte << 8 * i for i, byte in enumerate(parts))

    def hang(self) -> None:
        """The foreground goes round and round in one place; interrupts come as before."""
        assert self._library.bench_hang(self._bench)
