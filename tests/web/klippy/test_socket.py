"""Klipper's socket itself: its file, its clients, and what they must not break."""

import asyncio
import json
import socket
import stat
from dataclasses import replace

import pytest
from tests.web.fake_bridge import STATUS, FakeBridge

from passo.errors import InputError
from passo.web.klippy import server
from passo.web.klippy.server import KlippySocket


async def ask(path, method, **params):
    """A connection of its own, for one request."""
    reader, writer = await asyncio.open_unix_connection(path)
    writer.write(json.dumps({"id": 1, "method": method, "params": params}).encode() + b"\x03")
    answer = json.loads((await reader.readuntil(b"\x03"))[:-1])
    return reader, writer, answer["result"]


def run(test, tmp_path):
    """Runs a test with the path of a socket that is served, and its bridge."""

    async def main():
        path, bridge = str(tmp_path / "klippy"), FakeBridge()
        serving = asyncio.create_task(KlippySocket(bridge, path).run())
        try:
            await asyncio.wait_for(test(path, bridge), 10)
        finally:
            serving.cancel()
            await asyncio.wait([serving])
        assert not (tmp_path / "klippy").exists()

    asyncio.run(main())


def test_socket_is_private_and_replaces_an_old_one(tmp_path):
    path = tmp_path / "klippy"
    old = socket.socket(socket.AF_UNIX)
    old.bind(str(path))
    KlippySocket(FakeBridge(), str(path))._listening.socket.close()
    old.close()
    assert stat.S_ISSOCK(path.stat().st_mode)
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert [p.name for p in tmp_path.iterdir()] == ["klippy"]


def test_file_in_its_place_is_not_touched(tmp_path):
    (tmp_path / "klippy").write_text("mine")
    with pytest.raises(InputError, match="klippy cannot be opened: the path is that of a file"):
        KlippySocket(FakeBridge(), str(tmp_path / "klippy"))
    assert (tmp_path / "klippy").read_text() == "mine"


def test_restart_ends_connections_and_reopens_the_socket(tmp_path):
    async def test(path, bridge):
        reader, writer, _ = await ask(path, "gcode/firmware_restart")
        assert await reader.read() == b""
        writer.close()
        while "FIRMWARE_RESTART" not in bridge.asked:
            await asyncio.sleep(0.01)
        await asyncio.sleep(0.05)
        _, writer, info = await ask(path, "info")
        assert info["state"] == "ready"
        writer.close()

    run(test, tmp_path)


def test_changes_are_pushed_while_another_client_sends_rubbish(tmp_path):
    async def test(path, bridge):
        reader, writer, _ = await ask(path, "objects/subscribe", objects={"fan": None})
        _, hostile = await asyncio.open_unix_connection(path)
        hostile.write(b"\x00\xff\x03[]\x03" + b"{" * 5000 + b"\x03" + b"x" * (5 << 20))
        bridge.show(replace(STATUS, fans={"part": 0.5}))
        news = json.loads((await reader.readuntil(b"\x03"))[:-1])
        assert news["params"]["status"] == {"fan": {"speed": 0.5}}
        for one in (writer, hostile):
            one.close()

    run(test, tmp_path)


def test_client_that_does_not_read_is_dropped_and_others_stay(tmp_path, monkeypatch):
    monkeypatch.setattr(server, "_TIMEOUT_S", 0.3)
    monkeypatch.setattr(server, "PUSH_S", 0.05)

    async def test(path, bridge):
        slow = socket.socket(socket.AF_UNIX)
        slow.connect(path)
        request = (
            json.dumps(
                {
                    "id": 1,
                    "method": "objects/query",
                    "params": {"objects": {"configfile": None, "gcode": None}},
                }
            ).encode()
            + b"\x03"
        )
        slow.setblocking(False)
        for _ in range(200):
            await asyncio.get_running_loop().sock_sendall(slow, request)
        _, writer, info = await ask(path, "info")
        clients = bridge.listeners[0].connections
        assert len(clients) == 2
        while len(clients) > 1:
            await asyncio.sleep(0.02)
        assert info["state"] == "ready"
        slow.close()
        writer.close()

    run(test, tmp_path)
