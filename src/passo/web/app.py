"""The ASGI application: routes of the HTTP interface, and the WebSocket that tells what happens."""

from __future__ import annotations

from typing import TYPE_CHECKING

from starlette.applications import Starlette
from starlette.responses import Response
from starlette.routing import Route, WebSocketRoute

from passo.web import openapi
from passo.web.access import Access
from passo.web.answers import JSON
from passo.web.feed import Feed
from passo.web.files.handlers import FileHandlers
from passo.web.files.uploads import Uploads
from passo.web.operations import OPERATIONS
from passo.web.pages import page_routes
from passo.web.routes import EXCEPTION_HANDLERS, routes
from passo.web.site import Site
from passo.web.slicers.octoprint import OctoPrint
from passo.web.temperature_history import TemperatureHistory

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.websockets import WebSocket

    from passo.web.bridge import Bridge


def web_app(bridge: Bridge, temperatures: TemperatureHistory | None = None) -> Starlette:
    """The application of one printer, with what is kept of its temperatures."""
    site = Site(bridge, Access(), temperatures or TemperatureHistory())
    uploads = Uploads(bridge)
    described = openapi.encoded(OPERATIONS)

    async def description(_: Request) -> Response:
        return Response(described, media_type=JSON)

    async def feed(websocket: WebSocket) -> None:
        await Feed(bridge, websocket).run()

    return Starlette(
        routes=[
            *routes(OPERATIONS, site),
            *FileHandlers(bridge, uploads).routes,
            *OctoPrint(bridge, uploads).routes,
            Route(openapi.PATH, description),
            WebSocketRoute("/api/v1/feed", feed),
            *page_routes(),
        ],
        exception_handlers=EXCEPTION_HANDLERS,
    )
