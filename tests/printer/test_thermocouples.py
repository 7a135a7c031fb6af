"""A hotend with a thermocouple behind a converter, through the wires of the board."""

from __future__ import annotations

import pytest
from tests.console.scenario import Scenario

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


@pytest.fixture(params=["max31855", "max6675"])
def s(request, firmware):
    with Scenario(config.load_text(text(request.param, firmware), "t.toml")) as scenario:
        yield scenario


def test_a_hotend_is_heated_by_its_thermocouple(s):
    assert s.host.ok("M105")[-1].startswith("ok T:25.00 /0.00")
    assert s.host.ok("M109 S200", 300)[-1] == "ok"
    s.passes(60)
    assert s.board.temperature("hotend") == pytest.approx(200, abs=1)
    assert s.printer.connection.heaters["hotend"].celsius == pytest.approx(200, abs=0.5)


def test_an_open_thermocouple_switches_off_within_a_second(s):
    s.host.ok("M104 S200")
    s.passes(20)
    s.board.force_sensor("hotend", 1.0)
    s.passes(1.0)
    assert s.printer.halted.startswith("heater hotend was switched off: its sensor is open")
    s.passes(0.1)
    assert s.board.output_value("hotend") == 0


def test_another_policy_keeps_the_machine_alive_and_the_heater_can_be_rearmed(firmware):
    machine = config.load_text(text(firmware=firmware, policy="heater"), "t.toml")
    with Scenario(machine) as s:
        s.host.ok("M104 S200")
        s.passes(20)
        s.board.force_sensor("hotend", 0.0)
        s.host.expect("heater hotend was switched off: its sensor is short-circuited", 1)
        s.passes(10)
        assert not s.printer.halted
        s.board.force_sensor("hotend", None)
        s.passes(1)
        s.host.ok("M922")
        s.host.ok("M109 S100", 300)


def test_pins_are_claimed():
    for old, new in (("D49", "D10"), ("D47", "D10"), ("D45", "D47")):
        with pytest.raises(ConfigError, match="a pin of its own"):
            config.load_text(text().replace(f'"{old}"', f'"{new}"', 1), "t.toml")
    with pytest.raises(ConfigError, match=r"heaters\.hotend\.sensor_pin is missing"):
        config.load_text(text().replace('sensor_pin = "D49"\n', "", 1), "t.toml")
