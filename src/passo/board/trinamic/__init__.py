"""Motor drivers with registers, over UART or SPI: the exchanges with them, and their status."""

from passo.board.trinamic.driver import (
    AnswerLostError,
    DriverFailure,
    DriverLink,
    Exchange,
    Spi20Wire,
    SpiWire,
    UartWire,
)
from passo.board.trinamic.settings import DriverSettings, speed_of, threshold_of
from passo.board.trinamic.status import Finding, Reading, findings, open_coils

__all__ = [
    "AnswerLostError",
    "DriverFailure",
    "DriverLink",
    "DriverSettings",
    "Exchange",
    "Finding",
    "Reading",
    "Spi20Wire",
    "SpiWire",
    "UartWire",
    "findings",
    "open_coils",
    "speed_of",
    "threshold_of",
]
