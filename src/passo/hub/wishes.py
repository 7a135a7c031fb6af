"""What people ask of the farm: the bodies of requests, and what the farm answers besides its
views. Times are seconds since 1970."""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import UNSET, Meta, Struct, UnsetType

from passo.hub.views import Kind, Loaded, Name, Tag

Url = Annotated[str, Meta(min_length=8, max_length=300)]
Watts = Annotated[float, Meta(ge=0, le=1e6)]
Count = Annotated[int, Meta(ge=1, le=10_000)]
Sha256 = Annotated[str, Meta(pattern="^[0-9a-f]{64}$")]


class NewPrinter(Struct, forbid_unknown_fields=True):
    """A printer to add. `code` is a one-time code of a Passo printer, `key` an API key in its
    place. `name` is the printer's own unless it is given."""

    url: Url
    kind: Kind = "passo"
    code: Annotated[str, Meta(max_length=32)] = ""
    key: Annotated[str, Meta(max_length=200)] = ""
    name: Annotated[str, Meta(max_length=80)] = ""
    tags: Annotated[list[Tag], Meta(max_length=20)] = []


class PrinterChange(Struct, forbid_unknown_fields=True):
    """Changes of a printer; an omitted value stays. An empty `power_group` is none."""

    name: Name | UnsetType = UNSET
    url: Url | UnsetType = UNSET
    tags: Annotated[list[Tag], Meta(max_length=20)] | UnsetType = UNSET
    loaded: Loaded | UnsetType = UNSET
    power_group: Annotated[str, Meta(max_length=40)] | UnsetType = UNSET
    heating_w: Watts | UnsetType = UNSET
    service: bool | UnsetType = UNSET
    clears_itself: bool | UnsetType = UNSET


class Attended(Struct, forbid_unknown_fields=True):
    """The attention of a printer is dealt with. `started` answers whether the run has started, if
    that was unknown."""

    started: bool | None = None


class NewJob(Struct, forbid_unknown_fields=True):
    """A job to add. `each` are ids of printers that print it once each; `quantity` is then their
    number. `retries` failed runs are repeated on other printers."""

    file: Sha256
    quantity: Count = 1
    priority: Annotated[int, Meta(ge=-100, le=100)] = 0
    needs: Loaded = Loaded()
    tags: Annotated[list[Tag], Meta(max_length=20)] = []
    each: Annotated[list[str], Meta(max_length=1000)] = []
    due_s: float | None = None
    retries: Annotated[int, Meta(ge=0, le=10)] = 0


class JobChange(Struct, forbid_unknown_fields=True):
    """Changes of a job; an omitted value stays. `quantity` is at least the number of runs that are
    done or running. `due_s` null removes the time."""

    quantity: Count | UnsetType = UNSET
    priority: Annotated[int, Meta(ge=-100, le=100)] | UnsetType = UNSET
    needs: Loaded | UnsetType = UNSET
    tags: Annotated[list[Tag], Meta(max_length=20)] | UnsetType = UNSET
    due_s: float | UnsetType | None = UNSET
    retries: Annotated[int, Meta(ge=0, le=10)] | UnsetType = UNSET
    paused: bool | UnsetType = UNSET


class ServiceInterval(Struct, forbid_unknown_fields=True):
    """When a maintenance item is due: after hours of printing, prints or mm of filament, whichever
    comes first. `done`: it has just been done, so that it counts from now."""

    every_h: Annotated[float, Meta(gt=0)] | None = None
    every_prints: Annotated[int, Meta(gt=0)] | None = None
    every_mm: Annotated[float, Meta(gt=0)] | None = None
    done: bool = False


class ServiceItem(Struct, frozen=True):
    """A maintenance item of a printer: its interval, what has been printed since it was done, and
    when and by whom it was done."""

    item: str
    every_h: float | None
    every_prints: int | None
    every_mm: float | None
    hours: float
    prints: int
    filament_mm: float
    due: bool
    done_s: float | None
    done_by: str


class FarmEvent(Struct, frozen=True):
    """A line of the log of the farm. `who` is a user, or `hub`."""

    number: int
    time_s: float
    who: str
    what: str
    printer: str = ""
    job: str = ""
    run: str = ""


class PrinterStatistics(Struct, frozen=True):
    """The hub's runs on a printer."""

    printer: str
    done: int
    failed: int
    cancelled: int
    printed_s: float
    filament_mm: float


class Share(Struct, frozen=True):
    """The hub's runs with one material, or for one user; an empty name is an unknown one."""

    name: str
    done: int
    failed: int
    cancelled: int
    printed_s: float
    filament_mm: float


class Statistics(Struct, frozen=True):
    """The hub's runs: all, of each printer, with each material, for each user."""

    done: int
    failed: int
    cancelled: int
    printed_s: float
    filament_mm: float
    printers: tuple[PrinterStatistics, ...]
    materials: tuple[Share, ...] = ()
    users: tuple[Share, ...] = ()


Result = Literal["done", "unreachable", "refused"]


class Stopped(Struct, frozen=True):
    """What became of an emergency stop of a printer. `reason` says why it failed."""

    printer: str
    result: Result
    reason: str = ""
