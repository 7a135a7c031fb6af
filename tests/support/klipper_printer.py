"""A printer whose board runs Klipper's firmware, in virtual time: drivers with registers, switches,
and a plain-Python microcontroller that knows nothing of Passo."""

from __future__ import annotations

import json
from dataclasses import dataclass
from math import ceil
from pathlib import Path
from typing import Any

from tests.config.test_pins import KLIPPER
from tests.oracles.klipper_mcu import KlipperMcu
from tests.oracles.trinamic_chip import Chip
from tests.support.klipper_board import on_its_pins

from passo import _core, config
from passo.config.machine import MachineConfig
from passo.printer.setup.boards import board_descriptions
from passo.printer.setup.connections import _connected

# x and y share a UART of one pin, z is on an SPI bus.
DRIVERS = {
    "x": 'driver = "TMC2209"\ntmc = { run_current_a = 0.8, uart_pin = "^PB12" }\n',
    "y": 'driver = "TMC2209"\ntmc = { run_current_a = 0.6, uart_pin = "^PB12", address = 1 }\n',
    "z": 'driver = "TMC2130"\ntmc = { run_current_a = 0.5, cs_pin = "PB13", clock_pin = "PB14",'
    ' mosi_pin = "PB15", miso_pin = "PA2" }\n',
}
SWITCHES = {"x": "PA8", "y": "PA9", "z": "PA10"}  # high where they are pressed
START_MM = {"x": 12.0, "y": 7.0, "z": 3.0}
STEPS_PER_MM = {"x": 80.0, "y": 80.0, "z": 400.0}
ROOM_C = 0.95  # of what the analog inputs read


def machine(told: dict[str, Any], folder: Path) -> MachineConfig:
    (folder / "board.dict").write_text(json.dumps(told))
    text = KLIPPER
    for motor, driver in DRIVERS.items():
        text = text.replace(f"[steppers.{motor}]\n", f"[steppers.{motor}]\n{driver}")
    return config.load_text(on_its_pins(text, told), str(folder / "my.toml"))


class Board(KlipperMcu):
    """With a machine around it, which stands off its switches at first. `axes` are those whose
    motors it has, configured in their order; their switches hang on it too, or are hung."""

    def __init__(self, told: dict[str, Any], axes: str = "xyz") -> None:
        super().__init__(told, round(ROOM_C * told["config"]["ADC_MAX"]))
        self.axes = axes
        self._before = dict.fromkeys(axes, 0)  # steps until the last reset
        self.chips = {"x": Chip("TMC2209"), "y": Chip("TMC2209", 1), "z": Chip("TMC2130")}
        self.uarts = {self._on("PB12"): [self.chips["x"], self.chips["y"]]}
        self.spi = {self._on("PB13"): self.chips["z"]}
        for axis in axes:
            self.hang(axis, self)

    def _on(self, pin: str) -> int:
        return self.pin(on_its_pins(f'"{pin}"', self.told).strip('"'))

    def hang(self, axis: str, moved_by: Board) -> None:
        """The axis' switch here, which its motor there brings to it."""
        self.levels[self._on(SWITCHES[axis])] = lambda: int(moved_by.place(axis) <= 0)

    def place(self, axis: str) -> float:
        """Where the mechanics are, mm from the switch."""
        oid = self.axes.index(axis)
        steps = self.motors[oid].position if oid in self.motors else 0
        return START_MM[axis] + (self._before[axis] + steps) / STEPS_PER_MM[axis]

    def _act_reset(self) -> None:
        for oid, axis in enumerate(self.axes):
            self._before[axis] += self.motors[oid].position
        super()._act_reset()


@dataclass
class End:
    """A board at its link. Its own clock ran for `start_s` before, and runs fast by `drift`."""

    link: _core.Link
    board: Board
    start_s: float = 0.0
    drift: float = 0.0
    cut: bool = False  # nothing comes through
    port: int = 1  # of the board's, since it restarts

    def clock(self, host: int) -> int:
        """The board's clock at host time."""
        return int(host * (1 + self.drift) + self.start_s * self.board.hz)

    def host(self, clock: int) -> int:
        """The host time at which the board's clock reads so."""
        return ceil((clock - self.start_s * self.board.hz) / (1 + self.drift))


class Wire:
    """Carries bytes at once, in virtual time, which is that of the first board: from deadline to
    deadline."""

    def __init__(self, ends: list[End]) -> None:
        self._ends = ends
        self.hz = float(ends[0].board.hz)
        self.now = ends[0].board.now

    def board_clock(self, link: _core.Link) -> int:
        return next(end.clock(self.now) for end in self._ends if end.link is link)

    def run(self, until: int, until_heaters: bool) -> _core.Stop:
        while True:
            wake = self._exchange()
            if any(end.port != end.board.ports for end in self._ends):
                return _core.Stop.CLOSED
            if any(end.link.shut_down for end in self._ends):
                return _core.Stop.SHUTDOWN
            deadlines = [(end, end.board.next_deadline) for end in self._ends]
            due = (end.host(clock) for end, clock in deadlines if clock is not None)
            wake = min(wake, *due, until + 1)
            if wake > until:
                self.now = max(self.now, until)
                for end in self._ends:
                    end.board.advance(end.clock(self.now))
                return _core.Stop.TIME
            self.now = max(self.now, wake)

    def _exchange(self) -> int:
        """Until nobody says anything more: what one board tells may concern another."""
        while True:
            wakes, heard = [], False
            for end in self._ends:
                orders, wake = end.link.poll(self.now)
                wakes.append(wake)
                if end.port != end.board.ports:
                    continue
                end.board.feed(b"" if end.cut else orders, end.clock(self.now))
                said = end.board.poll(end.clock(self.now))
                if end.cut:
                    continue
                if said:
                    end.link.feed(said, self.now)
                heard |= bool(orders or said)
            if not heard:
                return min(wakes)


class Port:
    """To that board, in the time of the one `beside` which it works."""

    live = False
    byte_s = 0.0

    def __init__(
        self,
        board: Board,
        beside: Port | None = None,
        *,
        start_s: float = 0.0,
        drift: float = 0.0,
    ) -> None:
        self._board, self._beside = board, beside
        self._start_s, self._drift = start_s, drift
        self._ends: list[End] = []
        self.end: End | None = None

    def open(self, timeout_s: float = 0.0) -> None:
        pass

    def attach(self, link: _core.Link) -> Any:
        self.end = end = End(link, self._board, self._start_s, self._drift, port=self._board.ports)
        if self._beside is None:
            self._ends = [end]
            self._wire = Wire(self._ends)
            return self._wire
        self._beside._ends.append(end)
        return self._beside._wire


def connected(*ports: Port) -> Any:
    """What connects a printer to them, the main one first."""
    return lambda it: (_connected(board_descriptions(it), ports), None)
