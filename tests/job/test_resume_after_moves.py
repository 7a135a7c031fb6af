"""M1000 of a machine that has moved since the power went: homed by hand, or tried before."""

import errno
import os
import shutil

import pytest
from tests.job.test_journal import WALL
from tests.support.scenario import Host, Scenario

from passo import config
from passo.errors import CardError
from passo.job.live import file_lines
from passo.job.live.journal import Journal

HEIGHT_MM = 1.6


@pytest.fixture(scope="module")
def power_cut(tmp_path_factory):
    """What a power cut in the fifth layer leaves: the files, and where the motors are."""
    folder = tmp_path_factory.mktemp("cut")
    (folder / "card").mkdir()
    (folder / "card" / "wall.gcode").write_text(WALL)
    return folder, cut({"card": str(folder / "card"), "state": str(folder / "state")})


@pytest.fixture
def places(power_cut, tmp_path):
    shutil.copytree(power_cut[0], tmp_path, dirs_exist_ok=True)
    return {"card": str(tmp_path / "card"), "state": str(tmp_path / "state")}


@pytest.fixture
def left(power_cut):
    return power_cut[1]


def cut(places, machine="i3"):
    """Where the motors are when the power goes."""
    with Scenario(machine, **places) as s:
        s.host.ok("M32 wall.gcode")
        assert s.until(lambda: s.positions()["e"] > 6.5, 200)
        return s.positions()


def again(places, left, machine="i3"):
    s = Scenario(machine, **places)
    for stepper in "xyz":
        s.board.place(stepper, left[stepper])
    s.host.ok("M302 P1")
    return s


def ends_at_its_height(s):
    s.host.send("M1000")
    s.host.expect("echo:Printing wall", 600)
    s.host.expect("Done printing", 300)
    assert s.positions()["z"] == pytest.approx(HEIGHT_MM, abs=0.03)


def tried(s, seconds, end="M410"):
    """A first M1000 that is ended after so long; tells its last words."""
    s.host.send("M1000")
    s.passes(seconds)
    Host(s).send(end)
    s.host.expect("stopped|halted", 30)
    s.passes(5)


def test_a_machine_that_was_homed_is_where_it_has_homed(places, left):
    with again(places, left) as s:
        s.host.ok("G28", 100)
        ends_at_its_height(s)


@pytest.mark.parametrize("tries", [1, 2])
def test_resume_after_homing_without_offset_of_print(places, tmp_path, tries):
    """M206 of the print, which it is begun with or has in its file, counts as it did."""
    text = WALL.replace("G28\n", "G28\nM206 Z0.2\nG28\nM206 Z0.9\n")
    (tmp_path / "card" / "wall.gcode").write_text(text)
    left = cut(places)
    assert left["z"] == pytest.approx(0.6, abs=0.25)
    with again(places, left) as s:
        s.host.ok("G28", 100)
        if tries > 1:
            tried(s, 3.0)
        s.host.send("M1000")
        s.host.expect("echo:Printing wall", 600)
        s.host.expect("Done printing", 300)
        assert s.positions()["z"] == pytest.approx(HEIGHT_MM - 0.2, abs=0.01)


@pytest.mark.parametrize("seconds", [1.0, 6.0])
def test_file_cannot_be_changed_during_m1000(places, left, tmp_path, seconds):
    (tmp_path / "card" / "b.g").write_text("G4 P100\n")
    with again(places, left) as s:
        s.host.send("M1000")
        s.passes(seconds)
        for line in ("M24", "M23 b.g", "M32 b.g", "M26 S0", "M21", "M22", "M30 wall.gcode"):
            told = Host(s).ok(line)
            assert ("SD card ok" if line == "M21" else "wall.gcode") in told[0]
        s.host.expect("echo:Printing wall.gcode from line 7[0-9]$", 600)
        s.host.expect("Done printing", 300)
        assert s.positions()["z"] == pytest.approx(HEIGHT_MM, abs=0.03)
        assert s.positions()["e"] == pytest.approx(14.7, abs=0.1)


def test_m524_ends_the_resume(places, left):
    with again(places, left) as s:
        s.host.ok("M140 S60")
        tried(s, 3.0, "M524")
        assert s.printer.rig.queue.standing
        assert s.printer.rig.connection.heaters["bed"].target == 0
        ends_at_its_height(s)


def test_a_pause_of_a_failed_resume_does_not_pause_the_next(places, left, tmp_path, monkeypatch):
    (tmp_path / "card" / "b.g").write_text("G28 X\nG1 X9\n")

    def pulled(reader, offset):
        raise CardError.of("card.removed", "/wall.gcode", value="Input/output error")

    with again(places, left) as s:
        s.host.send("M1000")
        s.passes(1)
        assert "will pause once it reaches the resume point" in Host(s).ok("M25")[0]
        with monkeypatch.context() as patch:
            patch.setattr(file_lines, "line_of_offset", lambda r, at: pulled(r, at) if at else 1)
            s.host.expect("wall.gcode: was removed while in use", 60)
        s.host.ok("M32 b.g")
        s.host.expect("Done printing", 30)
        assert s.positions()["x"] == 9.0


def test_motors_off_since_homing_give_no_position(places, left):
    with again(places, left) as s:
        s.host.ok("G28", 100)
        s.host.ok("M84")
        ends_at_its_height(s)


@pytest.mark.parametrize("seconds", [0.3, 1.5, 6.0])
@pytest.mark.parametrize("end", ["M410", "M112"])
def test_stopped_resume_leaves_the_nozzle_lifted(places, left, seconds, end):
    with again(places, left) as s:
        tried(s, seconds, end)
        if end == "M112":
            s.host.send("M999")
            s.host.expect("ready again", 10)
            s.host.ok("M302 P1")
        ends_at_its_height(s)


@pytest.mark.parametrize("seconds", [0.3, 0.7, 1.5, 6.0, 9.0])
def test_resume_cut_off_twice_ends_at_right_height(places, left, seconds):
    for _ in range(2):
        with again(places, left) as s:
            s.host.send("M1000")
            s.passes(seconds)
            left = s.positions()
    with again(places, left) as s:
        ends_at_its_height(s)


def test_the_journal_follows_a_machine_that_homes(places, left, tmp_path):
    with again(places, left) as s:
        s.host.ok("G28", 100)
        s.host.ok("G1 Z7 F600")
        s.host.ok("M400", 30)
        s.passes(1)
        left = s.positions()
        s.host.ok("M23 wall.gcode")  # to look at it: nothing is printed yet
        found = Journal(tmp_path / "state").read()
        assert found is not None
        assert found[1].z_mm == pytest.approx(7)
        assert found[1].line > 60
    with again(places, left) as s:
        ends_at_its_height(s)


def test_resume_without_room_for_journal(places, left, monkeypatch):
    with again(places, left) as s:

        def full(_: int) -> None:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

        monkeypatch.setattr(os, "fsync", full)
        s.host.ok("G28", 100)
        s.host.ok("G1 Z7 F600")
        s.host.ok("M400", 30)
        assert sum("journal" in line for line in s.host.heard) == 1
        ends_at_its_height(s)


def test_second_resume_without_endstops_starts_where_first_ended(places):
    text = config.shipped_text("i3")
    begin = text.index("[homing.x]")
    text = text[:begin] + text[text.index("[heaters.hotend]") :]
    machine = config.load_text(text)
    left = cut(places, machine)
    with again(places, left | {"x": 0.0, "y": 0.0}, machine) as s:
        tried(s, 3.5)
        assert s.positions()["x"] > 5
        ends_at_its_height(s)
        assert s.positions()["x"] == pytest.approx(10.0, abs=0.03)


@pytest.mark.parametrize("seconds", [0.5, 2.0, 4.0])
def test_a_pause_in_m1000_acts_as_soon_as_the_print_resumes(places, left, seconds):
    with again(places, left) as s:
        other = Host(s)
        s.host.send("M1000")
        s.passes(seconds)
        assert "will pause once it reaches the resume point" in other.ok("M25")[0]
        s.host.expect("echo:Printing wall", 600)
        s.host.expect("// action:paused", 1)
        s.passes(10)
        resting = s.positions()
        s.passes(10)
        assert s.positions() == resting
        s.host.ok("M24")
        s.host.expect("Done printing", 300)
        assert s.positions()["z"] == pytest.approx(HEIGHT_MM, abs=0.03)


def paused_on_its_way(s):
    """M1000 is under way, and the other console that it returns has sent M25."""
    other = Host(s)
    s.host.send("M1000")
    s.passes(1)
    other.ok("M25")
    return other


def test_a_pause_in_m1000_can_be_taken_back(places, left):
    with again(places, left) as s:
        other = paused_on_its_way(s)
        assert other.ok("M24") == ["ok"]
        s.host.expect("Done printing", 600)
        assert "// action:paused" not in s.host.heard


def test_pause_in_a_stopped_m1000_is_forgotten(places, left):
    with again(places, left) as s:
        paused_on_its_way(s).ok("M524")
        s.host.expect("stopped", 30)
        ends_at_its_height(s)
