"""A commit that comes late to a Cortex-M chip."""

from __future__ import annotations

from math import ceil

import pytest

from .test_cortex import CASES, TAKEN, Case, board_target

MOTORS, STEPS, MOVES = 6, 5, 3
# From the commit's arrival to its first steps.
AHEAD_US = (-100, 100, 400, 500, 700)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.board)
def test_late_commit_after_rest_is_taken_or_refused(case: Case) -> None:
    host, us = case.host(), case.hz // 1_000_000
    names = [pin for pin in board_target(case.board).chip.pins if pin not in TAKEN][:MOTORS]
    numbers = host.dictionary.enumerations["pin"]
    pins = [numbers[name] for name in names]
    pulse = ceil(0.1 * case.hz / 1e6)
    host.send(
        f"allocate_oids count={MOTORS}",
        *(
            f"config_stepper oid={i} step_pin={name} dir_pin={case.direction[0]} invert_step=0"
            f" step_pulse_ticks={pulse}"
            for i, name in enumerate(names)
        ),
        "finalize_config crc=1",
    )
    states = host.dictionary.enumerations["survive"]
    made: list[bool] = []
    for ahead in AHEAD_US:
        host.send("survive_arm")
        first = host.chip.clock + case.hz // 50
        for oid in range(MOTORS):
            host.send(
                f"reset_step_clock oid={oid} clock={(first - 100 * us) % 2**32}",
                f"set_next_step_dir oid={oid} dir=1",
                *[f"queue_step oid={oid} interval={100 * us} count={STEPS} add=0"] * MOVES,
            )
        host.chip.edges.clear()
        host.chip.run((first - host.chip.clock) / case.hz - ahead * 1e-6)
        end = first + 100 * us * STEPS * MOVES
        host.send(
            f"survive_commit serial={len(made) + 1} clock={end % 2**32} rest=1", seconds=0.004
        )
        told = host.send("survive_query")["survive_state"]["state"]
        rises = [pin for _, pin, level in host.chip.edges if level]
        made.append(told == states["resting"])
        assert [rises.count(pin) for pin in pins] == [STEPS * MOVES * made[-1]] * MOTORS
        assert host.send("get_config")["config"]["is_shutdown"] == 0
    assert made == sorted(made)
    assert set(made) == {False, True}
