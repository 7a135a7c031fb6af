"""Lines for hosts: `// action:`, with the blank that Printrun needs, and temperatures in waits."""

from __future__ import annotations

import re

import pytest
from tests.console.scenario import Host, Scenario

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
        ("M0 P2500", "Waiting; go on with M108", 2.5),
        ("M0", "Waiting; go on with M108", None),
        ("M0 Stop", "Stop", None),
    ],
)
def test_only_words_before_the_text_of_m0_count(s, line, text, seconds):
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
def test_who_waits_for_a_heater_hears_it_warm_every_second(s, wait):
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


def test_temperatures_that_come_anyway_are_not_doubled(s):
    s.host.ok("M155 S2")
    s.host.send("M109 S60")
    s.passes(5)
    assert len([line for line in s.host.heard if " T:" in line]) == 2


def test_a_fault_that_nobody_has_told_yet_ends_a_wait():
    """The thread of the link knows of it before the event loop does."""
    machine = config.load("i3")
    own = {n: h.model_copy(update={"on_fault": "heater"}) for n, h in machine.heaters.items()}
    with Scenario(machine.model_copy(update={"heaters": own})) as s:
        s.host.ok("M104 S200")
        s.passes(5)
        s.board.force_sensor("hotend", 0.0)
        s.passes(5)
        assert s.printer.connection.heaters["hotend"].fault is not None
        s.printer.connection.faults.clear()
        told, ok = s.host.ok("M109 S200")
        assert told.startswith("echo:heater hotend was switched off: its sensor is short-circuited")
        assert ok == "ok"
