"""Loops that keep real, scaled and virtual time."""

import asyncio
import selectors
import socket
import time

import pytest

from passo import clock
from passo.clock import ScaledLoop, VirtualLoop, new_loop


@pytest.fixture
def virtual():
    loop = VirtualLoop()
    yield loop
    loop.close()


def test_virtual_time_begins_at_0_and_jumps_to_the_next_deadline(virtual):
    seen = []

    async def sleeper(seconds):
        await asyncio.sleep(seconds)
        seen.append((seconds, virtual.time()))

    async def all_of_them():
        assert virtual.time() == 0.0
        await asyncio.gather(*(sleeper(s) for s in (86400.0, 0.25, 3600.0, 1e-6)))

    virtual.run_until_complete(all_of_them())
    assert [s for s, _ in seen] == [1e-6, 0.25, 3600.0, 86400.0]
    assert [t for _, t in seen] == pytest.approx([s for s, _ in seen], abs=1e-8)


def test_virtual_time_is_reproducible():
    def run():
        loop, seen = VirtualLoop(), []

        async def ticking(name, period):
            for _ in range(50):
                await asyncio.sleep(period)
                seen.append((name, loop.time()))

        async def both():
            await asyncio.gather(ticking("a", 0.1), ticking("b", 0.3), ticking("c", 0.1))

        loop.run_until_complete(both())
        loop.close()
        return seen

    assert run() == run()


def test_virtual_time_pauses_while_a_task_is_ready(virtual):
    async def busy():
        for _ in range(100):
            await asyncio.sleep(0)
        return virtual.time()

    assert virtual.run_until_complete(busy()) == 0.0


def test_readable_data_comes_before_virtual_time(virtual):
    near, far = socket.socketpair()

    async def read():
        near.setblocking(False)
        far.send(b"here")
        async with asyncio.timeout(5):
            data = await virtual.sock_recv(near, 10)
        return data, virtual.time()

    assert virtual.run_until_complete(read()) == (b"here", 0.0)
    near.close()
    far.close()


def test_timeouts_end_in_virtual_time(virtual):
    async def never():
        with pytest.raises(TimeoutError):
            async with asyncio.timeout(1000):
                await asyncio.Event().wait()
        return virtual.time()

    assert virtual.run_until_complete(never()) == pytest.approx(1000)


@pytest.mark.parametrize("scale", [0.5, 10.0, 1000.0])
def test_scaled_seconds_are_a_fraction_of_real_ones(monkeypatch, scale):
    real_s = 100.0
    waited = []
    monkeypatch.setattr(time, "monotonic", lambda: real_s)

    def select(_, timeout=None):
        nonlocal real_s
        if timeout:
            waited.append(timeout)
            real_s += timeout
        return []

    monkeypatch.setattr(selectors.DefaultSelector, "select", select)
    loop = ScaledLoop(scale)
    assert loop.time() == 0.0
    loop.run_until_complete(asyncio.sleep(20))
    assert sum(waited) == pytest.approx(20 / scale)
    assert loop.time() == pytest.approx(20)
    loop.close()


def test_a_busy_computer_slows_scaled_time_down(monkeypatch):
    real_s = 0.0
    monkeypatch.setattr(time, "monotonic", lambda: real_s)
    loop = ScaledLoop(20.0)

    async def busy():
        nonlocal real_s
        await asyncio.sleep(0)
        begin = loop.time()
        real_s += 0.004
        assert loop.time() - begin == pytest.approx(0.08)
        real_s += 3.0
        assert loop.time() - begin == pytest.approx(0.1)
        await asyncio.sleep(0)
        assert loop.time() - begin == pytest.approx(0.1)

    loop.run_until_complete(busy())
    loop.close()


def test_the_kind_of_loop_follows_the_scale():
    for scale, kind in ((1, asyncio.SelectorEventLoop), (2.5, ScaledLoop), (None, VirtualLoop)):
        loop = new_loop(scale)
        assert type(loop) is kind
        loop.close()


@pytest.mark.parametrize("scale", [0, -1, float("nan")])
def test_time_always_increases(scale):
    with pytest.raises(ValueError, match="above 0"):
        clock.new_loop(scale)
