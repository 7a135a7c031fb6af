"""The width of the filament is measured; the flow follows it where this filament is extruded."""

from __future__ import annotations

from pathlib import Path

import pytest
from tests.support.filament_printer import ENDED, printing, with_inputs
from tests.support.scenario import Scenario

from passo.config.machine import MachineConfig
from passo.job.live.job_state import JobState

SENSOR = """[filament_sensors.meter]
kind = "width"
pin = "A11"
{}
[filament_sensors.meter.width]
second_pin = "A12"
readings = [0, 20000]
diameters_mm = [0, 2.5]
distance_mm = 20.0
interval_mm = 2.0
{}
"""
FAULT = "SIMULATE_FAULT NAME=filament-meter VALUE={}"


def with_meter(keys: str = "", width: str = "") -> MachineConfig:
    return with_inputs(SENSOR.format(keys, width))


def thin(s: Scenario) -> object:
    """The factor of the diameter that is measured."""
    measured = s.printer.status.read().filament_sensors["meter"].diameter_mm
    assert measured == pytest.approx(1.70, abs=0.003)  # a step of the converter
    return pytest.approx((1.75 / measured) ** 2, rel=1e-6)


def extrusion(count: int = 100) -> list[str]:
    """Moves of 1 mm of filament each, at 2 mm of filament a second."""
    return [f"G1 X{50 + 20 * (i % 2)} E1 F2400" for i in range(count)]


def test_flow_follows_the_width_where_it_is_extruded(tmp_path: Path):
    with Scenario(with_meter(), card=str(tmp_path)) as s:
        printing(s, tmp_path, *extrusion())
        s.passes(20)
        at_mm = s.positions()["e"]
        assert 30 < at_mm < 50
        s.host.ok(FAULT.format("width:1.70"))
        s.passes(15)
        begun_mm = s.positions()["e"]
        assert begun_mm > at_mm + 20 + 2
        status = s.printer.status.read().filament_sensors["meter"]
        assert status.flow_factor == pytest.approx(1.0597, abs=0.003)
        assert status.diameter_mm == pytest.approx(1.70, abs=0.003)
        assert s.printer.status.read().flow_factors == [1.0]  # that of M221 stays
        s.host.expect("^Done printing file$", 100)
        s.passes(1)
        # p mm at the nominal width, the rest of 100 mm at the other one
        factor = status.flow_factor
        place_mm = (100 * factor - s.positions()["e"]) / (factor - 1)
        assert at_mm + 20 <= place_mm + 1.5
        assert place_mm <= at_mm + 20 + 2 + 1.5


def test_m221_and_the_width_multiply_and_end_apart(tmp_path: Path):
    with Scenario(with_meter(width="corrects_at_once = true"), card=str(tmp_path)) as s:
        s.host.ok(FAULT.format("width:1.70"))
        s.passes(1)
        [factor] = s.printer.rig.job.filament.width_factors
        assert factor == thin(s)
        printing(s, tmp_path, "M221 S90", *extrusion(40))
        s.host.expect("^Done printing file$", 100)
        s.passes(1)
        assert s.positions()["e"] == pytest.approx(40 * 0.9 * factor, abs=0.02)
        assert s.host.ok("M221")[0] == "echo:E0 Flow: 90%"
        s.host.ok("M406")
        assert s.printer.rig.job.filament.width_factors == [1.0]
        assert s.printer.rig.job.filament.flows == [0.9]


def test_width_beyond_the_difference_does_not_change_the_flow(tmp_path: Path):
    with Scenario(with_meter(width="corrects_at_once = true\nmax_mm = 3.0")) as s:
        for diameter, followed in ((1.53, False), (1.57, True), (1.97, False)):
            s.host.ok(FAULT.format(f"width:{diameter}"))
            s.passes(1)
            [factor] = s.printer.rig.job.filament.width_factors
            measured = s.printer.status.read().filament_sensors["meter"].diameter_mm
            assert measured == pytest.approx(diameter, abs=0.003)
            assert factor == ((1.75 / measured) ** 2 if followed else 1.0)


@pytest.mark.parametrize("fault", ["out", "width:0.9", "width:1.96"])
def test_missing_or_wrong_filament_pauses_the_print(tmp_path: Path, fault: str):
    with Scenario(with_meter(), card=str(tmp_path)) as s:
        printing(s, tmp_path, *extrusion())
        s.passes(10)
        s.host.ok(FAULT.format(fault))
        s.host.expect(ENDED, 2)
        s.passes(6)
        assert s.assembly.services.jobs.runner.state is JobState.PAUSED
        s.host.ok(FAULT.format("none"))
        s.passes(1)
        s.host.ok("M24")
        s.host.expect("^Done printing file$", 200)
        s.passes(1)
        assert s.positions()["e"] == pytest.approx(100, abs=0.3)


def test_commands_report_and_set_the_measurement():
    with Scenario(with_meter("", "measures = false")) as s:
        s.host.ok(FAULT.format("width:1.70"))
        s.passes(1)
        raw = "// ADC1=6804 ADC2=6804 RAW=13607"  # 13600 in steps of a converter with 10 bits
        assert s.host.ok("QUERY_RAW_FILAMENT_WIDTH")[0] == raw
        assert s.host.ok("M407")[1] == "// Width sensor: OFF, flow factor of the width: 1.0000"
        s.host.ok("ENABLE_FILAMENT_WIDTH_SENSOR FLOW_COMPENSATION=0")
        s.host.ok("ENABLE_FILAMENT_WIDTH_LOG")
        s.host.ok("M302 P1")
        s.host.ok("G92 E0")
        s.host.send("G1 E60 F600")
        s.host.expect(r"^// Filament width: 1\.70\d mm$", 20)
        s.passes(10)
        assert s.printer.rig.job.filament.width_factors == [1.0]
        s.host.ok("M405 D1")  # cm; measured again from here on
        s.host.ok("ENABLE_FILAMENT_WIDTH_SENSOR FLOW_COMPENSATION=1")
        s.host.ok("G1 E80 F600")
        s.host.ok("M400")
        s.passes(1)
        [factor] = s.printer.rig.job.filament.width_factors
        assert factor == thin(s)
        report = f"// Width sensor: ON, flow factor of the width: {factor:.4f}"
        assert s.host.ok("QUERY_FILAMENT_WIDTH")[1] == report
        s.host.ok("RESET_FILAMENT_WIDTH_SENSOR")
        assert s.printer.rig.job.filament.width_factors == [1.0]
        s.host.ok("M404 W1.70")
        assert s.host.ok("M404")[0] == "echo:Filament dia (nominal mm): 1.7"
        s.host.ok("DISABLE_FILAMENT_WIDTH_LOG")
        s.host.ok("DISABLE_FILAMENT_WIDTH_SENSOR")


def test_restart_measures_from_the_beginning(tmp_path: Path):
    with Scenario(with_meter(width="corrects_at_once = true"), card=str(tmp_path)) as s:
        s.host.ok(FAULT.format("width:1.70"))
        s.passes(1)
        s.host.ok("M112")
        s.passes(1)
        s.host.send("M999")
        s.host.expect("ready again", 30)
        s.passes(1)
        status = s.printer.status.read().filament_sensors["meter"]
        assert (status.detected, status.measures) == (True, True)
        assert s.printer.rig.job.filament.width_factors == [thin(s)]
