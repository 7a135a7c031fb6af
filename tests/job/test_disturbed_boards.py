"""The disturbed prints of one board, on two: cuts, holds and new plans keep every step.
test_disturbances.py makes more of them."""

import random
from functools import partial

import pytest
from tests.support.disturbed_prints import disturb, shift_by_babysteps, steps, undisturbed
from tests.support.scenario import Scenario
from tests.support.two_boards import two_boards

from passo.printer.setup.connections import connect_simulated
from passo.simulator import Cable

WORLDS = {
    "fast": (("drift_ppm = 100.0", "start_s = 250.0"), Cable(300e-6, 100e-6)),
    "slow": (("drift_ppm = -100.0", "start_s = 1.0"), Cable(0.0, 50e-6)),
}


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    return undisturbed(tmp_path_factory.mktemp("card"))


def scenario(monkeypatch, card, world, **more):
    keys, cable = WORLDS[world]
    monkeypatch.setattr("passo.printer.printer.connect", partial(connect_simulated, cable=cable))
    return Scenario(two_boards(*keys, **more), card=str(card))


def test_disturbed_print_on_two_boards_ends_at_same_steps(monkeypatch, whole):
    card, wanted = whole
    with scenario(monkeypatch, card, "slow") as s:
        disturb(s, random.Random(0), lambda: None)
        assert steps(s) == wanted


def test_babysteps_shift_print_on_two_boards_by_their_sum(monkeypatch, whole):
    card, wanted = whole
    with scenario(monkeypatch, card, "fast") as s:
        shift_by_babysteps(s, random.Random(1), wanted)
