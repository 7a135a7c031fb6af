"""A board must know every word that its host will need, before anything moves or heats."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from tests.support.klipper_board import dictionary
from tests.support.klipper_printer import machine

from passo.board.description import Accelerometer, BoardDescription, I2cPins, Input
from passo.board.dictionary import Dictionary, DictionaryError
from passo.board.words import check_words
from passo.printer.setup.boards import board_description

COMMANDS = [
    "get_config",
    "get_uptime",
    "get_clock",
    "emergency_stop",
    "queue_step",
    "set_next_step_dir",
    "reset_step_clock",
    "stepper_get_position",
    "stepper_stop_on_trigger",
    "endstop_home",
    "endstop_query_state",
    "trsync_start",
    "trsync_set_timeout",
    "trsync_trigger",
    "query_analog_in",
    "queue_digital_out",
    "update_digital_out",
    "tmcuart_send",
    "spi_send",
    "spi_transfer",
    "buttons_query",
    "buttons_ack",
]
REPORTS = [
    "config",
    "uptime",
    "clock",
    "shutdown",
    "is_shutdown",
    "stepper_position",
    "endstop_state",
    "trsync_state",
    "analog_in_state",
    "tmcuart_response",
    "spi_transfer_response",
    "buttons_state",
]


@pytest.fixture(params=[False, True], ids=["older", "newer"])
def told(request: pytest.FixtureRequest) -> dict:
    return dictionary(chip="stm32", newer=request.param)


@pytest.fixture
def board(told: dict, tmp_path: Path) -> BoardDescription:
    described = board_description(machine(told, tmp_path))
    return replace(described, inputs=(Input("filament-roll", "^PC13"),))


def parsed(told: dict, commands: dict[str, int], reports: dict[str, int]) -> Dictionary:
    pairs = [
        tuple((number, text) for text, number in words.items()) for words in (commands, reports)
    ]
    return Dictionary(pairs[0], pairs[1], told["enumerations"], told["config"])


def changed(words: dict[str, int], name: str, becomes: str | None) -> dict[str, int]:
    """Without the word of that name, or with another declaration in its place."""
    kept = {text: number for text, number in words.items() if text.split()[0] != name}
    assert len(kept) == len(words) - 1
    return kept if becomes is None else {**kept, becomes: 4000}


def test_board_with_every_message_is_accepted(told: dict, board: BoardDescription) -> None:
    check_words(board, parsed(told, told["commands"], told["responses"]))


@pytest.mark.parametrize(
    ("part", "name"), [*(("commands", n) for n in COMMANDS), *(("responses", n) for n in REPORTS)]
)
def test_board_that_lacks_a_message_is_refused(
    told: dict, board: BoardDescription, part: str, name: str
) -> None:
    for becomes, says in (
        (None, f"the board has no message '{name}'"),
        (f"{name} other=%u", f"the board has '{name} other', where '{name}.*' is needed"),
    ):
        words = {**told, part: changed(told[part], name, becomes)}
        with pytest.raises(DictionaryError, match=f"^{says}$"):
            check_words(board, parsed(told, words["commands"], words["responses"]))


def test_reports_may_have_more_parameters_but_not_commands(
    told: dict, board: BoardDescription
) -> None:
    state = "endstop_state oid=%c homing=%c next_clock=%u pin_value=%c more=%u"
    reports = changed(told["responses"], "endstop_state", state)
    check_words(board, parsed(told, told["commands"], reports))
    commands = changed(told["commands"], "get_clock", "get_clock of=%u")
    with pytest.raises(DictionaryError, match="'get_clock of', where 'get_clock' is needed"):
        check_words(board, parsed(told, commands, reports))


def test_messages_for_missing_parts_are_not_required(told: dict, board: BoardDescription) -> None:
    bare = replace(
        board,
        **dict.fromkeys(("steppers", "sensors", "outputs", "endstops", "inputs"), ()),
        **dict.fromkeys(("heaters", "drivers", "settings"), ()),
    )
    always = {"get_config", "get_uptime", "get_clock", "emergency_stop"}
    commands = {text: n for text, n in told["commands"].items() if text.split()[0] in always}
    check_words(bare, parsed(told, commands, told["responses"]))


def test_i2c_messages_of_old_and_new_firmware_work(told: dict, board: BoardDescription) -> None:
    chip = Accelerometer("lis2dw", I2cPins("", "", 25, bus="i2c1"))
    board = replace(board, accelerometers=(chip,))
    check_words(board, parsed(told, told["commands"], told["responses"]))
    commands = {text: n for text, n in told["commands"].items() if not text.startswith("i2c_")}
    with pytest.raises(DictionaryError, match="the board has no message 'i2c_transfer'"):
        check_words(board, parsed(told, commands, told["responses"]))
