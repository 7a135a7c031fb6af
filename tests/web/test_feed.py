"""The WebSocket: the whole status first, then what changes, and each event."""

import asyncio
import json
from dataclasses import replace

import pytest
from tests.web.fake_bridge import STATUS, FakeBridge
from tests.web.local_site import HOST, local_client, site

from passo.clock import new_loop
from passo.events import Message
from passo.web.feeds import AT_ONCE

FEED = f"ws://{HOST}/api/v1/feed"


@pytest.fixture
def bridge():
    return FakeBridge()


def test_changes_follow_the_status(bridge):
    with local_client(bridge).websocket_connect(FEED) as client:
        first = client.receive_json()
        assert (first["type"], first["version"], first["status"]["time_s"]) == ("status", 1, 12.5)
        client.portal.call(bridge.show, replace(STATUS, time_s=13.0, fans={"part": 0.5}))
        assert client.receive_json() == {
            "type": "changes",
            "version": 2,
            "changes": {"time_s": 13.0, "fans": {"part": 0.5}},
        }
        client.portal.call(bridge.tell, Message("echo:hot"))
        event = {"kind": "Message", "text": "echo:hot"}
        assert client.receive_json() == {"type": "event", "event": event}
    assert bridge.listeners == []


def test_a_slow_client_gets_the_latest_state_alone(bridge):
    with local_client(bridge).websocket_connect(FEED) as client:
        client.receive_json()

        def hurry():
            for i in range(5):
                bridge.show(replace(STATUS, time_s=20.0 + i))

        client.portal.call(hurry)
        assert client.receive_json()["changes"] == {"time_s": 24.0}


class Client:
    """A WebSocket of an application in the loop of the test. `got` are the messages with their
    times; it takes them while `reads` is set."""

    def __init__(self, app, path="/api/v1/feed"):
        self._loop = asyncio.get_running_loop()
        self.got, self.reads, self._left = [], asyncio.Event(), asyncio.Event()
        self.reads.set()
        scope = {
            "type": "websocket",
            "scheme": "ws",
            "path": path,
            "query_string": b"",
            "headers": [(b"host", HOST.encode())],
            "client": ("127.0.0.1", 50000),
            "subprotocols": [],
        }
        self._arrives = iter([{"type": "websocket.connect"}])
        self._task = asyncio.ensure_future(app(scope, self._receive, self._send))

    async def _receive(self):
        for message in self._arrives:
            return message
        await self._left.wait()
        return {"type": "websocket.disconnect", "code": 1001}

    async def _send(self, message):
        await self.reads.wait()
        if message["type"] == "websocket.send":
            self.got.append((self._loop.time(), json.loads(message["text"])))

    async def leave(self):
        self._left.set()
        await self._task


def in_virtual_time(test):
    async def main():
        bridge = FakeBridge()
        app = site(bridge)
        await asyncio.wait_for(test(bridge, app), 1000)
        assert bridge.listeners == []

    with asyncio.Runner(loop_factory=lambda: new_loop(None)) as runner:
        runner.run(main())


def test_fifty_clients_and_one_that_does_not_read():
    async def test(bridge, app):
        loop = asyncio.get_running_loop()
        clients, slow = [Client(app) for _ in range(50)], Client(app)
        await asyncio.sleep(1)
        slow.reads.clear()
        shown = []
        for number in range(100):
            await asyncio.sleep(0.05)
            bridge.show(replace(STATUS, time_s=20.0 + number))
            shown.append((loop.time(), 20.0 + number))
        await asyncio.sleep(1)
        for client in clients:
            assert [(s, m["changes"]["time_s"]) for s, m in client.got[1:]] == shown
        slow.reads.set()
        await asyncio.sleep(1)
        # One was on its way; of all others only the state in the end is sent.
        assert [m["changes"]["time_s"] for _, m in slow.got[1:]] == [20.0, 119.0]
        for client in (*clients, slow):
            await client.leave()
        assert len(bridge.listeners) == 0

    in_virtual_time(test)


def test_each_message_is_made_once_for_all_clients(monkeypatch):
    async def test(bridge, app):
        clients = [Client(app) for _ in range(30)]
        await asyncio.sleep(1)
        assert len(bridge.listeners) == 1
        made = []
        monkeypatch.setattr("passo.web.messages.text", lambda kind, **_: made.append(kind) or "{}")
        for number in range(5):
            bridge.show(replace(STATUS, time_s=20.0 + number))
            bridge.tell(Message(f"echo:{number}"))
            await asyncio.sleep(0.05)
        assert made == ["changes", "event"] * 5
        assert {len(client.got) for client in clients} == {11}
        for client in clients:
            await client.leave()

    in_virtual_time(test)


def test_requests_have_their_turn_between_groups_of_clients():
    async def test(bridge, app):
        loop = asyncio.get_running_loop()
        clients = [Client(app) for _ in range(10 * AT_ONCE)]
        await asyncio.sleep(1)
        sent_by_turn, before = [], sum(len(client.got) for client in clients)

        def turn():
            sent_by_turn.append(sum(len(client.got) for client in clients))
            if len(sent_by_turn) < 50:
                loop.call_soon(turn)

        loop.call_soon(turn)
        bridge.show(replace(STATUS, time_s=20.0))
        await asyncio.sleep(1)
        sent = [b - a for a, b in zip([before, *sent_by_turn], sent_by_turn, strict=False)]
        assert (sum(sent), max(sent)) == (len(clients), AT_ONCE)
        for client in clients:
            await client.leave()

    in_virtual_time(test)
