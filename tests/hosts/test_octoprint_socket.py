"""A hub for OctoPrint on `passo serve`: it uploads, and follows the print on the WebSocket."""

import json
import urllib.request

import pytest
from tests.hosts.served import Served
from websockets.sync.client import connect

NAME = "part.gcode"
FILE = "G28\nM104 S180\nG1 X20 Y20 Z5 F6000\n" + "G1 X80 F6000\nG1 X20\n" * 40 + "M104 S0\n"
BORDER = "b"
UPLOAD = (
    f'--{BORDER}\r\nContent-Disposition: form-data; name="print"\r\n\r\ntrue\r\n'
    f'--{BORDER}\r\nContent-Disposition: form-data; name="file"; filename="{NAME}"\r\n\r\n'
    f"{FILE}\r\n--{BORDER}--\r\n"
)


@pytest.fixture
def served(tmp_path):
    found = Served(tmp_path, web=True)
    yield found
    found.close()


def ask(served, path, body, kind="application/json"):
    """What the printer answers to a POST."""
    request = urllib.request.Request(f"http://{served.http}{path}", body.encode())
    request.add_header("Content-Type", kind)
    with urllib.request.urlopen(request, timeout=30) as answer:
        return json.loads(answer.read())


def test_hub_follows_a_print_to_its_end(served):
    session = ask(served, "/api/login", '{"passive": true}')["session"]
    states, ends = [], []
    with connect(f"ws://{served.http}/sockjs/websocket") as socket:
        socket.send(json.dumps({"auth": f"local:{session}"}))
        told = ask(served, "/api/files/local", UPLOAD, f"multipart/form-data; boundary={BORDER}")
        assert told["effectivePrint"] is True
        while not (ends and states[-1] == "Operational"):
            message = json.loads(socket.recv(timeout=30))
            if state := message.get("current", {}).get("state"):
                states.append(state["text"])
            event = message.get("event", {})
            if event.get("type", "").startswith("Print") and "path" in event["payload"]:
                ends.append((event["type"], event["payload"]["path"]))
    assert ends == [("PrintDone", NAME)]
