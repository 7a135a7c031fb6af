"""A light on the board that blinks while all is well."""

from __future__ import annotations

import pytest
from tests.console.scenario import Scenario

from passo import config
from passo.config.load import shipped_text
from passo.errors import ConfigError

HZ = 16_000_000


def text(firmware: str, led: str = "LED") -> str:
    return f'{shipped_text("i3")}firmware = "{firmware}"\nstatus_led = "{led}"\n'


@pytest.mark.parametrize("firmware", ["virtual", "passo"])
def test_it_blinks_until_the_board_shuts_down(firmware):
    with Scenario(config.load_text(text(firmware), "m.toml")) as s:
        assert s.board.output_value("status-led") == HZ // 2  # of a cycle of a second
        s.host.send("M112")
        s.host.expect("halted", 2)
        assert s.board.output_value("status-led") == 0
        s.host.send("M999")
        s.host.expect("ready again", 5)
        assert s.board.output_value("status-led") == HZ // 2


def test_its_pin_is_its_own():
    with pytest.raises(ConfigError, match=r"a pin of its own: PB4 belongs to board\.status_led"):
        config.load_text(text("virtual", "D10"), "m.toml")
