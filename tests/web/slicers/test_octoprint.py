"""What slicers of the host type OctoPrint ask, and what they get."""

import pytest
from tests.web.fake_bridge import FakeBridge
from tests.web.local_site import local_client
from tests.web.slicers import recorded
from tests.web.slicers.recorded import GCODE

from passo.errors import CommandError


@pytest.fixture
def bridge(tmp_path):
    return FakeBridge(str(tmp_path))


@pytest.fixture
def client(bridge):
    with local_client(bridge) as client:
        yield client


def test_prusaslicer_uploads_and_prints(bridge, client, tmp_path):
    answer = client.post("/api/files/local", **recorded.prusaslicer())
    assert answer.status_code == 201
    assert answer.headers["location"] == "http://127.0.0.1:4000/api/files/local/part.gcode"
    assert (tmp_path / "part.gcode").read_bytes() == GCODE
    assert bridge.asked == ["create /part.gcode", "print /part.gcode"]
    told = answer.json()
    assert told["effectivePrint"] is True
    assert told["files"]["local"]["path"] == "part.gcode"


def test_prusaslicer_uploads_into_a_folder(bridge, client, tmp_path):
    (tmp_path / "toys").mkdir()
    sent = recorded.prusaslicer(start=False, folder="toys")
    assert client.post("/api/files/local", **sent).json()["effectivePrint"] is False
    assert (tmp_path / "toys" / "part.gcode").read_bytes() == GCODE
    assert bridge.asked == ["create /toys/part.gcode"]


def test_cura_says_after_the_file_that_it_prints(bridge, client, tmp_path):
    assert client.post("/api/files/local", **recorded.cura()).status_code == 201
    assert bridge.asked == ["create /CE3_part.gcode", "print /CE3_part.gcode"]


def test_a_busy_printer_keeps_the_file(bridge, client, tmp_path):
    bridge.answers["print /part.gcode"] = CommandError.of("job.printing", value="other.gcode")
    answer = client.post("/api/files/local", **recorded.prusaslicer())
    assert (answer.status_code, answer.json()["effectivePrint"]) == (201, False)
    assert (tmp_path / "part.gcode").exists()


@pytest.mark.parametrize(
    ("name", "code"),
    [("part.bgcode", "upload.binary"), ("part.stl", "upload.kind"), ("../p.gcode", "card.name")],
)
def test_a_refused_file_is_answered_in_json(bridge, client, tmp_path, name, code):
    answer = client.post("/api/files/local", **recorded.prusaslicer(name))
    assert answer.status_code in (400, 415)
    assert answer.json()["error"]["code"] == code
    assert list(tmp_path.iterdir()) == bridge.asked == []


def test_a_file_that_is_printed_is_not_replaced(bridge, client, tmp_path):
    (tmp_path / "part.gcode").write_bytes(b"G28\n")
    bridge.answers["create /part.gcode"] = CommandError.of("job.printing", value="part.gcode")
    answer = client.post("/api/files/local", **recorded.prusaslicer())
    assert (answer.status_code, answer.json()["error"]["code"]) == (409, "job.printing")
    assert (tmp_path / "part.gcode").read_bytes() == b"G28\n"
