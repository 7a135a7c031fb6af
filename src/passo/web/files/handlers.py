"""HTTP for the files of the card."""

from __future__ import annotations

from typing import TYPE_CHECKING

from starlette.routing import Route

from passo.errors import PassoError
from passo.web.answers import json, refusal
from passo.web.files.body import Body
from passo.web.files.names import program

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.responses import Response

    from passo.web.bridge import Bridge
    from passo.web.files.uploads import Uploads


class FileHandlers:
    """Handlers for one printer."""

    def __init__(self, bridge: Bridge, uploads: Uploads) -> None:
        self._bridge, self._uploads = bridge, uploads

    @property
    def routes(self) -> list[Route]:
        """Where the handlers are found."""
        return [Route("/api/v1/files/content", self.upload, methods=["PUT"])]

    async def upload(self, request: Request) -> Response:
        """The body becomes a file of the card."""
        body = Body(request)
        try:
            path = program(request.query_params.get("path", ""))
            async with self._uploads.file(path, total=body.length, resumable=True) as incoming:
                async for data in body.pieces():
                    await incoming.write(data)
        except PassoError as error:
            await body.drain()
            return refusal(error)
        return json({"path": path, "size": incoming.offset}, 201)
