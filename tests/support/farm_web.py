"""The web interface of a farm of fake printers, for clients in the same event loop."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncGenerator, Awaitable, Callable
from pathlib import Path
from typing import Any, TypeVar

import httpx2
from tests.support.fake_printer import FakePrinter, Network
from tests.support.farm_world import World

from passo.hub.app import hub_app
from passo.hub.call import HubSite
from passo.hub.contents import Contents
from passo.hub.limits import SCHEMA, Limits
from passo.hub.link import PrinterRecord
from passo.hub.proposals import Proposals
from passo.hub.wishes import NewPrinter
from passo.web.access import Binding
from passo.web.accounts.accounts import Accounts
from passo.web.accounts.store import Store
from passo.web.roles import Role

_T = TypeVar("_T")
_BASE = "http://127.0.0.1:4100"
PASSWORD = "correct horse"


class FarmWeb:
    """A farm with its web interface. Its printers are not connected."""

    def __init__(self, folder: Path, *names: str) -> None:
        self.printers = [FakePrinter(name) for name in names]
        self.world = World(self.printers, network=Network(delay_s=0.0, upload_s=0.0))
        self.contents = Contents(folder / "files")
        self.proposals = Proposals()
        store = Store(folder, more=SCHEMA)
        self.accounts = Accounts(store, wall_s=lambda: 1.8e9, now_s=lambda: 0.0)
        self.limits = Limits(store)
        parts = self.world.farm, self.contents, self._fits, self.limits, self._pair
        site = HubSite(*parts, self.proposals, self.world.wall_s)
        self.app = hub_app(site, self.accounts, Binding(loopback=True))
        self.client = self._client()

    def _client(self, **headers: str) -> httpx2.AsyncClient:
        transport = httpx2.ASGITransport(self.app, client=("127.0.0.1", 50000))
        return httpx2.AsyncClient(transport=transport, base_url=f"{_BASE}/api/v1", headers=headers)

    def _fits(self, sha256: str, printer: str) -> None:
        return None

    async def _pair(self, wish: NewPrinter) -> PrinterRecord:
        name = wish.name or "found"
        self.world.printers.setdefault(f"id-{name}", FakePrinter(name))
        return PrinterRecord(f"id-{name}", name, wish.url, wish.kind, "key")

    async def caller(self, name: str, role: Role, *tags: str) -> httpx2.AsyncClient:
        """A client with a key, whose printers have one of the tags."""
        if not self.accounts.exist:
            await self.accounts.create_administrator("ada", PASSWORD, "address", None)
        _, token = await self.accounts.add_key(name, role)
        await self.limits.set(f"key {name}", tags)
        return self._client(**{"X-Api-Key": token})


def with_farm(folder: Path, *names: str) -> Callable[[Callable[[FarmWeb], Awaitable[_T]]], _T]:
    """Runs a test with a farm of these printers."""

    def run(test: Callable[[FarmWeb], Awaitable[_T]]) -> _T:
        async def main() -> _T:
            async with _opened(folder, *names) as web:
                return await test(web)

        return asyncio.run(main())

    return run


@contextlib.asynccontextmanager
async def _opened(folder: Path, *names: str) -> AsyncGenerator[FarmWeb]:
    web = FarmWeb(folder, *names)
    try:
        yield web
    finally:
        await web.client.aclose()
        await web.world.farm.close()
        web.contents.close()
        web.accounts.close()


def names_of(rows: list[dict[str, Any]]) -> list[str]:
    """The names in a list of the API, sorted."""
    return sorted(row["name"] for row in rows)
