"""Lines of a file that SDCARD_LOOP_BEGIN repeats, as in Klipper."""

from __future__ import annotations

import pytest
from tests.support.macro_machine import macro, with_macros
from tests.support.scenario import Scenario

from passo import Machine
from passo.errors import InputError
from passo.job.live.journal import Journal

LOOPS = """G28
G91
SDCARD_LOOP_BEGIN COUNT=3 ; parts
G1 X5 F6000
SDCARD_LOOP_BEGIN COUNT=2
G1 Y1
SDCARD_LOOP_END
M118 round
SDCARD_LOOP_END ; all
SDCARD_LOOP_END
G1 X0.5"""
ENDLESS = "G28\nG91\nSDCARD_LOOP_BEGIN COUNT=0\nG1 X5 F3000\nG1 X-5\nSDCARD_LOOP_END\nG1 Y7\n"
I3 = with_macros(macro("LOOPS", "SDCARD_LOOP_BEGIN COUNT=2"))


@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_loops_repeat_on_the_card_and_in_a_print(tmp_path, end):
    path = tmp_path / "a.g"
    path.write_bytes(LOOPS.replace("\n", end).encode())
    printed = Machine(I3).print(path)
    assert (printed.final_position_mm["x"], printed.final_position_mm["y"]) == (15.5, 6.0)
    assert Machine(I3).estimate(path).moves == printed.moves
    with Scenario(I3, card=str(tmp_path)) as s:
        s.host.ok("M32 a.g")
        s.host.expect("Done printing file", 100)
        assert (s.positions()["x"], s.positions()["y"]) == (15.5, 6.0)
        assert s.host.heard.count("round") == 3
        s.host.ok("M32 a.g")  # from its beginning, with all rounds
        s.host.expect("Done printing file", 100)
        assert s.host.heard.count("round") == 6


def test_endless_loop_ends_after_its_round(tmp_path):
    path = tmp_path / "a.g"
    path.write_text(ENDLESS)
    printed = Machine(I3).print(path)
    assert (printed.moves, printed.final_position_mm["y"]) == (3, 7.0)
    assert "SDCARD_LOOP_BEGIN COUNT=0 repeats its lines until" in printed.warnings[0]
    with Scenario(I3, card=str(tmp_path)) as s:
        s.host.ok("M32 a.g")
        s.passes(60)
        assert s.assembly.services.jobs.runner.active
        assert s.positions()["y"] == 0
        s.host.ok("SDCARD_LOOP_DESIST")
        s.host.expect("Done printing file", 30)
        assert (s.positions()["x"], s.positions()["y"]) == (0, 7)


def test_pause_and_failed_line_keep_the_rounds(tmp_path):
    text = "G28\nG91\nSDCARD_LOOP_BEGIN COUNT=3\nG1 X60 F6000\nSDCARD_LOOP_END\nG1 Y7\n"
    (tmp_path / "a.g").write_text(text.replace("G1 X60", "G1 X90\nM104 SX"))
    (tmp_path / "b.g").write_text(text)
    with Scenario(I3, card=str(tmp_path)) as s:
        s.host.ok("M32 b.g")
        assert s.until(lambda: s.positions()["x"] > 70, 60)
        s.host.ok("M25")
        s.passes(5)
        s.host.ok("M24")
        s.host.expect("Done printing file", 60)
        assert (s.positions()["x"], s.positions()["y"]) == (180, 7)
        s.host.ok("M32 a.g")
        for _ in range(2):
            s.host.expect("Print of a.g stopped: a.g:5: the word 'S'", 60)
            s.host.ok("M24")
        s.host.expect("Print of a.g stopped: a.g:4: X 270.000 mm is beyond", 60)
        s.host.ok("M23 b.g")  # its loops are its own
        s.host.ok("M24")
        s.host.expect("Done printing file", 60)
        assert s.positions()["x"] == 180


def test_print_with_loops_is_not_resumed_after_a_power_cut(tmp_path):
    (tmp_path / "a.g").write_text(ENDLESS)
    state = tmp_path / "state"
    with Scenario(I3, card=str(tmp_path), state=str(state)) as s:
        s.host.ok("M32 a.g")
        text = "This print cannot be resumed after a power cut: it repeats its lines"
        s.host.expect(text, 60)
        s.passes(5)
        assert s.host.heard.count(f"echo:{text}") == 1
        s.host.ok("M25")
        s.passes(2)
        s.host.ok("M24")
        s.passes(2)
        assert Journal(state).read() is None


@pytest.mark.parametrize(
    ("text", "line", "says"),
    [
        ("SDCARD_LOOP_BEGIN\n", 2, "SDCARD_LOOP_BEGIN needs COUNT="),
        ("SDCARD_LOOP_BEGIN COUNT=-1\n", 2, "COUNT is -1: expected"),
        ("SDCARD_LOOP_BEGIN COUNT=9\n" * 101, 102, "expected at most 100 loops within each other"),
        ("LOOPS\nG1 X5 F600\n", 2, "SDCARD_LOOP_BEGIN is in a macro"),
        ("M98 P20\nM30\nO20\nSDCARD_LOOP_BEGIN COUNT=2\nM99\n", 5, "BEGIN is in a macro or a sub"),
        ("SDCARD_LOOP_DESIST\n", 2, "SDCARD_LOOP_DESIST controls prints from files"),
    ],
)
def test_wrong_loop_ends_the_print(tmp_path, text, line, says):
    path = tmp_path / "a.g"
    path.write_text(f"G28\n{text}")
    for run in (Machine(I3).print, Machine(I3).estimate):
        with pytest.raises(InputError, match=says) as caught:
            run(path)
        assert caught.value.problems[0].line == line
    with Scenario(I3, card=str(tmp_path)) as s:
        s.host.ok("M32 a.g")
        s.host.expect(f"Print of a.g stopped: a.g:{line}: .*{says}", 60)
        assert "is for files that can be read again" in s.host.ok("SDCARD_LOOP_END")[0]
