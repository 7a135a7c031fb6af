"""Waits and targets in the order of the program, however late the program looks at the clock."""

from __future__ import annotations

from pathlib import Path

import pytest
from tests.support.scenario import Host, Scenario
from tests.support.waits import NEAR_C, WAITS, machine

from passo.job.live import journal_keeper
from passo.job.live.journal import Journal

LATE_S = 0.5  # longer than the 0.2 s from a command on a standing machine to its time


def targets(s: Scenario) -> dict[str, float]:
    return {name: heater.target for name, heater in s.printer.rig.connection.heaters.items()}


def computes_after_commands(s: Scenario, seconds: float = LATE_S) -> None:
    """After each command the program computes for so long before it looks at anything else."""
    s.printer.state.command_listeners.append(lambda *_: s.loop.pass_time(seconds))


@pytest.mark.parametrize("source", ["card", "host"])
@pytest.mark.parametrize("kind", WAITS)
def test_a_wait_ends_warm_after_a_late_target(kind, source, tmp_path):
    waits = WAITS[kind]
    lines = (*waits.lines, "M118 reached")
    (tmp_path / "a.g").write_text("\n".join(lines))
    with Scenario(machine(waits.machine), card=str(tmp_path)) as s:
        computes_after_commands(s)
        s.host.send(*(("M32 a.g",) if source == "card" else lines))
        s.host.expect("^reached$", 600)
        heaters = s.printer.rig.connection.heaters
        assert {n: heaters[n].celsius for n in waits.warm} == pytest.approx(waits.warm, abs=NEAR_C)


def test_a_tune_comes_after_the_target_before_it(tmp_path):
    (tmp_path / "a.g").write_text("M104 S50\nM303 E0 S100 C3\nM118 tuned\n")
    with Scenario(card=str(tmp_path)) as s:
        computes_after_commands(s)
        s.host.send("M32 a.g")
        s.host.expect("PID Autotune finished", 900)
        s.host.expect("^tuned$", 10)
        assert targets(s)["hotend"] == 0


def test_a_filament_change_reheats_after_a_late_target():
    """The target of another console is still queued when the change asks for its own."""
    with Scenario() as s:
        s.host.ok("G92 X30 Y0 Z0 E0")
        s.host.ok("M109 S180", 300)
        s.host.send("M600 S200", "M118 changed")
        s.passes(20)
        computes_after_commands(s)
        s.printer.outputs.targets.set_target("hotend", 150)
        s.host.send("M108")
        s.host.expect("^changed$", 300)
        assert targets(s)["hotend"] == 200
        assert s.printer.rig.connection.heaters["hotend"].celsius == pytest.approx(200, abs=NEAR_C)


@pytest.mark.parametrize("asks", ["M220 S90", "M221 S90", "M290 Z0.1", "M201 X900"])
@pytest.mark.parametrize("way_mm", [5.0, 5.137, 5.274, 5.411])
def test_a_change_of_the_plan_keeps_a_target_at_its_end(asks, way_mm):
    """The end of a plan is no whole tick: the target is due up to half a tick after it."""
    with Scenario() as s:
        s.host.ok("G92 X0 Y0 Z0")
        s.host.ok(f"G1 X{way_mm} Y3 F1800")
        s.host.ok("M104 S200")
        job, queue, other = s.printer.rig.job, s.printer.rig.queue, Host(s)
        assert s.until(lambda: job.plan.queued == 0 and job.clock < queue.now + 0.15 * queue.hz, 10)
        other.ok(asks)
        s.passes(3)
        assert targets(s)["hotend"] == 200


def test_a_target_outlasts_a_lost_link(monkeypatch):
    """The link fails just as the target is due."""
    with Scenario() as s:
        s.host.ok("M104 S200")
        due = (
            s.printer.rig.job.outputs.next_mark
            or s.printer.rig.queue.flush()
            or s.printer.rig.job.outputs.next_mark
        )
        queue = s.printer.rig.queue
        run, fails = queue._run, [True]

        def fail_once(clock):
            if fails and clock == due[0]:
                fails.clear()
                raise ZeroDivisionError("by the test")
            run(clock)

        monkeypatch.setattr(queue, "_run", fail_once)
        with pytest.raises(ZeroDivisionError):
            queue._pass(due[0])
        assert targets(s)["hotend"] == 0
        queue._pass(due[0] + 1)
        assert targets(s)["hotend"] == 200


@pytest.mark.parametrize("how", ["M140 S20000", "M524", "the endstop"])
def test_heater_off_overrides_a_queued_target(how, tmp_path):
    (tmp_path / "a.g").write_text("G92 X0 Y0 Z0\nG1 X50 F6000\nM140 S60\nG1 X60\nG1 X999\n")
    with Scenario(card=str(tmp_path)) as s:
        if how == "M140 S20000":
            s.host.ok("G92 X0 Y0 Z0")
            s.host.send("G1 X50 F6000", "M140 S60", "M140 S20000")
        else:
            s.host.send("M32 a.g")
            job, queue = s.printer.rig.job, s.printer.rig.queue

            def near():
                return (
                    job.outputs.next_mark and job.outputs.next_mark[0] < queue.now + 0.1 * queue.hz
                )

            assert s.until(near, 5)
            if how == "M524":
                s.host.ok("M524")
            else:
                s.printer.stops.stop_by_endstop(["x_min"])
        s.passes(10)
        assert targets(s)["bed"] == 0


def test_the_journal_pairs_lines_with_their_targets(tmp_path, monkeypatch):
    """Each record is made while the clock runs on past the next target, as on a busy computer."""
    (tmp_path / "card").mkdir()
    lines = ["M140 S40"]
    for i in range(60):
        lines += [f"G1 X{20 + i % 2 * 5} F3000", f"M140 S{41 + i * 0.1:.1f}"]
    Path(tmp_path, "card", "a.g").write_text("\n".join(lines))
    with Scenario(card=str(tmp_path / "card"), state=str(tmp_path / "state")) as s:
        s.host.ok("G92 X20 Y0 Z0")
        monkeypatch.setattr(journal_keeper, "EVERY_S", 0.0)
        s.printer.lifetime._watchers.insert(0, lambda: s.loop.pass_time(0.07))
        records = []
        s.host.send("M32 a.g")
        monkeypatch.setattr(
            Journal, "record", lambda _, moment: records.append((moment.line, moment.targets_c))
        )
        s.host.expect("Done printing", 60)
    moved = [(line, t["bed"]) for line, t in records if 2 < line < 120]
    assert len(moved) > 20
    for line, celsius in moved:
        # Line 2 moves at 40 °C, line 4 at 41 °C, line 6 at 41.1 °C; after line 120 one more is set.
        assert celsius == pytest.approx(41 + (line - 4) / 20, abs=0.01), line
