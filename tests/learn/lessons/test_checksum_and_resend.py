"""By hand: N 78, 4 52, blank 32, G 71, 2 50, 8 56 give 23."""

import pytest

from passo.learn.lessons.checksum_and_resend import EXPERIMENT, LESSON

ACCEPTED, RESENT, LATE = 0, 1, 2


@pytest.mark.parametrize(
    ("damage", "result"),
    [
        ("none", ACCEPTED),
        ("bit", RESENT),
        ("swap", ACCEPTED),
        ("twice", ACCEPTED),
        ("lost", RESENT),
        ("line", LATE),
    ],
)
def test_which_damage_the_protocol_finds(damage, result):
    for line in ("N4 G28", "N5 M104 S210", "N6 G1 X12.5"):
        assert EXPERIMENT.run({"line": line, "damage": damage})["result"] == result


def test_checksum_by_hand():
    total = 0
    for code in (78, 52, 32, 71, 50, 56):
        total ^= code
    assert total == 23
    assert EXPERIMENT.run({"line": "N4 G28"})["sent"] == total
    assert EXPERIMENT.run({"line": "N4 G28", "damage": "bit"})["counted"] == total ^ 1


def test_answers():
    assert [LESSON.asked(i).answer for i in range(3)] == [23, ACCEPTED, LATE]
