"""A fan that stops turning pauses the print."""

from __future__ import annotations

from tests.support.filament_printer import printing, turns, with_inputs
from tests.support.scenario import Scenario

from passo.job.live.job_state import JobState

TACHOMETER = """[fans.part.tachometer]
pin = "^D36"
min_rpm = 1000.0
on_fault = "job"
"""


def test_stalled_fan_pauses_the_print_once(tmp_path):
    with Scenario(with_inputs(TACHOMETER), card=str(tmp_path)) as s:
        s.host.ok("M106 S255")
        printing(s, tmp_path, *turns(20))
        s.passes(4)
        assert s.assembly.services.jobs.runner.state is JobState.PRINTING
        s.host.ok("SIMULATE_FAULT NAME=part-fan VALUE=stalled")
        s.host.expect("prompt_begin Fan part has power and turns at .* rpm.*M24", 8)
        assert s.assembly.services.jobs.runner.state is JobState.PAUSED
        s.host.ok("M24")
        s.host.expect("^Done printing file$", 100)


def test_fan_that_stalls_without_a_print_is_only_reported(tmp_path):
    with Scenario(with_inputs(TACHOMETER), card=str(tmp_path)) as s:
        s.host.ok("M106 S255")
        s.passes(5)
        s.host.ok("SIMULATE_FAULT NAME=part-fan VALUE=stalled")
        s.host.expect("fan part has power and turns at", 8)
        assert s.assembly.services.jobs.runner.state is JobState.NONE
