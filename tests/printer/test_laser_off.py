"""A laser goes off where the machine stands and nobody minds it; stopping is never late."""

from __future__ import annotations

import pytest
from tests.support.scenario import Host, Scenario

from passo.printer.watch.idle_timeout import LASER_OFF_S

FILES = {
    "lit.g": "G92 X0 Y0 Z0\nM3 S500\nG1 X50 F3000\n",
    "bad.g": "G92 X0 Y0 Z0\nM3 S500\nG1 X50 F3000\nM302 S-1\nG1 X90\nM5\n",
    "end.g": "G92 X0 Y0 Z0\nM3 S500\nG1 X50 F3000\nM2\n",
    "asks.g": "G92 X0 Y0 Z0\nM3 S400\nM0 Look\nG1 X50 F3000\nM5\n",
    "long.g": "G92 X0 Y0 Z0\nM3 S100\n" + "G1 X105 F3000\nG1 X5\n" * 200,
}


@pytest.fixture
def s(tmp_path):
    for name, text in FILES.items():
        (tmp_path / name).write_text(text)
    with Scenario("laser", card=str(tmp_path)) as scenario:
        scenario.passes(1.0)
        yield scenario


def share(s: Scenario) -> float:
    """Of full power, now."""
    return s.board.output_value("laser") / s.printer.rig.connection.full_scale("laser")


def start(s: Scenario, name: str) -> None:
    s.host.ok(f"M23 {name}")
    s.host.ok("M24")


STANDING = {
    "idle": (),
    "lit": ("M3 S100",),
    "switched off": ("M3 S100", "M5"),
    "stopped before": ("M410",),
    "moved": ("G92 X0 Y0 Z0", "G1 X5 F3000", "M400"),
}


@pytest.mark.parametrize("before", STANDING.values(), ids=STANDING)
@pytest.mark.parametrize("seconds", [0.05, 0.3, 1.5])
def test_a_stop_of_an_idle_machine_changes_nothing(s, before, seconds):
    for line in before:
        s.host.ok(line)
    s.passes(seconds)
    s.host.ok("M410")
    s.passes(2.0)
    assert (s.printer.state.halted, share(s)) == ("", 0.0)
    s.host.ok("G92 X0 Y0 Z0")
    s.host.ok("G1 X10 F3000")
    s.host.ok("M400")
    assert s.printer.state.halted == ""


@pytest.mark.parametrize("stop", ["M524", "M410"])
@pytest.mark.parametrize(
    ("file", "lines"), [("long.g", ()), ("long.g", ("M25",)), ("asks.g", ())], ids=str
)
def test_a_stop_of_a_suspended_print_changes_nothing(s, file, lines, stop):
    start(s, file)
    s.passes(4.0)
    for line in lines:
        s.host.ok(line)
    s.passes(5.0)
    s.host.ok(stop)
    s.passes(4.0)
    assert (s.printer.state.halted, share(s), s.printer.rig.queue.standing) == ("", 0.0, True)


def test_triggered_endstop_has_no_effect(s):
    """What M540 S1 asks for, on a machine that has just come to a stand."""
    s.host.ok("M3 S100")
    s.passes(1.0)

    async def hit() -> None:
        s.printer.stops.stop_by_endstop(["y"])

    s.run(hit())
    s.passes(2.0)
    assert (s.printer.state.halted, share(s)) == ("", 0.0)


def test_m410_ends_a_wait_for_the_user(s):
    s.host.send("M0 hello")
    s.passes(3.0)
    Host(s).ok("M410")
    s.host.expect("^ok", 1)
    s.passes(2.0)
    assert s.printer.state.halted == ""


@pytest.mark.parametrize(
    ("file", "ended"), [("lit.g", "done"), ("end.g", "done"), ("bad.g", "failed")]
)
def test_laser_goes_off_with_last_move_of_print(s, file, ended):
    start(s, file)
    assert s.until(lambda: share(s) == pytest.approx(0.5, abs=0.005), 2.0)
    s.host.expect("Done printing|stopped: .*: S is -1", 10)
    if ended == "failed":
        assert s.until(lambda: s.printer.rig.queue.standing, 3.0)
        s.passes(0.4)
    assert share(s) == 0.0
    s.host.ok("G1 X80 F3000")
    s.passes(0.5)
    assert share(s) == 0.0


def test_laser_goes_off_after_seconds_at_rest(s):
    """Also when the host that lit it has gone."""
    s.host.ok("G92 X0 Y0 Z0")
    s.host.send("M3 S500", "G1 X100 F3000")
    s.passes(0.5)

    async def hang_up() -> None:
        s.host.session.close()

    s.run(hang_up())
    assert s.until(lambda: s.printer.rig.queue.standing, 5.0)
    s.passes(LASER_OFF_S - 0.3)
    assert share(s) == pytest.approx(0.5, abs=0.005)
    s.passes(0.8)
    assert share(s) == 0.0


def test_laser_stays_on_during_dwell(s):
    s.host.ok("M3 S500")
    s.host.ok("G4 S10")
    s.passes(9.5)
    assert share(s) == pytest.approx(0.5, abs=0.005)
    s.passes(1.0 + LASER_OFF_S)
    s.host.expect("Laser off after an idle time", 1)
    assert share(s) == 0.0


@pytest.mark.parametrize("command", ["M84", "M81", "M18 X"])
def test_laser_is_off_before_motors(s, command):
    s.host.ok("G92 X0 Y0 Z0")
    s.host.ok("M3 S500")
    s.host.ok("G1 X5 F3000")
    s.passes(1.0)
    lit_when_off: list[bool] = []
    switched = s.printer.rig.connection.switch

    def switch(output: str, on: bool) -> None:
        lit_when_off.append(share(s) > 0)
        switched(output, on)

    s.printer.rig.connection.switch = switch
    s.host.ok(command)
    s.passes(0.5)
    assert lit_when_off
    assert not any(lit_when_off)
    assert share(s) == 0.0


def test_motors_that_soon_go_off_wait_for_it(s):
    s.host.ok("M84 S1")
    s.host.ok("G92 X0 Y0 Z0")
    s.host.ok("M3 S500")
    s.host.ok("G1 X5 F3000")
    s.host.expect("Laser off", 5)
    assert s.printer.outputs.motors.on
    s.host.expect("Motors off", 3)
    assert share(s) == 0.0


def test_laser_is_off_while_axes_home(s):
    s.host.ok("M3 S500")
    s.host.send("G28", "G1 X5 F3000")
    s.passes(1.0)
    assert share(s) == 0.0
    s.host.send("M400", "M118 there")
    s.host.expect("there", 60)
    assert share(s) == 0.0


def test_laser_is_off_while_waiting_for_user(s):
    start(s, "asks.g")
    s.passes(3.0)
    assert share(s) == 0.0
    s.host.ok("M108")
    assert s.until(lambda: share(s) == pytest.approx(0.4, abs=0.005), 1.0)
    s.host.expect("Done printing", 5)
    assert share(s) == 0.0


def test_laser_off_stops_private_event_loop():
    with Scenario("laser", free=True) as s:
        s.host.ok("M410")
        s.passes(2.0)
        assert s.printer.state.halted == ""
