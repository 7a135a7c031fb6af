"""What slicers of the host type Moonraker ask, and what they get without a Moonraker."""

import hashlib
from dataclasses import replace

import pytest
from tests.support.web_errors import code_of
from tests.web.fake_bridge import STATUS, FakeBridge
from tests.web.local_site import local_client
from tests.web.slicers import recorded
from tests.web.slicers.recorded import GCODE

from passo.errors import CommandError
from passo.printer.status import PrinterState

UPLOAD = "/server/files/upload"


@pytest.fixture
def bridge(tmp_path):
    return FakeBridge(str(tmp_path))


@pytest.fixture
def client(bridge):
    with local_client(bridge) as client:
        yield client


@pytest.mark.parametrize(
    ("state", "shown"), [(PrinterState.IDLE, "ready"), (PrinterState.HALTED, "shutdown")]
)
def test_the_test_button_finds_a_moonraker(bridge, client, state, shown):
    bridge.show(replace(STATUS, state=state, halted="M112" if shown == "shutdown" else ""))
    ((key, told),) = client.get("/server/info").json().items()
    assert (key, told["klippy_state"]) == ("result", shown)
    assert told["moonraker_version"].startswith("passo-")
    (root,) = client.get("/server/files/roots").json()["result"]
    assert (root["name"], root["permissions"]) == ("gcodes", "rw")


@pytest.mark.parametrize("start", [True, False])
def test_a_file_is_uploaded_into_a_new_folder(bridge, client, tmp_path, start):
    sent = recorded.moonraker("a*b.gcode", start=start, folder="toys/cars")
    answer = client.post(UPLOAD, **sent)
    told = answer.json()
    assert (answer.status_code, told["print_started"], told["action"]) == (
        201,
        start,
        "create_file",
    )
    assert (told["item"]["path"], told["item"]["size"]) == ("toys/cars/a_b.gcode", len(GCODE))
    assert told["result"]["item"] == told["item"]
    assert (tmp_path / "toys/cars/a_b.gcode").read_bytes() == GCODE
    path = "/toys/cars/a_b.gcode"
    assert bridge.asked == [f"create {path}", *[f"print {path}"] * start]


def test_a_busy_printer_keeps_the_file_and_says_why_later(bridge, client, tmp_path):
    bridge.answers["print /part.gcode"] = CommandError.of("job.printing", value="other.gcode")
    answer = client.post(UPLOAD, **recorded.moonraker())
    assert (answer.status_code, answer.json()["print_started"]) == (201, False)
    assert (tmp_path / "part.gcode").read_bytes() == GCODE
    answer = client.post("/printer/print/start", json={"filename": "part.gcode"})
    assert (answer.status_code, code_of(answer)) == (409, "job.printing")
    del bridge.answers["print /part.gcode"]
    assert client.post("/printer/print/start?filename=part.gcode").json() == {"result": "ok"}


@pytest.mark.parametrize(
    ("sent", "status"),
    [
        (recorded.moonraker(folder="new", checksum="0" * 64), 400),
        (recorded.moonraker(root="config"), 400),
        (recorded.moonraker("part.bgcode", folder="new"), 415),
        (recorded.moonraker("part.gcode", folder="../new"), 400),
    ],
)
def test_a_refused_file_leaves_nothing_on_the_card(bridge, client, tmp_path, sent, status):
    assert client.post(UPLOAD, **sent).status_code == status
    assert list(tmp_path.iterdir()) == []


def test_a_right_checksum_is_accepted(client, tmp_path):
    sent = recorded.moonraker(checksum=hashlib.sha256(GCODE).hexdigest())
    assert client.post(UPLOAD, **sent).status_code == 201
    assert (tmp_path / "part.gcode").read_bytes() == GCODE
