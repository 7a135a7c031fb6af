"""An i3 whose Z and extruder are on a second board, and the same on one board."""

from __future__ import annotations

import lzma
from array import array
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from pathlib import Path

import pytest

from passo.config.load import load_text, shipped_text
from passo.config.machine import MachineConfig
from passo.job.batch import simulated_print as printing
from passo.job.batch.result import PrintResult
from passo.job.batch.simulated_print import Print
from passo.simulator import Cable

ROOT = Path(__file__).parents[2]


def one_board(firmware: str = "virtual") -> MachineConfig:
    return load_text(shipped_text("i3").replace("[board]", f'[board]\nfirmware = "{firmware}"'))


def two_boards(*keys: str, base: str = "ramps", firmware: str = "virtual", **more: str):
    """`keys` stand in the table of the second board, `more` replace text of the i3's file."""
    text = shipped_text("i3").replace('socket = "Z"', 'socket = "tool:Z"')
    text = text.replace('socket = "E0"', 'socket = "tool:E1"')
    for old, new in more.items():
        assert old in text
        text = text.replace(old, new)
    text = text.replace("[board]", f'[board]\nfirmware = "{firmware}"')
    own = [f'base = "{base}"', f'firmware = "{firmware}"', *keys]
    return load_text("\n".join([text, "[boards.tool]", *own]))


@dataclass
class Edges:
    """What a print did: clocks since the job began and directions of each motor's steps, changes of
    each output."""

    result: PrintResult
    steps: dict[str, tuple[array, bytes]]
    outputs: dict[str, list[tuple[int, int]]]
    slack_s: dict[str, float]  # how long before its time each board had the most urgent command

    def skew_us(self, other: Edges, stepper: str) -> float:
        """The most by which a step of one comes earlier or later than in the other."""
        (mine, turns), (theirs, others) = self.steps[stepper], other.steps[stepper]
        assert len(mine) == len(theirs) > 0
        assert turns == others
        return max(abs(a - b) for a, b in zip(mine, theirs, strict=True)) / 16

    def gap_us(self, stepper: str) -> float:
        """The least time between two steps."""
        clocks, _ = self.steps[stepper]
        return min(b - a for a, b in pairwise(clocks)) / 16

    def turn_us(self, stepper: str) -> float:
        """The least time between two steps of opposite directions."""
        steps = zip(*self.steps[stepper], strict=True)
        return min(b - a for (a, way), (b, other) in pairwise(steps) if way != other) / 16


def printed(
    monkeypatch: pytest.MonkeyPatch, machine: MachineConfig, path: Path, cable: Cable | None = None
) -> Edges:
    with monkeypatch.context() as patch:
        connect = partial(printing.connect_simulated, cable=cable)
        patch.setattr("passo.job.batch.simulated_print.connect_simulated", connect)
        job = Print(machine)
    names = [o.name for o in job.connection.board.outputs]
    for name in names:
        job.board.trace_output(name)
    job.trace_until(1e6)
    result = job.run(path)
    steps = {}
    for stepper in job.connection.board.steppers:
        clocks, turns = job.board.take_steps(stepper.name, 0, 2**62)
        steps[stepper.name] = (array("q", (c - job.base for c in array("q", clocks))), turns)
    outputs = {
        name: [(clock - job.base, value) for clock, value in job.board.take_changes(name)]
        for name in names
    }
    slack = {c.name: c.link.min_slack.slack / c.board.clock_hz for c in job.connection.connections}
    return Edges(result, steps, outputs, slack)


def demo(folder: Path) -> Path:
    path = folder / "demo.gcode"
    path.write_bytes(lzma.decompress((ROOT / "examples/demo.gcode.xz").read_bytes()))
    return path
