"""Buttons: what two looks see is told, again and again until it is acknowledged."""

from __future__ import annotations

import pytest
from tests.support.raw_board import RawBoard

REST = 1000
AGAIN = 5


@pytest.fixture
def board() -> RawBoard:
    """A button on the pin of the switch, which reads 1 when it is pressed, and an open pin."""
    raw = RawBoard()
    raw.simulated.force_switch("x", False)
    for line in (
        "allocate_oids count=1",
        "config_buttons oid=0 button_count=2",
        "buttons_add oid=0 pos=0 pin=PE5 pull_up=1",
        "buttons_add oid=0 pos=1 pin=PH5 pull_up=1",
        "finalize_config crc=1",
        f"buttons_query oid=0 clock={raw.clock(0)} rest_ticks={REST} retransmit_count={AGAIN}"
        " invert=2",
    ):
        assert raw.tell(line) == []
    raw.wait(REST - 1)
    return raw


def states(said) -> list[tuple[int, list[int]]]:
    return [(v["ack_count"], list(v["state"])) for _, v in said]


def pressed(board: RawBoard, on: bool, looks: int):
    board.simulated.force_switch("x", on)
    return board.wait(looks * REST)


def test_a_bounce_of_one_sample_does_not_trigger(board):
    assert pressed(board, False, 10) == []
    assert pressed(board, True, 1) == []
    assert pressed(board, False, 10) == []


def test_an_input_that_bounces_does_not_hold_up_another(board):
    pin = board.dictionary.enumerations["pin"]["PH5"]
    board.device.add_switch(pin, [], 0.0, False, True)
    board.device.force_switch(pin, 1)
    board.wait(2 * REST)
    board.simulated.force_switch("x", True)
    said = []
    for look in range(4):
        board.device.force_switch(pin, look % 2)
        said += board.wait(REST)
    assert states(said) == [(0, [1])]


def test_states_are_reported_until_they_are_acknowledged(board):
    assert states(pressed(board, True, 2)) == [(0, [1])]
    assert states(pressed(board, False, 2)) == [(0, [1, 0])]
    assert states(board.wait(AGAIN * REST)) == [(0, [1, 0])]
    assert states(board.wait(2 * AGAIN * REST)) == [(0, [1, 0])] * 2
    board.tell("buttons_ack oid=0 count=1")
    assert states(board.wait(AGAIN * REST)) == [(1, [0])]
    board.tell("buttons_ack oid=0 count=1")
    assert board.wait(100 * REST) == []
    board.tell("buttons_ack oid=0 count=9")  # more than there were
    assert states(pressed(board, True, 2)) == [(2, [1])]


def test_button_events_wait_for_room(board):
    for i in range(20):
        pressed(board, i % 2 == 0, 2)
    told = states(board.wait(AGAIN * REST))[-1]
    assert told == (0, [1, 0] * 4)
    board.tell("buttons_ack oid=0 count=8")
    board.wait(AGAIN * REST)
    assert pressed(board, False, AGAIN) == []  # as it was when there was no room
    assert states(pressed(board, True, 2)) == [(8, [1])]


@pytest.mark.parametrize(
    ("line", "fault"),
    [
        ("config_buttons oid=0 button_count=9", "Max of 8 buttons"),
        ("buttons_add oid=0 pos=2 pin=PE5 pull_up=0", "Set button past maximum button count"),
        ("buttons_query oid=0 clock=0 rest_ticks=1 retransmit_count=1 invert=0",
         "Period too short for this board"),
        ("buttons_ack oid=1 count=1", "Invalid oid type"),
    ],
)  # fmt: skip
def test_misuse_shuts_the_board_down(board, line, fault):
    board.tell(line)
    assert board.device.fault == fault
    assert pressed(board, True, 10) == []
