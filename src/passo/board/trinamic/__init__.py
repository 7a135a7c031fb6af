"""Motor drivers with registers, over UART or SPI: TMC2208, TMC2209, TMC2130, TMC5160."""

from passo.board.trinamic.driver import (
    AnswerLostError,
    DriverFailure,
    DriverLink,
    Exchange,
    SpiWire,
    UartWire,
)
from passo.board.trinamic.settings import DriverSettings, threshold_of
from passo.board.trinamic.status import Finding, Reading, findings, open_coils

__all__ = [
    "AnswerLostError",
    "DriverFailure",
    "DriverLink",
    "DriverSettings",
    "Exchange",
    "Finding",
    "Reading",
    "SpiWire",
    "UartWire",
    "findings",
    "open_coils",
    "threshold_of",
]
