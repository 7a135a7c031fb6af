"""A print whose heater fails: it ends with the sentence, unless the machine file lets it go on."""

from __future__ import annotations

import pytest

from passo import config
from passo.errors import MachineError
from passo.job.batch.result import PrintResult
from passo.job.batch.simulated_print import Print

JOB = "M140 S60\nM109 S200\nG28\nG1 X20 F3000\nM190 S60\nG1 X40\nG4 S60\nG1 X20\n"


def prepared(on_fault: str) -> Print:
    text = config.shipped_text("i3")
    bed = "max_c = 120.0\n"
    return Print(config.load_text(text.replace(bed, f'{bed}on_fault = "{on_fault}"\n', 1)))


@pytest.fixture
def job(tmp_path):
    path = tmp_path / "job.gcode"
    path.write_text(JOB)
    return path


@pytest.mark.parametrize("on_fault", ["machine", "job"])
def test_a_print_ends_with_its_heater(job, on_fault):
    printing = prepared(on_fault)
    printing.board.force_heater("bed", 0.0)
    result = PrintResult("job", "i3")
    with pytest.raises(MachineError, match="its power differs from that of its model") as error:
        printing.run(job, result=result)
    assert result.warnings == []  # the error says it
    assert result.cpu_s["total"] > 0
    assert error.value.problems[0].code == "heat.model-deviation"
    assert error.value.status == 5
    assert {heater.target for heater in printing.connection.heaters.values()} == {0.0}
    assert [printing.board.output_value(name) for name in ("bed", "hotend")] == [0, 0]
    stopped = "Command request" if on_fault == "machine" else ""
    assert printing.board.device.fault == stopped


def test_a_print_continues_without_an_unused_heater(job):
    printing = prepared("heater")
    printing.board.force_heater("bed", 0.0)
    result = printing.run(job)
    assert result.errors == []
    assert [w.split(":")[0] for w in result.warnings] == ["heater bed was switched off"]
    assert result.final_steps["x"] == 20 * 80
    assert printing.connection.heaters["bed"].target == 60
    assert printing.board.output_value("bed") == 0
    assert printing.connection.heaters["hotend"].celsius == pytest.approx(200, abs=2)
