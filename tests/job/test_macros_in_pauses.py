"""Macros around pauses, and prints that continue in the midst of one."""

from __future__ import annotations

from pathlib import Path

import pytest
from tests.support.macro_machine import macro, with_macros
from tests.support.scenario import Scenario

PAUSE = (
    macro("M25", "M118 pausing\nM25.1\nG91\nG1 Y7 F6000\nG90\nM118 away", rename_existing='"M25.1"')
    + macro("M24", "M118 back\nG1 Y1 F6000\nM24.1", rename_existing='"M24.1"')
    + macro("PAUSE_HERE", "G1 X30 F6000\nM601\nG91\nG1 Y7\nG1 Y3\nM118 away\nG90")
    + macro("LONG", "{% for i in range(8) %}\nG1 X{10 * i + 10} F600\n{% endfor %}")
    + macro("WRONG", "M601\nG1 X9999\nM118 never")
    + "[park]\nposition_mm = [100.0, 150.0]\n"
)


@pytest.fixture
def places(tmp_path):
    (tmp_path / "card").mkdir()
    return {"card": str(tmp_path / "card"), "state": str(tmp_path / "state")}


def put(places, text):
    (Path(places["card"]) / "a.g").write_text(text)


def at(s):
    return s.positions()["x"], s.positions()["y"]


def pauses(s):
    """A pause is reached, the machine stands."""
    assert s.until(lambda: s.assembly.services.jobs.runner.state.name == "PAUSED", 200)
    s.passes(20)


def test_the_rest_of_a_macro_that_pauses_comes_in_the_pause(places):
    put(places, "G28\nG1 Y20 F6000\nPAUSE_HERE\nG1 X50\n")
    with Scenario(with_macros(PAUSE), **places) as s:
        seen = []
        s.printer.lifetime.as_time_passes(lambda: seen.append(at(s)))
        s.host.ok("M32 a.g")
        pauses(s)
        assert "away" in s.host.heard
        assert (30, 30) in seen  # where the macro has gone, before the head parks
        assert at(s) == (100, 150)
        seen.clear()
        s.host.ok("M24.1")
        s.host.expect("^Done printing file$", 60)
        assert (30, 20) in seen  # where it paused
        assert at(s) == (50, 20)


def test_pause_and_return_of_a_console_may_be_macros(places):
    put(places, "G28\nG1 X10 F6000\nG1 X190 F600\n")
    with Scenario(with_macros(PAUSE), **places) as s:
        seen = []
        s.printer.lifetime.as_time_passes(lambda: seen.append(at(s)))
        s.host.ok("M32 a.g")
        assert s.until(lambda: s.positions()["x"] > 12, 200)
        s.host.ok("M25", 60)
        pauses(s)
        assert "away" in s.host.heard
        assert any(y == 7 for _, y in seen)
        assert at(s) == (100, 150)
        seen.clear()
        s.host.ok("M24", 60)
        assert "back" in s.host.heard
        s.host.expect("^Done printing file$", 100)
        assert any(y == 1 for _, y in seen)
        assert at(s) == (190, 0)


@pytest.mark.parametrize(("lifted_mm", "parked_mm"), [(3, 10), (30, 30)])
def test_park_never_lowers_what_a_macro_has_lifted(places, lifted_mm, parked_mm):
    put(places, "G28\nG1 X10 F6000\nLIFT\nG1 X50\n")
    lift = macro("LIFT", f"M25\nG91\nG1 Z{lifted_mm} F600\nG90")
    with Scenario(
        with_macros(
            PAUSE.replace("[macros.M25]", "[macros.OTHER]").replace(
                'rename_existing = "M25.1"\n', ""
            )
            + lift
        ),
        **places,
    ) as s:
        s.host.ok("M32 a.g")
        pauses(s)
        assert at(s) == (100, 150)
        assert s.printer.rig.job.machine_position[2] == pytest.approx(parked_mm)


def test_a_pause_by_a_console_returns_into_a_macro(places):
    put(places, "G28\nLONG\nG1 Y5\n")
    with Scenario(with_macros(PAUSE), **places) as s:
        seen = []
        s.printer.lifetime.as_time_passes(lambda: seen.append(at(s)))
        s.host.ok("M32 a.g")
        assert s.until(lambda: s.positions()["x"] > 33, 200)
        s.host.ok("M25.1", 60)
        pauses(s)
        assert at(s) == (100, 150)
        assert s.printer.status.read().job.line == 2
        s.host.ok("M24.1", 60)
        s.host.expect("^Done printing file$", 100)
        assert at(s) == (80, 5)
        assert max(x for x, y in seen if y == 0) > 79


def test_a_macro_that_fails_in_the_pause_leaves_the_print_paused(places):
    put(places, "G28\nG1 X20 F6000\nWRONG\nG1 X50\n")
    with Scenario(with_macros(PAUSE), **places) as s:
        s.host.ok("M32 a.g")
        pauses(s)
        assert any("a.g is paused, but its macro is not carried out" in x for x in s.host.heard)
        assert "never" not in s.host.heard
        s.host.ok("M24.1")
        s.host.expect("^Done printing file$", 60)
        assert at(s)[0] == 50


@pytest.mark.parametrize("changed", [False, True])
def test_after_a_power_cut_a_macro_is_carried_out_again(places, changed):
    counted = macro(
        "COUNT", "SET_GCODE_VARIABLE MACRO=COUNT VARIABLE=n VALUE={n + 1}", variables="{n = 0}"
    )
    long = macro("LONG", "M118 long {printer['gcode_macro COUNT'].n}" + "\nG1 X10 F300\nG1 X70")
    put(places, "G28\nCOUNT\nG92 Y-5\nCOUNT\nG1 X5 F6000\nLONG\nG1 Y5\n")
    with Scenario(with_macros(counted + long), **places) as s:
        s.host.ok("M32 a.g")
        s.host.expect("^long 2$", 100)
        assert s.until(lambda: s.positions()["x"] > 40, 200)
        left = s.positions()
    again = long.replace("F300", "F600") if changed else long
    with Scenario(with_macros(counted + again), **places) as s:
        for axis in "xyz":
            s.board.place(axis, left[axis])
        s.host.ok("M302 P1")
        told = s.host.ok("M1000", 600)
        if changed:
            assert any("the macros of the machine file have changed since" in x for x in told)
            return
        assert any(x.startswith("echo:Printing") and x.endswith(" 6") for x in told)
        s.host.expect("^long 2$", 100)
        s.host.expect("^Done printing file$", 600)
        assert at(s) == (70, 10)


def test_what_follows_a_change_of_filament_in_a_macro_comes_after_it(places):
    gcode = "M118 change {params.B}\nM600.1\nM118 changed\nG1 Y9 F6000"
    put(places, "G28\nG1 X20 F6000\nM600 B3\nG1 X50\n")
    text = macro("M600", gcode, rename_existing='"M600.1"')
    with Scenario(with_macros(text), **places) as s:
        s.host.ok("M32 a.g")
        pauses(s)
        assert "change 3" in s.host.heard
        assert "changed" not in s.host.heard
        s.host.ok("M24")
        s.host.expect("^changed$", 30)
        s.host.expect("^Done printing file$", 60)
        assert at(s) == (50, 9)
