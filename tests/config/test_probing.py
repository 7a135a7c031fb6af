"""A probe or a levelling that cannot work is refused with its line and the numbers."""

import pytest

from passo.config.load import load_text, shipped_text
from passo.errors import ConfigError


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("{ x = 110, y = 110 }", "{ x = 250, y = 110 }", r"points\[4\] is 'X250 Y110'.* to X225 "),
        ("{ x = 110, y = 110 }", "{ x = 15.6, y = 15 }", "at least 1 mm from point 1, .* 0.6 mm"),
        ("trigger_height_mm = 1.2", "trigger_height_mm = 9.5", r"start_mm is 10.*more than 10\.5"),
        ("trigger_height_mm = 1.2", "trigger_height_mm = -2.5", r"low_mm is -2.*which is -2\.5"),
        ("trigger_height_mm = 1.2", "trigger_height_mm = 0\nfast_mm_s = 0.5", "this takes 24 s"),
        ("[15.0, 15.0, 215.0", "[15.0, 15.0, 245.0", "area is 'X245 Y15'"),
        ("area = [15.0, 15.0, 215.0, 205.0]", "area = [15.0, 15.0, 10.0, 205.0]", "greater ones"),
        ("1.2\n", '1.2\nheaters_off = ["bad"]\n', "Did you mean 'bed'"),
        ('pin = "^Z_MAX"', 'pin = "^Z_MIN"', "Z_MIN.* belongs to homing.z.pin"),
    ],
)
def test_probe_that_cannot_work_is_refused(old, new, says):
    text = shipped_text("i3-probe")
    assert old in text
    with pytest.raises(ConfigError, match=says):
        load_text(text.replace(old, new))


def test_points_must_be_enough_for_the_method():
    head, _, tail = shipped_text("i3-probe").partition("points = [")
    few = "points = [{ x = 15, y = 15 }, { x = 100, y = 50 }]\n"
    with pytest.raises(ConfigError, match="points is 2: expected at least 6 enabled points"):
        load_text(head + few + tail.partition("\n]\n")[2])


def test_levelling_needs_a_probe():
    with pytest.raises(ConfigError, match=r'levelling.method is .linear.: expected "none"'):
        load_text(shipped_text("i3") + '\n[levelling]\nmethod = "linear"\n')
