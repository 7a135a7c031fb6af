"""After everything has stopped a print goes on: never later than it was, hardly earlier."""

import errno
import os
import random
import stat
from dataclasses import replace

import pytest
from tests.support.scenario import Scenario

from passo.job.live.journal import Journal, Moment, Program
from passo.printer.status import InterruptedPrint

WALL = "M302 P1\nM106 S128\nG28\nG92 E0\n" + "".join(
    f"G1 Z{0.2 * (layer + 1):.1f} F600\n"
    + "".join(
        f"G1 X{10 + 40 * (i % 2)} Y{10 + 40 * (i // 2 % 2)} E{layer * 2 + i / 10:.2f} F6000\n"
        for i in range(1, 21)
    )
    for layer in range(8)
)


@pytest.fixture
def places(tmp_path):
    card, state = tmp_path / "card", tmp_path / "state"
    card.mkdir()
    (card / "wall.gcode").write_text(WALL)
    return {"card": str(card), "state": str(state)}, state


def journal_of(state):
    return Journal(state).read()


def test_journal_is_at_most_a_second_late_and_never_early(places):
    arguments, state = places
    generator = random.Random(7)
    starts = []
    with Scenario("i3", **arguments) as s:
        s.printer.rig.job.results.keep_moves(True)
        s.host.ok("M32 wall.gcode")
        looked = 0
        while looked < 200:
            s.passes(generator.uniform(0.02, 0.5))
            starts += [
                (m.core.start_ticks if hasattr(m, "core") else m.start_ticks, m.line)
                for m in s.printer.rig.job.results.take_moves()
            ]
            now = s.printer.rig.queue.now
            under_way = [(at, line) for at, line in starts if at <= now and line]
            found = journal_of(state)
            if found is None:
                assert "Done printing file" in s.host.heard
                break
            looked += 1
            moment = found[1]
            if not under_way:
                assert moment.line <= 3
                continue
            assert moment.line <= max(line for _, line in under_way)
            second_ago = now - 1.05 * s.printer.rig.queue.hz
            before = [line for at, line in under_way if at <= second_ago]
            assert moment.line >= (before[-1] if before and before[-1] > 1 else 0)
        assert looked > 100


@pytest.mark.parametrize("machine", ["i3", "corexy", "delta"])
def test_a_print_resumes_after_a_power_cut(machine, places):
    arguments, state = places
    with Scenario(machine, **arguments) as s:
        s.host.ok("M32 wall.gcode")
        s.host.expect("Done printing", 300)
        whole = s.positions()
    assert journal_of(state) is None
    with Scenario(machine, **arguments) as s:
        s.host.ok("M140 S50")
        s.host.ok("M32 wall.gcode")
        assert s.until(lambda: s.positions()["e"] > 6.5, 200)
        left = s.positions()
    program, moment = journal_of(state)
    assert program.path == "/wall.gcode"
    assert moment.targets_c["bed"] == 50
    assert WALL.split("\n")[moment.line - 1].startswith("G1")
    with Scenario(machine, **arguments) as s:
        for stepper, at in left.items():
            if stepper != "e":
                s.board.place(stepper, at)
        assert f"interrupted at line {moment.line}" in s.printer.state.greeting()
        s.host.ok("M302 P1")
        answer = [x for x in s.host.ok("M1000", 600) if "busy" not in x]
        assert f"echo:Printing wall.gcode from line {moment.line}" in answer
        assert s.board.temperature("bed") > 47
        s.host.expect("Done printing", 300)
        end = s.positions()
        for stepper in whole:
            if stepper != "e":
                assert end[stepper] == pytest.approx(whole[stepper], abs=0.03)
        # The filament of the lines that were printed again or for the first time, and the priming.
        before = [x for x in WALL.split("\n")[: moment.line - 1] if " E" in x][-1]
        rest = 16.0 - float(before.split("E")[1].split()[0])
        assert end["e"] == pytest.approx(5.0 + rest, abs=0.03)
        assert s.board.output_value("part") > 0
    assert journal_of(state) is None


def test_a_recovery_that_is_stopped_leaves_the_heaters_off(places):
    arguments, _ = places
    with Scenario("i3", **arguments) as s:
        s.host.ok("M140 S90")
        s.host.ok("M32 wall.gcode")
        s.passes(20)
    with Scenario("i3", **arguments) as s:
        s.host.send("M1000")
        assert s.until(lambda: s.printer.waits.heating, 60)
        s.passes(1)
        s.host.send("M108")
        s.host.expect("it was stopped", 2)
        assert s.printer.rig.connection.heaters["bed"].target == 0
        assert "Not SD printing" in s.host.ok("M27")[0]


def test_card_pulled_during_recovery_leaves_heaters_off(places, monkeypatch):
    arguments, _ = places
    with Scenario("i3", **arguments) as s:
        s.host.ok("M104 S60")
        s.host.ok("M32 wall.gcode")
        s.passes(20)
        left = s.positions()

    def pulled(*_):
        raise OSError(errno.EIO, os.strerror(errno.EIO))

    with Scenario("i3", **arguments) as s:
        for stepper in "xyz":
            s.board.place(stepper, left[stepper])
        s.host.ok("M302 P1")
        s.host.send("M1000")
        hotend = s.printer.rig.connection.heaters["hotend"]
        assert s.until(lambda: hotend.target > 0, 100)
        with monkeypatch.context() as now:
            now.setattr(os, "preadv", pulled)
            s.host.expect("removed while in use", 200)
        s.passes(1)
        assert hotend.target == 0
        s.host.send("M1000")
        s.host.expect("Done printing", 300)
        assert s.positions()["z"] == pytest.approx(1.6, abs=0.03)


@pytest.mark.parametrize("start", [("M26 S{}", "M24"), ("M24 S{}",)])
def test_a_print_started_at_a_line_resumes_where_it_was(start, places):
    arguments, state = places
    layer = WALL.index("G1 Z0.8")
    with Scenario("i3", **arguments) as s:
        for line in ("M302 P1", "G28", "G92 E6", "M23 wall.gcode", *start):
            s.host.ok(line.format(layer), 60)
        assert s.until(lambda: s.positions()["e"] > 1.5, 200)  # of 2 mm a layer
        left = s.positions()
    line = journal_of(state)[1].line
    assert 18 > line - WALL[:layer].count("\n") > 10
    with Scenario("i3", **arguments) as s:
        for stepper in "xyz":
            s.board.place(stepper, left[stepper])
        s.host.ok("M1000", 600)
        assert s.positions()["z"] == pytest.approx(0.8, abs=0.01)
        s.host.expect("Done printing", 300)
        assert s.positions()["z"] == pytest.approx(1.6, abs=0.01)


def test_another_file_is_not_resumed(places, tmp_path):
    arguments, state = places
    with Scenario("i3", **arguments) as s:
        s.host.ok("M32 wall.gcode")
        s.passes(15)
    (tmp_path / "card" / "wall.gcode").write_text(WALL.replace("X10", "X11"))
    with Scenario("i3", **arguments) as s:
        assert "is not the file that was printed" in s.host.ok("M1000")[0]
        s.host.ok("M1000 C")
        assert s.printer.state.greeting() == ""
        assert "no print was interrupted" in s.host.ok("M1000")[0]
    assert journal_of(state) is None


def test_print_cut_off_before_first_move_restarts(places, tmp_path):
    arguments, _ = places
    for text, answer in ((WALL, "Printing wall.gcode from its beginning"), (WALL + "M105\n", "")):
        with Scenario("i3", **arguments) as s:
            s.host.ok("M32 wall.gcode")
        (tmp_path / "card" / "wall.gcode").write_text(text)
        with Scenario("i3", **arguments) as s:
            offer = s.printer.state.greeting()
            assert "was interrupted at its beginning. M1000 resumes it from there" in offer
            assert (answer or "is not the file that was printed") in s.host.ok("M1000")[0]
            if answer:
                s.host.expect("Done printing file", 200)
                assert s.positions()["z"] == pytest.approx(1.6, abs=0.01)


HEATS = "M83\nM109 S200\n" + "".join(f"G1 X{i} E1 F600\n" for i in range(9, 90))


def test_print_that_heats_first_has_its_own_journal(places, tmp_path):
    arguments, state = places
    (tmp_path / "card" / "heats.g").write_text(HEATS)
    with Scenario("i3", **arguments) as s:
        s.host.ok("M32 wall.gcode")
        s.host.expect("Done printing file", 200)
        s.host.ok("M32 heats.g")
        for _ in range(20):
            s.passes(1)
            program, moment = journal_of(state)
            assert (program.path, moment.line) == ("/heats.g", 0)


def test_a_print_does_not_restart_after_a_line_that_failed(places, tmp_path):
    arguments, state = places
    (tmp_path / "card" / "fails.g").write_text("G28\nG1 X20 F6000\nG1 X9999\n" + HEATS)
    with Scenario("i3", **arguments) as s:
        s.host.ok("M32 fails.g")
        s.host.expect("Print of fails.g stopped: fails.g:3", 60)
        s.passes(5)
        s.host.ok("M24")
        assert journal_of(state)[1].line == 2


def test_a_torn_record_is_left_out(tmp_path):
    journal = Journal(tmp_path)
    journal.begin(Program("m", "/a", 5, 7), Moment(0, 0.0))
    journal.record(Moment(4, 1.5, 0.2, {"bed": 60.0}))
    size = journal.path.stat().st_size
    journal.record(Moment(9, 2.5))
    journal.leave()
    raw = journal.path.read_bytes()
    for cut in range(size, len(raw) - 1):
        journal.path.write_bytes(raw[:cut])
        assert Journal(tmp_path).read() == (
            Program("m", "/a", 5, 7),
            Moment(4, 1.5, 0.2, {"bed": 60.0}),
        )
    journal.path.write_bytes(raw)
    assert Journal(tmp_path).read()[1] == Moment(9, 2.5)
    journal.path.write_bytes(b"rubbish")
    assert Journal(tmp_path).read() is None


def test_a_cancelled_print_cannot_be_resumed(places):
    arguments, state = places
    with Scenario("i3", **arguments) as s:
        s.host.ok("M32 wall.gcode")
        s.passes(15)
        s.host.ok("M524")
        assert journal_of(state) is None


def test_a_halted_print_can_be_resumed_in_the_same_session(places):
    arguments, _ = places
    with Scenario("i3", **arguments) as s:
        s.host.ok("M32 wall.gcode")
        assert s.until(lambda: s.positions()["e"] > 4, 200)
        assert s.printer.status.read().interrupted is None
        s.host.send("M112")
        s.host.expect("halted", 5)
        s.host.send("M999")
        s.host.expect("ready again", 5)
        found = s.printer.status.read().interrupted
        assert found == InterruptedPrint("/wall.gcode", found.line, "")
        assert found.line > 20
        s.host.ok("M302 P1")
        assert f"from line {found.line}" in s.host.ok("M1000", 600)[-2]
        assert s.printer.status.read().interrupted is None
        s.host.expect("Done printing", 300)
        assert s.positions()["z"] == pytest.approx(1.6, abs=0.01)


def test_an_interrupted_print_comes_before_the_card_s_own(places, tmp_path):
    arguments, state = places
    (tmp_path / "card" / "auto0.g").write_text("M118 AUTO\nG4 S100\n")
    with Scenario("i3", **arguments) as s:
        assert "SD printing byte" in s.host.ok("M27")[0]  # nothing was interrupted
        s.host.ok("M524")
        s.passes(1)
        s.host.ok("M32 wall.gcode")
        s.passes(15)
    left = journal_of(state)
    with Scenario("i3", **arguments) as s:
        assert s.host.ok("M27")[0] == "Not SD printing"
        offer = s.printer.state.greeting()
        assert offer.startswith(
            f"echo:The print of /wall.gcode was interrupted at line {left[1].line}"
        )
        assert offer.endswith("M1000 C forgets it. auto0.g was not started")
        assert journal_of(state) == left
        s.host.ok("M302 P1")
        assert "from line" in s.host.ok("M1000", 600)[-2]
    with Scenario("i3", **arguments) as s:
        s.host.ok("M1000 C")
    with Scenario("i3", **arguments) as s:
        assert "SD printing byte" in s.host.ok("M27")[0]


@pytest.mark.parametrize("failing", range(3))
def test_a_journal_that_cannot_begin_leaves_no_older_print(tmp_path, monkeypatch, failing):
    """The file's, then the directory's durability; what ends the old one needs a third."""
    journal = Journal(tmp_path)
    journal.begin(Program("m", "/a", 5, 7), Moment(4, 1.5))
    calls = 0
    real = os.fsync

    def full(descriptor):
        nonlocal calls
        calls += 1
        if calls == failing + 1:
            raise OSError(errno.ENOSPC, "No space left on device")
        real(descriptor)

    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", full)
        if failing < 2:
            with pytest.raises(OSError, match="No space"):
                journal.begin(Program("m", "/b", 6, 8), Moment(0, 0.0))
            assert not journal.open
            assert list(tmp_path.iterdir()) == []
            assert journal.read() is None
        else:
            journal.begin(Program("m", "/b", 6, 8), Moment(0, 0.0))
            with pytest.raises(OSError, match="No space"):
                journal.record(Moment(9, 2.5))
            journal.end()
            assert list(tmp_path.iterdir()) == []
    journal.begin(Program("m", "/c", 6, 8), Moment(0, 0.0))
    journal.record(Moment(9, 2.5))
    assert journal.read() == (Program("m", "/c", 6, 8), Moment(9, 2.5))
    journal.end()
    assert list(tmp_path.iterdir()) == []


def test_print_without_room_removes_older_journal(places, monkeypatch):
    arguments, state = places
    with Scenario("i3", **arguments) as s:
        s.host.ok("M32 wall.gcode")
        s.passes(15)
    assert journal_of(state) is not None

    def full(_):
        raise OSError(errno.ENOSPC, "No space left on device")

    with Scenario("i3", **arguments) as s:
        with monkeypatch.context() as patch:
            patch.setattr(os, "fsync", full)
            answer = s.host.ok("M32 wall.gcode")
        assert "echo:No journal of this print: No space left on device" in answer
        s.passes(10)
        assert "SD printing byte" in s.host.ok("M27")[0]
    assert journal_of(state) is None


def test_print_with_renamed_heater_is_not_resumed(places):
    arguments, state = places
    with Scenario("i3", **arguments) as s:
        s.host.ok("M140 S50")
        s.host.ok("M32 wall.gcode")
        assert s.until(lambda: s.positions()["e"] > 1, 200)
    program, moment = journal_of(state)
    journal = Journal(state)
    renamed = replace(
        moment, targets_c={"plate": 50.0, "old": 0.0}, overrides={"fan cooler": (0, 0.5)}
    )
    journal.begin(program, renamed)
    journal.leave()
    with Scenario("i3", **arguments) as s:
        assert s.host.ok("M1000")[:1] == [
            "echo:/wall.gcode: needs fan cooler, heater plate, which is missing from the machine"
            " file. Restore that section and restart Passo, or forget the print (M1000 C)."
        ]
        assert s.host.ok("M27")[0] == "Not SD printing"
        assert s.printer.rig.connection.heaters["bed"].target == 0
        assert journal_of(state) == (program, renamed)
    journal.begin(program, replace(moment, targets_c={"bed": 45.0, "old": 0.0}, overrides={}))
    journal.leave()
    with Scenario("i3", **arguments) as s:
        s.host.ok("M302 P1")
        assert "from line" in s.host.ok("M1000", 600)[-2]
        assert s.printer.rig.connection.heaters["bed"].target == 45


def test_the_end_of_a_journal_is_durable(tmp_path, monkeypatch):
    """As its beginning: a name that has gone must not come back with a power cut."""
    synced = []
    real = os.fsync

    def noted(descriptor):
        kind = "directory" if stat.S_ISDIR(os.fstat(descriptor).st_mode) else "file"
        synced.append((kind, sorted(path.name for path in tmp_path.iterdir())))
        real(descriptor)

    monkeypatch.setattr(os, "fsync", noted)
    journal = Journal(tmp_path)
    journal.begin(Program("m", "/a", 5, 7), Moment(0, 0.0))
    assert [kind for kind, _ in synced] == ["file", "directory"]
    assert synced[1] == ("directory", ["journal"])
    journal.record(Moment(4, 1.5))
    assert synced[2:] == [("file", ["journal"])]
    journal.end()
    assert synced[3:] == [("directory", [])]
    journal.end()
    assert len(synced) == 4


def test_journal_resumes_after_shutdown_without_survive(places):
    """The cable is cut in mid-print. The board stops when its outputs are not renewed; the host
    halts, and offers to go on from the journal."""
    arguments, state = places
    with Scenario("i3", **arguments) as s:
        s.host.ok("M32 wall.gcode")
        s.host.expect("Done printing", 300)
        whole = s.positions()
    with Scenario("i3", **arguments) as s:
        assert not s.printer.rig.connection.main.survives
        s.host.ok("M104 S60")
        s.host.ok("M32 wall.gcode")
        assert s.until(lambda: s.positions()["e"] > 6.5, 200)
        port, queue = s.printer.rig.connection.main.port, s.printer.rig.queue
        port.unplug()
        s.host.expect("connection to the board has ended", 5)
        assert "connection to the board has ended" in s.printer.state.halted
        cut = queue.base + queue.now
        s.board.device.poll(cut + 4 * s.board.board.clock_hz)
        assert s.board.device.fault == "Missed scheduling of next digital out event"
        assert s.board.output_value("hotend") == 0
        port.plug(cut + 4 * s.board.board.clock_hz)
        assert journal_of(state) is not None
        s.host.send("M999")
        s.host.expect("ready again", 10)
        line = journal_of(state)[1].line
        s.host.expect(f"wall.gcode was interrupted at line {line}. M1000 resumes it, M1000 C", 1)
        s.host.ok("M302 P1")
        before = s.positions()["e"]
        assert f"from line {line}" in s.host.ok("M1000", 600)[-2]
        s.host.expect("Done printing", 300)
        assert s.printer.state.halted == s.board.device.fault == ""
        end = s.positions()
    for axis in "xyz":
        assert end[axis] == pytest.approx(whole[axis], abs=0.03)
    done = [x for x in WALL.split("\n")[: line - 1] if " E" in x][-1]
    rest = 16.0 - float(done.split("E")[1].split()[0])
    assert end["e"] - before == pytest.approx(5.0 + rest, abs=0.03)  # with the priming
    assert journal_of(state) is None
