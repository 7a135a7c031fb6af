"""A print that is paused, hurried and asked again and again ends where it would have ended."""

import random

import pytest
from tests.console.scenario import Scenario
from tests.job.disturbed import disturb, shift_by_babysteps, steps, undisturbed


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    return undisturbed(tmp_path_factory.mktemp("card"))


@pytest.mark.parametrize("seed", range(12))
def test_it_ends_where_it_would_have_ended(whole, seed):
    card, wanted = whole
    with Scenario("i3", card=str(card)) as s:
        disturb(s, random.Random(seed), lambda: None)
        assert steps(s) == wanted


@pytest.mark.parametrize("seed", range(12))
def test_babysteps_shift_it_by_their_sum(whole, seed):
    card, wanted = whole
    with Scenario("i3", card=str(card)) as s:
        assert shift_by_babysteps(s, random.Random(seed), wanted)["z"] != 0
