"""Clients that are slow: their connections end in time, and no other client waits for them. In
virtual time, on uvicorn's protocols with a connection in memory."""

import asyncio

import msgspec
import pytest
from anyio import to_thread
from tests.web.fake_bridge import FakeBridge
from tests.web.local_site import HOST, site
from uvicorn.server import ServerState

from passo.clock import new_loop
from passo.events import Message
from passo.web.files.body import SPAN_S
from passo.web.protocol import (
    HEADERS_S,
    MAX_OF_PEER,
    UNREAD_S,
    LimitedProtocol,
)
from passo.web.requests import BODY_S
from passo.web.server import configuration
from passo.web.web_socket import UNREAD_MESSAGES_S

FILES = "/api/v1/files/content"
PART = b'--x\r\nContent-Disposition: form-data; name="file"; filename="a.gcode"\r\n\r\nG1 X'
_MAX_UNREAD = 1 << 16  # bytes that asyncio keeps until it pauses a protocol


class Connection(asyncio.Transport):
    """A connection in memory. `sent` is what the server has written; the client reads it at once if
    it `reads`. `ended_s` is when the server has ended the connection."""

    def __init__(self, server, peer="127.0.0.1", *, reads=True):
        super().__init__({"peername": (peer, 50000), "sockname": ("127.0.0.1", 4000)})
        self._loop, self.reads = asyncio.get_running_loop(), reads
        self.sent, self.ended_s = b"", None
        self.protocol = LimitedProtocol(server.config, server.state, {}, self._loop)
        self.protocol.connection_made(self)

    def set_protocol(self, protocol):
        self.protocol = protocol

    def get_protocol(self):
        return self.protocol

    def write(self, data):
        before, self.sent = len(self.sent), self.sent + bytes(data)
        if not self.reads and before <= _MAX_UNREAD < len(self.sent):
            self.protocol.pause_writing()

    def read_all(self):
        self.reads = True
        self.protocol.resume_writing()

    def is_closing(self):
        return self.ended_s is not None

    def close(self):
        if self.ended_s is None:
            self.ended_s = self._loop.time()
            self._loop.call_soon(self.protocol.connection_lost, None)

    abort = close

    def pause_reading(self):
        pass

    resume_reading = pause_reading


class Server:
    def __init__(self, card=None):
        self.bridge = FakeBridge(card)
        self.config = configuration(site(self.bridge))
        self.config.load()
        self.state = ServerState()


@pytest.fixture
def at_once(monkeypatch):
    """What a worker thread does takes no virtual time."""

    async def run_sync(action, **_):
        return action()

    monkeypatch.setattr(to_thread, "run_sync", run_sync)


def run(test, *given):
    async def main():
        await asyncio.wait_for(test(Server(*given)), 1000)

    with asyncio.Runner(loop_factory=lambda: new_loop(None)) as runner:
        runner.run(main())


def request(method, path, *headers):
    """The first bytes of a request, with the end of the headers."""
    return "\r\n".join([f"{method} {path} HTTP/1.1", f"Host: {HOST}", *headers, "", ""]).encode()


async def drip(connection, data, every_s=1.0):
    """Sends a byte after the other until the connection has ended; returns when that was."""
    for byte in data:
        if connection.ended_s is not None:
            break
        connection.protocol.data_received(bytes([byte]))
        await asyncio.sleep(every_s)
    return connection.ended_s


def test_connection_with_slow_headers_ends_after_its_time():
    async def test(server):
        start = asyncio.get_running_loop().time()
        connection = Connection(server)
        assert await drip(connection, request("GET", "/api/v1/status")) == start + HEADERS_S
        assert connection.sent == b""
        silent = Connection(server)
        await asyncio.sleep(HEADERS_S + 1)
        assert silent.ended_s is not None

    run(test)


def test_time_for_headers_restarts_with_each_request():
    async def test(server):
        loop, connection = asyncio.get_running_loop(), Connection(server)
        whole = request("GET", "/api/v1/status")
        connection.protocol.data_received(whole)
        await asyncio.sleep(1)
        assert connection.sent.startswith(b"HTTP/1.1 200")
        start = loop.time()
        assert await drip(connection, whole) == start + HEADERS_S

    run(test)


@pytest.mark.parametrize(
    ("method", "path", "kind", "limit_s", "code"),
    [
        ("PUT", "/api/v1/heaters/hotend/target", "application/json", BODY_S, "web.slow"),
        ("PUT", f"{FILES}?path=a.gcode", "application/octet-stream", SPAN_S, "upload.slow"),
        ("POST", "/api/files/local", "multipart/form-data; boundary=x", SPAN_S, "upload.slow"),
    ],
)
@pytest.mark.usefixtures("at_once")
def test_slow_body_is_refused_after_its_time(tmp_path, method, path, kind, limit_s, code):
    async def test(server):
        loop, connection = asyncio.get_running_loop(), Connection(server)
        headers = request(method, path, f"Content-Type: {kind}", "Content-Length: 5000")
        connection.protocol.data_received(headers)
        start = loop.time()
        part = (
            b'--x\r\nContent-Disposition: form-data; name="file"; filename="a.gcode"\r\n\r\nG1 X1'
        )
        for byte in part:
            connection.protocol.data_received(bytes([byte]))
            await asyncio.sleep(1)
            if connection.sent:
                break
        assert limit_s <= loop.time() - start <= limit_s + 1
        head, _, body = connection.sent.partition(b"\r\n\r\n")
        assert head.startswith(b"HTTP/1.1 408")
        assert code.encode() in body
        assert not (tmp_path / "a.gcode").exists()

    run(test, str(tmp_path))


@pytest.mark.usefixtures("at_once")
def test_client_that_does_not_read_an_answer_is_dropped(tmp_path):
    (tmp_path / "long.gcode").write_bytes(b"G1 X1\n" * 200_000)

    async def test(server):
        loop = asyncio.get_running_loop()
        slow, late = Connection(server, reads=False), Connection(server, reads=False)
        start = loop.time()
        for one in (slow, late):
            one.protocol.data_received(request("GET", f"{FILES}?path=long.gcode"))
        await asyncio.sleep(UNREAD_S - 1)
        late.read_all()
        await asyncio.sleep(UNREAD_S)
        assert slow.ended_s == start + UNREAD_S
        assert len(slow.sent) < 300_000  # the rest of the file was not read
        assert len(late.sent) > 1_200_000

    run(test, str(tmp_path))


def upgrade():
    key = "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA=="
    wants = ["Connection: Upgrade", "Upgrade: websocket", "Sec-WebSocket-Version: 13", key]
    return request("GET", "/api/v1/feed", *wants)


def test_websocket_that_does_not_read_is_dropped_and_others_stay():
    async def test(server):
        loop, bridge = asyncio.get_running_loop(), server.bridge
        slow, fast = Connection(server, reads=False), Connection(server)
        for one in (slow, fast):
            one.protocol.data_received(upgrade())
        await asyncio.sleep(1)
        start = loop.time()
        for number in range(300):
            bridge.tell(Message(f"{number} {'x' * 400}"))
        await asyncio.sleep(UNREAD_MESSAGES_S + 1)
        assert slow.ended_s == pytest.approx(start + UNREAD_MESSAGES_S)
        assert len(slow.sent) < _MAX_UNREAD + 1000
        assert all(b"%d xxx" % number in fast.sent for number in range(300))
        assert fast.ended_s is None
        fast.close()
        await asyncio.sleep(0.1)
        assert bridge.listeners == []

    run(test)


def test_connections_of_one_address_are_limited_but_not_of_this_computer():
    async def test(server):
        far = [Connection(server, "192.168.1.7") for _ in range(MAX_OF_PEER + 1)]
        near = [Connection(server) for _ in range(MAX_OF_PEER + 1)]
        assert [one.ended_s is not None for one in far] == [False] * MAX_OF_PEER + [True]
        assert [one.ended_s for one in near] == [None] * (MAX_OF_PEER + 1)
        for one in (*far, *near):
            one.close()
        await asyncio.sleep(0.1)

    run(test)


def frame(opcode, data, *, fin=True, masked=True, length=None):
    """A WebSocket frame of a client, with a mask of zeros (RFC 6455, 5.2)."""
    first = bytes([opcode | (0x80 if fin else 0)])
    size = len(data) if length is None else length
    kind = size if size < 126 else 126
    more = b"" if size < 126 else size.to_bytes(2, "big")
    return first + bytes([kind | (0x80 if masked else 0)]) + more + b"\0" * 4 * masked + data


_TEXT, _CONTINUED, _BINARY, _CLOSE = 1, 0, 2, 8


@pytest.mark.parametrize(
    ("frames", "code"),
    [
        ([frame(_TEXT, b"{}", masked=False)], 1002),  # protocol error (RFC 6455, 7.4.1)
        ([frame(_CONTINUED, b"{}")], 1002),
        ([frame(3, b"")], 1002),
        ([frame(_TEXT, b"\xff")], 1007),
        ([frame(_TEXT, b"x" * 65000, fin=False), frame(_CONTINUED, b"x" * 65000)], 1009),
        ([frame(_TEXT, b"x", fin=False)] + [frame(_CONTINUED, b"x" * 60000, fin=False)] * 2, 1009),
        ([frame(_CLOSE, b"")], None),
        ([frame(_BINARY, b"x")], None),
    ],
)
def test_malformed_frames_end_a_websocket_with_their_code(frames, code):
    async def test(server):
        connection = Connection(server)
        connection.protocol.data_received(upgrade())
        await asyncio.sleep(1)
        before = len(connection.sent)
        for one in frames:
            connection.protocol.data_received(one)
            await asyncio.sleep(0)
        await asyncio.sleep(1)
        if code is not None:
            close = connection.sent[before:]
            assert (close[0], int.from_bytes(close[2:4], "big")) == (0x80 | _CLOSE, code)
        assert connection.ended_s is not None
        assert server.bridge.listeners == []

    run(test)


@pytest.mark.parametrize("empty", [b"", b"[]", b'{"type":"nothing"}'])
def test_invalid_feed_message_is_answered(empty):
    async def test(server):
        connection = Connection(server)
        connection.protocol.data_received(upgrade())
        await asyncio.sleep(1)
        before = len(connection.sent)
        connection.protocol.data_received(frame(_TEXT, empty))
        await asyncio.sleep(1)
        answer = connection.sent[before:]
        data = answer[4:] if answer[1] == 126 else answer[2:]
        assert msgspec.json.decode(data)["error"]["code"] == "web.malformed"
        assert connection.ended_s is None
        connection.close()
        await asyncio.sleep(0.1)

    run(test)
