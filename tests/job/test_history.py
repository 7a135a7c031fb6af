"""Each print from the card is a row of the history."""

import re
import sqlite3
from pathlib import Path

import pytest
from tests.support.scenario import Scenario

from passo.errors import InputError
from passo.job.live.history import History

FILE = "M302 P1\nG28\nG92 E0\n" + "".join(
    f"G1 X{10 + 50 * (i % 2)} E{i} F3000\n" for i in range(11)
)


@pytest.fixture
def places(tmp_path):
    (tmp_path / "card").mkdir()
    (tmp_path / "card" / "a.g").write_text(FILE)
    (tmp_path / "card" / "bad.g").write_text("G28 X\nG1 X999\n")
    return {"card": str(tmp_path / "card"), "state": str(tmp_path / "state")}


def test_prints_that_are_done_cancelled_or_failed_are_reported(places, tmp_path):
    with Scenario("i3", **places) as s:
        s.host.ok("M32 a.g")
        s.host.expect("Done printing", 60)
        s.host.ok("M26")
        s.host.ok("M24")
        s.passes(8)
        s.host.ok("M25")
        s.passes(5)
        s.host.ok("M524")
        s.host.ok("M32 bad.g")
        s.host.expect("stopped", 30)
        answer = s.host.ok("M78")
        assert answer[0] == "echo:Prints: 3, finished: 1, failed or cancelled: 2"
        assert answer[2].startswith("echo:  bad.g: failed")
        assert "bad.g:2: X 999.000 mm is beyond the limit of 250.000 mm" in answer[3]
        assert answer[4].startswith("echo:  a.g: cancelled")
        assert answer[5].startswith("echo:  a.g: done")
        assert answer[6].startswith("echo:Power on: 0h 0m 3")
    history = History(tmp_path / "state")
    totals = history.totals()
    assert totals.filament_mm == pytest.approx(13, abs=3)
    assert totals.longest_s == pytest.approx(18, abs=3)
    history.close()
    with Scenario("i3", **places) as s:
        assert "Prints: 3" in s.host.ok("M78")[0]
        s.host.ok("M78 S78")
        assert "Prints: 0" in s.host.ok("M78")[0]


def test_a_resumed_print_stays_one_print(places):
    Path(places["card"], "bad.g").write_text("G28 X\nG1 X999\nG1 X50 F600\n")
    with Scenario("i3", **places) as s:
        s.host.ok("M32 bad.g")
        s.host.expect("stopped", 30)
        s.passes(100)
        s.host.ok("M24")
        s.host.expect("Done printing", 30)
        answer = s.host.ok("M78")
        assert answer[0] == "echo:Prints: 1, finished: 1, failed or cancelled: 0"
        assert re.fullmatch("echo:  bad.g: done, 0h 0m [678]s", answer[2])
        s.host.ok("M26")
        s.host.ok("M24")
        s.host.expect("stopped", 30)
        assert s.host.ok("M78")[0] == "echo:Prints: 2, finished: 1, failed or cancelled: 1"


def test_a_history_of_an_older_kind_is_taken_over(tmp_path):
    base = sqlite3.connect(tmp_path / "history.sqlite")
    base.execute(
        "create table prints (id integer primary key, file text not null, size integer not null,"
        " ended text not null, print_s real not null, filament_mm real not null)"
    )
    base.execute("insert into prints values (1, 'old.g', 7, 'done', 60.0, 5.0)")
    base.commit()
    base.close()
    for size in (8, 9):
        history = History(tmp_path)
        history.add("new.g", size, "failed", 30.0, 2.0, "late")
        (new,), old = history.last(1), history.last(9)[-1]
        assert (new.file, new.ended, new.print_s, new.note) == ("new.g", "failed", 30.0, "late")
        assert (old.file, old.ended, old.print_s, old.note) == ("old.g", "done", 60.0, "")
        history.close()


def test_a_history_that_cannot_be_used_is_closed(tmp_path):
    (tmp_path / "history.sqlite").write_bytes(b"no history " * 100)
    with pytest.raises(sqlite3.DatabaseError):
        History(tmp_path)
    opened = [link.readlink() for link in Path("/proc/self/fd").iterdir() if link.is_symlink()]
    assert not [path for path in opened if path.is_relative_to(tmp_path)]


def test_no_directory_means_no_history():
    with Scenario("i3") as s:
        assert "no place to store" in s.host.ok("M78")[0]


def rows(path):
    history = History(path)
    try:
        last = [(row.file, row.ended, row.print_s, row.note) for row in history.last(9)]
        return last, history.totals()
    finally:
        history.close()


def test_prints_that_a_host_sends_are_reported(tmp_path):
    with Scenario("i3", state=str(tmp_path)) as s:
        s.host.ok("M302 P1")
        s.host.ok("G92 E0")
        s.host.ok("M75")
        s.passes(100)
        s.host.ok("M76")
        s.passes(1000)
        s.host.ok("M75")
        s.host.ok("G1 E20 F600")
        s.passes(20)
        s.host.ok("M77")
        s.host.ok("M77")  # nothing is under way any more
        s.host.ok("M530 S1 L20")
        s.host.ok("M531 cube.gcode")
        s.passes(60)
        s.host.ok("M530 S0")
        s.host.ok("M530 S0")
        s.host.ok("M75")
        s.passes(30)
        s.host.send("M112")
        s.host.expect("halted", 5)
        s.passes(1)
        s.host.send("M999")
        s.host.expect("ready again", 5)
        s.host.ok("M75")
        s.passes(10)
    last, totals = rows(tmp_path)
    assert [(file, ended) for file, ended, _, _ in last] == [
        ("(a host's)", "cancelled"),
        ("(a host's)", "failed"),
        ("cube.gcode", "done"),
        ("(a host's)", "done"),
    ]
    assert [row[2] for row in last] == pytest.approx([10, 32, 60, 120], abs=2)
    assert [row[3] for row in last] == ["", "emergency stop by M112", "", ""]
    assert totals.filament_mm == pytest.approx(20)


def test_print_with_timer_commands_is_in_history(tmp_path):
    card = tmp_path / "card"
    card.mkdir()
    (card / "a.g").write_text("M75\nG4 S30\nM77\nG4 S5\n")
    with Scenario("i3", card=str(card), state=str(tmp_path / "state")) as s:
        s.host.ok("M75")  # a host that starts the card's print
        s.host.ok("M32 a.g")
        s.host.expect("Print time 0h 0m 2[6-9]s", 60)  # it is read 4 s before
        s.host.expect("Done printing", 60)
    last, totals = rows(tmp_path / "state")
    assert [(file, ended) for file, ended, _, _ in last] == [("a.g", "done")]
    assert totals.print_s == pytest.approx(35, abs=1)


def test_how_long_the_printer_was_on_is_summed_up(tmp_path):
    with Scenario("i3", state=str(tmp_path)) as s:
        s.passes(1000)
        assert rows(tmp_path)[1].on_s == pytest.approx(600, abs=1)  # as a power cut would leave it
        assert s.host.ok("M78")[2] == "echo:Power on: 0h 16m 39s"
        s.passes(100)
    assert rows(tmp_path)[1].on_s == pytest.approx(1100, abs=1)
    with Scenario("i3", state=str(tmp_path)) as s:
        s.passes(2600)
        assert s.host.ok("M78")[2] == "echo:Power on: 1h 1m 39s"
        s.host.ok("M78 S78")
        s.passes(50)
        assert s.host.ok("M78")[2] == "echo:Power on: 0h 0m 50s"


def test_locked_history_is_reported_and_not_waited_for(tmp_path, places):
    with Scenario("i3", **places) as s:
        s.host.ok("M78")
        other = sqlite3.connect(tmp_path / "state" / "history.sqlite")
        other.execute("begin exclusive")
        for line in ("M78", "M78 S78"):
            assert s.host.ok(line)[0].startswith("echo:the history of prints cannot be used: data")
        s.host.ok("M32 bad.g")
        s.host.expect("This print is not in the history: database is locked", 30)
        other.rollback()
        other.close()
        assert s.host.ok("M78")[0].startswith("echo:Prints: 0")


def test_a_damaged_history_is_reported(tmp_path):
    (tmp_path / "history.sqlite").write_bytes(b"no base" * 999)
    with Scenario("i3", state=str(tmp_path)) as s:
        told = s.host.ok("M78")[0].removeprefix(f"echo:{tmp_path}: ")
        assert told.startswith("the history of prints cannot be used: file is not a database")


def test_a_print_that_was_killed_is_a_row(places, tmp_path):
    (tmp_path / "card" / "long.g").write_text(FILE + "G4 S200\n")
    with Scenario("i3", **places) as s:
        s.host.ok("M32 long.g")
        s.passes(150)
        killed = tmp_path / "killed"
        killed.mkdir()
        for file in (tmp_path / "state").iterdir():
            (killed / file.name).write_bytes(file.read_bytes())
        assert s.host.ok("M78")[0] == "echo:Prints: 0, finished: 0, failed or cancelled: 0"
    with Scenario("i3", card=places["card"], state=str(killed)) as s:
        answer = s.host.ok("M78")
        assert answer[0] == "echo:Prints: 1, finished: 0, failed or cancelled: 1"
        seconds = re.fullmatch(r"echo:  long\.g: interrupted, 0h (\d)m (\d+)s", answer[2])
        assert seconds
        assert 90 <= 60 * int(seconds[1]) + int(seconds[2]) <= 150
        s.host.ok("M1000", 60)
        s.host.expect("Done printing", 400)
        answer = s.host.ok("M78")
        assert answer[0] == "echo:Prints: 2, finished: 1, failed or cancelled: 1"
        assert answer[2].startswith("echo:  long.g: done")


def test_a_print_that_its_host_announces_is_one_row(places):
    with Scenario("i3", **places) as s:
        s.host.ok("M75")
        s.host.ok("M32 a.g")
        s.host.expect("Done printing", 60)
        assert "Prints: 1, finished: 1" in s.host.ok("M78")[0]


def test_two_printers_do_not_share_a_folder(places):
    with Scenario("i3", **places) as s:
        s.host.ok("M32 a.g")
        with pytest.raises(
            InputError, match=r"another printer .* Stop the other printer, or give each"
        ):
            Scenario("i3", **places)
        assert "SD printing" in s.host.ok("M27")[0]
    with Scenario("i3", **places) as s:
        assert "M1000 resumes" in s.printer.state.greeting()


def test_print_aborted_by_host_stays_in_history(tmp_path):
    with Scenario("i3", state=str(tmp_path)) as s:
        s.host.ok("M302 P1")
        for name in ("one", "two"):
            s.host.ok("M530 S1")
            s.host.ok("M75")
            s.host.ok("M530 S1")  # has printed nothing yet: the same
            s.host.ok(f"M531 {name}")
            s.host.ok("G1 E5 F300")
            s.host.ok("M400", 20)
        s.host.ok("M530 S0")
    last, _ = rows(tmp_path)
    assert [(file, ended) for file, ended, *_ in last] == [("two", "done"), ("one", "interrupted")]
