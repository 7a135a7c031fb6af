"""Filament that ends, is stuck or is inserted: the print pauses, and resumes at its place."""

from __future__ import annotations

import pytest
from tests.support.filament_printer import (
    ENDED,
    INPUT,
    PARK,
    printing,
    turns,
    with_inputs,
    with_sensor,
)
from tests.support.macro_machine import macro
from tests.support.scenario import Host, Scenario

from passo.config.motion import Idle
from passo.job.live.job_state import JobState

ARCS = ["G1 X60 Y60 F3000", *["G2 X60 Y60 I10 J0 E2"] * 6]
RETRACTIONS = [line for turn in turns(20) for line in (turn, "G1 E-4 F600", "G1 E4 F600")]
HEATING = [*turns(4), "M109 S60", *turns(20)]
HOMING = [*turns(4), "G28", "G1 Z10 F3000", *turns(20)]


def ends_at(s: Scenario) -> dict[str, float]:
    s.host.expect("^Done printing file$", 400)
    s.passes(1)
    return s.positions()


def undisturbed(tmp_path, lines: list[str]) -> dict[str, float]:
    with Scenario(with_sensor(), card=str(tmp_path)) as s:
        printing(s, tmp_path, *lines)
        return ends_at(s)


def test_print_pauses_parks_and_resumes_when_the_filament_ends(tmp_path):
    with Scenario(with_sensor(length_mm=3.0), card=str(tmp_path)) as s:
        begin = s.positions()
        printing(s, tmp_path, *turns())
        s.host.expect(ENDED, 60)
        s.host.expect("^// action:paused", 1)
        s.host.expect(f"^// action:prompt_begin .*{ENDED}.*M24", 1)
        s.passes(6)
        parked, park = s.positions(), s.machine.park
        assert parked["x"] - begin["x"] == pytest.approx(PARK[0] - 20, abs=0.05)
        assert parked["y"] - begin["y"] == pytest.approx(PARK[1] - 20, abs=0.05)
        assert parked["z"] - begin["z"] == pytest.approx(park.raise_mm, abs=0.01)
        assert 3.0 <= parked["e"] + park.retract_mm <= 3.15  # braked at once
        s.board.force_input(INPUT, True)
        s.passes(1)
        s.host.ok("M24")
        end = ends_at(s)
        assert end["e"] == pytest.approx(4.0, abs=0.01)
        assert end == undisturbed(tmp_path, turns())


@pytest.mark.parametrize("lines", [ARCS, RETRACTIONS, HEATING, HOMING])
@pytest.mark.parametrize("at_s", [3.3, 6.1])
def test_no_line_and_no_step_is_lost_wherever_it_ends(tmp_path, lines, at_s):
    """At any moment: in an arc, a retraction, a wait for heat, homing."""
    expected = undisturbed(tmp_path, lines)
    with Scenario(with_sensor(), card=str(tmp_path)) as s:
        printing(s, tmp_path, *lines)
        s.passes(at_s)
        s.board.force_input(INPUT, False)
        s.host.expect(ENDED, 1)
        s.passes(20)
        assert s.assembly.services.jobs.runner.state is JobState.PAUSED
        s.board.force_input(INPUT, True)
        s.host.ok("M24")
        assert ends_at(s) == expected
        assert sum(ENDED in line and "action" not in line for line in s.host.heard) == 1


def test_print_without_filament_asks_before_its_first_move(tmp_path):
    with Scenario(with_sensor("delay_mm = 100.0"), card=str(tmp_path)) as s:
        s.board.force_input(INPUT, False)
        s.passes(1)
        printing(s, tmp_path, *turns(10))
        s.host.expect(ENDED, 1)
        s.passes(10)
        assert s.positions()["e"] == 0
        s.host.ok("M24")  # the user has decided
        s.host.expect("roll detects no filament; the print continues", 5)
        assert ends_at(s)["e"] == pytest.approx(1.0, abs=0.01)


def test_loss_during_a_pause_asks_when_the_print_resumes(tmp_path):
    with Scenario(with_sensor(), card=str(tmp_path)) as s:
        printing(s, tmp_path, *turns())
        s.passes(5)
        s.host.ok("M25")
        s.passes(5)
        s.board.force_input(INPUT, False)
        s.host.silent(5, ENDED)
        s.host.ok("M24")
        s.host.expect(ENDED, 10)
        assert s.assembly.services.jobs.runner.state is JobState.PAUSED


def test_flickering_switch_pauses_at_most_once_and_loses_nothing(tmp_path):
    with Scenario(with_sensor(), card=str(tmp_path)) as s:
        printing(s, tmp_path, *turns())
        s.passes(3)
        s.board.flicker(INPUT)
        s.host.silent(5, ENDED)  # no level stays
        s.board.force_input(INPUT, False)
        s.host.expect(ENDED, 1)
        s.board.flicker(INPUT)
        s.host.silent(20, ENDED)
        s.board.force_input(INPUT, True)
        s.passes(1)
        s.host.ok("M24")
        assert ends_at(s) == undisturbed(tmp_path, turns())


def test_filament_between_sensor_and_nozzle_is_used_first(tmp_path):
    with Scenario(with_sensor("delay_mm = 1.5"), card=str(tmp_path)) as s:
        printing(s, tmp_path, *turns())
        s.passes(5)
        at_mm = s.positions()["e"]
        s.board.force_input(INPUT, False)
        s.host.expect(ENDED, 60)
        assert s.positions()["e"] - at_mm == pytest.approx(1.5, abs=0.15)
        s.host.ok("M412 D0")
        assert s.host.ok("M412")[0] == "echo:Filament runout ON ; Distance 0mm"


def test_pause_unloads_and_resume_loads_and_purges(tmp_path):
    machine = with_sensor("unload_mm = 50.0\nload_mm = 80.0")
    with Scenario(machine, card=str(tmp_path)) as s:
        printing(s, tmp_path, *turns(20))
        s.passes(4)
        s.board.force_input(INPUT, False)
        s.host.expect(ENDED, 1)
        at_mm = s.positions()["e"]
        s.passes(40)
        gone = at_mm - s.positions()["e"]
        assert gone == pytest.approx(50 + s.machine.park.retract_mm, abs=0.2)
        s.board.force_input(INPUT, True)
        s.host.ok("M24")
        assert ends_at(s)["e"] == pytest.approx(2.0 + 30, abs=0.01)


def test_long_runout_pause_keeps_the_bed_warm(tmp_path):
    machine = with_sensor()
    machine = machine.model_copy(update={"idle": Idle(heaters_off_s=60.0)})
    with Scenario(machine, card=str(tmp_path)) as s:
        printing(s, tmp_path, "M140 S50", "M104 S180", *turns(200))
        s.passes(8)
        s.board.force_input(INPUT, False)
        s.host.expect(ENDED, 1)
        s.passes(s.machine.idle.heaters_off_s + 20)
        status = s.printer.status.read()
        assert (status.heaters["hotend"].target_c, status.heaters["bed"].target_c) == (0, 50)
        assert status.cooled_c == {"hotend": 180}
        assert status.motion.motors_on


def test_switched_off_sensor_does_nothing(tmp_path):
    with Scenario(with_sensor(), card=str(tmp_path)) as s:
        s.host.ok("SET_FILAMENT_SENSOR SENSOR=Roll ENABLE=0")
        s.board.force_input(INPUT, False)
        s.passes(1)
        assert s.host.ok("QUERY_FILAMENT_SENSOR SENSOR=roll")[0] == (
            "// Filament Sensor roll: filament not detected"
        )
        printing(s, tmp_path, *turns(10))
        assert ends_at(s)["e"] == pytest.approx(1.0, abs=0.01)
        s.host.ok("M591 D0 S1")
        assert "enabled, filament present: no" in s.host.ok("M591 D0")[0]


def test_what_commands_set_is_stored_and_reset(tmp_path):
    machine, where = with_sensor(), {"state": str(tmp_path)}
    with Scenario(machine, **where) as s:
        assert "SET_FILAMENT_SENSOR SENSOR=roll ENABLE=1 DELAY_MM=0" in s.host.ok("M503")
        s.host.ok("M412 D80")
        s.host.ok("M591 D0 S0")
        told = "\n".join(s.host.ok("M500"))
        assert "SET_FILAMENT_SENSOR SENSOR=roll ENABLE=0, " in told
        assert "SET_FILAMENT_SENSOR SENSOR=roll DELAY_MM=80" in told
    with Scenario(machine, **where) as s:
        assert s.host.ok("M412")[0] == "echo:Filament runout OFF ; Distance 80mm"
        s.host.ok("M502")
        assert s.host.ok("M412")[0] == "echo:Filament runout ON ; Distance 0mm"
        s.host.ok("SET_FILAMENT_SENSOR SENSOR=roll ENABLE=0")
        s.host.ok("SET_FILAMENT_SENSOR SENSOR=roll DELAY_MM=5")  # as it is stored alone
        assert s.host.ok("M412")[0] == "echo:Filament runout OFF ; Distance 5mm"


def test_sensor_that_is_not_there_is_refused():
    with Scenario(with_sensor()) as s:
        told = s.host.ok("SET_FILAMENT_SENSOR SENSOR=other ENABLE=0")[0]
        assert "SENSOR" in told and "roll" in told


def test_runout_without_a_pause_runs_its_gcode(tmp_path):
    keys = 'on_runout = "none"\nrunout_gcode = "M118 {printer[\'%s\'].filament_detected}"'
    machine = with_sensor(keys % "filament_switch_sensor roll")
    with Scenario(machine, card=str(tmp_path)) as s:
        printing(s, tmp_path, *turns(20))
        s.passes(4)
        s.board.force_input(INPUT, False)
        s.host.expect("^False$", 2)
        assert s.assembly.services.jobs.runner.state is JobState.PRINTING
        assert ends_at(s)["e"] == pytest.approx(2.0, abs=0.01)


def test_inserted_filament_runs_its_gcode_once_while_nothing_prints(tmp_path):
    machine = with_sensor('insert_gcode = "M118 loaded"\nevent_delay_s = 5.0')
    with Scenario(machine, card=str(tmp_path)) as s:
        s.passes(1)
        s.board.force_input(INPUT, False)
        s.passes(1)
        s.board.force_input(INPUT, True)
        s.host.expect("^loaded$", 1)
        s.board.force_input(INPUT, False)
        s.passes(1)
        s.board.force_input(INPUT, True)
        s.host.silent(3, "loaded")  # within the event delay
        printing(s, tmp_path, *turns(20))
        s.passes(6)
        s.host.ok("SET_FILAMENT_SENSOR SENSOR=roll ENABLE=0")
        s.board.force_input(INPUT, False)
        s.passes(0.5)
        s.host.ok("SET_FILAMENT_SENSOR SENSOR=roll ENABLE=1")
        s.board.force_input(INPUT, True)
        s.host.silent(2, "loaded")  # a print is running


def test_macro_pause_parks_when_the_filament_ends(tmp_path):
    park = macro("PAUSE", "PAUSE_BASE\nG90\nG1 X77 Y77 F6000", rename_existing='"PAUSE_BASE"')
    machine = with_inputs('[filament_sensors.roll]\npin = "^D32"\n' + park)
    with Scenario(machine, card=str(tmp_path)) as s:
        begin = s.positions()
        printing(s, tmp_path, *turns())
        s.passes(5)
        s.board.force_input(INPUT, False)
        s.host.expect(f"prompt_begin .*{ENDED}", 5)
        s.passes(5)
        assert s.positions()["x"] - begin["x"] == pytest.approx(57, abs=0.05)
        s.board.force_input(INPUT, True)
        s.host.ok("M24")
        assert ends_at(s) == undisturbed(tmp_path, turns())


def test_print_of_a_host_pauses_and_returns(tmp_path):
    with Scenario(with_sensor()) as s:
        for line in ("M302 P1", "G92 X20 Y20 Z20 E0", "M83"):
            s.host.ok(line)
        begin = s.positions()
        lines = ["G1 X50 Y40 F6000", *turns(20)]
        s.host.send("M110 N0")
        s.host.expect("^ok")
        numbered = [f"N{n} {line}" for n, line in enumerate(lines, 1)]
        s.host.send(*(f"{line}*{checksum(line)}" for line in numbered))
        s.passes(4)
        s.board.force_input(INPUT, False)
        s.host.expect("^// action:pause", 2)
        s.host.expect(f"prompt_begin .*{ENDED}.*M108", 2)
        s.passes(10)
        assert s.positions()["x"] - begin["x"] == pytest.approx(PARK[0] - 20, abs=0.05)
        s.board.force_input(INPUT, True)
        Host(s).send("M108")
        s.host.expect("^// action:resume", 20)
        s.host.send("M400", "M118 end")
        s.host.expect("^end$", 60)
        end = s.positions()
        moved = [round(end[a] - begin[a], 2) for a in "xyze"]
        assert moved == [50, 39, 0, 2.0]


def checksum(line: str) -> int:
    total = 0
    for character in line.encode():
        total ^= character
    return total


def test_sensor_keeps_its_level_over_a_restart():
    with Scenario(with_sensor()) as s:
        s.board.force_input(INPUT, False)
        s.passes(1)
        s.host.ok("M112")
        s.passes(1)
        s.host.send("M999")
        s.host.expect("ready again", 30)
        s.passes(1)
        assert s.printer.status.read().filament_sensors["roll"].detected is False
        s.board.force_input(INPUT, True)
        s.passes(1)
        assert s.printer.status.read().filament_sensors["roll"].detected is True
