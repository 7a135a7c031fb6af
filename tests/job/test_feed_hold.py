"""A feed hold is short wherever it comes: a command under way may last, and is not taken back."""

import random
from pathlib import Path

import pytest
from tests.console.scenario import Scenario

ARCS = ["G1 X120 Y100", "G2 I-20 J0 P2"]


@pytest.mark.parametrize("machine", ["i3", "corexy"])
def test_a_print_is_at_rest_within_250_ms(machine: str, tmp_path: Path):
    chance = random.Random(machine)
    lines = ["M204 P3000 T3000", "M203 X100 Y100", "G28", "G1 X100 Y100 Z20 F6000"]
    for _ in range(120):
        x, y = chance.uniform(10, 190), chance.uniform(10, 190)
        lines += [f"G1 X{x:.2f} Y{y:.2f}"] if chance.random() < 0.6 else ARCS
    (tmp_path / "moves.gcode").write_text("\n".join(lines) + "\n")
    longest = 0.0
    with Scenario(machine, card=str(tmp_path)) as s:
        s.host.ok("M32 moves.gcode")
        s.passes(30)
        for _ in range(40):
            s.passes(chance.uniform(0.3, 1.0))
            s.host.ok("M25")
            begun, last, at = s.loop.time(), s.loop.time(), s.positions()
            while s.loop.time() < last + 0.02:
                s.passes(0.005)
                if s.positions() != at:
                    at, last = s.positions(), s.loop.time()
            longest = max(longest, last - begun)
            s.passes(4)
            s.host.ok("M24")
            s.passes(4)
    assert 0.2 < longest <= 0.25
