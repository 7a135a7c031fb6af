"""Outputs and analog inputs: edges of software PWM, maximum durations, limits that cut the heat."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.support.raw_board import RawBoard

CYCLE = 1000
LONGEST = 2000  # of oid 7 in RawBoard.configure()


def pulsed() -> tuple[RawBoard, int]:
    """A board whose fan (oid 2) is pulsed by its software; and the fan's pin."""
    board = RawBoard()
    for line in (
        "allocate_oids count=3",
        "config_digital_out oid=2 pin=PH6 value=0 default_value=0 max_duration=0",
        f"set_digital_out_pwm_cycle oid=2 cycle_ticks={CYCLE}",
        "finalize_config crc=1",
    ):
        board.tell(line)
    pin = board.dictionary.enumerations["pin"]["PH6"]
    board.device.trace_edges(pin)
    return board, pin


def edges(changes: list[tuple[int, int]], end: int) -> list[tuple[int, int]]:
    """What a pin does that takes these values (clock, ticks on), until `end`."""
    found: list[tuple[int, int]] = []
    level = 0

    def drive(clock: int, to: int) -> None:
        nonlocal level
        if to != level:
            found.append((clock, to))
        level = to

    for i, (clock, value) in enumerate(changes):
        until = changes[i + 1][0] if i + 1 < len(changes) else end + 1
        drive(clock, int(value > 0))
        if 0 < value < CYCLE:
            for begin in range(clock, until, CYCLE):
                if begin > clock:
                    drive(begin, 1)
                if begin + value < until:
                    drive(begin + value, 0)
    return found


@settings(max_examples=300)
@given(
    st.lists(
        st.tuples(st.integers(1, 5000), st.one_of(st.integers(0, CYCLE), st.just(2**32 - 1))),
        min_size=1,
        max_size=10,
    )
)
def test_software_pwm_has_the_edges_of_its_values(rows):
    board, pin = pulsed()
    clock = board.now
    changes: list[tuple[int, int]] = []
    for delay, value in rows:
        clock += delay
        board.tell(f"queue_digital_out oid=2 clock={clock & 0xFFFFFFFF} on_ticks={value}")
        changes.append((clock, min(value, CYCLE)))
    end = clock + 5500
    board.wait(end - board.now)
    assert board.device.take_edges(pin) == edges(changes, end)
    board.tell("emergency_stop")
    board.wait(10 * CYCLE)
    assert [level for _, level in board.device.take_edges(pin)] in ([], [0])


@pytest.mark.parametrize("cycle", [2 * CYCLE, CYCLE // 4])
def test_a_new_cycle_begins_with_the_next_value(cycle):
    board, pin = pulsed()
    begin = board.now + 100
    board.tell(f"queue_digital_out oid=2 clock={begin & 0xFFFFFFFF} on_ticks=300")
    board.wait(100 + CYCLE)
    board.tell(f"set_digital_out_pwm_cycle oid=2 cycle_ticks={cycle}")
    board.wait(2 * CYCLE)
    change = begin + 4 * CYCLE
    board.tell(f"queue_digital_out oid=2 clock={change & 0xFFFFFFFF} on_ticks=200")
    board.wait(CYCLE + 2 * cycle)
    assert board.device.fault == ""
    before = [(begin + i * CYCLE + at, 1 - at // 300) for i in range(4) for at in (0, 300)]
    after = [(change + i * cycle + at, 1 - at // 200) for i in range(2) for at in (0, 200)]
    assert board.device.take_edges(pin)[:12] == before + after


def test_a_new_cycle_is_refused_while_a_value_waits():
    board, _ = pulsed()
    board.tell(f"queue_digital_out oid=2 clock={board.clock(1000)} on_ticks=300")
    board.tell("set_digital_out_pwm_cycle oid=2 cycle_ticks=2000")
    assert board.device.fault == "Output updated while its queue holds commands"


@settings(max_examples=300)
@given(st.lists(st.tuples(st.integers(1, 2500), st.sampled_from([0, 1])), min_size=1, max_size=12))
def test_heater_not_renewed_in_time_shuts_down(rows):
    board = RawBoard()
    board.configure()
    board.simulated.trace_output("hotend")
    clock, expires = board.now, None
    for delay, value in rows:
        clock += delay
        if expires is not None and clock > expires:
            break
        board.tell(f"queue_digital_out oid=7 clock={clock & 0xFFFFFFFF} on_ticks={value}")
        expires = clock + LONGEST if value else None
    if expires is None:
        board.wait(10**6)
        assert not board.device.stopped
        return
    assert board.wait(expires - 1 - board.now) == []
    assert board.simulated.output_value("hotend") == 1
    reasons = board.dictionary.enumerations["static_string_id"]
    reason = reasons["Missed scheduling of next digital out event"]
    assert board.wait(1) == [
        ("shutdown", {"clock": expires & 0xFFFFFFFF, "static_string_id": reason})
    ]
    assert board.simulated.take_changes("hotend")[-1] == (expires, 0)


@given(
    samples=st.integers(1, 12),
    checks=st.integers(0, 5),
    spoilt=st.lists(st.booleans(), min_size=1, max_size=12),
    outside=st.sampled_from([0.0, 1.0]),
)
def test_limits_cut_the_heat_after_so_many_sums_outside(samples, checks, spoilt, outside):
    board = RawBoard()
    board.configure()
    least, limit = samples * 5, samples * 1000
    board.tell(f"query_analog_in oid=4 clock={board.clock(1000)} sample_ticks=100"
               f" sample_count={samples} rest_ticks=5000 bytes_per_report=2"
               f" min_value={least} max_value={limit} range_check_count={checks}")  # fmt: skip
    board.tell("update_digital_out oid=2 value=1")
    board.wait(1000 - 1)
    row = 0
    for is_spoilt in spoilt:
        board.simulated.force_sensor("hotend", outside if is_spoilt else None)
        said = [m for m in board.wait(5000) if m[0] == "analog_in_state"]
        share = outside if is_spoilt else 0.95
        assert [int.from_bytes(v["values"], "little") for _, v in said] == [
            samples * round(share * 1023)
        ]
        row = row + 1 if is_spoilt else 0
        if checks and row >= checks:
            assert board.device.fault == "ADC out of range"
            assert board.simulated.output_value("fan") == 0
            return
        assert board.device.fault == ""
    assert board.simulated.output_value("fan") == 1


def test_a_software_pwm_too_fast_for_the_chip_does_not_hang_it():
    board, _ = pulsed()
    board.tell("set_digital_out_pwm_cycle oid=2 cycle_ticks=2")
    board.tell(f"queue_digital_out oid=2 clock={board.clock(10)} on_ticks=1")
    board.wait(100_000)
    assert board.tell("get_clock") == [("clock", {"clock": board.clock(0)})]


def test_an_output_is_queued_again_after_a_shutdown():
    board = RawBoard()
    board.configure()
    board.device.trace_edges(fan := board.dictionary.enumerations["pin"]["PH6"])
    board.tell(f"queue_digital_out oid=2 clock={board.clock(1000)} on_ticks=1")
    board.tell("emergency_stop")
    board.tell("clear_shutdown")
    on = board.now + 5000
    board.tell(f"queue_digital_out oid=2 clock={on & 0xFFFFFFFF} on_ticks=1")
    board.wait(10_000)
    assert board.device.take_edges(fan) == [(on, 1)]


@pytest.mark.parametrize(
    "line",
    [
        "config_digital_out oid=8 pin=PB4 value=0 default_value=0 max_duration=0",
        "config_trsync oid=8",
        "config_endstop oid=8 pin=PE5 pull_up=1",
    ],
)
def test_nothing_is_added_to_a_configuration_that_is_finished(line):
    board = RawBoard()
    board.tell("allocate_oids count=9")
    board.tell("finalize_config crc=1")
    board.tell(line)
    assert board.device.fault == "Can't assign oid"


@pytest.mark.parametrize(
    ("line", "fault"),
    [
        ("config_digital_out oid=0 pin=PB4 value=1 default_value=0 max_duration=0",
         "Can't assign oid"),
        ("config_digital_out oid=1 pin=PB4 value=1 default_value=0 max_duration=2147483648",
         "Duration too long for the clock"),
        ("config_digital_out oid=1 pin=PB4 value=1 default_value=0 max_duration=2000",
         "Output with a maximum duration must begin at its default"),
    ],
)  # fmt: skip
def test_an_output_that_is_refused_is_put_to_its_default(line, fault):
    board = RawBoard()
    for prepared in (
        "allocate_oids count=2",
        "config_digital_out oid=0 pin=PH6 value=1 default_value=1 max_duration=0",
    ):
        board.tell(prepared)
    pin = board.dictionary.enumerations["pin"]["PB4"]
    board.device.trace_edges(pin)
    board.tell(line)
    assert board.device.fault == fault
    assert [level for _, level in board.device.take_edges(pin)] == [1, 0]


@pytest.mark.parametrize(
    ("line", "name"),
    [
        ("set_digital_out pin=PB4 value=1", "PB4"),
        ("set_pwm_out pin=PH5 cycle_ticks=9 value=255", "PH5"),
        ("set_digital_out pin=PH5 value=1", "PH5"),
    ],
)
def test_pin_of_configured_output_is_not_set_by_others(line, name):
    board = RawBoard()
    board.configure()
    board.device.trace_edges(board.dictionary.enumerations["pin"][name])
    board.tell(line)
    assert board.device.fault == "Pin belongs to a configured output"
    assert board.device.take_edges(board.dictionary.enumerations["pin"][name]) == []


@pytest.mark.parametrize(
    ("line", "fault"),
    [
        ("config_digital_out oid=0 pin=5000 value=0 default_value=0 max_duration=0",
         "Not a valid output pin"),
        ("config_pwm_out oid=0 pin=70000 cycle_ticks=9 value=0 default_value=0 max_duration=0",
         "Not a valid PWM pin"),
        ("config_analog_in oid=0 pin=5000", "Not a valid ADC pin"),
        ("config_endstop oid=0 pin=5000 pull_up=0", "Not a valid input pin"),
        ("config_stepper oid=0 step_pin=1 dir_pin=5000 invert_step=0 step_pulse_ticks=9",
         "Image cannot drive a stepper with these pins and pulses"),
        ("config_digital_out oid=0 pin=1 value=0 default_value=0 max_duration=2147483648",
         "Duration too long for the clock"),
    ],
)  # fmt: skip
def test_unfit_pin_functions_are_refused(line, fault):
    board = RawBoard()
    board.tell("allocate_oids count=1")
    name, _, rest = line.partition(" ")
    values = [int(word.split("=")[1]) for word in rest.split()]
    board.feed(board.commands.encode(name, values))
    assert board.device.fault == fault


@pytest.mark.parametrize(
    "line",
    [
        "config_digital_out oid=9 pin=PB4 value=1 default_value=1 max_duration=0",
        "config_pwm_out oid=9 pin=PB4 cycle_ticks=1000 value=255 default_value=255 max_duration=0",
    ],
)
def test_a_second_output_on_the_pin_of_a_heater_is_refused(line):
    board = RawBoard()
    board.tell("allocate_oids count=10")
    board.tell("config_digital_out oid=7 pin=PB4 value=0 default_value=0 max_duration=2000")
    heater = board.dictionary.enumerations["pin"]["PB4"]
    board.device.trace_edges(heater)
    board.tell(line)
    assert board.device.fault == "Pin belongs to a configured output"
    assert [level for _, level in board.device.take_edges(heater) if level] == []
