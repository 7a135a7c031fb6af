"""M602 ends what waits for a person, M876 S what was asked; no heating, homing or dwell."""

import pytest
from tests.support.scenario import Host, Scenario

ANSWERS = ["M602", "M876 S0", "M24"]


def card(tmp_path, text):
    (tmp_path / "a.g").write_text(text)
    return str(tmp_path)


@pytest.mark.parametrize("answer", ANSWERS)
def test_a_file_heats_and_dwells_to_the_end(tmp_path, answer):
    text = "M109 S60\nM118 hot\nG4 S20\nM118 dwelt\n"
    with Scenario("i3", card=card(tmp_path, text)) as s:
        s.host.ok("M32 a.g")
        s.passes(2)
        s.host.ok(answer)
        s.host.expect("^hot$", 120)
        assert s.board.temperature("hotend") > 55
        s.passes(2)
        s.host.ok(answer)
        s.host.silent(15, "dwelt")
        s.host.expect("^Done printing file$", 10)


@pytest.mark.parametrize("answer", ANSWERS)
def test_a_file_homes_to_the_end(tmp_path, answer):
    with Scenario("i3", card=card(tmp_path, "G28\nG1 X30 F6000\n")) as s:
        s.host.ok("M32 a.g")
        s.passes(3)
        s.host.ok(answer)
        s.host.expect("^Done printing file$", 60)
        assert s.positions()["x"] == pytest.approx(30, abs=0.02)


@pytest.mark.parametrize("answer", ["M602", "M876 S0"])
@pytest.mark.parametrize("own", [True, False])
def test_a_host_heats_to_the_end(answer, own):
    with Scenario("i3") as s:
        s.host.send("M109 S60")
        s.passes(2)
        (s.host if own else Host(s)).send(answer)
        s.host.silent(3, "^ok")
        s.host.expect("^ok", 120)
        assert s.board.temperature("hotend") > 55


def test_late_second_answer_is_ignored(tmp_path):
    """Two hosts show the question of an M600; the line behind it heats."""
    text = "G92 X20 Y20 Z20\nG1 X30 F6000\nM600\nM109 S60\nM118 hot\n"
    with Scenario("i3", card=card(tmp_path, text)) as s:
        other = Host(s)
        s.host.ok("M32 a.g")
        s.host.expect("prompt_show", 20)
        s.passes(10)
        s.host.ok("M876 S0")
        s.passes(6)
        assert s.printer.waits.heating
        other.ok("M876 S0")
        s.host.silent(2, "^hot$")
        s.host.expect("^hot$", 120)
        assert s.board.temperature("hotend") > 55


def test_answer_to_a_paused_file_ends_no_other_wait(tmp_path):
    text = "G92 X20 Y20 Z20\nM601\nG1 X30 F6000\n"
    with Scenario("i3", card=card(tmp_path, text)) as s:
        s.host.ok("M32 a.g")
        s.host.expect("prompt_show", 20)
        s.passes(5)
        s.host.send("M109 S60")
        s.passes(2)
        Host(s).ok("M876 S0")
        s.host.silent(3, "^ok")
        s.host.expect("^ok", 120)
        assert s.board.temperature("hotend") > 55
        s.host.expect("^Done printing file$", 20)


def test_question_interrupted_by_a_pause_is_asked_again(tmp_path):
    text = "G92 X20 Y20 Z20\nG1 X60 F1200\nM0 Look\nG1 X70\n"
    with Scenario("i3", card=card(tmp_path, text)) as s:
        s.host.ok("M32 a.g")
        s.passes(1)
        s.host.ok("M25")
        s.passes(5)
        assert "// action:prompt_end" in s.host.heard
        s.host.ok("M876 S0")
        s.host.silent(5, "resumed")  # nobody was asked to go on with the file
        s.host.ok("M24")
        s.host.expect("prompt_begin Look", 10)
        s.passes(10)
        s.host.silent(5, "Done")
        s.host.ok("M876 S0")
        s.host.expect("^Done printing file$", 10)
        assert s.positions()["x"] == pytest.approx(70, abs=0.02)
