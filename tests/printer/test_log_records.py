"""What a printer writes to the log of standard `logging`: logger, level, code, and no secret."""

from __future__ import annotations

import logging

import pytest
from tests.job.test_lost_link import FIRMWARE, break_link
from tests.support.scenario import Scenario

from passo.board.fault_injection import FaultOrder

PART = "G28\nG1 X20 F3000\nG1 X40\n"


@pytest.fixture
def log(caplog):
    caplog.set_level(logging.INFO, "passo")
    return caplog


def records(log, level):
    """(logger without `passo.`, message, code) of the records of this level."""
    return [
        (r.name.removeprefix("passo."), r.getMessage(), getattr(r, "code", ""))
        for r in log.records
        if r.levelno == level and r.name.startswith("passo.")
    ]


def heat_with_fault(s, fault):
    s.host.ok("M104 S200")
    s.passes(5)
    s.printer.faults.order(FaultOrder.parse(fault))


def test_a_print_is_logged_with_its_start_and_its_end(log, tmp_path):
    (tmp_path / "part.g").write_text(PART)
    with Scenario(card=str(tmp_path)) as s:
        s.host.ok("M32 part.g")
        s.host.expect("Done printing", 120)
    info = records(log, logging.INFO)
    assert info[0] == (
        "printer.setup.connections",
        "Board main connected: firmware 0.1.0, 16 MHz, 401 move commands",
        "",
    )
    name = "job.live.statistics"
    prints = [text for logger, text, _ in info if logger == name]
    assert prints[0] == "Print of part.g started"
    assert prints[1].startswith("Print of part.g done after 0h 0m ")
    assert prints[1].endswith(", 0 mm of filament")
    assert records(log, logging.WARNING) == records(log, logging.ERROR) == []
    (end,) = [r for r in log.records if getattr(r, "outcome", "")]
    assert (end.file, end.outcome) == ("part.g", "done")
    assert 5 < end.seconds < 30


def test_a_print_that_fails_is_a_warning_with_its_code(log, tmp_path):
    (tmp_path / "part.g").write_text(PART + "G1 X999\n")
    with Scenario(card=str(tmp_path)) as s:
        s.host.ok("M32 part.g")
        s.host.expect("stopped", 120)
    ((logger, text, code),) = records(log, logging.WARNING)
    assert (logger, code) == ("job.live.runner", "input.out-of-range")
    assert text.startswith("Print of part.g stopped: part.g:4: ")


@pytest.mark.parametrize(
    ("policy", "level"), [("machine", logging.ERROR), ("job", logging.WARNING)]
)
def test_a_heater_fault_is_logged_by_what_it_stops(log, policy, level):
    with Scenario() as s:
        heaters = s.machine.heaters
        hotend = heaters["hotend"].model_copy(update={"on_fault": policy})
        s.printer.machine.heaters["hotend"] = hotend
        heat_with_fault(s, "hotend-sensor=open")
        s.passes(5)
    ((_, text, code),) = records(log, level)
    assert code == "heat.sensor-open"
    assert "heater hotend was switched off" in text
    (record,) = [r for r in log.records if getattr(r, "code", "") == code]
    assert (record.part, record.axis, record.levelno) == ("heat", "hotend", level)
    assert record.value < record.limit


def test_a_lost_link_is_a_warning_and_its_return_is_information(log):
    with Scenario(FIRMWARE) as s:
        s.host.ok("G28", 60)
        break_link(s, 2.0)
        s.host.expect("The board is back", 10)
    ((logger, text, code),) = records(log, logging.WARNING)
    assert (logger, code) == ("printer.recovery.reconnect", "machine.closed")
    assert text.startswith("The machine waits: ")
    back = "The board is back, at the position where it stopped"
    assert (logger, back, "") in records(log, logging.INFO)


def test_m112_is_an_error_and_m999_is_information(log):
    with Scenario() as s:
        s.host.ok("M112")
        s.passes(1)
        s.host.ok("M999")
    halt = "Printer halted: emergency stop by M112"
    assert records(log, logging.ERROR) == [("printer.state", halt, "machine.emergency-stop")]
    ready = "The printer is ready again. Home it before you move it"
    assert ("printer.printer", ready, "") in records(log, logging.INFO)


def test_a_fault_of_the_program_is_an_error_with_its_trace(log):
    def watch() -> None:
        raise ZeroDivisionError("seven by nothing")

    with Scenario() as s:
        s.printer.lifetime.as_time_passes(watch)
        s.passes(1)
    ((_, text, code),) = records(log, logging.ERROR)
    assert code == "machine.program"
    assert "ZeroDivisionError: seven by nothing" in text
    assert 'raise ZeroDivisionError("seven by nothing")' in log.text


def test_settings_that_are_stored_are_information(log, tmp_path):
    with Scenario(state=str(tmp_path)) as s:
        s.host.ok("M92 X81")
        s.host.ok("M500")
    stored = "Settings stored, as changed from the machine file: M92 X81"
    assert ("console.settings_commands", stored, "") in records(log, logging.INFO)


def test_refused_lines_are_warnings_with_their_console(log):
    with Scenario() as s:
        s.host.ok("G1 X999 F3000")
        s.host.send("N5 M105*1")
        s.host.expect("Resend")
    codes = [(text.partition(":")[0], code) for _, text, code in records(log, logging.WARNING)]
    assert codes == [
        ("axis X is not homed. Home it (G28), or set its position (G92).", "input.not-homed"),
        ("checksum mismatch, Last Line", ""),
    ]
    assert {r.console for r in log.records if r.levelno == logging.WARNING} == {1}


def test_console_lines_are_debug_records_without_passwords(log):
    with Scenario() as s:
        s.host.ok("M105")
        assert records(log, logging.DEBUG) == []
        log.set_level(logging.DEBUG, "passo")
        s.host.ok("M114")
        s.host.ok('M587 S"wlan" P"geheim"')
        s.host.ok("M551 Pgeheim")
    lines = [text for logger, text, _ in records(log, logging.DEBUG) if "lines" in logger]
    assert lines[0] == "> M114"
    assert lines[1].startswith("< X:0.000 Y:0.000 Z:0.000")
    assert lines[2] == "< ok"
    assert {"> M587 (not shown)", "> M551 (not shown)"} <= set(lines)
    assert "geheim" not in log.text


def test_without_a_handler_nothing_is_written_to_standard_error():
    handlers = logging.getLogger("passo").handlers
    assert [type(handler) for handler in handlers] == [logging.NullHandler]
