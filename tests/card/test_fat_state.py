"""What a card's bookkeeping says: dirty mark, FSInfo, both tables; and what is refused."""

import asyncio
import contextlib
import errno
import os
import random
import struct
from collections.abc import Callable
from datetime import datetime
from pathlib import Path

import pytest
from tests.support.card_images import HARMLESS, Image, code

from passo.card.boot import find_volume
from passo.card.device import Device
from passo.card.fat import FatCard
from passo.errors import CardError

CLEAN = 1 << 27
FSINFO_FREE, FSINFO_NEXT = 512 + 488, 512 + 492


def tables(image: Image) -> list[bytes]:
    device = Device(image.path)
    layout = find_volume(device)
    found = [bytes(device.read(at, layout.table_bytes)) for at in layout.table_offsets]
    device.close()
    return found


def write(card: FatCard, path: str, content: bytes) -> None:
    with card.create(path) as writer:
        writer.write(content)


def test_dirty_mark_is_set_only_during_changes(small: Image):
    entry_1 = 32 * 512 + 4
    assert small.peek(entry_1, "<I") & CLEAN
    card = small.card()
    with card.create("a.g") as first:
        assert not small.peek(entry_1, "<I") & CLEAN
        second = card.create("b.g")
        first.write(b"G28")
        second.write(b"G29")
    assert not small.peek(entry_1, "<I") & CLEAN
    second.abort()
    assert small.peek(entry_1, "<I") & CLEAN
    with pytest.raises(CardError):
        card.remove("c.g")
    assert small.peek(entry_1, "<I") & CLEAN
    card.close()
    small.check()


def test_a_card_that_was_dirty_stays_dirty(small: Image):
    entry_1 = 32 * 512 + 4
    small.poke(entry_1, struct.pack("<I", 0x0FFFFFFF & ~CLEAN))
    card = small.card()
    write(card, "a.g", b"G28")
    card.close()
    assert not small.peek(entry_1, "<I") & CLEAN
    assert [line for line in small.complaints() if line.startswith("Dirty bit")]


def test_fsinfo_and_both_fats_are_updated(small: Image):
    small.poke(FSINFO_FREE, struct.pack("<II", 7, 0xFFFFFFFF))  # a wrong hint
    card = small.card()
    free = card.free_bytes
    assert free == (2048 - 32 - 2 * 16 - 1) * 512
    write(card, "a.g", bytes(100_000))
    assert card.free_bytes == free - 196 * 512
    assert small.peek(FSINFO_FREE, "<I") == card.free_bytes // 512
    assert small.peek(FSINFO_NEXT, "<I") == 3 + 196
    write(card, "a.g", bytes(1000))
    assert card.free_bytes == free - 2 * 512
    card.remove("a.g")
    assert card.free_bytes == free
    card.close()
    first, second = tables(small)
    assert first == second
    assert struct.unpack("<4I", first[:16])[2:] == (0x0FFFFFF8, 0)
    small.check()


def test_the_four_bits_above_an_entry_are_kept(small: Image):
    small.poke(32 * 512 + 4 * 2, struct.pack("<I", 0xAFFFFFF8))  # the root's
    card = small.card()
    for number in range(20):
        write(card, f"a{number}.g", b"")
    card.close()
    assert struct.unpack_from("<I", tables(small)[1], 8)[0] >> 28 == 0xA


def test_without_mirroring_only_the_active_fat_is_written(small: Image):
    small.poke(40, struct.pack("<H", 0x81))
    before = small.path.read_bytes()[32 * 512 : 48 * 512]
    card = small.card()
    write(card, "a.g", bytes(5000))
    card.close()
    assert small.path.read_bytes()[32 * 512 : 48 * 512] == before
    card = small.card()
    with card.open("a.g") as reader:
        assert reader.read() == bytes(5000)
    card.close()


def test_write_to_full_card_leaves_other_files(small: Image):
    card = small.card()
    write(card, "a.g", b"old")
    free = card.free_bytes
    writer = card.create("a.g")
    with pytest.raises(CardError) as raised:
        for _ in range(100):
            writer.write(bytes(300_000))
    assert code(raised) == "card.full"
    with pytest.raises(CardError) as raised:
        writer.close()
    assert code(raised) == "card.full"
    assert card.free_bytes == free
    with card.open("a.g") as reader:
        assert reader.read() == b"old"
    write(card, "all of it.g", bytes(free))
    assert card.free_bytes == 0
    with pytest.raises(CardError) as raised:
        card.make_directory("no room")
    assert code(raised) == "card.full"
    message = str(raised.value)
    assert "the card is full: 512 bytes are needed, 0 are free" in message
    with pytest.raises(CardError) as raised:
        for number in range(20):  # the root needs another cluster
            write(card, f"{number}.g", b"")
    assert code(raised) == "card.full"
    card.remove("all of it.g")
    assert card.free_bytes == free
    card.close()
    small.check()


def test_open_file_is_not_deleted(small: Image):
    card = small.card()
    write(card, "a.g", b"G28")
    with card.open("a.g") as reader, card.open("A.G"):
        for attempt in (lambda: card.remove("A.G"), lambda: card.create("a.G")):
            with pytest.raises(CardError) as raised:
                attempt()
            assert code(raised) == "card.busy"
        assert reader.read() == b"G28"
    with card.create("a.g"):
        for attempt in (lambda: card.open("a.g"), lambda: card.remove("a.g")):
            with pytest.raises(CardError) as raised:
                attempt()
            assert code(raised) == "card.busy"
    card.remove("a.g")
    card.close()
    small.check()


def test_unfit_images_are_refused(small: Image):
    card = small.card()
    card.make_directory("dir")
    write(card, "file.g", b"")
    write(card, "locked.g", b"")
    cases: list[tuple[Callable[[], object], str]] = [
        (lambda: card.open("nothing.g"), "card.not-found"),
        (lambda: card.find("dir/nothing.g"), "card.not-found"),
        (lambda: card.list("nothing"), "card.not-found"),
        (lambda: card.list("file.g"), "card.not-directory"),
        (lambda: card.create("file.g/x"), "card.not-directory"),
        (lambda: card.create("nothing/x"), "card.not-found"),
        (lambda: card.open("dir"), "card.directory"),
        (lambda: card.open("/"), "card.directory"),
        (lambda: card.create("dir"), "card.directory"),
        (lambda: card.remove("dir"), "card.directory"),
        (lambda: card.make_directory("FILE.G"), "card.exists"),
        (lambda: card.create("a:b"), "card.name"),
        (lambda: card.make_directory("what?"), "card.name"),
    ]
    for attempt, expected in cases:
        with pytest.raises(CardError) as raised:
            attempt()
        assert code(raised) == expected
    with pytest.raises(CardError) as raised:
        card.open("dir/none.g")
    assert str(raised.value) == (
        "/dir/none.g: is not on the card. List the files (M20), and give one of these names."
    )
    card.close()
    small.check()


def test_read_only_file_is_not_changed(image: Image, tmp_path: Path):
    (tmp_path / "a").write_bytes(b"G28")
    image.put(tmp_path / "a", "a.g")
    image.mtools("mattrib", "+r", "::a.g")
    card = image.card()
    for attempt in (lambda: card.remove("a.g"), lambda: card.create("a.g")):
        with pytest.raises(CardError) as raised:
            attempt()
        assert code(raised) == "card.read-only"
    card.close()


def test_write_protected_card_refuses_changes(small: Image, monkeypatch: pytest.MonkeyPatch):
    card = small.card()
    write(card, "a.g", b"G28")
    monkeypatch.setattr(card._device, "read_only", True)
    with pytest.raises(CardError) as raised:
        card.create("b.g")
    assert code(raised) == "card.read-only"
    with card.open("a.g") as reader:
        assert reader.read() == b"G28"
    card.close()


def test_a_file_has_less_than_4_gib(small: Image, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("passo.card.fat_files.MAX_BYTES", 1000)
    card = small.card()
    writer = card.create("a.g")
    writer.write(bytes(1000))
    with pytest.raises(CardError) as raised:
        writer.write(b"x")
    assert code(raised) == "card.too-long"
    assert card.list() == []
    card.close()
    small.check()


def test_removed_card_fails_all_open_files(small: Image):
    card = small.card()
    content = random.Random(6).randbytes(200_000)
    write(card, "a.g", content)
    reader, writer = card.open("a.g"), card.create("b.g")
    assert reader.read(1000) == content[:1000]
    with small.path.open("r+b") as file:
        file.truncate(100_000)
    attempts: list[Callable[[], object]] = [
        lambda: reader.read(150_000),
        lambda: card.open("a.g").read(),
    ]
    for attempt in attempts:
        with pytest.raises(CardError) as raised:
            attempt()
        assert code(raised) == "card.removed"
    writer.abort()
    card.close()


def test_reading_continues_when_the_card_is_back(small: Image, monkeypatch: pytest.MonkeyPatch):
    """A table that could not be read does not count as a file that ends there."""
    card = small.card()
    content = random.Random(7).randbytes(400_000)  # of more clusters than a table's sector tells
    write(card, "a.g", content)
    card.close()
    card = small.card()
    reader = card.open("a.g")
    assert reader.read(1000) == content[:1000]

    def pulled(*_: object) -> int:
        raise OSError(errno.EIO, os.strerror(errno.EIO))

    for _ in range(2):
        with monkeypatch.context() as now:
            now.setattr(os, "preadv", pulled)
            with pytest.raises(CardError) as raised:
                reader.read(300_000)
            assert code(raised) == "card.removed"
    assert reader.read() == content[1000:]
    card.close()


def test_card_can_be_used_from_several_threads(small: Image):
    card = small.card()

    async def life() -> None:
        await asyncio.gather(
            *(asyncio.to_thread(write, card, f"{n}.g", bytes([n]) * 30_000) for n in range(12))
        )

    asyncio.run(life())
    for number in range(12):
        with card.open(f"{number}.g") as reader:
            assert reader.read() == bytes([number]) * 30_000
    card.close()
    small.check()


def test_unmounting_closes_open_files(small: Image):
    card = small.card()
    write(card, "a.g", b"G28")
    reader, writer = card.open("a.g"), card.create("b.g")
    writer.write(bytes(300_000))
    card.close()
    card.close()
    attempts: list[Callable[[], object]] = [
        card.list,
        lambda: reader.read(1),
        lambda: writer.write(b"x"),
        writer.close,
        lambda: card.remove("a.g"),
    ]
    for attempt in attempts:
        with pytest.raises(CardError) as raised:
            attempt()
        assert code(raised) == "card.removed"
    reader.close()
    small.check()
    card = small.card()
    assert [entry.name for entry in card.list()] == ["a.g"]
    card.close()


@pytest.mark.parametrize("allowed", range(9))
def test_a_medium_that_fails_leaves_lost_clusters_at_worst(
    small: Image, monkeypatch: pytest.MonkeyPatch, allowed: int
):
    card = small.card()
    write(card, "a.g", b"old" * 700)
    left = iter([None] * allowed)
    sync = os.fdatasync

    def failing(file: int) -> None:
        if next(left, 0) == 0:  # this one fails, later ones work again
            monkeypatch.setattr(os, "fdatasync", sync)
            raise OSError(errno.EIO, "Input/output error")

    monkeypatch.setattr(os, "fdatasync", failing)
    with contextlib.suppress(CardError):
        write(card, "a.g", b"new" * 900)
    with contextlib.suppress(CardError):
        card.make_directory("dir")
    with contextlib.suppress(CardError):
        write(card, "b.g", b"more" * 500)
    card.close()
    assert all(line.startswith(HARMLESS) for line in small.complaints()), small.complaints()
    card = small.card()
    with card.open("a.g") as reader:
        assert reader.read() in (b"old" * 700, b"new" * 900)
    card.close()


def test_replacing_keeps_the_name_and_the_creation(small: Image):
    card = small.card()
    write(card, "Some Name.gcode", b"1")
    card._now = lambda: datetime(2030, 1, 2, 3, 4, 6)
    write(card, "SOMENA~1.GCO", b"22")
    entry = card.find("some name.gcode")
    assert (entry.name, entry.size) == ("Some Name.gcode", 2)
    assert entry.modified == datetime(2030, 1, 2, 3, 4, 6)
    assert len(card.list()) == 1
    card.close()
    small.check()
