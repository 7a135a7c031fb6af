"""Fans of tools: which fans M106 without P sets, by which factor, and what a change does."""

from __future__ import annotations

import pytest
from tests.support.scenario import Scenario

from passo import config
from passo.config.load import shipped_text
from passo.errors import ConfigError

FANS = """[fans.left]
pin = "D4"
number = 1
[fans.right]
pin = "D5"
number = 2
[fans.duct]
pin = "D6"
number = 3
min_power = 0.1
max_power = 0.8
"""


def machine(first: str, second: str = "", fans: str = ""):
    """The machine with two extruders, whose tools have these further keys."""
    text = shipped_text("dual-extruder")
    head, _, rest = text.partition("[[tools]]\n")
    one, _, two = rest.partition("[[tools]]\n")
    text = f"{head}[[tools]]\n{first}\n{one}[[tools]]\n{second}\n{two}"
    return config.load_text(text.replace("[fans.part]", f"{FANS}{fans}[fans.part]"))


def speeds(s):
    s.passes(1)
    fans = s.printer.status.read().fans
    return {name: round(fans.get(name, 0.0), 3) for name in ("part", "left", "right", "duct")}


def on(**fans: float):
    return dict.fromkeys(("part", "left", "right", "duct"), 0.0) | fans


def test_m106_without_p_sets_the_fan_of_the_tool_by_its_factor():
    with Scenario(machine('fans = ["left"]', 'fans = ["right"]\nfan_factor = 0.5')) as s:
        s.host.ok("M106 S204")
        assert speeds(s) == on(left=0.8)
        s.host.ok("T1")
        assert speeds(s) == on(right=0.4)
        s.host.ok("M106 S102")
        assert speeds(s) == on(right=0.2)
        s.host.ok("T0")
        assert speeds(s) == on(left=0.4)
        s.host.ok("M107")
        s.host.ok("T1")
        assert speeds(s) == on()


def test_tool_may_have_several_fans_which_p_sets_alone():
    with Scenario(machine('fans = ["left", "duct"]\nfan_factor = 1.5')) as s:
        s.host.ok("M106 S102")
        assert speeds(s) == on(left=0.6, duct=0.48)
        s.host.ok("M106 P3 S255")
        assert speeds(s) == on(left=0.6, duct=0.8)
        s.host.ok("M106 S255")
        assert speeds(s) == on(left=1.0, duct=0.8)
        s.host.ok("M107")
        assert speeds(s) == on()


def test_change_follows_the_moves_before_it():
    with Scenario(machine('fans = ["left"]', 'fans = ["right"]')) as s:
        s.host.ok("G92 X0 Y0 Z0")
        s.host.ok("M106 S255")
        s.host.send("G1 X20 F600", "T1", "G1 X21")
        s.passes(1)
        assert s.board.output_value("left") > 0
        s.host.ok("M400", 10)
        assert speeds(s) == on(right=1.0)


def test_tools_with_one_fan_leave_it_alone_at_a_change():
    with Scenario(machine("")) as s:
        s.host.ok("M106 S128")
        s.host.ok("T1")
        assert speeds(s) == on(part=0.502)


def test_tools_with_one_fan_may_differ_in_the_factor():
    with Scenario(machine("", "fan_factor = 0.5")) as s:
        s.host.ok("M106 S255")
        assert speeds(s) == on(part=1.0)
        s.host.ok("T1")
        assert speeds(s) == on(part=0.5)


def test_fan_that_p_has_switched_off_stays_off_at_a_change():
    with Scenario(machine('fans = ["left"]', 'fans = ["right"]')) as s:
        s.host.ok("M106 S255")
        s.host.ok("M106 P1 S0")
        s.host.ok("T1")
        assert speeds(s) == on()


def test_machine_with_one_tool_has_its_factor():
    tool = '[[tools]]\nextruder = "e"\nheater = "hotend"\nfan_factor = 0.5\n'
    text = shipped_text("i3").replace("[fans.part]", f"{tool}[fans.part]")
    with Scenario(config.load_text(text)) as s:
        s.host.ok("M106 S255")
        s.passes(1)
        assert s.printer.status.read().fans["part"] == 0.5


@pytest.mark.parametrize("name", ["lift", "case"])
def test_tool_with_a_fan_that_commands_do_not_set_is_refused(name):
    case = '[fans.case]\npin = "D42"\nfollows_motors = ["x"]\n'
    with pytest.raises(ConfigError, match="the name of a fan that M106 sets"):
        machine(f'fans = ["{name}"]', fans=case)
