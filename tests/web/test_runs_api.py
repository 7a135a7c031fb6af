"""Run ids and checksums over HTTP, as the Python client of a real printer sends them."""

import asyncio
import hashlib
import uuid

import pytest
from tests.web.local_site import local_client

import passo
from passo.web.client import AsyncClient, RequestError

API = "/api/v1"
PART = b"G28\nG1 X50 F3000\nG1 X10\n"


def code_of(answer):
    return answer.json()["error"]["code"]


def served(test, tmp_path):
    """Runs `test(client, printer)` with a printer that is served at a free port."""
    (tmp_path / "card").mkdir()

    async def main():
        places = {"card": str(tmp_path / "card"), "state": str(tmp_path / "state")}
        async with passo.Printer("i3", **places) as printer:
            await test(AsyncClient(printer.open_http()), printer)

    passo.run(main(), clock=50)


def test_python_client_uploads_starts_once_and_follows_a_run(tmp_path):
    async def test(client, printer):
        right = hashlib.sha256(PART).hexdigest()
        with pytest.raises(RequestError) as refused:
            await client.files.upload(PART, "part.gcode", sha256="0" * 64)
        assert refused.value.fault.code == "upload.checksum"
        assert right in refused.value.fault.message
        assert list((tmp_path / "card").iterdir()) == []
        stored = await client.files.upload(PART, "part.gcode", sha256=right.upper())
        assert stored.complete
        run = str(uuid.uuid4())
        with pytest.raises(RequestError) as unknown:
            await client.runs.get(run)
        assert (unknown.value.status, unknown.value.fault.code) == (404, "run.unknown")
        answers = [await client.job.start("/part.gcode", run=run) for _ in range(3)]
        assert [answer.known for answer in answers] == [False, True, True]
        while (found := await client.runs.get(run)).state == "printing":
            await asyncio.sleep(1)
        assert (found.file, found.state, found.reason) == ("/part.gcode", "done", "")
        summary = await client.summary.get()
        assert (summary.id, summary.name) == (printer.id, "i3")
        assert (tmp_path / "state" / "printer-id").read_text().strip() == printer.id
        assert (summary.last_print.run, summary.last_print.result) == (run, "done")
        (past,) = await client.job.past()
        assert (past.run, past.number) == (run, summary.last_print.number)
        paired = await client.pairing.pair("", "farm")
        assert (paired.id, paired.name) == (printer.id, "i3")

    served(test, tmp_path)


def test_checksum_is_that_of_all_parts_of_an_upload(tmp_path):
    async def main():
        async with passo.Printer("i3", card=str(tmp_path)) as printer:
            web = local_client(printer._bridge)

            def put(first, last, digest):
                headers = {"Content-Range": f"bytes {first}-{last}/{len(PART)}"}
                headers["Content-Type"] = "application/octet-stream"
                url = f"{API}/files/content?path=part.gcode&sha256={digest}"
                return web.put(url, content=PART[first : last + 1], headers=headers)

            right, end = hashlib.sha256(PART).hexdigest(), len(PART) - 1
            for digest, status in (("0" * 64, 400), (right, 201)):
                assert (await asyncio.to_thread(put, 0, 9, digest)).json()["complete"] is False
                assert (await asyncio.to_thread(put, 10, end, "")).status_code == status
                assert (tmp_path / "part.gcode").exists() == (status == 201)

    passo.run(main(), clock=50)


def test_printer_keeps_its_id_with_its_state_alone(tmp_path):
    async def of(state):
        async with passo.Printer("i3", state=state and str(tmp_path / state)) as printer:
            return printer.id

    ids = [passo.run(of(state), clock="virtual") for state in ("a", "a", "b", None, None)]
    assert ids[0] == ids[1]
    assert len(set(ids)) == 4
    assert all(uuid.UUID(one).version == 4 for one in ids)
    (tmp_path / "a" / "printer-id").write_text("torn")
    made = passo.run(of("a"), clock="virtual")
    assert made not in ids
    assert passo.run(of("a"), clock="virtual") == made
