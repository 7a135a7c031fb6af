"""Faults of heaters, as events with messages, and failures of boards, as errors."""

from __future__ import annotations

from dataclasses import dataclass, replace

from passo import _core
from passo.board.ports import LinkLostError
from passo.errors import MachineError, Problem

FaultKind = _core.FaultKind


@dataclass(frozen=True, slots=True)
class HeaterFault:
    """A protection of a heater has switched it off.

    `celsius` is the temperature of its sensor at board clock `clock`, and `limit` is the limit that
    it passed: in °C, or for a model deviation a fraction of full power. `str()` gives a message
    with the next action.
    """

    heater: str
    kind: FaultKind
    celsius: float
    limit: float
    clock: int

    @classmethod
    def of(cls, heater: str, fault: _core.HeatFault) -> HeaterFault:
        """Converts the `fault` that the core has found at the heater."""
        return cls(heater, fault.kind, fault.celsius, fault.limit, fault.clock)

    @property
    def problem(self) -> Problem:
        """The fault as a problem of the catalogue: its code is `heat.` and its kind."""
        code = f"heat.{self.kind.name.lower().replace('_', '-')}"
        # Some sensors read hot when their cable is open, and cold when it is shorted.
        if self.kind == FaultKind.SENSOR_OPEN and self.celsius > self.limit:
            code += "-high"
        if self.kind == FaultKind.SENSOR_SHORT and self.celsius < self.limit:
            code += "-low"
        values = {"axis": self.heater, "value": self.celsius, "limit": self.limit}
        return Problem(code, values=values)

    @property
    def halting(self) -> MachineError:
        """The error of a fault that halts the printer; M999 restarts the printer."""
        problem = self.problem
        hint = problem.entry.action.replace("M922", "M999")
        return MachineError([replace(problem, hint=hint)])

    def __str__(self) -> str:
        """The message of the fault, with the next action."""
        return str(self.problem)


# The shutdown reasons of Klipper's firmware; Passo's firmware uses the same texts.
_TOO_LATE = (
    "Missed scheduling of next digital out event",
    "Missed scheduling of next hard pwm event",
    "Timer too close",
    "Stepper too far in past",
    "No next step",
)
_SENSORS = ("ADC out of range", "Thermocouple ADC out of range", "Thermocouple reader fault")
_I2C = ("I2C NACK", "I2C START NACK", "I2C START READ NACK", "I2C Timeout")
_OVERLOADED = "Rescheduled timer in the past"


def shutdown_error(reason: str, named: str, time_scale: float) -> MachineError:
    """The error of a board that has shut down for this reason. `named` is the reason with the name
    of the board, if there are several boards. `time_scale` is how many times faster than real time
    the host runs."""
    clock = f"for --clock {time_scale:g}" if time_scale != 1 else "or too busy"
    action = "a lower --clock" if time_scale != 1 else "a faster computer or a better cable"
    hint = ""
    if reason in _TOO_LATE:
        hint = (
            f"Commands reached it after their time: this computer was too slow {clock}. End other"
            f" programs or use {action}, then send M999"
        )
    elif reason in _SENSORS:
        hint = (
            "A temperature sensor reads outside of its heater's min_c to max_c. Check the sensors'"
            " cables, then send M999"
        )
    elif reason in _I2C:
        hint = (
            "A device on I2C, such as an accelerometer or a sensor, did not answer. Check its"
            " cable, or use a shorter one; newer firmware only reports it. Then send M999"
        )
    elif reason == _OVERLOADED:
        hint = (
            "Its processor was overloaded. Set [board.budget] in the machine file or print more"
            " slowly, then send M999"
        )
    return MachineError.of("machine.shutdown", hint=hint, value=named)


class BoardAloneError(LinkLostError):
    """The board ran out of commands and braked to a stop."""


class PlaceLostError(MachineError):
    """The positions of a board's motors are not proven any more. Everything else works."""


class BoardResetError(PlaceLostError, LinkLostError):
    """The board has restarted and lost its configuration. The main board's name is empty."""

    def __init__(self, name: str) -> None:
        board = f"board {name}" if name else "the board"
        super().__init__([Problem("machine.began-anew", values={"value": board})])


class BoardSilentError(LinkLostError):
    """The board does not answer."""

    def __init__(self, question: str) -> None:
        super().__init__([Problem("machine.silent", values={"value": question})])
