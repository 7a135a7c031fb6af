"""Arcs in prints from the card: tiny ones that name no circle."""

from __future__ import annotations

import pytest
from tests.support.scenario import Scenario

TINY = "G1 X97.767 Y171.872 F6000\nG2 X97.766 Y171.871 I-0 J-0 E0.00007\nG1 X100 Y171.871 E0.1\n"


@pytest.fixture
def printed(tmp_path):
    """Prints these lines from the card, between homing and a message."""
    with Scenario("i3", card=str(tmp_path)) as s:

        def run(text):
            (tmp_path / "arcs.g").write_text(f"M302 P1\nG28\nM83\nG1 Z5 F600\n{text}M118 after\n")
            s.host.ok("M32 arcs.g")
            return s

        yield run


def test_a_card_print_passes_a_tiny_arc(printed):
    s = printed(TINY)
    s.host.expect("^Done printing file$", 600)
    assert (s.positions()["x"], s.positions()["y"]) == (100, pytest.approx(171.871, abs=0.0063))
    assert s.positions()["e"] == pytest.approx(0.10007, abs=0.006)
