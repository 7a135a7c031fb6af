"""What an idle printer does: how often it wakes its computer, in virtual time."""

import asyncio

import pytest
from tests.web.fake_bridge import FakeBridge
from tests.web.local_site import site

import passo
from passo.clock import VirtualLoop
from passo.web.server import server

SECONDS = 60


@pytest.fixture
def wakeups(monkeypatch):
    """The number of times that the loop has waited."""
    count = [0]
    pass_time = VirtualLoop.pass_time

    def counted(loop, seconds):
        count[0] += 1
        pass_time(loop, seconds)

    monkeypatch.setattr(VirtualLoop, "pass_time", counted)
    return count


class Quiet:
    def __init__(self):
        self.count = 0

    def on_snapshot(self, _):
        self.count += 1

    def on_event(self, event):
        pass


def test_idle_printer_only_passes_time_and_looks_once_a_second(wakeups):
    async def main():
        async with passo.Printer("i3") as printer:
            await printer.open_tcp()
            bridge = printer._bridge
            reads = bridge._latest.version
            await asyncio.sleep(1)
            wakeups[0] = 0
            await asyncio.sleep(SECONDS)
            assert wakeups[0] <= SECONDS * 10 + 5
            assert SECONDS - 5 < bridge._latest.version - reads <= SECONDS + 2

    passo.run(main(), clock="virtual")


def test_snapshots_come_four_times_a_second_to_a_listener_alone():
    async def main():
        async with passo.Printer("i3") as printer:
            bridge, quiet = printer._bridge, Quiet()
            end = bridge.listen(quiet)
            await asyncio.sleep(SECONDS)
            assert 3 * SECONDS < quiet.count <= 4 * SECONDS + 1
            end()
            before = bridge._latest.version
            await asyncio.sleep(SECONDS)
            assert bridge._latest.version - before <= SECONDS + 1

    passo.run(main(), clock="virtual")


def test_web_server_without_connections_never_wakes(wakeups):
    async def main():
        served = server(site(FakeBridge()))
        serving = asyncio.create_task(served.serve(sockets=[]))
        await asyncio.sleep(1)
        wakeups[0] = 0
        await asyncio.sleep(SECONDS)
        assert wakeups[0] == 1  # of this sleep
        served.should_exit = True
        await serving

    passo.run(main(), clock="virtual")
