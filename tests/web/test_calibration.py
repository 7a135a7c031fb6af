"""Calibration over HTTP: what it sends, what it works out, and the map of the bed."""

import pytest
from tests.web.fake_bridge import FakeBridge
from tests.web.local_site import local_client

from passo.config.load import shipped_text
from passo.config.thermistor import Ntc
from passo.levelling.correction import Correction
from passo.levelling.fits import Fit
from passo.levelling.mesh import Mesh
from passo.web.bridge import BedState, SettingValue

API = "/api/v1/calibration"


@pytest.fixture
def bridge():
    return FakeBridge(machine="i3-probe")


@pytest.fixture
def web(bridge):
    return local_client(bridge)


@pytest.mark.parametrize(
    ("method", "path", "body", "script"),
    [
        ("POST", "heater", {"heater": "hotend", "celsius": 210}, "M303 H0 S210 C8 R0 U1"),
        (
            "POST",
            "heater",
            {"heater": "bed", "celsius": 60, "method": "model"},
            "M303 H-1 S60 R5 U1",
        ),
        ("POST", "bed", None, "G28\nG29"),
        ("POST", "probe", None, "G28\nM48 P10"),
        (
            "PUT",
            "thermistor",
            {"heater": "hotend", "r25_ohm": 98e3, "beta_k": 4180.5, "c_per_k": 9e-8},
            "M305 H0 A98000 B4180.5 C0.00000009",
        ),
    ],
)
def test_task_becomes_commands(web, bridge, method, path, body, script):
    assert web.request(method, f"{API}/{path}", json=body).status_code < 300
    assert bridge.asked == [script]


def test_a_shaper_is_measured_where_there_is_an_accelerometer(tmp_path):
    web = local_client(FakeBridge(machine="i3"))
    assert web.post(f"{API}/shaper", json={"axis": "y"}).status_code == 404
    pins = 'cs_pin = "D40"\nclock_pin = "D42"\nmosi_pin = "D59"\nmiso_pin = "D64"'
    file = tmp_path / "mine.toml"
    file.write_text(f"{shipped_text('i3')}\n[accelerometer]\n{pins}\n", encoding="utf-8")
    bridge = FakeBridge(machine=str(file))
    web = local_client(bridge)
    assert web.get("/api/v1/machine").json()["accelerometer"] is True
    assert web.post(f"{API}/shaper", json={"axis": "y"}).status_code == 200
    assert bridge.asked == ["G28\nSHAPER_CALIBRATE AXIS=Y"]


@pytest.mark.parametrize(
    ("machine", "procedure", "script"),
    [("i3-two-z", "gantry", "G28\nG34"), ("delta-probe", "delta", "G28\nG33")],
)
def test_levelling_is_offered_by_what_the_machine_has(machine, procedure, script):
    bridge = FakeBridge(machine=machine)
    web = local_client(bridge)
    assert procedure in web.get(f"{API}/bed").json()["procedures"]
    assert web.post(f"{API}/level", json={"procedure": procedure}).status_code == 200
    assert bridge.asked == [script]


def test_levelling_that_the_machine_does_not_have_is_refused(web, bridge):
    assert web.get(f"{API}/bed").json()["procedures"] == ["screws"]
    assert web.post(f"{API}/level", json={"procedure": "delta"}).status_code == 404
    assert bridge.asked == []


def test_fit_starts_from_the_thermistor_in_force(web, bridge):
    rows = (("A", "100000"), ("B", "4100"), ("C", "0"))
    bridge.values = [
        SettingValue("Heater sensors", "M305 H0", word, value, "3950", None, "command")
        for word, value in rows
    ]
    true = Ntc(100_000.0, 4500.0, 5e-8)
    shown = Ntc(100_000.0, 4100.0)
    readings = [{"shown_c": c, "true_c": true.celsius(shown.ohm(c))} for c in (100, 160, 200, 240)]
    answer = web.post(f"{API}/thermistor/fit", json={"heater": "hotend", "readings": readings})
    now, beta, full = answer.json()
    assert now["beta_k"] == 4100
    assert now["residuals_c"][3] == pytest.approx(240 - readings[3]["true_c"])
    assert (beta["method"], full["method"]) == ("beta", "steinhart-hart")
    assert full["beta_k"] == pytest.approx(4500, rel=1e-3)
    assert full["rms_c"] < 1e-3 < beta["rms_c"] < now["rms_c"]
    assert bridge.asked == []


def test_reading_that_no_thermistor_gives_is_refused(web, bridge):
    bridge.values = [SettingValue("", "M305 H0", word, "3950", "", None, "file") for word in "ABC"]
    body = {"heater": "hotend", "readings": [{"shown_c": 200, "true_c": 20}]}
    answer = web.post(f"{API}/thermistor/fit", json=body)
    assert answer.json()["error"]["code"] == "input.point-far"
    body["heater"] = "nothing"
    assert web.post(f"{API}/thermistor/fit", json=body).status_code == 404


def test_bed_map_is_that_of_the_mesh_or_a_sampled_fit(web, bridge):
    empty = web.get(f"{API}/bed").json()
    assert (empty["probe"], empty["measured"], empty["heights_mm"]) == (True, "none", [])
    mesh = Mesh((0.0, 100.0), (0.0, 50.0, 100.0), ((0.1, 0.2), (0.0, 0.0), (-0.1, -0.2)))
    bridge.bed_state = BedState(Correction(mesh=mesh), on=True)
    found = web.get(f"{API}/bed").json()
    assert (found["measured"], found["on"], found["ys_mm"]) == ("mesh", True, [0, 50, 100])
    assert found["heights_mm"][2] == pytest.approx([-0.1, -0.2])
    bridge.bed_state = BedState(Correction(fit=Fit(0.0, 0.01)), on=False)
    found = web.get(f"{API}/bed").json()
    assert (found["measured"], found["xs_mm"][-1]) == ("fit", 250)
    assert found["heights_mm"][0][-1] == pytest.approx(2.5)
