"""A light on the board that blinks while all is well."""

from __future__ import annotations

import pytest
from tests.support.scenario import Scenario
from tests.support.two_boards import two_boards

from passo import config
from passo.config.load import shipped_text
from passo.errors import ConfigError

HZ = 16_000_000


def text(firmware: str, led: str = "LED") -> str:
    return f'{shipped_text("i3")}firmware = "{firmware}"\nstatus_led = "{led}"\n'


@pytest.mark.parametrize("firmware", ["virtual", "passo"])
def test_status_led_blinks_until_shutdown(firmware):
    with Scenario(config.load_text(text(firmware), "m.toml")) as s:
        assert s.board.output_value("status-led") == HZ // 2  # of a cycle of a second
        s.host.send("M112")
        s.host.expect("halted", 2)
        assert s.board.output_value("status-led") == 0
        s.host.send("M999")
        s.host.expect("ready again", 5)
        assert s.board.output_value("status-led") == HZ // 2


def test_status_led_pin_cannot_be_used():
    with pytest.raises(ConfigError, match=r"a pin of its own: PB4 belongs to board\.status_led"):
        config.load_text(text("virtual", "D10"), "m.toml")


@pytest.mark.parametrize(
    ("led", "says"),
    [
        ("tool:LED", "is 'tool:LED': expected a pin of the board itself, without the name of one"),
        ("^LED", "is '^LED': expected no ^ before PB7: it does nothing here"),
    ],
)
def test_status_led_of_each_board(led, says):
    with pytest.raises(ConfigError) as error:
        config.load_text(text("virtual", led) + '\n[boards.tool]\nbase = "pico"\n', "m.toml")
    assert f"board.status_led {says}" in str(error.value)


def test_each_board_has_its_own_status_led():
    machine = two_boards('status_led = "LED"')
    with Scenario(machine) as s:
        outputs = {name: board.board.outputs for name, board in s.board.boards.items()}
        assert [o.name for o in outputs["tool"] if o.blinks] == ["status-led-tool"]
        assert not [o for o in outputs[""] if o.blinks]
        assert s.board.boards["tool"].output_value("status-led-tool") == HZ // 2
