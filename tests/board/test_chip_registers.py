"""Registers over I2C, in the words of newer and older firmware."""

from __future__ import annotations

from dataclasses import dataclass, field

import pytest

from passo.board.chip_registers import I2cRegisters, NotAcknowledgedError
from passo.board.description import I2cPins
from passo.board.dictionary import Dictionary

WIRE = I2cPins("PB8", "PB9", 0x19)
OLDER = ("i2c_write oid=%c data=%*s", "i2c_read oid=%c reg=%*s read_len=%u")
NEWER = ("i2c_transfer oid=%c write=%*s read_len=%u",)


@dataclass
class Oids:
    i2c_devices: dict[I2cPins, int] = field(default_factory=lambda: {WIRE: 7})


class Board:
    """Answers each question with a register of 0x44, and this status."""

    def __init__(self, words: tuple[str, ...], status: int) -> None:
        self.dictionary = Dictionary(
            tuple(enumerate(words)), (), {"i2c_bus_status": {"SUCCESS": 0, "NACK": 1}}, {}
        )
        self.oids, self.status = Oids(), status
        self.said: list[str] = []

    def command(self, text: str) -> None:
        self.said.append(text)

    def ask(self, text: str, answer: str) -> dict[str, int | bytes]:
        self.said.append(f"{text} -> {answer}")
        return {"i2c_bus_status": self.status, "response": b"\x44"}


def test_registers_by_newer_i2c_messages() -> None:
    board = Board(NEWER, 0)
    registers = I2cRegisters(board, WIRE)
    assert registers.read(0x0F) == 0x44
    registers.send(0x20, 0x94)
    assert board.said == [
        "i2c_transfer oid=7 write=0f read_len=1 -> i2c_response",
        "i2c_transfer oid=7 write=2094 read_len=0 -> i2c_response",
    ]
    board.status = 1
    for call in (lambda: registers.read(0x0F), lambda: registers.send(0x20, 0x94)):
        with pytest.raises(NotAcknowledgedError, match="NACK"):
            call()


def test_registers_by_older_i2c_messages() -> None:
    board = Board(OLDER, 1)
    registers = I2cRegisters(board, WIRE)
    assert registers.read(0x0F) == 0x44
    registers.send(0x20, 0x94)
    assert board.said == [
        "i2c_read oid=7 reg=0f read_len=1 -> i2c_read_response",
        "i2c_write oid=7 data=2094",
    ]
