"""M600 and M601 of a console in the pause of a file, which stays paused until M24."""

import pytest
from tests.job.test_host_pause import PLACE, actions, at, parking, way
from tests.support.scenario import Host, Scenario

TURNS = [f"G1 X{50 + 20 * (i % 2)} Y{40 + i} E0.1 F1500" for i in range(30)]
PROGRAM = "\n".join(["G92 X20 Y20 Z20", "M83", "M302 P1", "G1 X50 Y40 F6000", *TURNS, "G1 X33 Y44"])


@pytest.fixture
def s(tmp_path):
    """In the middle of the file."""
    (tmp_path / "a.g").write_text(PROGRAM)
    with Scenario(parking(), card=str(tmp_path)) as scenario:
        scenario.begin = at(scenario)
        scenario.host.ok("M32 a.g")
        scenario.passes(8)
        yield scenario


def ends_where_it_should(s: Scenario, more_e: float = 0.0) -> None:
    s.host.expect("^Done printing file$", 120)
    assert way(s.begin, at(s)) == pytest.approx((13, 24, 0, 3 + more_e), abs=0.02)
    assert not s.printer.state.halted


@pytest.mark.parametrize("command", ["M600 U80 L50", "M601"])
@pytest.mark.parametrize("answer", ["M108", "M876 S0"])
@pytest.mark.parametrize("pause_s", [0.0, 10.0])
def test_filament_change_in_pause_returns_and_stays_paused(s, command, answer, pause_s):
    s.host.ok("M25")
    s.passes(pause_s)
    filament = -30 if "U" in command else 0
    parked = at(s)
    s.host.send(command)
    s.passes(20)
    if pause_s:
        lift, back = s.machine.park.raise_mm, s.machine.park.retract_mm
        unloaded = 80 if filament else 0
        assert way(parked, at(s)) == pytest.approx((0, 0, lift, -back - unloaded), abs=0.02)
    Host(s).send(answer)
    s.host.expect("^ok", 20)
    s.passes(20)
    if pause_s:
        assert way(parked, at(s)) == pytest.approx((0, 0, 0, filament), abs=0.02)
    assert (s.positions()["x"], s.positions()["y"]) == pytest.approx(
        (PLACE[0] - 20 + s.begin[0], PLACE[1] - 20 + s.begin[1]), abs=0.1
    )
    s.host.silent(60, "Done|resume")
    assert "pause" not in actions(s.host)  # a host that hears it would send M24 behind it
    assert s.host.ok("M27")[0].startswith("SD printing byte")
    s.host.ok("M24")
    ends_where_it_should(s, filament)


@pytest.mark.parametrize(("end", "change_s"), [("closed", 1.0), ("closed", 10.0), ("M410", 10.0)])
@pytest.mark.parametrize("pause_s", [0.0, 10.0])
def test_filament_that_was_taken_back_comes_back_with_the_file(s, pause_s, change_s, end):
    """Nobody goes on with M600: the host that sent it has gone, or it is stopped. It takes filament
    back before the file itself does, or again."""
    other = Host(s)
    if pause_s:
        s.host.ok("M25")
        s.passes(pause_s)
        other.send("M600")
    else:
        other.send("M600")
        s.host.send("M25")
    s.passes(change_s)
    if end == "closed":
        other.session.close()
    else:
        s.host.send(end)
    s.passes(5)
    s.host.ok("M24")
    ends_where_it_should(s)


def test_m25_right_after_m600(s):
    s.host.send("M600")
    Host(s).send("M25")
    s.passes(30)
    Host(s).send("M108")
    s.host.expect("^ok", 20)
    s.host.silent(30, "Done")
    s.host.ok("M24")
    ends_where_it_should(s)


@pytest.mark.parametrize("own", [True, False])
@pytest.mark.parametrize("answer", ["M24", "M602"])
def test_resume_ends_filament_change_too(s, own, answer):
    s.host.ok("M25")
    s.passes(10)
    s.host.send("M600 U80 L80")
    s.passes(20)
    (s.host if own else Host(s)).send(answer)
    ends_where_it_should(s)
    assert actions(s.host)[-1] == "resumed"


def test_m600_of_a_console_pauses_a_file_that_is_printed(s):
    assert "echo:Change the filament, then continue with M24" in s.host.ok("M600 Z7", 20)
    s.passes(10)
    assert way(s.begin, at(s))[2] == pytest.approx(7, abs=0.02)
    s.host.silent(30, "Done")
    s.host.ok("M108")
    ends_where_it_should(s)


@pytest.mark.parametrize("stop", ["M524", "M410"])
def test_stop_in_filament_change_does_not_return(s, stop):
    s.host.ok("M25")
    s.passes(10)
    s.host.send("M600")
    s.passes(20)
    suspended = at(s)
    other = Host(s)
    other.send(stop)
    s.host.expect("it was stopped", 5)
    s.passes(20)
    assert at(s) == suspended
    if stop == "M410":  # the file is still paused
        other.ok("M24")
        s.host.expect("^Done printing file$", 120)
        assert way(s.begin, at(s)) == pytest.approx((13, 24, 0, 3), abs=0.02)
    else:
        assert other.ok("M27")[0] == "Not SD printing"
