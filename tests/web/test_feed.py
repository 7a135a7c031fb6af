"""The WebSocket: the whole status first, then what changes, and each event."""

from dataclasses import replace

import pytest
from tests.web.fake_bridge import STATUS, FakeBridge
from tests.web.local_site import HOST, local_client

from passo.events import Message

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
