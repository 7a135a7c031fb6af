"""A printer whose board runs Klipper's firmware, in virtual time: drivers with registers, switches,
and a plain-Python microcontroller that knows nothing of Passo."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from tests.config.test_pins import KLIPPER
from tests.hosts.klipper_board import on_its_pins
from tests.oracles.klipper_mcu import KlipperMcu
from tests.oracles.trinamic_chip import Chip

from passo import _core, config
from passo.config.machine import MachineConfig
from passo.printer.wiring import _connected, board_descriptions

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
    """With a machine around it, which stands off its switches at first."""

    def __init__(self, told: dict[str, Any]) -> None:
        super().__init__(told, round(ROOM_C * told["config"]["ADC_MAX"]))
        self._before = dict.fromkeys(SWITCHES, 0)  # steps until the last reset
        self.chips = {"x": Chip("TMC2209"), "y": Chip("TMC2209", 1), "z": Chip("TMC2130")}
        self.uarts = {self._on(told, "PB12"): [self.chips["x"], self.chips["y"]]}
        self.spi = {self._on(told, "PB13"): self.chips["z"]}
        for axis, pin in SWITCHES.items():
            self.levels[self._on(told, pin)] = lambda axis=axis: int(self.place(axis) <= 0)

    def _on(self, told: dict[str, Any], pin: str) -> int:
        return self.pin(on_its_pins(f'"{pin}"', told).strip('"'))

    def place(self, axis: str) -> float:
        """Where the mechanics are, mm from the switch. Motors are configured in their order."""
        oid = list(SWITCHES).index(axis)
        steps = self.motors[oid].position if oid in self.motors else 0
        return START_MM[axis] + (self._before[axis] + steps) / STEPS_PER_MM[axis]

    def _act_reset(self) -> None:
        for oid, axis in enumerate(SWITCHES):
            self._before[axis] += self.motors[oid].position
        super()._act_reset()


class Wire:
    """Carries bytes at once, in virtual time: from deadline to deadline."""

    def __init__(self, link: _core.Link, board: Board, hz: float) -> None:
        self._link, self._board, self.hz = link, board, hz
        self.now = board.now

    def board_clock(self, link: _core.Link) -> int:
        return self.now

    def run(self, until: int, until_heaters: bool) -> _core.Stop:
        while True:
            wake = self._exchange()
            if self._link.shut_down:
                return _core.Stop.SHUTDOWN
            due = self._board.next_deadline
            wake = wake if due is None else min(wake, due)
            if wake > until:
                self.now = max(self.now, until)
                self._board.advance(self.now)
                return _core.Stop.TIME
            self.now = max(self.now, wake)

    def _exchange(self) -> int:
        while True:
            orders, wake = self._link.poll(self.now)
            self._board.feed(orders, self.now)
            said = self._board.poll(self.now)
            if not said:
                return wake
            self._link.feed(said, self.now)


class Port:
    """To that board."""

    live = False
    byte_s = 0.0

    def __init__(self, board: Board) -> None:
        self._board = board

    def open(self) -> None:
        pass

    def attach(self, link: _core.Link) -> Any:
        return Wire(link, self._board, float(self._board.hz))


def connected(board: Board) -> Any:
    """What connects a printer to it."""
    return lambda it: (_connected(board_descriptions(it), [Port(board)]), None)
