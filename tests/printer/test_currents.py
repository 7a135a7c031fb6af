"""Currents of drivers that the board sets: told when the board begins."""

from __future__ import annotations

import pytest
from tests.config.test_pins import FOUR_PI

from passo import config
from passo.config.board import CurrentSetter
from passo.errors import ConfigError
from passo.printer.setup.connections import connect_simulated

CHANNELS = {"x": 3, "y": 1, "z": 0, "e": 2}
MIDDLE = 128


def with_currents(firmware: str = "virtual", **amperes: float) -> str:
    text = FOUR_PI
    for name, ampere in amperes.items():
        text = text.replace(f"[steppers.{name}]", f"[steppers.{name}]\npeak_current_a = {ampere}")
    return f'{text}firmware = "{firmware}"\n'


@pytest.mark.parametrize(("ampere", "steps"), [(1.0, 135), (0.5, 67), (1.894, 255), (0.001, 0)])
def test_digipot_steps_for_each_milliampere(ampere, steps):
    """round(0.1346 · mA)"""
    setter = config.load_board("4pi").current_setter
    assert isinstance(setter, CurrentSetter)
    assert setter.word(3, ampere) == bytes([3, steps])


@pytest.mark.parametrize("firmware", ["virtual", "passo"])
def test_each_motor_gets_its_own_and_others_stay_in_the_middle(firmware):
    machine = config.load_text(with_currents(firmware, x=1.0, z=0.6))
    connection, simulated = connect_simulated(machine)
    (board,) = simulated.boards.values()
    (chip,) = board.digipots
    found = {name: chip.wiper(channel) for name, channel in CHANNELS.items()}
    assert found == {"x": 135, "y": MIDDLE, "z": 81, "e": MIDDLE}
    assert [chip.wiper(channel) for channel in (4, 5)] == [MIDDLE, MIDDLE]
    connection.close()


def test_digipot_without_currents_is_not_written():
    _, simulated = connect_simulated(config.load_text(with_currents()))
    (board,) = simulated.boards.values()
    assert board.digipots == []


def test_impossible_motor_current_is_refused():
    for ampere in (1.895, 0.007):  # 255.1 steps, and 0.9
        with pytest.raises(ConfigError, match=rf"is {ampere}: expected 0\.008 to 1\.89 A"):
            config.load_text(with_currents(y=ampere))
    ramps = config.shipped_text("i3").replace("[steppers.y]", "[steppers.y]\npeak_current_a = 1.0")
    with pytest.raises(ConfigError, match="the board does not set the current of this socket"):
        config.load_text(ramps)
