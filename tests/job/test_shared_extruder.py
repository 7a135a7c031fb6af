"""Tools that share an extruder: the one that was printing is in use after a stop, with its offset,
however far the file was read ahead."""

from pathlib import Path

import pytest
from tests.support.disturbed_prints import steps
from tests.support.scenario import Scenario

from passo import _core, config
from passo.config.machine import MachineConfig

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
    job.stops.stop_from(0.1 * job.clock)
    x = job.machine_position[0]
    assert 0 < x < 50
    assert (job.tool, job.program_position[0]) == (0, pytest.approx(x))
    job.feed(b"G1 X20\n")
    job.advance()
    assert job.machine_position[0] == pytest.approx(20)


def test_tool_of_pause_is_in_use_and_program_keeps_its_own():
    job = amid_t0()
    job.stops.hold_from(0.1 * job.clock)
    job.stops.suspend()
    assert (job.tool, job.program_position[0]) == (0, pytest.approx(job.stops.position[0]))
    job.stops.resume()
    job.flush()
    assert job.tool == 1
    assert job.machine_position[0] == pytest.approx(80 - OFFSET_MM)
    assert job.program_position[0] == pytest.approx(80)


def test_babystep_in_pause_stays_with_stopped_tool():
    job = amid_t0()
    job.stops.hold_from(0.1 * job.clock)
    assert job.plan.shift_from(job.clock, 2, 0.1) is not None
    job.stops.suspend()
    assert job.tool == 0


def test_print_with_shared_extruder_paused_ends_at_same_steps(
    tmp_path: Path,
) -> None:
    turns = [f"G1 X{50 + 30 * (i % 2)} E2 F3600" for i in range(4)]
    program = ["M302 P1", "G28", "M83", "T0", "G1 X60 Y50 Z5 F6000", *turns, "T1", *turns, "M400"]
    (tmp_path / "a.g").write_text("\n".join(program) + "\n")

    def net(meanwhile: list[str] | None) -> dict[str, int]:
        with Scenario(sharing(), card=str(tmp_path)) as s:
            s.host.ok("M32 a.g")
            if meanwhile is not None:
                assert s.until(
                    lambda: s.printer.rig.job.history.line_at(s.printer.rig.queue.now) >= 7, 300
                )
                assert s.printer.rig.job.tool == 1  # read ahead
                s.host.ok("M25")
                s.passes(20)
                assert s.printer.rig.job.tool == 0
                for line in meanwhile:
                    s.host.ok(line, 100)
                s.host.ok("M24")
            s.host.expect("Done printing", 900)
            return steps(s)

    wanted = net(None)
    assert net([]) == wanted
    assert net(["T1", "G1 X100 F6000", "M400", "T0"]) == wanted
    assert net(["T3"]) == wanted
