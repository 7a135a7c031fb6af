"""Where limits and the feed rate override act: in their place in a program, at once from beside."""

import pytest
from tests.support.scenario import Host, Scenario

SLOWLY = "G92 X20 Y20 Z20\nG1 X120 F3000\nM220 S50\nG1 X20\nM220 S100\n"


@pytest.fixture
def s(tmp_path):
    (tmp_path / "a.g").write_text(SLOWLY)
    with Scenario("i3", card=str(tmp_path)) as scenario:
        yield scenario


def reached(s, x, within=10.0):
    """Seconds until X is there, to 0.2 mm: it may only turn there."""
    start = s.loop.time()
    assert s.until(lambda: abs(s.positions()["x"] - x) < 0.2, within)
    return s.loop.time() - start


def legs(s):
    """Seconds from 20 to 120 mm, and back."""
    assert s.until(lambda: s.positions()["x"] > 20.0, 5)
    return reached(s, 120.0), reached(s, 20.0)


def assert_in_order(times):
    assert times == pytest.approx((2.02, 4.01), abs=0.04)  # 50 mm/s, then 25


def test_m220_in_a_file_leaves_the_moves_before_it_alone(s):
    s.host.send("M32 a.g")
    assert_in_order(legs(s))


def test_m220_after_a_move_of_a_console_leaves_the_move_alone(s):
    s.host.send("G92 X20 Y20 Z20", "G1 X120 F3000 M220 S50", "G1 X20 M220 S100")
    assert_in_order(legs(s))


def test_m204_of_the_console_that_prints_leaves_its_moves_alone(s):
    s.host.send("G92 X20 Y20 Z20", "G1 X120 F6000", "M204 T100", "G1 X119")
    assert s.until(lambda: s.positions()["x"] > 20.0, 5)
    assert reached(s, 120.0) == pytest.approx(1.04, abs=0.04)


@pytest.mark.parametrize("beside", [False, True])
def test_m220_of_a_console_acts_at_once(s, beside):
    asks = Host(s) if beside else s.host
    s.host.send(*SLOWLY.splitlines()[:2])
    assert s.until(lambda: s.positions()["x"] > 70.0, 5)
    asks.ok("M220 S50")
    assert reached(s, 120.0) == pytest.approx(2 - 0.2, abs=0.1)  # 0.16 s are with the board


def test_m220_during_a_print_acts_on_all_that_is_planned(s):
    s.host.send("M32 a.g")
    assert s.until(lambda: s.positions()["x"] > 70.0, 5)
    s.host.ok("M220 S200")
    assert reached(s, 120.0) == pytest.approx(0.6, abs=0.06)
    assert reached(s, 20.0) == pytest.approx(1.03, abs=0.06)


@pytest.mark.parametrize("disturb", [("M25", "M24"), ("M290 Z0.1",)])
def test_replanning_does_not_apply_later_limits_early(s, disturb):
    s.host.send("M32 a.g")
    assert s.until(lambda: s.positions()["x"] > 40.0, 5)
    for line in disturb:
        s.host.ok(line)
        s.passes(2.5 if line == "M25" else 0)
    assert s.until(lambda: s.positions()["x"] > 70.0, 5)
    assert reached(s, 120.0) == pytest.approx(1.0, abs=0.05)
    assert reached(s, 20.0) == pytest.approx(4.01, abs=0.05)


@pytest.mark.parametrize(
    "line", ["M204 T100", "M201 X100", "M203 X10", "M205 J0.3", "SET_VELOCITY_LIMIT ACCEL=100"]
)
def test_limits_in_a_file_leave_the_moves_before_them_alone(tmp_path, line):
    with Scenario("i3", card=str(tmp_path)) as s:
        (tmp_path / "a.g").write_text(f"G92 X20 Y20 Z20\nG1 X120 F3000\n{line}\nG1 X119\n")
        s.host.send("M32 a.g")
        assert s.until(lambda: s.positions()["x"] > 20.0, 5)
        assert reached(s, 120.0) == pytest.approx(2.02, abs=0.04)


def test_m204_of_another_console_acts_on_all_that_is_planned(tmp_path):
    with Scenario("i3", card=str(tmp_path)) as s:
        (tmp_path / "a.g").write_text("G92 X20 Y20 Z20\n" + "G1 X120 F6000\nG1 X20\n" * 5)
        s.host.send("M32 a.g")
        assert s.until(lambda: s.positions()["x"] > 30.0, 5)
        s.host.ok("M204 T200")
        reached(s, 120.0)
        assert reached(s, 20.0) == pytest.approx(1.5, abs=0.05)  # half a second to 100 mm/s


@pytest.mark.parametrize(
    ("line", "seconds"),
    [
        ("SET_VELOCITY_LIMIT ACCEL=200", 1.5),
        ("SET_VELOCITY_LIMIT VELOCITY=50", 2.02),
        ("SET_VELOCITY_LIMIT MINIMUM_CRUISE_RATIO=0.9 ACCEL=200", 2.48),
    ],
)
def test_klipper_limits_from_console_act_on_planned_moves(tmp_path, line, seconds):
    with Scenario("i3", card=str(tmp_path)) as s:
        (tmp_path / "a.g").write_text("G92 X20 Y20 Z20\n" + "G1 X120 F6000\nG1 X20\n" * 5)
        s.host.ok("M204 T3000")
        s.host.send("M32 a.g")
        assert s.until(lambda: s.positions()["x"] > 30.0, 5)
        s.host.ok(line)
        reached(s, 120.0)
        assert reached(s, 20.0) == pytest.approx(seconds, abs=0.05)


def homed_s(s):
    start = s.loop.time()
    s.host.ok("G28", 120)
    return s.loop.time() - start


def test_m220_leaves_homing_alone(s):
    homed_s(s)
    usual = homed_s(s)
    s.host.ok("M220 S20")
    assert homed_s(s) == pytest.approx(usual, abs=0.05)


def test_m220_leaves_parking_alone(s, tmp_path):
    def parked_s(percent):
        (tmp_path / "b.g").write_text(f"G28\nM220 S{percent}\nG1 X100 Y20 Z5 F6000\nG4 S60\n")
        s.host.ok("M32 b.g")
        assert s.until(lambda: s.positions()["z"] == 5.0, 120)
        s.passes(1)
        start = s.loop.time()
        s.host.ok("M25")
        assert s.until(lambda: s.positions()["z"] > 5.0 and s.printer.rig.queue.standing, 60)
        took = s.loop.time() - start
        s.host.ok("M524")
        return took

    assert parked_s(25) == pytest.approx(parked_s(100), abs=0.05)


def test_m220_during_homing_does_not_reach_it(s):
    homed_s(s)
    usual = homed_s(s)
    other = Host(s)
    start = s.loop.time()
    s.host.send("G28")
    s.passes(0.3)
    other.ok("M220 S20")
    s.host.expect("^ok", 60)
    assert s.loop.time() - start == pytest.approx(usual, abs=0.3)


def test_console_commands_act_within_seconds_of_long_moves(tmp_path):
    """A file is read no further ahead than 4 s of its moves, however long these are."""
    moves = "".join(f"G1 X{20 + 100 * (i % 2)} F3000\n" for i in range(200))
    (tmp_path / "a.g").write_text("M106 S0\nG92 X20 Y20 Z20\n" + moves)
    with Scenario("i3", card=str(tmp_path)) as s:
        s.host.send("M32 a.g")
        s.passes(10)
        assert s.printer.rig.queue.ahead_s < 6
        s.host.ok("M106 S255")
        s.host.ok("M104 S200")
        assert s.until(lambda: s.board.output_value("part") > 0, 6)
        assert s.until(lambda: s.printer.rig.connection.heaters["hotend"].target == 200, 1)
        assert "byte" in s.host.ok("M27")[0]


def test_long_moves_of_a_file_do_not_stop_where_its_reading_did(tmp_path):
    moves = "".join(f"G1 X{20 + i} F1200\n" for i in range(200))
    (tmp_path / "a.g").write_text("G92 X20 Y20 Z20\n" + moves)
    with Scenario("i3", card=str(tmp_path)) as s:
        s.host.send("M32 a.g")
        assert s.until(lambda: s.positions()["x"] > 30.0, 5)
        start = s.loop.time()
        assert s.until(lambda: s.positions()["x"] > 210.0, 15)
        assert s.loop.time() - start == pytest.approx(180 / 20, abs=0.05)
