"""A host that falls silent: tails, refusals, outputs that are kept, and what it finds later."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.oracles.wire import step_clocks
from tests.support.raw_board import RawBoard

GUARD = 16_000_000 // 200
STATES = ("off", "homing", "resting", "moving", "braking", "held", "lost")
HEATER_LONGEST = 2000  # of oid 7 in RawBoard.configure()
MOTORS = {0: "PF0", 1: "PF6"}


class Host:
    """Commits moves, and reckons where the steps must come out."""

    def __init__(self) -> None:
        self.board = RawBoard()
        self.board.configure()
        self.pins = {m: self.board.dictionary.enumerations["pin"][p] for m, p in MOTORS.items()}
        for pin in self.pins.values():
            self.board.device.trace_edges(pin)
        self.last = dict.fromkeys(MOTORS, self.board.now)
        self.steps: dict[int, list[int]] = {m: [] for m in MOTORS}
        self.serial = 0
        self.tell("survive_arm")

    def tell(self, text: str) -> list[tuple[str, dict]]:
        return self.board.tell(text)

    def move(self, motor: int, interval: int, count: int, add: int = 0) -> None:
        self.tell(f"queue_step oid={motor} interval={interval} count={count} add={add}")
        self.steps[motor] += step_clocks(self.last[motor], interval, count, add)
        self.last[motor] = self.steps[motor][-1]

    def tail(self, motor: int, interval: int, count: int, direction: int = 0) -> None:
        self.tell(
            f"survive_tail oid={motor} interval={interval} count={count} add=0 dir={direction}"
        )

    def commit(self, clock: int, rest: bool = False) -> list[tuple[str, dict]]:
        self.serial += 1
        clock &= 0xFFFFFFFF
        return self.tell(f"survive_commit serial={self.serial} clock={clock} rest={int(rest)}")

    def state(self) -> tuple[str, int]:
        ((name, values),) = self.tell("survive_query")
        assert name == "survive_state"
        return STATES[values["state"]], values["serial"]

    def done(self, motor: int) -> list[int]:
        return [c for c, level in self.board.device.take_edges(self.pins[motor]) if level]

    def position(self, motor: int) -> int:
        return self.tell(f"stepper_get_position oid={motor}")[0][1]["pos"]


@pytest.mark.parametrize("words", [("survive_off", "survive_arm"), ("survive_home", "survive_arm")])
def test_commits_are_counted_again(words):
    host = Host()
    host.commit(host.board.now + 500_000, rest=True)
    assert host.state() == ("resting", 1)
    host.tell("survive_arm")
    assert host.state() == ("resting", 1)
    for word in words:
        host.tell(word)
    assert host.state() == ("resting", 0)


def test_moves_and_clocks_wait_for_their_commit():
    host = Host()
    host.move(0, 200_000, 3)
    host.tell(f"reset_step_clock oid=1 clock={host.board.clock(300_000)}")
    host.last[1] = host.board.now + 300_000
    host.move(1, 100_000, 2)
    host.board.wait(50_000)
    assert host.done(0) == [] and host.state() == ("resting", 0)
    host.commit(host.board.now + 650_000)
    assert host.state() == ("moving", 1)
    host.board.wait(600_000)
    assert host.done(0) == host.steps[0]
    assert host.done(1) == host.steps[1]


def test_without_a_further_commit_the_tails_stop_the_motors():
    host = Host()
    limit = host.board.now + 500_000
    host.move(0, 10_000, 50)
    host.move(1, 20_000, 25)
    host.tail(0, 12_000, 1)
    host.tail(0, 15_000, 3)
    host.tail(1, 30_000, 2, direction=1)
    host.commit(limit)
    host.board.wait(500_000 - GUARD - 100)
    assert host.state() == ("moving", 1)
    host.board.wait(200)
    assert host.state() == ("braking", 1)
    host.move(0, 10_000, 5)  # too late
    host.commit(limit + 100_000)
    host.board.wait(GUARD + 200_000)
    assert host.state() == ("held", 1)
    assert host.done(0) == step_clocks(limit - 500_000, 10_000, 50, 0) + [
        limit + 12_000 + 15_000 * k for k in range(4)
    ]
    assert host.done(1) == step_clocks(limit - 500_000, 20_000, 25, 0) + [
        limit + 30_000 * k for k in (1, 2)
    ]
    assert (host.position(0), host.position(1)) == (-54, -23)
    assert host.board.device.fault == ""


@settings(max_examples=100, deadline=None)
@given(
    st.lists(st.tuples(st.integers(2, 12), st.integers(0, 4)), min_size=2, max_size=8), st.data()
)
def test_each_commit_replaces_the_one_before(periods, data):
    """The link breaks at any of the commits, before or behind its message."""
    host = Host()
    until = data.draw(st.integers(0, len(periods) - 1), "commits that arrive")
    begin = host.board.now
    limit = begin
    tails: list[int] = []
    for i, (tens, tail) in enumerate(periods):
        host.move(0, 10_000, 10 * tens)
        tails = [limit + 100_000 * tens + 15_000 * k for k in range(1, tail + 1)]
        if i == until:
            break
        for _ in range(tail):
            host.tail(0, 15_000, 1)
        limit += 100_000 * tens
        kept = (limit, tails)
        host.commit(limit)
        host.board.wait(max(0, limit - GUARD - 20_000 - host.board.now))
    if until == 0:
        host.board.wait(2_000_000)
        assert host.done(0) == [] and host.state() == ("resting", 0)
        return
    host.board.wait(2_000_000)
    limit, tails = kept
    assert host.done(0) == [c for c in host.steps[0] if c <= limit] + tails
    assert host.state() == ("held", until)


def test_a_plan_that_ends_has_no_tail_and_rests():
    host = Host()
    host.move(0, 10_000, 50)
    host.commit(host.board.now + 500_000, rest=True)
    assert host.state() == ("moving", 1)
    host.board.wait(2_000_000)
    assert host.state() == ("resting", 1)
    # The next print of this host goes on without a word about it.
    host.tell(f"reset_step_clock oid=0 clock={host.board.clock(0)}")
    host.last[0] = host.board.now
    host.move(0, 10_000, 10)
    host.commit(host.board.now + 100_000, rest=True)
    host.board.wait(200_000)
    assert host.done(0) == host.steps[0]


def test_a_motor_after_a_long_standstill_begins_in_a_tail():
    host = Host()
    host.move(0, 10_000, 50)
    limit = host.board.now + 500_000
    host.tail(1, limit + 1000 & 0xFFFFFFFF, 0)
    host.tail(1, 5000, 2)
    host.commit(limit)
    host.board.wait(600_000)
    assert host.done(1) == [limit + 6000, limit + 11_000]


def test_the_host_takes_over_at_the_motors_positions():
    host = Host()
    host.move(0, 10_000, 50)
    host.tail(0, 20_000, 2)
    host.commit(host.board.now + 500_000)
    host.board.wait(600_000)
    assert host.state() == ("held", 1)
    host.tell("survive_arm")
    assert host.state() == ("resting", 1)
    host.tell(f"reset_step_clock oid=0 clock={host.board.clock(0)}")
    host.last[0] = host.board.now
    host.done(0)
    host.steps[0] = []
    host.move(0, 10_000, 10)
    host.commit(host.board.now + 100_000, rest=True)
    host.board.wait(200_000)
    assert host.done(0) == host.steps[0] and host.position(0) == -62


def test_move_queue_entries_are_freed():
    """Tails that were replaced, dropped moves, and those of a shutdown."""
    host = Host()
    slots = host.tell("get_config")[0][1]["move_count"]
    for _ in range(2 * slots):
        host.tell(f"reset_step_clock oid=0 clock={host.board.clock(0)}")
        host.last[0] = host.board.now
        host.move(0, 1000, 1)
        host.tail(0, 300_000, 1)
        host.commit(host.board.now + 200_000)
        host.board.wait(1100)
    host.board.wait(400_000)
    for _ in range(2 * slots):
        host.move(0, 1000, 1)
    assert host.board.device.fault == "" and host.state()[0] == "held"
    host.tell("survive_arm")
    for _ in range(slots - 10):
        host.move(0, 1000, 1)
    host.tell("emergency_stop")
    host.tell("clear_shutdown")
    assert host.state()[0] == "off"
    for arm in (False, True):  # what waited was given up at the shutdown, not by a host
        if arm:
            host.tell("survive_arm")
        host.tell(f"reset_step_clock oid=0 clock={host.board.clock(100_000)}")
        for _ in range(slots - 10):
            host.move(0, 1000, 1)
        host.board.wait(100_000 + slots * 1000)
        assert host.board.device.fault == ""


def heating() -> tuple[Host, int]:
    """With a heater that is kept for two seconds, its sensor watched; and its pin, traced."""
    host = Host()
    host.tell(
        f"query_analog_in oid=4 clock={host.board.clock(1000)} sample_ticks=1000 sample_count=1"
        " rest_ticks=100000 bytes_per_report=2 min_value=0 max_value=1023 range_check_count=4"
    )
    heater = host.board.dictionary.enumerations["pin"]["PB4"]
    host.board.device.trace_edges(heater)
    host.tell("survive_output oid=7 value=1 seconds=2")
    return host, heater


def test_a_heater_is_kept_for_its_time_and_then_off():
    host, heater = heating()
    on = host.board.now + 1000
    host.tell(f"queue_digital_out oid=7 clock={on & 0xFFFFFFFF} on_ticks=1")
    host.board.wait(40_000_000)
    assert host.board.device.take_edges(heater) == [(on, 1), (on + HEATER_LONGEST + 32_000_000, 0)]
    assert host.board.device.fault == ""


@pytest.mark.parametrize(("before", "seconds"), [(1500, 0), (1_000_000, 1)])
def test_kept_heater_goes_off_without_sensor_samples(before, seconds):
    host, heater = heating()
    on = host.board.now + 1000
    host.tell(f"queue_digital_out oid=7 clock={on & 0xFFFFFFFF} on_ticks=1")
    host.board.wait(before)
    host.tell(
        "query_analog_in oid=4 clock=0 sample_ticks=0 sample_count=0 rest_ticks=0"
        " bytes_per_report=0 min_value=0 max_value=0 range_check_count=0"
    )
    host.board.wait(60_000_000)
    off = on + HEATER_LONGEST + seconds * 16_000_000
    assert host.board.device.take_edges(heater) == [(on, 1), (off, 0)]
    assert host.board.device.fault == ""


def test_each_link_loss_keeps_heater_for_whole_time():
    host, heater = heating()
    first = host.board.now + 1000
    again = first + 20_000_000
    host.tell(f"queue_digital_out oid=7 clock={first & 0xFFFFFFFF} on_ticks=1")
    host.board.wait(20_000_000)
    host.tell(f"queue_digital_out oid=7 clock={again & 0xFFFFFFFF} on_ticks=1")
    host.board.wait(40_000_000)
    off = again + HEATER_LONGEST + 32_000_000
    assert host.board.device.take_edges(heater) == [(first, 1), (off, 0)]


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        ("survive_output oid=7 value=1 seconds=1", "No sensor watches what an output is held"),
        ("survive_output oid=7 value=1 seconds=61", "Output may not be held for so long"),
    ],
)
def test_outputs_that_may_not_be_kept_are_refused(line, reason):
    host = Host()
    host.tell(line)
    assert host.board.device.fault.startswith(reason)


@pytest.mark.parametrize(("count", "checks"), [(1, 0), (0, 4)])
def test_a_sensor_that_is_not_checked_does_not_watch(count, checks):
    host = Host()
    for samples, looks in ((1, 4), (count, checks)):
        host.tell(
            f"query_analog_in oid=4 clock={host.board.clock(1000)} sample_ticks=1000"
            f" sample_count={samples} rest_ticks=100000 bytes_per_report=2 min_value=0"
            f" max_value=1023 range_check_count={looks}"
        )
    host.tell("survive_output oid=7 value=1 seconds=1")
    assert host.board.device.fault == "No sensor watches what an output is held for"


def test_a_kept_heater_takes_the_lesser_power():
    host = Host()
    host.tell("survive_output oid=7 value=0 seconds=0")
    on = host.board.now + 1000
    host.tell(f"queue_digital_out oid=7 clock={on & 0xFFFFFFFF} on_ticks=1")
    heater = host.board.dictionary.enumerations["pin"]["PB4"]
    host.board.device.trace_edges(heater)
    host.board.wait(100_000)
    assert host.board.device.take_edges(heater) == [(on, 1), (on + HEATER_LONGEST, 0)]


@pytest.mark.parametrize(("on_ticks", "kept"), [(200, 200), (700, 500)])
def test_a_kept_heater_is_pulsed_with_the_lesser_power(on_ticks, kept):
    board = RawBoard()
    for line in (
        "allocate_oids count=2",
        "config_digital_out oid=0 pin=PB4 value=0 default_value=0 max_duration=4000",
        "set_digital_out_pwm_cycle oid=0 cycle_ticks=1000",
        "config_analog_in oid=1 pin=PK5",
        "finalize_config crc=1",
        f"query_analog_in oid=1 clock={board.clock(1000)} sample_ticks=1000 sample_count=1"
        " rest_ticks=100000 bytes_per_report=2 min_value=0 max_value=1023 range_check_count=4",
        "survive_arm",
        "survive_output oid=0 value=500 seconds=60",
    ):
        board.tell(line)
    heater = board.dictionary.enumerations["pin"]["PB4"]
    board.device.trace_edges(heater)
    on = board.now + 1000
    board.tell(f"queue_digital_out oid=0 clock={on & 0xFFFFFFFF} on_ticks={on_ticks}")
    board.wait(1000 + 5900)
    edges = board.device.take_edges(heater)
    widths = [off - up for (up, _), (off, _) in zip(edges[::2], edges[1::2], strict=True)]
    assert widths == [on_ticks] * 4 + [kept] * 2


def test_output_with_another_cycle_is_not_kept():
    board = RawBoard()
    for line in (
        "allocate_oids count=3",
        "config_digital_out oid=0 pin=PB4 value=0 default_value=0 max_duration=40000",
        "set_digital_out_pwm_cycle oid=0 cycle_ticks=10000",
        "config_analog_in oid=1 pin=PK5",
        "config_stepper oid=2 step_pin=PF0 dir_pin=PF1 invert_step=0 step_pulse_ticks=32",
        "finalize_config crc=1",
        f"query_analog_in oid=1 clock={board.clock(1000)} sample_ticks=1000 sample_count=1"
        " rest_ticks=100000 bytes_per_report=2 min_value=0 max_value=1023 range_check_count=4",
        "survive_arm",
        "survive_output oid=0 value=5000 seconds=60",
    ):
        board.tell(line)
    heater = board.dictionary.enumerations["pin"]["PB4"]
    board.device.trace_edges(heater)
    on = board.now + 1000
    board.tell(f"queue_digital_out oid=0 clock={on & 0xFFFFFFFF} on_ticks=5000")
    board.wait(15_000)
    board.tell("set_digital_out_pwm_cycle oid=0 cycle_ticks=1000")
    board.wait(16_000_000)
    pulses = [(on + i * 10_000 + at, 1 - at // 5000) for i in range(4) for at in (0, 5000)]
    assert board.device.take_edges(heater) == pulses
    assert board.device.fault == ""


def test_a_laser_is_off_before_the_machine_brakes():
    host = Host()
    host.tell("survive_output oid=2 value=0 seconds=0")
    fan = host.board.dictionary.enumerations["pin"]["PH6"]
    host.board.device.trace_edges(fan)
    limit = host.board.now + 500_000
    host.move(0, 10_000, 50)
    on = host.board.now + 1000
    host.tell(f"queue_digital_out oid=2 clock={on & 0xFFFFFFFF} on_ticks=1")
    host.tell(f"queue_digital_out oid=2 clock={limit + 5 & 0xFFFFFFFF} on_ticks=1")
    host.commit(limit)
    host.board.wait(700_000)
    assert host.board.device.take_edges(fan) == [(on, 1), (limit - GUARD, 0)]


def test_queued_heater_value_is_not_treated_as_laser():
    """It has nothing to keep yet, but its host may still reach this board, though not another."""
    host = Host()
    host.tell("survive_output oid=7 value=0 seconds=60")
    heater = host.board.dictionary.enumerations["pin"]["PB4"]
    host.board.device.trace_edges(heater)
    limit = host.board.now + 500_000
    host.move(0, 10_000, 50)
    host.commit(limit)
    on = limit - GUARD - 500
    host.tell(f"queue_digital_out oid=7 clock={on & 0xFFFFFFFF} on_ticks=1")
    again = host.board.now + 500_000
    host.board.wait(500_000 - 1000)
    host.tell(f"queue_digital_out oid=7 clock={again & 0xFFFFFFFF} on_ticks=1")
    host.board.wait(200_000)
    assert host.state() == ("held", 1)
    assert host.board.device.take_edges(heater) == [
        (on, 1),
        (on + HEATER_LONGEST, 0),
        (again, 1),
        (again + HEATER_LONGEST, 0),
    ]
    assert host.board.device.fault == ""


def test_host_gets_decision_and_late_commands():
    host = Host()
    limit = host.board.now + 500_000
    host.move(0, 10_000, 50)
    host.commit(limit)
    told = host.board.wait(600_000)
    assert [(n, STATES[v["state"]], v["serial"]) for n, v in told] == [
        ("survive_state", "braking", 1)
    ]
    (again,) = host.commit(limit + 100_000)
    assert (again[0], STATES[again[1]["state"]]) == ("survive_state", "held")
    assert host.state() == ("held", 1)


def test_the_laser_stays_off_while_the_board_holds():
    host = Host()
    host.tell("survive_output oid=2 value=0 seconds=0")
    host.tell("survive_output oid=3 value=0 seconds=0")
    host.move(0, 10_000, 50)
    host.commit(host.board.now + 500_000)
    host.board.wait(600_000)
    pins = host.board.dictionary.enumerations["pin"]
    for name in ("PH6", "PH5"):
        host.board.device.trace_edges(pins[name])
    host.tell(f"queue_digital_out oid=2 clock={host.board.clock(1000)} on_ticks=1")
    host.tell(f"queue_digital_out oid=2 clock={host.board.clock(-1000)} on_ticks=1")
    host.tell("update_digital_out oid=2 value=1")
    host.tell(f"queue_pwm_out oid=3 clock={host.board.clock(1000)} value=100")
    host.board.wait(100_000)
    assert host.board.device.take_edges(pins["PH6"]) == []
    assert host.board.device.output_value(pins["PH5"]) == 0
    assert host.board.device.fault == ""
    host.tell("survive_arm")
    host.tell(f"queue_digital_out oid=2 clock={host.board.clock(1000)} on_ticks=1")
    host.board.wait(2000)
    assert len(host.board.device.take_edges(pins["PH6"])) == 1


def test_tail_too_late_for_first_step_after_rest_is_refused():
    """The motor has no step in the commit: those of another board have."""
    host = Host()
    limit = host.board.now + 20_000
    host.tail(0, 30_000, 5, direction=1)
    host.board.wait(60_000)
    host.commit(limit)
    assert host.state() == ("held", 0)
    host.board.wait(200_000)
    assert host.position(0) == 0
    assert host.board.device.fault == ""


@pytest.mark.parametrize(
    "lines",
    [
        ["reset_step_clock oid=0 clock={clock}", "queue_step oid=0 interval=20000 count=5 add=0"],
        [
            "survive_tail oid=0 interval={clock} count=0 add=0 dir=1",
            "survive_tail oid=0 interval=20000 count=5 add=0 dir=1",
        ],
    ],
)
def test_first_step_after_endstop_may_be_too_late(lines):
    """A switch has stopped the motor, and the clock that lets it go on is in the same commit."""
    host = Host()
    host.tell("survive_off")
    host.tell("trsync_start oid=6 report_clock=0 report_ticks=0 expire_reason=4")
    host.tell("stepper_stop_on_trigger oid=0 trsync_oid=6")
    host.tell("trsync_trigger oid=6 reason=2")
    host.tell("survive_arm")
    clock = host.board.clock(1000)
    for line in lines:
        host.tell(line.format(clock=clock))
    host.board.wait(60_000)
    host.commit(host.board.now + 500_000)
    assert host.state() == ("held", 0)
    host.board.wait(200_000)
    assert host.position(0) == 0
    assert host.board.device.fault == ""


def test_a_commit_that_is_nearly_over_brakes_at_once():
    host = Host()
    host.move(0, 10_000, 10)
    limit = host.board.now + 100_000
    host.tail(0, 20_000, 2)
    host.board.wait(5_000)
    host.commit(limit - 60_000)
    assert host.state()[0] == "braking"
    host.board.wait(300_000)
    assert host.state() == ("held", 1) and host.position(0) == -12
    assert host.board.device.fault == ""


def test_expired_duration_without_survive_shuts_down():
    host = Host()
    host.tell("survive_output oid=7 value=0 seconds=0")
    host.tell("survive_off")
    host.tell(f"queue_digital_out oid=7 clock={host.board.clock(1000)} on_ticks=1")
    host.board.wait(10_000)
    assert host.board.device.fault == "Missed scheduling of next digital out event"


def test_a_late_heater_command_takes_effect_at_once():
    """A frame that had to be repeated on a bad link is no reason to stop."""
    host = Host()
    heater = host.board.dictionary.enumerations["pin"]["PB4"]
    host.board.device.trace_edges(heater)
    told = host.board.now
    host.tell(f"queue_digital_out oid=7 clock={host.board.clock(-5000)} on_ticks=1")
    host.board.wait(1000)
    assert host.board.device.fault == ""
    ((on, level),) = host.board.device.take_edges(heater)
    assert level == 1 and told < on <= told + 100


def test_late_laser_goes_off_and_next_commit_is_refused():
    host = Host()
    host.tell("survive_output oid=2 value=0 seconds=0")
    light = host.board.dictionary.enumerations["pin"]["PH6"]
    host.tell(f"queue_digital_out oid=2 clock={host.board.clock(100)} on_ticks=1")
    limit = host.board.now + 500_000
    host.move(0, 10_000, 50)
    host.tail(0, 15_000, 2)
    host.commit(limit)
    host.board.wait(100_000)
    host.board.device.trace_edges(light)
    host.tell(f"queue_digital_out oid=2 clock={host.board.clock(-5000)} on_ticks=1")
    host.move(0, 10_000, 20)
    told = host.commit(limit + 200_000)
    assert [(n, STATES[v["state"]], v["serial"]) for n, v in told] == [
        ("survive_state", "braking", 1)
    ]
    host.board.wait(800_000)
    assert [level for _, level in host.board.device.take_edges(light)] == [0]
    assert host.state() == ("held", 1)
    assert host.done(0)[-2:] == [limit + 15_000, limit + 30_000]
    assert host.board.device.fault == ""


def test_late_laser_is_forgotten_after_takeover():
    host = Host()
    host.tell("survive_output oid=2 value=0 seconds=0")
    host.tell(f"queue_digital_out oid=2 clock={host.board.clock(-5000)} on_ticks=1")
    host.tell("survive_arm")
    host.last[0] = host.board.now
    host.move(0, 10_000, 50)
    assert host.commit(host.board.now + 500_000, rest=True) == []
    assert host.state() == ("moving", 1)


def test_sensors_that_are_asked_late_begin_at_once():
    host = Host()
    host.tell(
        f"query_analog_in oid=4 clock={host.board.clock(-100_000)} sample_ticks=1000"
        " sample_count=2 rest_ticks=50000 bytes_per_report=2 min_value=0 max_value=65535"
        " range_check_count=4"
    )
    told = host.board.wait(60_000)
    assert "analog_in_state" in [name for name, _ in told]
    assert host.board.device.fault == ""


def test_late_step_while_homing_stops_all_motors():
    """Nobody knows where, but the board lives, and heats on."""
    host = Host()
    host.tell("survive_home")
    begin = host.board.now
    for motor in MOTORS:
        host.tell(f"reset_step_clock oid={motor} clock={begin & 0xFFFFFFFF}")
        host.last[motor] = begin
    host.move(0, 10_000, 1000)
    host.move(1, 10_000, 5)
    assert host.state() == ("homing", 0)
    host.board.wait(200_000)
    told = host.tell("queue_step oid=1 interval=10000 count=50 add=0")
    assert [(n, STATES[v["state"]]) for n, v in told] == [("survive_state", "lost")]
    assert [len(host.done(motor)) for motor in MOTORS] == [20, 5]
    host.tell("queue_step oid=0 interval=10000 count=50 add=0")
    host.tell(f"reset_step_clock oid=1 clock={host.board.clock(1000)}")
    host.tell("queue_step oid=1 interval=10000 count=50 add=0")
    host.board.wait(400_000)
    assert [host.done(motor) for motor in MOTORS] == [[], []]
    assert (host.position(0), host.position(1)) == (-20, -5)
    assert host.state() == ("lost", 0)
    assert host.board.device.fault == ""
    host.tell("survive_arm")
    assert host.state() == ("resting", 0)
    host.last[1] = host.board.now
    host.tell(f"reset_step_clock oid=1 clock={host.board.clock(0)}")
    host.move(1, 10_000, 3)
    host.commit(host.board.now + 200_000, rest=True)
    host.board.wait(100_000)
    assert len(host.done(1)) == 3


@pytest.mark.parametrize("mode", ["survive_arm", "survive_home"])
def test_switches_that_are_armed_late_are_looked_at_at_once(mode):
    host = Host()
    host.tell(mode)
    host.board.simulated.force_switch("x", True)
    late = host.board.clock(-100_000)
    host.tell(f"trsync_start oid=6 report_clock={late} report_ticks=200000 expire_reason=4")
    told = host.tell(
        f"endstop_home oid=5 clock={late} sample_ticks=100 sample_count=2 rest_ticks=1000"
        " pin_value=1 trsync_oid=6 trigger_reason=2"
    )
    told += host.board.wait(10_000)
    reasons = [v["trigger_reason"] for n, v in told if n == "trsync_state" and not v["can_trigger"]]
    assert reasons[0] == 2
    assert host.board.device.fault == ""


def test_a_timeout_that_is_put_off_too_late_ends_at_once():
    host = Host()
    host.tell("survive_home")
    host.tell("trsync_start oid=6 report_clock=0 report_ticks=0 expire_reason=4")
    told = host.tell(f"trsync_set_timeout oid=6 clock={host.board.clock(-100_000)}")
    told += host.board.wait(10_000)
    assert [(v["can_trigger"], v["trigger_reason"]) for n, v in told if n == "trsync_state"] == [
        (0, 4)
    ]
    assert host.board.device.fault == ""
