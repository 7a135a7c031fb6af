"""A client of Klipper's socket without a socket."""

from __future__ import annotations

import asyncio
import json
from typing import Any

from tests.web.fake_bridge import FakeBridge

from passo.web.klippy.connection import Connection
from passo.web.klippy.engine import Engine


class Client:
    """Sends requests to an engine, and keeps what comes back: `pushed` are calls of its methods."""

    def __init__(self, engine: Engine) -> None:
        self.connection = Connection(engine, self._receive)
        engine.connections.append(self.connection)
        self.answers: dict[Any, dict[str, Any]] = {}
        self.pushed: list[dict[str, Any]] = []
        self._requests = 0

    def _receive(self, frame: bytes) -> None:
        assert frame.endswith(b"\x03") and frame.count(b"\x03") == 1
        message = json.loads(frame[:-1])
        if "id" in message:
            self.answers[message.pop("id")] = message
        else:
            self.pushed.append(message)

    def send(self, method: str, **params: object) -> int:
        """Sends a request; returns its number."""
        self._requests += 1
        request = {"id": self._requests, "method": method, "params": params}
        self.connection.receive(json.dumps(request).encode() + b"\x03")
        return self._requests

    async def ask(self, method: str, **params: object) -> dict[str, Any]:
        """The result of a request, or its error."""
        number = self.send(method, **params)
        for _ in range(10):
            await asyncio.sleep(0)
        return self.answers[number].get("result", self.answers[number].get("error"))


class Served:
    """An engine of a printer that does not exist, at 100 s. `restarts` are its calls to start
    again."""

    def __init__(self, card: str | None = None, machine: str = "i3") -> None:
        self.bridge = FakeBridge(card, machine)
        self.restarts: list[bool] = []
        self.engine = Engine(self.bridge, self.restarts.append, now_s=lambda: 100.0)
        self.bridge.listen(self.engine)

    def client(self) -> Client:
        """Another client."""
        return Client(self.engine)
