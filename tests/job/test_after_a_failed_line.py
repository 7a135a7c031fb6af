"""A file that was stopped by one of its lines goes on behind it: no line is left out."""

import pytest
from tests.support.macro_machine import macro, with_macros
from tests.support.scenario import Scenario

from passo.job.live.journal import Journal


def printed_lines(tmp_path, machine, lines, state=None):
    """Where all is at the end, if the file is gone on with after each of its bad lines."""
    (tmp_path / "a.g").write_text("\n".join(lines) + "\n")
    with Scenario(machine, card=str(tmp_path), state=state) as s:
        s.host.ok("G28", 60)
        s.host.ok("M302 P1")
        s.host.ok("M23 a.g")
        stops = []
        for _ in range(4):
            before = len(s.host.heard)
            s.host.ok("M24")
            s.host.expect("^Done printing file|^echo:Print of a.g stopped", 120)
            s.passes(2)
            stops += [x for x in s.host.heard[before:] if "stopped" in x]
            if "Done printing file" in s.host.heard:
                break
        return s.positions(), [x.split("a.g:")[1].split(":")[0] for x in stops]


WAY = [f"G1 X{i} E0.1 F3000" for i in range(1, 31)]


@pytest.mark.parametrize(
    ("machine", "bad"),
    [
        ("i3", "G1 E10001"),
        ("i3", "G1 X990"),
        ("i3", "G2 I20 J0 E5"),  # a whole circle, the half of it before Y 0
        ("delta", "G3 I18 J33 E1"),  # between the soft limits, beyond the limit radius
        ("delta", "G1 X-60 Y-60 Z190 F9000"),  # beyond a motor's limit on its way
        ("scara", "G1 X-200 Y-200"),
        ("scara", "G2 J60 E1"),
    ],
)
def test_print_continues_after_refused_move(tmp_path, machine, bad):
    start = ["G1 X100 Y100 F3000"] if machine == "scara" else ["G1 Z20 F3000"]
    ways = [f"G1 X{100 + i} E0.1 F3000" for i in range(1, 31)] if machine == "scara" else WAY
    good, none = printed_lines(tmp_path, machine, ["M83", *start, *ways])
    assert none == []
    with_bad = ["M83", *start, *ways[:10], bad, *ways[10:20], bad, *ways[20:]]
    for state in (None, str(tmp_path / "state")):  # the journal reads the file, too
        found, stops = printed_lines(tmp_path, machine, with_bad, state)
        assert stops == ["13", "24"]
        assert found == good


@pytest.mark.parametrize("bad", ["G1 E10001", "G1 X990", "G2 X5 Y5", "T7", "M104 SX"])
def test_failed_line_print_resumes_also_after_power_cut(tmp_path, bad):
    places = {"card": str(tmp_path), "state": str(tmp_path / "state")}
    lines = ["M302 P1", "G28", "M83", "G1 Y20 F3000", bad, *WAY]
    lines = [x.replace("F3000", "F300") for x in lines]
    (tmp_path / "a.g").write_text("\n".join(lines) + "\n")
    with Scenario("i3", **places) as s:
        s.host.ok("M32 a.g")
        s.host.expect("Print of a.g stopped: a.g:5: ", 60)
        s.passes(5)
        s.host.ok("M24")
        assert s.until(lambda: 10 < s.positions()["x"] < 11, 60)
        left = s.positions()
    with Scenario("i3", **places) as s:
        for stepper in "xyz":
            s.board.place(stepper, left[stepper])
        s.host.ok("M302 P1")
        s.host.send("M1000")
        s.host.expect("echo:Printing a.g from line 1[0-9]$", 60)
        s.host.expect("Done printing file", 60)
        assert s.positions()["x"] == 30.0


@pytest.mark.parametrize("meanwhile", [(), ("M104 S0", "G1 Z30 F3000"), ("M84",)])
def test_print_stopped_at_failure_is_offered_after_cut(tmp_path, meanwhile):
    places = {"card": str(tmp_path), "state": str(tmp_path / "state")}
    lines = ["M302 P1", "G28", "M83", "G1 Y20 Z0.2 F3000", "M104 S60", *WAY[:10], "T7", *WAY[10:]]
    (tmp_path / "a.g").write_text("\n".join(lines) + "\n")
    with Scenario("i3", **places) as s:
        s.host.ok("M32 a.g")
        s.host.expect("Print of a.g stopped: a.g:16: ", 60)
        for line in meanwhile:
            s.host.ok(line, 60)
        s.passes(5)
        left = s.positions()
    with Scenario("i3", **places) as s:
        for stepper in "xyz":
            s.board.place(stepper, left[stepper])
        s.host.ok("M302 P1")
        assert "a.g was interrupted at line 15. M1000 resumes" in s.printer.state.greeting()
        s.host.send("M1000")
        s.host.expect("echo:Printing a.g from line 15$", 600)
        assert s.board.temperature("hotend") > 57
        s.host.expect("Print of a.g stopped: a.g:16: ", 60)
        s.host.ok("M24")
        s.host.expect("Done printing file", 60)
        assert s.positions()["x"] == 30.0
        assert s.positions()["z"] == pytest.approx(0.2, abs=0.02)
    assert Journal(tmp_path / "state").read() is None


@pytest.mark.parametrize("end", ["M524", "M23 b.g", "M22", "M26 S0", "M32 b.g", "M410"])
def test_print_given_up_after_failure_is_not_offered(tmp_path, end):
    places = {"card": str(tmp_path), "state": str(tmp_path / "state")}
    (tmp_path / "a.g").write_text("G28\nG1 X20 F6000\nG1 X9999\nG1 X40\n")
    (tmp_path / "b.g").write_text("G1 X10 F6000\n")
    with Scenario("i3", **places) as s:
        s.host.ok("M32 a.g")
        s.host.expect("" if end == "M410" else "Print of a.g stopped", 60)
        s.passes(3)
        s.host.ok(end)
        s.passes(3)
        assert Journal(tmp_path / "state").read() is None


def heat(s):
    heaters = s.printer.rig.connection.heaters
    return {
        name: heater.target for name, heater in heaters.items()
    }, s.printer.rig.commands.outputs.fans


@pytest.mark.parametrize("bad", ["G1 X990", "T7", "M104 SX", "RAISES", "M23 none.g"])
def test_failed_print_cools_until_it_continues(tmp_path, bad):
    """Like a cancelled print. The user sets the second heater in the meantime; it stays so."""
    machine = with_macros(macro("RAISES", "{ action_raise_error('no') }"))
    lines = ["G28", "M104 S60", "M140 S40", "M109 S60", "M106 S255", "G1 Z5 F3000", bad, "G1 X9"]
    (tmp_path / "a.g").write_text("\n".join(lines) + "\n")
    with Scenario(machine, card=str(tmp_path)) as s:
        s.host.ok("M32 a.g")
        s.host.expect("Print of a.g stopped: a.g:7: ", 100)
        s.host.expect("Heaters and fans are off; M24 sets them again")
        s.passes(1)
        assert heat(s) == ({"hotend": 0.0, "bed": 0.0}, {"part": 0.0})
        s.passes(100)
        cold_c = s.board.temperature("hotend")
        assert cold_c < 50
        s.host.ok("M140 S45")
        s.host.ok("M24")
        s.host.expect("The print warms up before it continues")
        s.passes(0.5)
        assert heat(s) == ({"hotend": 60.0, "bed": 45.0}, {"part": 1.0})
        assert s.positions()["x"] == 0.0
        s.host.expect("Done printing file", 100)
        assert s.board.temperature("hotend") > 57
        assert s.positions()["x"] == 9.0


def test_failed_print_that_begins_again_stays_cold(tmp_path):
    (tmp_path / "a.g").write_text("M104 S60\nT7\nG4 P100\n")
    with Scenario("i3", card=str(tmp_path)) as s:
        for again in ("M26 S0", "M23 a.g"):
            s.host.ok("M32 a.g")
            s.host.expect("Print of a.g stopped: a.g:2: ", 10)
            s.host.ok(again)
            s.host.ok("M26 S12")
            s.host.ok("M24")
            s.host.expect("Done printing file", 10)
            assert heat(s)[0] == {"hotend": 0.0, "bed": 0.0}


def test_print_that_did_nothing_does_not_block_the_next(tmp_path):
    places = {"card": str(tmp_path), "state": str(tmp_path / "state")}
    (tmp_path / "auto0.g").write_text("T7\n")
    for _ in range(2):
        with Scenario("i3", **places) as s:
            assert s.printer.state.greeting() == ""
            s.passes(10)
            assert s.host.ok("M27")[0] == "Not SD printing"


def test_an_axis_gets_its_position_at_standstill():
    """Else the place would jump in the midst of a plan that may be planned anew."""
    with Scenario("i3") as s:
        s.host.ok("G28 X Y", 60)
        s.host.ok("G1 X100 Y100 F3000")
        s.passes(0.5)
        s.host.send("G92 Z5", "G1 Z6 F300", "G1 X10 Y10 F3000", "M400")
        s.passes(1)
        s.host.send("M220 S50", "M400", "M114 R")
        s.host.expect("^X:10.000 Y:10.000 Z:6.000", 60)
        at = s.positions()
        assert (at["x"], at["y"], at["z"]) == (10.0, 10.0, 21.0)
