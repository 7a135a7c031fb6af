"""Pins that tell drivers how fine their steps are: set when the board is configured, for good."""

from __future__ import annotations

import pytest
from tests.config.test_pins import FOUR_PI

from passo import config
from passo.board.configuration import commands
from passo.printer.setup.boards import board_description
from passo.printer.setup.connections import connect_simulated

# A4982: MS1, MS2
LEVELS = {1: (0, 0), 2: (1, 0), 4: (0, 1), 16: (1, 1)}


@pytest.mark.parametrize("firmware", ["virtual", "passo"])
@pytest.mark.parametrize("microsteps", LEVELS)
def test_microstep_pins_have_the_levels_of_the_motor(microsteps, firmware):
    text = FOUR_PI.replace('socket = "Y"', f'socket = "Y"\nmicrosteps = {microsteps}')
    machine = config.load_text(f'{text}firmware = "{firmware}"\n')
    connection, simulated = connect_simulated(machine)
    main = connection.main
    lines = commands(main.board, main.dictionary)
    for pin, level in zip(("PC11", "PC10"), LEVELS[microsteps], strict=True):
        (line,) = (line for line in lines if f"pin={pin} " in line)
        assert line.endswith(f"pin={pin} value={level} default_value={level} max_duration=0")
    names = [o.name for o in main.board.outputs]
    assert [n for n in names if "-ms" in n] == [f"{m}-ms{i}" for m in "xyze" for i in (1, 2)]
    levels = tuple(simulated.output_value(f"y-ms{i}") for i in (1, 2))
    assert levels == LEVELS[microsteps]


def test_microstep_pins_on_a_further_board_are_set():
    text = FOUR_PI.replace('socket = "Z"', 'socket = "tool:X"\nmicrosteps = 2')
    text += '\n[boards.tool]\nbase = "4pi"\n'
    outputs = {o.name: o.pin for o in board_description(config.load_text(text), "tool").outputs}
    assert outputs == {"z-enable": "!PC31", "z-ms1": "!PC30", "z-ms2": "PC29"}
