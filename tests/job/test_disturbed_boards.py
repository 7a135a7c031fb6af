"""The disturbed prints of one board, on two: cuts, holds and new plans keep every step."""

import random
from functools import partial

import pytest
from tests.console.scenario import Scenario
from tests.job.test_disturbed import disturb, spiral, steps
from tests.job.two_boards import two_boards

from passo.printer.wiring import connect_simulated
from passo.simulator import Cable

WORLDS = {
    "alike": ((), None),
    "fast": (("drift_ppm = 100.0", "start_s = 250.0"), Cable(300e-6, 100e-6)),
    "slow": (("drift_ppm = -100.0", "start_s = 1.0"), Cable(0.0, 50e-6)),
}


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    card = tmp_path_factory.mktemp("card")
    (card / "a.g").write_text(spiral())
    with Scenario("i3", card=str(card)) as s:
        s.host.ok("M32 a.g")
        s.host.expect("Done printing", 900)
        return card, steps(s)


def scenario(monkeypatch, card, world, **more):
    keys, cable = WORLDS[world]
    monkeypatch.setattr("passo.printer.printer.connect", partial(connect_simulated, cable=cable))
    return Scenario(two_boards(*keys, **more), card=str(card))


@pytest.mark.parametrize("world", WORLDS)
@pytest.mark.parametrize("seed", range(4))
def test_it_ends_where_one_board_would_have_ended(monkeypatch, undisturbed, world, seed):
    card, wanted = undisturbed
    with scenario(monkeypatch, card, world) as s:
        disturb(s, random.Random(seed), lambda: None)
        assert steps(s) == wanted


@pytest.mark.parametrize("world", WORLDS)
@pytest.mark.parametrize("seed", range(3))
def test_babysteps_shift_it_by_their_sum(monkeypatch, undisturbed, world, seed):
    card, wanted = undisturbed
    generator = random.Random(seed)
    sums = {"x": 0.0, "z": 0.0}
    with scenario(monkeypatch, card, world) as s:

        def babystep():
            axis, mm = generator.choice("xzz"), generator.randrange(-20, 20) / 20
            if s.host.ok(f"M290 {axis}{mm}") == ["ok"]:
                sums[axis] += mm

        disturb(s, generator, babystep)
        s.host.ok("M400", 60)
        per_mm = {row["name"]: row["steps_per_unit"] for row in s.printer.job.steppers()}
        for name, net in steps(s).items():
            assert net == wanted[name] + round(sums.get(name, 0.0) * per_mm[name]), name
