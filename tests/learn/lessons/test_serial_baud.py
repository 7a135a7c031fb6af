"""Numbers by hand: 16 MHz / (8 · 17) = 117647; 16 MHz / (8 · 8) = 250000."""

import pytest

from passo.learn.lessons.serial_baud import EXPERIMENT, LESSON


@pytest.mark.parametrize(
    ("baud", "divisor", "error_percent"),
    [(57_600, 35, -0.794), (115_200, 17, 2.124), (250_000, 8, 0), (500_000, 4, 0)],
)
def test_error_of_each_rate_at_16_mhz(baud, divisor, error_percent):
    outcome = EXPERIMENT.run({"board_baud": baud, "host_baud": baud})
    assert outcome["divisor"] == divisor
    assert outcome["error_percent"] == pytest.approx(error_percent, abs=1e-3)
    assert (outcome["received"], outcome["result"]) == (ord("G"), 0)


def test_bits_that_a_slow_board_reads_of_a_fast_host():
    # U is 0x55: from the start 0 1 0 1 0 1 0 1 0, then high. A bit of the board is 2.125 of the
    # host's: it reads bits 1, 3, 5, 7 (all high), 9 and later (high).
    outcome = EXPERIMENT.run({"host_baud": 250_000, "character": "U"})
    assert outcome["received"] == 0xFF
    assert outcome["result"] == 1


def test_answers():
    assert LESSON.asked(0).answer == pytest.approx(-0.7937, abs=1e-4)
    assert LESSON.asked(1).answer == pytest.approx(13.0, abs=0.1)  # 113636: 9.5 · 1.376 %
    assert LESSON.asked(2).answer == 1
