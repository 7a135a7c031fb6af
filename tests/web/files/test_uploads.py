"""Uploads: whole or not at all, in little memory, resumed, and refused in words."""

import asyncio
import zlib
from dataclasses import dataclass

import pytest
from tests.support.web_errors import code_of
from tests.web.fake_bridge import FakeBridge
from tests.web.local_site import local_client

from passo.errors import CardError, InputError
from passo.web.files import incoming, uploads
from passo.web.files.body import MIN_BYTES, SPAN_S, Pace
from passo.web.files.uploads import MAX_UPLOADS, Uploads

CONTENT = b"G28\n" + b"G1 X1 Y1 E0.1\n" * 60_000  # some pieces


@pytest.fixture
def bridge(tmp_path):
    return FakeBridge(str(tmp_path))


@pytest.fixture
def web(bridge):
    with local_client(bridge) as client:
        yield client


def put(web, name, content=CONTENT, **headers):
    headers = {name.replace("_", "-"): value for name, value in headers.items()}
    return web.put(f"/api/v1/files/content?path={name}", content=content, headers=headers)


def test_a_file_is_stored_as_it_comes(web, tmp_path):
    answer = put(web, "a.gcode")
    assert answer.status_code == 201
    assert answer.json() == {"path": "/a.gcode", "size": len(CONTENT), "complete": True}
    assert zlib.crc32((tmp_path / "a.gcode").read_bytes()) == zlib.crc32(CONTENT)


@pytest.mark.parametrize(
    ("name", "content", "status", "code"),
    [
        ("a.bgcode", b"GCDE", 415, "upload.binary"),
        ("a.gcode", b"GCDE\1\0\0\0", 415, "upload.binary"),
        ("a.gcode", b"PK\3\4 an archive", 415, "upload.content"),
        ("a.gcode", b"\x7fELF\0", 415, "upload.content"),
        ("a.gcode", b"", 415, "input.empty"),
        ("a.stl", b"solid", 415, "upload.kind"),
        ("new/a.gcode", b"PK\3\4 an archive", 415, "upload.content"),
        ("..%2Fa.gcode", b"G28", 400, "card.name"),
    ],
)
def test_upload_that_is_not_g_code_is_refused(web, tmp_path, name, content, status, code):
    answer = put(web, name, content)
    assert (answer.status_code, code_of(answer)) == (status, code)
    assert list(tmp_path.iterdir()) == []


def test_an_upload_makes_its_folders_and_names_its_path(web, tmp_path):
    for name in ("toys/a?/b:c.gcode", "TOYS/a_/d.gcode"):
        path = put(web, name.replace("?", "%3F"), b"G28\n").json()["path"]
        assert path == f"/{name.replace('?', '_').replace(':', '_')}"
    found = {str(p.relative_to(tmp_path)) for p in tmp_path.rglob("*.gcode")}
    assert found == {"toys/a_/b_c.gcode", "toys/a_/d.gcode"}


@pytest.mark.parametrize(
    ("name", "code"), [("part.g", "card.not-directory"), ("link", "card.exists")]
)
def test_no_upload_goes_below_a_file_or_a_link(web, tmp_path, tmp_path_factory, name, code):
    outside = tmp_path_factory.mktemp("outside")
    (tmp_path / "link").symlink_to(outside, target_is_directory=True)
    (tmp_path / "part.g").write_bytes(b"G28\n")
    answer = put(web, f"{name}/toys/a.gcode", b"G28\n")
    assert (answer.status_code, code_of(answer)) == (409, code)
    assert list(outside.iterdir()) == []
    assert {path.name for path in tmp_path.iterdir()} == {"link", "part.g"}


@pytest.mark.parametrize("said", [True, False])
def test_a_full_card_keeps_what_it_holds(web, bridge, tmp_path, monkeypatch, said):
    """Whether the client tells the size before or not."""
    (tmp_path / "a.gcode").write_bytes(b"G28\n")
    monkeypatch.setattr(incoming, "_FREE_CHECK", 1)
    free = iter([10 << 20] if said else [100 << 20, 10 << 20])
    kind = type(asyncio.run(bridge.card()))
    monkeypatch.setattr(kind, "free_bytes", property(lambda _: next(free)))
    content = CONTENT if said else (CONTENT[i : i + 9999] for i in range(0, len(CONTENT), 9999))
    answer = put(web, "a.gcode", content)
    assert (answer.status_code, code_of(answer)) == (507, "card.full")
    assert (tmp_path / "a.gcode").read_bytes() == b"G28\n"
    assert [path.name for path in tmp_path.iterdir()] == ["a.gcode"]


def test_parts_of_a_file_come_one_after_the_other(web, tmp_path):
    total = len(CONTENT)
    first = put(web, "a.gcode", CONTENT[:300_000], Content_Range=f"bytes 0-299999/{total}")
    assert first.json()["complete"] is False
    assert not (tmp_path / "a.gcode").exists()
    kept = web.get("/api/v1/files/upload?path=a.gcode").json()
    assert kept == {"path": "/a.gcode", "offset": 300_000, "total": total}
    wrong = put(web, "a.gcode", b"x", Content_Range=f"bytes 5-5/{total}")
    assert (wrong.status_code, code_of(wrong)) == (409, "upload.offset")
    rest = f"bytes 300000-{total - 1}/{total}"
    assert put(web, "a.gcode", CONTENT[300_000:], Content_Range=rest).json()["complete"] is True
    assert (tmp_path / "a.gcode").read_bytes() == CONTENT
    assert web.get("/api/v1/files/upload?path=a.gcode").status_code == 404


@pytest.mark.parametrize(
    "about", ["bytes 0-1/9", "bytes 4-3/9", "bytes 0-9/9", "0-2/9", "bytes */9"]
)
def test_a_wrong_range_is_refused(web, about):
    answer = put(web, "a.gcode", b"G28", Content_Range=about)
    assert code_of(answer) == "upload.malformed"


@dataclass
class Broken(Exception):
    """The connection is lost."""


def run(test, tmp_path, **options):
    bridge, arrived = FakeBridge(str(tmp_path)), []

    async def main():
        await test(Uploads(bridge, arrived.append), tmp_path)

    asyncio.run(main())
    return arrived


def test_a_lost_connection_keeps_what_has_come(tmp_path):
    async def test(uploads, folder):
        with pytest.raises(Broken):
            async with uploads.file("/a.gcode", total=8, resumable=True) as file:
                await file.write(b"G28\n")
                raise Broken
        assert uploads.kept("/A.gcode").offset == 4
        async with uploads.file("/a.gcode", total=8, offset=4, resumable=True) as file:
            await file.write(b"G29\n")
        assert (folder / "a.gcode").read_bytes() == b"G28\nG29\n"

    assert run(test, tmp_path) == ["/a.gcode"]


def test_an_upload_that_does_not_continue_is_dropped(tmp_path, monkeypatch):
    monkeypatch.setattr(uploads, "KEPT_S", 0.01)

    async def test(uploads, folder):
        async with uploads.file("/a.gcode", total=8, resumable=True) as file:
            await file.write(b"G28\n")
        assert len(list(folder.iterdir())) == 1
        while list(folder.iterdir()):
            await asyncio.sleep(0.01)
        assert uploads.kept("/a.gcode") is None

    assert run(test, tmp_path) == []


def test_a_new_upload_replaces_one_that_was_kept(tmp_path):
    async def test(uploads, folder):
        async with uploads.file("/a.gcode", total=8, resumable=True) as file:
            await file.write(b"G28\n")
        async with uploads.file("/a.gcode", total=4, resumable=True) as file:
            await file.write(b"G29\n")
        assert [path.name for path in folder.iterdir()] == ["a.gcode"]

    run(test, tmp_path)


def test_uploads_are_few_and_one_a_file(tmp_path):
    async def test(uploads, _):
        async with uploads.file("/a.gcode") as file:
            await file.write(b"G28\n")
            with pytest.raises(CardError, match="being written"):
                async with uploads.file("/A.GCODE"):
                    pass
        for number in range(MAX_UPLOADS):
            async with uploads.file(f"/{number}.gcode", total=9, resumable=True) as file:
                await file.write(b"G28\n")
        with pytest.raises(InputError, match=f"{MAX_UPLOADS} files are being uploaded"):
            async with uploads.file("/b.gcode"):
                pass
        await uploads.forget("/0.gcode")
        async with uploads.file("/b.gcode") as file:
            await file.write(b"G28\n")

    assert run(test, tmp_path) == ["/a.gcode", "/b.gcode"]


def test_one_byte_a_second_is_too_slow():
    pace = Pace(100.0)
    for second in range(1, int(SPAN_S)):
        pace.received(100.0 + second, 1)
    with pytest.raises(InputError, match="only 30 bytes arrived within 30 s"):
        pace.received(100.0 + SPAN_S, 1)


def test_a_slow_network_is_fast_enough():
    pace = Pace(0.0)
    for second in range(1, 1000):
        pace.received(float(second), int(MIN_BYTES / SPAN_S) + 1)
