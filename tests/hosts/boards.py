"""Boards at one end of a pty, with carriages that press the switches of `kalico.cfg`."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple, Protocol

from tests.firmware.simavr.bench import AvrBench, pin_number
from tests.hosts.shared_clock import SharedClock, SharedLine


class Motor(NamedTuple):
    """A motor's pins, its carriage's switch (one that nothing asks: none), and how many steps it
    stands above that."""

    step: str
    direction: str
    switch: str
    above: int


MOTORS = {
    "x": Motor("PF0", "PF1", "PE5", 1600),
    "y": Motor("PF6", "PF7", "PJ1", 800),
    "z": Motor("PL3", "PL1", "PD3", 2000),
    "e": Motor("PA4", "PA6", "PA5", 0),
}
ROOM_COUNTS = 977  # of 1023: 25 °C, by the thermistors of `kalico.cfg`


class Moved(NamedTuple):
    """Where a motor's carriage is above its switch, and how many steps brought it there."""

    position: int
    steps: int


class PtyBoard(Protocol):
    """A board that hosts reach at the serial device `path`."""

    path: str

    def moved(self) -> dict[str, Moved]: ...
    def close(self) -> None: ...


class ProcessBoard:
    """The firmware as a process of its own; in real time without a shared clock."""

    def __init__(self, program: Path, folder: Path, clock: SharedClock | None = None) -> None:
        self.path = str(folder / "board")
        words = [program, self.path, ROOM_COUNTS]
        for m in MOTORS.values():
            words += [*map(pin_number, (m.step, m.direction, m.switch)), m.above]
        self._process = subprocess.Popen(
            list(map(str, words)),
            env=clock.environment if clock else None,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self._ask()  # it answers when the device is there

    def _ask(self) -> list[int]:
        assert self._process.stdin and self._process.stdout
        self._process.stdin.write("\n")
        self._process.stdin.flush()
        return [int(word) for word in self._process.stdout.readline().split()]

    def moved(self) -> dict[str, Moved]:
        reason, *numbers = self._ask()
        assert reason == 0  # it has not shut down
        return dict(zip(MOTORS, map(Moved, numbers[::2], numbers[1::2]), strict=True))

    def close(self) -> None:
        self._process.communicate()
        assert self._process.returncode == 0
        Path(self.path).unlink()


class AvrOnPty:
    """A simulated AVR that runs the firmware's image. `world` is called once a millisecond."""

    def __init__(self, bench: AvrBench, clock: SharedClock) -> None:
        self.bench = bench
        self.world: list[Callable[[], None]] = []
        for channel in (13, 14):
            bench.set_voltage(channel, 5 * ROOM_COUNTS / 1023)
        self._carriages = {
            name: bench.add_carriage(m.step, m.direction, m.above, m.switch)
            for name, m in MOTORS.items()
        }
        self._line = SharedLine(clock, self, bench.hz)
        self.path = self._line.path
        self.look = self._line.look

    def poll(self, now: int) -> bytes:
        self.bench.run(now)
        for part in self.world:
            part()
        return self.bench.receive()

    def feed(self, data: bytes, now: int) -> None:
        self.bench.run(now)
        self.bench.send(data)

    def moved(self) -> dict[str, Moved]:
        return self.look(
            lambda: {
                name: Moved(self.bench.position(c), self.bench.rises(MOTORS[name].step))
                for name, c in self._carriages.items()
            }
        )

    def close(self) -> None:
        self._line.close()
        self.bench.close()
