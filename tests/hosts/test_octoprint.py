"""OctoPrint prints on `passo serve`."""

import json
import urllib.request

import pytest
from tests.hosts.noise import Noise
from tests.hosts.octoprint import OctoPrint
from tests.hosts.served import Served
from tests.support.bed_visualizer import drawn


@pytest.fixture(scope="module")
def server(hosts, tmp_path_factory):
    octoprint = OctoPrint(hosts / "octoprint", tmp_path_factory.mktemp("octoprint"))
    yield octoprint
    octoprint.close()


@pytest.fixture
def host(server):
    yield server
    if not server.state.startswith(("Closed", "Offline")):
        server.disconnect()


def port(printer, way):
    return printer.pty if way == "pty" else f"socket://{printer.tcp}"


@pytest.mark.parametrize("way", ["pty", "tcp"])
def test_octoprint_prints_to_the_end(router, whole, host, way):
    host.connect(port(router, way))
    host.print(whole.path)
    host.finished()
    assert {k: v for k, v in router.position().items() if k in whole.end} == whole.end


@pytest.mark.parametrize("way", ["pty", "tcp"])
def test_a_line_that_came_in_damaged_is_printed_once(printer, program, host, at_end, way, tmp_path):
    if way == "pty":
        noise, name = Noise(seed=4).on_pty(printer.pty, tmp_path / "noisy"), str(tmp_path / "noisy")
    else:
        noise, address = Noise(seed=4).on_tcp(printer.tcp)
        name = f"socket://{address}"
    try:
        host.connect(name)
        host.print(program.path)
        host.finished()
        host.disconnect()
    finally:
        noise.close()
    assert noise.damaged >= 10
    at_end(printer)


@pytest.mark.parametrize("way", ["pty", "tcp"])
def test_octoprint_uploads_to_card_and_prints(printer, program, host, at_end, way):
    host.connect(port(printer, way))
    host.wait(lambda: host.get("printer/sd")["ready"])
    host.upload(program.path, "sdcard")
    host.wait(lambda: host.state == "Operational" and host.get("files/sdcard")["files"])
    (stored,) = printer.card.iterdir()
    assert stored.read_text().split("\n") == program.text.split("\n")
    (listed,) = host.get("files/sdcard")["files"]
    host.post(f"files/sdcard/{listed['path'].lstrip('/')}", command="select", print=True)
    printer.wait_for("Done printing file")
    host.wait(lambda: host.state == "Operational")
    at_end(printer)


def test_names_beyond_ascii_are_listed_and_printed(printer, program, host, at_end):
    for name in ("Würfel & Kügel.gcode", "日本語.gcode", "中国語.gcode"):
        (printer.card / name).write_text(program.text)
    host.connect(port(printer, "pty"))
    host.wait(lambda: len(host.get("files/sdcard")["files"]) == 3)
    listed = {x["display"]: x["path"] for x in host.get("files/sdcard")["files"]}
    assert set(listed) == {"Würfel & Kügel.gcode", "日本語.gcode", "中国語.gcode"}
    path = listed["日本語.gcode"].lstrip("/")
    host.post(f"files/sdcard/{path}", command="select", print=True)
    printer.wait_for("Done printing file")
    host.wait(lambda: host.state == "Operational")
    at_end(printer)


@pytest.mark.parametrize("way", ["pty", "tcp"])
def test_a_pause_loses_nothing(printer, program, host, at_end, way):
    host.connect(port(printer, way))
    host.print(program.path)
    host.wait(lambda: host.sent > 10)
    host.job(command="pause", action="pause")
    host.wait(lambda: host.state == "Paused")
    sent = host.sent
    assert sent < 99
    host.job(command="pause", action="resume")
    host.finished()
    at_end(printer)


def test_a_move_that_is_refused_pauses_the_print(printer, program, host, at_end, tmp_path):
    """The motors go off in mid-print, and with them the place: nothing is printed in the air."""
    lines = program.text.split("\n")
    half = len(lines) // 2
    (tmp_path / "lost.gcode").write_text("\n".join([*lines[:half], "M84", *lines[half:]]))
    host.connect(port(printer, "pty"))
    host.print(tmp_path / "lost.gcode")
    host.wait(lambda: host.state == "Paused")
    assert host.sent < 99
    assert printer.position()["e"] < 0.6 * program.end["e"]
    host.job(command="cancel")
    host.wait(lambda: host.state == "Operational")
    host.print(program.path)
    host.finished()
    at_end(printer)


@pytest.mark.parametrize("way", ["pty", "tcp"])
def test_after_a_cancel_it_prints_again(printer, program, host, at_end, way):
    host.connect(port(printer, way))
    host.print(program.path)
    host.wait(lambda: host.sent > 10)
    host.job(command="cancel")
    host.wait(lambda: host.state == "Operational")
    assert printer.position()["e"] < 0.9 * program.end["e"]
    host.print(program.path)
    host.finished()
    at_end(printer)


@pytest.mark.parametrize("way", ["pty", "tcp"])
def test_octoprint_reconnects_in_mid_print(printer, program, host, at_end, way):
    host.connect(port(printer, way))
    host.print(program.path)
    host.wait(lambda: host.sent > 10)
    host.disconnect()
    host.connect(port(printer, way))
    host.print(program.path)
    host.finished()
    at_end(printer)


def test_octoprint_follows_pause_of_card_print(printer, program, host, at_end):
    lines = program.text.split("\n")
    half = len(lines) // 2
    change = "\n".join([*lines[:half], "M600", *lines[half:]])
    (printer.card / "change.gcode").write_text(change)
    host.connect(port(printer, "pty"))
    host.wait(lambda: host.get("printer/sd")["ready"] and host.get("files/sdcard")["files"])
    (listed,) = host.get("files/sdcard")["files"]
    host.post(f"files/sdcard/{listed['path'].lstrip('/')}", command="select", print=True)
    host.wait(lambda: host.state == "Paused")
    host.job(command="pause", action="resume")
    printer.wait_for("Done printing file")
    host.wait(lambda: host.state == "Operational")
    at_end(printer)


@pytest.fixture
def probing(tmp_path):
    """A printer with a probe, on a bed that is tilted and bent, and its HTTP API."""
    served = Served(tmp_path, "i3-probe", web=True)
    yield served
    served.close()


@pytest.mark.parametrize(
    ("kind", "commands"),
    [("fit", ("G29 T", "M420 S1 V")), ("mesh", ("BED_MESH_CALIBRATE", "BED_MESH_OUTPUT"))],
)
def test_bed_visualizer_draws_the_map_of_the_bed(probing, host, kind, commands):
    """By OctoPrint's serial log, as the HTTP API reports the bed; homing draws nothing."""
    host.connect(port(probing, "pty"))
    assert drawn(host.received("G28")) == []
    replies = [host.received(command) for command in commands]
    with urllib.request.urlopen(f"http://{probing.http}/api/v1/calibration/bed") as answer:
        bed = json.load(answer)
    assert bed["measured"] == kind
    front = bed["heights_mm"][0]
    assert front[-1] - front[0] > 0.2
    rows = [pytest.approx(row, abs=5.1e-4) for row in bed["heights_mm"]]
    assert [drawn(reply) for reply in replies] == [rows, rows]
