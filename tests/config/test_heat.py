"""Heaters in a machine file: what is understood, and what is refused with which sentence."""

from __future__ import annotations

import pytest

from passo import config
from passo.config.sensors import SensorTable
from passo.errors import ConfigError

HEAD = "max_c = 285.0\n"


def loaded(text: str, lines: str) -> config.MachineConfig:
    return config.load_text(text.replace(HEAD, HEAD + lines, 1), "my.toml")


def test_defaults(i3_text):
    heater = config.load_text(i3_text).heaters["hotend"]
    assert heater.sensor.kind == "thermistor"
    assert heater.control.kind == "pid"
    assert heater.on_fault == "machine"
    assert heater.protection.runaway_c == 4.0


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ("sensor = { kind = 'pt10' }", "sensor.kind is 'pt10': expected one of thermistor, pt100,"),
        ("sensor = { beta_k = 1.0 }", "sensor.kind is missing: expected one of thermistor, pt100,"),
        ("sensor = { kind = 'pt100', gain = 1.0 }", "heaters.hotend.sensor.gain is not a known"),
        (
            "sensor = { kind = 'thermistor', beta_k = 0 }",
            "sensor.beta_k is 0: expected a number",
        ),
        ("control = { kind = 'model', kp = 1.0 }", "heaters.hotend.control.kp is not a known key"),
        ("control = { kind = 'pid', drive_min = 1.0 }", "drive_min is 1.0: expected a share of p"),
        ("on_fault = 'job?'", "on_fault is 'job?': expected one of 'machine', 'job' or 'heater'"),
        ("min_c = 300.0", "max_c is 285.0: expected a temperature above min_c"),
        ("sensor = { kind = 'table', points = [[0, 1], [9, 0.5], [12, 0.6]] }", "only rise or on"),
        ("sensor = { kind = 'table', points = [[0, 1], [9, -0.5]] }", "shares from 0 to 1"),
        ("sensor = { kind = 'table', file = 'no.csv' }", "a table that can be read (No such file"),
    ],
)
def test_what_is_refused(i3_text, line, says):
    with pytest.raises(ConfigError) as error:
        loaded(i3_text, line + "\n")
    (problem,) = error.value.problems
    assert says in str(problem)
    assert problem.line is not None


def test_a_fan_that_is_not_there(i3_text):
    with pytest.raises(ConfigError, match=r"fan is 'prat': .* Did you mean 'part'"):
        config.load_text(i3_text.replace('fan = "part"', 'fan = "prat"'))


def test_a_table_from_a_file(i3_text, tmp_path):
    (tmp_path / "ntc.csv").write_text("# °C, share\n25, 0.9\n\n100.5, 0.5  # hot\n")
    text = i3_text.replace(HEAD, HEAD + "sensor = { kind = 'table', file = 'ntc.csv' }\n", 1)
    machine = tmp_path / "my.toml"
    machine.write_text(text)
    sensor = config.load(machine).heaters["hotend"].sensor
    assert isinstance(sensor, SensorTable)
    assert sensor.points == [[25.0, 0.9], [100.5, 0.5]]
    (tmp_path / "ntc.csv").write_text("25, 0.9\n100\n")
    with pytest.raises(ConfigError, match="line 2 is no"):
        config.load(machine)
