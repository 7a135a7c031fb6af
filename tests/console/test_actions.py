"""Lines for hosts: `// action:`, with the blank that Printrun needs, and temperatures in waits."""

from __future__ import annotations

import re

import pytest
from tests.support.scenario import Host, Scenario

from passo import config


@pytest.fixture
def s():
    with Scenario() as scenario:
        yield scenario


def actions(host: Host) -> list[str]:
    assert not [line for line in host.heard if line.startswith("//action")]
    return [x.removeprefix("// action:") for x in host.heard if x.startswith("// action:")]


@pytest.mark.parametrize(
    ("line", "text", "seconds"),
    [
        ("M0 Remove clip3", "Remove clip3", None),
        ("M0 Close TOPS9 lid", "Close TOPS9 lid", None),
        ("M1 S5 Look at P20", "Look at P20", 5.0),
        ("M0 P2500 S3 Two words", "Two words", 3.0),
        ("M0 P2500", "Waiting; continue with M108", 2.5),
        ("M0", "Waiting; continue with M108", None),
        ("M0 Stop", "Stop", None),
    ],
)
def test_m0_reads_parameters_only_before_its_text(s, line, text, seconds):
    start = s.loop.time()
    s.host.send(line)
    s.host.expect("busy: paused for user", 1)
    assert actions(s.host) == [f"prompt_begin {text}", "prompt_button Continue", "prompt_show"]
    if seconds is None:
        s.host.silent(20, "^ok")
        s.host.send("M876 S0")
    s.host.expect("^ok", 10)
    if seconds is not None:
        assert s.loop.time() - start == pytest.approx(seconds, abs=0.3)


def test_m115_announces_what_there_is(s):
    told = s.host.ok("M115")
    assert "Cap:PROMPT_SUPPORT:1" in told  # M0 and M600 ask, M876 answers
    assert "Cap:PROGRESS:1" in told  # M530 to M532
    s.host.ok("M532 X40")
    assert s.host.ok("M73") == ["echo:Progress: 40%", "ok"]


@pytest.mark.parametrize("wait", ["M109 S60", "M190 S40", "M116"])
def test_heater_wait_reports_temperature_every_second(s, wait):
    beside = Host(s)
    if wait == "M116":
        s.host.ok("M140 S40")
    s.host.send(wait)
    s.passes(5.5)
    lines = [line for line in s.host.heard if " T:" in line]
    number = r"-?\d+\.\d\d"
    line = rf" T:{number} /{number} B:{number} /{number} @:\d+ B@:\d+ W:\?"
    assert len(lines) == 5
    assert all(re.fullmatch(line, x) for x in lines)
    assert not [x for x in beside.heard if "T:" in x]


def test_automatic_temperature_reports_are_not_doubled(s):
    s.host.ok("M155 S2")
    s.host.send("M109 S60")
    s.passes(5)
    assert len([line for line in s.host.heard if " T:" in line]) == 2


def test_an_unreported_fault_ends_a_wait():
    """The thread of the link knows of it before the event loop does."""
    machine = config.load("i3")
    own = {n: h.model_copy(update={"on_fault": "heater"}) for n, h in machine.heaters.items()}
    with Scenario(machine.model_copy(update={"heaters": own})) as s:
        s.host.ok("M104 S200")
        s.passes(5)
        s.board.force_sensor("hotend", 0.0)
        s.passes(5)
        assert s.printer.rig.connection.heaters["hotend"].fault is not None
        s.printer.rig.connection.faults.clear()
        told, ok = s.host.ok("M109 S200")
        assert told.startswith("echo:heater hotend was switched off: its sensor reads")
        assert ok == "ok"


ASKED = ["prompt_button Continue", "prompt_show"]


@pytest.mark.parametrize("command", ["M600", "M601", "M25"])
@pytest.mark.parametrize("answer", ["M24", "M602", "M876 S0", "M108"])
def test_hosts_are_notified_of_a_pause_in_a_file(tmp_path, command, answer):
    (tmp_path / "a.g").write_text(f"G92 X20 Y20 Z20\nG1 X30 F6000\n{command}\nG1 X50\n")
    with Scenario("i3", card=str(tmp_path)) as s:
        s.host.ok("M23 a.g")
        s.host.ok("M24")
        s.host.expect("^// action:paused$", 20)
        s.passes(10)
        text = {
            "M600": "Change the filament, then continue with M24",
            "M601": "Paused; continue with M24",
        }
        asked = [f"prompt_begin {text[command]}", *ASKED] if command in text else []
        assert actions(s.host) == ["paused", *asked]
        if command == "M25" and answer in ("M876 S0", "M108"):
            s.host.ok(answer)  # nobody was asked
            s.host.silent(5, "resumed")
            answer = "M24"
        s.host.ok(answer)
        s.host.expect("^Done printing file$", 20)
        assert actions(s.host)[1 + len(asked) :] == [*(["prompt_end"] if asked else []), "resumed"]


@pytest.mark.parametrize("answer", ["M24", "M602", "M108", "M876 S0"])
def test_wait_for_the_user_in_a_file_ends_like_a_pause(tmp_path, answer):
    (tmp_path / "a.g").write_text("G92 X20 Y20 Z20\nG1 X30 F6000\nM0 Look\nG1 X50\n")
    with Scenario("i3", card=str(tmp_path)) as s:
        s.host.ok("M23 a.g")
        s.host.ok("M24")
        s.passes(10)
        s.host.silent(5, "Done")
        assert s.printer.status.read().question == "Look"
        assert s.host.ok(answer) == ["ok"]
        s.host.expect("^Done printing file$", 10)
        assert s.printer.status.read().question == ""
        assert actions(s.host) == ["prompt_begin Look", *ASKED, "prompt_end"]


def test_a_cancel_in_a_pause_ends_the_question_to_the_user(tmp_path):
    (tmp_path / "a.g").write_text("G92 X20 Y20 Z20\nG1 X30 F6000\nM600\nG1 X50\n")
    with Scenario("i3", card=str(tmp_path)) as s:
        s.host.ok("M23 a.g")
        s.host.ok("M24")
        s.host.expect("prompt_show", 20)
        s.host.ok("M524")
        s.passes(5)
        assert actions(s.host)[-1] == "prompt_end"
        assert "resumed" not in actions(s.host)
