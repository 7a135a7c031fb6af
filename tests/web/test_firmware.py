"""Firmware that is built by an order over HTTP."""

import asyncio
import io
import json
import zipfile
from contextlib import contextmanager
from dataclasses import replace
from fnmatch import fnmatch
from pathlib import Path

import pytest
from tests.toolchain.fakes import TEENSY_CODE, intel_hex, program
from tests.web.fake_bridge import STATUS, FakeBridge
from tests.web.local_site import HOST, Clock, accounts, client, site

from passo import config
from passo.printer.status import HeaterStatus
from passo.web.endpoints import firmware
from passo.web.firmware import builds
from passo.web.firmware.ports import Port, ports
from passo.web.roles import Role

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


def test_boards_list_their_manual_steps(web):
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


TEENSY = "teensy3-mk20dx256"
COLD = replace(STATUS, heaters={"hotend": HeaterStatus(25.0, 0.0, 0.0)})


@pytest.fixture
def cold():
    """A printer with cold heaters, whose computer has built the image of a Teensy."""
    bridge = FakeBridge()
    bridge.show(COLD)
    with client(site(bridge)) as web:
        yield bridge, web


def build_teensy(web, monkeypatch):
    image = f"image.write_text({intel_hex(TEENSY_CODE)!r})"
    text = STAND_IN.replace("i3.hex", f"{TEENSY}.hex").replace(
        'image.write_text(":00000001FF")', image
    )
    about = 'About("i3", "RAMPS", "m", image.name, "ab", 10, 20, 3, 4, "1", "c", "d", {})'
    stand_in(monkeypatch, text.replace(f"write_about({about}, image)", "").rstrip() + WITH_ABOUT)
    web.post(f"{API}/build", json={"board": TEENSY})
    assert last(web)["state"] == "done"


WITH_ABOUT = """
from hashlib import sha256
sha = sha256(image.read_bytes()).hexdigest()
about = About("t", "Teensy 3.2", "mk20dx256", image.name, sha, 10, 20, 3, 4, "1", "c", "", {})
write_about(about, image)
"""


def flashing(web, *states):
    """What is flashed, once it is in one of these states."""
    with lines_of_builds(web) as feed:
        while (found := web.get(f"{API}/flash").json())["state"] not in states:
            feed.send_json({"type": "script", "id": 2, "script": "M115"})
            feed.receive_json()
    return found


def test_image_is_flashed_after_its_step_by_hand(cold, monkeypatch, tmp_path):
    _, web = cold
    notes = program(tmp_path / "bin", "teensy_loader_cli", then="print('Programming...')")
    monkeypatch.setenv("PATH", str(tmp_path / "bin"))
    build_teensy(web, monkeypatch)
    answer = web.post(f"{API}/flash", json={"image": f"{TEENSY}.hex"})
    assert (answer.status_code, answer.json()["state"]) == (202, "running")
    again = web.post(f"{API}/flash", json={"image": f"{TEENSY}.hex"})
    assert again.json()["error"]["code"] == "firmware.busy"
    assert (
        web.post(f"{API}/build", json={"board": "ramps"}).json()["error"]["code"] == "firmware.busy"
    )
    found = flashing(web, "waiting")
    assert found["asks"] == "Press the button on the Teensy."
    assert not notes.exists()
    web.post(f"{API}/flash/confirm")
    found = flashing(web, "done", "failed")
    assert (found["state"], found["asks"]) == ("done", "")
    assert "Programming..." in found["log"]
    assert found["log"][-1].startswith(f"{TEENSY}: written.")
    assert json.loads(notes.read_text())[:3] == ["--mcu=mk20dx256", "-w", "-v"]


def test_flashing_is_cancelled_at_a_step_by_hand(cold, monkeypatch, tmp_path):
    _, web = cold
    notes = program(tmp_path / "bin", "teensy_loader_cli")
    monkeypatch.setenv("PATH", str(tmp_path / "bin"))
    build_teensy(web, monkeypatch)
    web.post(f"{API}/flash", json={"image": f"{TEENSY}.hex"})
    flashing(web, "waiting")
    assert web.delete(f"{API}/flash").status_code == 204
    assert web.get(f"{API}/flash").json()["state"] == "cancelled"
    assert not notes.exists()


def test_missing_program_is_named_in_the_log(cold, monkeypatch, tmp_path):
    _, web = cold
    monkeypatch.setenv("PATH", str(tmp_path))
    build_teensy(web, monkeypatch)
    web.post(f"{API}/flash", json={"image": f"{TEENSY}.hex"})
    found = flashing(web, "done", "failed")
    assert found["state"] == "failed"
    assert "the program teensy_loader_cli, which is missing" in found["log"][-1]


def test_flashing_is_refused_while_it_would_disturb(cold, monkeypatch):
    bridge, web = cold

    def code(**order):
        return web.post(f"{API}/flash", json=order).json()["error"]["code"]

    assert code(image="i3.hex") == "web.not-found"
    build_teensy(web, monkeypatch)
    used = [Port("/dev/ttyUSB0", "", used=True), Port("/dev/ttyUSB1", "", used=False)]
    monkeypatch.setattr(firmware, "ports", lambda *_: used)
    assert [port["path"] for port in web.get(f"{API}/ports").json()] == [
        "/dev/ttyUSB0",
        "/dev/ttyUSB1",
    ]
    assert code(image=f"{TEENSY}.hex", port="/dev/ttyUSB0") == "firmware.port-used"
    assert code(image=f"{TEENSY}.hex", port="/dev/mem") == "web.not-found"
    bridge.show(STATUS)  # its bed is on
    assert code(image=f"{TEENSY}.hex") == "firmware.not-now"


def test_flashing_needs_the_password_again():
    clock = Clock()
    kept = accounts(clock=clock)
    asyncio.run(kept.add("ada", "a long password", Role.ADMIN))
    with client(site(FakeBridge(), kept)) as web:
        web.headers["X-Passo-Request"] = "1"
        web.post("/api/v1/session", json={"name": "ada", "password": "a long password"})
        codes = []
        for passed_s in (0, 400):
            clock.s += passed_s
            answer = web.post(f"{API}/flash", json={"image": "x.hex"})
            codes.append(answer.json()["error"]["code"])
    assert codes == ["web.not-found", "web.password"]


def test_ports_of_boards_and_consoles_are_in_use(monkeypatch):
    machine = config.load_text(
        config.shipped_text("i3") + 'link = "serial"\nport = "/dev/ttyUSB0"\n', "my.toml"
    )
    found = {
        Path("/dev"): ["ttyACM0", "ttyUSB0", "ttyUSB1"],
        Path("/dev/serial/by-id"): [],
        Path("/"): [],
    }

    def glob(folder, pattern):
        return [folder / name for name in found[folder] if fnmatch(name, pattern)]

    monkeypatch.setattr(Path, "glob", glob)
    assert [(p.path, p.used) for p in ports(machine, ["serial /dev/ttyUSB1", "tcp :1"])] == [
        ("/dev/ttyACM0", False),
        ("/dev/ttyUSB0", True),
        ("/dev/ttyUSB1", True),
    ]
