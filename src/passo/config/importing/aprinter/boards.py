"""APrinter's boards and pins on Passo's board files."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from passo.config.board_files import load_board
from passo.config.importing.draft import bad
from passo.config.pin_names import bare
from passo.errors import ConfigError

if TYPE_CHECKING:
    from passo.config.importing.aprinter.document import Node

BOARDS = {
    "RADDS": "radds",
    "RAMPS-FD": "ramps-fd",
    "4pi": "4pi",
    "Teensy 3": "teensy3-mk20dx256",
    "RAMPS 1.3": "ramps",
    "Melzi": "melzi",
    "STM32F429I-Discovery": "stm32f429-discovery",
    "STM32F407-Discovery": "stm32f407-discovery",
    "Duet v0.6": "duet-0.6",
}
_PIN = re.compile(r"(?:Due|Mega|Teensy)Pin(A?)(\d+)|\w+<\w+?([A-K]), *(\d+)>")
_INVERTED = ("OutputInvert", "Invert")


class Pins:
    """The ports, inputs and outputs of a board, by their names in the document."""

    def __init__(self, document: Node, name: Node, base: str | None = None) -> None:
        base = base or BOARDS.get(str(name.scalar))
        boards = [b for b in document.each("boards") if b.text("name") == name.scalar]
        if base is None or not boards:
            limit, place = ", ".join(BOARDS), name.place
            raise ConfigError.of(
                "import.board", place.file, place.line, value=str(name.scalar)[:40], limit=limit
            )
        self.base, self.board, self._node = base, load_board(base), boards[0]

    def motor(self, port: Node) -> dict[str, str]:
        """The socket of a stepper port, or its pins if no socket of the board has this wiring."""
        found = self._found("stepper_ports", port)
        keys = {"step": "StepPin", "direction": "DirPin", "enable": "EnablePin"}
        pins = {key: self._pin(found, name) for key, name in keys.items()}
        if not found.flag("EnableLevel"):
            pins["enable"] = f"!{pins['enable']}"
        chip = {key: self.board.pin(pin) for key, pin in pins.items()}
        for name, socket in self.board.sockets.items():
            if {
                "step": socket.step,
                "direction": socket.direction,
                "enable": socket.enable,
            } == chip:
                return {"socket": name}
        return {f"{key}_pin": pin for key, pin in pins.items()}

    def switch(self, name: Node, inverted: bool) -> str:
        """A digital input with its marks."""
        found = self._found("digital_inputs", name)
        pull = "^" if found.text("InputMode", "PullMode") in ("Pull-up", "PullUp") else ""
        return f"{'!' if inverted else ''}{pull}{self._pin(found, 'Pin')}"

    def sensor(self, name: Node) -> str:
        """The pin of an analog input."""
        return self._pin(self._found("analog_inputs", name).within("Driver"), "Pin")

    def output(self, name: Node) -> str:
        """The pin of an output, with its mark."""
        backend = self._found("pwm_outputs", name).within("Backend")
        driver = backend.get("HardPwmDriver") or backend
        mark = "!" if any(driver.flag(key) for key in _INVERTED) else ""
        return f"{mark}{self._pin(driver, 'OutputPin')}"

    def _found(self, group: str, name: Node) -> Node:
        for one in self._node.each(group):
            if one.text("Name") == name.scalar:
                return one
        limit = f"a name in {group} of the board"
        raise bad(name.place, group, str(name.scalar)[:40], limit)

    def _pin(self, node: Node, key: str) -> str:
        found = node.within(key)
        match = _PIN.fullmatch(str(found.scalar))
        pin = ""
        if match and match[2]:
            plain = "T" if match[0].startswith("Teensy") else "D"
            pin = f"{match[1] or plain}{match[2]}"
        elif match:
            pin = f"P{match[3]}{match[4]}"
        chip = self.board.chip
        if bare(self.board.pin(pin)) not in (chip.pins if chip else ()):
            limit = f"a pin of the board {self.board.name}"
            raise bad(found.place, key, str(found.scalar)[:40], limit)
        return pin
