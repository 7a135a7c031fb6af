"""A feed hold is short wherever it comes: a command under way may last, and is not taken back."""

import math
import random
from array import array
from itertools import pairwise
from pathlib import Path

import pytest
from tests.support.scenario import Scenario

from passo import config

FIRMWARE = 'firmware = "passo"\n'
ARCS = ["G1 X120 Y100", "G2 I-20 J0 P2"]


@pytest.mark.parametrize("firmware", ["", FIRMWARE], ids=["virtual", "passo"])
@pytest.mark.parametrize("machine", ["i3", "corexy"])
def test_a_print_is_at_rest_within_250_ms(machine: str, firmware: str, tmp_path: Path):
    chance = random.Random(machine)
    lines = ["M204 P3000 T3000", "M203 X100 Y100", "G28", "G1 X100 Y100 Z20 F6000"]
    for _ in range(120):
        x, y = chance.uniform(10, 190), chance.uniform(10, 190)
        lines += [f"G1 X{x:.2f} Y{y:.2f}"] if chance.random() < 0.6 else ARCS
    (tmp_path / "moves.gcode").write_text("\n".join(lines) + "\n")
    longest = 0.0
    text = config.shipped_text(machine) + firmware
    with Scenario(config.load_text(text), card=str(tmp_path)) as s:
        s.host.ok("M32 moves.gcode")
        s.passes(30)
        motors = [stepper.name for stepper in s.board.board.steppers]
        for motor in motors:
            s.board.trace_steps(motor, 0, 2**62)
        for _ in range(40):
            s.passes(chance.uniform(0.3, 1.0))
            queue = s.printer.rig.queue
            begun = queue.base + queue.now
            s.host.ok("M25")
            s.passes(0.3)  # parking begins later
            steps = (array("q", s.board.take_steps(motor, begun, 2**62)[0]) for motor in motors)
            last = max(clocks[-1] for clocks in steps if clocks)
            longest = max(longest, (last - begun) / queue.hz)
            s.passes(4)
            s.host.ok("M24")
            s.passes(4)
    assert 0.2 < longest <= 0.25


def test_long_commands_hold_up_no_others(tmp_path: Path):
    """A command leaves by its end, so that a hold need not wait for it: here those of the extruder
    last, and bytes go evenly to the board all the same."""
    lines = ["M302 P1", "G92 X0 Y0 Z0 E0", "G1 X100 Y100 F6000"]
    for i in range(3000):
        x, y = 100 + 30 * math.cos(i / 20), 100 + 30 * math.sin(i / 20) + i % 2 * 0.2
        lines.append(f"G1 X{x:.3f} Y{y:.3f} E{i * 0.004:.4f}")
    (tmp_path / "dense.gcode").write_text("\n".join(lines) + "\n")
    with Scenario(config.load_text(config.shipped_text("i3") + FIRMWARE), card=str(tmp_path)) as s:
        s.host.ok("M32 dense.gcode")
        s.passes(6)
        link = s.printer.rig.connection.main.link
        sent = [link.wire_bytes]
        for _ in range(300):
            s.passes(0.01)
            sent.append(link.wire_bytes)
    most = max(b - a for a, b in pairwise(sent))
    assert (sent[-1] - sent[0]) / 300 > 40
    assert most < 220  # 302 where the others wait
