"""Uploads from their first line to their last, the good ones and those that cannot begin."""

import shutil

import pytest
from tests.support.numbered_lines import numbered
from tests.support.scenario import Host, Scenario

from passo.errors import CardError

REFUSED = ["Error:PreviousCommandFailed", "ok"]


@pytest.fixture
def s(tmp_path):
    (tmp_path / "old.g").write_text("G1 X1\n")
    with Scenario("i3", card=str(tmp_path)) as scenario:
        yield scenario


@pytest.fixture
def bare():
    """A printer without a card, whose axes know where they are."""
    with Scenario("i3") as scenario:
        scenario.host.ok("G92 X20 Y20 Z20")
        yield scenario


def test_upload_wrapper_writes_the_lines_between(s, tmp_path):
    s.host.ok("M932")
    assert s.host.ok("M28 Fold.g") == ["Writing to file: old.g", "ok"]
    for line in ("G1 X2", "M105", "M999", "G28"):
        assert s.host.ok(line) == ["ok"]
    assert s.host.ok("M29") == ["Done saving file.", "ok"]
    assert s.host.ok("M933") == ["ok"]
    assert (tmp_path / "old.g").read_text() == "G1 X2\nM105\nM999\nG28\n"
    assert (s.host.session.upload, s.host.session.strict) == (None, False)
    s.passes(2)
    assert s.positions()["x"] == 20.0


def test_failed_upload_wrapper_consumes_its_lines(s, tmp_path):
    session = s.host.session
    s.host.ok("M932")
    assert s.host.ok("M28 Fno/such.g")[0].startswith("Error:/no: is not on the card")
    for line in ("G28", "M105", "M104 S200"):
        assert s.host.ok(line) == REFUSED
    assert session.upload is not None
    assert s.host.ok("M29") == ["ok"]
    assert session.upload is None
    assert s.host.ok("M105") == REFUSED  # until M932 or M933
    assert s.host.ok("M933") == ["ok"]
    assert not session.strict
    assert "/0.00" in s.host.ok("M105")[0]
    assert [p.name for p in tmp_path.iterdir()] == ["old.g"]
    assert s.positions()["x"] == 20.0
    s.host.ok("M932")
    assert s.host.ok("M28 Fold.g") == ["Writing to file: old.g", "ok"]
    assert s.host.ok("M29") == ["Done saving file.", "ok"]


def test_bytes_beyond_ascii_are_kept_as_they_came(s, tmp_path):
    stored = "M117 Grüße, 25 °C\nG1 X2\x85\nM118 ".encode() + b"\xff\xb2\x80\n"
    s.host.ok("M28 a.g")
    s.host.send_bytes(stored)
    assert s.host.ok("M29") == ["Done saving file.", "ok"]
    assert (tmp_path / "a.g").read_bytes() == stored


def test_a_log_that_cannot_be_written_spoils_no_print(s, monkeypatch):
    s.host.ok("G92 X20 Y20 Z20")
    s.host.ok("M928 log.g")

    def full(_: bytes) -> None:
        raise CardError.of("card.full", "log.g", value=1, limit=0)

    monkeypatch.setattr(s.host.session.upload.writer, "write", full)
    move, wait = numbered((1, "G1 X21 F6000"), (2, "M400"))
    told, *others, ok = s.host.ok(move)
    assert told.startswith("echo:log.g: the card is full")
    assert (others, ok) == ([], "ok")  # and no pause
    assert s.host.ok(wait) == ["ok"]
    assert s.positions()["x"] == 21
    assert not s.host.session.failed


def test_a_path_from_the_root_is_one_wherever_names_count_from(s, tmp_path):
    (tmp_path / "parts").mkdir()
    s.host.ok("M23 Dparts")
    for written, name in (("F/top.g", "/top.g"), ("/two.g", "/two.g"), ("here.g", "here.g")):
        assert s.host.ok(f"M28 {written}")[0] == f"Writing to file: {name}"
        assert s.host.ok("M29")[0] == "Done saving file."
    found = sorted(str(p.relative_to(tmp_path)) for p in tmp_path.rglob("*.g"))
    assert found == ["old.g", "parts/here.g", "top.g", "two.g"]


def test_m932_and_m933_act_while_a_file_is_written(s, tmp_path):
    s.host.ok("M28 old.g")
    s.host.ok("M932")
    assert s.host.session.strict
    s.host.ok("G1 X3")
    s.host.ok("M933")
    assert not s.host.session.strict
    assert s.host.ok("M29")[0] == "Done saving file."
    assert (tmp_path / "old.g").read_text() == "G1 X3\n"


def test_m932_and_m933_are_not_logged_and_act(s, tmp_path):
    s.host.ok("M928 log.g")
    s.host.ok("M932")
    assert s.host.session.strict
    s.host.ok("G90")
    s.host.ok("M29")
    assert (tmp_path / "log.g").read_text() == "G90\n"


def test_upload_with_a_missing_line_is_dropped(s, tmp_path):
    lines = numbered((0, "M110 N0"), (1, "G1 X7"), (2, "G1 X8"))
    s.host.ok("M932")
    s.host.ok("M28 old.g")
    s.host.ok(lines[0])
    s.host.ok(lines[1])
    assert "not carried out while a file is written" in s.host.ok("G1 X5")[0]
    assert s.host.ok(lines[2]) == REFUSED
    assert s.host.ok("M29") == ["ok"]
    assert (tmp_path / "old.g").read_text() == "G1 X1\n"


def test_a_halted_printer_still_writes_the_whole_file(s, tmp_path):
    other = Host(s)
    s.host.ok("M28 old.g")
    s.host.ok("G1 X7")
    other.ok("M112")
    s.host.expect("Printer halted", 1)
    assert s.host.ok("G1 X8") == ["ok"]
    s.host.ok("M29")
    assert (tmp_path / "old.g").read_text() == "G1 X7\nG1 X8\n"


def test_lines_for_an_unopened_file_are_reported_once(bare):
    assert "there is no card" in bare.host.ok("M28 a.g")[0]
    note = "echo:G28 is not carried out: it is for the file a.g. End it with M29"
    assert bare.host.ok("G28") == [note, "ok"]
    assert bare.host.ok("M104 S200") == ["ok"]
    assert bare.printer.rig.connection.heaters["hotend"].target == 0
    bare.host.ok("M29")
    bare.host.ok("M104 S200")
    bare.passes(1)
    assert bare.printer.rig.connection.heaters["hotend"].target == 200


def test_a_second_upload_does_not_end_the_first(s, tmp_path):
    lines = numbered((0, "M110 N0"), (1, "G1 X7"), (2, "G1 X8"))
    s.host.ok("M28 old.g")
    s.host.ok(lines[0])
    s.host.ok(lines[1])
    assert "old.g: is in use" in s.host.ok("M28 new.g")[0]
    s.host.ok(lines[2])
    assert s.host.ok("M29")[0] == "Done saving file."
    assert (tmp_path / "old.g").read_text() == "G1 X7\nG1 X8\n"
    s.host.ok("M928 log.g")
    assert "is in use" in s.host.ok("M28 new.g")[0]
    s.host.ok("G90")
    s.host.ok("M29")
    assert (tmp_path / "log.g").read_text() == "M28 new.g\nG90\n"
    assert not (tmp_path / "new.g").exists()


def test_m112_without_a_number_acts_in_an_upload_with_numbers(s):
    lines = numbered((0, "M110 N0"), (1, "G1 X7"))
    s.host.ok("M28 old.g")
    s.host.ok(lines[0])
    s.host.ok(lines[1])
    s.host.ok("M28 new.g")
    s.host.ok("M112")
    assert s.printer.state.halted == "emergency stop by M112"


# -- ahead of every queue -------------------------------------------------------------------------


@pytest.mark.parametrize("lines", [["M28 a.g", "M112"], ["M28 a.g\nM112"], ["M28", "G28", "M112"]])
def test_m112_acts_in_an_upload_that_has_no_file(bare, lines):
    for line in lines:
        bare.host.send(line)
    bare.passes(0.5)
    assert bare.printer.state.halted == "emergency stop by M112"
    bare.host.send("M999")
    bare.host.expect("ready again", 3)
    assert not bare.printer.state.halted
    bare.host.ok("M29")
    assert bare.host.ok("G28", 60)[-1] == "ok"


def test_m112_acts_where_a_strict_console_has_refused_the_upload(s):
    s.host.ok("M932")
    s.host.ok("M23 nothing.g")
    assert s.host.ok("M28 old.g") == REFUSED
    assert s.host.ok("M933") == ["ok"]
    s.host.ok("M112")
    assert s.printer.state.halted == "emergency stop by M112"


def test_m410_and_m108_act_in_an_upload_that_has_no_file(bare):
    other = Host(bare)
    other.send("G1 X200 F600", "M400")
    bare.host.ok("M28 a.g")
    bare.passes(2)
    bare.host.ok("M410")
    other.expect("^ok", 1)
    bare.until(lambda: bare.printer.rig.queue.standing, 2)
    at = bare.positions()["x"]
    assert 30 < at < 45
    other.ok("M400")
    other.send("M109 S250")
    bare.passes(1)
    bare.host.ok("M108")
    other.expect("^ok", 0.1)
    assert bare.positions()["x"] == at


def test_m112_after_queued_upload_is_text_if_upload_begins(s, tmp_path):
    """Both M28 wait behind M400."""
    s.host.ok("G92 X20 Y20 Z20")
    s.host.send("G1 X30 F600", "M400", "M28 old.g", "M112", "M29")
    s.passes(3)
    assert not s.printer.state.halted
    assert (tmp_path / "old.g").read_text() == "M112\n"
    s.host.send("G1 X40 F600", "M400", "M28 no/such.g", "M112", "M29")
    s.passes(0.5)
    assert not s.printer.state.halted  # nobody knows yet
    s.passes(3)
    assert s.printer.state.halted == "emergency stop by M112"


def test_m112_after_the_end_of_an_upload_in_hand_acts_at_once(s):
    s.host.ok("G92 X20 Y20 Z20")
    s.host.send("G1 X100 F600", "M400", "M28 old.g", "G28", "M29", "M112")
    s.passes(0.1)
    assert s.printer.state.halted == "emergency stop by M112"


def test_an_upload_that_lacks_a_line_leaves_the_old_file(s, tmp_path):
    s.host.ok("M28 old.g")
    s.host.ok("G1 X2")
    too_long = "this line is longer than 65536 characters and is left out"
    assert s.host.ok("M117 " + "x" * 70000, 10)[0] == f"echo:{too_long}. Send shorter lines"
    assert s.host.ok("M29") == [
        f"echo:error writing to file old.g: old.g: a line of the file was refused: {too_long}."
        " Shorten the line, then upload the file again.",
        "ok",
    ]
    assert (tmp_path / "old.g").read_text() == "G1 X1\n"
    s.host.ok("M28 old.g")
    assert s.host.ok("M29") == ["Done saving file.", "ok"]


def test_an_upload_into_a_folder_that_was_removed_is_not_stored(s, tmp_path):
    s.host.ok("M28 old.g")
    s.host.ok("G1 X2")
    shutil.rmtree(tmp_path)
    assert s.host.ok("M29") == [
        "echo:error writing to file old.g: /old.g: was removed while in use, or fails: its folder"
        " was removed. Insert the card again and mount it; replace it if that recurs.",
        "ok",
    ]
