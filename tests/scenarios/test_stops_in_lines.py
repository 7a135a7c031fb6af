"""Stops that stand in a file or behind another command, and what they leave of lines in hand."""

from __future__ import annotations

import pytest
from tests.support.scenario import Host, Scenario

START = 20.0  # of X, mm, when the power comes


@pytest.fixture
def s():
    with Scenario() as scenario:
        for line in ("G92 X0 Y0 Z0", "G1 X10 F6000", "M400"):
            scenario.host.ok(line, 20)
        yield scenario


@pytest.mark.parametrize("line", ["M400 M112", "G91 M112", "(now) M112", "M104 S200 M112"])
def test_m112_after_another_command_halts(s, line):
    s.host.ok("M104 S150")
    s.host.ok(line)
    s.host.expect("Error:Printer halted: emergency stop by M112", 2)
    assert s.printer.rig.connection.heaters["hotend"].target == 0


@pytest.mark.parametrize("line", ["G1 X500 M112", "G1 E5M112", "X500 m0112", "M104 S900 M112"])
def test_m112_after_refused_command_halts(s, line):
    s.host.ok("G1 X10")
    s.host.ok(line)
    s.host.expect("Error:Printer halted: emergency stop by M112", 2)


@pytest.mark.parametrize(
    ("line", "what"),
    [
        (
            "M220 S50 G1 X12 F6000",
            lambda s: (s.positions()["x"], s.printer.rig.job.limits.speed_factor),
        ),
        (
            "M105 G1 X12",
            lambda s: (s.positions()["x"], s.printer.rig.job.limits.speed_factor * 0.5),
        ),
    ],
)
def test_move_after_immediate_command_is_done(s, line, what):
    s.host.ok(line)
    s.host.ok("M400")
    assert what(s) == (pytest.approx(START + 12, abs=0.02), 0.5)


def test_halted_printer_answers_query_and_skips_rest(s):
    s.host.ok("M112")
    s.passes(1)
    for line in ("M105 G1 X12", "M105 M104 S200"):
        assert s.host.ok(line)[0].startswith("echo:Printer stopped: emergency stop by M112")
    assert s.host.ok("M105")[-1].startswith("ok T:")
    s.host.ok("M999")
    s.passes(5)
    assert s.printer.rig.connection.heaters["hotend"].target == 0
    assert s.positions()["x"] == pytest.approx(START + 10, abs=0.02)


@pytest.mark.parametrize("first", ["M302 S170", "M220 S100", "M85 S0", "M113 S2"])
def test_parameters_belong_to_their_command(s, first):
    s.host.ok(f"{first} M104 S60")
    s.passes(0.5)
    assert s.printer.rig.connection.heaters["hotend"].target == 60
    assert (
        s.printer.heat.settings.cold.cold_c,
        s.printer.prompts.kill_s,
        s.host.session.busy_s,
    ) == (
        170,
        0,
        2,
    )
    assert s.printer.rig.job.limits.speed_factor == 1.0


@pytest.mark.parametrize("line", ["M0 P1 then M104 S100", "M1 P1 then M106 S255"])
def test_the_text_of_a_pause_is_not_a_command(s, line):
    s.host.ok(line)
    s.passes(2)
    assert s.printer.rig.connection.heaters["hotend"].target == 0
    assert s.printer.rig.commands.outputs.fans.get("part", 0) == 0


def test_m112_acts_before_the_line_that_contains_it(s):
    s.host.ok("M104 S150")
    s.host.send("G4 S60", "M400", "G1 X20 M112")
    s.passes(1)
    assert s.printer.state.halted == "emergency stop by M112"


@pytest.mark.parametrize(
    "line",
    [
        *("M117 M112", "G1 X11 ; M112", "G1 X11 (M112)", "M118 G1 M112", "M486 AItem112"),
        *("EXCLUDE_OBJECT_START NAME=Item112_stl_id_0", "M486 Aframe M112", "M105 M1120"),
    ],
)
def test_m112_in_a_message_stops_nothing(s, line):
    s.host.ok(line)
    s.passes(2)
    assert not s.printer.state.halted


def test_m112_in_a_file_halts(tmp_path):
    (tmp_path / "a.g").write_text("G92 X0\nM104 S200\nG1 X5 F600\nM400\nM112\nG1 X50\n")
    with Scenario(card=str(tmp_path)) as s:
        s.host.ok("M32 a.g")
        s.host.expect("Error:Printer halted: emergency stop by M112", 20)
        assert s.printer.rig.connection.heaters["hotend"].target == 0
        assert s.host.ok("M27")[0] == "Not SD printing"
        s.passes(5)
        assert s.positions()["x"] == pytest.approx(START + 5, abs=0.02)


def test_m410_in_a_file_ends_its_print(tmp_path):
    (tmp_path / "a.g").write_text("G92 X0\nG1 X5 F600\nM400\nM410\nG1 X50\n")
    with Scenario(card=str(tmp_path)) as s:
        s.host.ok("M32 a.g")
        s.host.expect("Print of a.g stopped: a.g:4: the print was stopped by M410", 20)
        s.passes(5)
        assert s.positions()["x"] == pytest.approx(START + 5, abs=0.02)


@pytest.mark.parametrize("own", [True, False])
def test_m410_drops_received_moves_too(s, own):
    lines = [f"G1 X{20 + 80 * (i % 2)} F3000" for i in range(40)] + ["X30", "M104 S0", "M105"]
    s.host.ok("M104 S150")
    s.host.send(*lines)
    s.passes(3)
    (s.host if own else Host(s)).ok("M410")
    s.passes(1)
    at = s.positions()
    s.passes(20)
    assert s.positions() == at
    assert len([x for x in s.host.heard if x.startswith("ok")]) == 4 + len(lines) + own
    assert "echo:G1 is not carried out: it was in hand when the machine was stopped" in s.host.heard
    # What is no move is done: the heater is off.
    assert s.printer.rig.connection.heaters["hotend"].target == 0
    s.host.ok("G1 X12")
    s.host.ok("M400", 20)
    assert s.positions()["x"] == pytest.approx(START + 12, abs=0.02)


def test_a_file_that_is_uploaded_keeps_lines_that_were_in_hand(tmp_path):
    with Scenario(card=str(tmp_path)) as s:
        other = Host(s)
        s.host.ok("G92 X0")
        s.host.send("G1 X50 F600", "M400", "M28 a.g", "G1 X1", "G1 X2", "M29")
        s.passes(1)
        other.ok("M410")
        s.passes(1)
        assert (tmp_path / "a.g").read_text() == "G1 X1\nG1 X2\n"
