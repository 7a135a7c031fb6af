"""A print that is paused, hurried and asked again and again ends where it would have ended. One
example of each kind; test_disturbances.py makes many."""

import random

import pytest
from tests.support.disturbed_prints import disturb, shift_by_babysteps, steps, undisturbed
from tests.support.scenario import Scenario


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    return undisturbed(tmp_path_factory.mktemp("card"))


def test_disturbed_print_ends_at_same_steps(whole):
    card, wanted = whole
    with Scenario("i3", card=str(card)) as s:
        disturb(s, random.Random(0), lambda: None)
        assert steps(s) == wanted


def test_babysteps_shift_print_by_their_sum(whole):
    card, wanted = whole
    with Scenario("i3", card=str(card)) as s:
        assert shift_by_babysteps(s, random.Random(1), wanted)["z"] != 0


@pytest.fixture(scope="module")
def end_s(whole):
    """Of print time, if nothing disturbs it."""
    with Scenario("i3", card=str(whole[0])) as s:
        s.host.ok("M32 a.g")
        s.host.expect("Done printing", 900)
        return s.printer.rig.queue.now_s


@pytest.mark.parametrize("before_end_s", [0.2, 0.7, 100])
@pytest.mark.parametrize("pauses", [[["M25", "M24"]], [["M25"], ["M24", "M25"], ["M24"]]])
def test_a_pause_that_is_over_at_once_takes_nothing_back(whole, end_s, before_end_s, pauses):
    """Filament that was taken back comes again, and the end of a file is not left out."""
    card, wanted = whole
    with Scenario("i3", card=str(card)) as s:
        s.host.ok("M32 a.g")
        s.passes(end_s - before_end_s)
        for words in pauses:
            s.host.send(*words)
            s.passes(0.0 if words == pauses[-1] else 3.0)
        s.host.expect("Done printing", 900)
        assert steps(s) == wanted
