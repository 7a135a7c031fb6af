"""Firmware that is built by an order over HTTP."""

import io
import json
import zipfile
from contextlib import contextmanager

import pytest
from tests.web.fake_bridge import FakeBridge
from tests.web.local_site import HOST, client, site

from passo import config
from passo.web.firmware import builds

API = "/api/v1/firmware"
FEED = f"ws://{HOST}/api/v1/feed"
# In place of the compiler: what it was ordered, a line, an image, and the status.
STAND_IN = """
import json, sys
from dataclasses import asdict
from pathlib import Path
from passo.toolchain.images import About, write_about
order = json.load(sys.stdin)
print("compiling", order.get("board") or order["name"], flush=True)
image = Path(order["output"], "i3.hex")
image.write_text(":00000001FF")
write_about(About("i3", "RAMPS", "m", image.name, "ab", 10, 20, 3, 4, "1", "c", "d", {}), image)
"""


@pytest.fixture
def web():
    with client(site(FakeBridge())) as web:  # one event loop for all requests
        yield web


def stand_in(monkeypatch, program):
    monkeypatch.setattr(builds, "_COMMAND", (builds.sys.executable, "-c", program))


@contextmanager
def lines_of_builds(web):
    """The feed, which sends the lines of builds by now."""
    with web.websocket_connect(FEED) as feed:
        feed.receive_json()
        feed.send_json({"type": "listen", "console": False, "builds": True})
        feed.send_json({"type": "script", "id": 1, "script": "M115"})
        while feed.receive_json()["type"] != "answer":
            pass
        yield feed


def last(web):
    """The last build, when it is over."""
    with lines_of_builds(web) as feed:
        while (found := web.get(f"{API}/build").json())["state"] == "running":
            feed.receive_json()
    return found


def test_boards_say_what_they_need(web):
    found = web.get(f"{API}/boards").json()
    assert [board["name"] for board in found["shipped"]] == config.shipped_boards()
    (main,) = found["machine"].values()
    assert (main["mcu"], main["flash"], main["state"]) == ("atmega2560", "avrdude", "ready")


def test_build_is_logged_and_downloaded(web, monkeypatch):
    stand_in(monkeypatch, STAND_IN)
    assert web.get(f"{API}/build").status_code == 404
    with lines_of_builds(web) as feed:
        answer = web.post(f"{API}/build", json={})
        assert (answer.status_code, answer.json()["of"]) == (202, "i3")
        line = {"type": "build", "number": 1, "state": "running", "line": "compiling machine.toml"}
        assert feed.receive_json() == line
        assert feed.receive_json() == {**line, "state": "done", "line": ""}
    found = last(web)
    assert (found["state"], found["log"]) == ("done", ["compiling machine.toml"])
    (image,) = found["images"]
    assert (image["file"], image["flash_bytes"], image["flash_size"]) == ("i3.hex", 10, 20)
    packed = web.get(f"{API}/build/zip")
    assert packed.headers["content-type"] == "application/zip"
    with zipfile.ZipFile(io.BytesIO(packed.content)) as archive:
        assert archive.namelist() == ["i3.hex", "i3.json", "build.log"]
        assert json.loads(archive.read("i3.json"))["mcu"] == "m"
        assert archive.read("build.log") == b"compiling machine.toml\n"


def test_one_build_at_a_time_and_it_can_be_cancelled(web, monkeypatch):
    stand_in(monkeypatch, "import time; print('begun', flush=True); time.sleep(60)")
    assert web.post(f"{API}/build", json={"board": "ramps"}).json()["of"] == "ramps"
    answer = web.post(f"{API}/build", json={"board": "ramps"})
    assert (answer.status_code, answer.json()["error"]["code"]) == (409, "firmware.busy")
    assert web.delete(f"{API}/build").status_code == 204
    assert last(web)["state"] == "cancelled"
    stand_in(monkeypatch, STAND_IN)
    assert web.post(f"{API}/build", json={"board": "ramps"}).json()["number"] == 2
    assert last(web)["state"] == "done"


def test_build_that_takes_too_long_is_ended(web, monkeypatch):
    stand_in(monkeypatch, "import time; time.sleep(60)")
    monkeypatch.setattr(builds, "MAX_S", 0.2)
    web.post(f"{API}/build", json={"board": "ramps"})
    found = last(web)
    text = "The build was ended: it took longer than 0.2 s."
    assert (found["state"], found["log"]) == ("failed", [text])


def test_build_of_a_text_with_errors_is_refused(web):
    answer = web.post(f"{API}/build", json={"text": "name = 1"})
    assert answer.json()["error"]["code"].startswith("config.")
    answer = web.post(f"{API}/build", json={"board": "none"})
    assert (answer.status_code, answer.json()["error"]["code"]) == (404, "firmware.board")


def test_build_for_a_machine_without_a_file_needs_a_text():
    bridge = FakeBridge()
    bridge.machine_source = ""  # a program made it
    with client(site(bridge)) as web:
        answer = web.post(f"{API}/build", json={})
    assert (answer.status_code, answer.json()["error"]["code"]) == (409, "machine.no-file")


def test_machine_text_becomes_an_image(web):
    web.post(f"{API}/build", json={"text": config.shipped_text("i3")})
    found = last(web)
    assert found["state"] == "done", found["log"]
    (image,) = found["images"]
    assert image["file"] == "i3.hex"
    assert 0 < image["flash_bytes"] < image["flash_size"] == 262144
    assert found["log"][0] == "i3: compiling for atmega2560 (RAMPS 1.4)"
