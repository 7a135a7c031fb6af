"""What a print that goes on after a power cut must know beside its file."""

import math
from pathlib import Path

import pytest
from tests.job.test_journal import WALL, journal_of
from tests.support.scenario import Scenario

from passo import config
from passo.job.live.journal import Journal, Moment, Program

VASE = "M302 P1\nG28\nG92 E0\nG1 Z0.2 F600\n" + "".join(
    f"G1 X{100 + 20 * math.cos(i / 10):.3f} Y{100 + 20 * math.sin(i / 10):.3f}"
    f" Z{0.2 + i / 3000:.5f} E{i / 40:.3f} F2400\n"
    for i in range(600)
)


@pytest.fixture
def places(tmp_path):
    (tmp_path / "card").mkdir()
    (tmp_path / "card" / "wall.gcode").write_text(WALL)
    (tmp_path / "card" / "vase.gcode").write_text(VASE)
    return {"card": str(tmp_path / "card"), "state": str(tmp_path / "state")}


def recorded(places):
    return journal_of(Path(places["state"]))


def left_after(places, *lines):
    """Where the motors are when the power goes in the fifth layer, these lines a moment before."""
    with Scenario("i3", **places) as s:
        s.host.ok("M32 wall.gcode")
        assert s.until(lambda: s.positions()["e"] > 6.5, 200)
        for line in lines:
            s.host.ok(line)
            s.passes(3)
        return s.positions()


def gone_on(places, left):
    """Where they are at the end of the print, gone on with from there."""
    with Scenario("i3", **places) as s:
        goes_on(s, left)
        return s.positions()


def goes_on(s, left):
    """The print, from where the motors were left to its end."""
    for stepper in "xyz":
        s.board.place(stepper, left[stepper])
    s.host.ok("M302 P1")
    s.host.ok("M1000", 600)
    s.host.expect("Done printing", 300)


def test_babysteps_of_a_console_are_not_forgotten(places):
    left = left_after(places, "M290 Z0.3", "M290 X-0.5")
    assert recorded(places)[1].babysteps_mm == {"x": -0.5, "z": 0.3}
    end = gone_on(places, left)
    assert end["z"] == pytest.approx(1.6 + 0.3, abs=0.01)
    assert end["x"] == pytest.approx(10.0 - 0.5, abs=0.02)


@pytest.mark.parametrize("pause", [("M25", "M24"), ("M25", "G28", "M24"), ("M25", "G28 Z", "M24")])
def test_babysteps_of_suspended_job_survive_homing(places, pause):
    left = left_after(places, "M290 Z0.3", *pause)
    assert recorded(places)[1].babysteps_mm == {"z": 0.3}
    assert gone_on(places, left)["z"] == pytest.approx(1.6 + 0.3, abs=0.01)


def test_babysteps_before_and_after_homing_in_a_pause_add_up(places):
    left = left_after(places, "M290 Z0.3", "M25", "G28 Z", "M290 Z0.2", "M24")
    assert recorded(places)[1].babysteps_mm == {"z": 0.5}
    assert gone_on(places, left)["z"] == pytest.approx(1.6 + 0.5, abs=0.01)


def test_babysteps_of_a_print_that_was_given_up_are_gone_with_it(places):
    with Scenario("i3", **places) as s:
        s.host.ok("M32 wall.gcode")
        assert s.until(lambda: s.positions()["e"] > 6.5, 200)
        s.host.ok("M290 Z0.3")
        s.host.ok("M25")
        s.passes(3)
        s.host.ok("G28", 60)
        assert (
            s.printer.motion.offsets.of_program_mm(suspended=s.printer.rig.job.stops.suspended)["z"]
            == 0.3
        )
        s.host.ok("M524")
        assert (
            s.printer.motion.offsets.of_program_mm(suspended=s.printer.rig.job.stops.suspended)["z"]
            == 0
        )


def test_babysteps_end_where_the_axis_is_homed(places):
    with Scenario("i3", **places) as s:
        s.host.ok("G28", 60)
        s.host.ok("M290 Z0.3")
        s.host.ok("M290 X0.3")
        s.host.ok("G28 Z", 60)
        assert s.printer.motion.offsets.babysteps_mm == {"x": 0.3, "y": 0.0, "z": 0.0}


def test_z_is_known_after_a_power_cut_in_a_pause(places):
    left = left_after(places, "M25")
    assert left["z"] > 5  # parked above the print
    assert gone_on(places, left)["z"] == pytest.approx(1.6, abs=0.01)


def test_z_is_known_after_a_babystep_in_a_pause(places):
    left = left_after(places, "M25", "M290 Z0.5")
    assert gone_on(places, left)["z"] == pytest.approx(2.1, abs=0.01)


def test_a_vase_is_recorded_as_seldom_as_its_z_allows(places, monkeypatch):
    records = []
    record = Journal.record
    monkeypatch.setattr(Journal, "record", lambda s, m: (records.append(m), record(s, m)))
    with Scenario("i3", **places) as s:
        s.host.ok("M32 vase.gcode")
        assert s.until(lambda: s.positions()["e"] > 1, 60)
        records.clear()
        start = s.loop.time()
        assert s.until(lambda: s.positions()["e"] > 13, 200)
        seconds = s.loop.time() - start
        rise = 12 * 40 / 3000
        assert len(records) <= seconds + rise / 0.02 + 2
        true_z = s.positions()["z"]
        assert abs(records[-1].z_mm - true_z) < 0.04


def test_nothing_is_written_while_nothing_changes(places, monkeypatch):
    text = "G28\nG1 Z5\nG4 S600\nG1 Z6\n"
    (Path(places["card"]) / "still.g").write_text(text)
    records = []
    record = Journal.record
    monkeypatch.setattr(Journal, "record", lambda s, m: (records.append(m), record(s, m)))
    with Scenario("i3", **places) as s:
        s.host.ok("M32 still.g")
        s.passes(30)
        records.clear()
        s.passes(300)
        assert records == []
        s.host.ok("M140 S40 F")  # what the file does not tell
        s.passes(2)
        assert [m.targets_c["bed"] for m in records] == [40.0]


def test_only_steps_of_z_that_matter_are_written(places):
    """A machine that homes upwards finds its Z by itself."""
    with Scenario("delta", **places) as s:
        s.host.ok("M32 wall.gcode")
        assert s.until(lambda: s.positions()["e"] > 6.5, 200)
        written = len(Journal(Path(places["state"])).path.read_bytes().split(b"\n"))
        assert written <= s.printer.rig.queue.now_s + 4


def test_a_long_journal_is_read_to_its_end(tmp_path):
    journal = Journal(tmp_path)
    program = Program("m", "/a", 5, 7)
    journal.begin(program, Moment(1, 0.0, 0.0, {"x" * 60000: 1.0}))
    journal.record(Moment(8, 9.5, 0.2))
    journal.leave()
    first, early, late, _ = journal.path.read_bytes().split(b"\n")
    with journal.path.open("wb") as file:
        file.write(first + b"\n")
        for _ in range((1 << 26) // len(early) + 1):
            file.write(early + b"\n")
        file.write(late + b"\n")
    assert journal.path.stat().st_size > 1 << 26
    assert journal.read() == (program, Moment(8, 9.5, 0.2))


def test_a_line_without_end_is_not_a_record(tmp_path):
    journal = Journal(tmp_path)
    journal.begin(Program("m", "/a", 5, 7), Moment(3, 1.0))
    journal.leave()
    with journal.path.open("ab") as file:
        file.write(b"0" * (1 << 20))
    assert journal.read() == (Program("m", "/a", 5, 7), Moment(3, 1.0))


def test_a_full_disk_leaves_no_stale_offer(places, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    with Scenario("i3", **places) as s:
        s.host.ok("M32 wall.gcode")
        assert s.until(lambda: s.positions()["e"] > 2, 200)
        monkeypatch.setattr(Journal, "record", full)
        s.host.expect("cannot be resumed after a power cut: No space left", 3)
        s.host.expect("Done printing", 300)
        assert s.positions()["z"] == pytest.approx(1.6, abs=0.01)
    assert recorded(places) is None


@pytest.mark.parametrize(
    ("machine", "stored"),
    [("i3", ("M200 D1.75", "M204 P500", "M207 S5")), ("dual-extruder", ("M218 T1 X20 Y1",))],
)
def test_stored_settings_hold_for_the_rest_of_a_print(machine, stored, tmp_path):
    (tmp_path / "card").mkdir()
    tool = "T1\n" if machine != "i3" else ""
    lines = [f"G1 X{50 + i % 2 * 30} Y50 Z5 E2 F600" for i in range(8)]
    (tmp_path / "card" / "a.g").write_text(f"G28\n{tool}M83\n" + "\n".join(lines))
    places = {"card": str(tmp_path / "card"), "state": str(tmp_path / "state")}
    with Scenario(machine, **places) as s:
        for line in (*stored, "M302 P1", "M500", "M32 a.g"):
            s.host.ok(line)
        s.host.expect("Done printing", 200)
        whole, settings = s.printer.rig.job.machine_position, s.host.ok("M503")
    with Scenario(machine, **places) as s:
        s.host.ok("M32 a.g")
        assert s.until(lambda: s.printer.rig.job.history.line_at(s.printer.rig.queue.now) >= 8, 200)
    with Scenario(machine, **places) as s:
        s.host.ok("M1000", 200)
        s.host.expect("Done printing", 200)
        assert s.printer.rig.job.machine_position == pytest.approx(whole, abs=1e-6)
        assert s.host.ok("M503") == settings


def test_the_nozzle_that_prints_is_filled(tmp_path):
    (tmp_path / "card").mkdir()
    lines = [f"G1 X{50 + i % 2 * 30} Y50 Z5 E2 F600" for i in range(8)]
    (tmp_path / "card" / "a.g").write_text("G28\nT1\nM83\n" + "\n".join(lines))
    places = {"card": str(tmp_path / "card"), "state": str(tmp_path / "state")}
    machine = config.load_text(
        config.shipped_text("dual-extruder") + "\n[park]\nprime_mm = 4.0\nprime_mm_s = 5.0\n"
    )
    with Scenario(machine, **places) as s:
        s.host.ok("M302 P1")
        s.host.ok("M32 a.g")
        assert s.until(lambda: s.printer.rig.job.history.line_at(s.printer.rig.queue.now) >= 8, 200)
    line = recorded(places)[1].line
    with Scenario(machine, **places) as s:
        before = s.positions()
        s.host.ok("M302 P1")
        s.host.ok("M1000", 200)
        s.host.expect("Done printing", 200)
        after = s.positions()
        assert after["e"] == before["e"]
        left_mm = 2 * (3 + len(lines) - line + 1)
        assert after["e1"] - before["e1"] == pytest.approx(4 + left_mm, abs=0.05)


FAR = WALL.replace("X10", "X90").replace("X50", "X130").replace("Y10", "Y60").replace("Y50", "Y100")
NEAR = WALL.replace("G92 E0\n", "G92 E0\nG1 X100 Y100 F6000\n")  # no straight way from home


@pytest.mark.parametrize(("when", "text"), [(6.5, FAR), (0.9, NEAR), (13.3, NEAR)])
def test_a_print_resumes_with_arms(when, text, tmp_path):
    """Arms find their switches anew, and their way; Z, which moves alone, is kept."""
    (tmp_path / "card").mkdir()
    (tmp_path / "card" / "wall.gcode").write_text(text)
    places = {"card": str(tmp_path / "card"), "state": str(tmp_path / "state")}
    with Scenario("scara", **places) as s:
        s.host.ok("M32 wall.gcode")
        s.host.expect("Done printing", 600)
        whole = s.positions()
    with Scenario("scara", **places) as s:
        s.host.ok("M140 S50")
        s.host.ok("M32 wall.gcode")
        assert s.until(lambda: s.positions()["e"] > when, 300)
        left = s.positions()
    with Scenario("scara", **places) as s:
        for stepper in left:
            if stepper != "e":
                s.board.place(stepper, left[stepper])
        s.host.ok("M302 P1")
        lowest = [left["z"]]
        s.printer.lifetime.as_time_passes(lambda: lowest.append(s.positions()["z"]))
        answer = s.host.ok("M1000", 900)
        assert any("Printing wall.gcode from line" in x for x in answer), answer
        assert min(lowest) > left["z"] - 0.05
        s.host.expect("Done printing", 600)
        end = s.positions()
        for stepper in ("a", "b", "z"):
            assert end[stepper] == pytest.approx(whole[stepper], abs=0.03)


def cut_and_gone_on(text, places, line, *live, lead=3):
    """Cut while this line is printed, consoles having sent `live` so many lines before; gone on
    with. The journal's line, mm of filament from there, and the printer's last overrides."""
    (Path(places["card"]) / "a.g").write_text(text)
    with Scenario("i3", **places) as s:
        s.host.ok("M32 a.g")

        def at(number):
            return lambda: s.printer.rig.job.history.line_at(s.printer.rig.queue.now) >= number

        assert s.until(at(line - lead), 200)
        for order in live:
            s.host.ok(order)
        assert s.until(at(line), 200)
    number = recorded(places)[1].line
    with Scenario("i3", **places) as s:
        s.host.ok("M302 P1")
        s.host.ok("M1000", 200)
        before, start = s.printer.rig.commands.outputs.fans["part"], s.positions()["e"]
        s.host.expect("Done printing", 200)
        job = s.printer.rig.job
        return (
            number,
            s.positions()["e"] - start,
            before,
            job.filament.flows,
            job.limits.speed_factor,
        )


OVERRIDDEN = (
    "M302 P1\nG28\nM83\nM106 S51\n"
    + "".join(f"G1 X{50 + i % 2 * 30} Y50 Z5 E1 F1800\n" for i in range(15))
    + "M221 S50\nM220 S80\nM106 S255\n"
    + "".join(f"G1 X{50 + i % 2 * 30} Y50 Z5 E1 F1800\n" for i in range(8))
)


def test_overrides_of_the_file_hold_from_their_line(places):
    """All of it was read ahead when the power went in line 12."""
    line, e_mm, fan, flows, speed = cut_and_gone_on(OVERRIDDEN, places, 12)
    assert 11 <= line <= 12
    assert fan == pytest.approx(0.2)
    assert e_mm == pytest.approx(20 - line + 8 * 0.5, abs=0.05)
    assert (flows, speed) == ([0.5], 0.8)


def test_overrides_of_a_console_hold_until_the_file_sets_others(places):
    orders = ("M221 S200", "M220 S120", "M106 S153 F")
    line, e_mm, fan, flows, speed = cut_and_gone_on(
        OVERRIDDEN.replace("M221 S50\nM220 S80\nM106 S255\n", ""), places, 12, *orders
    )
    assert fan == pytest.approx(0.6)
    assert e_mm == pytest.approx(2 * (28 - line), abs=0.1)
    assert (flows, speed) == ([2.0], 1.2)


def test_planned_fan_value_replaces_one_set_at_once(places):
    """It was read when M106 came in line 19, and acted in line 22."""
    line, _, fan, _, _ = cut_and_gone_on(OVERRIDDEN, places, 26, "M106 S153 F", lead=7)
    assert 23 <= line <= 26
    assert fan == pytest.approx(1.0)


SET_IN_FILE = {
    "i3": "M302 P1\nM206 X5\nM92 E200\nG28\nM206 Y3\nG91\nG1 X50 Y50 Z5 F6000\nG90\nM83\n",
    "dual-extruder": "M302 P1\nG28\nM218 T1 X20 Y1\nT1\nM92 E120\nG10 P0 S0 R0\nM83\n",
}


@pytest.mark.parametrize("machine", list(SET_IN_FILE))
def test_settings_of_the_file_hold_for_the_rest_of_it(machine, places):
    text = SET_IN_FILE[machine]
    last = text.count("\n")
    text += "".join(f"G1 X{80 + i % 2 * 30} Y80 Z5 E2 F600\n" for i in range(8))
    (Path(places["card"]) / "a.g").write_text(text + "G91\nG1 X1\nG90\n")
    with Scenario(machine, **places) as s:
        s.host.ok("M32 a.g")
        s.host.expect("Done printing", 300)
        job, offsets = s.printer.rig.job, s.printer.motion.offsets
        settings = s.host.ok("M503")
        whole = job.machine_position, offsets.home_mm, job.tool
        steps = s.positions()
    with Scenario(machine, **places) as s:
        s.host.ok("M32 a.g")
        assert s.until(
            lambda: s.printer.rig.job.history.line_at(s.printer.rig.queue.now) >= last + 4, 300
        )
        left = s.positions()
    with Scenario(machine, **places) as s:
        s.board.place("z", left["z"])
        s.host.send("M1000")
        s.host.expect("Done printing", 300)
        assert s.host.ok("M503") == settings
        job, offsets = s.printer.rig.job, s.printer.motion.offsets
        assert job.machine_position == pytest.approx(whole[0], abs=1e-6)
        assert (offsets.home_mm, job.tool) == whole[1:]
        for stepper in "xy":
            assert s.positions()[stepper] == pytest.approx(steps[stepper], abs=0.03)


@pytest.mark.parametrize("home", ["G28 O", "G28 X O", "G28 B", "M206 X5\nG28 B", "M84 X\nG28 O"])
def test_homing_in_the_midst_of_a_file_is_read_as_it_was_done(home, places):
    """Only axes that do not know where they are begin at home, and drop what G92 has set."""
    text = f"M302 P1\nG28\nG1 X60 Y60 Z5 F6000\nG92 X50 Y70\n{home}\nG91\n"
    last = text.count("\n")
    text += "".join(f"G1 X{5 - i % 2 * 7} Y2 F300\n" for i in range(8)) + "G90\nG1 X70 Y70\n"
    (Path(places["card"]) / "a.g").write_text(text)
    with Scenario("i3", **places) as s:
        s.host.ok("M32 a.g")
        s.host.expect("Done printing", 300)
        whole = s.positions()
    with Scenario("i3", **places) as s:
        s.host.ok("M32 a.g")
        assert s.until(
            lambda: s.printer.rig.job.history.line_at(s.printer.rig.queue.now) >= last + 4, 300
        )
        left = s.positions()
    with Scenario("i3", **places) as s:
        s.board.place("z", left["z"])
        s.host.send("M1000")
        s.host.expect("Done printing", 300)
        assert s.positions() == pytest.approx(whole | {"e": 5.0}, abs=0.03)  # the priming


@pytest.mark.parametrize(
    ("machine", "before"),
    [
        ("i3", ("M206 X-5 Y-3", "M92 E120", "M204 P500", "M302 P1")),
        ("i3", ("M83", "G91", "G1 F1234")),
        ("i3", ("G20", "M83")),
        ("i3", ("G28", "G1 X60 Y60 Z5 F6000", "G92 X0 Y10 Z2 E7")),
        ("dual-extruder", ("G28", "M218 T1 X20 Y1", "T1", "G1 X90 Y60 Z5 F6000", "G92 X50")),
        ("dual-extruder", ("G28", "G1 X90 Y60 Z5 F6000", "M218 T1 X-20 Y1 Z-0.5", "T1")),
    ],
)
def test_a_print_resumes_with_its_settings_from_the_start(machine, before, places):
    """Settings that nobody has stored, modes, a tool and places that its file does not name."""
    home = "" if "G28" in before else "G28\nG1 X2 Y2 Z0.2\n"
    text = f"M302 P1\n{home}" + "".join(f"G1 X{i % 2 + 1} E{i / 10} F60\n" for i in range(16))
    (Path(places["card"]) / "a.g").write_text(text + "M206 Z1\nM500\n")

    def begun(s):
        for line in (*before, "M32 a.g"):
            s.host.ok(line, 60)

    def ended(s):
        s.host.expect("Done printing", 300)
        job = s.printer.rig.job
        return job.machine_position[:3], job.program_position, s.host.ok("M503")

    with Scenario(machine, **places) as s:
        begun(s)
        whole = ended(s)
        where = {axis: s.positions()[axis] for axis in "xyz"}
    (Path(places["state"]) / "settings.json").unlink()
    with Scenario(machine, **places) as s:
        begun(s)
        line = text.count("\n") - 8
        assert s.until(
            lambda: s.printer.rig.job.history.line_at(s.printer.rig.queue.now) >= line, 300
        )
        left = s.positions()
    (Path(places["state"]) / "settings.json").unlink(missing_ok=True)
    for cut in (True, False):
        with Scenario(machine, **places) as s:
            for axis in "xyz":
                s.board.place(axis, left[axis])
            s.host.send("M1000")
            if cut:
                assert s.until(
                    lambda: s.printer.rig.job.history.line_at(s.printer.rig.queue.now) >= line + 2,
                    300,
                )
                left = s.positions()
                continue
            found = ended(s)
            assert found[0] == pytest.approx(whole[0], abs=1e-6)
            assert found[1] == pytest.approx(whole[1], abs=1e-6)
            assert found[2:] == whole[2:]
            for axis in "xyz":
                assert s.positions()[axis] == pytest.approx(where[axis], abs=0.03)


def test_a_print_without_endstops_resumes_from_home(tmp_path):
    """Nobody but a person can bring it there, so it says so."""
    (tmp_path / "card").mkdir()
    (tmp_path / "card" / "a.g").write_text("G1 X20 Y10 F600\nG1 X60 Y40\nG1 X10\n")
    places = {"card": str(tmp_path / "card"), "state": str(tmp_path / "state")}
    with Scenario("cnc", **places) as s:
        s.host.ok("M32 a.g")
        s.passes(4)
    with Scenario("cnc", **places) as s:
        assert "resumes it from X 0 Y 0: without switches it must" in s.printer.state.greeting()
        s.host.ok("M1000", 60)
        s.host.expect("Done printing", 60)
        assert (s.positions()["x"], s.positions()["y"]) == pytest.approx((10, 40), abs=0.02)


def state_after(places, name, *lines, killed):
    """Settings and modes at the end of a print that these lines of a console have changed."""
    with Scenario("i3", **places) as s:
        s.host.ok(f"M32 {name}")
        assert s.until(lambda: s.positions()["e"] > 4.5, 200)
        for line in lines:
            s.host.ok(line, 60)
        s.passes(6)
        left = s.positions()
        if not killed:
            s.until(lambda: "Done printing file" in s.host.heard, 300)
            return list(s.printer.settings.lines()), s.printer.rig.job.modes.gcode
    with Scenario("i3", **places) as s:
        for stepper in "xyz":
            s.board.place(stepper, left[stepper])
        s.host.ok("M302 P1")
        s.host.ok("M1000", 600)
        s.until(lambda: "Done printing file" in s.host.heard, 300)
        return list(s.printer.settings.lines()), s.printer.rig.job.modes.gcode


@pytest.mark.parametrize(
    "lines",
    [
        ("M203 X50", "M83"),
        ("M204 P500", "M204 P900"),
        ("M207 S2", "M603 L50"),
        ("M302 S150 P1", "G91 G90"),
        ("M200 D2", "M200 S0"),
        ("SET_VELOCITY_LIMIT VELOCITY=70 MINIMUM_CRUISE_RATIO=0.1",),
        ("M25", "M83", "M203 X60", "M24"),
    ],
)
def test_settings_of_consoles_survive_interruption(places, lines):
    whole = state_after(places, "wall.gcode", *lines, killed=False)
    assert state_after(places, "wall.gcode", *lines, killed=True) == whole


def test_a_tool_offset_set_during_a_print_is_not_forgotten(places):
    left = left_after(places, "M218 T0 X1")
    assert recorded(places)[0].changes[0][1] == ["G21", "M218 T0 X1 Y0 Z0", "G21"]
    assert gone_on(places, left)["x"] == pytest.approx(9.0, abs=0.02)


def test_settings_of_consoles_survive_second_interruption(places):
    left = left_after(places, "M218 T0 X1", "M218 T0 X2")
    with Scenario("i3", **places) as s:
        for stepper in "xyz":
            s.board.place(stepper, left[stepper])
        s.host.ok("M302 P1")
        s.host.ok("M1000", 600)
        s.passes(3)
        left = s.positions()
    assert [lines[1] for _, lines in recorded(places)[0].changes] == [
        "M218 T0 X1 Y0 Z0",
        "M218 T0 X2 Y0 Z0",
    ]
    assert gone_on(places, left)["x"] == pytest.approx(8.0, abs=0.02)


def test_settings_before_first_move_survive_interruption(places, tmp_path):
    (tmp_path / "card" / "fails.gcode").write_text("G4 P10\nM104 Sx\n" + WALL)
    ends = []
    for killed in (False, True):
        with Scenario("i3", **places) as s:
            s.host.ok("M32 fails.gcode")
            s.host.expect("Print of fails.gcode stopped", 20)
            s.passes(2)
            for line in ("M203 X50", "M83", "M24"):
                s.host.ok(line)
            assert s.until(lambda: s.positions()["e"] > 4.5, 200)
            left = s.positions()
            if not killed:
                s.host.expect("Done printing", 300)
                ends.append((list(s.printer.settings.lines()), s.printer.rig.job.modes.gcode))
    with Scenario("i3", **places) as s:
        goes_on(s, left)
        assert (list(s.printer.settings.lines()), s.printer.rig.job.modes.gcode) == ends[0]
    assert "M83" in ends[0][1]


def test_live_only_settings_of_file_survive_interruption(places, tmp_path):
    own = "M85 S3600\nM84 S300\nM301 P25\nM145 S0 H205\nM540 S1\n"
    (tmp_path / "card" / "own.gcode").write_text(own + WALL)
    whole = state_after(places, "own.gcode", killed=False)
    assert {"M85 S3600", "M84 S300", "M540 S1"} <= set(whole[0])
    assert state_after(places, "own.gcode", killed=True) == whole


def test_what_was_allowed_for_a_print_survives_interruption(places):
    text = "M302 P1\nG28\nPRINT_START\nT3\n" + "".join(
        f"G1 X{300 - i % 2 * 200} Y50 Z5 E{i} F1800\n" for i in range(20)
    )
    (Path(places["card"]) / "a.g").write_text(text)
    with Scenario("i3", **places) as s:

        async def start():
            skips = s.printer.skips.allowing(["clamp", "ignore_tools", "unknown"])
            s.assembly.services.jobs.files.open("/a.g")
            s.assembly.services.jobs.runner.start(skips=skips)

        s.run(start())
        assert s.until(lambda: s.positions()["e"] > 6, 200)
        left = s.positions()
    assert recorded(places)[0].allow == ["clamp", "ignore_tools", "unknown"]
    with Scenario("i3", **places) as s:
        goes_on(s, left)
        assert s.positions()["x"] == 100


def test_outputs_resume_with_their_values_at_the_place(places):
    outputs = '[outputs.{}]\npin = "{}"\n'
    parts = outputs.format("lamp", "D11") + outputs.format("late", "D6") + "start = 1.0\n"
    machine = config.load_text(
        config.shipped_text("i3").replace("[fans.part]", f"{parts}[fans.part]")
    )
    moves = "".join(f"G1 X{50 + i % 2 * 30} Y50 Z5 F1800\n" for i in range(15))
    text = f"G28\nSET_PIN PIN=lamp VALUE=1\n{moves}SET_PIN PIN=lamp VALUE=0\n{moves}"
    (Path(places["card"]) / "a.g").write_text(text)
    with Scenario(machine, **places) as s:
        s.host.ok("M32 a.g")
        history, queue = s.printer.rig.job.history, s.printer.rig.queue
        assert s.until(lambda: history.line_at(queue.now) >= 8, 200)
        assert s.board.output_value("outputs.lamp") == 1
    with Scenario(machine, **places) as s:
        s.passes(1)
        names = ("lamp", "late")
        assert [s.board.output_value(f"outputs.{name}") for name in names] == [0, 1]
        s.host.ok("M1000", 200)
        s.passes(1)
        assert [s.board.output_value(f"outputs.{name}") for name in names] == [1, 1]
        s.host.expect("Done printing", 200)
        s.passes(1)
        assert s.board.output_value("outputs.lamp") == 0
