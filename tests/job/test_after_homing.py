"""A motor that homing has stopped gets its clock anew, even if a cut came before its first step."""

import pytest
from tests.support.scenario import Scenario

PROGRAM = "G28\nG1 Z30 F300\nG1 X50 F6000\nG1 X60\nM400\n"


@pytest.mark.parametrize("between", [(), ("M220 S50",), ("M290 Z0.1",), ("M25", "M24")])
def test_motor_moves_if_plan_was_cut_before_first_step(between, tmp_path):
    (tmp_path / "a.g").write_text(PROGRAM)
    with Scenario("i3", card=str(tmp_path)) as s:
        s.host.send("M32 a.g")
        assert s.until(lambda: s.positions()["z"] < 0.01 and not s.printer.rig.job.locked_axes, 60)
        assert s.until(lambda: s.positions()["z"] > 29.0, 60)
        for line in between:
            s.host.ok(line)
            s.passes(2.5 if line == "M25" else 0)
        s.passes(15)
        assert s.positions()["x"] == pytest.approx(60.0, abs=0.1)
