"""Fans with a tachometer: their speed, and faults of fans that do not turn."""

from __future__ import annotations

import json

import pytest
from tests.support.scenario import Scenario

from passo import config
from passo.config.load import shipped_text


def machine(on_fault: str = "report", board: str = "", follows: str = ""):
    part = f"""[fans.part.tachometer]
pin = "^D11"
pulses = 3
min_rpm = 1000.0
on_fault = "{on_fault}"
simulated_rpm = 6000.0
"""
    text = shipped_text("i3").replace("[fans.part]\n", f"[fans.part]\n{follows}", 1)
    return config.load_text(text.replace("[board]\n", f"[board]\n{board}", 1) + part)


def rpm(s) -> float | None:
    return s.printer.status.read().fan_rpm["part"]


@pytest.mark.parametrize("firmware", ["", 'firmware = "passo"\n'])
def test_speed_follows_the_power(firmware):
    with Scenario(machine(board=firmware)) as s:
        s.passes(3)
        assert rpm(s) == 0.0
        for power, seconds in ((255, 5), (128, 5)):
            s.host.ok(f"M106 S{power}")
            s.passes(seconds)
            assert rpm(s) == pytest.approx(6000 * power / 255, rel=0.02)
            assert s.board.rotor_rpm("part") == pytest.approx(6000 * power / 255, rel=0.01)
        assert json.loads(s.host.ok("M408 S2")[0])["params"]["fanRPM"] == [round(rpm(s))]
        s.host.ok("M107")
        s.passes(6)
        assert rpm(s) == 0.0


@pytest.mark.parametrize("fault", ["stalled", "silent"])
def test_fan_that_does_not_turn_is_reported_once(fault):
    with Scenario(machine()) as s:
        s.host.ok("M106 S255")
        s.passes(5)
        s.host.ok(f"SIMULATE_FAULT NAME=part-fan VALUE={fault}")
        s.passes(12)
        told = [line for line in s.host.heard if "fan part has power and turns at" in line]
        assert len(told) == 1
        s.host.ok("SIMULATE_FAULT NAME=part-fan VALUE=none")
        s.passes(6)
        s.host.ok(f"SIMULATE_FAULT NAME=part-fan VALUE={fault}")
        s.passes(8)
        told = [line for line in s.host.heard if "fan part has power and turns at" in line]
        assert len(told) == 2


def test_fan_that_starts_is_no_fault():
    with Scenario(machine("machine")) as s:
        for _ in range(3):
            s.host.ok("M106 S255")
            s.passes(5)
            s.host.ok("M107")
            s.passes(5)
        assert not s.printer.state.halted


def test_fault_halts_the_printer_if_the_file_says_so():
    with Scenario(machine("machine")) as s:
        s.host.ok("SIMULATE_FAULT NAME=part-fan VALUE=stalled")
        s.host.ok("M106 S255")
        s.passes(2.9)
        assert not s.printer.state.halted
        assert s.until(lambda: bool(s.printer.state.halted), 2)
        assert "fan part" in s.printer.state.halted


def test_fan_of_a_hotend_must_turn_only_while_it_is_hot():
    with Scenario(machine(follows='follows = "hotend"\n')) as s:
        s.host.ok("SIMULATE_FAULT NAME=part-fan VALUE=stalled")
        s.passes(10)
        assert not [line for line in s.host.heard if "fan part" in line]
        s.host.ok("M104 S100")
        s.passes(60)
        assert [line for line in s.host.heard if "fan part has power and turns at 0" in line]
