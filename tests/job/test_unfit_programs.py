"""Prints from the card and from hosts that have commands which must not be left out."""

from __future__ import annotations

import pytest
from tests.support.macro_machine import macro, with_macros
from tests.support.scenario import Scenario

from passo.printer.unfit_commands import Skips

TEXT = "G28\nG1 X10 F3000\nPRINT_START BED=60\nG29\nG1 X20\n"


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "a.g").write_text(TEXT)
    return str(tmp_path)


def test_a_card_print_stops_before_its_first_move(folder):
    with Scenario("i3", card=folder) as s:
        s.host.ok("M32 a.g")
        s.host.expect("^echo:a.g:4: G29 levels the bed, and this machine has no probe")
        told = s.host.expect("^echo:Print of a.g stopped: a.g:3: PRINT_START is unknown here")
        assert "M24 U1" in told
        s.passes(5)
        assert s.printer.rig.job.locked_axes == [0, 1, 2]  # nothing has homed
        s.host.ok("M24")  # it does not begin by itself
        s.host.expect("^echo:Print of a.g stopped: a.g:3: PRINT_START", 1)
        s.host.ok("M24 U1")
        s.host.expect("^Done printing file$", 60)
        assert s.positions()["x"] == 20
        assert s.printer.rig.job.locked_axes == []


def test_printer_may_skip_commands_that_options_allow(folder):
    with Scenario("i3", card=folder, skips=Skips(unknown=True, levelling=True)) as s:
        s.host.ok("M32 a.g")
        s.host.expect("^Done printing file$", 60)
        assert s.positions()["x"] == 20


def test_a_print_that_may_clamp_goes_to_the_limit(tmp_path):
    (tmp_path / "a.g").write_text("G28\nG1 X999 F9000\nG1 X300\nG1 Y20\n")
    with Scenario("i3", card=str(tmp_path), skips=Skips(clamp=True)) as s:
        s.host.ok("M32 a.g")
        told = s.host.expect("X 999.000 mm is beyond the limit of 250.000 mm", 60)
        assert "a.g:2: " in told
        assert "such targets were moved to the limit (2 times)" in told
        s.host.expect("^Done printing file$")
        assert (s.positions()["x"], s.positions()["y"]) == (250, 20)
        s.host.ok("M32 a.g")  # the next print counts from 0
        assert "(2 times)" in s.host.expect("X 999.000 mm is beyond the limit", 60)
        answers = s.host.ok("G1 X999")  # consoles do not clamp
        assert any("X 999.000 mm is beyond the limit" in text for text in answers), answers
        assert s.positions()["x"] == 250


def test_a_print_may_leave_out_moves_beyond_the_reach(tmp_path):
    (tmp_path / "a.g").write_text("G28\nG1 Z20 F3000\nG1 X10 Y10\nG1 X70 Y70\nG1 Z10\n")
    with Scenario("delta", card=str(tmp_path), skips=Skips(clamp=True)) as s:
        s.host.ok("M32 a.g")
        s.host.expect("such moves were left out \\(2 times\\)", 60)
        s.host.ok("M23 a.g")
        assert s.host.ok("M114")[0].startswith("X:10.000 Y:10.000 Z:20.000")


def test_a_print_may_keep_its_tool(tmp_path):
    (tmp_path / "a.g").write_text("G28\nT1\nG1 X20 F3000\n")
    with Scenario("i3", card=str(tmp_path)) as s:
        s.host.ok("M32 a.g")
        s.host.expect("^echo:Print of a.g stopped: a.g:2: tool T1 does not exist", 60)
    with Scenario("i3", card=str(tmp_path), skips=Skips(ignore_tools=True)) as s:
        s.host.ok("M32 a.g")
        s.host.expect("^Done printing file$", 60)
        assert s.positions()["x"] == 20
        assert any("tool T1 does not exist" in text for text in s.host.ok("T1"))


def test_what_a_print_may_skip_concerns_its_macros_too(tmp_path):
    (tmp_path / "a.g").write_text("G28\nBEGIN\nG1 X20 F3000\n")
    machine = with_macros(macro("BEGIN", "OTHER_MACRO\nG1 X10 F3000"))
    with Scenario(machine, card=str(tmp_path)) as s:
        s.host.ok("M32 a.g")
        s.host.expect("^echo:Print of a.g stopped: a.g:2: OTHER_MACRO is unknown", 60)
        s.host.ok("M24 U1")
        s.host.expect("^Done printing file$", 60)
        assert s.positions()["x"] == 20


def test_commands_before_start_of_print_do_not_count(folder):
    with Scenario("i3", card=folder) as s:
        s.host.ok("G28")
        s.host.ok("M23 a.g")
        s.host.ok(f"M24 S{TEXT.index('G29')}")
        s.host.expect("^Done printing file$", 60)
        assert s.positions()["x"] == 20


def test_a_file_of_many_pieces_is_looked_through_to_its_end(tmp_path):
    text = "G28\n" + "G1 X1 F6000 ; back\nG1 X2 F6000 ; forth\n" * 20_000 + "G29\n"
    (tmp_path / "a.g").write_text(text)
    with Scenario("i3", card=str(tmp_path)) as s:
        s.host.ok("M32 a.g")
        s.host.expect("^echo:Print of a.g stopped: a.g:40002: G29 levels the bed", 5)
        assert s.printer.rig.job.locked_axes == [0, 1, 2]  # nothing has homed


@pytest.mark.parametrize("line", ["G29", "G84 X1 Z1 R1", "PRINT_START"])
@pytest.mark.parametrize("numbered", [True, False])
def test_a_host_that_prints_is_asked_to_pause(line, numbered):
    with Scenario("i3") as s:
        text = f"N1 {line}"
        checked = f"{text}*{xor(text)}"
        s.host.ok("M110 N0")
        answers = s.host.ok(checked if numbered else line)
        assert ("// action:pause" in answers) is numbered
        assert answers[0].startswith(
            "echo:G29 levels the bed" if line == "G29" else "echo:Unknown command: "
        )


def test_a_host_may_print_without_levelling():
    with Scenario("i3", skips=Skips(levelling=True)) as s:
        text = "N1 G29"
        s.host.ok("M110 N0")
        answers = s.host.ok(f"{text}*{xor(text)}")
        assert answers[0].startswith("echo:G29 does nothing here")
        assert "// action:pause" not in answers


def xor(text):
    total = 0
    for byte in text.encode():
        total ^= byte
    return total
