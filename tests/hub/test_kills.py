"""The hub is killed at each commit and at each request: no run starts twice, and none is lost."""

from __future__ import annotations

import asyncio
from contextlib import nullcontext, suppress
from functools import cache

import pytest
from tests.support.fake_printer import FakePrinter
from tests.support.farm_life import Life
from tests.support.farm_world import Killed, World, play

NEVER = -1


async def small_farm(
    commit: int = NEVER, request: int = NEVER, after: bool = False
) -> tuple[int, int, int]:
    """Two printers print three copies, and one print fails; the hub is killed once: before or after
    a commit, or before or after a request takes effect."""
    printers = [FakePrinter(name, heat_s=60, print_s=300) for name in ("a", "b")]
    world = World(printers)
    life = Life(world, 0, {"fuse": 300.0})
    await world.start()
    for printer in printers:
        await life.set_power(printer, "fuse", 200.0)
    first = world.disk.commits
    killed = False

    def at_commit(number: int, durable: bool) -> None:
        nonlocal killed
        if not killed and number - first == commit and durable == after:
            killed = True
            world.kill()

    def at_link(number: int, answered: bool) -> None:
        nonlocal killed
        if not killed and number == request and answered == after:
            killed = True
            with suppress(Killed) if answered else nullcontext():  # the printer's side goes on
                world.kill()

    world.disk.at_commit, world.at_link = at_commit, at_link
    hub = asyncio.ensure_future(life.hub())
    sha256 = await world.file()
    while not world.store.jobs:  # a user who gets no answer asks again
        await life.asked(lambda: world.job(quantity=3, retries=1))
        await asyncio.sleep(1.0)
    asyncio.get_running_loop().call_later(500.0, printers[0].halt, "A fault")
    life.calm = True
    await life.users(20.0, 20_000.0)
    hub.cancel()
    assert sha256 and (killed or (commit, request) == (NEVER, NEVER))
    life.check()
    done = sum(run[1] == "done" for printer in printers for run in printer.runs.values())
    return done, world.disk.commits - first, world.link_calls


@cache
def counts() -> tuple[int, int, int]:
    """Copies, commits and requests of the farm without a kill."""
    return play(small_farm)


def test_farm_without_a_kill_prints_three_copies():
    copies, commits, requests = counts()
    assert copies == 3
    assert commits > 30 and requests >= 8


@pytest.mark.parametrize("after", [False, True], ids=["before", "after"])
def test_kill_at_each_commit(after):
    for commit in range(1, counts()[1]):  # the first one is of the test's own file
        copies, *_ = play(lambda commit=commit: small_farm(commit=commit, after=after))
        assert copies == 3, commit


@pytest.mark.parametrize("after", [False, True], ids=["before", "after"])
def test_kill_at_each_request(after):
    for request in range(counts()[2]):
        copies, *_ = play(lambda request=request: small_farm(request=request, after=after))
        assert copies == 3, request
