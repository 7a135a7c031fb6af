"""A print with two extruders that is stopped: each of them is where it has stopped, and the tool in
use is the one that was printing, however far the file was read ahead."""

from pathlib import Path

import pytest
from tests.console.scenario import Scenario
from tests.job.disturbed import steps

from passo import _core, config
from passo.config.machine import MachineConfig

FIRST = 8  # line of the first move with T1; T0 comes behind ten of them
TURNS = [f"G1 X{50 + 30 * (i % 2)} E2 F1800" for i in range(10)]
PROGRAM = ["M302 P1", "G28", "T0", "M83", "G1 X60 Y50 Z5 F6000", "G1 E3 F600", "T1", *TURNS]
PROGRAM += ["T0", *TURNS, "T1", "G1 X100 E1", "M400"]


@pytest.fixture
def card(tmp_path: Path) -> str:
    (tmp_path / "a.g").write_text("\n".join(PROGRAM) + "\n")
    return str(tmp_path)


def parking() -> MachineConfig:
    """A machine that takes filament back while it stands aside."""
    text = config.shipped_text("dual-extruder")
    return config.load_text(text + "\n[park]\nposition_mm = [5.0, 180.0]\nretract_mm = 2.0\n")


def amid_t1(s: Scenario) -> None:
    """Starts the file, up to the moves of T1; those of T0 are planned by then."""
    s.host.ok("M32 a.g")
    s.until(lambda: s.printer.job.line_at(s.printer.drive.now) >= FIRST + 2, 300)
    assert s.printer.job.tool == 0  # read ahead


def undisturbed(card: str) -> dict[str, int]:
    with Scenario(parking(), card=card) as s:
        s.host.ok("M32 a.g")
        s.host.expect("Done printing", 900)
        return steps(s)


@pytest.mark.parametrize(
    "meanwhile", [[], ["M400"], ["T0"], ["T0", "T1"], ["T0", "G1 X100 F6000", "M400", "T1"]]
)
def test_after_a_pause_it_ends_where_it_would_have_ended(card, meanwhile):
    wanted = undisturbed(card)
    with Scenario(parking(), card=card) as s:
        amid_t1(s)
        s.host.ok("M25")
        for line in meanwhile:
            s.host.ok(line, 100)
        s.host.ok("M24")
        s.host.expect("Done printing", 900)
        assert steps(s) == wanted


def test_the_extruder_that_has_printed_takes_its_filament_back(card):
    with Scenario(parking(), card=card) as s:
        amid_t1(s)
        before = steps(s)
        s.host.ok("M25")
        s.passes(20)
        assert s.printer.job.tool == 1
        assert steps(s)["e"] == before["e"]


@pytest.mark.parametrize("stop", ["M410", "M524"])
def test_after_a_stop_each_extruder_moves_from_where_it_is(card, stop):
    with Scenario(parking(), card=card) as s:
        amid_t1(s)
        s.host.ok(stop)
        s.passes(5)
        assert s.printer.job.tool == 1
        for line in ("M302 P1", "M83"):
            s.host.ok(line)
        for tool, motor in ((0, "e"), (1, "e1"), (0, "e")):
            before = steps(s)
            s.host.ok(f"T{tool}")
            s.host.ok("G1 E1 F300")
            s.host.ok("M400", 60)
            now = steps(s)
            per_mm = s.printer.machine.steppers[motor].steps_per_mm
            moved = {name: now[name] - before[name] for name in ("e", "e1")}
            other = {"e": "e1", "e1": "e"}[motor]
            assert moved[other] == 0
            assert abs(moved[motor] - per_mm) <= 1


def test_a_further_axis_that_is_moved_in_a_pause_comes_back(tmp_path):
    text = config.shipped_text("i3").replace("[steppers.e]", "[steppers.u]")
    text = text.replace("[extruders.e]", "[axes.u]\nmin_mm = -100.0\nhome_mm = 0.0\nmax_mm = 100.0")
    turns = [f"G1 X{50 + 40 * (i % 2)} U{i} F1500" for i in range(10)]
    program = ["G28", "G92 U0", "G1 X50 Y50 Z5 F6000", *turns, "M400"]
    (tmp_path / "a.g").write_text("\n".join(program) + "\n")

    def net(moved_mm: float) -> dict[str, int]:
        with Scenario(config.load_text(text), card=str(tmp_path)) as s:
            s.host.ok("M32 a.g")
            s.until(lambda: s.printer.job.line_at(s.printer.drive.now) >= FIRST, 300)
            s.host.ok("M25")
            for line in ("G91", f"G1 U{moved_mm:g} F300", "M24"):
                s.host.ok(line)
            s.host.expect("Done printing", 300)
            return steps(s)

    assert net(20) == net(0)


# -- tools that share an extruder ------------------------------------------------------------------

OFFSET_MM = 5.0  # of T1 along X


def sharing() -> MachineConfig:
    """Five tools with one extruder, the second one with a place of its own."""
    tool = '[[tools]]\nextruder = "e"\n'
    first, second, *rest = config.shipped_text("multi-material").split(tool)
    offset = f"offset_mm = [{OFFSET_MM}, 0.0, 0.0]\n"
    text = tool.join([first, second, offset + rest[0], *rest[1:]])
    return config.load_text(text + "\n[park]\nposition_mm = [5.0, 180.0]\nretract_mm = 2.0\n")


def amid_t0() -> _core.Job:
    """In the first of two moves, with T0, the one with T1 being planned."""
    job = _core.Job(sharing().core_spec(), True)
    job.feed(b"M83\nT0\nG1 X50 E1 F3000\nT1\nG1 X80 E1\n")
    while job.advance() == _core.JobStatus.EVENT:
        pass
    job.flush()
    assert job.tool == 1
    return job


def test_the_tool_that_was_stopped_is_in_use_and_its_offset():
    job = amid_t0()
    job.stop_from(0.1 * job.clock)
    x = job.machine_position[0]
    assert 0 < x < 50
    assert (job.tool, job.program_position[0]) == (0, pytest.approx(x))
    job.feed(b"G1 X20\n")
    job.advance()
    assert job.machine_position[0] == pytest.approx(20)


def test_the_tool_that_stands_aside_is_in_use_and_the_program_goes_on_with_the_other():
    job = amid_t0()
    job.hold_from(0.1 * job.clock)
    job.suspend()
    assert (job.tool, job.program_position[0]) == (0, pytest.approx(job.stop_position[0]))
    job.resume()
    job.flush()
    assert job.tool == 1
    assert job.machine_position[0] == pytest.approx(80 + OFFSET_MM)
    assert job.program_position[0] == pytest.approx(80)


def test_a_babystep_while_it_stands_stays_with_the_tool_that_was_stopped():
    job = amid_t0()
    job.hold_from(0.1 * job.clock)
    assert job.shift_from(job.clock, 2, 0.1) is not None
    job.suspend()
    assert job.tool == 0


def test_a_print_with_such_tools_is_paused_and_ends_where_it_would_have_ended(tmp_path):
    turns = [f"G1 X{50 + 30 * (i % 2)} E2 F1800" for i in range(4)]
    program = ["M302 P1", "G28", "M83", "T0", "G1 X60 Y50 Z5 F6000", *turns, "T1", *turns, "M400"]
    (tmp_path / "a.g").write_text("\n".join(program) + "\n")

    def net(meanwhile: list[str] | None) -> dict[str, int]:
        with Scenario(sharing(), card=str(tmp_path)) as s:
            s.host.ok("M32 a.g")
            if meanwhile is not None:
                s.until(lambda: s.printer.job.line_at(s.printer.drive.now) >= 7, 300)
                assert s.printer.job.tool == 1  # read ahead
                s.host.ok("M25")
                s.passes(20)
                assert s.printer.job.tool == 0
                for line in meanwhile:
                    s.host.ok(line, 100)
                s.host.ok("M24")
            s.host.expect("Done printing", 900)
            return steps(s)

    wanted = net(None)
    assert net([]) == wanted
    assert net(["T1", "G1 X100 F6000", "M400", "T0"]) == wanted
    assert net(["T3"]) == wanted
