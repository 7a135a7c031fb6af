"""A print from the card: start, pause, cancel, end."""

import json
import re

import pytest
from tests.support.card_print import SQUARE, printed, steps
from tests.support.scenario import Host, Scenario


@pytest.mark.parametrize("end", [b"\0" * 512, b"\r\n\x1a", b"\n\x1arubbish\xff\0\n\x80of a block"])
def test_a_file_that_was_cut_or_is_of_dos_is_printed_to_its_end(s, folder, end):
    (folder / "dos.g").write_bytes(b"\xef\xbb\xbfG28 X\r\nM221 S\r\nG1 X12 F6000" + end)
    s.host.ok("M32 dos.g")
    printed(s)
    assert s.positions()["x"] == 12.0


def test_a_file_is_printed_to_its_end(s):
    assert s.host.ok("M23 square.gcode") == [
        f"File opened: square.gcode Size: {len(SQUARE)}",
        "File selected",
        "ok",
    ]
    s.host.ok("M24")
    assert re.fullmatch(r"SD printing byte \d+/\d+", s.host.ok("M27")[0])
    printed(s)
    assert s.positions() == {"x": 60.0, "y": 60.0, "z": 0.2, "e": pytest.approx(5.9, abs=0.01)}
    assert s.host.ok("M27")[0] == "Not SD printing"


def test_a_printed_file_stays_selected_and_can_be_rewound(s):
    s.host.ok("M32 square.gcode")
    printed(s)
    done = s.host.heard.count("Done printing file")
    assert s.host.ok("M24")[0] == (
        "echo:square.gcode has been printed to its end. Rewind it with M26 S0, then send M24."
    )
    s.passes(1)
    assert s.host.heard.count("Done printing file") == done
    assert "Not SD printing" in s.host.ok("M27")[0]
    s.host.ok("M26")
    s.host.ok("M24")
    s.passes(3)
    assert "SD printing byte" in s.host.ok("M27")[0]
    printed(s)


def test_a_pause_brakes_parks_and_resumes_at_the_same_point(folder):
    with Scenario("i3", card=str(folder)) as s:
        s.host.ok("M32 square.gcode")
        printed(s)
        undisturbed = steps(s)
    with Scenario("i3", card=str(folder)) as s:
        s.host.ok("M32 square.gcode")
        assert s.until(lambda: s.positions()["e"] > 2, 60)
        before = s.loop.time()
        s.host.ok("M25")
        assert s.until(lambda: s.printer.rig.queue.standing, 2)
        assert s.loop.time() - before <= 0.25
        stopped = s.positions()
        s.passes(4)
        assert s.positions() == stopped | {"z": 10.2, "e": pytest.approx(stopped["e"] - 2, 0.01)}
        s.host.ok("G91")
        s.host.ok("G1 X30 E4 F3000")
        s.host.ok("T0")
        s.host.ok("M400")
        assert s.positions()["x"] == pytest.approx(stopped["x"] + 30, abs=0.02)
        s.host.ok("M24")
        printed(s)
        # What was extruded by hand is extruded; all else is as if there had been no pause.
        assert steps(s) == undisturbed | {"e": undisturbed["e"] + round(4 * 95.5)}


def test_cancelling_leaves_the_heaters_off_and_the_file_selected(s):
    s.host.ok("M106 S255")
    s.host.ok("M140 S60")
    s.host.ok("M32 square.gcode")
    assert s.until(lambda: s.positions()["e"] > 2, 60)
    s.host.ok("M524")
    s.passes(1)
    stopped = s.positions()
    s.passes(5)
    assert s.positions() == stopped
    assert s.printer.rig.connection.heaters["bed"].target == 0
    assert s.board.output_value("part") == 0
    assert s.host.ok("M27")[0] == "Not SD printing"
    s.host.ok("M24")
    printed(s)
    assert s.positions()["x"] == 60.0


def test_a_host_cancels_with_pause_and_rewind(s):
    s.host.ok("M32 square.gcode")
    assert s.until(lambda: s.positions()["e"] > 2, 60)
    s.host.ok("M25")
    s.passes(3)
    s.host.ok("M26 S0")
    assert s.host.ok("M27")[0] == "Not SD printing"
    assert s.host.ok("G1 X1 F6000") == ["ok"]


def test_a_program_ends_with_m30_and_deletes_nothing(s, folder):
    (folder / "cnc.nc").write_text("%\nG28\nG1 X5 F6000\nM30\nG1 X9\n%\n")
    s.host.ok("M32 cnc.nc")
    printed(s)
    assert s.positions()["x"] == 5.0
    assert (folder / "cnc.nc").exists()


def test_moves_of_a_console_come_between_those_of_a_file(s):
    s.host.ok("M32 square.gcode")
    s.passes(8)
    assert s.host.ok("M106 S100", 10) == ["ok"]
    assert "T:" in s.host.ok("M105")[0]
    printed(s)
    assert s.board.output_value("part") > 0


def test_auto0_g_runs_at_the_start(folder):
    (folder / "AUTO0.G").write_text("G28 X\nG1 X33 F6000\n")
    with Scenario("i3", card=str(folder)) as s:
        printed(s, 30)
        assert s.positions()["x"] == 33.0


def test_a_file_takes_back_the_speed_that_it_has_kept(s, folder):
    (folder / "a.g").write_text("G92 X0 Y0 Z0\nM220 B\nM220 S50\nG1 X5 F600\nM220 R\nG1 X0 F600\n")
    s.host.ok("M220 S150")
    s.host.ok("M32 a.g")
    s.passes(0.6)
    assert json.loads(s.host.ok("M408 S0")[0])["params"]["speedFactor"] == 150  # as planned by now
    s.host.expect("Done printing", 10)
    assert s.host.ok("M220") == ["Speed factor override: 150", "ok"]


def test_querying_the_file_does_not_disturb_its_print(s, folder):
    (folder / "say.g").write_text("G28\n" + "G1 X30 F6000\nM114\nG1 X60\n" * 200)
    other = Host(s)
    s.host.ok("M32 say.g")
    s.passes(5)
    for question in ("M27", "M73", "M408 S3"):
        s.host.heard.clear()
        other.heard.clear()
        s.host.send(f"G4 P1 {question} M118 MARK")
        s.passes(5)
        assert s.host.heard.count("MARK") == other.heard.count("MARK") == 1
        # What the file's commands answer is told to all.
        said = [line for line in other.heard if line.startswith("X:")]
        assert len(said) > 3
        assert [line for line in s.host.heard if line.startswith("X:")] == said


def test_pause_in_mid_line_drops_rest_of_line(folder):
    lines = "G28\n" + "".join(f"G1 X{10 + 50 * (i % 2)} F3000\n" for i in range(20))
    (folder / "line.g").write_text(lines)
    undisturbed = None
    for pause in ("", "M25", "G4 P1 M25 M118 MARK"):
        with Scenario("i3", card=str(folder)) as s:
            s.host.ok("M32 line.g")
            s.passes(8)
            if pause:
                s.host.send(pause)
                s.passes(8)
                s.host.ok("M24")
            printed(s)
            undisturbed = undisturbed or steps(s)
            assert steps(s) == undisturbed
            assert s.positions()["x"] == 60.0
            assert "MARK" not in s.host.heard


def test_selection_after_cancel_does_not_start(s, folder):
    (folder / "hot.g").write_text("M109 S200\n")
    (folder / "b.g").write_text("M118 B\nG4 S5\n")
    for last in ("M23 b.g", "M22", "M25"):
        s.host.ok("M32 hot.g")
        s.passes(3)
        s.host.send("M524", "M24", last)
        s.passes(3)
        assert s.host.ok("M27")[0] == "Not SD printing"
        s.host.ok("M21")
    s.host.ok("M32 hot.g")
    s.passes(3)
    s.host.send("M524", "M24")
    s.passes(3)
    assert "SD printing byte" in s.host.ok("M27")[0]
    assert s.printer.rig.connection.heaters["hotend"].target == 200
