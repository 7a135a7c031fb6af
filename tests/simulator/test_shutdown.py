"""Everything that shuts a board down, and what it then does and refuses."""

from __future__ import annotations

import pytest
from tests.support.raw_board import RawBoard

FIRST = "queue_step oid=0 interval=1000 count=10 add=0"


@pytest.fixture
def board() -> RawBoard:
    raw = RawBoard()
    raw.configure()
    return raw


@pytest.mark.parametrize(
    ("wait", "text", "fault"),
    [
        (0, "emergency_stop", "Command request"),
        (0, "queue_step oid=0 interval=1000 count=0 add=0", "Invalid count parameter"),
        (1001, FIRST, "Timer too close"),
        (17_000, FIRST, "Timer too close"),
        (17_001, FIRST, "Stepper too far in past"),
        (0, "queue_step oid=0 interval=100 count=20 add=-10", "Stepper too far in past"),
        (0, "queue_step oid=2 interval=1000 count=1 add=0", "Invalid oid type"),
        (0, "queue_step oid=99 interval=1000 count=1 add=0", "Invalid oid type"),
        (0, "set_next_step_dir oid=5 dir=1", "Invalid oid type"),
        (0, "queue_pwm_out oid=2 clock={now} value=1", "Invalid oid type"),
        (0, "queue_digital_out oid=2 clock={past} on_ticks=1", "Timer too close"),
        (0, "query_analog_in oid=4 clock={past} sample_ticks=1 sample_count=1 rest_ticks=1000"
            " bytes_per_report=2 min_value=0 max_value=1023 range_check_count=1",
         "Timer too close"),
        (0, "query_analog_in oid=4 clock={now} sample_ticks=1 sample_count=1 rest_ticks=1"
            " bytes_per_report=2 min_value=0 max_value=1023 range_check_count=1",
         "Period too short for this board"),
        (0, "endstop_home oid=5 clock={past} sample_ticks=200 sample_count=4 rest_ticks=1000"
            " pin_value=1 trsync_oid=6 trigger_reason=1", "Timer too close"),
        (0, "endstop_home oid=5 clock={now} sample_ticks=200 sample_count=4 rest_ticks=1000"
            " pin_value=1 trsync_oid=0 trigger_reason=1", "Invalid oid type"),
        (0, "endstop_home oid=5 clock={now} sample_ticks=1 sample_count=2 rest_ticks=1000"
            " pin_value=1 trsync_oid=6 trigger_reason=1", "Period too short for this board"),
        (0, "allocate_oids count=3", "Can't assign oid"),
        (0, "config_trsync oid=7", "Can't assign oid"),
        (0, "finalize_config crc=1", "Configuration is finalized already"),
    ],
)  # fmt: skip
def test_a_misuse_shuts_the_board_down(board, wait, text, fault):
    board.wait(wait)
    values = {"now": board.clock(0), "past": board.clock(-1)}
    said = board.tell(text.format(**values))
    names = board.dictionary.enumerations["static_string_id"]
    assert said == [("shutdown", {"clock": board.clock(0), "static_string_id": names[fault]})]
    assert board.device.fault == fault
    assert board.device.stopped


@pytest.mark.parametrize("payload", [b"\x60\x7f", b"\x02\x00\x80", b"\x80\x80\x80\x80\x80\x80"])
def test_a_payload_that_is_not_a_command_shuts_the_board_down(board, payload):
    board.feed(payload)
    assert board.device.fault == "Command parser error"


def test_commands_before_the_configuration_are_refused():
    board = RawBoard()
    board.tell(FIRST)
    assert board.device.fault == "Invalid oid type"
    board = RawBoard()
    board.tell("allocate_oids count=1")
    board.tell("config_stepper oid=0 step_pin=PF0 dir_pin=PF1 invert_step=0 step_pulse_ticks=32")
    board.tell(FIRST)
    assert board.device.fault == "Command before finalize_config"


@pytest.mark.parametrize(
    "command",
    [
        "allocate_oids count=256",
        "query_analog_in oid=4 clock=1000000 sample_ticks=1 sample_count=256 rest_ticks=1000"
        " bytes_per_report=2 min_value=0 max_value=65535 range_check_count=0",
        "query_analog_in oid=4 clock=1000000 sample_ticks=1 sample_count=1 rest_ticks=1000"
        " bytes_per_report=2 min_value=0 max_value=65536 range_check_count=0",
    ],
)
def test_a_value_beyond_its_type_is_refused(command):
    board = RawBoard()
    board.configure()
    board.tell(command)
    assert board.device.fault == "Command parser error"


def test_a_step_in_time_is_executed_whenever_it_comes(board):
    board.wait(1000)
    board.tell(FIRST)
    board.wait(9000)
    board.tell(FIRST)
    board.wait(9999)
    assert board.simulated.net_steps("x") == -19
    board.wait(1)
    assert board.simulated.net_steps("x") == -20
    assert board.device.fault == ""


def test_the_slot_of_a_command_is_free_when_it_begins():
    board = RawBoard(move_count=16)
    board.configure()
    board.wait(999)
    for _ in range(16):
        board.tell("queue_step oid=0 interval=1000 count=2 add=0")
    board.tell("queue_step oid=0 interval=1000 count=2 add=0")
    assert board.device.fault == ""
    board.tell("queue_step oid=0 interval=1000 count=2 add=0")
    assert board.device.fault == "Move queue overflow"
    board = RawBoard(move_count=16)
    board.configure()
    for _ in range(60):
        board.tell("queue_step oid=0 interval=1000 count=2 add=0")
        board.wait(1800)
    assert board.device.fault == ""


def test_pin_updates_hold_slots_until_their_clock():
    board = RawBoard(move_count=4)
    board.configure()
    for i in range(4):
        board.tell(f"queue_digital_out oid=2 clock={board.clock(1000 + i)} on_ticks={i % 2}")
    assert board.device.fault == ""
    board.tell(f"queue_digital_out oid=2 clock={board.clock(2000)} on_ticks=1")
    assert board.device.fault == "Move queue overflow"


def test_a_clock_is_not_reset_under_steps(board):
    board.tell(FIRST)
    board.wait(500)
    board.tell(f"reset_step_clock oid=0 clock={board.clock(0)}")
    assert board.device.fault == "Can't reset time when stepper active"


def test_an_output_is_not_updated_over_its_queue(board):
    board.tell(f"queue_digital_out oid=2 clock={board.clock(1000)} on_ticks=1")
    board.tell("update_digital_out oid=2 value=1")
    assert board.device.fault == "Output updated while its queue holds commands"


def test_a_heater_that_is_renewed_too_late_is_cut_off_before(board):
    board.simulated.trace_output("hotend")
    start = board.now
    for at in (100, 100 + 2001):
        board.tell(f"queue_digital_out oid=7 clock={board.clock(at)} on_ticks=1")
    board.wait(10_000)
    assert board.device.fault == "Missed scheduling of next digital out event"
    assert board.simulated.take_changes("hotend") == [(start + 100, 1), (start + 2100, 0)]


def test_a_heater_that_is_not_renewed_is_cut_off(board):
    board.simulated.trace_output("hotend")
    start = board.now
    for i in range(3):
        board.tell(f"queue_digital_out oid=7 clock={board.clock(100)} on_ticks=1")
        board.wait(1900 if i < 2 else 1999 + 100)
        assert board.device.fault == ""
    said = board.wait(1)
    assert board.device.fault == "Missed scheduling of next digital out event"
    assert said[0][1]["clock"] == board.clock(0)
    assert board.simulated.take_changes("hotend") == [(start + 100, 1), (board.now, 0)]


def test_a_heater_that_is_off_needs_no_renewal(board):
    board.tell("update_digital_out oid=7 value=1")
    board.wait(1000)
    board.tell("update_digital_out oid=7 value=0")
    board.wait(100_000)
    assert board.device.fault == ""


def test_motion_stops_at_once_and_outputs_go_to_their_default(board):
    board.tell("update_digital_out oid=2 value=1")
    board.tell(FIRST)
    board.tell(FIRST)
    board.wait(3500)
    board.tell("emergency_stop")
    board.wait(100_000)
    assert board.simulated.net_steps("x") == -3
    assert board.simulated.output_value("fan") == 0


def test_after_a_shutdown_only_questions_are_answered(board):
    board.tell("emergency_stop")
    reason = board.dictionary.enumerations["static_string_id"]["Command request"]
    refused = [("is_shutdown", {"static_string_id": reason})]
    assert board.tell(FIRST) == refused
    assert board.tell("update_digital_out oid=2 value=1") == refused
    assert board.simulated.output_value("fan") == 0
    assert board.tell("get_clock") == [("clock", {"clock": board.clock(0)})]
    assert board.tell("get_config")[0][1]["is_shutdown"] == 1
    assert board.tell("debug_ping data=07") == [("pong", {"data": b"\x07"})]
    assert board.tell("emergency_stop") == []


def test_steps_after_a_cleared_shutdown_wait_for_the_clock(board):
    board.tell("emergency_stop")
    assert board.tell("clear_shutdown") == []
    board.tell(FIRST)
    board.wait(20_000)
    assert board.simulated.steps("x") == 0
    board.tell(f"reset_step_clock oid=0 clock={board.clock(0)}")
    board.tell(FIRST)
    board.wait(20_000)
    assert board.simulated.steps("x") == 10


def test_reset_forgets_the_configuration(board):
    board.tell("emergency_stop")
    assert board.tell("reset") == [("starting", {})]
    board.sequence = 0
    assert board.tell("get_config") == [
        ("config", {"is_config": 0, "crc": 0, "is_shutdown": 0, "move_count": 0})
    ]
    board.configure()
    assert board.device.fault == ""
