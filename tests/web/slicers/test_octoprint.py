"""What slicers of the host type OctoPrint ask, and what they get."""

from dataclasses import replace

import pytest
from tests.support.web_errors import code_of
from tests.web.fake_bridge import STATUS, FakeBridge
from tests.web.local_site import local_client
from tests.web.slicers import recorded
from tests.web.slicers.recorded import GCODE

from passo.errors import CommandError
from passo.printer.status import FilesStatus, JobStatus, PrinterState


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
    sent = recorded.prusaslicer(start=False, folder="toys/cars")
    assert client.post("/api/files/local", **sent).json()["effectivePrint"] is False
    assert (tmp_path / "toys/cars/part.gcode").read_bytes() == GCODE
    assert bridge.asked == ["create /toys/cars/part.gcode"]


def test_forbidden_characters_of_a_name_are_replaced(bridge, client, tmp_path):
    sent = recorded.prusaslicer("Body_01*: PLA?.gcode", folder="a<b")
    (told,) = client.post("/api/files/local", **sent).json()["files"].values()
    assert told["path"] == "a_b/Body_01__ PLA_.gcode"
    assert (tmp_path / told["path"]).read_bytes() == GCODE
    again = client.post("/api/files/local/a<b/Body_01*: PLA%3F.gcode", json={"command": "select"})
    assert again.status_code == 204
    assert bridge.asked[-2:] == [f"print /{told['path']}", f"select /{told['path']}"]


def test_cura_asks_to_print_after_the_file(bridge, client, tmp_path):
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


CURA_STARTS = [
    ("GET", "/api/settings", None, lambda told: told["feature"]["sdSupport"] is False),
    ("GET", "/api/printerprofiles", None, lambda told: told["profiles"]["_default"]["heatedBed"]),
    ("POST", "/api/login", b'{"passive":true}', lambda told: told["active"]),
    ("GET", "/api/version", None, lambda told: told["api"] == "0.1"),
    ("GET", "/api/connection", None, lambda told: told["current"]["state"] == "Operational"),
    ("GET", "/api/printer", None, lambda told: told["state"]["flags"]["ready"]),
    ("GET", "/api/job", None, lambda told: told["state"] == "Operational"),
]


@pytest.mark.parametrize(("method", "path", "body", "right"), CURA_STARTS)
def test_cura_finds_what_it_asks_for_at_its_start(client, method, path, body, right):
    method, path, sent = recorded.cura_request(method, path, body)
    answer = client.request(method, path, **sent)
    assert answer.status_code == 200
    assert right(answer.json())


def test_cura_watches_a_print(bridge, client):
    job = JobStatus("part.gcode", 0.25, 10, 1, 8, 60.0, 180.0, path="/toys/part.gcode", size=400)
    printing = replace(
        STATUS,
        state=PrinterState.PRINTING,
        job=replace(job, offset=100),
        files=FilesStatus(mounted=True, selected="/toys/part.gcode"),
    )
    bridge.show(printing)
    told = client.get("/api/job").json()
    assert told["state"] == "Printing"
    assert told["job"]["file"]["path"] == "toys/part.gcode"
    assert told["job"]["estimatedPrintTime"] == 240.0
    assert told["progress"] == {
        "completion": 25.0,
        "filepos": 100,
        "printTime": 60,
        "printTimeLeft": 180,
        "printTimeLeftOrigin": "analysis",
    }
    told = client.get("/api/printer").json()
    assert told["temperature"] == {
        "tool0": {"actual": 25.0, "target": 0.0, "offset": 0},
        "bed": {"actual": 60.0, "target": 60.0, "offset": 0},
    }
    flags = told["state"]["flags"]
    assert (flags["printing"], flags["paused"], flags["ready"], flags["error"]) == (1, 0, 0, 0)


@pytest.mark.parametrize(
    ("body", "asked"),
    [
        ({"command": "pause", "action": "pause"}, "pause"),
        ({"command": "pause", "action": "resume"}, "resume"),
        ({"command": "pause"}, "pause"),
        ({"command": "cancel"}, "cancel"),
        ({"command": "start"}, "print /part.gcode"),
    ],
)
def test_octoprint_job_commands_control_the_print(bridge, client, body, asked):
    bridge.show(replace(STATUS, files=FilesStatus(mounted=True, selected="/part.gcode")))
    assert client.post("/api/job", json=body).status_code == 204
    assert bridge.asked == [asked]


def test_a_paused_print_is_resumed_by_the_same_button(bridge, client):
    bridge.show(replace(STATUS, state=PrinterState.PAUSED))
    assert client.post("/api/job", json={"command": "pause"}).status_code == 204
    assert bridge.asked == ["resume"]


def test_without_a_selected_file_nothing_starts(client):
    answer = client.post("/api/job", json={"command": "start"})
    assert (answer.status_code, code_of(answer)) == (409, "job.no-file")


def test_a_halted_printer_is_started_again_by_connecting(bridge, client):
    bridge.show(replace(STATUS, state=PrinterState.HALTED, halted="M112"))
    assert client.get("/api/printer").json()["state"]["text"] == "Error: M112"
    assert client.post("/api/connection", json={"command": "connect"}).status_code == 204
    assert bridge.asked == ["restart"]


def test_commands_are_carried_out(bridge, client):
    assert client.post("/api/printer/command", json={"command": "G28"}).status_code == 204
    body = {"commands": ["G91", "G1 Z10 F600", "G90"]}
    assert client.post("/api/printer/command", json=body).status_code == 204
    assert bridge.asked == ["G28", "G91\nG1 Z10 F600\nG90"]


@pytest.mark.parametrize("body", [b"[]", b"{", b'{"commands": 5}', b'{"commands": [5]}', b"{}"])
def test_unknown_octoprint_commands_are_refused(bridge, client, body):
    answer = client.post("/api/printer/command", content=body)
    assert (answer.status_code, code_of(answer)) == (400, "web.malformed")
    assert bridge.asked == []


def test_files_are_listed_selected_and_deleted(bridge, client, tmp_path):
    (tmp_path / "toys").mkdir()
    (tmp_path / "toys" / "part.gcode").write_bytes(GCODE)
    assert client.get("/api/files").json()["files"][0]["children"] == []
    (folder,) = client.get("/api/files?recursive=true").json()["files"]
    (file,) = folder["children"]
    assert (folder["type"], file["path"], file["size"]) == ("folder", "toys/part.gcode", len(GCODE))
    path = file["refs"]["resource"]
    assert client.get(path).json() == file
    assert client.get(file["refs"]["download"]).content == GCODE
    for more, asked in (({}, "select"), ({"print": True}, "print")):
        assert client.post(path, json={"command": "select", **more}).status_code == 204
        assert bridge.asked[-1] == f"{asked} /toys/part.gcode"
    assert client.delete(path).status_code == 204
    assert client.get(path).status_code == 404


def test_a_form_makes_a_folder(client, tmp_path):
    body = recorded.form(('name="foldername"', b"toys"), ('name="path"', b""), boundary="b")
    sent = {"Content-Type": "multipart/form-data; boundary=b"}
    assert client.post("/api/files/local", content=body, headers=sent).status_code == 201
    assert (tmp_path / "toys").is_dir()


@pytest.mark.parametrize("before", [b'"print"', b"true", b'"file"', b"G28", b"M400"])
def test_a_form_that_breaks_off_leaves_nothing(client, tmp_path, before):
    sent = recorded.prusaslicer(folder="toys/cars")
    sent["content"] = sent["content"].partition(before)[0]
    answer = client.post("/api/files/local", **sent)
    assert (answer.status_code, code_of(answer)) == (400, "upload.malformed")
    assert list(tmp_path.iterdir()) == []
