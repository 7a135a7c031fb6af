"""What the hub stores, besides files, which are stored as they are shown. Times are seconds since
1970."""

from __future__ import annotations

from msgspec import Struct

from passo.hub.link import PrinterRecord
from passo.hub.run_state import RunState
from passo.hub.views import Kind, Loaded

NEVER_PRINTED = 0  # in place of the number of the last print


class PrinterRow(Struct, frozen=True):
    """A printer. `key` is the hub's key on it. `cleared_number` is the number of the printer's last
    print when its bed became clear: with a greater one, something has printed since."""

    id: str
    name: str
    url: str
    kind: Kind
    key: str = ""
    tags: tuple[str, ...] = ()
    loaded: Loaded = Loaded()
    power_group: str = ""
    heating_w: float = 0.0
    service: bool = False
    clears_itself: bool = False
    attention: str = ""
    bed_clear: bool = False
    cleared_number: int = NEVER_PRINTED
    cleared_s: float | None = None
    cleared_by: str = ""
    prints: int = 0
    printed_s: float = 0.0
    filament_mm: float = 0.0
    added_s: float = 0.0

    @property
    def record(self) -> PrinterRecord:
        """What a link needs."""
        return PrinterRecord(self.id, self.name, self.url, self.kind, self.key)


class JobRow(Struct, frozen=True):
    """A job; `number` orders jobs by their arrival. `given` copies have a run that gives nothing
    back. A job is open until `over_s` is set."""

    id: str
    number: int
    file: str
    name: str
    quantity: int
    given: int = 0
    priority: int = 0
    needs: Loaded = Loaded()
    tags: tuple[str, ...] = ()
    each: tuple[str, ...] = ()
    due_s: float | None = None
    retries: int = 0
    paused: bool = False
    cancelled: bool = False
    added_s: float = 0.0
    added_by: str = ""
    over_s: float | None = None


class RunRow(Struct, frozen=True):
    """One print of a job on one printer. `path` is the file on the printer. `number_before` is the
    number of the printer's last print before the start. `gives_back`: its copy is printed by
    another run. `cancelled_by` is the user who wants it cancelled, or empty."""

    id: str
    job: str
    file: str
    name: str
    printer: str
    state: RunState
    attempt: int
    assigned_s: float
    started_s: float | None = None
    ended_s: float | None = None
    filament_mm: float = 0.0
    printed_s: float = 0.0
    reason: str = ""
    path: str = ""
    number_before: int = NEVER_PRINTED
    gives_back: bool = False
    cancelled_by: str = ""


class ServiceRow(Struct, frozen=True):
    """A maintenance item of a printer, due after so many hours of printing, prints or mm of
    filament since its last time. The `at_` values are the printer's totals at that time."""

    printer: str
    item: str
    every_h: float | None = None
    every_prints: int | None = None
    every_mm: float | None = None
    done_s: float | None = None
    done_by: str = ""
    at_s: float = 0.0
    at_prints: int = 0
    at_mm: float = 0.0


class GroupRow(Struct, frozen=True):
    """A power group."""

    name: str
    limit_w: float


class SettingRow(Struct, frozen=True):
    """A setting of the whole farm."""

    name: str
    value: str
