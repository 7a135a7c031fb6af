"""The board as the host sees it: its dictionary, its configuration, a connection to it."""

from passo.board.connection import Connection
from passo.board.description import BoardDescription, Endstop, Heater, Output, Sensor, Stepper
from passo.board.dictionary import Dictionary, decode
from passo.board.faults import FaultKind, HeaterFault

__all__ = [
    "BoardDescription",
    "Connection",
    "Dictionary",
    "Endstop",
    "FaultKind",
    "Heater",
    "HeaterFault",
    "Output",
    "Sensor",
    "Stepper",
    "decode",
]
