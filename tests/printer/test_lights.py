"""Coloured lights: SET_LED, M150, and the frames that boards receive."""

from __future__ import annotations

from array import array
from itertools import pairwise

import pytest
from tests.support.scenario import Scenario

from passo import config
from passo.config.load import shipped_text
from passo.errors import ConfigError

HZ = 16_000_000
LIGHTS = """[lights.head]
kind = "neopixel"
pin = "D11"
count = 3
start = [0.0, 0.0, 0.2]
[lights.Bar]
kind = "neopixel"
pin = "D6"
count = 75
order = "RGBW"
[lights.case]
kind = "led"
red_pin = "D5"
white_pin = "D4"
pwm_hz = 100.0
start = [0.0, 0.0, 0.0, 0.25]
"""
BUSES = """[lights.strip]
kind = "dotstar"
data_pin = "D11"
clock_pin = "D6"
count = 3
start = [1.0, 0.0, 0.0]
[lights.lamp]
kind = "pca9632"
scl_pin = "D5"
sda_pin = "D4"
order = "BGRW"
"""
DARK, BLUE = (0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.2, 0.0)


def machine(lights: str = LIGHTS, firmware: str = ""):
    text = shipped_text("i3").replace("[fans.part]", f"{lights}[fans.part]")
    return config.load_text(text.replace("[board]\n", f"[board]\n{firmware}"))


@pytest.fixture(params=["virtual", "passo"])
def s(request):
    with Scenario(
        machine(firmware='firmware = "passo"\n' if request.param == "passo" else "")
    ) as s:
        s.passes(1)
        yield s


def test_lights_start_with_their_colours(s):
    assert s.board.light("head") == bytes((0, 0, 51)) * 3  # in the order GRB
    assert s.board.light("Bar") == bytes(300)
    assert s.board.output_value("lights.case.white") == HZ // 100 // 4
    assert s.printer.status.read().lights["head"] == ((0.0, 0.0, 0.2, 0.0),) * 3


def test_set_led_sets_one_led_or_all_in_any_case(s):
    s.host.ok("SET_LED LED=HEAD RED=1 GREEN=0.5")
    s.host.ok("SET_LED LED=head BLUE=1 INDEX=2")
    assert s.until(lambda: s.board.light("head")[5] == 255, 1)
    assert s.board.light("head") == bytes((128, 255, 0, 0, 0, 255, 128, 255, 0))
    s.host.ok("SET_LED LED=case RED=0.5")
    assert s.until(lambda: s.board.output_value("lights.case.red") == HZ // 100 // 2, 1)
    assert s.board.output_value("lights.case.white") == 0


def test_light_without_transmit_shows_with_its_next_change(s):
    s.host.ok("SET_LED LED=head RED=1 INDEX=1 TRANSMIT=0")
    s.passes(1)
    assert s.board.light("head") == bytes((0, 0, 51)) * 3
    s.host.ok("SET_LED LED=head GREEN=1 INDEX=2")
    s.passes(1)
    assert s.board.light("head") == bytes((0, 255, 0, 255, 0, 0, 0, 0, 51))


def test_light_changes_after_the_moves_before_it(s):
    s.host.ok("G92 X0 Y0 Z0")
    s.board.trace_light("head")
    s.board.trace_steps("x", 0, 1 << 62)
    s.host.send("G1 X10 F3000", "SET_LED LED=head RED=1", "G1 X15", "M400")
    s.passes(3)
    [(clock, frame)] = s.board.take_light("head")
    clocks = array("q", s.board.take_steps("x", 0, 1 << 62)[0])
    per_mm = s.machine.steppers["x"].steps_per_unit
    assert frame == bytes((0, 255, 0)) * 3
    done_mm = sum(one <= clock for one in clocks) / per_mm
    assert 10 <= done_mm <= 13  # the frame may take 50 ms


def test_light_without_sync_does_not_wait_for_moves(s):
    s.host.ok("G92 X0 Y0 Z0")
    s.host.send("G1 X20 F600", "SET_LED LED=head RED=1 SYNC=0")
    s.passes(1)
    assert s.board.light("head") == bytes((0, 255, 0)) * 3


def test_only_ten_frames_a_second_and_the_last_state_wins(s):
    s.board.trace_light("Bar")
    for i in range(100):
        s.host.ok(f"SET_LED LED=Bar RED={i / 99} SYNC=0")
        s.passes(0.01)
    s.passes(1)
    frames = s.board.take_light("Bar")
    gaps_s = [(b - a) / HZ for (a, _), (b, _) in pairwise(frames)]
    assert len(frames) >= 5
    assert min(gaps_s) >= 0.1 - 1e-6
    assert frames[-1][1] == bytes((255, 0, 0, 0)) * 75


def test_a_frame_that_is_late_is_sent_again(s):
    s.board.fail_light("head", 7)
    s.host.ok("SET_LED LED=head RED=1")
    s.passes(3)
    assert s.board.light("head") == bytes((0, 255, 0)) * 3


def test_a_light_that_is_always_late_is_reported_once(s):
    s.board.fail_light("head", 1000)
    s.host.ok("SET_LED LED=head RED=1")
    s.passes(5)
    told = [line for line in s.host.heard if "light head" in line]
    assert len(told) == 1
    s.board.fail_light("head", 0)
    s.host.ok("SET_LED LED=head GREEN=1")
    s.passes(2)
    assert s.board.light("head") == bytes((255, 0, 0)) * 3


def test_stopped_plan_keeps_the_colours_that_are_shown(s):
    s.host.ok("G92 X0 Y0 Z0")
    s.host.send("G1 X20 F600", "SET_LED LED=head RED=1")
    s.passes(1)
    s.host.send("M410")
    s.passes(2)
    assert s.board.light("head") == bytes((0, 0, 51)) * 3
    assert s.printer.status.read().lights["head"][0] == (0.0, 0.0, 0.2, 0.0)


def test_lights_show_their_start_after_a_restart(s):
    s.host.ok("SET_LED LED=head RED=1")
    s.passes(1)
    s.host.send("M112")
    s.passes(1)
    assert s.board.light("head") == bytes((0, 255, 0)) * 3  # kept during the halt
    s.host.send("M999")
    s.passes(4)
    assert s.board.light("head") == bytes((0, 0, 51)) * 3


@pytest.mark.parametrize(
    ("line", "colors"),
    [
        ("M150 R255 U128", [(1.0, 128 / 255, 0.0, 0.0)] * 3),
        ("M150 B255 P51", [(0.0, 0.0, 0.2, 0.0)] * 3),
        ("M150 R I1 K", [BLUE, (1.0, 0.0, 0.2, 0.0), BLUE]),
        ("M150", [DARK] * 3),
    ],
)
def test_m150_counts_to_255(s, line, colors):
    s.host.ok(line)
    s.passes(1)
    assert list(s.printer.status.read().lights["head"]) == [pytest.approx(c) for c in colors]


@pytest.mark.parametrize(
    ("line", "limit"),
    [
        ("SET_LED LED=haed RED=1", "head, Bar, case"),
        ("SET_LED LED=head RED=2", "0 to 1"),
        ("SET_LED LED=head RED=1 INDEX=4", "1 to 3"),
        ("M150 R255 I3", "0 to 2"),
        ("M150 R255 S3", "0 to 2"),
    ],
)
def test_wrong_values_name_their_limit(s, line, limit):
    s.host.ok(line)
    assert any(limit in answer for answer in s.host.heard)


@pytest.mark.parametrize("firmware", ["", 'firmware = "passo"\n'])
def test_lights_on_buses_show_their_colours(firmware):
    with Scenario(machine(BUSES, firmware)) as s:
        s.passes(1)
        assert s.board.light("strip") == bytes((255, 0, 0, 255)) * 3
        s.host.ok("SET_LED LED=strip GREEN=1 INDEX=2")
        s.host.ok("SET_LED LED=lamp RED=1 BLUE=0.5 WHITE=0.2")
        s.passes(1)
        assert s.board.light("strip") == bytes((255, 0, 0, 255, 255, 0, 255, 0, 255, 0, 0, 255))
        chip = s.board.led_chip("lamp")
        assert [chip.register(at) for at in range(2, 6)] == [128, 0, 255, 51]
        assert chip.register(8) == 0xAA  # each output follows its brightness


def test_chain_of_different_leds_has_the_order_of_each():
    mixed = 'kind = "neopixel"\npin = "D6"\ncount = 2\norders = ["GRB", "RGBW"]\n'
    with Scenario(machine(f"[lights.mixed]\n{mixed}")) as s:
        s.host.ok("SET_LED LED=mixed RED=1 WHITE=0.2")
        s.passes(1)
        assert s.board.light("mixed") == bytes((0, 255, 0, 255, 0, 0, 51))


def test_chip_with_four_steps_shows_the_nearest():
    with Scenario(machine(BUSES.replace("pca9632", "pca9533"))) as s:
        s.host.ok("SET_LED LED=lamp RED=1 GREEN=0.7 BLUE=0.3 WHITE=0.1")
        s.passes(1)
        chip = s.board.led_chip("lamp")
        assert [chip.register(at) for at in range(1, 5)] == [0, 85, 0, 171]
        assert chip.register(5) == 0b00_01_11_10  # white, red, green, blue


@pytest.mark.parametrize(
    ("changes", "limit"),
    [
        ('orders = ["RGB", "GRB"]', "one order for each of the 1 LEDs"),
        ('order = "RRB"', "a permutation of RGB or RGBW"),
        ("count = 167", "at most"),
        ("start = [2.0, 0.0, 0.0]", "1"),
    ],
)
def test_a_chain_that_no_board_can_have_is_refused(changes, limit):
    with pytest.raises(ConfigError, match=limit):
        machine(f'[lights.a]\nkind = "neopixel"\npin = "D11"\n{changes}\n')
