"""Pauses of prints that a host sends: M600, M601, and faults of heaters."""

from __future__ import annotations

import re

import pytest
from tests.support.scenario import Host, Scenario

from passo import config
from passo.config.machine import MachineConfig

PLACE = (5.0, 180.0)  # where it parks


def parking(text: str = "") -> MachineConfig:
    """An i3 with a place to park; a bed's fault does what the text says."""
    bed = "max_c = 120.0\n"
    shipped = config.shipped_text("i3").replace(bed, bed + text, 1)
    return config.load_text(f"{shipped}\n[park]\nposition_mm = {list(PLACE)}\n")


@pytest.fixture
def s():
    with Scenario(parking()) as scenario:
        for line in ("M302 P1", "G92 X0 Y0 Z0 E0", "G1 X50 Y40 Z5 E3 F6000", "M400"):
            scenario.host.ok(line, 20)
        yield scenario


def at(s: Scenario) -> tuple[float, float, float, float]:
    """How far motors have gone since the start of the test: X, Y, Z, E in mm."""
    places = s.positions()
    x, y, z, e = (round(places[n], 2) for n in ("x", "y", "z", "e"))
    return x, y, z, e


def actions(host: Host) -> list[str]:
    return [x.removeprefix("// action:") for x in host.heard if x.startswith("// action:")]


def way(before: tuple[float, ...], now: tuple[float, ...]) -> tuple[float, ...]:
    return tuple(round(b - a, 2) for a, b in zip(before, now, strict=True))


@pytest.mark.parametrize("command", ["M600", "M601"])
@pytest.mark.parametrize("answer", ["M108", "M876 S0", "M602"])
def test_the_nozzle_leaves_the_print_and_comes_back(s, command, answer):
    park = s.machine.park
    before = at(s)
    s.host.send(command)
    s.passes(10)
    x, y = PLACE
    assert way(before, at(s)) == pytest.approx(
        (x - 50, y - 40, park.raise_mm, -park.retract_mm), abs=0.02
    )
    s.host.silent(60, "^ok")
    assert actions(s.host)[0] == "pause"
    Host(s).send(answer)
    s.host.expect("^ok", 10)
    s.passes(1)
    assert way(before, at(s)) == pytest.approx((0, 0, 0, 0), abs=0.02)
    assert actions(s.host)[-1] == "resume"
    s.host.ok("G1 X60 E4 F6000")
    s.host.ok("M400")
    assert way(before, at(s)) == pytest.approx((10, 0, 0, 1), abs=0.02)


@pytest.mark.parametrize("answer", ["M108", "M876 S0", "M602", "M24"])
def test_the_console_that_has_paused_can_resume_by_itself(s, answer):
    s.host.send("M601")
    s.passes(20)
    s.host.silent(5, "^ok")
    before = len(s.host.heard)
    s.host.send(answer, "G4 S3", "M118 after")
    s.host.expect("^// action:resume", 10)
    s.passes(2)
    s.host.silent(0.5, "after")  # the dwell is not cut short by an answer whose turn comes
    s.host.expect("after", 5)
    s.passes(1)
    heard = s.host.heard[before:]
    assert heard.count("ok") == 4
    assert not [line for line in heard if "file" in line]  # M24 has begun nothing else


def test_parameters_of_m600_set_how_it_parks(s):
    """E takes back and Z lifts by so much, X and Y are the place, U unloads and L loads."""
    before = at(s)
    s.host.send("M600 E4 Z7 X60 Y30 U80 L50")
    s.passes(20)
    assert way(before, at(s)) == pytest.approx((10, -10, 7, -84), abs=0.02)
    s.host.send("M108")
    s.host.expect("^ok", 30)
    s.passes(1)
    assert way(before, at(s)) == pytest.approx((0, 0, 0, -30), abs=0.02)
    s.host.ok("G1 E4 F600")  # filament that was moved meanwhile does not count
    s.host.ok("M400")
    assert way(before, at(s))[3] == pytest.approx(-29, abs=0.02)


def test_the_new_filament_has_its_own_temperature(s):
    hotend = s.printer.rig.connection.heaters["hotend"]
    s.host.ok("M104 S60")
    before = at(s)
    s.host.send("M600 T0 U80 L50 S80 B3")
    s.passes(60)
    assert hotend.target == 60
    assert "echo:M600 does not beep: there is no beeper" in s.host.heard
    s.host.send("M108")
    s.passes(1)
    assert hotend.target == 80
    low = at(s)
    assert s.until(lambda: at(s) != low, 120)
    assert hotend.celsius == pytest.approx(80, abs=3)
    s.host.expect("^ok", 30)
    assert way(before, at(s)) == pytest.approx((0, 0, 0, -30), abs=0.02)


def test_m108_ends_the_heating_wait_of_m600(s):
    before = at(s)
    s.host.send("M600 S150")
    s.passes(20)
    s.host.send("M108")
    s.passes(2)
    assert way(before, at(s))[2] > 1
    s.host.send("M108")
    s.host.expect("^ok", 10)
    assert way(before, at(s)) == pytest.approx((0, 0, 0, 0), abs=0.02)


def test_the_temperature_counts_in_a_file_too(tmp_path):
    (tmp_path / "a.g").write_text("G92 X0 Y0 Z0\nG1 X10 Z5 F6000\nM600 S60\nG1 X20\n")
    with Scenario("i3", card=str(tmp_path)) as s:
        s.host.ok("M32 a.g")
        s.passes(20)
        s.host.ok("M24")
        s.host.expect("Done printing", 60)
        hotend = s.printer.rig.connection.heaters["hotend"]
        assert (hotend.target, hotend.celsius) == (60, pytest.approx(60, abs=3))


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ("T1", "T is 1: expected 0, the tool in use"),
        ("S400", "S is 400: expected 5 to 285 C"),
        ("X900 Y30", "X is 900: expected 0 to 250 mm"),
        ("X60 Y-1", "Y is -1: expected 0 to 220 mm"),
        ("Z251", "Z is 251: expected -250 to 250 mm"),
        ("E5001", "E is 5001: expected -5000 to 5000 mm"),
        ("L5001", "L is 5001: expected -5000 to 5000 mm"),
        ("U100000000", "U is 1e+08: expected -5000 to 5000 mm"),
    ],
)
def test_impossible_m600_is_refused(s, words, told):
    before = at(s)
    assert told in s.host.ok(f"M600 {words}")[0]
    s.passes(5)
    assert at(s) == before


def test_words_of_m600_count_in_a_file_too(tmp_path):
    (tmp_path / "a.g").write_text("G92 X0 Y0 Z0\nG1 X10 Z5 F6000\nM600 Z7 X60 Y30\nG1 X20\n")
    with Scenario("i3", card=str(tmp_path)) as s:
        s.host.ok("M23 a.g")
        before = at(s)
        s.host.ok("M24")
        s.passes(20)
        assert way(before, at(s)) == pytest.approx((60, 30, 12, 0), abs=0.02)
        s.host.ok("M24")
        s.host.expect("Done printing", 20)
        assert way(before, at(s)) == pytest.approx((20, 0, 5, 0), abs=0.02)
        assert "pause" not in actions(s.host)


def test_laser_is_off_while_its_file_is_paused(tmp_path):
    (tmp_path / "a.g").write_text("G92 X0 Y0 Z0\nM3 S500\nG1 X20 F3000\nM601\nG1 X60\n")
    with Scenario("laser", card=str(tmp_path)) as s:
        full = s.printer.rig.connection.full_scale("laser")
        s.host.ok("M23 a.g")
        s.host.ok("M24")
        s.host.expect("Paused; continue with M24", 10)
        s.passes(1)
        for _ in range(20):
            s.passes(0.5)
            assert s.board.output_value("laser") == 0
        assert s.positions()["x"] == pytest.approx(20, abs=0.02)  # behind the moves before it
        s.host.send("M24")
        lit = pytest.approx(0.5, abs=0.005)
        assert s.until(lambda: s.board.output_value("laser") / full == lit, 2)
        s.host.expect("Done printing", 10)
        assert s.positions()["x"] == pytest.approx(60, abs=0.02)
        assert s.board.output_value("laser") == 0


def test_stop_in_a_pause_does_not_return_the_nozzle(s):
    s.host.send("M600")
    s.passes(10)
    parked = at(s)
    Host(s).ok("M410")
    s.host.expect("^echo:it was stopped", 5)
    s.host.expect("^ok", 5)
    s.passes(5)
    assert at(s) == parked
    assert "resume" not in actions(s.host)
    s.host.ok("G91")
    s.host.ok("G1 X-5 F6000")
    s.host.ok("M400")
    assert way(parked, at(s)) == pytest.approx((-5, 0, 0, 0), abs=0.02)


def test_a_host_that_hangs_up_leaves_the_nozzle_parked(s):
    beside = Host(s)
    s.host.send("M600")
    s.passes(10)
    parked = at(s)

    async def hang_up() -> None:
        s.host.session.close()

    s.run(hang_up())
    s.passes(10)
    assert at(s) == parked
    beside.ok("G91")
    beside.ok("G1 X5 F6000")
    beside.ok("M400")
    assert way(parked, at(s)) == pytest.approx((5, 0, 0, 0), abs=0.02)


def test_an_emergency_stop_ends_the_pause(s):
    s.host.send("M600")
    s.passes(10)
    Host(s).ok("M112")
    s.host.expect("Printer halted", 5)
    s.host.expect("^ok", 5)
    s.host.send("M999")
    s.host.expect("ready again", 10)
    s.host.ok("G92 X0 Y0 Z0")
    s.host.ok("G1 X5 F6000")
    assert s.printer.rig.job.stops.suspended is False


def test_a_machine_that_is_not_homed_does_not_move(tmp_path):
    with Scenario("i3") as s:
        before = at(s)
        s.host.send("M600")
        s.passes(10)
        assert at(s) == before
        s.host.send("M108")
        s.host.expect("^ok", 5)


# -- a heater fails -------------------------------------------------------------------------------


@pytest.fixture
def mild():
    """Its bed's faults pause what is printed."""
    with Scenario(parking('on_fault = "job"\n')) as scenario:
        for line in ("M302 P1", "M140 S60", "G92 X0 Y0 Z0 E0", "G1 X10 Y40 Z5 F6000", "M400"):
            scenario.host.ok(line, 20)
        yield scenario


def fail(s: Scenario) -> None:
    s.board.force_sensor("bed", 0.0)
    s.host.expect("heater bed was switched off", 5)


def mend(s: Scenario) -> None:
    """All goes on when the bed is warm."""
    s.board.force_sensor("bed", None)
    s.passes(1)
    Host(s).ok("M922")
    Host(s).ok("M108")


def test_a_heater_s_fault_pauses_what_a_host_sends(mild):
    s = mild
    before = at(s)
    lines = [f"G1 X{10 + 100 * ((i + 1) % 2)} E{i + 1} F3000" for i in range(30)]
    s.host.send(*lines)
    s.passes(1)
    fail(s)
    s.passes(10)
    park = s.machine.park
    assert s.printer.rig.queue.standing
    assert way(before, at(s))[2] == pytest.approx(park.raise_mm, abs=0.02)
    assert actions(s.host)[0] == "pause"
    parked, oks = at(s), s.host.heard.count("ok")
    s.passes(120)
    assert (at(s), s.host.heard.count("ok")) == (parked, oks)
    assert s.host.heard.count("ok") < 5 + 30
    mend(s)
    s.host.expect("// action:resume", 900)
    s.host.send("M400", "M118 done")
    s.host.expect("^done", 120)
    assert way(before, at(s)) == pytest.approx((0, 0, 0, 30), abs=0.02)
    assert s.host.heard.count("ok") == 5 + 30 + 2


def test_axes_home_to_the_end_before_it_pauses(mild):
    s = mild
    s.host.send("G28", "G1 X30 Y30 Z30 F6000")
    s.passes(1)
    fail(s)
    s.host.expect("busy: paused for user", 60)
    assert s.printer.rig.job.locked_axes == []
    s.passes(5)
    assert (s.positions()["x"], s.positions()["y"]) == pytest.approx(PLACE, abs=0.1)
    mend(s)
    s.host.send("M400", "M118 done")
    s.host.expect("^done", 900)
    assert [s.positions()[n] for n in "xy"] == pytest.approx([30, 30], abs=0.1)


def test_a_fault_on_an_idle_machine_moves_nothing(mild):
    s = mild
    s.passes(60)
    before = at(s)
    fail(s)
    s.passes(10)
    assert actions(s.host) == ["pause"]
    assert at(s) == before
    s.host.ok("G1 X20 F6000")


def test_halt_ends_the_pause_of_a_host_print(mild):
    s = mild
    s.host.send("G1 X100 F600")
    s.passes(1)
    fail(s)
    s.passes(1)
    s.host.ok("M112")
    s.host.expect("Printer halted", 5)
    s.host.send("M999")
    s.host.expect("ready again", 10)
    s.host.ok("G92 X0 Y0 Z0")
    s.host.ok("G1 X5 F6000")
    s.host.ok("M400")
    assert re.match("X:5.000 ", s.host.ok("M114")[0])
