"""G28 with any tool, from any place: the axes end at home, and M114 reads where they are."""

import pytest
from tests.support.scenario import Scenario

from passo import config
from passo.config.machine import MachineConfig


def offsets(machine: MachineConfig) -> dict[tuple[float, ...], int]:
    """A tool for each offset."""
    return {tuple(tool.offset_mm): n for n, tool in reversed([*enumerate(machine.all_tools)])}


def place(machine: MachineConfig, offset: tuple[float, ...], fraction: float) -> dict[str, float]:
    """A place of a nozzle: this fraction of each axis with an endstop or, with arms, above the
    bed."""
    if machine.axes_of_arms:
        return {"x": 0.4 * machine.home_point[0] + 5, "y": 30.0, "z": 20 + 30 * fraction}
    ends = [(n, machine.axes[n], mm) for n, mm in zip("xyz", offset, strict=True)]
    at = {n: a.min_mm + fraction * (a.max_mm - a.min_mm) + mm for n, a, mm in ends}
    return {n: mm for n, mm in at.items() if n in machine.homing}


def sends(s: Scenario, *lines: str) -> None:
    """Sends lines; all of them must succeed."""
    for line in lines:
        said = [x for x in s.host.ok(line, 200) if x != "echo:busy: processing"]
        assert said == ["ok"], line


def reported(s: Scenario) -> dict[str, float]:
    words = s.host.ok("M114")[0].split(" E:")[0].split()
    return {word[0].lower(): float(word[2:]) for word in words}


@pytest.mark.parametrize("name", [m for m in config.shipped_machines() if config.load(m).homing])
def test_every_tool_homes_from_any_place(name):
    with Scenario(name) as s:
        sends(s, "G28", "M400")
        home, shown = s.positions(), reported(s)
        for offset, tool in offsets(s.machine).items():
            for fraction in (0.0, 0.7):
                if len(s.machine.tools) > 1:
                    sends(s, f"T{tool}")
                at = place(s.machine, offset, fraction)
                sends(s, f"G1 {' '.join(f'{n}{mm:.3f}' for n, mm in at.items())} F9000", "M400")
                sends(s, "G28 X", "G28", "M400")
                for stepper, mm in s.positions().items():
                    step = 1 / s.machine.steppers[stepper].steps_per_unit
                    assert mm == pytest.approx(home[stepper], abs=1.5 * step), stepper
                tool_shown = {n: shown[n] + mm for n, mm in zip("xyz", offset, strict=True)}
                for axis, mm in tool_shown.items():
                    assert reported(s)[axis] == pytest.approx(mm, abs=0.011), axis


def test_switch_stuck_behind_home_ends_the_search():
    with Scenario("dual-extruder") as s:
        sends(s, "G28", "T1", "G1 X5 F6000", "M400")  # carriage at -20
        s.board.force_switch("x", True)
        said = s.host.ok("G28 X", 60)[-2]
        assert "switch x at ^X_MIN is still triggered 24 mm away from 0 mm" in said
        assert s.positions()["x"] == pytest.approx(4.0, abs=0.02)
        assert reported(s)["x"] == pytest.approx(29.0, abs=0.02)
        assert "axis X is not homed" in s.host.ok("G1 X10")[0]


@pytest.mark.parametrize(("name", "x"), [("i3", 60.0), ("corexy", 60.0)])
def test_place_is_counted_when_a_switch_is_stuck(name, x):
    with Scenario(name) as s:
        sends(s, "G28", f"G1 X{x} Y30 F6000", "M400")
        s.board.force_switch("x", True)
        assert "is still triggered 3 mm away" in s.host.ok("G28 X", 60)[-2]
        assert reported(s)["x"] == pytest.approx(x + 3, abs=0.02)
        s.board.force_switch("x", None)
        sends(s, "G28 X")
