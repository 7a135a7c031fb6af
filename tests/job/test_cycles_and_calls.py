"""Canned cycles and sub-programs in prints from the card: pauses, failures, power cuts."""

from __future__ import annotations

import pytest
from tests.support.scenario import Scenario

HOLES = [(10 * i, 10 * j) for j in (1, 2) for i in (1, 2, 3)]
CYCLE = (
    "G28\nF300\nG0 X5 Y5 Z5\nG83 X10 Y10 Z1 R3 Q0.7\nX20\nX30\nX10 Y20\nX20\nX30\nG80\n"
    "G0 X0 Y40 F3000\n"
)
CALLS = (
    "G28\nF300\nG0 X0 Y10 Z5\nM98 P20 L3\nG0 X0 Y20\nM98 P20 L3\nG0 X0 Y40 F3000\nM30\n"
    "O20\nG91\nG0 X10\nM98 P30\nG90\nM99\nO30\nG1 Z-4\nG0 Z4\nM99\n"
)
PROGRAMS = {"cycle.g": CYCLE, "calls.g": CALLS}
FIRST_HOLE = {"cycle.g": {8: 4, 9: 5}, "calls.g": {6: 3}}  # of the lines where a print continues


@pytest.fixture
def places(tmp_path):
    (tmp_path / "card").mkdir()
    for name, text in PROGRAMS.items():
        (tmp_path / "card" / name).write_text(text)
    return {"card": str(tmp_path / "card"), "state": str(tmp_path / "state")}


class Drilled:
    """Each hole whose bottom the tool has reached, as often as it was there."""

    def __init__(self, s):
        self.holes, self._down = [], False
        s.printer.lifetime.as_time_passes(lambda: self._look(s))

    def _look(self, s):
        x, y, z = (s.positions()[axis] for axis in "xyz")
        down = z < 1.3 and x > 5  # not at home
        if down and not self._down:
            self.holes.append((round(x), round(y)))
        self._down = down


def started(s, name):
    s.host.ok(f"M32 {name}")
    s.board.place("z", 20.0)
    drilled = Drilled(s)
    assert s.until(lambda: s.printer.rig.job.history.line_at(s.printer.rig.queue.now) >= 4, 200)
    return drilled


@pytest.mark.parametrize("name", PROGRAMS)
def test_all_holes_are_drilled(places, name):
    with Scenario("i3", **places) as s:
        drilled = started(s, name)
        s.host.expect("^Done printing file$", 600)
        assert drilled.holes == HOLES
        assert (s.positions()["x"], s.positions()["y"], s.positions()["z"]) == (0, 40, 5)


@pytest.mark.parametrize("name", PROGRAMS)
def test_a_pause_within_a_hole_returns_into_it(places, name):
    with Scenario("i3", **places) as s:
        drilled = started(s, name)
        for x in (10, 20):
            assert s.until(lambda x=x: s.positions()["x"] == x and s.positions()["z"] < 2.5, 200)
            before = list(drilled.holes)
            s.host.ok("M25")
            s.passes(5)
            s.host.ok("G91")
            s.host.ok("G0 X3 F6000", 30)
            s.host.ok("G90")
            s.host.ok("M400", 30)
            assert drilled.holes == before
            s.host.ok("M24")
        s.host.expect("^Done printing file$", 600)
        assert drilled.holes == HOLES
        assert (s.positions()["x"], s.positions()["y"], s.positions()["z"]) == (0, 40, 5)


@pytest.mark.parametrize("name", PROGRAMS)
def test_power_cut_in_a_cycle_or_call_repeats_its_line(places, name):
    with Scenario("i3", **places) as s:
        drilled = started(s, name)
        assert s.until(lambda: len(drilled.holes) == 5 and s.positions()["z"] > 2, 300)
        s.passes(1.5)
        left = s.positions()
    with Scenario("i3", **places) as s:
        for axis in "xyz":
            s.board.place(axis, left[axis])
        s.host.ok("M302 P1")
        drilled = Drilled(s)
        told = next(x for x in s.host.ok("M1000", 600) if x.startswith("echo:Printing"))
        line = int(told.split()[-1])
        s.host.expect("^Done printing file$", 600)
        # A call is carried out again as a whole.
        assert drilled.holes == HOLES[FIRST_HOLE[name][line] :]
        assert (s.positions()["x"], s.positions()["y"]) == (0, 40)
        assert s.positions()["z"] == pytest.approx(5, abs=0.05)


def test_a_line_that_fails_in_a_subprogram_is_left_out_with_m24(places, tmp_path):
    text = CALLS.replace("M98 P30\n", "M98 P30\nG0 Y999\n")
    (tmp_path / "card" / "bad.g").write_text(text)
    with Scenario("i3", **places) as s:
        drilled = started(s, "bad.g")
        for _ in range(6):
            s.host.expect("^echo:Print of bad.g stopped: bad.g:13: Y", 200)
            s.host.ok("M24")
        s.host.expect("^Done printing file$", 600)
        assert drilled.holes == HOLES


def test_a_console_has_cycles_but_no_subprograms(places):
    with Scenario("i3", **places) as s:
        s.host.ok("G28", 60)
        drilled = Drilled(s)
        for line in ("G0 X5 Y5 Z5 F3000", "G81 X10 Y10 Z1 R3 F300", "X20", "G80", "M400"):
            s.host.ok(line, 60)
        assert drilled.holes == HOLES[:2]
        answer = s.host.ok("M98 P20")[0]
        assert answer.startswith("echo:M98 P20 cannot be carried out: sub-programs are read from a")
        assert s.host.ok("M99")[-1].startswith("ok")


def test_a_missing_subprogram_stops_a_card_print_first(places, tmp_path):
    (tmp_path / "card" / "bad.g").write_text(CALLS.replace("O30", "O31"))
    with Scenario("i3", **places) as s:
        s.host.ok("M32 bad.g")
        s.host.expect("^echo:Print of bad.g stopped: bad.g:12: M98 P30 cannot be carried out", 5)
        assert s.printer.rig.job.locked_axes == [0, 1, 2]
