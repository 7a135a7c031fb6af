"""The link to a board breaks in mid-print, again and again: the print ends where it would have."""

import random

import pytest
from tests.console.scenario import Scenario
from tests.job.test_disturbed import disturb, spiral, steps

from passo import config

I3 = config.load("i3")
FIRMWARE = I3.model_copy(update={"board": I3.board.model_copy(update={"firmware": "passo"})})


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    card = tmp_path_factory.mktemp("card")
    (card / "a.g").write_text(spiral())
    with Scenario(FIRMWARE, card=str(card)) as s:
        s.host.ok("M32 a.g")
        s.host.expect("Done printing", 900)
        return card, steps(s)


def break_link(s, seconds):
    """The cable is out for so long."""
    port, drive = s.printer.connection.main.port, s.printer.drive
    port.unplug()
    s.passes(seconds)
    port.plug(drive.base + drive.now)
    s.board.device.poll(drive.base + drive.now)


@pytest.mark.parametrize("seed", range(12))
def test_it_ends_where_it_would_have_ended(undisturbed, seed):
    card, wanted = undisturbed
    generator = random.Random(seed)
    with Scenario(FIRMWARE, card=str(card)) as s:
        s.host.ok("M32 a.g")
        s.passes(14)  # it is at home by then
        breaks = 0
        while "Done printing file" not in s.host.heard:
            s.passes(generator.expovariate(0.5))
            if "Done printing file" in s.host.heard:
                break
            break_link(s, generator.choice((0.02, 0.3, 2.0, 40.0)))
            s.host.expect("The board is back", 10)
            breaks += 1
            assert not s.printer.halted
        assert breaks > 3
        assert s.board.device.fault == ""
        assert steps(s) == wanted


@pytest.mark.parametrize("seed", range(8))
def test_pauses_and_limits_beside_it(undisturbed, seed):
    card, wanted = undisturbed
    generator = random.Random(seed)
    with Scenario(FIRMWARE, card=str(card)) as s:

        def perhaps():
            if generator.random() < 0.5 and s.printer.drive.now_s > 14:
                break_link(s, generator.choice((0.02, 0.3, 2.0)))
                s.host.expect("The board is back", 10)

        disturb(s, generator, perhaps)
        assert s.board.device.fault == ""
        assert steps(s) == wanted
