"""The ASGI application: routes of the HTTP interface, and the WebSocket that tells what happens."""

from __future__ import annotations

from typing import TYPE_CHECKING

import msgspec
from starlette.applications import Starlette
from starlette.responses import Response
from starlette.routing import Route, WebSocketRoute

from passo.web.deltas import tree
from passo.web.feed import Feed
from passo.web.files.handlers import FileHandlers
from passo.web.files.uploads import Uploads
from passo.web.slicers.octoprint import OctoPrint

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.websockets import WebSocket

    from passo.web.bridge import Bridge


def web_app(bridge: Bridge) -> Starlette:
    """The application of one printer."""

    async def status(_: Request) -> Response:
        snapshot = bridge.latest()
        body = {"version": snapshot.version, "status": tree(snapshot.status)}
        return Response(msgspec.json.encode(body), media_type="application/json")

    async def feed(websocket: WebSocket) -> None:
        await Feed(bridge, websocket).run()

    uploads = Uploads(bridge)
    return Starlette(
        routes=[
            Route("/api/v1/status", status),
            WebSocketRoute("/api/v1/feed", feed),
            *FileHandlers(bridge, uploads).routes,
            *OctoPrint(bridge, uploads).routes,
        ]
    )
