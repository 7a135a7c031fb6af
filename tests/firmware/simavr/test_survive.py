"""A chip that is left alone: what it was told for that case comes on time, on all motors."""

from .boards import HZ, motors

MOTORS, COMMITS, MOVES, STEPS = 3, 4, 36, 10
INTERVAL, TAIL = 2000, 5000
SPAN = MOVES * STEPS * INTERVAL
PINS = ("PF0", "PF6", "PL3")


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
    for oid, pin in enumerate(PINS):
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
