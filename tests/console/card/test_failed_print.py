"""A print from the card that stops at a line, and continues after it."""

import pytest
from tests.support.card_print import printed
from tests.support.scenario import Scenario


@pytest.mark.parametrize(
    ("data", "sentence"),
    [
        (b"G28 X\nG1 X12,5\n", ":2: 'X12,5' has a decimal comma. Write a point: X12.5"),
        (b"G28 X\nM104 S20,5\n", "'S20,5' has a decimal comma. Write a point: S20.5"),
        ("G28 X\n\xa0G1 X5\n".encode(), ":2: the no-break space (U+00A0) in"),
        ("G28 X\n".encode("utf-16"), ":1: the text is UTF-16, not UTF-8"),
        (b"G28 X\n#1=5\n", ":2: '#1=5' is a parameter"),
    ],
)
def test_file_with_other_text_stops_and_names_it(s, folder, data, sentence):
    (folder / "bad.g").write_bytes(data)
    s.host.ok("M32 bad.g")
    assert s.until(lambda: any(sentence in line for line in s.host.heard), 60)


def test_file_stops_at_failed_command_and_continues_after_it(s, folder):
    (folder / "wrong.g").write_text("G28\nG1 X5 F6000\nG1 X900\nG1 X9\nM104 S200\n")
    s.host.ok("M32 wrong.g")
    s.host.expect("Print of wrong.g stopped: wrong.g:3: .*X.*900", 30)
    s.passes(1)
    assert s.positions()["x"] == 5.0
    s.host.ok("M24")
    printed(s)
    assert s.positions()["x"] == 9.0


def test_internal_error_in_a_print_turns_heaters_off(folder, monkeypatch):
    def broken(*_):
        raise RuntimeError("by the test")

    with Scenario("i3", card=str(folder)) as s:
        s.host.ok("M140 S60")
        s.passes(1)
        monkeypatch.setattr(s.printer.dispatch, "run_command", broken)
        s.host.ok("M32 square.gcode")
        s.host.expect("Error:Printer halted: a fault of the program, RuntimeError: by the test", 5)
        s.passes(4)
        assert s.board.output_value("bed") == 0
        assert s.printer.rig.connection.heaters["bed"].target == 0


def test_connecting_host_does_not_change_a_failed_print(s, folder):
    (folder / "half.g").write_text("G28 X\nG1 X10\nG1 E10001\nG1 X20\n")
    s.host.ok("M32 half.g")
    s.host.expect("Print of half.g stopped", 60)
    s.host.ok("M21")
    assert s.host.ok("M24") == ["ok"]
    printed(s, 60)
    assert s.positions()["x"] == 20.0


@pytest.mark.parametrize("line", ["M106 P", "M104 Sabc", "G1 X", "M207 S"])
def test_a_word_without_a_number_stops_a_print_at_its_line(s, folder, line):
    (folder / "a.g").write_text(f"G92 X20 Y20 Z20\nG1 X30 F3000\n{line}\nG1 X40\n")
    s.host.ok("M32 a.g")
    word = line.split()[1][0]
    s.host.expect(f"^echo:Print of a.g stopped: a.g:3: the word '{word}' has no valid number", 5)
    s.passes(2)
    assert s.positions()["x"] == pytest.approx(30.0, abs=0.01)


def test_failed_print_reports_next_action_once(s, folder):
    (folder / "a.g").write_text("M140 S50\nM106 S255\nM36 nothere.g\nG4 P9\n")
    s.host.ok("M32 a.g")
    assert s.host.expect("stopped", 5) == (
        "echo:Print of a.g stopped: a.g:3: /nothere.g: is not"
        " on the card. List the files (M20), and give one of these names. Correct the cause, then"
        " continue after this command"
        " (M24), or cancel (M524)."
    )
    s.passes(1)
    bed = s.printer.rig.connection.heaters["bed"]
    assert (bed.target, s.board.output_value("part")) == (0, 0)
    s.host.ok("M24")
    s.passes(1)
    assert (bed.target, s.board.output_value("part")) == (50, 1600000)
    s.host.ok("M524")
    s.passes(1)
    assert (bed.target, s.board.output_value("part")) == (0, 0)
    s.host.ok("M24")
    s.host.expect("stopped", 5)  # from its beginning
    s.passes(1)
    assert bed.target == 0
    s.host.ok("M24")
    s.host.expect("Done printing file", 600)
    s.host.ok("M524")
    assert bed.target == 50  # nothing was left to cancel


def test_a_print_that_asks_for_statistics_continues_without_them(s, folder):
    (folder / "a.g").write_text("M78\nG28\nG1 X5\n")
    s.host.ok("M32 a.g")
    s.host.expect("echo:there is no place to store settings", 5)
    printed(s)
    assert s.positions()["x"] == 5.0
