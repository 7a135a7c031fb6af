"""The events that a live printer reports; each event is a value of one of these types."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

from passo.printer.status import JobStatus, PrinterState

Outcome: TypeAlias = Literal["done", "cancelled", "failed"]


@dataclass(frozen=True, slots=True)
class StateChanged:
    """The printer has changed its state. `halted` says why a halted printer is halted."""

    state: PrinterState
    before: PrinterState
    halted: str = ""


@dataclass(frozen=True, slots=True)
class TemperatureChanged:
    """The target of a heater has changed, or its reading by at least 1 °C. The reading is None
    until the sensor has reported."""

    heater: str
    celsius: float | None
    target_c: float


@dataclass(frozen=True, slots=True)
class LayerChanged:
    """The moves of another layer have begun. `layers`, the number of layers, is None until the
    whole file is planned."""

    file: str
    layer: int
    layers: int | None


@dataclass(frozen=True, slots=True)
class ProgressChanged:
    """The progress of a print has risen by a whole percent."""

    job: JobStatus


@dataclass(frozen=True, slots=True)
class JobEnded:
    """A print from a file is over; `reason` says why it failed."""

    file: str
    outcome: Outcome
    reason: str = ""


@dataclass(frozen=True, slots=True)
class Fault:
    """A protection has switched a heater off. `kind` is its row in docs/explanation/heat.md, for
    example `sensor-open`; `text` is the sentence that consoles receive."""

    heater: str
    kind: str
    text: str


@dataclass(frozen=True, slots=True)
class Message:
    """A line that all consoles receive."""

    text: str


@dataclass(frozen=True, slots=True)
class RemoteCall:
    """A macro calls a method that a client of Klipper's socket has registered."""

    method: str
    arguments: Mapping[str, Any]


Event: TypeAlias = (
    StateChanged
    | TemperatureChanged
    | LayerChanged
    | ProgressChanged
    | JobEnded
    | Fault
    | Message
    | RemoteCall
)
