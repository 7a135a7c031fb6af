"""Tones of a beeper, as the pins of the simulated board show them."""

from array import array
from itertools import pairwise

import pytest
from tests.job.test_adopted import killed
from tests.support.scenario import Host, Scenario

from passo import config
from passo.board.ports import InProcess
from passo.errors import ConfigError
from passo.printer.setup import connections as wiring

PIN = "D12"
APART_S = 0.25  # from the end of a tone to the next, at least


def machine(pin=PIN, board="", more=""):
    """An i3 with a beeper; `board` are lines of its board's table."""
    text = config.shipped_text("i3").replace("[board]\n", f"[board]\n{board}\n")
    return config.load_text(f'{text}\n[beeper]\npin = "{pin}"\n{more}')


@pytest.fixture
def s():
    with Scenario(machine()) as scenario:
        scenario.host.ok("G92 X20 Y20 Z20")
        scenario.board.trace_output("beeper")
        yield scenario


def tones(s, off=0):
    """(Hz, s, begin in s) of all tones since the last call, each over."""
    hz = s.machine.board.clock_hz
    changes = s.board.take_changes("beeper")
    assert len(changes) % 2 == 0
    found = []
    for (begin, on), (end, over) in zip(changes[::2], changes[1::2], strict=True):
        assert (on > 0, over == 0) == (True, not off)
        found.append((round(hz / 2 / on), round((end - begin) / hz, 4), begin / hz))
    return found


def heard(s):
    return [tone[:2] for tone in tones(s)]


# -- tones ----------------------------------------------------------------------------------------


def test_m300_has_its_frequency_and_duration(s):
    assert s.host.ok("M300 S440 P200") == ["ok"]
    s.passes(1)
    assert heard(s) == [(440, 0.2)]
    assert s.host.ok("M300") == ["ok"]
    s.passes(2)
    assert heard(s) == [(260, 1.0)]


def test_a_melody_comes_in_order(s):
    """The rest of 0.5 s lies between the second tone and the third."""
    s.host.send("M300 S262 P100", "M300 S330 P150", "M300 S0 P500", "M300 S392 P300")
    s.passes(5)
    found = tones(s)
    assert [tone[:2] for tone in found] == [(262, 0.1), (330, 0.15), (392, 0.3)]
    ends = [begin + seconds for _, seconds, begin in found]
    silence = [begin - end for end, (*_, begin) in zip(ends, found[1:], strict=False)]
    assert silence[0] == pytest.approx(APART_S, abs=0.05)
    assert silence[1] == pytest.approx(0.5, abs=0.001)


def test_tone_is_played_in_order_with_moves(s):
    """And the moves do not wait for it."""
    hz = s.machine.board.clock_hz
    s.host.send("G1 X50 F1800", "M300 S440 P2000", "G1 X80")
    s.until(lambda: not s.printer.rig.queue.standing, 1)
    s.until(lambda: s.printer.rig.queue.standing, 10)
    moved_s = s.printer.rig.connection.now / hz
    s.passes(3)
    ((_, seconds, begin),) = tones(s)
    assert seconds == 2.0
    assert begin == pytest.approx(moved_s - 1.0 + APART_S, abs=0.1)
    assert s.positions()["x"] == 80.0


def test_tones_do_not_change_the_steps():
    def clocks(line):
        with Scenario(machine()) as s:
            s.host.ok("G92 X20 Y20 Z20")
            s.board.trace_steps("x", 0, 1 << 40)
            s.host.send("G1 X40 F6000", line, "G1 X60", "G1 X20")
            s.passes(5)
            first, *more = array("q", s.board.take_steps("x", 0, 1 << 40)[0])
            return [clock - first for clock in more]

    silent, loud = clocks("M118 nothing"), clocks("M300 S1000 P1000")
    assert len(silent) == 6399
    assert loud == silent


def test_tone_above_the_boards_maximum_is_limited(s):
    """A tone too high is no reason to stop a print; it is told once."""
    told = s.host.ok("M300 S4000 P9000")
    assert told == ["echo:M300: a tone has at most 1000 Hz and 5000 ms here", "ok"]
    assert s.host.ok("M300 S5 P100") == ["ok"]
    assert s.host.ok("M300 S1001 P1") == ["ok"]
    s.passes(8)
    assert heard(s) == [(1000, 5.0), (20, 0.1), (1000, 0.001)]


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ("M300 S-1", "S is -1: expected at least 0 Hz"),
        ("M300 P-5", "P is -5: expected at least 0 ms"),
    ],
)
def test_negative_tone_parameters_are_refused(s, line, sentence):
    assert sentence in s.host.ok(line)[0]
    s.passes(2)
    assert heard(s) == []


def test_sender_waits_if_many_tones_are_queued(s):
    """So a file of nothing but tones is as long as its melody."""
    s.host.send(*["M300 S440 P10"] * 100)
    s.passes(3)
    assert 64 <= sum(x.startswith("ok") for x in s.host.heard) < 100
    s.until(lambda: s.host.heard.count("ok") == 101, 30)
    s.passes(30)
    assert heard(s) == [(440, 0.01)] * 100


# -- who ends it ----------------------------------------------------------------------------------


def test_stop_also_ends_pauses_between_tones(s):
    s.host.send(*["M300 S0 P5000"] * 10)
    s.passes(1)
    s.host.ok("M410")
    s.host.ok("M300 S440 P100")
    s.passes(2)
    assert heard(s) == [(440, 0.1)]


@pytest.mark.parametrize("stop", ["M410", "M112"])
def test_stop_drops_queued_tones(s, stop):
    s.host.send("M300 S500 P400", "M300 S600 P400", "G1 X35 F600", "M300 S700")
    s.passes(0.6)
    s.host.send(stop)
    s.passes(8)
    found = heard(s)
    assert [pitch for pitch, _ in found] == [500]
    assert found[0][1] == 0.4 if stop == "M410" else found[0][1] < 0.4
    assert s.board.output_value("beeper") == 0
    if stop == "M112":
        s.host.send("M999")
        s.host.expect("ready again", 10)
        s.board.trace_output("beeper")
    s.host.ok("M300 S800 P100")
    s.passes(1)
    assert heard(s)[-1] == (800, 0.1)


def test_user_prompt_beeps_once(s):
    s.host.send("M0 Look here")
    s.passes(2)
    assert heard(s) == [(1000, 0.3)]
    s.host.ok("M108")
    s.passes(2)
    assert heard(s) == []


def test_a_change_of_filament_beeps(s):
    s.host.ok("M302 P1")
    s.host.send("M600 B3")
    s.passes(20)
    assert heard(s) == [(1000, 0.3)]
    assert not [x for x in s.host.heard if "M600 beeps not" in x]
    Host(s).ok("M108")


# -- boards ---------------------------------------------------------------------------------------

OWN = 'firmware = "passo"'  # the board runs Passo's firmware


def pulses(s, seconds):
    """(Hz, s) of a tone, from the edges at the pin of a board with firmware."""
    names = s.printer.rig.connection.main.dictionary.enumerations["pin"]
    pin = names[s.machine.pin(PIN)]
    s.board.device.trace_edges(pin)
    s.passes(seconds)
    found = s.board.device.take_edges(pin)
    clock_hz = s.machine.board.clock_hz
    rises = [clock for clock, level in found if level == 1]
    (period,) = {b - a for a, b in pairwise(rises)}
    assert found[-1][1] == 0
    # It ends low for the rest of its last cycle.
    return clock_hz / period, round((found[-1][0] - rises[0] + period / 2) / clock_hz, 4)


def test_firmware_board_plays_the_edges_of_a_tone():
    with Scenario(machine(board=OWN)) as s:
        s.host.send("M300 S500 P200")
        assert pulses(s, 1) == (500.0, 0.2)


@pytest.mark.parametrize("away_s", [0.5, 5])
@pytest.mark.parametrize("lines", [("G1 X21", "M300 S500 P1000"), ("M300 S500 P1000", "G1 X60")])
def test_tone_ends_while_link_is_lost(away_s, lines):
    """A board that goes on alone has the end of the tone, at rest and while it brakes."""
    with Scenario(machine(board=OWN)) as s:
        port, queue = s.printer.rig.connection.main.port, s.printer.rig.queue
        s.host.ok("G92 X20 Y20 Z20")
        s.board.trace_output("beeper")
        s.host.send("G1 F600", *lines)
        s.until(lambda: s.board.output_value("beeper") > 0, 5)
        port.unplug()
        s.passes(away_s)
        port.plug(queue.base + queue.now)
        s.board.device.poll(queue.base + queue.now)
        s.host.expect("The board is back", 10)
        s.passes(10)
        ((pitch, seconds),) = heard(s)
        assert (pitch, seconds <= 1.0) == (500, True), seconds
        assert s.printer.state.halted == ""
        s.host.ok("M300 S600 P100")
        s.passes(1)
        assert heard(s) == [(600, 0.1)]


def test_board_without_host_ends_the_tone():
    """One that cannot go on without its host: the printer halts, the tone ends in time."""
    with Scenario(machine()) as s:
        s.board.trace_output("beeper")
        s.host.send("M300 S500 P2000")
        s.until(lambda: s.board.output_value("beeper") > 0, 5)
        s.printer.rig.connection.main.port.unplug()
        s.board.device.poll(s.printer.rig.connection.now + 4 * s.machine.board.clock_hz)
        assert heard(s) == [(500, 2.0)]
        s.host.expect("Printer halted: the connection to the board has ended", 20)


def test_tone_of_the_previous_host_ends(monkeypatch):
    """A board that another host has left alone has its end; the next tone comes behind it."""
    before = Scenario(machine(board=OWN))
    before.board.trace_output("beeper")
    before.host.send("M300 S500 P4000")
    assert before.until(lambda: before.board.output_value("beeper") > 0, 5)
    board, clock = killed(before)
    assert board.output_value("beeper") > 0

    def connect(machine):
        ports = [InProcess(board.device, clock)]
        return wiring._connected(wiring.board_descriptions(machine), ports, adopt=True), board

    monkeypatch.setattr("passo.printer.printer.connect", connect)
    with Scenario(machine(board=OWN)) as s:
        assert s.printer.rig.connection.adopted
        s.host.ok("M300 S600 P100")
        s.passes(8)
        assert board.device.fault == ""
        assert heard(s) == [(500, 4.0), (600, 0.1)]


def test_beeper_on_a_further_board_sounds():
    more = '[boards.tool]\nbase = "ramps"\n'
    with Scenario(machine(pin="tool:D12", more=more)) as s:
        s.board.trace_output("beeper")
        s.host.send("M300 S440 P200", "M300 S0 P300", "M300 S880 P100")
        s.passes(2)
        found = tones(s)
        assert [tone[:2] for tone in found] == [(440, 0.2), (880, 0.1)]
        assert found[1][2] - found[0][2] == pytest.approx(0.5, abs=0.001)


def test_a_faster_board_reaches_higher_tones():
    more = '[boards.tool]\nbase = "radds"\n'
    with Scenario(machine(pin="tool:D41", more=more)) as s:
        s.board.trace_output("beeper")
        assert s.host.ok("M300 S4000 P100") == ["ok"]
        s.passes(1)
        (_, on), (_, off) = s.board.take_changes("beeper")
        assert (on, off) == (s.machine.boards["tool"].clock_hz // 8000, 0)
        assert "at most 5000 Hz" in s.host.ok("M300 S6000")[0]


# -- the machine file -----------------------------------------------------------------------------


def test_beeper_pin_cannot_be_used():
    with pytest.raises(ConfigError, match=r"beeper\.pin"):
        machine(pin="D10")  # the hotend's
    with pytest.raises(ConfigError, match=r"beeper\.pin.*a pin of"):
        machine(pin="D999")


def test_beeper_of_a_display_is_used():
    fitted = 'fitted = ["reprap-discount-smart"]'
    assert machine(pin="D37", board=fitted).beeper.pin == "D37"
    with pytest.raises(ConfigError, match=r"beeper\.pin"):
        machine(pin="D35", board=fitted)  # its button


def test_output_with_inverter_is_off_at_high_level():
    with Scenario(machine(pin=f"!{PIN}")) as s:
        assert s.board.output_value("beeper") == s.machine.board.clock_hz // 1000
        s.board.trace_output("beeper")
        s.host.ok("M300 S500 P100")
        s.passes(1)
        (begin, on), (end, over) = s.board.take_changes("beeper")
        assert over == 2 * on == s.machine.board.clock_hz // 500
        assert (end - begin) / s.machine.board.clock_hz == pytest.approx(0.1)
