"""A hotend with a thermocouple or a platinum resistor behind a converter, through the wires of the
board."""

from __future__ import annotations

import re

import pytest
from tests.support.scenario import Scenario

from passo import config
from passo.config.load import shipped_text
from passo.errors import ConfigError

SENSOR = """sensor_pin = "D49"
sensor = {{ kind = "{kind}", clock_pin = "D47", miso_pin = "D45", mosi_pin = "D43" }}
"""


def text(kind: str = "max31855", firmware: str = "virtual", policy: str = "machine") -> str:
    sensor = SENSOR.format(kind=kind) + f'on_fault = "{policy}"\n'
    text = shipped_text("i3").replace('sensor_pin = "T0"\n', sensor, 1)
    return f'{text}firmware = "{firmware}"\n'


@pytest.fixture(params=["virtual", "passo"])
def firmware(request):
    return request.param


@pytest.fixture(params=["max31855", "max31856", "max31865", "max6675"])
def s(request, firmware):
    with Scenario(config.load_text(text(request.param, firmware), "t.toml")) as scenario:
        yield scenario


def test_a_hotend_is_heated_by_its_thermocouple(s):
    told = re.match(r"ok T:(\S+) /0.00", s.host.ok("M105")[-1])
    assert told and float(told[1]) == pytest.approx(25, abs=0.02)  # a MAX31865 counts 1/32 °C
    assert s.host.ok("M109 S200", 300)[-1] == "ok"
    s.passes(60)
    assert s.board.temperature("hotend") == pytest.approx(200, abs=1)
    assert s.printer.rig.connection.heaters["hotend"].celsius == pytest.approx(200, abs=0.5)


def test_an_open_thermocouple_switches_off_within_a_second(s):
    s.host.ok("M104 S200")
    s.passes(20)
    s.board.force_sensor("hotend", 1.0)
    s.passes(1.0)
    assert s.printer.state.halted.startswith("heater hotend was switched off: its sensor reads")
    assert "means a broken cable" in s.printer.state.halted
    s.passes(0.1)
    assert s.board.output_value("hotend") == 0


def test_a_board_without_another_sensor_outlives_its_fault():
    """A board refuses to keep warm what no sensor watches."""
    machine = text("max31855", "passo", "heater")
    begin, end = machine.index("[heaters.bed]"), machine.index("[fans.part]")
    with Scenario(config.load_text(machine[:begin] + machine[end:], "t.toml")) as s:
        s.host.ok("M109 S200", 300)
        s.passes(60)
        s.board.force_sensor("hotend", 1.0)
        s.host.expect("heater hotend was switched off", 5)
        s.passes(60)
        assert s.board.device.fault == "" and not s.printer.state.halted


@pytest.mark.parametrize("kind", ["max31855", "max31865"])
def test_heater_policy_keeps_machine_alive_until_rearmed(firmware, kind):
    """A MAX31865 keeps a fault until it is told to forget it."""
    machine = config.load_text(text(kind, firmware, "heater"), "t.toml")
    with Scenario(machine) as s:
        s.host.ok("M104 S200")
        s.passes(20)
        s.board.force_sensor("hotend", 0.0)
        s.host.expect(
            "heater hotend was switched off: its sensor reads .* short circuit in its cable", 1
        )
        s.passes(10)
        assert not s.printer.state.halted
        s.board.force_sensor("hotend", None)
        s.passes(1)
        s.host.ok("M922")
        s.host.ok("M109 S100", 300)


@pytest.mark.parametrize(("kind", "settings"), [("max31856", (0x91, 3)), ("max31865", (0xC3, 0))])
def test_a_converter_with_registers_is_set_up(firmware, kind, settings):
    with Scenario(config.load_text(text(kind, firmware), "t.toml")) as s:
        (board,) = s.board.boards.values()
        chip = board.converters["hotend"]
        assert (chip.setting(0), chip.setting(1)) == settings


@pytest.mark.parametrize("kind", ["max31856", "max31865"])
@pytest.mark.parametrize(("ratio", "word"), [(1.0, "a broken cable"), (0.0, "a short circuit")])
def test_thermocouple_faults_have_sentences(firmware, kind, ratio, word):
    with Scenario(config.load_text(text(kind, firmware), "t.toml")) as s:
        s.passes(1)
        s.board.force_sensor("hotend", ratio)
        s.passes(1.0)
        assert s.printer.state.halted.startswith(
            "heater hotend was switched off: its sensor reads "
        )
        assert f"means {word}" in s.printer.state.halted


def test_thermocouple_pins_must_be_free():
    for old, new in (("D49", "D10"), ("D47", "D10"), ("D45", "D47")):
        with pytest.raises(ConfigError, match="a pin of its own"):
            config.load_text(text().replace(f'"{old}"', f'"{new}"', 1), "t.toml")
    with pytest.raises(ConfigError, match=r"heaters\.hotend\.sensor_pin is missing"):
        config.load_text(text().replace('sensor_pin = "D49"\n', "", 1), "t.toml")
