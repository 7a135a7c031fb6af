"""What slicers of the host type PrusaLink ask, and what they get."""

import pytest
from tests.support.web_errors import code_of
from tests.web.fake_bridge import FakeBridge
from tests.web.local_site import local_client
from tests.web.slicers import recorded
from tests.web.slicers.recorded import GCODE


@pytest.fixture
def bridge(tmp_path):
    return FakeBridge(str(tmp_path))


@pytest.fixture
def client(bridge):
    with local_client(bridge) as client:
        yield client


def test_the_storage_is_the_card(client):
    (storage,) = client.get("/api/v1/storage").json()["storage_list"]
    assert (storage["path"], storage["available"], storage["read_only"]) == ("/local", True, False)
    assert storage["free_space"] > 0
    told = client.get("/api/version").json()
    assert told["text"].startswith("OctoPrint")
    assert told["capabilities"] == {"upload-by-put": True}


@pytest.mark.parametrize("start", [True, False])
def test_a_file_is_uploaded_and_printed(bridge, client, tmp_path, start):
    method, path, sent = recorded.prusalink("toys/part.gcode", start=start)
    answer = client.request(method, path, **sent)
    assert (answer.status_code, answer.json()["print_started"]) == (201, start)
    assert (tmp_path / "toys" / "part.gcode").read_bytes() == GCODE
    assert bridge.asked == ["create /toys/part.gcode", *["print /toys/part.gcode"] * start]


def test_binary_gcode_is_refused_in_words(client, tmp_path):
    method, path, sent = recorded.prusalink("part.bgcode")
    answer = client.request(method, path, **sent)
    assert (answer.status_code, code_of(answer)) == (415, "upload.binary")
    assert "Supports binary G-code" in answer.json()["error"]["action"]
