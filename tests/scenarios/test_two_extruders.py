"""Two extruders: pauses, stops and settings while the program has read beyond a change of tools."""

from __future__ import annotations

import re

import pytest
from tests.scenarios.test_extruder_axes import text as extruder_axes
from tests.support.disturbed_prints import steps
from tests.support.scenario import Host, Scenario

from passo import config
from passo.config.machine import MachineConfig
from passo.motion.axis_slots import E

PER_MM = 95.5
PARK = "\n[park]\nposition_mm = [5.0, 180.0]\nretract_mm = 2.0\n"
# T1 prints, and T0 has lines that are read ahead when it stops.
BOTH = "\n".join(
    ["M302 P1", "G28", "T1", "M83"]
    + [f"G1 X{50 + 30 * (i % 2)} Y50 Z5 E2 F3600" for i in range(6)]
    + ["T0"]
    + [f"G1 X{50 + 30 * (i % 2)} E2 F1800" for i in range(6)]
)


def machine(text: str = "") -> MachineConfig:
    return config.load_text((text or config.shipped_text("dual-extruder")) + PARK)


def filament(s: Scenario) -> tuple[float, float]:
    """What the motors have pushed, mm."""
    first, second = (round(s.board.net_steps(e) / PER_MM, 1) for e in ("e", "e1"))
    return first, second


def moved(s: Scenario, *lines: str) -> tuple[float, float]:
    before = filament(s)
    for line in lines:
        s.host.ok(line, 60)
    s.host.ok("M400", 60)
    first, second = (round(b - a, 1) for a, b in zip(before, filament(s), strict=True))
    return first, second


@pytest.fixture
def s():
    with Scenario(machine()) as scenario:
        for line in ("M302 P1", "G28", "G1 X50 Y50 Z5 F6000", "M83", "G1 E50 F3000", "M400"):
            scenario.host.ok(line, 60)
        yield scenario


@pytest.fixture
def printing(tmp_path):
    """T1 prints its third line."""
    (tmp_path / "a.g").write_text(BOTH)
    with Scenario(machine(), card=str(tmp_path)) as scenario:
        scenario.host.ok("M32 a.g")
        job, queue = scenario.printer.rig.job, scenario.printer.rig.queue
        assert scenario.until(lambda: job.history.line_at(queue.now) >= 8, 300)
        assert job.tool == 0  # read ahead
        yield scenario


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory) -> dict[str, int]:
    """Steps of the whole print."""
    folder = tmp_path_factory.mktemp("card")
    (folder / "a.g").write_text(BOTH)
    with Scenario(machine(), card=str(folder)) as scenario:
        scenario.host.ok("M32 a.g")
        scenario.host.expect("Done printing", 300)
        assert filament(scenario) == pytest.approx((12, 12), abs=0.1)
        return steps(scenario)


@pytest.mark.parametrize(
    "lines",
    [
        (),
        ("M400",),
        ("T0", "M400"),
        ("T0", "T1"),
        ("T0", "G92 E0", "T1"),
        ("T0", "G1 X100 F6000", "M400"),
        ("T0", "G1 X100 F6000", "M400", "T1"),
    ],
)
def test_pause_retracts_printed_filament_and_restores_it(printing, undisturbed, lines):
    printing.host.ok("M25")
    printing.passes(8)
    at_stop = printing.printer.rig.job.stops.position[E]
    assert filament(printing) == pytest.approx((0, at_stop - 2), abs=0.1)
    for line in lines:
        printing.host.ok(line, 20)
    printing.host.ok("M24")
    printing.host.expect("Done printing", 60)
    assert steps(printing) == undisturbed


def test_extrusion_in_pause_uses_tool_in_use(printing):
    printing.host.ok("M25")
    printing.passes(8)
    assert moved(printing, "G91", "G1 E3 F300") == pytest.approx((0, 3), abs=0.2)
    assert moved(printing, "T0", "G1 E4 F300") == pytest.approx((4, 0), abs=0.1)
    printing.host.ok("M24")
    printing.host.expect("Done printing", 60)
    assert filament(printing) == pytest.approx((12 + 4, 12 + 3), abs=0.1)


@pytest.mark.parametrize("stop", ["M410", "M524"])
def test_after_a_stop_each_extruder_keeps_its_position(printing, stop):
    printing.host.ok(stop)
    printing.passes(2)
    assert printing.printer.rig.job.tool == 1  # its nozzle is over the print
    printing.host.ok("M83")
    assert moved(printing, "G1 E1 F300") == pytest.approx((0, 1), abs=0.1)
    assert moved(printing, "T0", "G1 E1") == pytest.approx((1, 0), abs=0.1)
    assert moved(printing, "T1", "G1 E1") == pytest.approx((0, 1), abs=0.1)


def test_a_pause_right_after_a_change_of_tools(s):
    s.host.ok("T1")
    before = filament(s)
    s.host.send("M600")
    s.passes(8)
    assert filament(s) == pytest.approx((before[0], before[1] - 2), abs=0.1)
    Host(s).send("M108")
    s.passes(8)
    assert filament(s) == before


@pytest.mark.parametrize(
    "lines", [("T1", "M92 T1 E95.5"), ("M92 T1 E95.5", "T1"), ("T1", "M502", "M302 P1")]
)
def test_scales_of_an_extruder_that_does_not_move(s, lines):
    assert moved(s, *lines) == (0, 0)
    assert moved(s, "G1 E1 F300") == pytest.approx((0, 1), abs=0.1)
    assert moved(s, "T0", "G1 E1") == pytest.approx((1, 0), abs=0.1)


def test_each_extruder_has_its_own_retraction(s):
    s.host.ok("T1")
    assert moved(s, "G10") == pytest.approx((0, -3), abs=0.1)
    assert moved(s, "T0", "G11") == (0, 0)
    assert moved(s, "G10") == pytest.approx((-3, 0), abs=0.1)
    assert moved(s, "G11") == pytest.approx((3, 0), abs=0.1)
    assert moved(s, "T1", "G11") == pytest.approx((0, 3), abs=0.1)


def test_extruders_of_one_nozzle_lift_it_once(s):
    s.host.ok("M207 Z0.5")
    for line, z in (("G10", 5.5), ("T1", 5.0), ("G10", 5.5), ("G11", 5.0), ("T0", 5.0)):
        s.host.ok(line)
        s.host.ok("M400", 20)
        assert s.positions()["z"] == pytest.approx(z, abs=0.01), line
    assert moved(s, "G11") == pytest.approx((3, 0), abs=0.1)
    assert s.positions()["z"] == pytest.approx(5.0, abs=0.01)


def test_stop_forgets_a_retraction_not_executed(s):
    s.host.ok("M207 Z0.5")
    s.host.send("G1 X200 F1200", "G10")
    s.passes(1)
    s.host.ok("M410")
    assert moved(s, "G11") == (0, 0)
    assert moved(s, "G10") == pytest.approx((-3, 0), abs=0.1)


@pytest.mark.parametrize("line", ["G1 U20 F300", "G1 U-20 F300", "G1 V9 F300"])
def test_filament_of_axes_may_be_pushed_in_a_pause(tmp_path, line):
    moves = [f"G1 X{50 + i % 2 * 40} Y{50 + i} U1 F1500" for i in range(12)]
    (tmp_path / "a.g").write_text("\n".join(["M302 P1", "G28", "M83", *moves, "G1 V5 F600"]))
    own = re.sub(r"\[park\]\n(.+\n)*", "", extruder_axes())
    with Scenario(machine(own), card=str(tmp_path)) as s:
        s.host.ok("M32 a.g")
        assert s.until(lambda: s.printer.rig.job.history.line_at(s.printer.rig.queue.now) >= 8, 300)
        for command in ("M25", "M400", "G91", line, "M24"):
            s.host.ok(command, 60)
        s.host.expect("Done printing", 60)
        mm = float(line.split()[1][1:])
        u, v = (mm, 0) if "U" in line else (0, mm)
        at = s.positions()
        assert (at["u"], at["v"]) == pytest.approx((12 + u, 5 + v), abs=0.05)


def after_a_pause(tmp_path, *lines: str) -> tuple[dict[str, float], list[str]]:
    """Where a print ends whose tools change behind a pause with these lines, and the settings."""
    moves = [f"G1 X{100 + 20 * (i % 2)} F3000" for i in range(40)]
    (tmp_path / "a.g").write_text(
        "\n".join(["M302 P1", "G28", "T0", "G1 X100 Y50 Z5 F6000", *moves, "T1", "G1 X90", "M400"])
    )
    with Scenario(machine(), card=str(tmp_path)) as s:
        s.host.ok("M32 a.g")
        assert s.until(lambda: s.positions()["x"] > 115, 100)
        for line in ("M25", *lines, "M24"):
            s.host.ok(line, 60)
        assert s.until(lambda: "Done printing file" in s.host.heard, 200)
        return s.positions(), list(s.printer.settings.lines())


def test_tool_offset_set_in_pause_holds_after_it(tmp_path):
    """M218 of the first tool leaves the second one where it was."""
    assert after_a_pause(tmp_path)[0]["x"] == 65.0
    end, settings = after_a_pause(tmp_path, "M218 T0 X3")
    assert (end["x"], "M218 T0 X3 Y0 Z0" in settings) == (65.0, True)
    assert after_a_pause(tmp_path, "M218 T1 X20")[0]["x"] == 70.0


def test_filament_settings_of_pause_hold_after_it(tmp_path):
    lines = ("M207 S1", "M208 S0.5", "M209 S1", "M603 T0 L50", "M200 T1 D2.85")
    _, settings = after_a_pause(tmp_path, *lines)
    assert {"M209 S1", "M603 T0 L50 U100", "M200 T1 D2.85"} <= set(settings)
    assert any(x.startswith("M207 S1 ") for x in settings)
    assert any(x.startswith("M208 S0.5 ") for x in settings)


def test_a_tools_height_holds_for_a_move_that_does_not_name_z():
    with Scenario(machine()) as s:
        lines = ("M302 P1", "G28", "M218 T1 X0 Y0 Z-0.6", "M83", "G1 Z0.8 F600")
        for line in (*lines, "G1 X100 Y100 E1 F6000", "M400", "T1"):
            s.host.ok(line, 60)
        assert s.host.ok("M114")[0].startswith("X:100.000 Y:100.000 Z:0.800")
        assert moved(s, "G1 X110 Y100 E1") == pytest.approx((0, 1), abs=0.1)
        at = "X:110.000 Y:100.000 Z:0.800 E:2.0000 Count X:8800 Y:8000 Z:560"
        assert s.host.ok("M114")[0] == at


OFFSET = """M302 P1
G28
M83
M218 T1 X-20 Y2 Z-0.6
G1 X50 Y50 Z5 F6000
G1 Y70 E1 F600
G1 Y50 E1
T1
G4 P3000
G1 X50 E1
G1 Y70 E1
G1 Y50 E1
"""


@pytest.mark.parametrize("tools", [(), ("T0", "G1 Y40 F6000"), ("T0", "T1", "G91", "G1 X5 F6000")])
@pytest.mark.parametrize("line", [6, 9, 11])
def test_a_pause_about_a_change_of_tools_moves_no_axis_twice(tmp_path, line, tools):
    """In the last lines of T0, between the change and the first move, and in the lines of T1."""
    (tmp_path / "a.g").write_text(OFFSET)
    with Scenario(machine(), card=str(tmp_path)) as s:
        s.host.ok("M32 a.g")
        job, queue = s.printer.rig.job, s.printer.rig.queue
        assert s.until(lambda: job.history.line_at(queue.now) >= line, 300)
        for command in ("M25", *tools, "M400", "M24"):
            s.host.ok(command, 60)
        s.host.expect("Done printing", 60)
        at = s.positions()
        assert [at[a] for a in "xyz"] == pytest.approx([70, 48, 5.6], abs=0.01)
        assert filament(s) == pytest.approx((2, 3), abs=0.1)


def test_speed_change_before_tool_move_keeps_position(tmp_path):
    """M220 plans anew what was read ahead."""
    (tmp_path / "a.g").write_text(OFFSET)
    with Scenario(machine(), card=str(tmp_path)) as s:
        s.host.ok("M32 a.g")
        job, queue = s.printer.rig.job, s.printer.rig.queue
        for line, speed in ((6, "M220 S50"), (9, "M220 S200"), (11, "M290 Z0.1")):
            assert s.until(lambda line=line: job.history.line_at(queue.now) >= line, 300)
            s.host.ok(speed)
        s.host.expect("Done printing", 60)
        at = s.positions()
        assert [at[a] for a in "xyz"] == pytest.approx([70, 48, 5.7], abs=0.01)


def test_stop_between_tools_keeps_nozzle_position(printing):
    """T1 stops; the offset of the T0 that was read ahead is not carried out."""
    printing.host.ok("M410")
    printing.passes(2)
    job = printing.printer.rig.job
    assert job.tools.offset_due == [0, 0, 0]
    assert job.program_position[0] == pytest.approx(job.machine_position[0] + 25)
