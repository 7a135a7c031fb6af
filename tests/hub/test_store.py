"""The store of the hub: transactions, transitions, what is refused."""

from __future__ import annotations

import sqlite3
import stat

import pytest
from tests.support.farm_world import Disk

from passo.errors import HubError
from passo.hub.records import JobRow, PrinterRow, RunRow
from passo.hub.run_state import TRANSITIONS, RunState
from passo.hub.schema import VERSION
from passo.hub.store import RUNS, Store, WrongState
from passo.hub.views import FileView, Loaded

PRINTER = PrinterRow("p", "mk3", "http://mk3", "passo", "secret", ("big",), Loaded("PLA"))
FILE = FileView("f" * 64, "a.gcode", 10, 5.0, ("PLA", "PETG"), 0.4)
JOB = JobRow("j", 1, FILE.sha256, "a.gcode", 2, each=("p",), due_s=7.0)


def run(state: RunState, id: str = "r", printer: str = "p") -> RunRow:
    return RunRow(id, "j", FILE.sha256, "a.gcode", printer, state, 1, 9.0)


def filled(store: Store, *runs: RunRow) -> Store:
    with store.change("anna", "all is added", printer="p") as change:
        for row in (PRINTER, FILE, JOB, *runs):
            change.add(row)
    return store


def test_store_reads_back_what_it_has_written(tmp_path):
    path = tmp_path / "farm.sqlite"
    store = filled(Store.open(path), run(RunState.PRINTING))
    with store.change("anna") as change:
        change.setting("queue_paused", "1")
    store.close()
    store = Store.open(path)
    assert store.printers == {"p": PRINTER}
    assert store.files == {FILE.sha256: FILE}
    assert store.jobs == {"j": JOB}
    assert store.active_run("p") == run(RunState.PRINTING)
    assert store.queue_paused and store.next_number() == 2
    assert store.query("select who, what, printer from events") == [("anna", "all is added", "p")]
    assert store.query("pragma synchronous") == [(2,)]  # full
    assert store.query("pragma journal_mode") == [("wal",)]
    assert stat.S_IMODE(path.stat().st_mode) == 0o600


@pytest.mark.parametrize("old", list(RunState))
def test_transition_needs_the_stored_state_and_a_follower(old):
    for new in RunState:
        for stored in RunState:
            store = filled(Store.open(None), run(stored))
            allowed = stored is old and new in TRANSITIONS[old]
            try:
                with store.change("", "moved") as change:
                    change.set(PRINTER, bed_clear=True)
                    change.move(run(old), old, new, reason="so")
            except WrongState:
                assert not allowed
            else:
                assert allowed
            (row,) = store.select(RUNS, "", ())
            assert row.state is (new if allowed else stored)
            assert row.reason == ("so" if allowed else "")
            # The whole transaction or nothing, also in memory and in the log.
            assert store.printers["p"].bed_clear is allowed
            assert len(store.query("select * from events")) == 1 + allowed


def test_printer_has_one_run_that_is_not_over():
    store = filled(Store.open(None), run(RunState.FAILED, "r1"), run(RunState.UPLOADED, "r2"))
    with pytest.raises(HubError, match="UNIQUE"), store.change("") as change:
        change.add(run(RunState.ASSIGNED, "r3"))
    assert store.active_run("p") == run(RunState.UPLOADED, "r2")


def test_log_cannot_be_changed():
    store = filled(Store.open(None))
    for sql in ("update events set who = 'eve'", "delete from events"):
        with pytest.raises(HubError, match="append only"):
            store.query(sql)


def test_file_of_a_newer_version_is_refused(tmp_path):
    path = tmp_path / "farm.sqlite"
    Store.open(path).close()
    base = sqlite3.connect(path)
    base.execute(f"pragma user_version = {VERSION + 1}")
    base.close()
    with pytest.raises(HubError, match=r"newer version .*format 2, at most 1.*another folder"):
        Store.open(path)


def test_file_that_is_not_a_store_is_refused(tmp_path):
    path = tmp_path / "farm.sqlite"
    path.write_bytes(b"G28\n" * 1000)
    with pytest.raises(HubError, match="not a database"):
        Store.open(path)
    with pytest.raises(HubError, match=r"unable to open|No such file|Is a directory"):
        Store.open(tmp_path)


def test_second_hub_on_the_same_file_is_refused(tmp_path):
    first = Store.open(tmp_path / "farm.sqlite")
    with pytest.raises(HubError, match="locked"):
        Store.open(tmp_path / "farm.sqlite")
    first.close()
    Store.open(tmp_path / "farm.sqlite").close()


def test_full_disk_changes_nothing():
    disk = sqlite3.connect(":memory:", isolation_level=None, factory=Disk)
    store = filled(Store(disk))
    disk.full = True
    with pytest.raises(HubError, match="disk is full"), store.change("", "x") as change:
        change.set(PRINTER, bed_clear=True)
    assert not store.printers["p"].bed_clear
    disk.full = False
    assert store.query("select bed_clear from printers") == [(0,)]
