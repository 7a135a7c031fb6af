"""Places that a machine file may not name: said in a sentence, with a line."""

from __future__ import annotations

import re

import pytest
from tests.support.scenario import Scenario

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
def test_geometry_far_from_usual_values_is_refused(machine, key, value, told):
    with pytest.raises(ConfigError, match=told) as raised:
        config.load_text(changed(machine, **{key: value}), "far.toml")
    [problem] = raised.value.problems
    assert problem.line


def without_switches(machine: str, **keys: str) -> str:
    text = changed(machine, **keys)
    begin = text.index("[homing.")
    return text[:begin] + text[text.index("[heaters.", begin) :]


def test_arms_without_endstops_must_reach_home_of_axes():
    assert config.load_text(without_switches("scara"))
    far = without_switches("scara", x_offset="9000.0")
    with pytest.raises(ConfigError, match=r"a home that the arms reach: .* not 9000") as raised:
        config.load_text(far, "far.toml")
    [problem] = raised.value.problems
    assert far.splitlines()[(problem.line or 0) - 1] == "[axes.x]"


def test_the_arms_must_reach_the_switch_of_an_axis():
    switch = '[homing.z]\ndirection = "max"\nposition = 9000.0\npin = "^Z_MIN"\n'
    text = without_switches("rotary-delta").replace("[heaters.", f"{switch}\n[heaters.", 1)
    with pytest.raises(ConfigError, match=r"9000\.0: .* that the nozzle can reach: arm A"):
        config.load_text(text, "far.toml")


def test_arms_with_switches_take_their_positions():
    with Scenario(config.load_text(changed("scara", x_offset="9000.0"))) as s:
        s.host.ok("G28 A B", 60)
        assert "beyond its limit of -60.000 degrees. " in s.host.ok("G1 X10 Y10 F600")[0]


def homes(machine: str, *lines: str, axis: str) -> str:
    """A shipped machine whose axis or arm has these lines in its table `homing`."""
    head, table, rest = shipped_text(machine).partition(f"[homing.{axis}]\n")
    table_lines = {line.split(" = ")[0]: line for line in rest.split("\n\n")[0].splitlines()}
    table_lines |= {line.split(" = ")[0]: line for line in lines}
    return head + table + "\n".join(table_lines.values()) + "\n\n" + rest.partition("\n\n")[2]


U_AXIS = """
[axes.u]
min_mm = -180.0
max_mm = 180.0
speed_mm_s = 100.0
accel_mm_s2 = 1000.0

[steppers.u]
steps_per_mm = 10.0
socket = "E1"

[homing.u]
direction = "max"
position = %s
pin = "^X_MAX"
"""


@pytest.mark.parametrize(
    ("machine", "axis", "direction", "position", "expected"),
    [
        ("i3", "x", "min", 260.0, "at most 125, as axes.x goes from min_mm 0 to max_mm 250 and"),
        ("i3", "x", "min", 250.0, "at most 125,"),
        ("i3", "x", "min", 126.0, "at most 125,"),
        ("i3", "x", "max", 0.0, "at least 125,"),
        ("i3", "y", "max", -5.0, "at least 110,"),
        ("i3", "z", "max", 1.0, "at least 125,"),
        ("corexy", "x", "min", 1000.0, "axes.x goes from"),
        ("delta", "a", "max", 30.0, "at least 174, as carriage A goes from 30 to 318 mm and"),
        ("delta", "c", "min", 318.0, "at most 174,"),
        ("scara", "b", "min", 250.0, "at most 202.5, as arm B goes from 60 to 250 degrees and"),
        ("rotary-delta", "a", "min", 80.0, "at most 52.5,"),
        ("scara", "b", "min", 260.0, "at most 202.5,"),
        ("scara", "b", "min", 420.0, ""),  # 60 degrees, a turn further
        ("scara", "b", "min", 160.0, ""),  # where arms meet
        ("i3", "x", "min", -2.2, ""),
        ("i3", "x", "min", -60.0, ""),
        ("i3", "x", "min", 3.0, ""),
        ("i3", "x", "min", 125.0, ""),
        ("i3", "x", "max", 252.5, ""),
        ("i3", "x", "max", 125.0, ""),
        ("delta", "b", "max", 330.0, ""),
    ],
)
def test_a_home_is_on_the_side_of_its_endstop(machine, axis, direction, position, expected):
    text = homes(machine, f'direction = "{direction}"', f"position = {position}", axis=axis)
    if not expected:
        assert config.load_text(text).homing[axis].position == position
        return
    with pytest.raises(ConfigError) as raised:
        config.load_text(text, "side.toml")
    [problem] = raised.value.problems
    told = str(problem)
    line = text.splitlines()[(problem.line or 0) - 1]
    assert line == f"position = {position}"
    assert f"homing.{axis}.position is {position}: expected " in told
    assert expected in told
    assert f'homing.{axis}.direction is "{direction}"' in told


@pytest.mark.parametrize("limits", ["", "min_mm = 30.0\n", "max_mm = 318.0\n"])
def test_carriage_without_limits_gets_home_of_axes(limits):
    def delta(position: float) -> str:
        text = homes("delta", f"position = {position}", axis="a")
        return re.sub(r"^min_mm = 30.0\nmax_mm = 318.0\n", limits, text, flags=re.M)

    assert config.load_text(delta(318.0))
    with pytest.raises(ConfigError, match="as carriage A goes from"):
        config.load_text(delta(130.0))


@pytest.mark.parametrize(("position", "good"), [(0.0, True), (181.0, True), (-1.0, False)])
def test_a_further_axis_has_its_home_on_the_side_of_its_endstop(position, good):
    text = shipped_text("i3") + U_AXIS % position
    if good:
        assert config.load_text(text).homing["u"].position == position
    else:
        with pytest.raises(
            ConfigError, match=r"homing\.u\.position is -1\.0: expected at least 0,"
        ):
            config.load_text(text)
