"""The ASGI application: routes of the HTTP interface, and the WebSocket that reports events."""

from __future__ import annotations

from typing import TYPE_CHECKING

from starlette.applications import Starlette
from starlette.routing import WebSocketRoute

from passo.web import openapi
from passo.web.access import Access, Binding
from passo.web.call import Call
from passo.web.feed import serve_feed
from passo.web.feeds import Feeds
from passo.web.files.metadata import MetadataReader
from passo.web.files.uploads import Uploads
from passo.web.firmware.builds import Builds
from passo.web.firmware.flashes import Flashes
from passo.web.guard import Guard
from passo.web.messages import Messages
from passo.web.operations import OPERATIONS
from passo.web.pages import page_routes
from passo.web.routes import EXCEPTION_HANDLERS, routes
from passo.web.site import Site
from passo.web.slicers import octoprint_socket
from passo.web.summary_feed import serve_summary_feed

if TYPE_CHECKING:
    from pathlib import Path

    from starlette.requests import Request
    from starlette.types import ASGIApp
    from starlette.websockets import WebSocket

    from passo.web.accounts.accounts import Accounts
    from passo.web.bridge import Bridge
    from passo.web.logs import Logs
    from passo.web.operation import Caller
    from passo.web.temperature_history import TemperatureHistory


def web_app(
    bridge: Bridge,
    accounts: Accounts,
    binding: Binding,
    temperatures: TemperatureHistory,
    logs: Logs,
    *,
    printer_id: str = "",
    state: Path | None = None,
) -> ASGIApp:
    """The application of one printer at one address, with its temperature history and its logs; its
    id is `printer_id`; the cache of its files is in the folder `state`."""
    access, metadata = Access(accounts, binding), MetadataReader(bridge, state)
    uploads = Uploads(bridge, metadata.want)
    firmware = Builds(), Flashes()
    site = Site(
        bridge,
        accounts,
        access,
        uploads,
        metadata,
        temperatures,
        logs,
        *firmware,
        printer_id,
        state,
    )
    feeds, messages = Feeds(bridge), Messages()

    def call(caller: Caller, request: Request) -> Call:
        return Call(access, caller, request, site)

    async def feed(websocket: WebSocket) -> None:
        await serve_feed(site, feeds, messages, websocket)

    async def summary_feed(websocket: WebSocket) -> None:
        await serve_summary_feed(site, feeds, websocket)

    async def octoprint(websocket: WebSocket) -> None:
        await octoprint_socket.serve_socket(site, feeds, websocket)

    app = Starlette(
        routes=[
            *routes(OPERATIONS, access, call),
            openapi.route(OPERATIONS),
            WebSocketRoute("/api/v1/feed", feed),
            WebSocketRoute("/api/v1/summary/feed", summary_feed),
            WebSocketRoute(octoprint_socket.PATH, octoprint),
            *page_routes(),
        ],
        exception_handlers=EXCEPTION_HANDLERS,
    )
    return Guard(app, binding)
