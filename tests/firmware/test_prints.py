"""Whole prints on the firmware: every edge of every pin, at its tick."""

from __future__ import annotations

import lzma
from pathlib import Path

import pytest

from passo import config
from passo.job.batch.simulated_print import Print

ROOT = Path(__file__).parents[2]
LASER = """\
G21
G90
M3 S0
G1 X10 Y10 F3000
G1 X30 S120 F1200
G1 Y30 S255
G1 X10 Y10 S40
M5
"""


def program(name: str) -> str:
    if name == "laser":
        return LASER
    folder = "examples" if name == "demo" else "tests/data"
    return lzma.open(ROOT / folder / f"{name}.gcode.xz", "rt", encoding="utf-8").read()


def printed(path: Path, machine: str, firmware: str) -> tuple[Print, dict[str, object]]:
    """The print, done; and all that its board did."""
    chosen = config.load(machine)
    board = chosen.board.model_copy(update={"firmware": firmware})
    job = Print(chosen.model_copy(update={"board": board}))
    names = [o.name for o in job.connection.board.outputs]
    for name in names:
        job.board.trace_output(name)
    job.trace_until(1e9)
    result = job.run(path)
    seen: dict[str, object] = {name: job.board.take_changes(name) for name in names}
    for stepper in job.connection.board.steppers:
        seen[stepper.name] = job.board.take_steps(stepper.name, 0, 2**62)
    seen["print time"] = result.print_time_s
    seen["stream"] = result.stream_hash
    seen["net steps"] = result.final_steps
    seen["refused frames"] = job.board.device.naks
    seen["planned"] = result.net_steps_expected
    return job, seen


@pytest.mark.parametrize(
    ("name", "machine"),
    [("demo", "i3"), ("gear_arcs", "mk3s"), ("plate_toolchanger", "dual-extruder"),
     ("laser", "laser")],
)  # fmt: skip
def test_the_firmware_does_what_the_model_of_a_board_does(tmp_path, name, machine):
    path = tmp_path / "program.gcode"
    path.write_text(program(name), encoding="utf-8")
    _, model = printed(path, machine, "virtual")
    job, firmware = printed(path, machine, "passo")
    assert firmware == model
    assert firmware["net steps"] == firmware["planned"]
    assert sum(map(len, (firmware[s.name][0] for s in job.connection.board.steppers))) == 8 * sum(
        job.board.steps(s.name) for s in job.connection.board.steppers
    )


def test_the_laser_goes_fifty_millimetres_each_way(tmp_path):
    path = tmp_path / "program.gcode"
    path.write_text(LASER, encoding="utf-8")
    job, _ = printed(path, "laser", "passo")
    assert [job.board.steps(s.name) for s in job.connection.board.steppers] == [4000, 4000, 0]
