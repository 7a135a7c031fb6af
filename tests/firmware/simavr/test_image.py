"""What a build makes, and what it refuses."""

from __future__ import annotations

from dataclasses import replace

import pytest

from passo.toolchain.avr import (
    CHIPS,
    AvrBoard,
    FirmwareError,
    Motor,
    board_header,
    build,
    reserved_register_users,
)

from .boards import FIRMWARE, MELZI, RAMPS, image


@pytest.mark.parametrize(("board", "flash"), [(RAMPS, 40_000), (MELZI, 40_000)])
def test_an_image_is_small_and_leaves_room_for_the_stack(board, flash):
    made = image(board)
    assert made.flash < flash
    assert made.ram + 900 <= CHIPS[board.mcu].ram
    assert made.file.read_text().startswith(":10000000")


def test_a_reserved_register_in_other_code_is_found():
    listing = (
        "00001068 <harmless>:\n"
        "    1068:\t0e 94 00 10 \tcall\t0x2000\t; 0x2000 <r5>\n"
        "    106c:\t8a e0       \tldi\tr24, 0x0A\t; 10\n"
        "0000106e <guilty>:\n"
        "    106e:\t91 01       \tmovw\tr18, r2\n"
        "    1070:\t9a 2c       \tmov\tr9, r10\n"
        "00001072 <half>:\n"
        "    1072:\t6c 01       \tmovw\tr12, r8\n"
    )
    assert reserved_register_users(listing) == ["guilty", "half"]


def test_compiling_without_the_reservation_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr("passo.toolchain.avr.RESERVED", (24,))
    with pytest.raises(FirmwareError, match=r"registers of the interrupts are used by .*main"):
        build(RAMPS, FIRMWARE, tmp_path)


def test_motors_get_the_units_that_are_left_and_three_stay_free():
    fixed, free = RAMPS.assigned()
    assert [unit for _, unit in fixed] == ["TIMER1A", "TIMER1B", "TIMER1C", "TIMER3A"]
    assert free == ["TIMER3B", "TIMER3C", "TIMER4A"]
    named = AvrBoard("atmega1284p", (Motor("PD7", "PC5", "TIMER3A"), Motor("PC6", "PC7")))
    fixed, free = named.assigned()
    assert [unit for _, unit in fixed] == ["TIMER3A", "TIMER1A"]
    assert free == ["TIMER1B", "TIMER3B"]
    assert "S(0, 3, A, D, 7, C, 5) S(1, 1, A, C, 6, C, 7)" in board_header(named)
    assert AvrBoard("atmega2560", slow_motors=4).assigned()[1] == [*CHIPS["atmega2560"].units[:4]]


@pytest.mark.parametrize(
    ("board", "reason"),
    [
        (AvrBoard("atmega8"), "no firmware for atmega8"),
        (replace(MELZI, motors=(*MELZI.motors, Motor("PA0", "PA1"))), "at most 4 motors"),
        (replace(MELZI, slow_motors=1), "at most 4 motors"),
        (AvrBoard("atmega2560", (Motor("PF0", "PF1", "TIMER5C"),)), "TIMER5C is taken"),
        (AvrBoard("atmega2560", (Motor("X", "PF1"),)), "X is not a pin"),
    ],
)
def test_a_board_that_cannot_be_built_is_refused(board, reason):
    with pytest.raises(FirmwareError, match=reason):
        board_header(board)
