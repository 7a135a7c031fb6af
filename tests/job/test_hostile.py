"""What people do to a print at the worst moment, and where the printer is afterwards."""

import pytest
from tests.support.scenario import Host, Scenario

HEAD = "M302 P1\nG28\nG92 E0\n"
WAYS = "".join(f"G1 X{20 + i % 2 * 60} Y{20 + i} Z1 E{i / 5} F3000\n" for i in range(40))
END = {"x": 80.0, "y": 59.0, "z": 1.0, "e": 7.801}


@pytest.fixture
def start(tmp_path):
    """Prints a text, and gives the printer some seconds into it."""
    scenarios = []

    def started(text=HEAD + WAYS, after=12.0):
        (tmp_path / "a.g").write_text(text)
        scenarios.append(Scenario("i3", card=str(tmp_path)))
        scenarios[-1].host.ok("M32 a.g")
        scenarios[-1].passes(after)
        return scenarios[-1]

    yield started
    for scenario in scenarios:
        scenario.__exit__()


def prints_to_its_end(s, seconds=120):
    s.host.expect("Done printing file", seconds)
    at = s.positions()
    del at["e"]  # of a print that was cancelled, what was drawn back stays so
    assert at == {axis: END[axis] for axis in "xyz"}
    return s.positions()["e"]


def is_paused(s):
    return s.host.ok("M27")[0].startswith("SD printing") and s.printer.rig.queue.standing


def target(s):
    return s.printer.rig.connection.heaters["hotend"].target


def test_a_pause_leaves_the_heaters_on(start):
    s = start("M104 S200\n" + HEAD + WAYS)
    s.host.ok("M25")
    for _ in range(5):
        s.passes(1)
        assert target(s) == 200
    s.host.ok("M24")
    prints_to_its_end(s)
    assert target(s) == 200


@pytest.mark.parametrize("after", [0.3, 1.5, 3.0, 4.2])
def test_a_pause_while_axes_home_comes_when_they_are_there(start, after):
    s = start(after=after)
    assert s.printer.motion.homer.active
    s.host.ok("M25")
    s.passes(12)
    assert is_paused(s)
    assert s.printer.rig.job.locked_axes == []
    s.host.ok("M24")
    assert prints_to_its_end(s) == END["e"]


def test_pause_cancelled_during_homing_does_not_pause(start):
    s = start(after=1.0)
    s.host.send("M25", "M24")
    assert prints_to_its_end(s) == END["e"]


@pytest.mark.parametrize("command", ["M600", "M601"])
@pytest.mark.parametrize("stop", ["M524", "M410", "M25 M26"])
def test_cancel_while_file_pause_is_pending(start, command, stop):
    """What was to come behind the moves that were cut does not come: nobody is asked, nor waits."""
    s = start(HEAD + f"G1 X100 Y100 F3000\nG1 X10 F900\n{command}\nG1 X90\n", after=14)
    assert not s.printer.rig.queue.standing
    s.host.send(*stop.split())
    s.passes(1)
    at = s.positions()
    s.passes(5)
    assert s.positions() == at
    assert not s.printer.rig.job.stops.suspended
    assert not [x for x in s.host.heard if x.startswith("// action:p") and x != "// action:paused"]
    s.host.ok("G1 X90 F3000", 5)


def test_cancel_while_a_console_heats_in_a_pause(start):
    s = start()
    other = Host(s)
    s.host.ok("M25")
    s.passes(5)
    other.send("M109 S200")
    s.passes(3)
    assert target(s) == 200
    s.host.ok("M524")
    other.expect("^ok", 2)
    s.passes(1)
    assert target(s) == 0
    assert not s.printer.motion_lock.locked
    s.host.ok("M24")
    prints_to_its_end(s)


M600 = HEAD + WAYS.replace("X20 Y40", "X20 Y40\nM600\nG1 X20 Y40")


def test_cancel_during_filament_change(start):
    s = start(M600, after=0)
    s.host.expect("Change the filament", 60)
    s.passes(0.4)
    s.host.ok("M524")
    s.passes(2)
    assert "Not SD" in s.host.ok("M27")[0]
    s.host.ok("M108")
    s.host.ok("M24")
    s.host.expect("Change the filament", 60)
    s.passes(3)
    assert is_paused(s)
    s.host.ok("M108")
    prints_to_its_end(s)


def test_halt_during_filament_change(start):
    """After M999 the file begins anew, also one that was read far ahead."""
    s = start(M600 + "; so that it is longer than what is read at once\n" * 1000, after=0)
    s.host.expect("Change the filament", 60)
    s.passes(1)
    s.host.send("M112")
    s.host.expect("Printer halted", 2)
    s.host.send("M999")
    s.host.expect("ready again", 10)
    s.host.ok("M24")
    s.host.expect("Change the filament", 60)
    s.passes(3)
    s.host.ok("M24")
    prints_to_its_end(s)


def test_two_consoles_pause_and_resume_at_once(start):
    s = start()
    other = Host(s)
    for wait in (3.0, 0.0, 0.05, 0.5):
        s.host.send("M25")
        other.send("M25")
        s.passes(wait)
        s.host.send("M24")
        other.send("M24")
        s.passes(0.02)
    s.passes(0.5)
    assert prints_to_its_end(s) == END["e"]


@pytest.mark.parametrize("moment", [0.0, 0.02, 0.1, 0.4, 1.5, 4.0])
@pytest.mark.parametrize("again", [False, True])
def test_cancel_while_braking_parking_or_returning(start, moment, again):
    s = start()
    s.host.ok("M25")
    if again:
        s.passes(4)
        s.host.ok("M24")
    s.passes(moment)
    s.host.ok("M524")
    s.passes(2)
    assert s.printer.rig.queue.standing
    s.host.ok("M24")
    prints_to_its_end(s)


def test_cancel_and_start_sent_together(start):
    s = start(HEAD + WAYS + "G1 E0\n" + WAYS)
    s.host.send("M524", "M24")
    s.passes(1)
    s.host.send("M524", "M24", "M524")
    s.passes(2)
    assert "Not SD" in s.host.ok("M27")[0]
    s.host.send("M524", "M24")
    prints_to_its_end(s)
    assert s.host.heard.count("Done printing file") == 1


@pytest.mark.parametrize("after", [3.0, 7.0, 12.0, 45.0])
def test_m410_ends_a_print(start, after):
    s = start(HEAD + "M109 S50\n" + WAYS if after == 7.0 else HEAD + WAYS, after)
    s.host.send("M410")
    s.host.expect("Print of a.g stopped: M410", 2)
    s.passes(2)
    assert s.printer.rig.queue.standing
    assert "Not SD" in s.host.ok("M27")[0]
    s.host.ok("M24")  # from its beginning
    prints_to_its_end(s, 300)


def test_m410_in_a_pause_stops_only_what_moves_then(start):
    s = start()
    s.host.ok("M25")
    s.passes(0.5)
    s.host.send("M410")
    s.passes(2)
    assert is_paused(s)
    s.host.ok("M24")
    prints_to_its_end(s)


def test_print_resumes_after_motors_off_in_a_pause(start):
    """The print waits until the axes know again where they are."""
    s = start()
    s.host.ok("M25")
    s.passes(5)
    s.host.ok("M84")
    assert "axis X is not homed" in s.host.ok("M24")[0]
    s.passes(1)
    assert is_paused(s)
    s.host.ok("G28", 60)
    s.host.ok("M24")
    prints_to_its_end(s)


def test_moves_in_a_pause_of_a_print_without_z(start):
    """Nothing parks, since Z does not know where it is; what was moved by hand goes back."""
    s = start(HEAD.replace("G28", "G28 X Y") + WAYS.replace(" Z1", ""))
    s.host.ok("M25")
    s.passes(3)
    at = s.positions()
    s.host.ok("G1 X5 Y5 F6000")
    s.host.ok("M24")
    s.host.expect("Done printing file", 120)
    assert s.positions() == END | {"z": at["z"]}


def test_print_resumes_after_homing_in_a_pause(start):
    s = start()
    s.host.ok("M25")
    s.passes(5)
    s.host.ok("G28", 60)
    s.host.ok("M24")
    assert prints_to_its_end(s) == END["e"]


def test_the_file_that_is_printed_is_neither_deleted_nor_written(start):
    s = start()
    assert "is being printed" in s.host.ok("M30 a.g")[0]
    assert "is being printed" in s.host.ok("M28 a.g")[0]
    s.host.ok("M106 S255")  # for the file, which is none
    s.host.ok("M29")
    assert "is being printed" in s.host.ok("M23 a.g")[0]
    assert "is being printed" in s.host.ok("M22")[0]
    assert prints_to_its_end(s) == END["e"]
    assert s.board.output_value("part") == 0
