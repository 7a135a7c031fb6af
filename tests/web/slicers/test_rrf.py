"""Requests of RepRapFirmware's clients and of APrinter's page, and what they get."""

import asyncio
import zlib
from dataclasses import replace

import pytest
from tests.web.fake_bridge import STATUS, FakeBridge
from tests.web.local_site import accounts, client, local_client, site
from tests.web.slicers import recorded
from tests.web.slicers.recorded import GCODE

from passo.errors import CardError, CommandError
from passo.printer.status import JobStatus, PrinterState
from passo.web.operation import Caller
from passo.web.roles import Role
from passo.web.slicers.address_sessions import IDLE_S, AddressSessions
from passo.web.slicers.rrf import on_card


@pytest.fixture
def bridge(tmp_path):
    return FakeBridge(str(tmp_path))


@pytest.fixture
def web(bridge):
    with local_client(bridge) as client:
        yield client


def test_a_slicer_uploads_and_prints(bridge, web, tmp_path):
    connected = web.get("/rr_connect?password=reprap&time=2026-11-25T10:00:00").json()
    assert connected["err"] == 0
    method, path, sent = recorded.duet_upload()
    assert web.request(method, path, **sent).json() == {"err": 0}
    assert (tmp_path / "part.gcode").read_bytes() == GCODE
    started = web.get('/rr_gcode?gcode=M32 "0:/gcodes/part.gcode"')
    assert started.json()["buff"] > 0
    assert bridge.asked == ["create /part.gcode", "print /part.gcode"]
    assert web.get("/rr_disconnect").json() == {"err": 0}


@pytest.mark.parametrize(
    ("name", "status"),
    [("part.bgcode", 415), ("..%2Fpart.gcode", 400), ("", 400), ("toys/part.stl", 415)],
)
def test_failed_upload_is_reported_in_both_formats(web, tmp_path, name, status):
    """APrinter's page looks at the status, slicers at `err`."""
    answer = web.post(f"/rr_upload?name=0:/gcodes/{name}", content=GCODE)
    assert (answer.status_code, answer.json()["err"]) == (status, 1)
    assert list(tmp_path.iterdir()) == []


def test_upload_and_print_find_the_same_cleaned_name(bridge, web, tmp_path):
    method, path, sent = recorded.duet_upload("toys/a*b.gcode")
    assert web.request(method, path, **sent).json() == {"err": 0}
    assert (tmp_path / "toys/a_b.gcode").read_bytes() == GCODE
    assert web.get('/rr_gcode?gcode=M32 "0:/gcodes/toys/a*b.gcode"').status_code == 200
    assert bridge.asked == ["create /toys/a_b.gcode", "print /toys/a_b.gcode"]


def test_a_damaged_upload_is_refused(web, tmp_path):
    right = f"{zlib.crc32(GCODE):x}"
    answer = web.post("/rr_upload?name=new/a.gcode&crc32=1234", content=GCODE)
    assert (answer.status_code, answer.json()["err"]) == (400, 1)
    assert list(tmp_path.iterdir()) == []
    assert web.post(f"/rr_upload?name=a.gcode&crc32={right}", content=GCODE).json() == {"err": 0}


@pytest.mark.parametrize(
    ("sent", "path"),
    [
        ("0:/gcodes/a.gcode", "/a.gcode"),
        ("0:/gcodes", "/"),
        ("/gcodes/toys/a.gcode", "/toys/a.gcode"),
        ("/sdcard/a.gcode", "/a.gcode"),
        ("0:/a.gcode", "/a.gcode"),
        ("a.gcode", "/a.gcode"),
        ("gcodes.g", "/gcodes.g"),
        ("toys/gcodes/a.gcode", "/toys/gcodes/a.gcode"),
    ],
)
def test_prefixes_mean_the_card(sent, path):
    assert on_card(sent) == path


@pytest.mark.parametrize("sent", ["0:/gcodes/../../a.gcode", "1:a.gcode:b", "0:/sys/..", "0:0:/a"])
def test_no_prefix_leads_out_of_the_card(sent):
    with pytest.raises(CardError):
        on_card(sent)


def test_the_answer_to_a_line_is_sent_once(bridge, web):
    bridge.answers["M105"] = ("T:25.0 /0.0",)
    bridge.answers["G1 X900"] = CommandError.of("command.failed", value="too far")
    web.get("/rr_gcode?gcode=M105")
    web.get("/rr_gcode?gcode=G1 X900")
    told = web.get("/rr_reply").text.splitlines()
    assert told[0] == "T:25.0 /0.0"
    assert told[1].startswith("Error: ")
    assert web.get("/rr_reply").text == ""


def test_aprinters_console_answers_line_by_line(bridge, web):
    bridge.answers["M105"] = ("T:25.0 /0.0",)
    bridge.answers["G1 X900"] = CommandError.of("command.failed", value="too far")
    answer = web.post("/rr_gcode", content=b"M105\nG1 X900\n\nG28\n")
    lines = answer.text.splitlines()
    assert answer.headers["x-content-type-options"] == "nosniff"
    assert [lines[0], lines[1], lines[3], lines[4]] == ["T:25.0 /0.0", "ok", "ok", "ok"]
    assert lines[2].startswith("Error:")
    assert bridge.asked == ["M105", "G1 X900", "G28"]


def test_status_as_each_of_both_reads_it(bridge, web):
    job = JobStatus("a", 0.5, 1, 2, 8, 60.0, 60.0, path="/a", size=400, offset=200)
    bridge.show(replace(STATUS, state=PrinterState.PRINTING, job=job))
    told = web.get("/rr_status?type=3").json()
    assert (told["status"], told["fractionPrinted"], told["currentLayer"]) == ("P", 50.0, 2)
    assert told["coords"]["xyz"] == [10.0, 20.0, 0.3]
    assert told["temps"]["bed"]["active"] == 60.0
    assert web.get("/rr_status?type=2").json()["name"] == bridge.machine.name
    text = web.get("/rr_status").text
    assert '"T0":{"current":25.0,"target":-1e1024,"error":false}' in text
    told = web.get("/rr_status").json()
    assert told["axes"]["X"] == {"pos": 10.0}
    assert (told["active"], told["speedRatio"], told["fans"]) == (
        True,
        1.0,
        {"F0": {"target": 0.0}},
    )


def test_files_are_listed_moved_and_deleted(bridge, web, tmp_path):
    assert web.get("/rr_mkdir?dir=0:/gcodes/toys").json() == {"err": 0}
    (tmp_path / "a.gcode").write_bytes(GCODE)
    listed = web.get("/rr_filelist?dir=0:/gcodes").json()
    assert [(f["type"], f["name"], f["size"]) for f in listed["files"]] == [
        ("f", "a.gcode", len(GCODE)),
        ("d", "toys", 0),
    ]
    assert web.get("/rr_files?dir=/&flagDirs=1").json()["files"] == ["a.gcode", "*toys"]
    assert web.get("/rr_files").status_code == 422
    assert web.get("/rr_filelist?dir=0:/gcodes/none").json()["err"] == 2
    assert web.get("/rr_download?name=0:/gcodes/a.gcode").content == GCODE
    (tmp_path / "toys" / "b.gcode").write_bytes(b"old")
    move = "/rr_move?old=0:/gcodes/a.gcode&new=0:/gcodes/toys/b.gcode"
    assert web.get(move).json()["err"] == 1
    assert web.get(f"{move}&deleteexisting=yes").json() == {"err": 0}
    assert (tmp_path / "toys" / "b.gcode").read_bytes() == GCODE
    assert web.get("/rr_delete?name=toys").status_code == 409
    for name in ("toys/b.gcode", "toys"):
        assert web.get(f"/rr_delete?name=0:/gcodes/{name}").json() == {"err": 0}
    assert list(tmp_path.iterdir()) == []


def test_a_file_has_its_plan_and_slicer(web, tmp_path):
    (tmp_path / "a.gcode").write_bytes(GCODE)
    found = {}
    while "printTime" not in found:
        found = web.get("/rr_fileinfo?name=0:/gcodes/a.gcode").json()
    assert (found["err"], found["size"], found["printTime"]) == (0, len(GCODE), 60)
    assert found["generatedBy"] == "PrusaSlicer 2.9.3"
    assert web.get("/rr_fileinfo").json() == {"err": 1}


# -- sessions -------------------------------------------------------------------------------------


@pytest.fixture
def guarded(bridge):
    """The application with an administrator, and the key of an operator."""
    kept = accounts()

    async def fill():
        await kept.create_administrator("admin", "password of admin", "address", None)
        return (await kept.add_key("slicer", Role.OPERATOR))[1]

    key = asyncio.run(fill())
    return site(bridge, kept, loopback=False), key


def test_the_password_is_a_key(guarded, tmp_path):
    app, key = guarded
    web, other = client(app), client(app, "192.168.1.9")
    assert web.get("/rr_connect?password=reprap").json() == {"err": 1}
    assert web.get("/rr_status?type=1").status_code == 401
    assert web.get(f"/rr_connect?password={key}").json()["err"] == 0
    method, path, sent = recorded.duet_upload()
    assert web.request(method, path, **sent).json() == {"err": 0}
    assert web.get("/api/v1/files").status_code == 401  # for this interface alone
    assert other.get("/rr_status?type=1").status_code == 401
    through = {"X-Forwarded-For": "10.0.0.1"}
    assert web.get("/rr_status?type=1", headers=through).status_code == 401
    assert web.get("/rr_disconnect").json() == {"err": 0}
    assert web.get("/rr_status?type=1").status_code == 401


def test_another_web_page_has_no_session(guarded):
    app, key = guarded
    web = client(app)
    web.get(f"/rr_connect?password={key}")
    for headers in ({"Sec-Fetch-Site": "cross-site"}, {"Origin": "http://evil.example"}):
        assert web.get("/rr_gcode?gcode=M112", headers=headers).status_code == 403


def test_a_session_ends_that_is_not_used():
    now = [0.0]
    sessions = AddressSessions(lambda: now[0])
    sessions.begin("10.0.0.1", Caller("slicer", Role.OPERATOR, key="hash"))
    now[0] = IDLE_S
    assert sessions.use("10.0.0.1").key == "hash"
    now[0] = 2 * IDLE_S
    assert sessions.use("10.0.0.1").key == "hash"
    now[0] = 3 * IDLE_S + 1
    assert sessions.use("10.0.0.1") is None


def test_a_long_upload_keeps_its_session():
    now = [0.0]
    sessions = AddressSessions(lambda: now[0])
    caller = Caller("slicer", Role.OPERATOR, key="hash")
    sessions.begin("10.0.0.1", caller)
    now[0] = 10 * IDLE_S
    sessions.renew("10.0.0.1", replace(caller, key="of another"))
    sessions.renew("10.0.0.2", caller)
    assert (sessions.use("10.0.0.2"), sessions.use("10.0.0.1")) == (None, None)
    sessions.begin("10.0.0.1", caller)
    now[0] += 10 * IDLE_S
    sessions.renew("10.0.0.1", caller)
    assert sessions.use("10.0.0.1").key == "hash"
