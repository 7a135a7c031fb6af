"""The library's plan and its steps are those of a print."""

from __future__ import annotations

import pytest

import passo
from passo.job.batch.policy import Policy
from passo.job.batch.step_trace import trace_steps

PROGRAMS = {  # steps of each motor
    "delta": (
        "G28\nG1 X30 Y25 Z20 F3000\nG1 X10 Z10 E5\nG28\nG1 Z150\nG1 X5\n",
        {"a": 20146, "b": 18150, "c": 16498, "e": 2100},
    ),
    "i3": (
        "G28\nG1 X30 Y25 Z20 F3000 E4\nG92 E0 X0\nG1 X10 Z10 E5\nG28 X\nG1 X5\n",
        {"x": 3600, "y": 2000, "z": 12000, "e": 860},
    ),
    "scara": (
        "G28\nG1 X100 Y125 Z20 F3000\nG1 X80 Z10\n",
        {"a": 10750, "b": 9485, "z": 4800, "e": 0},
    ),
    "dual-extruder": (
        "G28\nG1 X30 E4 F3000\nT1\nG92 E0\nG1 X10 E5\nT0\nG1 X5 E3\nT1\nG1 X10 E6\nG28\nG1 X5 E9\n",
        {"x": 11600, "y": 0, "z": 0, "e": 573, "e1": 1051},
    ),
}


@pytest.mark.parametrize("name", PROGRAMS)
def test_ideal_times_of_steps_are_those_of_a_print(tmp_path, name):
    text, counts = PROGRAMS[name]
    path = tmp_path / "a.gcode"
    path.write_text(text)
    machine = passo.Machine.load(name)
    trace = trace_steps(machine.config, path, Policy(), ideal=True)
    found = {
        stepper: list(machine.step_times_s(machine.plan(path), stepper)) for stepper in trace.ideal
    }
    assert {stepper: len(times) for stepper, times in found.items()} == counts
    for stepper, times in found.items():
        assert times == [tick / trace.clock_hz for tick in trace.ideal[stepper]]


def test_unknown_motor_of_step_times_is_named():
    machine = passo.Machine.load("i3")
    with pytest.raises(ValueError, match="there is no motor 'y1', but x, y, z, e"):
        next(machine.step_times_s(iter(()), "y1"))
