"""How print time passes: from standing still, through running dry, and where time is free."""

import random
import re

import pytest
from tests.support.scenario import Host, Scenario

from passo.motion.motion_queue import BUFFER_S, GATHER_S, HORIZON_S, LEAD_S


@pytest.fixture
def s():
    with Scenario("i3") as scenario:
        scenario.host.ok("G92 X20 Y20 Z20")
        scenario.passes(1)
        yield scenario


def speeds(s, seconds, step_s=0.02):
    """Speeds of X, mm/s, in spans of so many seconds."""
    found, before = [], s.positions()["x"]
    for _ in range(round(seconds / step_s)):
        s.passes(step_s)
        at = s.positions()["x"]
        found.append((at - before) / step_s)
        before = at
    return found


def test_a_standing_machine_starts_soon_after_the_first_line(s):
    start = s.loop.time()
    s.host.ok("G1 X60 F6000")
    assert s.loop.time() == start  # `ok` does not wait for motion
    assert s.until(lambda: s.positions()["x"] != 20.0, 1)
    assert LEAD_S / 2 < s.loop.time() - start < LEAD_S + 0.05


def test_a_burst_of_lines_is_planned_together(s):
    s.host.send(*(f"G1 X{20 + i} F3000" for i in range(1, 61)))
    s.passes(LEAD_S + GATHER_S + 0.1)
    assert min(speeds(s, 0.6)) == pytest.approx(50, abs=2)  # 60 mm at 50 mm/s, never slower


def test_moves_that_arrive_one_by_one_run_without_a_stop(s):
    """A host that sends 10 mm every 0.2 s, as they are driven: the plan is always about to end."""
    for i in range(1, 4):
        s.host.send(f"G1 X{20 + 10 * i} F3000")
    found = []
    for i in range(4, 14):
        found += speeds(s, 0.2)
        s.host.send(f"G1 X{20 + 10 * i} F3000")
    assert min(found[20:]) > 40
    s.host.ok("M400")
    assert s.positions()["x"] == 150.0


def test_moves_that_come_too_late_start_again_and_lose_nothing(s):
    for i in range(1, 6):
        s.host.send(f"G1 X{20 + 10 * i} F3000")
        assert s.until(lambda: s.printer.rig.queue.standing, 2)
        assert s.positions()["x"] == 20 + 10 * i
    s.passes(60)
    s.host.ok("G1 X25")
    s.host.ok("M400")
    assert s.positions()["x"] == 25.0


def test_full_plan_accepts_no_more_lines(s):
    s.host.send(*(f"G1 X{20 + i % 2 * 50} F3000" for i in range(40)))  # 1 s each, and more
    s.passes(0.5)
    acknowledged = sum(x.startswith("ok") for x in s.host.heard) - 1
    assert acknowledged == 4  # the first goes nowhere; the fourth reaches beyond
    assert (
        s.printer.rig.job.clock + s.printer.rig.job.plan.queued_ticks
        < s.printer.rig.queue.now + ((BUFFER_S + 1.5) * s.printer.rig.queue.hz)
    )


def test_a_host_that_stops_sending_is_at_rest_soon(s):
    """It sends the next of many short moves at each `ok`, and pauses by sending no more."""
    for i in range(400):
        start = len(s.host.heard)
        s.host.send(f"G1 X{20 + i % 2 * 10} F3000")
        assert s.until(lambda: any(x == "ok" for x in s.host.heard[start:]), 3)  # noqa: B023
    assert s.until(lambda: s.printer.rig.queue.standing, BUFFER_S + 0.5)


def test_free_time_pauses_while_nothing_waits():
    with Scenario("i3", free=True) as s:
        queue = s.printer.rig.queue
        s.passes(1)
        before = queue.now
        s.passes(600)
        assert queue.now == before
        assert s.host.ok("M105")[0].startswith("ok T:")
        assert queue.now == before


def test_free_time_passes_only_while_something_waits():
    with Scenario("i3", free=True) as s:
        queue = s.printer.rig.queue
        start, printed = s.loop.time(), queue.now_s
        s.host.ok("M109 S200", 100)
        assert s.loop.time() - start < 1
        assert queue.now_s - printed > 20
        s.host.ok("G28", 100)
        s.host.ok("G4 S1000")
        s.host.ok("M400")
        assert s.loop.time() - start < 2
        assert queue.now_s - printed > 1020


@pytest.mark.parametrize(
    "lines",
    [["M0"], ["M600"], ["M0", "G1 X5"], ["M600", "G1 X5 F3000"], ["M104 S200", "G4 P500", "M0"]],
)
def test_free_time_pauses_while_a_user_is_waited_for(lines):
    with Scenario("i3", free=True) as s:
        queue = s.printer.rig.queue
        s.host.ok("G28", 100)
        s.host.ok("M109 S200", 100)
        s.host.send(*lines)
        s.host.expect("paused for user", 20)
        s.passes(1)  # the nozzle has left
        before = queue.now
        s.passes(600)
        assert queue.now == before
        other = Host(s)
        assert other.ok("M105")[0].startswith("ok T:")
        assert queue.now == before
        other.ok("M108")
        s.host.ok("M400", 20)
        assert s.until(lambda: queue.standing, 1)


def test_free_time_passes_for_a_pause_of_some_seconds():
    with Scenario("i3", free=True) as s:
        start, printed = s.loop.time(), s.printer.rig.queue.now_s
        s.host.ok("M0 S1000", 20)
        assert s.loop.time() - start < 1
        assert 1000 < s.printer.rig.queue.now_s - printed < 1001


@pytest.mark.parametrize("line", ["M108", "M410", "M112"])
def test_wait_for_the_user_in_free_time_ends(line):
    with Scenario("i3", free=True) as s:
        s.host.ok("G28", 100)
        s.host.send("M0", "G1 X50 F3000")
        s.host.expect("paused for user", 20)
        s.passes(1)
        other = Host(s)
        other.send(line)
        s.passes(2)
        if line == "M112":
            assert s.printer.state.halted
            other.send("M999")
            s.host.expect("ready again", 2)
        assert s.until(lambda: not s.printer.waits.busy, 2)
        s.host.ok("M115", 5)


def test_in_free_time_moves_are_done_when_the_host_is_silent():
    with Scenario("i3", free=True) as s:
        s.host.ok("G92 X20")
        s.host.send("G1 X60 F600")
        s.passes(2)
        assert s.positions()["x"] == 60.0


@pytest.mark.parametrize("seed", range(4))
def test_a_stall_of_half_a_second_is_covered_whenever_it_comes(s, seed):
    """Whatever the board needs for half a second, and for the time that what is planned then takes
    to get there, is handed out; or else all is, for a stop."""
    chance = random.Random(seed)
    job, queue = s.printer.rig.job, s.printer.rig.queue
    least = []

    def look():
        ahead = (job.plan.handed_out - queue.now) / queue.hz
        if job.plan.queued > 0 and job.plan.handed_out > 0:
            least.append(ahead)

    s.printer.lifetime.as_time_passes(look)
    for _ in range(60):
        x, y = chance.uniform(20, 60), chance.uniform(20, 60)
        s.host.send(f"G1 X{x:.3f} Y{y:.3f} F{chance.choice((600, 1200, 3000))}")
        s.passes(chance.uniform(0, 0.9))
    assert len(least) > 50
    assert min(least) > 0.5 + HORIZON_S


@pytest.mark.parametrize(
    ("line", "report", "every_s"),
    [("M155 S5", "^ T:", 5), ("M921 S7", "trace hotend", 7), ("M154 S4", "^X:", 4)],
)
def test_reports_come_at_their_print_time_in_free_time(line, report, every_s):
    with Scenario("i3", free=True) as s:
        queue, heard_s = s.printer.rig.queue, []
        write = s.host.write

        def hear(text, *, dispensable=False):
            if re.search(report, text.decode(), re.MULTILINE):
                heard_s.append(queue.now_s)
            write(text, dispensable=dispensable)

        s.host.write = hear
        asked_s = queue.now_s
        s.host.ok(line)
        s.host.ok("M190 S60", 100)
        s.host.ok("G4 S60")
        s.host.ok("M400", 10)
        until_s = queue.now_s
        count = int((until_s - asked_s) / every_s)
        assert count > 20
        due_s = [asked_s + (i + 1) * every_s for i in range(count)]
        assert heard_s == pytest.approx(due_s, abs=0.001)
        s.host.ok(f"{line.split()[0]} S0")
        s.host.ok("G4 S60 M400", 10)
        assert len(heard_s) == count


def test_reports_come_at_host_time_while_free_time_pauses():
    with Scenario("i3", free=True) as s:
        s.host.ok("M155 S5")
        s.passes(52)
        assert sum(line.startswith(" T:") for line in s.host.heard) == 10


@pytest.mark.parametrize("free", [False, True])
def test_a_wait_reports_temperatures_each_second_of_print_time(free):
    with Scenario("i3", free=free) as s:
        start_s = s.printer.rig.queue.now_s
        s.host.ok("M109 S100", 300)
        seconds = s.printer.rig.queue.now_s - start_s
        reports = [line for line in s.host.heard if line.endswith("W:?")]
        assert seconds > 15
        assert len(reports) == pytest.approx(seconds, abs=1.5)
        celsius = [float(re.match(r" T:([-\d.]+)", line)[1]) for line in reports]
        assert celsius[0] < 40
        assert celsius[-1] == pytest.approx(100, abs=2)


def test_free_time_passes_for_an_emergency_stop():
    """Nothing waits and nothing moves: the board must hear of it all the same."""
    with Scenario("i3", free=True) as s:
        s.passes(2)
        s.host.ok("M112")
        s.host.expect("^Error:Printer halted: emergency stop by M112", 1)
        s.host.send("M999")
        s.host.expect("ready again", 1)
        assert s.printer.state.halted == ""
        s.host.ok("G28")
        assert s.printer.rig.job.locked_axes == []


def test_two_restarts_count_as_one():
    with Scenario("i3") as s:
        s.host.ok("M112")
        s.host.expect("Printer halted", 5)
        s.host.send("M999", "M999")
        s.host.expect("ready again", 5)
        s.host.ok("M112")
        s.host.expect("Printer halted", 5)
        s.passes(10)
        assert s.printer.state.halted == "emergency stop by M112"
