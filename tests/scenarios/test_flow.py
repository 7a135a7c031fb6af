"""M221: at once from beside a print, in its place in a program, for each tool of its own."""

import re
from pathlib import Path

import pytest
from tests.job.test_journal import journal_of
from tests.support.scenario import Host, Scenario

HEAD = "M302 P1\nG28\nG92 E0\nM83\nG1 X20 Y20 Z5 F6000\n"
LEG_MM, LEGS = 2.0, 6
# 20 s for each leg of 100 mm: two minutes, all of them planned at once.
SLOW = HEAD + "".join(f"G1 X{20 + 100 * (1 - i % 2)} E{LEG_MM} F300\n" for i in range(LEGS))
WHOLE_MM = LEG_MM * LEGS
RATE_MM_S = 0.1


@pytest.fixture
def places(tmp_path):
    (tmp_path / "card").mkdir()
    (tmp_path / "card" / "slow.g").write_text(SLOW)
    return {"card": str(tmp_path / "card"), "state": str(tmp_path / "state")}


@pytest.fixture
def s(places):
    with Scenario("i3", **places) as scenario:
        yield scenario


def filament(s):
    return s.positions()["e"]


def begun(s):
    s.host.ok("M32 slow.g")
    assert s.until(lambda: filament(s) > 1, 100)


def pushed_s(s, seconds):
    before = filament(s)
    s.passes(seconds)
    return filament(s) - before


def test_m221_during_a_print_acts_at_once(s):
    begun(s)
    assert s.printer.rig.queue.ahead_s > 4
    before = filament(s)
    s.host.ok("M221 S50")
    s.passes(0.25)
    assert pushed_s(s, 5) == pytest.approx(0.5 * RATE_MM_S * 5, abs=0.015)  # a step is 0.0105 mm
    s.host.expect("Done printing", 300)
    changed = before + 0.16 * RATE_MM_S  # the board has that much
    assert filament(s) == pytest.approx(changed + 0.5 * (WHOLE_MM - changed), abs=0.02)
    assert f"E:{WHOLE_MM:.4f}" in s.host.ok("M114")[0]


def test_m221_does_not_change_other_axes(s):
    begun(s)
    start, x = s.loop.time(), s.positions()["x"]
    s.host.ok("M221 S200")
    s.passes(2)
    assert s.positions()["x"] - x == pytest.approx(5 * (s.loop.time() - start), abs=0.05)


def test_m114_reports_the_programs_e_on_the_way(s):
    begun(s)
    s.host.ok("M221 S50")
    s.passes(2)
    words = dict(re.findall(r"([XE]):([-\d.]+)", s.host.ok("M114 R")[0].partition("Count")[0]))
    assert float(words["E"]) == pytest.approx(LEG_MM * (float(words["X"]) - 20) / 100, abs=0.03)


def test_m221_in_a_pause_applies_after_it(s):
    begun(s)
    before = filament(s)
    s.host.ok("M25")
    s.passes(5)
    s.host.ok("M221 S50")
    s.host.ok("M24")
    s.host.expect("Done printing", 300)
    changed = before + 0.16 * RATE_MM_S
    assert filament(s) == pytest.approx(changed + 0.5 * (WHOLE_MM - changed), abs=0.03)
    assert s.printer.rig.job.filament.flows == [0.5]


def test_flow_is_restored_with_interrupted_print(places):
    with Scenario("i3", **places) as s:
        begun(s)
        s.host.ok("M221 S50")
        s.passes(2)
        left = s.positions()
    assert journal_of(Path(places["state"]))[1].overrides["flow 0"][1] == 0.5
    with Scenario("i3", **places) as s:
        for stepper in "xyz":
            s.board.place(stepper, left[stepper])
        s.host.ok("M302 P1")
        s.host.ok("M1000", 600)
        assert s.host.ok("M221")[0] == "echo:E0 Flow: 50%"
        s.passes(5)
        assert pushed_s(s, 5) == pytest.approx(0.5 * RATE_MM_S * 5, abs=0.015)


TURN = ("G1 X120 E2 F3000", "M221 S50", "G1 X20 E2", "M221 S100")


def assert_in_order(s):
    assert s.until(lambda: s.positions()["x"] > 119.9, 60)
    assert filament(s) == pytest.approx(2, abs=0.02)
    assert s.until(lambda: s.positions()["x"] < 20.1, 60)
    assert filament(s) == pytest.approx(3, abs=0.02)


def test_m221_in_a_file_acts_in_order(s, places):
    (Path(places["card"]) / "turn.g").write_text(HEAD + "\n".join(TURN) + "\n")
    s.host.send("M32 turn.g")
    assert_in_order(s)


def test_m221_from_the_printing_console_acts_in_order(s):
    for line in HEAD.splitlines():
        s.host.ok(line, 60)
    s.host.send(*TURN)
    assert_in_order(s)


def test_m221_of_another_console_acts_at_once(s):
    asks = Host(s)
    for line in HEAD.splitlines():
        s.host.ok(line, 60)
    s.host.send("G1 X120 E2 F300")
    assert s.until(lambda: filament(s) > 1, 60)
    asks.ok("M221 S200")
    s.host.ok("M400", 60)
    changed = 1 + 0.2 * RATE_MM_S
    assert filament(s) == pytest.approx(changed + 2 * (2 - changed), abs=0.03)


@pytest.mark.parametrize("value", ["0", "-5"])
def test_no_flow_at_all_is_refused(s, value):
    s.host.ok("M221 S95")
    assert f"S is {value}: expected 1 to 1000 percent" in s.host.ok(f"M221 S{value}")[0]
    assert s.host.ok("M221")[0] == "echo:E0 Flow: 95%"


def test_each_tool_has_its_own_flow():
    with Scenario("dual-extruder") as s:
        s.host.ok("M221 T1 S50")
        assert s.host.ok("M221")[0] == "echo:E0 Flow: 100%"
        assert s.host.ok("M221 T1")[0] == "echo:E1 Flow: 50%"
        assert "T is 7: expected a tool with an extruder" in s.host.ok("M221 T7 S50")[0]
        assert s.printer.rig.job.filament.flows == [1.0, 0.5]
