"""File 80, M92 X82, then the file is edited to 100 and the printer restarts."""

import pytest

from passo.learn.lessons.stored_settings import EXPERIMENT, LESSON

FILE, STORED, COMMAND = 0, 1, 2


@pytest.mark.parametrize(
    ("action", "before", "after"),
    [
        ("none", (82, COMMAND), (100, FILE)),
        ("M500", (82, STORED), (82, STORED)),
        ("M500 M502", (80, FILE), (82, STORED)),
        ("M500 M502 M500", (80, FILE), (100, FILE)),
    ],
)
def test_value_and_source_around_the_restart(action, before, after):
    outcome = EXPERIMENT.run({"action": action})
    assert (outcome["before"], outcome["before_source"]) == before
    assert (outcome["after"], outcome["after_source"]) == after
    assert outcome["error_percent"] == pytest.approx(after[0] - 100)


def test_stored_value_that_equals_the_edited_file_is_the_files():
    outcome = EXPERIMENT.run({"action": "M500", "edited": 82})
    assert (outcome["after"], outcome["after_source"]) == (82, FILE)


def test_answers():
    assert LESSON.asked(0).answer == 95
    assert LESSON.asked(1).answer == FILE
    assert LESSON.asked(2).answer == pytest.approx(5.708, abs=1e-3)  # 100000 / 48 / 365
