"""The smoothing of pressure advance: the default of an extruder, and what `passo check` says."""

from __future__ import annotations

from math import ceil, sqrt

import pytest

from passo import config
from passo.config.advance import default_smooth_s, smooth_s
from passo.config.load import shipped_text
from passo.config.notes import notes

I3 = shipped_text("i3")


def machine(extruder: str = "", accel: float = 5000.0, path: float = 3000.0):
    text = I3.replace("[extruders.e]\n", f"[extruders.e]\n{extruder}\n")
    made = config.load_text(text)
    own = made.extruders["e"].model_copy(update={"accel_mm_s2": accel})
    limits = made.limits.model_copy(update={"print_accel_mm_s2": path})
    return made.model_copy(update={"extruders": {"e": own}, "limits": limits})


@pytest.mark.parametrize(
    ("advance", "accel", "path"),
    [
        (0.05, 5000.0, 3000.0),
        (0.05, 1000.0, 3000.0),
        (0.05, 900.0, 3000.0),
        (0.05, 700.0, 3000.0),
        (0.05, 250.0, 1500.0),
        (0.05, 250.0, 5000.0),
        (0.5, 5000.0, 1500.0),
        (1.0, 5000.0, 1500.0),
        (0.05, 30.0, 10.0),
    ],
)
def test_default_is_short_where_the_extruder_follows(advance, accel, path):
    """Lines of 0.06 mm of filament a mm, and right angles at 5 mm/s."""
    made = machine(f"advance_s = {advance}", accel, path)
    found = default_smooth_s(made.path_limits, made.extruders["e"])

    def fits(smooth):
        ramps = 0.06 * path * (1 + 2 * advance / smooth)
        corner = advance * 0.06 * 5.0 / (smooth / 2) ** 2
        return max(ramps, corner) <= accel * (1 + 1e-9)

    assert 0.02 <= found <= 0.04
    assert found == round(found, 3)
    assert fits(found) or found == 0.04
    assert found == 0.02 or not fits(found - 0.001)


def test_machine_without_an_advance_has_that_of_a_direct_drive():
    made = machine("", 900.0)
    assert (
        default_smooth_s(made.path_limits, made.extruders["e"])
        == ceil(0.1 / (900 / 180 - 1) * 1e3) / 1e3
    )
    assert default_smooth_s(made.path_limits, made.extruders["e"]) == 0.025
    assert made.core_spec()["filters"]["smooth_s"] == [0]  # no delay before the first M900


def test_filament_is_not_shaped_unless_the_file_says_so():
    shaping = "\n[shaping.x]\nfrequency_hz = 40.0\n"
    for extruder, shaped in (("", False), ("shaped = true\n", True)):
        text = I3.replace("[extruders.e]\n", f"[extruders.e]\n{extruder}")
        assert config.load_text(text + shaping).core_spec()["filters"]["shaped"] == [shaped]


@pytest.mark.parametrize(("written", "used"), [("0", 0.001), ("0.0005", 0.001), ("0.03", 0.03)])
def test_a_given_time_counts_from_a_millisecond_on(written, used):
    made = machine(f"advance_smooth_s = {written}")
    assert smooth_s(made.path_limits, made.extruders["e"]) == used
    assert made.core_spec()["filters"]["smooth_s"] == [used / 2]


@pytest.mark.parametrize(
    ("extruder", "accel", "note"),
    [
        ("", 5000.0, None),
        ("advance_s = 0.05", 5000.0, "smoothed over 0.02 s, because the extruder's limits allow"),
        ("advance_s = 0.05", 700.0, "over 0.035 s, because the extruder's accel_mm_s2 of 700"),
        ("advance_s = 0.05", 250.0, f"allows a line of 0.5 x 0.3 mm {250 / 0.06 / 3.5:.0f} mm/s²"),
        ("advance_s = 0.05\nadvance_smooth_s = 0.02", 5000.0, None),
        ("advance_s = 0.05\nadvance_smooth_s = 0.005", 700.0, f"{700 / 0.06 / 21:.0f} mm/s² of"),
        ("advance_s = 0.05\nadvance_smooth_s = 0", 5000.0, "is 0: Passo smooths over at least"),
    ],
)
def test_check_says_which_smoothing_and_why(extruder, accel, note):
    found = [text for text in notes(machine(extruder, accel)) if "advance_smooth_s" in text]
    assert len(found) == (note is not None)
    assert (note or "") in "".join(found)


def test_speed_of_a_right_angle_needs_smoothing_of_a_slow_path():
    made = machine("advance_s = 0.05", 30.0, 10.0)
    assert 2 * sqrt(0.05 * 0.06 * 5 / 30) > 0.04  # more than the longest default
    assert default_smooth_s(made.path_limits, made.extruders["e"]) == 0.04
