"""The machine file over HTTP: read, checked, compared, written."""

import asyncio
from concurrent.futures import ThreadPoolExecutor

import pytest
from tests.web.fake_bridge import FakeBridge
from tests.web.local_site import client, local_client, site

from passo import config
from passo.config.own_machines import own_or_shipped
from passo.library.printer import Printer, run
from passo.web.bridge import SettingValue

API = "/api/v1/machine"
TEXT = config.shipped_text("i3")
SPEED = SettingValue("Maximum feedrates", "M203", "X", "300", "300", None, "file")


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(TEXT)
    return path


@pytest.fixture
def bridge(path):
    return FakeBridge(machine=str(path))


@pytest.fixture
def web(bridge):
    return local_client(bridge)


def written(web, text):
    replaces = web.get(f"{API}/file").json()["sha256"]
    return web.put(f"{API}/file", json={"text": text, "replaces": replaces})


def test_keys_name_the_sources_of_their_values(web, bridge):
    bridge.values = [SPEED]
    keys = {key["key"]: key for key in web.get(f"{API}/keys").json()}
    line = TEXT.splitlines().index("speed_mm_s = 300.0") + 1
    assert keys["axes.x.speed_mm_s"] == {
        "key": "axes.x.speed_mm_s",
        "value": 300.0,
        "source": "file",
        "line": line,
        "setting": "M203 X",
        "setting_value": "300",
        "setting_source": "file",
    }
    assert keys["axes.x.jerk_mm_s"]["source"] == "default"
    assert keys["board.mcu"]["source"] == "board"
    assert keys["uuid"]["value"] == "(not shown)"


def test_schema_has_help_unit_range_and_when_a_change_acts(web):
    axis = web.get(f"{API}/schema").json()["$defs"]["Axis"]["properties"]
    speed = axis["speed_mm_s"]
    assert (speed["x-unit"], speed["x-acts"], speed["maximum"]) == ("mm/s", "live", 1e6)
    assert speed["description"] == "The maximum speed."
    assert (axis["min_mm"]["x-acts"], axis["min_mm"]["default"]) == ("restart", 0.0)


def test_validation_names_key_line_and_next_action(web):
    text = TEXT.replace("speed_mm_s = 300.0", "speed_mm_s = -1.0", 1)
    found = web.post(f"{API}/validate", json={"text": text}).json()
    assert not found["ok"]
    (problem,) = found["problems"]
    assert problem["key"] == "axes.x.speed_mm_s"
    assert problem["line"] == text.splitlines().index("speed_mm_s = -1.0") + 1
    assert problem["action"] == "Correct the value"
    assert web.post(f"{API}/validate", json={"text": TEXT}).json()["ok"]


def test_difference_names_keys_and_lines(web):
    text = TEXT.replace("speed_mm_s = 300.0", "speed_mm_s = 250.0", 1)
    found = web.post(f"{API}/diff", json={"text": text}).json()
    assert found["changes"] == [
        {"key": "axes.x.speed_mm_s", "before": 300.0, "after": 250.0, "acts": "live"}
    ]
    assert "-speed_mm_s = 300.0\n+speed_mm_s = 250.0" in found["text"]


def test_file_is_replaced_and_the_one_before_is_kept(web, bridge, path):
    text = TEXT.replace("max_mm = 250.0", "max_mm = 240.0", 1)
    answer = written(web, text).json()
    assert (answer["live"], answer["restart"]) == ([], ["axes.x.max_mm"])
    assert path.read_text() == text
    assert path.with_name("mine.toml.bak").read_text() == TEXT
    assert bridge.asked == []
    assert {one.name for one in path.parent.iterdir()} == {"mine.toml", "mine.toml.bak"}


def test_stored_setting_overrides_a_changed_value(web, bridge):
    bridge.values = [SettingValue("", "M203", "X", "100", "300", "100", "stored")]
    answer = written(web, TEXT.replace("speed_mm_s = 300.0", "speed_mm_s = 250.0", 1)).json()
    assert (answer["live"], answer["overridden"]) == ([], ["axes.x.speed_mm_s"])
    assert bridge.asked == []


def test_file_with_errors_or_changed_by_another_is_not_written(web, path):
    wrong = TEXT.replace("speed_mm_s = 300.0", "speed_mm_s = -1.0", 1)
    answer = written(web, wrong)
    assert (answer.status_code, answer.json()["error"]["code"]) == (400, "config.value")
    answer = web.put(f"{API}/file", json={"text": TEXT, "replaces": "0"})
    assert (answer.status_code, answer.json()["error"]["code"]) == (409, "machine.file-changed")
    assert path.read_text() == TEXT


def test_of_two_changes_of_the_same_text_one_is_written(web, path):
    body = {"text": TEXT + "\n", "replaces": web.get(f"{API}/file").json()["sha256"]}
    with ThreadPoolExecutor(2) as pool:
        answers = list(pool.map(lambda _: web.put(f"{API}/file", json=body), range(2)))
    assert sorted(answer.status_code for answer in answers) == [200, 409]
    assert path.with_name("mine.toml.bak").read_text() == TEXT


def test_shipped_machine_has_no_file_to_write():
    web = local_client(FakeBridge())
    assert web.get(f"{API}/file").json()["path"] is None
    assert written(web, TEXT).json()["error"]["code"] == "machine.no-file"
    refused = web.post(f"{API}/own", json={"text": TEXT})
    assert (refused.status_code, refused.json()["error"]["code"]) == (409, "machine.no-folder")


def test_a_shipped_machine_is_saved_as_the_users_own(tmp_path):
    web = client(site(FakeBridge(), state=tmp_path))
    own = tmp_path / "machines" / "i3.toml"
    assert web.get(f"{API}/file").json()["own_path"] == str(own)
    assert own_or_shipped("i3", tmp_path) == "i3"
    wrong = web.post(f"{API}/own", json={"text": TEXT.replace("[axes.x]", "[axes.q]")})
    assert (wrong.status_code, own.exists()) == (400, False)
    saved = web.post(f"{API}/own", json={"text": TEXT})
    assert (saved.status_code, saved.json()) == (200, {"path": str(own)})
    assert own.read_text() == TEXT
    assert own_or_shipped("i3", tmp_path) == str(own)
    assert own_or_shipped("ender3", tmp_path) == "ender3"
    assert own_or_shipped("some/i3.toml", tmp_path) == "some/i3.toml"
    web.post(f"{API}/own", json={"text": TEXT + "\n"})
    assert own.read_text() == TEXT + "\n"
    assert own.with_name("i3.toml.bak").read_text() == TEXT


def test_library_of_machines_is_listed_and_read(web):
    names = [machine["name"] for machine in web.get(f"{API}/library").json()]
    assert names == config.shipped_machines()
    assert web.get(f"{API}/library/i3").json()["text"] == TEXT
    assert web.get(f"{API}/library/none").status_code == 404


def test_live_printer_takes_a_lower_speed_and_restarts_for_the_rest(path):
    async def main():
        async with Printer(path, restarts=True) as printer:
            client = local_client(printer._bridge)
            text = TEXT.replace("speed_mm_s = 300.0", "speed_mm_s = 250.0", 1)
            lower = await asyncio.to_thread(written, client, text)
            text = TEXT.replace("speed_mm_s = 300.0", "speed_mm_s = 350.0", 1)
            higher = await asyncio.to_thread(written, client, text)
            speeds = [s.value for s in await printer._bridge.settings() if s.command == "M203"]
            await asyncio.to_thread(client.post, f"{API}/restart")
            return lower.json(), higher.json(), speeds[0], await printer.serve()

    lower, higher, speed, again = run(main())
    assert lower["live"] == ["axes.x.speed_mm_s"]
    assert (higher["live"], higher["restart"]) == ([], ["axes.x.speed_mm_s"])
    assert (speed, again) == ("300", True)  # as fast as the limits of its start allow


def test_restart_is_refused_for_a_file_with_errors(path):
    async def main():
        async with Printer(path, restarts=True) as printer:
            path.write_text(TEXT.replace("speed_mm_s = 300.0", "speed_mm_s = -1.0", 1))
            client = local_client(printer._bridge)
            return await asyncio.to_thread(client.post, f"{API}/restart")

    assert run(main()).json()["error"]["code"] == "config.value"
