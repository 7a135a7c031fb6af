"""How long the clocks of several boards are asked for before motion depends on them."""

from __future__ import annotations

import asyncio
from types import SimpleNamespace

import pytest

from passo.board.boards import Boards
from passo.printer.reconnection import _Reconnection


class Part(SimpleNamespace):
    __hash__ = object.__hash__  # type: ignore[assignment]


def boards(*jitters_s: float) -> Boards:
    several = object.__new__(Boards)
    links = [SimpleNamespace(clock_jitter_s=jitter) for jitter in jitters_s]
    several.connections = [Part(link=link, lost=False) for link in links]  # type: ignore[assignment]
    return several


@pytest.mark.parametrize(
    ("jitters_s", "seconds"), [((0, 0), 4), ((0, 100e-6), 4.6), ((2e-3, 0), 16), ((1, 0), 30)]
)
def test_it_is_longer_where_answers_vary_at_a_reconnection_too(monkeypatch, jitters_s, seconds):
    several = boards(*jitters_s)
    assert several.settling_s == pytest.approx(seconds)
    waited = []

    async def sleep(duration: float) -> None:
        waited.append(duration)

    async def reopen() -> None:
        pass

    class Done(Exception):
        pass

    async def stood(self, connection) -> int:
        raise Done

    monkeypatch.setattr(asyncio, "sleep", sleep)
    monkeypatch.setattr(_Reconnection, "_stood_behind", stood)
    several.connections[0].lost = True  # type: ignore[misc]
    several.connections[0].reopen = reopen  # type: ignore[attr-defined]
    drive = SimpleNamespace(wait=lambda: None)
    machine = _Reconnection(SimpleNamespace(connection=several, drive=drive))  # type: ignore[arg-type]
    with pytest.raises(Done):
        asyncio.run(machine.take_over())
    assert sum(waited) == pytest.approx(seconds)
