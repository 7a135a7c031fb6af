"""What the hub shows and stores: printers, files, jobs, runs. Times are seconds since 1970."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from msgspec import Meta, Struct

from passo.web.summary import Summary

Kind: TypeAlias = Literal["passo", "moonraker"]
Condition: TypeAlias = Literal[
    "connecting",  # not seen since the hub started
    "unreachable",  # no word for a minute
    "idle",
    "busy",
    "printing",
    "paused",
    "halted",
]
Tag: TypeAlias = Annotated[str, Meta(min_length=1, max_length=40)]
Name: TypeAlias = Annotated[str, Meta(min_length=1, max_length=80)]


class Loaded(Struct, frozen=True):
    """What a printer has, or what a job needs; an empty text or None: not said, or any."""

    material: str = ""
    colour: str = ""
    nozzle_mm: float | None = None
    plate: str = ""


class PrinterView(Struct, frozen=True):
    """A printer of the farm. `bed_clear`: `cleared_by` has said at `cleared_s` that its bed is
    empty, and nothing has printed on it since. `attention` is what a user must look at before the
    next run, or empty. `start_unknown`: it is unknown whether its run has started, and a user
    must answer. `run` is the id of the hub's run on it, or empty. `last_word_s` is when it was last
    heard of, while it is unreachable. `power_group` limits heating printers; `heating_w` is its
    power while it heats. `service`: nothing starts on it. `clears_itself`: its bed counts as clear
    after each print that is done. `printed_s`, `filament_mm` and `prints` are totals of the hub's
    runs; `service_due` are the maintenance items that are due."""

    id: str
    name: str
    url: str
    kind: Kind
    condition: Condition
    bed_clear: bool
    tags: tuple[str, ...] = ()
    loaded: Loaded = Loaded()
    attention: str = ""
    run: str = ""
    power_group: str = ""
    heating_w: float = 0.0
    service: bool = False
    clears_itself: bool = False
    seen: Summary | None = None
    prints: int = 0
    printed_s: float = 0.0
    filament_mm: float = 0.0
    service_due: tuple[str, ...] = ()
    cleared_by: str = ""
    cleared_s: float | None = None
    last_word_s: float | None = None
    start_unknown: bool = False


class FileView(Struct, frozen=True):
    """A file of the hub: its content never changes. `materials`, `nozzle_mm` and `print_s` come
    from the slicer's comments, empty or None if it says nothing."""

    sha256: str
    name: str
    size: int
    added_s: float
    materials: tuple[str, ...] = ()
    nozzle_mm: float | None = None
    print_s: float | None = None
    filament_mm: float | None = None
    has_picture: bool = False


class JobView(Struct, frozen=True):
    """A job: `quantity` prints of a file. `waiting`, `running`, `done`, `failed` count its runs;
    `retries` failed runs are repeated on other printers. `each` are printers that print it once
    each, in place of a free choice; `tags` limit the choice. `why` says why nothing of it starts
    now, or is empty. A greater `priority` comes first."""

    id: str
    file: str  # SHA-256
    name: str
    quantity: int
    priority: int = 0
    needs: Loaded = Loaded()
    tags: tuple[str, ...] = ()
    each: tuple[str, ...] = ()
    due_s: float | None = None
    retries: int = 0
    paused: bool = False
    added_s: float = 0.0
    added_by: str = ""
    waiting: int = 0
    running: int = 0
    done: int = 0
    failed: int = 0
    cancelled: int = 0
    why: str = ""


class RunView(Struct, frozen=True):
    """One print of a job on one printer. `state` is one of `RunState`; `attempt` counts from 1;
    `reason` says why it failed."""

    id: str
    job: str
    file: str
    name: str
    printer: str
    state: str
    attempt: int
    assigned_s: float
    started_s: float | None = None
    ended_s: float | None = None
    filament_mm: float = 0.0
    printed_s: float = 0.0
    reason: str = ""


class PowerGroup(Struct, frozen=True):
    """Printers on one fuse: the heating printers of it stay below `limit_w` in sum."""

    name: str
    limit_w: float
    used_w: float = 0.0


class Farm(Struct, frozen=True):
    """The whole farm, the first message of the hub's feed."""

    printers: tuple[PrinterView, ...]
    jobs: tuple[JobView, ...]
    groups: tuple[PowerGroup, ...] = ()
    queue_paused: bool = False
