"""What a farm needs to know of one printer, in one small message."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, TypeAlias

from msgspec import Struct

from passo.printer.status import FaultStatus, LastPrint, PrinterState
from passo.version import __version__

if TYPE_CHECKING:
    from passo.printer.status import JobStatus, Status

SummaryState: TypeAlias = Literal["idle", "busy", "printing", "paused", "halted"]

_STATES: dict[PrinterState, SummaryState] = {
    PrinterState.IDLE: "idle",
    PrinterState.BUSY: "busy",
    PrinterState.PRINTING: "printing",
    PrinterState.PAUSED: "paused",
    PrinterState.HALTED: "halted",
}

_MOVED_C = 0.8  # more than the noise of a sensor between two whole degrees


class SummaryJob(Struct, frozen=True):
    """The running print. `file` is its path on the card; `run` is the run id that came with its
    start, or empty. `fraction` is 0 to 1 in thousandths; `left_s` and `layers` are None while they
    are unknown."""

    file: str
    run: str
    fraction: float
    left_s: float | None
    printed_s: float
    layer: int
    layers: int | None
    filament_mm: float


class SummaryHeater(Struct, frozen=True):
    """A heater in whole degrees. `celsius` is None while its sensor does not report; `target_c`
    is 0 while it is off."""

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


def summary_of(id: str, name: str, status: Status, before: Summary | None = None) -> Summary:
    """The summary of the printer `name` with this status. `before` is the last one that was sent: a
    temperature stays the same until it has moved by `_MOVED_C`."""
    known = before.heaters if before is not None else ()
    shown = {heater.name: heater.celsius for heater in known}
    heaters = tuple(
        SummaryHeater(heater, _whole(values.current_c, shown.get(heater)), round(values.target_c))
        for heater, values in status.heaters.items()
    )
    return Summary(
        id=id,
        name=name,
        version=__version__,
        state=_STATES[status.state],
        job=None if status.job is None else _job(status.job),
        last_print=status.last_print,
        heaters=heaters,
        fault=status.faults[0] if status.faults else None,
    )


def is_news(before: Summary, now: Summary) -> bool:
    """Whether the state, the print, the fault or the last print has changed, which clients learn at
    once."""
    return _news(before) != _news(now)


def _news(one: Summary) -> tuple[object, ...]:
    job = None if one.job is None else (one.job.file, one.job.run)
    return one.state, job, one.fault, one.last_print


def _whole(celsius: float | None, shown: int | None) -> int | None:
    if celsius is None:
        return None
    return shown if shown is not None and abs(celsius - shown) < _MOVED_C else round(celsius)


def _job(job: JobStatus) -> SummaryJob:
    return SummaryJob(
        file=job.path or job.file,
        run=job.run,
        fraction=round(job.fraction, 3),
        left_s=None if job.left_s is None else round(job.left_s),
        printed_s=round(job.printed_s),
        layer=job.layer,
        layers=job.layers,
        filament_mm=round(job.filament_mm),
    )
