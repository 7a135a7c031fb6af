"""Places that a machine file may not name: said in a sentence, with a line."""

from __future__ import annotations

import re

import pytest
from tests.console.scenario import Scenario

from passo import config
from passo.config.load import shipped_text
from passo.errors import ConfigError


def changed(machine: str, **keys: str) -> str:
    text = shipped_text(machine)
    for key, value in keys.items():
        text, times = re.subn(rf"^{key} = .*$", f"{key} = {value}", text, flags=re.M)
        assert times
    return text


@pytest.mark.parametrize(
    ("machine", "key", "value", "told"),
    [
        ("scara", "x_offset", "1e308", "a number of at most 10000"),
        ("scara", "y_offset", "-1e308", "a number of at least -10000"),
        ("rotary-delta", "z_offset", "1e200", "a number of at most 10000"),
    ],
)
def test_a_geometry_far_away_is_no_geometry(machine, key, value, told):
    with pytest.raises(ConfigError, match=told) as raised:
        config.load_text(changed(machine, **{key: value}), "far.toml")
    [problem] = raised.value.problems
    assert problem.line


def without_switches(machine: str, **keys: str) -> str:
    text = changed(machine, **keys)
    begin = text.index("[homing.")
    return text[:begin] + text[text.index("[heaters.", begin) :]


def test_without_switches_the_arms_must_reach_the_home_of_the_axes():
    assert config.load_text(without_switches("scara"))
    far = without_switches("scara", x_offset="9000.0")
    with pytest.raises(ConfigError, match=r"a home that the arms reach: .* not 9000") as raised:
        config.load_text(far, "far.toml")
    [problem] = raised.value.problems
    assert far.splitlines()[(problem.line or 0) - 1] == "[axes.x]"


def test_the_arms_must_reach_the_switch_of_an_axis():
    switch = '[homing.z]\ndirection = "max"\nposition = 9000.0\npin = "^Z_MIN"\n'
    text = without_switches("rotary-delta").replace("[heaters.", f"{switch}\n[heaters.", 1)
    with pytest.raises(ConfigError, match=r"9000\.0: .* where the nozzle can be: arm A"):
        config.load_text(text, "far.toml")


def test_with_switches_the_arms_are_where_these_are():
    with Scenario(config.load_text(changed("scara", x_offset="9000.0"))) as s:
        s.host.ok("G28 A B", 60)
        assert "beyond its limit of -60.000 degrees. " in s.host.ok("G1 X10 Y10 F600")[0]
