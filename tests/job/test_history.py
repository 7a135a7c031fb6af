"""Each print from the card is a row of the history."""

import sqlite3

import pytest
from tests.console.scenario import Scenario

from passo.job.history import History

FILE = "M302 P1\nG28\nG92 E0\n" + "".join(
    f"G1 X{10 + 50 * (i % 2)} E{i} F3000\n" for i in range(11)
)


@pytest.fixture
def places(tmp_path):
    (tmp_path / "card").mkdir()
    (tmp_path / "card" / "a.g").write_text(FILE)
    (tmp_path / "card" / "bad.g").write_text("G28 X\nG1 X999\n")
    return {"card": str(tmp_path / "card"), "state": str(tmp_path / "state")}


def test_prints_that_are_done_cancelled_or_failed_are_told(places, tmp_path):
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
        assert answer[3].startswith("echo:  a.g: cancelled")
        assert answer[4].startswith("echo:  a.g: done")
    history = History(tmp_path / "state")
    totals = history.totals()
    assert totals.filament_mm == pytest.approx(13, abs=3)
    assert totals.longest_s == pytest.approx(18, abs=3)
    history.close()
    with Scenario("i3", **places) as s:
        assert "Prints: 3" in s.host.ok("M78")[0]
        s.host.ok("M78 S78")
        assert "Prints: 0" in s.host.ok("M78")[0]


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
        assert history.last(1) == [("new.g", "failed", 30.0, "late")]
        assert history.last(9)[-1] == ("old.g", "done", 60.0, "")
        history.close()


def test_without_a_directory_there_is_no_history():
    with Scenario("i3") as s:
        assert "no place to store" in s.host.ok("M78")[0]
