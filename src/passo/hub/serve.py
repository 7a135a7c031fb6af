"""Serves a farm: its store, its links, its web interface."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import time
from collections.abc import AsyncGenerator, Collection, Coroutine
from dataclasses import dataclass
from ipaddress import ip_address
from pathlib import Path
from typing import TYPE_CHECKING, Any

from passo.errors import HubError
from passo.hub.app import hub_app
from passo.hub.call import HubSite
from passo.hub.contents import Contents
from passo.hub.farm import Farm
from passo.hub.fits import FileFits, find_fit
from passo.hub.limits import SCHEMA, Limits
from passo.hub.links.links import Links
from passo.hub.proposals import Proposals
from passo.hub.store import Store
from passo.web.access import Binding
from passo.web.accounts import store as account_store
from passo.web.accounts.accounts import Accounts
from passo.web.server import listening, server

if TYPE_CHECKING:
    import socket


_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class Served:
    """A hub that runs: its address, and the code that creates its first account, empty if there is
    one."""

    url: str
    code: str


@contextlib.asynccontextmanager
async def served(
    host: str, port: int, state: Path, *, names: Collection[str] = (), find: bool = True
) -> AsyncGenerator[Served]:
    """Serves a farm within the block; port 0 is any free port; `names` are the host names that
    clients may use; `find`: multicast DNS proposes printers. Raises HubError and WebError if the
    folder `state` cannot be used, and InputError if the address cannot be opened."""
    async with contextlib.AsyncExitStack() as stack:
        listens = stack.enter_context(contextlib.closing(listening(host, port)))
        binding = Binding(_is_loopback(listens), frozenset(name.lower() for name in names))
        try:
            state.mkdir(parents=True, exist_ok=True)
            contents = stack.enter_context(contextlib.closing(Contents(state / "files")))
        except OSError as error:
            raise HubError.of("hub.store", value=error.strerror or str(error)) from None
        store = stack.enter_context(contextlib.closing(Store.open(state / "farm.sqlite")))
        kept = account_store.Store(state, more=SCHEMA)
        accounts = Accounts(kept, wall_s=time.time, now_s=time.monotonic)
        stack.callback(accounts.close)
        links = Links()
        stack.push_async_callback(links.close)
        fits = FileFits(links.machine, contents.path, lambda: farm.refit(), find_fit)
        stack.push_async_callback(fits.close)
        farm = Farm(store, links, contents.path, fits)
        proposals = Proposals()
        site = HubSite(farm, contents, fits, Limits(kept), links.pair, proposals, time.time)
        app = hub_app(site, accounts, binding)
        await farm.start()
        stack.push_async_callback(farm.close)
        if find:
            await stack.enter_async_context(_running(_find(proposals)))
        web = server(app)
        serving = asyncio.create_task(web.serve(sockets=[listens]))
        try:
            yield Served(_url(listens), accounts.code)
        finally:
            web.should_exit = True
            await asyncio.gather(serving, return_exceptions=True)


async def _find(proposals: Proposals) -> None:
    try:
        from passo.hub.discovery import discover
    except ImportError as error:
        _log.info("No printers are found by multicast DNS: %s is not installed", error.name)
        return
    await discover(proposals)


@contextlib.asynccontextmanager
async def _running(work: Coroutine[Any, Any, None]) -> AsyncGenerator[None]:
    task = asyncio.create_task(work)
    try:
        yield
    finally:
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)


def _is_loopback(listens: socket.socket) -> bool:
    return ip_address(listens.getsockname()[0].partition("%")[0]).is_loopback


def _url(listens: socket.socket) -> str:
    host, port = listens.getsockname()[:2]
    return f"http://{f'[{host}]' if ':' in host else host}:{port}"
