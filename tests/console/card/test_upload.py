"""M28 and M29: a console writes a file of the card."""

import pytest
from tests.support.card_print import SQUARE
from tests.support.numbered_lines import numbered
from tests.support.scenario import Scenario


def test_uploaded_file_exists_after_m29(s, folder):
    assert s.host.ok("M28 new.gcode") == ["Writing to file: new.gcode", "ok"]
    s.host.ok("G28")
    s.host.ok("G1 X10 ; a comment")
    assert not (folder / "new.gcode").exists()
    assert s.positions()["x"] == 20.0  # nothing was carried out
    assert s.host.ok("M29") == ["Done saving file.", "ok"]
    assert (folder / "new.gcode").read_text() == "G28\nG1 X10\n"
    assert s.host.ok("M30 new.gcode") == ["File deleted:new.gcode", "ok"]
    assert not (folder / "new.gcode").exists()


def test_numbered_upload_drops_numbers_and_answers_queries(s, folder):
    lines = numbered((-1, "M110 N-1"), (0, "G28"), (1, "G1 X10"), (2, "M110 N2"), (3, "G1 X20"))
    s.host.ok("M28 n.gcode")
    for line in lines[:3]:
        s.host.ok(line)
    assert "T:" in s.host.ok("M105")[0]
    assert "not carried out while a file is written" in s.host.ok("G1 X5")[0]
    s.host.send(numbered((7, "G1 X99"))[0])
    s.host.expect("Resend: 2", 1)
    s.host.expect("^ok", 1)
    for line in lines[3:]:
        s.host.ok(line)
    assert s.host.ok("M29")[0] == "Done saving file."
    assert (folder / "n.gcode").read_text() == "G28\nG1 X10\nG1 X20\n"


def test_a_file_that_cannot_be_opened_executes_nothing(s):
    assert "echo:" in s.host.ok("M28 no/such/place.g")[0]
    s.host.ok("G28")
    s.host.ok("G1 X99")
    assert s.host.ok("M29") == ["ok"]
    s.passes(3)
    assert s.positions()["x"] == 20.0


def test_upload_by_aprinters_wrapper(s, folder):
    (folder / "old.g").write_text("G1 X1\n")
    s.host.ok("M932")
    assert s.host.ok("M28 Fold.g")[0] == "Writing to file: old.g"
    s.host.ok("G1 X2")
    s.host.ok("M29")
    s.host.ok("M933")
    assert (folder / "old.g").read_text() == "G1 X2\n"


def test_a_cut_upload_leaves_the_old_file(s, folder):
    s.host.ok("M28 square.gcode")
    s.host.send("G1 X1", "G1 X")
    s.host.session.close()
    assert (folder / "square.gcode").read_text() == SQUARE
    assert sorted(p.name for p in folder.iterdir()) == ["notes.txt", "parts", "square.gcode"]


def test_m928_logs_and_executes_lines(s, folder):
    s.host.ok("M928 log.g")
    s.host.ok("G92 X0")
    s.host.ok("G1 X7 F6000")
    s.host.ok("M29")
    s.host.ok("M400")
    assert s.positions()["x"] == 27.0
    assert (folder / "log.g").read_text() == "G92 X0\nG1 X7 F6000\n"


def test_an_upload_has_the_name_that_was_given(s, folder):
    (folder / "Fold.gcode").write_text("G4\n")
    for name, path in (
        ("Fish.gcode", "ish.gcode"),
        ("Fold.gcode", "Fold.gcode"),
        ("fish2.gcode", "fish2.gcode"),
        ("F/top.g", "top.g"),
        ("/abs.g", "abs.g"),
        ("F/parts/in.g", "parts/in.g"),
        ("Fparts/in2.g", "parts/in2.g"),
    ):
        s.host.ok(f"M28 {name}")
        s.host.ok("G1 X1")
        assert s.host.ok("M29")[0] == "Done saving file.", name
        assert (folder / path).read_text() == "G1 X1\n"
    assert not (folder / "Fish.gcode").exists()


@pytest.mark.parametrize("strict", [True, False])
def test_upload_to_absolute_path_ignores_directory(s, folder, strict):
    s.host.ok("M932" if strict else "M933")
    s.host.ok("M23 Dparts")
    names = ("F/top.g", "Fhere.g") if strict else ("/top.g", "here.g")
    for name, path in zip(names, ("top.g", "parts/here.g"), strict=True):
        s.host.ok(f"M28 {name}")
        s.host.ok("G1 X3")
        assert s.host.ok("M29")[0] == "Done saving file."
        assert (folder / path).read_text() == "G1 X3\n"


def test_m29_may_name_the_file_as_printrun_does(tmp_path):
    with Scenario("i3", card=str(tmp_path)) as s:
        for line in ("M28 gear.g", "G1 X1"):
            s.host.ok(line)
        assert "Done saving file." in s.host.ok("M29 gear.g")
        assert (tmp_path / "gear.g").read_text() == "G1 X1\n"
