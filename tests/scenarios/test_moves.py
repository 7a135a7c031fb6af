"""Moves as programs ask for them, on the mechanics: modes, feed rates, limits, dwells, arcs."""

import re

import pytest
from tests.support.scenario import Host, Scenario


@pytest.fixture
def s():
    with Scenario("i3") as scenario:
        scenario.host.ok("M302 P1")
        scenario.host.ok("G92 X0 Y0 Z0 E0")
        yield scenario


def position(s):
    line = s.host.ok("M114")[0]
    return {k: float(v) for k, v in re.findall(r"([XYZE]):(-?[\d.]+)", line.split("Count")[0])}


def took(s, *lines):
    """Seconds from the first of these lines to rest."""
    start = s.loop.time()
    for line in lines:
        s.host.ok(line, 60)
    s.host.ok("M400", 60)
    return s.loop.time() - start


@pytest.mark.parametrize(
    ("modes", "x", "e"),
    [
        (["G90", "M82"], 5, 2),
        (["G90", "M83"], 5, 3),
        (["G91", "M82"], 15, 3),
        (["G91", "M83"], 15, 3),
    ],
)
def test_modes_of_axes_and_extruder(s, modes, x, e):
    s.host.ok("G1 X10 E1 F6000")
    for mode in modes:
        s.host.ok(mode)
    s.host.ok("G1 X5 E2")
    s.host.ok("M400")
    assert (position(s)["X"], position(s)["E"]) == (x, e)
    assert s.positions()["x"] == 20 + x
    s.host.ok("G92 E0")
    assert position(s)["E"] == 0
    assert s.positions()["e"] == pytest.approx(e, abs=0.01)


def test_r_makes_one_move_absolute(s):
    s.host.ok("G1 X10 F6000")
    s.host.ok("G91")
    s.host.ok("G1 X5 R")
    assert position(s)["X"] == 5
    s.host.ok("G1 X5")
    assert position(s)["X"] == 10


def test_the_feed_rate_stays_and_m220_scales_it(s):
    first = took(s, "G1 X20 F600")
    assert first == pytest.approx(2.0, abs=0.3)  # a standing machine takes a while to begin
    assert took(s, "G1 X0") == pytest.approx(first, abs=0.1)  # without F
    s.host.ok("M220 S50")
    assert took(s, "G1 X20") == pytest.approx(first + 2.0, abs=0.1)
    assert took(s, "G1 X0 F1200") == pytest.approx(first, abs=0.1)


def test_m220_does_not_change_dwell_time(s):
    s.host.ok("M220 S50")
    for line, seconds in (("G4 S6", 6.0), ("G4 P500", 0.5), ("G4", 0.0)):
        assert took(s, line) == pytest.approx(seconds, abs=0.3), line
    assert took(s, "G4 S6") - took(s, "G4 S2") == pytest.approx(4.0, abs=0.02)


@pytest.mark.parametrize(("command", "dwell_s", "further"), [("M108", 600, 60), ("M410", 1.9, 0)])
def test_dwell_ends_on_request(s, command, dwell_s, further):
    """The moves behind it go on after M108, and are forgotten after a stop."""
    other = Host(s)
    before = s.positions()["x"]
    s.host.send(f"G4 S{dwell_s}", "M106 S255", "G1 X60 F6000")
    s.passes(1)
    other.send(command)
    s.passes(0.3)
    assert s.printer.rig.queue.standing == (command == "M410")
    assert s.until(lambda: s.printer.rig.queue.standing, 1)
    assert s.positions()["x"] == before + further
    assert (s.board.output_value("part") > 0) == (command == "M108")
    assert s.host.ok("G1 X30 F6000") == ["ok"]
    s.host.ok("M400")
    assert s.positions()["x"] == before + 30.0


def test_a_nominal_time_is_kept(s):
    assert took(s, "G1 X20 T5") == pytest.approx(5.0, abs=0.3)
    assert s.positions()["x"] == 40.0


@pytest.mark.parametrize("target", ["X251", "X-1", "Y9999", "Z-0.1"])
def test_a_target_beyond_the_limits_is_refused_and_nothing_moves(target):
    with Scenario("i3") as s:
        s.host.ok("G28", 60)
        before = s.positions()
        assert f"{target[0]} " in s.host.ok(f"G1 {target}")[0]
        s.passes(1)
        assert s.positions() == before
        assert position(s) == {"X": 0, "Y": 0, "Z": 0, "E": 0}


def test_invalid_feedrate_is_refused(s):
    for line in ("G1 X1 F0", "G1 X1 F-5"):
        assert "must be above 0" in s.host.ok(line)[0]
    assert position(s)["X"] == 0
    assert s.host.ok("G1 X1 F600") == ["ok"]


def test_a_whole_circle_ends_where_it_began(s):
    s.host.ok("G1 X60 Y50 F6000")
    s.host.ok("M400")
    at = s.positions()
    widest = [0.0]

    def watch():
        widest[0] = max(widest[0], at["x"] - s.positions()["x"])
        return s.printer.rig.queue.standing and widest[0] > 0

    s.host.send("G2 X60 Y50 I-10 J0 F1200")
    assert s.until(watch, 20)
    assert widest[0] == pytest.approx(20, abs=0.05)
    assert s.positions() == at
    assert "arc" in s.host.ok("G2 X60 Y50 R0")[0]


def test_a_move_of_forty_seconds_takes_forty_seconds(s):
    assert took(s, "G1 X200 F300") == pytest.approx(40, abs=0.5)
    assert s.positions()["x"] == 220.0


def test_a_thousand_tiny_moves_do_not_drift(s):
    s.host.ok("G91")
    for _ in range(1000):
        s.host.send("G1 X0.007 F6000")
    s.host.ok("M400", 60)
    assert s.positions()["x"] == 27.0


def test_g10_and_g11_retract_and_recover(s):
    s.host.ok("G1 E5 F600")
    s.host.ok("M207 S2 F1200 Z0.4")
    s.host.ok("G10")
    s.host.ok("G10")  # the second counts for nothing
    s.host.ok("M400")
    assert s.positions()["e"] == pytest.approx(3, abs=0.01)
    assert s.positions()["z"] == 20.4
    s.host.ok("G11")
    s.host.ok("M400")
    assert s.positions()["e"] == pytest.approx(5, abs=0.01)
    assert s.positions()["z"] == 20.0


@pytest.mark.parametrize(
    ("meanwhile", "hopped", "z"),
    [
        ("G92 Z3", 3, 3),
        ("G92 X9", 10, 10),
        ("G28 X", 10, 10),
        ("G28 Z B", 10, 10),
        ("G28 X B", 10, 10),
        ("G28 Z", 0, 0),
    ],
)
def test_a_hop_is_not_part_of_the_programs_z(s, meanwhile, hopped, z):
    for line in ("G28", "M207 S2 F1200 Z0.4", "G1 Z10 E5 F6000", "G10", meanwhile):
        s.host.ok(line, 60)
    assert position(s)["Z"] == pytest.approx(hopped, abs=0.01)
    s.host.ok("G11")
    s.host.ok("M400")
    assert position(s)["Z"] == pytest.approx(z, abs=0.01)
    assert s.positions()["z"] == pytest.approx(10 if meanwhile == "G92 Z3" else z, abs=0.02)
    assert s.positions()["e"] == pytest.approx(5, abs=0.01)


def test_g20_moves_in_inches(s):
    s.host.ok("G20")
    s.host.ok("G1 X1 F60")
    s.host.ok("M400")
    assert s.positions()["x"] == 45.4


def test_a_laser_is_on_between_m3_and_m5():
    with Scenario("laser") as s:
        s.host.ok("G92 X0 Y0 Z0")
        s.host.ok("M3 S500")
        s.host.ok("M400")
        s.passes(0.2)
        half = s.board.output_value("laser")
        assert half > 0
        s.host.ok("M3 S1000")
        s.host.ok("M400")
        s.passes(0.2)
        assert s.board.output_value("laser") == pytest.approx(2 * half, rel=0.01)
        s.host.ok("M5")
        s.host.ok("M400")
        s.passes(0.2)
        assert s.board.output_value("laser") == 0


def test_volumes_become_lengths(s):
    """A filament of 1.75 mm has 2.40528 mm² across, one of 2 mm 3.14159."""
    s.host.ok("M200 D1.75")
    assert s.host.ok("M200")[0] == "M200 T0 D1.75"
    s.host.ok("G1 E24.0528 F600")
    s.host.ok("M400", 60)
    assert s.positions()["e"] == pytest.approx(10.0, abs=0.01)
    assert position(s)["E"] == 24.0528
    s.host.ok("M200 D2")
    s.host.ok("G1 E55.4687")
    s.host.ok("M400", 60)
    assert s.positions()["e"] == pytest.approx(20.0, abs=0.01)
    assert sum(s.printer.rig.job.results.statistics()["filament_mm"]) == pytest.approx(
        20.0, abs=1e-3
    )
    s.host.ok("G10")  # a retraction is a length always
    s.host.ok("M400", 60)
    assert s.positions()["e"] == pytest.approx(17.0, abs=0.01)
    s.host.ok("G11")
    for line in ("M200 D0", "M200 S0 D2"):
        assert s.host.ok(line) == ["ok"], line
        assert s.host.ok("M200")[0] == "M200 S0"
    s.host.ok("G92 E0")
    s.host.ok("G1 E5")
    s.host.ok("M400", 60)
    assert s.positions()["e"] == pytest.approx(25.0, abs=0.01)
    assert "20" in s.host.ok("M200 D20")[0]
    assert "tool" in s.host.ok("M200 T7 D1.75")[0]


def test_a_retraction_out_of_range_is_refused(s, tmp_path):
    """On a console and in a file, with the word, its value and what it may be."""
    s.host.ok("M207 S2 F1200 Z0.4")
    assert "S is -1: expected 0 to 5000" in s.host.ok("M207 S-1 Z1")[0]
    assert "Z is -0.4: expected 0 to 5000" in s.host.ok("M207 Z-.4")[0]
    assert "F-60 must be above 0" in s.host.ok("M208 F-60")[0]
    kept = [x for x in s.host.ok("M503 S0") if x.startswith(("M207", "M208"))]
    assert [x.partition(" R")[0].partition(" W")[0] for x in kept] == [
        "M207 S2 F1200 Z0.4",
        "M208 S0 F0",
    ]
    (tmp_path / "a.g").write_text("G4 P1\nM207 S9000\n")
    with Scenario("i3", card=str(tmp_path)) as other:
        other.host.ok("M32 a.g")
        other.host.expect("^echo:Print of a.g stopped: a.g:2: S is 9000: expected 0 to 5000", 5)


def test_a_slicer_s_own_retractions_become_those_of_the_firmware(s):
    """Moves of filament alone, from 0.1 to 10 mm; their own lengths count only for the program."""
    s.host.ok("M207 S1.5 F1800 Z0.4")
    s.host.ok("M209 S1")
    assert s.host.ok("M209")[0] == "M209 S1"
    s.host.ok("G1 X10 E5 F6000")
    for line, e, z in (
        ("G1 E1 F2400", 3.5, 20.4),
        ("G1 X20", 3.5, 20.4),
        ("G1 E0.95", 3.45, 20.4),  # too short
        ("G1 E5", 4.95, 20.0),
        ("G1 X30 E6", 5.95, 20.0),
        ("G1 E26", 25.95, 20.0),  # too long
        ("G1 E31", 30.95, 20.0),  # pushes, but nothing was drawn back before
        ("G1 E27", 29.45, 20.4),
        ("G1 E26", 28.45, 20.4),  # draws once more, as it is drawn back already
        ("G1 E30", 29.95, 20.0),
    ):
        s.host.ok(line)
        s.host.ok("M400", 60)
        at = s.positions()
        assert (at["e"], at["z"]) == pytest.approx((e, z), abs=0.02), line
    assert position(s)["E"] == 30
    s.host.ok("M209 S0")
    s.host.ok("G1 E29")
    s.host.ok("M400")
    assert s.positions()["e"] == pytest.approx(28.95, abs=0.02)


def test_filament_is_loaded_and_unloaded(s):
    """The program's E does not change by it."""
    s.host.ok("M603 L40 U25")
    assert s.host.ok("M603")[0] == "M603 T0 L40 U25"
    s.host.ok("G1 E2 F600")
    assert took(s, "M701") == pytest.approx(40 / 6, abs=1)
    assert s.positions()["e"] == pytest.approx(42, abs=0.01)
    s.host.ok("M702 U10 Z5")
    assert s.until(lambda: s.positions()["z"] == 25, 3)
    s.host.ok("M400", 60)
    assert s.positions()["e"] == pytest.approx(32, abs=0.01)
    assert s.positions()["z"] == 20
    s.host.ok("G1 E3")
    s.host.ok("M400", 60)
    assert s.positions()["e"] == pytest.approx(33, abs=0.01)
    assert position(s)["E"] == 3
    assert "does not exist" in s.host.ok("M701 T1")[0]
    assert "L" in s.host.ok("M701 L9999")[0]
    s.host.ok("M302 P0")
    assert "cold" in s.host.ok("M702")[0]


def test_letters_after_r_are_relative(s):
    s.host.ok("G1 X10 Y10 F6000")
    s.host.ok("G1 X5 Y5 F600 RX")
    assert position(s) | {"Z": 0, "E": 0} == {"X": 15, "Y": 5, "Z": 0, "E": 0}
    s.host.ok("G91")
    s.host.ok("G1 RXY X5 Y5")
    assert position(s)["X"] == 20
    assert position(s)["Y"] == 10
    s.host.ok("G1 R X5 Y5")
    assert position(s)["X"] == 5
    assert took(s, "G1 X-50") < 2  # F600 was of its own move
    s.host.ok("G1 RXF X50 F600")
    assert took(s, "G1 X-10") == pytest.approx(6, abs=0.5)  # behind the 5 s of the move before


@pytest.mark.parametrize(
    ("line", "homed"),
    [("G28 W", "xyz"), ("G28 O", "xyz"), ("g28 x y", "xy"), ("G28 XY", "xy"), ("G28 X0 Z0", "xz")],
)
def test_letters_that_slicers_put_after_g28(line, homed):
    with Scenario("i3") as s:
        s.host.ok(line, 60)
        at = s.positions()
        assert {a for a in "xyz" if abs(at[a]) < 0.02} == set(homed)
