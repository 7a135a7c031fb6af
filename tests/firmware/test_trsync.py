"""A group of motors that stop together, started anew while it waits."""

from tests.support.raw_board import RawBoard


def states(said: list) -> list[tuple[int, int, int]]:
    """Clock, whether it can trigger, and why it did, of each report."""
    found = [values for name, values in said if name == "trsync_state"]
    return [(v["clock"], v["can_trigger"], v["trigger_reason"]) for v in found]


def test_a_second_start_replaces_the_first():
    board = RawBoard()
    board.configure()
    start = board.now
    for ticks, reason, timeout in ((3000, 2, 25_000), (10_000, 3, 45_000)):
        board.tell(
            f"trsync_start oid=6 report_clock={board.clock(ticks)} report_ticks={ticks}"
            f" expire_reason={reason}"
        )
        board.tell("stepper_stop_on_trigger oid=0 trsync_oid=6")
        board.tell(f"trsync_set_timeout oid=6 clock={board.clock(timeout)}")
    said = []
    for _ in range(60):
        said += board.wait(1000)
    at = [start + ticks & 0xFFFFFFFF for ticks in (10_000, 20_000, 30_000, 40_000, 45_000)]
    ended = [(start + ticks & 0xFFFFFFFF, 0, 3) for ticks in (45_000, 50_000, 60_000)]
    assert states(said) == [*((clock, 1, 0) for clock in at[:4]), *ended]


def test_a_motor_that_changes_groups_stops_with_the_new_one_only():
    board = RawBoard()
    for line in (
        "allocate_oids count=3",
        "config_stepper oid=0 step_pin=PF0 dir_pin=PF1 invert_step=0 step_pulse_ticks=32",
        "config_trsync oid=1",
        "config_trsync oid=2",
        "finalize_config crc=1",
        f"reset_step_clock oid=0 clock={board.clock(0)}",
    ):
        board.tell(line)
    for oid in (1, 2):
        board.tell(f"trsync_start oid={oid} report_clock=0 report_ticks=0 expire_reason=2")
        board.tell(f"stepper_stop_on_trigger oid=0 trsync_oid={oid}")
    board.tell("queue_step oid=0 interval=1000 count=100 add=0")
    board.wait(10_500)
    board.tell("trsync_trigger oid=1 reason=1")
    board.wait(10_000)
    board.tell("trsync_trigger oid=2 reason=1")
    board.wait(50_000)
    assert board.tell("stepper_get_position oid=0")[0][1]["pos"] in (20, -20)
    assert board.device.fault == ""
