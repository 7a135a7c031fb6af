"""The tables of the hub, and the version of its file."""

from __future__ import annotations

import sqlite3

from passo.errors import HubError
from passo.hub.run_state import RunState

VERSION = 1

_ACTIVE = ", ".join(f"'{state.value}'" for state in RunState if not state.over)
_TABLES = f"""
create table printers (
    id text primary key,
    name text not null,
    url text not null,
    kind text not null,
    key text not null,
    tags text not null,            -- JSON, as all lists and objects here
    loaded text not null,
    power_group text not null,
    heating_w real not null,
    service integer not null,
    clears_itself integer not null,
    attention text not null,
    bed_clear integer not null,
    cleared_number integer not null,
    cleared_s real,
    cleared_by text not null,
    prints integer not null,
    printed_s real not null,
    filament_mm real not null,
    added_s real not null
);
create table files (
    sha256 text primary key,
    name text not null,
    size integer not null,
    added_s real not null,
    materials text not null,
    nozzle_mm real,
    print_s real,
    filament_mm real,
    has_picture integer not null
);
create table jobs (
    id text primary key,
    number integer not null unique,
    file text not null,
    name text not null,
    quantity integer not null,
    given integer not null,
    priority integer not null,
    needs text not null,
    tags text not null,
    each text not null,
    due_s real,
    retries integer not null,
    paused integer not null,
    cancelled integer not null,
    added_s real not null,
    added_by text not null,
    over_s real
);
create index open_jobs on jobs (number) where over_s is null;
create table runs (
    id text primary key,
    job text not null references jobs,
    file text not null,
    name text not null,
    printer text not null,         -- it may have been removed since
    state text not null,
    attempt integer not null,
    assigned_s real not null,
    started_s real,
    ended_s real,
    filament_mm real not null,
    printed_s real not null,
    reason text not null,
    path text not null,
    number_before integer not null,
    gives_back integer not null,
    cancelled_by text not null
);
create unique index one_run_on_a_printer on runs (printer) where state in ({_ACTIVE});
create index runs_of_jobs on runs (job);
create index runs_by_time on runs (assigned_s);
create table power_groups (name text primary key, limit_w real not null);
create table service_items (
    printer text not null,
    item text not null,
    every_h real,
    every_prints integer,
    every_mm real,
    done_s real,
    done_by text not null,
    at_s real not null,
    at_prints integer not null,
    at_mm real not null,
    primary key (printer, item)
);
create table settings (name text primary key, value text not null);
create table events (
    number integer primary key autoincrement,
    time_s real not null,
    who text not null,
    what text not null,
    printer text not null,
    job text not null,
    run text not null
);
create trigger events_stay before update on events begin select raise(abort, 'append only'); end;
create trigger events_remain before delete on events begin select raise(abort, 'append only'); end;
pragma user_version = {VERSION};
"""


def prepare(base: sqlite3.Connection) -> None:
    """Makes the tables in an empty file. Raises HubError if the file is from a newer version, and
    sqlite3.Error."""
    # One hub alone has the file: two of them would start a run twice.
    base.execute("pragma locking_mode = exclusive")
    base.execute("pragma journal_mode = wal")
    base.execute("pragma synchronous = full")
    base.execute("pragma foreign_keys = on")
    found: int = base.execute("pragma user_version").fetchone()[0]
    if found > VERSION:
        raise HubError.of(
            "hub.store",
            hint="Use the newer version of Passo, or another folder with --state",
            value=f"a newer version of Passo has written them (format {found}, at most {VERSION})",
        )
    if not found:
        base.executescript(f"begin immediate;{_TABLES}commit;")
