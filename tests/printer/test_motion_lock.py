"""Who may move the machine: one at a time, in the order of asking."""

import asyncio

import pytest

from passo.clock import VirtualLoop
from passo.printer.motion_lock import Turn


@pytest.fixture
def run():
    loop = VirtualLoop()
    yield loop.run_until_complete
    loop.close()


def test_the_turn_goes_round_in_the_order_of_asking(run):
    order = []

    async def asks(turn, name, times):
        for _ in range(times):
            await turn.wait()
            order.append(name)
            await asyncio.sleep(1)
            turn.give()

    async def all_of_them():
        turn = Turn()
        await asyncio.gather(*(asks(turn, name, 3) for name in "abc"))
        assert turn.take()

    run(all_of_them())
    assert "".join(order) == "abcabcabc"


def test_nobody_is_overtaken_by_who_only_takes(run):
    async def body():
        turn = Turn()
        assert turn.take()
        assert not turn.take()
        waiting = asyncio.ensure_future(turn.wait())
        await asyncio.sleep(0)
        turn.give()
        assert not turn.take()  # handed over, though its task has not yet run
        await waiting
        turn.give()
        assert turn.take()

    run(body())


def test_cancelled_waiter_is_skipped(run):
    async def body():
        turn = Turn()
        turn.take()
        first, second = (asyncio.ensure_future(turn.wait()) for _ in range(2))
        await asyncio.sleep(0)
        first.cancel()
        await asyncio.sleep(0)
        turn.give()
        await second
        assert not turn.take()

    run(body())


def test_waiter_cancelled_at_its_turn_passes_the_lock_on(run):
    async def body():
        turn = Turn()
        turn.take()
        first, second = (asyncio.ensure_future(turn.wait()) for _ in range(2))
        await asyncio.sleep(0)
        turn.give()
        first.cancel()
        await second
        assert first.cancelled()
        turn.give()
        assert turn.take()

    run(body())
