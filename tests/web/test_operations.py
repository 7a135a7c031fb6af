"""Requests reach the printer as the table declares them; refusals are errors of the catalogue."""

import asyncio

import pytest
from tests.web.fake_bridge import FakeBridge
from tests.web.local_site import local_client, site

from passo import AsyncClient, Client, RequestError
from passo.errors import CommandError
from passo.gcode.registry import table
from passo.web.operation import operation
from passo.web.operations import OPERATIONS
from passo.web.roles import Role
from passo.web.server import WebThread, listening


@pytest.fixture
def bridge():
    return FakeBridge()


@pytest.fixture
def web(bridge):
    return local_client(bridge)


@pytest.fixture
def served(bridge):
    """Where the bridge's printer is served."""
    thread, socket = WebThread(), listening("127.0.0.1", 0)
    port = socket.getsockname()[1]
    thread.serve(site(bridge), socket)
    yield f"http://127.0.0.1:{port}"
    thread.close()


def test_names_and_paths_are_declared_once():
    names = [operation.name for operation in OPERATIONS]
    assert len(names) == len(set(names))
    places = [(operation.method, operation.path) for operation in OPERATIONS]
    assert len(places) == len(set(places))
    assert all(operation.text for operation in OPERATIONS)


def test_handler_that_misses_a_part_of_the_path_is_no_operation():
    async def handler(call) -> None: ...

    with pytest.raises(TypeError, match=r"takes \[\], the path /fans/{name} gives \['name'\]"):
        operation("fans.set", "PUT", "/fans/{name}", Role.OPERATOR)(handler)


@pytest.mark.parametrize(
    ("path", "body", "script"),
    [
        ("heaters/hotend/target", {"celsius": 200}, "M104 T0 S200 F"),
        ("heaters/bed/target", {"celsius": 60.5}, "M140 P0 S60.5 F"),
        ("fans/part/speed", {"speed": 0.5}, "M106 P0 S127.5 F"),
    ],
)
def test_settings_become_commands(web, bridge, path, body, script):
    answer = web.put(f"/api/v1/{path}", json=body)
    assert (answer.status_code, answer.content) == (204, b"")
    assert bridge.asked == [script]


@pytest.mark.parametrize(
    ("path", "body", "script"),
    [
        ("outputs/light/value", {"value": 0.25}, "SET_PIN PIN=light VALUE=0.25"),
        ("outputs/none/value", {"value": 1}, None),
        ("fans/electronics/target", {"celsius": 40}, "electronics TARGET=40"),
        ("fans/part/target", {"celsius": 40}, None),
        ("inputs/filament-sensors/roll", {"enabled": False}, "SENSOR=roll ENABLE=0"),
        ("inputs/filament-sensors/none", {"enabled": False}, None),
        (
            "lights/head/color",
            {"red": 0.5, "led": 3},
            "LED=head RED=0.5 GREEN=0 BLUE=0 WHITE=0 INDEX=3",
        ),
        ("lights/light/color", {"red": 0.5}, None),
        ("servos/cover/angle", {"degrees": 45}, "SET_SERVO SERVO=cover ANGLE=45"),
        ("servos/cover/angle", {"degrees": None}, "SET_SERVO SERVO=cover WIDTH=0"),
        ("servos/lid/angle", {"degrees": 45}, None),
    ],
)
def test_parts_of_the_machine_file_are_set_by_name(path, body, script):
    bridge = FakeBridge(machine="i3-all-parts")
    with local_client(bridge) as web:
        answer = web.put(f"/api/v1/{path}", json=body)
    assert answer.status_code == (404 if script is None else 204)
    assert [script in line for line in bridge.asked] == ([] if script is None else [True])


def test_machine_names_its_inputs_and_outputs():
    with local_client(FakeBridge(machine="i3-all-parts")) as web:
        found = web.get("/api/v1/machine").json()
    assert found["outputs"] == {"light": {"pwm": True}, "pump": {"pwm": False}}
    encoder = {"kind": "motion", "part": "encoder", "pin": "^D34", "length_mm": 7.0}
    assert found["inputs"]["filament-encoder"] == encoder
    assert found["inputs"]["button-door"]["part"] == "door"


def test_machine_names_its_lights_servos_and_axes_with_stalls():
    with local_client(FakeBridge(machine="i3-all-parts")) as web:
        found = web.get("/api/v1/machine").json()
    assert found["lights"] == {
        "head": {"count": 8, "colors": "RGB"},
        "frame": {"count": 1, "colors": "RGBW"},
    }
    pulses = {"max_deg": 180.0, "min_pulse_us": 1000.0, "max_pulse_us": 2000.0}
    assert found["servos"] == {"cover": pulses}
    assert found["stall_axes"] == ["y"]


@pytest.mark.parametrize(
    ("path", "body", "command"),
    [
        ("motion/turn-motor", {"motor": "x"}, "STEPPER_BUZZ STEPPER=stepper_x"),
        ("motion/turn-motor", {"motor": "e"}, "STEPPER_BUZZ STEPPER=extruder"),
        ("motion/turn-motor", {"motor": "a"}, None),
        ("calibration/stall", {"axis": "y", "repeats": 3}, "STALL_CALIBRATE AXIS=Y REPEATS=3"),
        ("calibration/stall", {"axis": "x"}, None),  # it has a switch
    ],
)
def test_motors_are_turned_and_stalls_found_by_name(path, body, command):
    bridge = FakeBridge(machine="i3-all-parts")
    with local_client(bridge) as web:
        answer = web.post(f"/api/v1/{path}", json=body)
    assert answer.status_code == (404 if command is None else 200 if "stall" in path else 204)
    assert bridge.asked == ([] if command is None else [command])


@pytest.mark.parametrize(
    ("body", "values"),
    [
        (b'{"celsius": -1}', {"pointer": "/celsius", "value": "Expected float >= 0.0"}),
        (b'{"celsius": 1, "x": 1}', {"pointer": "", "value": "Object contains unknown field x"}),
        (b"{}", {"pointer": "", "value": "Object missing required field celsius"}),
    ],
)
def test_place_of_a_wrong_value_is_a_json_pointer(web, bridge, body, values):
    headers = {"Content-Type": "application/json"}
    answer = web.put("/api/v1/heaters/hotend/target", content=body, headers=headers)
    error = answer.json()["error"]
    assert (answer.status_code, error["code"]) == (400, "web.invalid")
    assert error["values"] == {"where": "body", **values}
    assert bridge.asked == []


@pytest.mark.parametrize(
    ("method", "path", "content", "kind", "status", "code"),
    [
        ("PUT", "heaters/hotend/target", b"{", "application/json", 400, "web.malformed"),
        ("PUT", "heaters/hotend/target", b"[" * 10000, "application/json", 400, "web.invalid"),
        ("PUT", "heaters/hotend/target", b"{}", "text/plain", 415, "web.media-type"),
        ("PUT", "heaters/hotend/target", b"1" * 2**21, "application/json", 413, "web.too-large"),
        ("PUT", "heaters/none/target", b'{"celsius":1}', "application/json", 404, "web.not-found"),
        ("DELETE", "heaters", b"", "", 405, "web.method"),
        ("GET", "nothing", b"", "", 404, "web.not-found"),
        ("GET", "status?a=1", b"", "", 400, "web.invalid"),
    ],
)
def test_refusals_are_errors_of_the_catalogue(web, method, path, content, kind, status, code):
    answer = web.request(method, f"/api/v1/{path}", content=content, headers={"Content-Type": kind})
    error = answer.json()["error"]
    assert (answer.status_code, error["code"]) == (status, code)
    assert set(error) == {"code", "part", "message", "action", "values"}


def test_refusals_of_the_printer_keep_their_code_and_status(web, bridge):
    bridge.answers["M104 T0 S200 F"] = CommandError.of("command.halted", value="it was stopped")
    answer = web.put("/api/v1/heaters/hotend/target", json={"celsius": 200})
    assert answer.status_code == 503
    assert answer.json()["error"]["code"] == "command.halted"


def test_fault_of_the_program_answers_500_and_is_logged(web, bridge, caplog):
    bridge.latest = None  # it is called
    answer = web.get("/api/v1/status")
    assert (answer.status_code, answer.json()["error"]["code"]) == (500, "web.program")
    assert "GET /api/v1/status failed" in caplog.text


def test_client_calls_operations_with_types(served, bridge):
    client = Client(served)
    client.heaters.set("hotend", celsius=200)
    assert bridge.asked == ["M104 T0 S200 F"]
    assert client.status.get().status.heaters["bed"].target_c == 60.0
    with pytest.raises(RequestError, match="no heater none") as refused:
        client.heaters.set("none", 200)
    assert (refused.value.status, refused.value.fault.code) == (404, "web.not-found")
    with pytest.raises(TypeError, match="needs celsius"):
        client.heaters.set("hotend")


def test_client_names_the_address_that_it_cannot_reach():
    with pytest.raises(RequestError, match=r"127\.0\.0\.1:9 cannot be reached"):
        Client("http://127.0.0.1:9").status.get()


def test_asynchronous_client_calls_the_same(served, bridge):
    async def main():
        await AsyncClient(served).fans.set("part", 1)

    asyncio.run(main())
    assert bridge.asked == ["M106 P0 S255 F"]


def test_machine_has_its_parts_and_limits(web):
    machine = web.get("/api/v1/machine").json()
    assert machine["name"] == "i3"
    assert machine["heaters"]["hotend"] == {"kind": "hotend", "max_c": 285.0}
    assert machine["fans"] == ["part"]
    assert machine["tools"] == [{"extruder": "e", "heater": "hotend"}]


def test_script_is_carried_out_and_answered(web, bridge):
    bridge.answers["M115"] = ("FIRMWARE_NAME:Passo",)
    answer = web.post("/api/v1/console", json={"script": "M115"})
    assert answer.json() == {"lines": ["FIRMWARE_NAME:Passo"]}


@pytest.mark.parametrize(
    ("path", "asked"),
    [
        ("stop", "emergency stop"),
        ("restart", "restart"),
        ("job/pause", "pause"),
        ("job/resume", "resume"),
        ("job/cancel", "cancel"),
    ],
)
def test_buttons_reach_the_printer(web, bridge, path, asked):
    assert web.post(f"/api/v1/{path}").status_code == 204
    assert bridge.asked == [asked]


def test_print_is_started_by_its_path(web, bridge):
    started = web.post("/api/v1/job/start", json={"path": "a/b.gcode"})
    assert (started.status_code, started.json()) == (200, {"known": False})
    assert bridge.asked == ["print a/b.gcode"]


def test_console_offers_each_command_with_its_text(web):
    commands = web.get("/api/v1/console/commands").json()
    assert len(commands) == len(table())
    home = next(command for command in commands if command["code"] == "G28")
    assert home["text"].startswith("Homes")
