"""A file that was stopped by one of its lines goes on behind it: no line is left out."""

import pytest
from tests.console.scenario import Scenario


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
        ("delta", "G1 X-60 Y-60 Z190 F9000"),  # beyond a motor's limit on its way
        ("scara", "G1 X-200 Y-200"),
    ],
)
def test_what_follows_a_move_that_is_refused_is_printed(tmp_path, machine, bad):
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
def test_a_print_goes_on_behind_it_after_a_power_cut_too(tmp_path, bad):
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


def test_an_axis_is_told_where_it_is_when_the_machine_stands():
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
