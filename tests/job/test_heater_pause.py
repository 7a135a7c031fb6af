"""A heater whose policy is `job` pauses what is printed: it goes on warm, or not at all."""

from pathlib import Path

import pytest
from tests.support.scenario import Host, Scenario

from passo import config

BODY = ["G1 Z5", "M83", *[f"G1 X{60 + i % 2 * 40} E1 F1200" for i in range(8)]]
OPEN = 1.0


def machine():
    text = config.shipped_text("i3")
    for limit in ("max_c = 285.0\n", "max_c = 120.0\n"):
        text = text.replace(limit, f'{limit}on_fault = "job"\n', 1)
    return config.load_text(text)


@pytest.fixture
def s(tmp_path):
    with Scenario(machine(), card=str(tmp_path)) as scenario:
        scenario.card = tmp_path
        yield scenario


def begin(s: Scenario, *lines: str, from_card: bool = True) -> Host:
    """Sends or starts a print; returns another console."""
    lines = ("G28", *lines, *BODY)
    if from_card:
        Path(s.card, "a.g").write_text("\n".join(lines) + "\n")
        s.host.send("M32 a.g")
    else:
        s.host.send(*lines)
    return Host(s)


def fails(s: Scenario, heater: str) -> None:
    """Its sensor is open for three seconds."""
    s.board.force_sensor(heater, OPEN)
    s.passes(3)
    s.board.force_sensor(heater, None)
    s.passes(1)


@pytest.mark.parametrize(
    ("wait", "heater", "after_s"),
    [
        ("M109 S200", "hotend", 20),
        ("M109 S200", "hotend", 60),
        ("M190 S60", "bed", 20),
        ("M104 S200\nM140 S60\nM116", "bed", 30),
    ],
)
def test_file_waits_again_for_heater_that_failed(s, wait, heater, after_s):
    other = begin(s, wait)
    s.passes(after_s)
    fails(s, heater)
    assert s.host.ok("M27")[0].startswith("SD printing")
    other.send("M922", "M302 P1", "M24")
    s.host.expect("Done printing", 600)
    found = s.printer.rig.connection.heaters[heater]
    assert found.celsius == pytest.approx(found.target, abs=4)
    assert s.positions()["e"] == pytest.approx(8, abs=0.02)


@pytest.mark.parametrize(("from_card", "on"), [(True, "M24"), (False, "M108")])
def test_nothing_is_pushed_before_the_hotend_is_warm_again(s, from_card, on):
    other = begin(s, "M109 S200", from_card=from_card)
    assert s.until(lambda: s.positions()["e"] > 3, 400)
    fails(s, "hotend")
    s.passes(200)
    at = s.positions()
    assert s.board.temperature("hotend") < 100
    if from_card:
        other.send(on)  # it is not armed yet
        s.host.expect("stays paused: heater hotend was switched off", 5)
        s.passes(30)
        assert s.positions() == at
        other.send("M922")
    other.send(on)
    s.passes(10)
    assert s.positions() == at
    assert s.until(lambda: s.positions()["e"] > at["e"] + 0.1, 200)
    assert s.board.temperature("hotend") > 190
    assert s.until(lambda: s.positions()["e"] > 7.98, 60)


@pytest.mark.parametrize("heats", ["M104 S200", "M302 P1"])
def test_print_stays_paused_if_hotend_was_switched_off(s, heats):
    other = begin(s, "M109 S200")
    assert s.until(lambda: s.positions()["e"] > 3, 400)
    other.ok("M25")
    s.passes(5)
    other.ok("M104 S0")
    s.passes(200)
    at = s.positions()
    other.send("M24")
    s.host.expect("stays paused: cold extrusion prevented", 5)
    s.passes(10)
    assert s.positions() == at
    other.send(heats, "M24")
    s.host.expect("Done printing", 300)
    assert s.positions()["e"] == pytest.approx(8, abs=0.02)


@pytest.mark.parametrize("pause", ["M600", "G4 S0"])
def test_answer_to_the_failure_question_rearms_heater(s, pause):
    """A host that has one line under way cannot send M922."""
    begin(s, "M109 S200", from_card=False)
    assert s.until(lambda: s.positions()["e"] > 3, 400)
    other = Host(s)
    other.send(pause)
    s.passes(20 if pause == "M600" else 0)
    s.board.force_sensor("hotend", OPEN)
    s.passes(5)
    at, heater = s.positions(), s.printer.rig.connection.heaters["hotend"]
    if pause == "M600":  # what is asked for is the change
        other.send("M108")
        other.expect("prompt_begin .*heater hotend was switched off", 5)
    for _ in range(2):  # it is not mended yet
        assert heater.fault
        other.send("M108")
        other.expect("Print still paused: heater hotend was switched off", 5)
        s.passes(1)
        assert (s.positions(), s.board.output_value("hotend")) == (at, 0)
    s.board.force_sensor("hotend", None)
    s.passes(1)
    other.send("M108")
    assert s.until(lambda: s.positions()["e"] > 7.98, 300)
    assert s.board.temperature("hotend") > 190


@pytest.mark.parametrize(("from_card", "on"), [(True, "M24"), (False, "M108")])
def test_print_continues_without_a_failed_bed(s, from_card, on):
    other = begin(s, "M140 S40", "M109 S200", from_card=from_card)
    assert s.until(lambda: s.positions()["e"] > 3, 400)
    s.board.force_sensor("bed", OPEN)
    s.passes(5)
    other.send(on)
    assert s.until(lambda: s.positions()["e"] > 7.98, 60)
    assert s.board.output_value("bed") == 0


def test_hotend_with_wrong_sensor_while_print_is_suspended(s):
    """A short circuit says that it is hot: it need not be so again."""
    other = begin(s, "M109 S60")
    s.passes(3)
    s.host.ok("M104 S60")
    s.board.force_sensor("hotend", 0.0)
    s.passes(5)
    s.board.force_sensor("hotend", None)
    s.passes(2)
    other.send("M922", "M24", "M302 P1")
    s.host.expect("Done printing", 300)


def test_hotend_fails_while_a_file_waits_for_the_user(s):
    other = begin(s, "M109 S200", "M0")
    s.host.expect("prompt_show", 400)
    fails(s, "hotend")
    other.send("M108")
    s.host.expect("is paused: heater hotend was switched off", 5)
    s.passes(60)
    assert s.host.ok("M27")[0].startswith("SD printing")
    other.send("M922", "M24")
    s.host.expect("prompt_show", 300)
    other.send("M108")
    s.host.expect("Done printing", 300)
    assert s.positions()["e"] == pytest.approx(8, abs=0.02)
    assert s.board.temperature("hotend") > 190
