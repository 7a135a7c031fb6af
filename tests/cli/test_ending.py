"""A signal ends a served printer once, and never cuts its closing short."""

import asyncio

import pytest

from passo.cli.ending import Ending
from passo.clock import VirtualLoop


async def _served(steps: list[str], *, closing_at_once: bool) -> bool:
    task = asyncio.current_task()
    assert task is not None
    ending = Ending()
    ending.begin(task)
    loop = asyncio.get_running_loop()
    loop.call_later(1, ending.ask)
    loop.call_later(2, ending.ask)
    try:
        if closing_at_once:
            ending.close()
        else:
            await asyncio.sleep(1.5)
            steps.append("served")
    finally:
        await asyncio.sleep(3)
        steps.append("closed")
    return ending.asked


def test_first_signal_ends_and_second_does_not_cut_closing():
    steps: list[str] = []
    loop = VirtualLoop()
    with pytest.raises(asyncio.CancelledError):
        loop.run_until_complete(_served(steps, closing_at_once=False))
    loop.close()
    assert steps == ["closed"]


def test_a_signal_while_a_restart_closes_is_only_noted():
    steps: list[str] = []
    loop = VirtualLoop()
    assert loop.run_until_complete(_served(steps, closing_at_once=True))
    loop.close()
    assert steps == ["closed"]
