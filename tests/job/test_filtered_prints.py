"""A print with shapers and advance that is disturbed, or loses its link or its host, ends at the
steps of the undisturbed print without them."""

import random

import pytest
from tests.job.test_lost_link import break_link, stall
from tests.support.disturbed_prints import disturb, shift_by_babysteps, steps, undisturbed
from tests.support.scenario import Scenario

from passo import config
from passo.config.motion import Backlash, Shaping

_I3 = config.load("i3")
FILTERED = _I3.model_copy(
    update={
        "shaping": {
            "x": Shaping(type="mzv", frequency_hz=40.0),
            "y": Shaping(type="3hump_ei", frequency_hz=30.0, damping=0.05),
            "z": Shaping(type="zv", frequency_hz=60.0),
        },
        "extruders": {"e": _I3.extruders["e"].model_copy(update={"advance_s": 0.05})},
    }
)
DELAY_S = 0.0303  # of the motors: the middle of the longest shaper
SURVIVES = FILTERED.model_copy(
    update={"board": FILTERED.board.model_copy(update={"firmware": "passo"})}
)


GEARED = SURVIVES.model_copy(
    update={"shaping": {}, "backlash": Backlash(x_mm=0.2, y_mm=0.1, z_mm=0.05, smooth_mm=1.0)}
)


def filtered(name, jerk_mm_s3=None):
    """A machine with all filters on, of a board that survives the loss of its link."""
    machine = config.load(name)
    return machine.model_copy(
        update={
            "shaping": FILTERED.shaping,
            "limits": machine.limits.model_copy(update={"jerk_mm_s3": jerk_mm_s3}),
            "extruders": {
                e: made.model_copy(update={"advance_s": 0.05})
                for e, made in machine.extruders.items()
            },
            "board": machine.board.model_copy(update={"firmware": "passo"}),
        }
    )


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    return undisturbed(tmp_path_factory.mktemp("card"))


@pytest.fixture(scope="module")
def geared_whole(whole, tmp_path_factory):
    card, plain = whole
    card, wanted = undisturbed(tmp_path_factory.mktemp("geared"), GEARED)
    assert max(abs(wanted[name] - plain[name]) for name in "xyz") > 0
    assert wanted["e"] == plain["e"]
    return card, wanted


def test_disturbed_filtered_print_ends_at_steps_of_plan(whole):
    """One example; test_disturbances.py makes more of them, with link losses among them."""
    card, wanted = whole
    with Scenario(FILTERED, card=str(card)) as s:
        disturb(s, random.Random(0), lambda: None)
        assert steps(s) == wanted


def test_babysteps_shift_filtered_print_by_their_sum(whole):
    card, wanted = whole
    with Scenario(FILTERED, card=str(card)) as s:
        assert shift_by_babysteps(s, random.Random(0), wanted)["z"] != 0


def lose_links(machine, card, wanted, generator, factors=(100,)):
    """Prints while the link breaks again and again, and perhaps at other speeds after each time.
    Asserts that the print ends at the wanted steps, and returns how often the link broke."""
    breaks = 0
    with Scenario(machine, card=str(card)) as s:
        s.host.ok("M32 a.g")
        s.passes(14)
        while "Done printing file" not in s.host.heard:
            s.host.ok(f"M220 S{generator.choice(factors)}")
            s.passes(generator.expovariate(0.5))
            if "Done printing file" in s.host.heard:
                break
            break_link(s, generator.choice((0.02, 0.3, 2.0, 40.0)))
            s.host.expect("The board is back", 10)
            breaks += 1
            assert not s.printer.state.halted
        assert s.board.device.fault == ""
        assert steps(s) == wanted
    return breaks


def test_filtered_print_with_link_losses_ends_at_same_steps(whole):
    """bench/faults.py breaks more links."""
    card, wanted = whole
    assert lose_links(SURVIVES, card, wanted, random.Random(0)) > 3


def test_late_host_resumes_filtered_print_where_board_stopped(whole):
    card, wanted = whole
    generator = random.Random(0)
    with Scenario(SURVIVES, card=str(card)) as s:
        s.host.ok("M32 a.g")
        s.passes(14)
        while "Done printing file" not in s.host.heard:
            s.passes(generator.expovariate(0.5))
            stall(s, generator.choice((0.05, 0.25, 0.6, 3.0)))
            assert not s.printer.state.halted
        assert any("braked to a stop" in line for line in s.host.heard)
        assert s.board.device.fault == ""
        assert steps(s) == wanted


def test_disturbed_print_takes_up_gaps_after_link_losses(geared_whole):
    card, wanted = geared_whole
    assert lose_links(GEARED, card, wanted, random.Random(1), (50, 100, 200)) > 3


@pytest.mark.parametrize(("kind", "jerk_mm_s3"), [("delta", 2e5), ("corexy", None), ("i3", 2e5)])
def test_filtered_print_of_coupled_motors_survives_link_losses(tmp_path, kind, jerk_mm_s3):
    """Towers follow the shaped nozzle, belts both shaped axes, also in the tails of commits."""
    card, wanted = undisturbed(tmp_path, kind)
    assert lose_links(filtered(kind, jerk_mm_s3), card, wanted, random.Random(7)) > 3


def test_homing_finds_the_switches_as_without_filters():
    def homed(machine):
        with Scenario(machine) as s:
            s.host.ok("G28", 60)
            s.host.ok("G1 X20 Y20 F6000")
            s.host.ok("G28", 60)
            return s.host.ok("M114"), steps(s)

    assert homed(FILTERED) == homed(_I3)
