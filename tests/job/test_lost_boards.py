"""The link to one of two boards breaks in mid-print, again and again: the print ends where it would
have, on both."""

import random
from array import array
from functools import partial

import pytest
from tests.job.test_lost_link import FIRMWARE
from tests.support.disturbed_prints import steps
from tests.support.disturbed_prints import undisturbed as printed_whole
from tests.support.scenario import Scenario
from tests.support.two_boards import two_boards

from passo import _core
from passo.board.connection import Connection
from passo.board.survive import move_evenly
from passo.config.pin_names import MAIN
from passo.motion.motion_queue import LEAD_S
from passo.printer.recovery.reconnect import _Attempt
from passo.printer.setup.connections import connect_simulated
from passo.simulator import Cable

WORLDS = {
    "fast": (("drift_ppm = 100.0", "start_s = 250.0"), Cable(300e-6, 100e-6)),
    "slow": (("drift_ppm = -100.0", "start_s = 1.0"), Cable(50e-6, 50e-6)),
    "far": (("drift_ppm = 40.0", "start_s = 1e5"), Cable(4e-3, 2e-3)),
    # When the link is opened anew an answer to what was asked before is still on its way.
    "farther": (("drift_ppm = 30.0", "start_s = 250.0"), Cable(8e-3, 1e-4)),
}


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    return printed_whole(tmp_path_factory.mktemp("card"), FIRMWARE)


def scenario(monkeypatch, card, world, **more):
    keys, cable = WORLDS[world]
    monkeypatch.setattr("passo.printer.printer.connect", partial(connect_simulated, cable=cable))
    return Scenario(two_boards(*keys, firmware="passo", **more), card=str(card))


def cut(s, board, seconds):
    s.board.cut_cable(board)
    s.passes(seconds)
    s.board.cut_cable(board, False)


def faults(s):
    return [board.device.fault for board in s.board.boards.values() if board.device.fault]


def test_print_with_lost_boards_ends_at_same_steps(monkeypatch, undisturbed):
    """One example; test_disturbances.py makes many."""
    card, wanted = undisturbed
    generator = random.Random(0)
    with scenario(monkeypatch, card, "far") as s:
        s.host.ok("M32 a.g")
        s.passes(16)  # it is at home by then
        while "Done printing file" not in s.host.heard:
            s.passes(generator.expovariate(0.5))
            if "Done printing file" in s.host.heard:
                break
            cut(s, generator.choice((MAIN, "tool")), generator.choice((0.02, 0.3, 2.0, 40.0)))
            s.passes(1.0)
            assert not s.printer.state.halted
        assert sum("The boards are back" in line for line in s.host.heard) > 2
        assert faults(s) == []
        assert steps(s) == wanted


@pytest.fixture
def gone_back(monkeypatch):
    """The boards that had to go back, as they had heard of one commit more than the other."""
    boards = []

    def spied(connection, steps, seconds, serial):
        boards.append(connection.name)
        move_evenly(connection, steps, seconds, serial)

    monkeypatch.setattr("passo.printer.recovery.reconnect.move_evenly", spied)
    return boards


@pytest.mark.parametrize("board", [MAIN, "tool"])
def test_link_loss_within_the_round_trip_of_a_commit(monkeypatch, tmp_path, gone_back, board):
    """The other board gets the word that makes a commit valid, and this one does not."""
    with scenario(monkeypatch, tmp_path, "far") as s:
        s.host.ok("M302 P1")
        s.host.ok("G92 X0 Y0 Z0 E0")
        s.host.send("G1 X150 Y120 Z12 E90 F600", "G1 X0 E0", "M400", "M118 done")
        s.passes(1.0)
        boards, hz = s.printer.rig.connection, s.printer.rig.queue.hz
        for i in range(30):
            before = len(gone_back)
            s.passes(0.5 + 0.01 * (i % 8))
            boards.run(boards.now + int(0.001 * (i % 10) * hz))
            cut(s, board, 0.4)
            s.host.expect("The boards are back", 12)
            s.passes(LEAD_S)
            assert len(gone_back) - before <= 1
        other = "tool" if board == MAIN else MAIN
        assert set(gone_back) == {other} and len(gone_back) < 25
        s.host.expect("done", 60)
        assert faults(s) == []
        assert steps(s) == {"x": 0, "y": 120 * 80, "z": 12 * 400, "e": 0}


@pytest.mark.parametrize("board", [MAIN, "tool"])
@pytest.mark.parametrize("seconds", [0.2, 0.5, 2.0])
def test_the_first_move_after_homing_comes_late(monkeypatch, tmp_path, board, seconds):
    """Its motors were stopped by switches."""
    with scenario(monkeypatch, tmp_path, "fast") as s:
        s.host.ok("G28", 60)
        s.host.send("G1 X100 Y100 Z5", "M400", "M118 done")
        s.passes(0.03)
        cut(s, board, seconds)
        s.host.expect("The boards are back", 12)
        s.host.expect("done", 30)
        assert faults(s) == []
        assert s.positions() | {"e": 0} == pytest.approx(
            {"x": 100, "y": 100, "z": 5, "e": 0}, abs=0.02
        )


@pytest.mark.parametrize("board", [MAIN, "tool"])
@pytest.mark.parametrize("after", [0.3, 2.2, 5.2, 8.0])
@pytest.mark.parametrize("seconds", [0.5, 10.0])
def test_a_board_is_lost_while_axes_home(monkeypatch, tmp_path, board, after, seconds):
    """Heat stays, no board shuts down, and the next G28 finds the switches."""
    with scenario(monkeypatch, tmp_path, "fast") as s:
        s.host.ok("M109 S60", 300)
        s.host.send("G28")
        s.passes(after)
        cut(s, board, seconds)
        s.passes(12)
        assert faults(s) == [] and s.printer.state.halted == ""
        s.host.send("M118 again", "G28", "M118 done")
        s.host.expect("^done", 60)
        assert not [line for line in s.host.heard[s.host.heard.index("again") :] if "not" in line]
        assert s.positions() | {"e": 0} == pytest.approx(dict.fromkeys("xyze", 0), abs=0.03)
        assert s.board.temperature("hotend") == pytest.approx(60, abs=3)


def test_board_stops_after_last_commit_under_way(monkeypatch, tmp_path):
    """The link's own question for its state, before that commit, may be answered late."""
    with scenario(monkeypatch, tmp_path, "far") as s:
        tool = s.printer.rig.connection.connections[1]
        s.printer.rig.connection.stop_job()
        tool.command("survive_query")
        tool.command(f"survive_commit serial=9 clock={tool.board_clock & 0xFFFFFFFF} rest=1")
        assert s.run(_Attempt(s.printer.supervisor.reconnection)._last_commit(tool)) == 9


@pytest.mark.parametrize("board", [MAIN, "tool"])
@pytest.mark.parametrize(
    ("world", "seconds"), [("fast", 2.0), ("fast", 40.0), ("fast", 300.0), ("farther", 4.5)]
)
def test_boards_keep_time_with_each_other_after_it(monkeypatch, tmp_path, board, world, seconds):
    """X and Z go evenly, so that each step of Z has its place among those of X."""
    with scenario(monkeypatch, tmp_path, world) as s:
        s.host.ok("G92 X0 Y0 Z0")
        s.host.send("G1 X100 Z20 F600", "M400", "M118 done")
        s.passes(2.0)
        cut(s, board, seconds)
        s.host.expect("The boards are back", 12)
        for name in "xz":
            s.board.trace_steps(name, 0, 2**62)
        s.host.expect("done", 20)
        clocks = {name: array("q", s.board.take_steps(name, 0, 2**62)[0]) for name in "xz"}
        x, z = list(clocks["x"]), list(clocks["z"])
        assert len(x) > 4000 and len(z) == len(x)
        skews = [abs(a - b) / 16 for a, b in zip(x[500:-500], z[500:-500], strict=True)]
        assert max(skews) <= 25


@pytest.mark.parametrize("seed", range(2))
def test_noise_on_either_cable(monkeypatch, undisturbed, seed):
    card, wanted = undisturbed
    generator = random.Random(seed)
    with scenario(monkeypatch, card, "fast") as s:
        s.host.ok("M32 a.g")
        s.passes(16)
        bursts = 0
        while "Done printing file" not in s.host.heard:
            s.passes(generator.expovariate(0.5))
            board = generator.choice((MAIN, "tool"))
            s.board.spoil_cable(board, generator.choice((0.002, 0.02, 0.05, 0.2, 0.5)))
            s.passes(5.0)
            s.board.spoil_cable(board, 0.0)
            s.passes(3.0)
            assert not [line for line in s.host.heard if line.startswith("echo:Print of")]
            assert not s.printer.state.halted
            bursts += 1
        assert bursts > 3
        assert faults(s) == []
        assert steps(s) == wanted


def test_high_latency_cable_stops_nothing(monkeypatch, undisturbed):
    """Each commit waits for what is to be acknowledged by both boards."""
    card, wanted = undisturbed
    with scenario(monkeypatch, card, "far") as s:
        s.host.ok("M32 a.g")
        s.host.expect("Done printing", 900)
        assert not [line for line in s.host.heard if "The machine waits" in line]
        assert steps(s) == wanted


def test_link_loss_keeps_heaters_of_both_boards_warm(monkeypatch, tmp_path):
    hot = {'"D10"': '"tool:D10"', '"T0"': '"tool:T0"', '"D9"': '"tool:D9"'}
    with scenario(monkeypatch, tmp_path, "fast", **hot) as s:
        s.host.ok("M140 S60")
        s.host.ok("M109 S200", 400)
        s.host.ok("M190 S60", 400)
        s.passes(30)
        s.host.ok("G92 X0 Y0 Z0 E0")
        s.host.send("G1 X100 E60 F600", "M400", "M118 done")
        s.passes(2.0)
        for board in (MAIN, "tool"):
            cut(s, board, 40.0)
            assert s.board.temperature("hotend") == pytest.approx(200, abs=12)
            assert s.board.temperature("bed") == pytest.approx(60, abs=4)
            s.host.expect("The boards are back", 15)
            s.passes(1.0)
        s.host.expect("done", 60)
        assert faults(s) == []
        assert steps(s) == {"x": 8000, "y": 0, "z": 0, "e": round(60 * 95.5)}


@pytest.mark.parametrize("cut_off", [MAIN, "tool"])
def test_heater_keeps_heating_on_board_with_link(monkeypatch, tmp_path, cut_off):
    """On the lost board it cools until that is back; neither is taken for a failed heater."""
    hot = {'"D10"': '"tool:D10"', '"T0"': '"tool:T0"', '"D9"': '"tool:D9"'}
    with scenario(monkeypatch, tmp_path, "fast", **hot) as s:
        s.host.ok("G92 X0 Y0 Z0")
        s.host.send("M104 S200", "M140 S60", "G1 X200 F600", "G1 X0", "M109 S200", "M118 done")
        s.passes(15)
        before = {name: s.board.temperature(name) for name in ("hotend", "bed")}
        cut(s, cut_off, 30.0)
        for name, board in (("hotend", "tool"), ("bed", MAIN)):
            warmer = s.board.temperature(name) - before[name]
            assert warmer < 0.5 if board == cut_off else warmer > 5
        s.host.expect("The boards are back", 15)
        s.host.expect("done", 600)
        assert faults(s) == []
        assert steps(s) == {"x": 0, "y": 0, "z": 0, "e": 0}


def test_only_lost_board_is_reopened_during_reheat(monkeypatch, tmp_path):
    """Opening a port resets many boards, which lose their place."""
    opened = []
    open_again = Connection.open_again

    async def spied(self):
        opened.append(self.name)
        await open_again(self)

    monkeypatch.setattr(Connection, "open_again", spied)
    with scenario(monkeypatch, tmp_path, "fast") as s:
        s.host.ok("M109 S200", 400)
        s.host.ok("G92 X0 Y0 Z0 E0")
        s.host.send("G1 X100 Z10 F600", "M400", "M118 done")
        s.passes(2.0)
        cut(s, MAIN, 100.0)  # its heat is off by then
        s.host.expect("The boards are back", 15)
        s.passes(2.0)
        opened.clear()
        cut(s, "tool", 6.0)
        s.host.expect("done", 100)
        assert set(opened) == {"tool"}
        assert faults(s) == []
        assert steps(s) == {"x": 8000, "y": 0, "z": 4000, "e": 0}


@pytest.mark.parametrize("board", [MAIN, "tool"])
def test_a_board_that_shuts_down_stops_the_other_at_once(monkeypatch, tmp_path, board):
    with scenario(monkeypatch, tmp_path, "fast") as s:
        s.host.ok("G92 X0 Y0 Z0")
        s.host.send("G1 X100 Z20 F600")
        s.passes(2.0)
        next(c for c in s.printer.rig.connection.connections if c.name == board).command(
            "emergency_stop"
        )
        s.passes(0.05)
        stood = steps(s)
        s.passes(1.0)
        assert steps(s) == stood
        assert "Command request" in s.printer.state.halted


def test_a_board_that_is_lost_while_axes_home_stops_them(monkeypatch, tmp_path):
    """No commits are in use then: the switches' boards and the motors' stop by themselves."""
    with scenario(monkeypatch, tmp_path, "fast") as s:
        s.host.send("G28 Z")
        s.passes(0.5)
        moving = steps(s)
        s.board.cut_cable("tool")
        s.passes(0.2)
        stood = steps(s)
        s.passes(8.0)
        assert steps(s) == stood != moving
        s.host.expect("homing: their positions are lost. Each board keeps warm for a minute", 1)
        assert faults(s) == []


def test_board_without_survive_stops_all_boards(monkeypatch):
    keys, cable = WORLDS["fast"]
    monkeypatch.setattr("passo.printer.printer.connect", partial(connect_simulated, cable=cable))
    machine = two_boards(*keys, firmware="passo")
    tool = machine.boards["tool"].model_copy(update={"firmware": "virtual"})
    with Scenario(machine.model_copy(update={"boards": {"tool": tool}})) as s:
        s.host.ok("G92 X0 Y0 Z0")
        s.host.send("G1 X100 Z20 F600")
        s.passes(2.0)
        s.board.cut_cable("tool")
        s.passes(5.0)
        assert "does not answer" in s.printer.state.halted
        assert "Command request" in faults(s)


def test_a_pause_while_a_board_is_waited_for_keeps_what_is_held(monkeypatch, undisturbed):
    card, wanted = undisturbed
    with scenario(monkeypatch, card, "fast") as s:
        s.host.ok("M32 a.g")
        s.passes(20)
        cut(s, "tool", 0.35)
        for _ in range(40):
            s.host.send("M25", "M24")
            s.passes(0.25)
        s.host.expect("Done printing", 900)
        assert faults(s) == []
        assert steps(s) == wanted


@pytest.mark.parametrize("world", ["fast", "slow"])
@pytest.mark.parametrize("board", [MAIN, "tool"])
def test_both_boards_brake_on_the_path(monkeypatch, tmp_path, world, board):
    with scenario(monkeypatch, tmp_path, world) as s:
        s.host.ok("G92 X0 Y0 Z0")
        s.host.send("G1 X100 Z20 F600")
        s.passes(2.0)
        for name in "xz":
            s.board.trace_steps(name, 0, 2**62)
        cut(s, board, 1.0)
        x, z = (list(array("q", s.board.take_steps(name, 0, 2**62)[0])) for name in "xz")
        assert len(x) == len(z) > 100
        assert x[-1] - x[-2] > 2 * (x[1] - x[0])  # it has braked
        assert max(abs(a - b) / 16 for a, b in zip(x, z, strict=True)) <= 120


@pytest.mark.parametrize("seconds", [0.15, 0.5, 2.0])
def test_commit_waiting_for_other_board_is_not_late(monkeypatch, undisturbed, seconds):
    """None gets a commit before the other has what belongs to it."""
    card, _ = undisturbed
    with scenario(monkeypatch, card, "fast") as s:
        s.host.ok("M32 a.g")
        s.passes(16)
        for i in range(6):
            for board in s.board.boards:
                s.board.cut_cable(board)
            s.passes(seconds)
            for board in s.board.boards:
                s.board.cut_cable(board, False)
            s.passes(2 + i / 10)
        late = [c.link.late_frames for c in s.printer.rig.connection.connections]
        assert all(n[_core.Cause.RETRANSMITS] for n in late)
        assert not any(n[_core.Cause.PLAN] for n in late), late
