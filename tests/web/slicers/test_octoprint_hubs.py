"""What hubs and apps for OctoPrint ask, in addition to slicers: FDM Monster logs in, reads the
WebSocket, jogs and heats."""

import asyncio
from dataclasses import replace

import pytest
from starlette.websockets import WebSocketDisconnect
from tests.support.web_errors import code_of
from tests.web.fake_bridge import STATUS, FakeBridge
from tests.web.local_site import HOST, accounts, client, local_client, site
from tests.web.slicers.recorded import GCODE

from passo.events import JobEnded, StateChanged
from passo.printer.status import PrinterState
from passo.web.roles import Role
from passo.web.slicers import octoprint_socket
from passo.web.slicers.octoprint_sessions import VALID_S, LoginSessions

SOCKET = f"ws://{HOST}/sockjs/websocket"
REMOTE = "192.168.1.9"


@pytest.fixture
def bridge(tmp_path):
    return FakeBridge(str(tmp_path))


@pytest.fixture
def local(bridge, monkeypatch):
    monkeypatch.setattr(octoprint_socket, "INTERVAL_S", 0)
    with local_client(bridge) as found:
        yield found


def remote_site(bridge, clock=None):
    kept = accounts(clock=clock)
    return kept, site(bridge, kept, loopback=False)


def key_of(portal, kept, role):
    portal.call(kept.add, "anna", "correct horse battery", Role.ADMIN)
    return portal.call(kept.add_key, "farm", role)[1]


def test_socket_reports_changes_of_state_and_the_end_of_prints(bridge, local):
    with local.websocket_connect(SOCKET) as socket:
        assert socket.receive_json()["connected"]["display_version"].startswith("OctoPrint (Passo")
        assert socket.receive_json()["history"]["state"]["text"] == "Operational"
        assert socket.receive_json()["current"]["temps"][0]["bed"]["target"] == 60
        socket.portal.call(bridge.show, replace(STATUS, state=PrinterState.PRINTING))
        flags = socket.receive_json()["current"]["state"]["flags"]
        assert (flags["printing"], flags["ready"]) == (True, False)
        socket.portal.call(bridge.tell, JobEnded("/toys/part.gcode", "cancelled"))
        file = {"name": "part.gcode", "path": "toys/part.gcode", "origin": "local"}
        event = {"type": "PrintCancelled", "payload": file}
        assert socket.receive_json() == {"event": event}
        changed = StateChanged(PrinterState.PAUSED, PrinterState.PRINTING)
        socket.portal.call(bridge.tell, changed)
        assert socket.receive_json()["event"]["payload"]["state_id"] == "PAUSED"
    assert bridge.listeners == []


def test_socket_without_log_in_reports_the_version_alone(bridge):
    kept, app = remote_site(bridge)
    with client(app, REMOTE) as caller, caller.websocket_connect(SOCKET) as socket:
        key = key_of(socket.portal, kept, Role.VIEWER)
        assert "connected" in socket.receive_json()
        for wrong in ("anna:", "anna:x", key):
            socket.send_json({"auth": wrong})
            assert socket.receive_json() == {"reauthRequired": {"reason": "stale"}}
        assert bridge.listeners == []
        login = caller.post("/api/login", json={"passive": True}, headers={"X-Api-Key": key})
        assert (login.json()["name"], login.json()["admin"]) == ("farm", False)
        socket.send_json({"throttle": 1})
        socket.send_json({"auth": f"farm:{login.json()['session']}"})
        assert "history" in socket.receive_json()


def test_socket_closes_a_client_that_does_not_log_in(bridge, monkeypatch):
    monkeypatch.setattr(octoprint_socket, "LOGIN_S", 0)
    _, app = remote_site(bridge)
    with client(app, REMOTE) as caller, caller.websocket_connect(SOCKET) as socket:
        assert "connected" in socket.receive_json()
        with pytest.raises(WebSocketDisconnect):
            socket.receive_json()


def test_socket_ends_without_an_error_after_a_disconnect(bridge):
    received = iter([{"type": "websocket.connect"}, {"type": "websocket.disconnect", "code": 1006}])
    sent = []

    async def receive():
        return next(received)

    async def send(message):
        sent.append(message["type"])
        if message["type"] == "websocket.close":
            raise OSError("the connection is lost")

    async def main():
        scope = {
            "type": "websocket",
            "path": "/sockjs/websocket",
            "headers": [(b"host", HOST.encode())],
            "client": ("127.0.0.1", 50000),
            "query_string": b"",
            "subprotocols": [],
        }
        await site(bridge)(scope, receive, send)

    asyncio.run(main())
    assert sent[0] == "websocket.accept"
    assert "websocket.close" not in sent
    assert bridge.listeners == []


def test_session_of_a_revoked_key_is_refused(bridge):
    kept, app = remote_site(bridge)
    with client(app, REMOTE) as caller, caller.websocket_connect(SOCKET) as socket:
        socket.receive_json()
        key = key_of(socket.portal, kept, Role.VIEWER)
        session = caller.post("/api/login", headers={"X-Api-Key": key}).json()["session"]
        socket.portal.call(kept.revoke_key, kept.keys[0].id)
        socket.send_json({"auth": f"farm:{session}"})
        assert socket.receive_json() == {"reauthRequired": {"reason": "stale"}}


def test_session_ends_ten_minutes_after_the_log_in():
    now = [0.0]
    sessions = LoginSessions(lambda: now[0])
    caller = object()
    token = sessions.begin(caller)
    now[0] = VALID_S
    assert sessions.caller(token) is caller
    now[0] += 1
    assert sessions.caller(token) is None


def test_keys_have_a_length_that_hubs_accept(bridge):
    kept, app = remote_site(bridge)
    with client(app, REMOTE) as caller:
        key = key_of(caller.portal, kept, Role.OPERATOR)
    assert 32 <= len(key) <= 43  # FDM Monster refuses others
    assert key.replace("_", "").isalnum()


@pytest.mark.parametrize(
    ("path", "body", "asked"),
    [
        ("printhead", {"command": "home", "axes": ["x", "y"]}, "G28 X Y"),
        (
            "printhead",
            {"command": "jog", "x": 10, "y": 0, "z": -0.5},
            "SAVE_GCODE_STATE NAME=_ui_octoprint\nG1 X10 Z-0.5 RXZ F600\n"
            "RESTORE_GCODE_STATE NAME=_ui_octoprint",
        ),
        ("tool", {"command": "target", "targets": {"tool0": 210}}, "M104 T0 S210"),
        ("bed", {"command": "target", "target": 60}, "M140 S60"),
    ],
)
def test_moves_and_targets_are_commands(bridge, local, path, body, asked):
    assert local.post(f"/api/printer/{path}", json=body).status_code == 204
    assert bridge.asked == [asked]


@pytest.mark.parametrize(
    ("path", "body"),
    [
        ("printhead", {"command": "home", "axes": ["e"]}),
        ("printhead", {"command": "jog", "x": "1"}),
        ("tool", {"command": "target", "targets": {"bed": 60}}),
        ("bed", {"command": "target"}),
        ("bed", {"command": "offset", "offset": 5}),
    ],
)
def test_malformed_moves_and_targets_are_refused(bridge, local, path, body):
    answer = local.post(f"/api/printer/{path}", json=body)
    assert (answer.status_code, code_of(answer)) == (400, "web.malformed")
    assert bridge.asked == []


def test_folder_lists_its_files_and_a_part_is_downloaded(local, tmp_path):
    (tmp_path / "toys").mkdir()
    (tmp_path / "toys" / "part.gcode").write_bytes(GCODE)
    (file,) = local.get("/api/files/local/toys?recursive=false").json()["children"]
    assert (file["path"], file["size"]) == ("toys/part.gcode", len(GCODE))
    part = {"Range": "bytes=0-10"}
    answer = local.get("/downloads/files/local/toys/part.gcode", headers=part)
    assert (answer.status_code, answer.content) == (206, GCODE[:11])


def test_current_user_is_the_owner_of_the_request(local):
    assert local.get("/api/currentuser").json()["name"] == "local"
    assert local.get("/api/server").json() == {"version": "1.5.0", "safemode": None}
