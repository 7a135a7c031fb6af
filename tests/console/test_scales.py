"""M92 and what depends on a motor's steps for a mm: its highest speed, and corners by steps."""

import pytest
from tests.support.scenario import Scenario

from passo import config


def machine(old, new):
    text = config.shipped_text("i3")
    assert old in text
    return config.load_text(text.replace(old, new, 1))


SLOW = ("[steppers.x]\n", "[steppers.x]\nmax_rate_hz = 25000\n")


def report(s):
    return [line for line in s.host.ok("M503 S0") if line != "ok"]


def test_step_rate_stays_within_motor_limit():
    with Scenario(machine(*SLOW)) as s:
        s.host.ok("G28", 60)
        s.host.ok("M92 X200")
        assert s.host.ok("M203")[0].startswith("M203 X125 Y300 ")
        before_s = s.loop.time()
        s.host.ok("G1 X100 F18000")
        s.host.ok("M400", 10)
        assert s.board.net_steps("x") - s.board.net_steps("y") == 100 * 200
        assert s.loop.time() - before_s > 100 / 125


def test_speed_limits_return_with_the_old_scale():
    with Scenario(machine(*SLOW)) as s:
        for line, speed in (
            ("M92 X200", "125"),
            ("M92 X80", "300"),
            ("M203 X100", "100"),  # somebody's choice, not the motor's limit
            ("M92 X200", "100"),
            ("M92 X400", "62.5"),
        ):
            s.host.ok(line)
            assert s.host.ok("M203")[0].startswith(f"M203 X{speed} Y300 "), line


def test_reported_fine_scales_restore_same_state():
    with Scenario("i3") as s:
        s.host.ok("M92 X3000 Y1700.3 E9000")
        changed = report(s)
        s.host.ok("M502")
        for line in changed:
            assert s.host.ok(line) == ["ok"], line
        assert report(s) == changed
        s.host.ok("M92 X80 Y80 E95.5")  # what was rounded in the report was no choice
        assert s.host.ok("M203")[0] == "M203 X300 Y300 Z12 E100"


@pytest.mark.parametrize("scale", [20, 80, 160])
def test_corners_by_steps_follow_the_scale(scale):
    """As if the machine file had it."""
    law = ('junction = "deviation"', 'junction = "cornering_distance"')
    seconds = []
    for per_mm in (80, scale):
        text = config.shipped_text("i3").replace(*law)
        text = text.replace("steps_per_mm = 80.0", f"steps_per_mm = {per_mm}.0")
        with Scenario(config.load_text(text)) as s:
            s.host.ok("G92 X0 Y0 Z0")
            s.host.ok(f"M92 X{scale} Y{scale}")
            for i in range(1, 30):
                s.host.send(f"G1 X{i} Y{i % 2 * 5} F9000")
            s.host.ok("M400", 60)
            seconds.append(s.printer.rig.planned_s())
    assert seconds[0] == pytest.approx(seconds[1], rel=1e-6)
