"""A stand-in for Spoolman: one spool, its REST interface, and the WebSocket for Moonraker."""

from __future__ import annotations

import threading
import time

import uvicorn
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocket, WebSocketDisconnect
from tests.hosts.served import free_port

SPOOL = 7
_START_S = 10.0


class Spoolman:
    """`uses_mm` are the lengths that clients used of the spool. `refuse` is how many of the next
    uses it answers with an error."""

    def __init__(self) -> None:
        self.uses_mm: list[float] = []
        self.refuse = 0
        port = free_port()
        self.url = f"http://127.0.0.1:{port}"
        routes = [
            Route("/api/v1/spool/{spool:int}", self._spool),
            Route("/api/v1/spool/{spool:int}/use", self._use, methods=["PUT"]),
            WebSocketRoute("/api/v1/spool", self._events),
        ]
        options = uvicorn.Config(Starlette(routes=routes), port=port, log_level="error")
        self._server = uvicorn.Server(options)
        self._thread = threading.Thread(target=self._server.run)
        self._thread.start()
        end = time.monotonic() + _START_S
        while not self._server.started:
            assert time.monotonic() < end, "the stand-in for Spoolman does not start"
            time.sleep(0.01)

    def close(self) -> None:
        """Ends the server."""
        self._server.should_exit = True
        self._thread.join()

    async def _spool(self, request: Request) -> Response:
        if request.path_params["spool"] != SPOOL:
            return JSONResponse({"message": "no such spool"}, 404)
        return JSONResponse({"id": SPOOL, "used_length": sum(self.uses_mm)})

    async def _use(self, request: Request) -> Response:
        if self.refuse:
            self.refuse -= 1
            return JSONResponse({"message": "locked"}, 500)
        self.uses_mm.append((await request.json())["use_length"])
        return await self._spool(request)

    async def _events(self, websocket: WebSocket) -> None:
        await websocket.accept()
        try:
            while True:
                await websocket.receive_text()
        except WebSocketDisconnect:
            return
