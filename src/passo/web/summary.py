"""What a farm needs to know of one printer, in one small message."""

from __future__ import annotations

from typing import Literal, TypeAlias

from msgspec import Struct

from passo.printer.status import FaultStatus

SummaryState: TypeAlias = Literal["idle", "busy", "printing", "paused", "halted"]
Result: TypeAlias = Literal["done", "cancelled", "failed"]


class SummaryJob(Struct, frozen=True):
    """The running print. `run` is the run id that came with its start, or empty. `fraction` is 0 to
    1 in thousandths; `left_s` and `layers` are None while they are unknown."""

    file: str
    run: str
    fraction: float
    left_s: float | None
    printed_s: float
    layer: int
    layers: int | None
    filament_mm: float


class LastPrint(Struct, frozen=True):
    """The newest row of the printer's history. `number` increases with each print; `reason` says
    why it failed, or is empty."""

    number: int
    file: str
    run: str
    result: Result
    reason: str


class SummaryHeater(Struct, frozen=True):
    """A heater in whole degrees. `celsius` is None before the first reading; `target_c` is 0 while
    it is off."""

    name: str
    celsius: int | None
    target_c: int


class Summary(Struct, frozen=True):
    """One printer. `id` is a UUID that stays when its name or its address changes."""

    id: str
    name: str
    version: str
    state: SummaryState
    job: SummaryJob | None = None
    last_print: LastPrint | None = None
    heaters: tuple[SummaryHeater, ...] = ()
    fault: FaultStatus | None = None
