"""A chip that is left alone: what it was told for that case comes on time, on all motors."""

import pytest

from .boards import HZ, motors

MOTORS, COMMITS, MOVES, STEPS = 3, 4, 36, 10
INTERVAL, TAIL = 2000, 5000
SPAN = MOVES * STEPS * INTERVAL
PINS = ("PF0", "PF6", "PL3", "PA4")


def test_commits_and_tails_come_on_time():
    """As many moves in a commit as a host puts there; the last one is followed by silence."""
    connection = motors(MOTORS)
    connection.command("survive_arm")
    base = connection.now + HZ // 2
    for oid in range(MOTORS):
        connection.command(f"reset_step_clock oid={oid} clock={base % 2**32}")
        connection.command(f"set_next_step_dir oid={oid} dir=1")
    for k in range(COMMITS):
        for _ in range(MOVES):
            for oid in range(MOTORS):
                connection.command(f"queue_step oid={oid} interval={INTERVAL} count={STEPS} add=0")
        for oid in range(MOTORS):
            connection.command(
                f"survive_tail oid={oid} interval={TAIL} count={3 + oid} add=0 dir=1"
            )
        limit = base + (k + 1) * SPAN
        connection.command(f"survive_commit serial={k + 1} clock={limit % 2**32} rest=0")
        connection.run(max(connection.now, limit - SPAN - HZ // 8))
    connection.run(limit + HZ // 4)
    edges = connection.bench.edges()
    for oid, pin in enumerate(PINS[:MOTORS]):
        wanted = [base + INTERVAL * i for i in range(1, COMMITS * MOVES * STEPS + 1)]
        wanted += [limit + TAIL * i for i in range(1, 4 + oid)]
        rises = [e.cycle for e in edges if e.level and e.pin == pin]
        late = [at - due for at, due in zip(rises, wanted, strict=True)]
        assert max(late) - min(late) < 450, pin
        assert connection.net_steps(f"m{oid}") == len(wanted)
    told = connection.ask("survive_query", "survive_state")
    held = connection.dictionary.enumerations["survive"]["held"]
    assert (told["state"], told["serial"]) == (held, COMMITS)
    connection.bench.close()


@pytest.mark.parametrize("interval", [400, 300])
def test_commit_just_in_time_is_taken_while_motors_step(interval):
    """Three motors go on, at 120 000 and 160 000 steps/s together; in it a fourth begins, by a
    clock of its own."""
    connection = motors(4)
    connection.command("survive_arm")
    base = connection.link.clock_at(connection.now) + HZ // 3
    steps = round(0.075 * HZ / interval) // MOVES
    limit = base + steps * MOVES * interval
    for oid in range(4):
        connection.command(f"reset_step_clock oid={oid} clock={base % 2**32}")
        connection.command(f"set_next_step_dir oid={oid} dir=1")
    for serial in (1, 2):
        for oid in range(3):
            for _ in range(MOVES):
                connection.command(f"queue_step oid={oid} interval={interval} count={steps} add=0")
        if serial == 1:
            for oid in range(3):
                connection.command(f"survive_tail oid={oid} interval={TAIL} count=3 add=0 dir=1")
            connection.command(f"survive_commit serial=1 clock={limit % 2**32} rest=0")
    connection.command(f"reset_step_clock oid=3 clock={limit % 2**32}")
    connection.command(f"queue_step oid=3 interval={interval} count=60 add=0")
    connection.run(limit - round(0.0053 * HZ))  # the decision falls 5 ms before
    connection.command(f"survive_commit serial=2 clock={(2 * limit - base) % 2**32} rest=1")
    connection.run(2 * limit - base + HZ // 4)
    told = connection.ask("survive_query", "survive_state")
    resting = connection.dictionary.enumerations["survive"]["resting"]
    assert (told["state"], told["serial"]) == (resting, 2)
    made = [connection.net_steps(f"m{oid}") for oid in range(4)]
    assert made == [2 * steps * MOVES] * 3 + [60]
    connection.bench.close()


@pytest.mark.parametrize("interval", [400, 300])
def test_long_tails_come_on_time_after_fast_steps(interval):
    """Four motors' tails of many moves are queued while three step, at 120 000 and 160 000
    steps/s together; the fourth begins with its tail."""
    tail, count, moves = 3 * interval // 2, 24, 30
    connection = motors(4)
    connection.command("survive_arm")
    base = connection.link.clock_at(connection.now) + HZ // 3
    steps = round(0.075 * HZ / interval) // MOVES
    limit = base + steps * MOVES * interval
    for oid in range(3):
        connection.command(f"reset_step_clock oid={oid} clock={base % 2**32}")
        connection.command(f"set_next_step_dir oid={oid} dir=1")
        for _ in range(MOVES):
            connection.command(f"queue_step oid={oid} interval={interval} count={steps} add=0")
    connection.command(f"survive_tail oid=3 interval={limit % 2**32} count=0 add=0 dir=1")
    words = f"interval={tail} count={count} add=0 dir=1"
    for oid in range(4):
        for _ in range(moves):
            connection.command(f"survive_tail oid={oid} {words}")
    connection.command(f"survive_commit serial=1 clock={limit % 2**32} rest=0")
    connection.run(limit + HZ // 4)
    told = connection.ask("survive_query", "survive_state")
    assert told["state"] == connection.dictionary.enumerations["survive"]["held"]
    made = [connection.net_steps(f"m{oid}") for oid in range(4)]
    assert made == [steps * MOVES + moves * count] * 3 + [moves * count]
    rises = [e for e in connection.bench.edges() if e.level]
    begun = [next(e.cycle for e in rises if e.pin == pin) for pin in (PINS[0], PINS[3])]
    assert abs(begun[1] - begun[0] - (limit + tail - base - interval)) < 450
    connection.bench.close()


def test_late_commit_after_rest_is_taken_or_refused():
    made = []
    for ahead in range(95_000, 135_000, 4_000):  # ticks from the first word to the first step
        connection = motors(4)
        connection.command("survive_arm")
        first = connection.link.clock_at(connection.now) + ahead
        for oid in range(4):
            connection.command(f"reset_step_clock oid={oid} clock={(first - 1000) % 2**32}")
            connection.command(f"set_next_step_dir oid={oid} dir=1")
            for _ in range(3):
                connection.command(f"queue_step oid={oid} interval=1000 count=5 add=0")
        connection.command(f"survive_commit serial=1 clock={(first + 15_000) % 2**32} rest=1")
        connection.run(connection.now + HZ // 3)
        told = connection.ask("survive_query", "survive_state")
        steps = [connection.net_steps(f"m{oid}") for oid in range(4)]
        resting = told["state"] == connection.dictionary.enumerations["survive"]["resting"]
        assert steps == ([15] * 4 if resting else [0] * 4)
        made.append(resting)
        connection.bench.close()
    assert made == sorted(made)
    assert set(made) == {False, True}
