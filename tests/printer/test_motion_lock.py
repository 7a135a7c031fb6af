"""Who may move the machine: one at a time, in the order of asking."""

import asyncio

import pytest

from passo.clock import VirtualLoop
from passo.printer.motion_lock import MotionLock


@pytest.fixture
def run():
    loop = VirtualLoop()
    yield loop.run_until_complete
    loop.close()


def test_lock_is_granted_in_the_order_of_asking(run):
    order = []

    async def asks(lock, name, times):
        for _ in range(times):
            await lock.acquire()
            order.append(name)
            await asyncio.sleep(1)
            lock.release()

    async def all_of_them():
        lock = MotionLock()
        await asyncio.gather(*(asks(lock, name, 3) for name in "abc"))
        assert lock.try_acquire()

    run(all_of_them())
    assert "".join(order) == "abcabcabc"


def test_take_does_not_overtake_waiting_tasks(run):
    async def body():
        lock = MotionLock()
        assert lock.try_acquire()
        assert not lock.try_acquire()
        waiting = asyncio.ensure_future(lock.acquire())
        await asyncio.sleep(0)
        lock.release()
        assert not lock.try_acquire()  # handed over, though its task has not yet run
        await waiting
        lock.release()
        assert lock.try_acquire()

    run(body())


def test_cancelled_waiter_is_skipped(run):
    async def body():
        lock = MotionLock()
        lock.try_acquire()
        first, second = (asyncio.ensure_future(lock.acquire()) for _ in range(2))
        await asyncio.sleep(0)
        first.cancel()
        await asyncio.sleep(0)
        lock.release()
        await second
        assert not lock.try_acquire()

    run(body())


def test_waiter_cancelled_at_its_turn_passes_the_lock_on(run):
    async def body():
        lock = MotionLock()
        lock.try_acquire()
        first, second = (asyncio.ensure_future(lock.acquire()) for _ in range(2))
        await asyncio.sleep(0)
        lock.release()
        first.cancel()
        await second
        assert first.cancelled()
        lock.release()
        assert lock.try_acquire()

    run(body())
