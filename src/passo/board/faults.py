"""What fails at a board: a heater, as an event and as a sentence; the board itself, as errors."""

from __future__ import annotations

from dataclasses import dataclass

from passo import _core
from passo.board.ports import LinkLostError
from passo.errors import MachineError, Problem

FaultKind = _core.FaultKind


@dataclass(frozen=True, slots=True)
class HeaterFault:
    """A protection of a heater has switched it off.

    `celsius` is what its sensor said at board clock `clock`, `limit` what it had to keep to: °C,
    and of a model deviation a share of full power. `str()` is a sentence with the next action.
    """

    heater: str
    kind: FaultKind
    celsius: float
    limit: float
    clock: int

    @classmethod
    def of(cls, heater: str, fault: _core.HeatFault) -> HeaterFault:
        """What the core has found at a heater of this name."""
        return cls(heater, fault.kind, fault.celsius, fault.limit, fault.clock)

    @property
    def problem(self) -> Problem:
        """The fault as a problem of the catalogue, `heat.` and its kind being the code."""
        code = f"heat.{self.kind.name.lower().replace('_', '-')}"
        values = {"axis": self.heater, "value": self.celsius, "limit": self.limit}
        return Problem(code, values=values)

    def __str__(self) -> str:
        return str(self.problem)


class BoardAloneError(LinkLostError):
    """The board was not told in time how to go on, and has stopped by itself."""


class PlaceLostError(MachineError):
    """Where the motors of a board stand cannot be proved any more; nothing else is wrong."""


class BoardResetError(PlaceLostError, LinkLostError):
    """The board has begun anew, and knows of nothing that it was told before. The main board's name
    is empty."""

    def __init__(self, name: str) -> None:
        board = f"board {name}" if name else "the board"
        super().__init__([Problem("machine.began-anew", values={"value": board})])


class BoardSilentError(LinkLostError):
    """The board does not answer."""

    def __init__(self, question: str) -> None:
        super().__init__([Problem("machine.silent", values={"value": question})])
