"""Outputs that the machine file names: SET_PIN, M42, M240, M355."""

from __future__ import annotations

from array import array
from functools import partial

import pytest
from tests.support.scenario import Scenario

from passo import config
from passo.config.load import shipped_text
from passo.errors import ConfigError
from passo.printer.setup.connections import connect_simulated
from passo.simulator import Cable

HZ = 16_000_000
FULL = HZ // 100  # ticks of a cycle of 100 Hz
OUTPUTS = """[outputs.lamp]
pin = "D11"
pwm = "software"
pwm_hz = 100.0
start = 0.25
scale = 255.0
use = "light"
[outputs.Relay]
pin = "!D6"
number = 4
at_halt = 1.0
[outputs.shutter]
pin = "D5"
use = "camera"
[outputs.enable]
pin = "D4"
start = 1.0
at_halt = 1.0
fixed = true
"""


def machine(outputs: str = OUTPUTS):
    return config.load_text(shipped_text("i3").replace("[fans.part]", f"{outputs}[fans.part]"))


@pytest.fixture
def s():
    with Scenario(machine()) as s:
        s.passes(1)
        yield s


def value(s, name: str) -> int:
    level = s.board.output_value(f"outputs.{name}")
    return 1 - level if name == "Relay" else level  # its pin is inverted


def status(s) -> dict[str, float]:
    return s.printer.status.read().outputs


def test_outputs_start_with_their_values(s):
    names = ("lamp", "Relay", "shutter", "enable")
    assert [value(s, name) for name in names] == [FULL // 4, 0, 0, 1]
    assert status(s) == {"lamp": 0.25, "Relay": 0.0, "shutter": 0.0}


def test_set_pin_counts_to_the_scale_in_any_case_of_the_name(s):
    s.host.ok("SET_PIN PIN=lamp VALUE=51")
    s.host.ok("SET_PIN PIN=relay VALUE=1")
    assert s.until(lambda: value(s, "Relay") == 1, 1)
    assert value(s, "lamp") == FULL // 5
    assert status(s)["lamp"] == pytest.approx(0.2)


def test_output_changes_after_the_moves_before_it(s):
    s.host.ok("G92 X0 Y0 Z0")
    s.board.trace_output("outputs.Relay")
    s.board.trace_steps("x", 0, 1 << 62)
    s.host.send("G1 X10 F3000", "SET_PIN PIN=Relay VALUE=1", "G1 X15", "M400")
    s.passes(3)
    [(clock, _)] = s.board.take_changes("outputs.Relay")
    clocks = array("q", s.board.take_steps("x", 0, 1 << 62)[0])
    per_mm = s.machine.steppers["x"].steps_per_unit
    assert len(clocks) == pytest.approx(15 * per_mm, abs=1)
    assert sum(one <= clock for one in clocks) == pytest.approx(10 * per_mm, abs=1)


def test_two_changes_without_a_move_are_a_pulse_of_a_tenth(s):
    s.board.trace_output("outputs.shutter")
    s.host.send("G92 X0", "G1 X5 F3000", "SET_PIN PIN=shutter VALUE=1")
    s.host.send("SET_PIN PIN=shutter VALUE=0", "G1 X10", "SET_PIN PIN=shutter VALUE=1", "M400")
    s.passes(3)
    (on, high), (off, low), (again, _) = s.board.take_changes("outputs.shutter")
    assert (high, low) == (1, 0)
    assert (off - on) / HZ == pytest.approx(0.1, abs=0.002)
    assert (again - off) / HZ > 0.1  # after the second move, without another pause
    assert status(s)["shutter"] == 1.0


def test_two_values_of_a_pulsed_output_without_a_move_are_the_last(s):
    s.board.trace_output("outputs.lamp")
    s.host.send("SET_PIN PIN=lamp VALUE=204", "SET_PIN PIN=lamp VALUE=51", "M400")
    s.passes(2)
    assert [value for _, value in s.board.take_changes("outputs.lamp")] == [FULL // 5]


HARDWARE = """[outputs.heat]
pin = "SERVO3"
pwm = "hardware"
pwm_hz = 1000.0
start = 0.2
at_halt = 0.4
"""


@pytest.mark.parametrize("firmware", ["passo", "klipper"])
def test_hardware_pwm_starts_changes_and_halts_at_its_values(firmware: str):
    parts = machine(HARDWARE)
    board = parts.board.model_copy(update={"firmware": firmware})
    with Scenario(parts.model_copy(update={"board": board})) as s:
        s.passes(1)
        assert s.board.output_value("outputs.heat") == 51  # of 255
        s.host.ok("SET_PIN PIN=heat VALUE=0.5")
        assert s.until(lambda: s.board.output_value("outputs.heat") == 128, 1)
        s.host.send("M112")
        s.passes(1)
        assert s.board.output_value("outputs.heat") == 102
        s.host.ok("M999", 30)
        s.passes(1)
        assert s.board.output_value("outputs.heat") == 51


LIMITED = """[outputs.pump]
pin = "D11"
max_on_s = 1.0
[outputs.lamp]
pin = "D6"
"""


@pytest.mark.parametrize("firmware", ["passo", "klipper"])
def test_lost_link_ends_an_output_with_a_longest_time(monkeypatch, firmware: str):
    cable = partial(connect_simulated, cable=Cable(2e-4, 1e-4))
    monkeypatch.setattr("passo.printer.printer.connect", cable)
    parts = machine(LIMITED)
    board = parts.board.model_copy(update={"firmware": firmware})
    with Scenario(parts.model_copy(update={"board": board})) as s:
        s.host.ok("SET_PIN PIN=pump VALUE=1")
        s.host.ok("SET_PIN PIN=lamp VALUE=1")
        s.passes(5)  # the host renews it
        assert [s.board.output_value(f"outputs.{n}") for n in ("pump", "lamp")] == [1, 1]
        s.board.cut_cable("")
        s.passes(3)
        values = [s.board.output_value(f"outputs.{n}") for n in ("pump", "lamp")]
        assert values == [0, int(firmware == "passo")]  # other firmware has shut down


@pytest.mark.parametrize(
    ("line", "limit"),
    [
        ("SET_PIN PIN=lamp VALUE=256", "0 to 255"),
        ("SET_PIN PIN=Relay VALUE=0.5", "0 or 1: outputs.Relay has no pwm"),
        ("SET_PIN PIN=lamb VALUE=1", "lamp, Relay, shutter"),
        ("SET_PIN PIN=enable VALUE=0", "lamp, Relay, shutter"),
        ("M42 P5 S1", "4"),
    ],
)
def test_impossible_values_are_refused_with_the_possible_ones(s, line, limit):
    assert limit in s.host.ok(line)[0]
    assert value(s, "enable") == 1


def test_m42_sets_the_output_with_its_number(s):
    s.host.ok("M42 P4 S1")
    assert s.until(lambda: value(s, "Relay") == 1, 1)
    s.host.ok("M42 P4 S0")
    assert s.until(lambda: value(s, "Relay") == 0, 1)


def test_m355_switches_the_light_and_keeps_its_brightness(s):
    assert s.host.ok("M355 S1 P102")[0] == "echo:Case light: 102"
    assert s.until(lambda: value(s, "lamp") == 2 * FULL // 5, 1)
    assert s.host.ok("M355 S0")[0] == "echo:Case light: OFF"
    assert s.until(lambda: value(s, "lamp") == 0, 1)
    s.host.ok("M355 S1")
    assert s.until(lambda: value(s, "lamp") == 2 * FULL // 5, 1)


def test_m240_switches_the_camera_on_for_a_tenth_of_a_second(s):
    s.board.trace_output("outputs.shutter")
    s.host.ok("M240")
    s.passes(2)
    (on, high), (off, low) = s.board.take_changes("outputs.shutter")
    assert (high, low) == (1, 0)
    assert (off - on) / HZ == pytest.approx(0.1, abs=0.002)


def test_halted_board_has_the_values_for_a_halt(s):
    s.host.ok("SET_PIN PIN=lamp VALUE=255")
    s.passes(1)
    s.host.send("M112")
    s.passes(1)
    names = ("lamp", "Relay", "shutter", "enable")
    assert [value(s, name) for name in names] == [0, 1, 0, 1]
    assert status(s) == {"lamp": 0.0, "Relay": 1.0, "shutter": 0.0}
    s.host.ok("M999", 30)
    s.passes(1)
    assert [value(s, name) for name in names] == [FULL // 4, 0, 0, 1]


def test_macros_read_what_a_line_before_has_set():
    text = """[macros.TOGGLE]
gcode = "SET_PIN PIN=Relay VALUE={1 - printer['output_pin Relay'].value|int}"
"""
    with Scenario(machine(OUTPUTS + text)) as s:
        s.host.ok("TOGGLE")
        assert s.until(lambda: value(s, "Relay") == 1, 1)
        s.host.ok("TOGGLE")
        assert s.until(lambda: value(s, "Relay") == 0, 1)


def test_a_machine_without_outputs_names_what_is_missing():
    with Scenario() as s:
        assert "The machine file has no output for it" in s.host.ok("SET_PIN PIN=x VALUE=1")[0]


@pytest.mark.parametrize(
    ("old", "new", "limit"),
    [
        ("at_halt = 1.0\n[outputs.sh", "at_halt = 0.5\n[outputs.sh", "0 or 1"),
        ('use = "camera"', 'use = "light"', "belongs to outputs.lamp"),
        ("start = 1.0", "start = 0.5", "0 or 1 without pwm"),
        ("number = 4", "number = 4\nmax_on_s = 1.0", "the value of start"),
        ('pin = "D5"', 'pin = "D6"', "a pin of its own"),
        ("pwm_hz = 100.0", "pwm_hz = 1000.0", "at most 250 Hz"),
    ],
)
def test_impossible_outputs_are_refused_by_the_machine_file(old, new, limit):
    assert old in OUTPUTS
    with pytest.raises(ConfigError, match=limit):
        machine(OUTPUTS.replace(old, new))


JOINED = """[outputs.pair]
pin = "D11"
further_pins = ["!D6"]
pwm = "software"
pwm_hz = 100.0
[fans.twin]
pin = "D5"
further_pins = ["D4"]
number = 3
"""


def test_further_pins_switch_with_the_first_one():
    text = shipped_text("i3").replace("[fans.part]", f"{JOINED}[fans.part]")
    text = text.replace("[heaters.bed]", '[heaters.bed]\nfurther_pins = ["D44"]')
    with Scenario(config.load_text(text)) as s:
        s.passes(1)
        s.host.ok("SET_PIN PIN=pair VALUE=0.5")
        s.host.ok("M106 P3 S255")
        s.host.ok("M140 S60")
        assert s.until(lambda: s.board.output_value("outputs.pair") == FULL // 2, 1)
        assert s.board.output_value("outputs.pair+1") == FULL - FULL // 2
        fans = [s.board.output_value(name) for name in ("twin", "twin+1")]
        assert fans[0] == fans[1] > 0
        assert s.until(lambda: s.board.output_value("bed") > 0, 2)
        assert s.board.output_value("bed+1") == s.board.output_value("bed")
        s.host.send("M112")
        s.host.expect("halted", 5)
        assert [s.board.output_value(name) for name in ("bed", "bed+1", "twin", "twin+1")] == [
            0
        ] * 4


def test_further_pin_of_another_board_is_refused():
    pair = JOINED.replace('["!D6"]', '["!D6", "tool:PA1"]')
    tool = '[boards.tool]\nbase = "klipper"\nclock_hz = 16_000_000\n'
    with pytest.raises(ConfigError) as caught:
        config.load_text(shipped_text("i3").replace("[fans.part]", f"{pair}[fans.part]") + tool)
    limit = "expected a pin of the board of outputs.pair.pin, the main one"
    assert any(limit in str(problem) for problem in caught.value.problems)
