"""The end of a pause: the way back, or the print stays paused and says why there is none."""

import pytest
from tests.support.scenario import Host, Scenario

from passo import config

LOST = "axis X is not homed"


def program(x: int, y: int, z: int) -> str:
    turns = [f"G1 X{x + i % 2 * 5} Y{y + i * 0.05:g} E0.1 F1500" for i in range(100)]
    return "\n".join(
        ["G28", "M83", "M302 P1", f"G1 Z{z} F6000", f"G1 X{x} Y{y}", *turns, f"G1 X{x}"]
    )


def paused(machine, text, tmp_path, until_s=15):
    (tmp_path / "a.g").write_text(text)
    s = Scenario(machine, card=str(tmp_path))
    s.host.send("M32 a.g")
    s.passes(until_s)
    s.host.send("M25")
    return s


def goes_on(s: Scenario, x: float, y: float, z: float) -> None:
    """To the end of the file, and no filament is missing."""
    s.host.expect("^Done printing file$", 120)
    assert not s.printer.state.halted
    assert s.positions()["e"] == pytest.approx(10.0, abs=0.02)
    assert s.printer.rig.job.machine_position[:3] == pytest.approx([x, y, z], abs=1e-6)


@pytest.mark.parametrize("first", [["G28"], ["M84", "G28"]])
@pytest.mark.parametrize(
    ("machine", "place"),
    [("delta", (-10, 5, 5)), ("delta", (40, 0, 165)), ("rotary-delta", (5, 5, 5))],
)
def test_arms_return_from_the_top_after_a_pause(tmp_path, machine, place, first):
    with paused(machine, program(*place), tmp_path) as s:
        s.passes(15)
        for line in first:
            s.host.ok(line, 60)
        assert s.printer.rig.job.machine_position[2] > place[2] + 10
        s.host.ok("M24")
        goes_on(s, place[0], place[1] + 4.95, place[2])


@pytest.mark.parametrize("gap_s", [0.0, 0.02, 0.05])
def test_m24_is_refused_while_m84_is_pending(tmp_path, gap_s):
    with paused("i3", program(50, 50, 5), tmp_path) as s:
        s.passes(10)
        s.host.send("M84")
        s.passes(gap_s)
        other = Host(s)
        other.send("M24")
        other.expect(f"stays paused: {LOST}", 5)
        s.passes(5)
        assert s.host.ok("M27")[0].startswith("SD printing byte")
        assert LOST in other.ok("M24")[0]
        s.host.ok("G28", 60)
        other.ok("M24")
        goes_on(s, 50, 54.95, 5)


def test_m84_m24_and_g28_sent_together(tmp_path):
    with paused("i3", program(50, 50, 5), tmp_path) as s:
        s.host.send("M84", "M24", "G28")
        Host(s).send("M24")
        s.host.expect(f"stays paused: {LOST}", 5)
        s.passes(40)
        s.host.ok("M24")
        goes_on(s, 50, 54.95, 5)


def test_a_heater_that_fails_on_the_way_is_waited_for_again(tmp_path):
    """A sensor that breaks while the new filament's temperature is waited for."""
    mild = 'max_c = 285.0\non_fault = "heater"\n'
    text = config.shipped_text("i3").replace("max_c = 285.0\n", mild, 1)
    program = "G92 X20 Y20 Z20\nM302 P1\nG1 X50 F6000\nM600 S100 U20 L20\nG1 X60\n"
    (tmp_path / "a.g").write_text(program)
    with Scenario(config.load_text(text), card=str(tmp_path)) as s:
        s.host.ok("M32 a.g")
        s.passes(20)
        low = s.positions()
        s.host.ok("M24")
        s.passes(2)
        s.board.force_sensor("hotend", 0.0)
        s.host.expect("Print of a.g stays paused: heater hotend was switched off", 10)
        s.passes(10)
        assert s.positions() == low
        s.board.force_sensor("hotend", None)
        s.passes(2)
        s.host.ok("M922")
        s.host.ok("M24")
        s.host.expect("^Done printing file$", 120)
        assert s.printer.rig.connection.heaters["hotend"].celsius > 95
        way = {name: s.positions()[name] - low[name] for name in "xe"}
        assert way == pytest.approx({"x": 10.0, "e": 22.0}, abs=0.02)


@pytest.mark.parametrize("machine", ["i3", "corexy", "delta"])
def test_aborted_homing_in_pause_of_unhomed_print(machine, tmp_path):
    (tmp_path / "a.g").write_text("M302 P1\nM83\nG1 E20 F120\nG1 E5\n")
    with Scenario(machine, card=str(tmp_path)) as s:
        extruder = list(s.positions())[-1]
        s.host.ok("M32 a.g")
        s.passes(3)
        s.host.ok("M25")
        s.passes(2)
        s.host.send("G28")
        s.passes(2)
        s.host.send("M108")
        s.passes(1)
        at = s.positions()
        s.host.ok("M24")
        s.host.expect("^Done printing file$", 30)
        assert s.positions()[extruder] == pytest.approx(25, abs=0.01)
        assert s.positions() | {extruder: 0} == at | {extruder: 0}
        assert s.printer.rig.job.locked_axes


@pytest.mark.parametrize("after", [0.0, 0.05, 0.1, 0.2])
def test_unhomed_axes_stay_unhomed_after_a_pause(after, tmp_path):
    (tmp_path / "a.g").write_text("M302 P1\nM83\nG1 E20 F120\nG1 E5\n")
    with Scenario("i3", card=str(tmp_path)) as s:
        s.host.ok("M32 a.g")
        s.passes(3)
        s.host.ok("M25")
        s.passes(2)
        s.host.ok("M24")
        s.passes(after)
        s.host.ok("M524")
        s.passes(5)
        assert s.printer.rig.job.locked_axes == [0, 1, 2]


@pytest.mark.parametrize("unhomed", ["refuse", "allow"])
def test_arms_that_were_homed_in_the_pause_alone(tmp_path, unhomed):
    """They knew no place when the print was left, and come back to none that they do not reach."""
    text = f'unhomed_moves = "{unhomed}"\n' + config.shipped_text("scara")
    program = "M302 P1\nM83\nG1 E10 F60\nG28\nG1 X120 Y120 Z5 F3000\n"
    with paused(config.load_text(text), program, tmp_path, 2) as s:
        s.passes(5)
        s.host.ok("G28", 60)
        s.host.ok("M24")
        goes_on(s, 120, 120, 5)
