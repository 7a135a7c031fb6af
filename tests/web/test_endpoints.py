"""What operations send to the printer, and what they tell of it."""

from dataclasses import replace

import pytest
from tests.web.fake_bridge import STATUS, FakeBridge
from tests.web.local_site import HOST, client, local_client, site

from passo.printer.console_lines import ConsoleLine
from passo.printer.status import FaultStatus, HeaterStatus, JobStatus
from passo.web.bridge import PastPrint, SettingValue
from passo.web.logs import Logs

API = "/api/v1"


@pytest.fixture
def bridge():
    return FakeBridge()


@pytest.fixture
def web(bridge):
    return local_client(bridge)


def _jog(move):
    return f"SAVE_GCODE_STATE NAME=_ui_jog\n{move}\nRESTORE_GCODE_STATE NAME=_ui_jog"


@pytest.mark.parametrize(
    ("method", "path", "body", "script"),
    [
        (
            "POST",
            "motion/jog",
            {"distances_mm": {"x": 10, "z": -0.5}, "speed_mm_s": 50},
            _jog("G1 X10 Z-0.5 RXZ F3000"),
        ),
        (
            "POST",
            "motion/jog",
            {"distances_mm": {"e": 5}, "speed_mm_s": 5},
            _jog("G1 E5 RE F300"),
        ),
        ("POST", "motion/home", {}, "G28"),
        ("POST", "motion/home", {"axes": ["x", "y"]}, "G28 X Y"),
        ("POST", "motion/motors-off", None, "M18"),
        ("POST", "motion/wait", None, "M400"),
        ("POST", "console/end-wait", None, "M108"),
        ("PUT", "tuning/speed", {"factor": 1.5}, "M220 S150"),
        ("PUT", "tuning/flow/0", {"factor": 0.95}, "M221 T0 S95"),
        ("POST", "tuning/babystep", {"axis": "z", "distance_mm": -0.05}, "M290 Z-0.05"),
        ("POST", "settings/store", None, "M500"),
        ("POST", "settings/load", None, "M501"),
        ("POST", "settings/reset", None, "M502"),
        ("PUT", "job/objects/3", {"cancelled": True}, "cancel object 3"),
        ("PUT", "job/objects/3", {"cancelled": False}, "restore object 3"),
    ],
)
def test_operation_becomes_a_command(web, bridge, method, path, body, script):
    assert web.request(method, f"{API}/{path}", json=body).status_code == 204
    assert bridge.asked == [script]


@pytest.mark.parametrize(
    ("path", "body"),
    [
        ("motion/jog", {"distances_mm": {"x\nM112": 1}, "speed_mm_s": 50}),
        ("motion/jog", {"distances_mm": {}, "speed_mm_s": 50}),
        ("motion/home", {"axes": ["x\nM112"]}),
        ("tuning/babystep", {"axis": "e", "distance_mm": 0.1}),
        ("tuning/babystep", {"axis": "z", "distance_mm": 3}),
    ],
)
def test_nothing_but_parts_and_numbers_gets_into_a_command(web, bridge, path, body):
    assert web.post(f"{API}/{path}", json=body).status_code in (400, 404)
    assert bridge.asked == []


def test_settings_are_set_by_the_names_that_they_have(web, bridge):
    bridge.values = [SettingValue("Steps per unit", "M92", "X", "80", "80", None, "file")]
    assert web.get(f"{API}/settings").json()[0]["source"] == "file"
    body = {"command": "M92", "word": "X", "value": 80.25}
    assert web.put(f"{API}/settings", json=body).status_code == 204
    assert web.put(f"{API}/settings", json={**body, "command": "M112"}).status_code == 404
    assert bridge.asked == ["M92 X80.25"]
    row = ("SET_INPUT_SHAPER", "SHAPER_TYPE_X=", "mzv", "mzv", None, "file")
    bridge.values = [SettingValue("Input shapers", *row)]
    body = {"command": "SET_INPUT_SHAPER", "word": "SHAPER_TYPE_X=", "value": "ei"}
    assert web.put(f"{API}/settings", json=body).status_code == 204
    assert web.put(f"{API}/settings", json={**body, "value": "ei\nM112"}).status_code == 400
    assert bridge.asked[1:] == ["SET_INPUT_SHAPER SHAPER_TYPE_X=ei"]


def test_past_prints_and_faults_are_listed(web, bridge):
    bridge.prints = [PastPrint("a.gcode", 10, None, "done", 60.0, 5.0, "")] * 3
    assert len(web.get(f"{API}/job/past?limit=2").json()) == 2
    fault = FaultStatus("machine.emergency-stop", "printer", "it was stopped", "Send M999")
    bridge.show(replace(STATUS, faults=(fault,)))
    assert web.get(f"{API}/faults").json()[0]["code"] == "machine.emergency-stop"


def test_logs_are_those_of_the_server_and_without_secrets(bridge, tmp_path):
    key = "passo_" + "0a" * 20
    secrets = f'key {key}\n> M587 S"home" P"hunter2"\npassword=hunter2\nM5871 stays\n'
    (tmp_path / "passo.log").write_text(f"started\n{secrets}")
    (tmp_path / "passo.log.1").write_text("older")
    (tmp_path / "other.txt").write_text("secret")
    (tmp_path / "passo.log.link").symlink_to(tmp_path / "other.txt")
    web = client(site(bridge, logs=Logs([tmp_path / "passo.log"])))
    assert {log["name"] for log in web.get(f"{API}/logs").json()} == {"passo.log", "passo.log.1"}
    text = web.get(f"{API}/logs/passo.log").text
    assert "started" in text
    assert "M5871 stays" in text
    assert "hunter2" not in text
    assert key not in text
    for name in ("other.txt", "passo.log.link", "..%2Fother.txt", "none"):
        assert web.get(f"{API}/logs/{name}").status_code == 404


def test_metrics_are_a_view_of_the_status(web, bridge):
    job = JobStatus("a.gcode", 0.25, 1, 1, None, 60.0, None, filament_mm=12.5)
    heaters = {**STATUS.heaters, 'a"b\\': HeaterStatus(None, 0.0, 0.0, "sensor-open")}
    bridge.show(replace(STATUS, job=job, heaters=heaters))
    answer = web.get("/metrics")
    assert answer.headers["content-type"] == "text/plain; version=0.0.4; charset=utf-8"
    lines = answer.text.splitlines()
    assert answer.text.endswith("\n")
    assert 'passo_temperature_celsius{heater="bed"} 60' in lines
    assert 'passo_heater_fault{heater="a\\"b\\\\"} 1' in lines
    assert not any(line.startswith('passo_temperature_celsius{heater="a') for line in lines)
    assert 'passo_state{state="idle"} 1' in lines
    assert 'passo_state{state="printing"} 0' in lines
    assert "passo_job_progress_ratio 0.25" in lines
    assert 'passo_board_sent_bytes_total{board="main"} 665' in lines
    named = [line.split()[2] for line in lines if line.startswith("# TYPE ")]
    assert len(named) == len(set(named))


def test_feed_runs_scripts_and_shows_console_lines(web, bridge):
    bridge.answers["M115"] = ("FIRMWARE_NAME:Passo",)
    with web.websocket_connect(f"ws://{HOST}{API}/feed") as feed:
        assert feed.receive_json()["type"] == "status"
        feed.send_json({"type": "listen", "console": True})
        feed.send_json({"type": "script", "id": 1, "script": "M115"})
        assert feed.receive_json() == {
            "type": "answer",
            "id": 1,
            "lines": ["FIRMWARE_NAME:Passo"],
            "error": None,
        }
        assert bridge.senders == ["local"]
        line = ConsoleLine(1.0, 2, True, "G28", "ada")
        feed.portal.call(lambda: [call(line) for call in bridge.line_listeners])
        shown = feed.receive_json()
        assert (shown["type"], shown["line"]["sender"]) == ("line", "ada")
        feed.send_text("{")
        assert feed.receive_json()["error"]["code"] == "web.malformed"
    assert bridge.line_listeners == []


def test_places_are_those_where_hosts_and_browsers_connect(web):
    assert web.get(f"{API}/places").json() == ["tcp 127.0.0.1:2000", "http://127.0.0.1:4000"]
