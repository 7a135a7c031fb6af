"""Whatever disturbs a print, in whatever order: pauses, changes, babysteps, and cables that break,
with one board or two. At its end no step is lost and no line is left out or printed twice."""

from __future__ import annotations

from functools import partial
from itertools import product
from pathlib import Path

import pytest
from hypothesis import Phase, settings
from hypothesis import strategies as st
from hypothesis.stateful import (
    RuleBasedStateMachine,
    initialize,
    precondition,
    rule,
    run_state_machine_as_test,
)
from tests.job.test_filtered_prints import SURVIVES
from tests.job.test_lost_boards import WORLDS
from tests.job.test_lost_link import FIRMWARE
from tests.support.disturbed_prints import steps
from tests.support.scenario import Host, Scenario
from tests.support.two_boards import two_boards

from passo.config.machine import MachineConfig
from passo.job.live.job_state import JobState
from passo.printer.recovery.link_state import LinkState
from passo.printer.setup.connections import connect_simulated

TURNS = 240
PRINTED = ("M104 S60", "M302 P1", "G92 X0 Y0 Z0 E0", "M83", "G1 X50 Y50 Z15 F6000", "G91")
DONE = "Done printing file"
FIRMWARES = {"firmware": FIRMWARE, "filtered": SURVIVES}
HOT_S = 70.0  # a board without its host switches its heaters off meanwhile
SECONDS = st.sampled_from((0.0, 0.02, 0.1, 0.4, 1.5, 1.5, 4.0))
STATES = (JobState.PRINTING, JobState.PAUSED, JobState.RETURNING)


def program() -> str:
    """Relative moves, so that each that is left out or made twice shows at the end: short and long
    ones, arcs, reversals, retractions, and rests of single motors."""
    lines = list(PRINTED)
    for i in range(TURNS):
        x, y = (1, -1)[i % 2] * (0.4 + i % 7), (1, 1, -1, -1)[i % 4] * 0.3 * (i % 5)
        lines.append(f"G1 X{x:.2f} Y{y:.2f} E0.05 F{(1200, 3000, 6000, 9000)[i % 4]}")
        if i % 15 == 7:
            lines += ["G2 X0 Y0 I-6 J0.1 E0.4", "G1 Z0.2 F600", "G1 X12 F3000", "G1 X-11.5 F9000"]
        if i % 20 == 19:
            lines += ["G1 E-1 F1800", "G1 Z0.4", "G1 Z-0.4", "G1 E1 F1800"]
    return "\n".join([*lines, "G1 X-3 Y2 E0.2 F1200"]) + "\n"


class Disturbances(RuleBasedStateMachine):
    """One print. `away`: the board whose cable is out."""

    card: Path
    wanted: dict[str, int]
    met: set[tuple[JobState, LinkState]]

    @initialize(
        place=st.sampled_from(("i3", *FIRMWARES, "fast", "slow", "far")),
        ending=st.sampled_from(("end",) * 6 + ("cancel", "halt")),
    )
    def begins(self, place: str, ending: str) -> None:
        self.away: str | None = None
        self.shifted = {"x": 0.0, "z": 0.0}
        self.place, self.ending = place, ending
        with pytest.MonkeyPatch.context() as patch:
            machine: MachineConfig | str = FIRMWARES.get(place, "i3")
            if place in WORLDS:
                keys, cable = WORLDS[place]
                machine = two_boards(*keys, firmware="passo")
                connect = partial(connect_simulated, cable=cable)
                patch.setattr("passo.printer.printer.connect", connect)
            self.s = Scenario(machine, card=str(self.card))
        self.other = Host(self.s)
        self.s.host.ok("M32 a.g")
        self.s.passes(2)

    @property
    def job(self) -> JobState:
        return self.s.assembly.services.jobs.runner.state

    def step(self, seconds: float, *lines: str) -> None:
        """Sends these lines. While a board is lost, commands that wait for it keep waiting."""
        self.s.host.send(*lines)
        if self.away is None and lines:
            self.is_answered()
        self.s.passes(seconds)
        self.met.add((self.job, self.s.printer.supervisor.link))
        assert self.s.printer.state.halted == ""
        assert not any(board.device.fault for board in self.s.board.boards.values())
        if self.job.active:
            assert self.s.printer.rig.connection.heaters["hotend"].target == 60

    def is_answered(self) -> None:
        """All that was sent has been carried out."""
        self.s.host.send("M118 answered")
        self.s.host.expect("^answered", 120)

    @precondition(lambda self: self.job.prints)
    @rule(seconds=SECONDS)
    def pauses(self, seconds: float) -> None:
        self.step(seconds, "M25")

    @precondition(lambda self: self.job is JobState.PAUSED)
    @rule(seconds=SECONDS)
    def resumes(self, seconds: float) -> None:
        self.step(seconds, "M24")

    @precondition(lambda self: self.job is JobState.PRINTING)
    @rule(seconds=SECONDS)
    def pauses_and_resumes_at_once(self, seconds: float) -> None:
        self.step(seconds, "M25", "M24")

    @precondition(lambda self: self.job.active)
    @rule(
        seconds=SECONDS,
        line=st.sampled_from(("M220 S50", "M220 S300", "M204 P500", "M204 P3000", "M106 S128")),
    )
    def is_changed(self, seconds: float, line: str) -> None:
        self.step(seconds, line, "M114 R")

    @precondition(lambda self: self.job.active)
    @rule(seconds=SECONDS, axis=st.sampled_from("xzz"), twentieths=st.integers(-20, 20))
    def is_shifted(self, seconds: float, axis: str, twentieths: int) -> None:
        assert self.other.ok(f"M290 {axis}{twentieths / 20}", 120) == ["ok"]
        self.shifted[axis] += twentieths / 20
        self.step(seconds)

    @precondition(lambda self: self.place != "i3" and self.away is None and self.job.active)
    @rule(seconds=SECONDS, second=st.booleans())
    def cable_comes_out(self, seconds: float, second: bool) -> None:
        boards = list(self.s.board.boards)
        self.away = boards[second and len(boards) - 1]
        if self.place in FIRMWARES:
            self.s.printer.rig.connection.main.port.unplug()
        else:
            self.s.board.cut_cable(self.away)
        self.step(seconds)

    @precondition(lambda self: self.away is not None)
    @rule(seconds=SECONDS, hot=st.sampled_from((0.0, 0.0, 0.0, HOT_S)))
    def cable_is_back(self, seconds: float, hot: float) -> None:
        self.s.passes(hot)
        self.plug()
        self.step(seconds)

    def plug(self) -> None:
        if self.away is None:
            return
        if self.place in FIRMWARES:
            queue, port = self.s.printer.rig.queue, self.s.printer.rig.connection.main.port
            port.plug(queue.base + queue.now)
            self.s.board.device.poll(queue.base + queue.now)
        else:
            self.s.board.cut_cable(self.away, False)
        self.away = None

    @precondition(lambda self: self.place in FIRMWARES and self.away is None and self.job.active)
    @rule(seconds=SECONDS, stalled=st.sampled_from((0.05, 0.25, 0.6, 3.0)))
    def host_stands_still(self, seconds: float, stalled: float) -> None:
        connection = self.s.printer.rig.connection
        connection.main.wire.sleep(connection.now + int(stalled * self.s.printer.rig.queue.hz))
        self.s.passes(stalled)
        self.step(seconds)

    def teardown(self) -> None:
        if hasattr(self, "s"):
            with self.s:
                getattr(self, self.ending)()

    def end(self) -> None:
        """No step is lost."""
        self.plug()
        self.step(0.0, "M220 S100")
        if self.job is JobState.PAUSED:
            self.step(0.0, "M24")
        assert self.s.until(lambda: DONE in self.s.host.heard, 900), self.s.host.heard
        self.step(0.0, "M400")
        per_mm = {
            row["name"]: row["steps_per_unit"] for row in self.s.printer.rig.job.motors.statistics()
        }
        for name, net in steps(self.s).items():
            shifted = round(self.shifted.get(name, 0.0) * per_mm[name])
            assert net == self.wanted[name] + shifted, name

    def cancel(self) -> None:
        """Nothing moves or heats afterwards."""
        if not self.job.active:
            return
        self.s.host.send("M524")
        self.plug()
        self.s.passes(20)
        assert self.job is JobState.READY
        self.is_cold_and_stands()

    def halt(self) -> None:
        """Nor does it after this; and then it homes again."""
        self.s.host.send("M112")
        self.s.passes(1)
        assert "M112" in self.s.printer.state.halted
        self.plug()
        self.s.passes(20)
        self.is_cold_and_stands()
        self.s.host.send("M999")
        self.s.host.expect("ready again", 20)
        assert self.s.host.ok("G28", 60)[-1] == "ok"

    def is_cold_and_stands(self) -> None:
        stood = steps(self.s)
        assert self.s.printer.rig.connection.heaters["hotend"].target == 0
        assert self.s.board.output_value("hotend") == 0
        self.s.passes(3)
        assert steps(self.s) == stood


def test_disturbed_prints_end_as_undisturbed(tmp_path: Path) -> None:
    """60 prints: what one disturbance leaves behind shows when the next one meets it. Each active
    state of a job meets each state of a link that a print survives."""
    Disturbances.card, Disturbances.met = tmp_path, set()
    (tmp_path / "a.g").write_text(program())
    with Scenario(FIRMWARE, card=str(tmp_path)) as s:
        s.host.ok("M32 a.g")
        assert s.until(lambda: DONE in s.host.heard, 300)
        Disturbances.wanted = steps(s)
    how = settings(max_examples=60, stateful_step_count=24, phases=[Phase.generate])
    run_state_machine_as_test(Disturbances, settings=how)
    links = (LinkState.CONNECTED, LinkState.RECONNECTING)
    assert Disturbances.met >= set(product(STATES, links))
