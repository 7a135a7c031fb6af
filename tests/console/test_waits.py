"""Waits of lines that end early, hosts that leave while they wait, and lines that break."""

from math import pi

import pytest
from tests.support.scenario import Host, Scenario

from passo import config
from passo.config.load import shipped_text
from passo.errors import CardError


@pytest.fixture
def s():
    with Scenario("i3") as scenario:
        scenario.host.ok("G92 X20 Y20 Z20")
        yield scenario


def oks(host, start=0):
    return [x for x in host.heard[start:] if x.startswith("ok")]


# -- M108 while the plan is full ------------------------------------------------------------------


@pytest.mark.parametrize("own", [True, False])
@pytest.mark.parametrize(
    ("feed", "waits"), [(600, "M400"), (100, "M109 S200"), (100, "M0"), (100, "M190 S60")]
)
def test_m108_ends_a_wait_that_has_no_room_yet(s, own, feed, waits):
    other = s.host if own else Host(s)
    s.host.ok(f"G1 X100 F{feed}")
    start = len(s.host.heard)
    s.host.send(waits)
    s.passes(1)
    assert not s.printer.dispatch.has_room()
    other.send("M108")
    s.passes(0.03)
    assert len(oks(s.host, start)) == 1 + own
    if waits.startswith("M109"):
        s.passes(60)
        assert s.printer.rig.connection.heaters["hotend"].target == 200
    s.host.ok("M400", 60)
    assert s.positions()["x"] == 100.0  # the moves went on


def test_m108_ends_only_the_first_wait_of_a_line(s):
    s.host.ok("G1 X100 F600")
    start = len(s.host.heard)
    s.host.send("M109 S200 M0")
    s.passes(0.5)
    s.host.send("M108")
    s.passes(20)
    assert len(oks(s.host, start)) == 0
    s.host.send("M108")
    s.passes(0.1)
    assert len(oks(s.host, start)) == 3


def test_axis_is_not_homed_if_m108_ends_the_wait(s):
    s.host.ok("G1 X100 F600")
    s.host.send("G28")
    s.passes(0.5)
    s.host.send("M108")
    s.host.expect("^echo:it was stopped$", 0.1)
    s.host.ok("M400", 20)
    assert s.positions()["x"] == 100.0


# -- hosts that leave -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    "line", ["M0", "M109 S200 M190 S90 M0", "M190 S90 G28 M0", "G4 S1 M400 M0"]
)
def test_a_host_that_leaves_ends_all_waits_of_its_line(s, line):
    other = Host(s)
    other.send(line)
    s.passes(2)
    assert s.printer.motion_lock.locked
    other.session.close()
    s.passes(0.2)
    assert not s.printer.motion_lock.locked
    assert s.host.ok("G92 X20") == ["ok"]


# -- answers in one burst with what they answer, and the end of the input -------------------------


@pytest.mark.parametrize("ends", [False, True])
@pytest.mark.parametrize(
    "lines",
    [
        ["M0", "M108"],
        ["M1 Remove the clip", "M876 S0"],
        ["M600", "M108"],
        ["M600", "M602"],
        ["M601", "M24"],
        ["G4 S2", "M0", "M602"],
        ["M0", "M0", "M108", "M108"],
        ["M0", "G1 X30", "M600", "M602", "M108"],
    ],
)
def test_answer_already_received_ends_the_wait_before_it(s, lines, ends):
    done = []
    s.host.send(*lines, "M118 next")
    if ends:
        s.host.session.end(lambda: done.append(True))
    start = s.loop.time()
    s.host.expect("^next$", 30)
    s.passes(0.1)
    assert len(oks(s.host)) == len(lines) + 2  # and that of G92
    assert done == [True] * ends
    assert s.loop.time() - start >= (2.0 if "G4 S2" in lines else 0.0)  # no dwell is cut short


def test_answer_already_received_ends_only_one_wait(s):
    s.host.send("M0", "M0", "M108", "M118 next")
    s.host.silent(60, "next")
    s.host.send("M108")
    s.host.expect("^next$", 1)


def test_used_answer_ends_no_later_wait(s):
    s.host.send("M109 S200")
    s.passes(1)
    s.host.send("M0", "M108", "M118 next")  # M108 ends the wait that goes on
    s.host.silent(60, "next")


@pytest.mark.parametrize("late", [False, True])
@pytest.mark.parametrize("wait", ["M0", "M1", "M600", "M601", "M109 S60 M0", "M0 G1 X90"])
def test_the_end_of_the_input_ends_a_wait_for_the_user(s, wait, late):
    """What comes after the wait needs the user's consent."""
    done = []
    s.host.send(wait, "G1 X90 F6000", "M118 next")
    s.passes(120 if late else 0)
    s.host.session.end(lambda: done.append(True))
    s.host.expect("the wait for the user ends, too; 2 lines after it are not carried out", 120)
    assert s.until(lambda: bool(done), 10)
    assert s.until(lambda: not s.printer.motion_lock.locked, 1)
    s.passes(5)
    assert s.positions()["x"] < 80
    assert "next" not in s.host.heard


@pytest.mark.parametrize("wait", ["M0 S5", "M109 S60", "G4 S5 M400", "M190 S30"])
def test_the_end_of_the_input_ends_no_other_wait(s, wait):
    done = []
    s.host.send(wait, "M118 next")
    s.host.session.end(lambda: done.append(s.loop.time()))
    start = s.loop.time()
    s.host.expect("^next$", 300)
    assert s.until(lambda: bool(done), 1)
    assert done[0] - start >= (5 if "5" in wait else 0)
    if wait == "M109 S60":
        assert s.printer.rig.connection.heaters["hotend"].celsius > 58


# -- lines that break -----------------------------------------------------------------------------


def broken(*_, **__):
    raise ZeroDivisionError("by the test")


FAULT = "a fault of the program, ZeroDivisionError: by the test"


@pytest.mark.parametrize(
    ("line", "place"),
    [
        ("M105", "act"),
        ("G1 X30", "take_line"),
        ("M109 S200", "take_line"),
        ("M109 S200", "wait"),
        ("G28", "finish"),
    ],
)
def test_internal_error_halts_and_line_still_gets_ok(s, monkeypatch, line, place):
    s.host.ok("M140 S60")
    s.passes(1)
    with monkeypatch.context() as patch:
        patch.setattr(s.printer.waits if place == "wait" else s.printer.dispatch, place, broken)
        answer = s.host.ok(line)
    assert answer[-1] == "ok"
    assert any(FAULT in x for x in answer)
    assert FAULT in s.printer.state.halted
    s.host.expect("^Error:Printer halted: a fault of the program", 1)
    assert not s.printer.motion_lock.locked
    assert s.printer.rig.connection.heaters["bed"].target == 0
    s.host.send("M999")
    s.host.expect("ready again", 3)
    assert s.host.ok("G28", 60)[-1] == "ok"


@pytest.mark.parametrize("again", [False, True], ids=["once", "in each pass"])
@pytest.mark.parametrize("line", ["G1 X60 F6000", "G28", "M109 S50", "M118 nothing"])
def test_internal_error_in_a_timer_halts(s, line, again):
    faulty = [True]

    def watch():
        if faulty[0]:
            faulty[0] = again
            broken()

    s.host.ok("M140 S60")
    s.passes(1)
    assert s.board.output_value("bed") > 0
    s.host.send(line)
    s.printer.lifetime.as_time_passes(watch)
    s.host.expect("^Error:Printer halted: a fault of the program", 3)
    s.passes(0.5)
    assert FAULT in s.printer.state.halted
    assert len(oks(s.host)) == 3  # G92, M140, and this line
    assert not s.printer.motion_lock.locked
    assert s.printer.rig.connection.heaters["bed"].target == 0
    assert s.board.output_value("bed") == 0
    faulty[0] = False
    s.host.ok("M999")
    assert s.host.ok("G28", 60)[-1] == "ok"


def test_internal_error_in_a_wait_halts(s, monkeypatch):
    s.host.send("M109 S200")
    s.passes(1)
    s.host._read = len(s.host.heard)
    heater = type(s.printer.rig.connection.heaters["hotend"])
    monkeypatch.setattr(heater, "settled", property(lambda _: broken()), raising=True)
    s.host.expect(FAULT, 3)
    s.host.expect("^ok", 1)
    s.host.expect("^Error:Printer halted: a fault of the program", 1)
    assert s.printer.rig.connection.heaters["hotend"].target == 0
    monkeypatch.undo()
    s.host.ok("M999")
    assert not s.printer.state.halted


def test_error_while_plan_is_full_releases_motion_lock(s, monkeypatch):
    s.host.ok("G1 X100 F600")
    s.host.send("G1 X120", "M118 after")
    monkeypatch.setattr(s.printer.dispatch, "take_line", broken)
    s.host.expect(FAULT, 10)
    s.host.expect("^after$", 1)
    assert not s.printer.motion_lock.locked
    assert len(oks(s.host)) == 4  # G92, G1, G1, M118


@pytest.mark.parametrize("line", ["M500 G1 X60 F6000", "G4 P1 M500 G1 X60", "M400 M500 G1 X60"])
def test_failed_command_ends_only_its_line(s, monkeypatch, line):
    def fails(*_):
        raise CardError.of("card.absent", value="by the test")

    monkeypatch.setitem(s.printer.dispatch.planned, "M500", fails)
    answer = s.host.ok(line)
    assert "there is no card: by the test" in answer[0]
    assert not s.printer.state.halted
    assert s.host.ok("G1 X40 F6000") == ["ok"]
    s.host.ok("M400")
    assert s.positions()["x"] == 40.0


def test_a_wait_that_fails_ends_its_line_and_not_its_console():
    """The heater stops by itself; the rest of the machine goes on."""
    text = shipped_text("i3").replace(
        "[heaters.hotend]\n", '[heaters.hotend]\non_fault = "heater"\n'
    )
    with Scenario(config.load_text(text)) as s:
        s.host.ok("G92 X20 Y20 Z20")
        s.host.send("M109 S200 G1 X60 F6000")
        s.passes(2)
        s.board.force_sensor("hotend", 1.0)
        s.host.expect("^ok", 10)
        assert not s.printer.state.halted
        assert s.host.ok("G1 X40 F6000") == ["ok"]
        assert s.host.ok("M400") == ["ok"]
        assert s.positions()["x"] == 40.0


# -- reports --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("command", "shown"), [("M155 S0.0001", " T:"), ("M154 S0.001", "X:"), ("M921 S.01", "//trace")]
)
def test_reports_come_ten_times_a_second_at_most(s, command, shown):
    s.host.ok(command)
    start = len(s.host.heard)
    s.passes(2.05)
    lines = [x for x in s.host.heard[start:] if x.startswith(shown)]
    each = len(s.printer.machine.heaters) if command.startswith("M921") else 1
    assert len(lines) == 20 * each


ARC = "G3 X100 Y100 I1 J0 P11000 F60000"  # more than a job has messages for at once


def test_line_longer_than_the_plan_is_completed():
    with Scenario("i3") as s:
        s.host.ok("G92 X100 Y100 Z5")
        s.host.send(ARC, "M104 S100", "M118 after")
        s.host.silent(60, "^ok|after")
        assert s.printer.rig.connection.heaters["hotend"].target == 0
        s.host.expect("^after$", 1300)
        s.host.ok("M400", 60)
        assert s.printer.rig.connection.heaters["hotend"].target == 100
        circles = (
            s.printer.rig.job.results.statistics()["print_mm"]
            + s.printer.rig.job.results.statistics()["travel_mm"]
        )
        assert circles == pytest.approx(11000 * 2 * pi, rel=2e-3)  # of chords


@pytest.mark.parametrize("closes", [False, True])
def test_line_longer_than_the_plan_can_be_stopped(closes):
    with Scenario("i3") as s:
        other = Host(s)
        s.host.ok("G92 X100 Y100 Z5")
        s.host.send(ARC)
        s.passes(5)
        if closes:
            s.host.session.close()
            other.send("M108")
            s.passes(5)  # what moves goes on
            assert s.printer.motion_lock.locked
        other.send("M410")
        s.passes(3)
        assert not s.printer.motion_lock.locked
        assert other.ok("G1 X60 F6000", 5) == ["ok"]
        s.passes(3)
        assert s.printer.rig.job.program_position[0] == 60
        assert closes or s.host.heard[-1] in ("ok", "wait")
