"""What mtools and mkfs.fat put on a card, read by Passo."""

import os
import random
from collections.abc import Callable
from datetime import datetime
from pathlib import Path

import pytest
from tests.support.card_images import Image, code, partitioned, run

from passo.card import FolderCard, open_card
from passo.card.directory import checksum
from passo.card.fat import FatCard
from passo.errors import CardError

CONTENT = random.Random(3).randbytes(300_001)


def read(card: FatCard, path: str) -> bytes:
    with card.open(path) as reader:
        return reader.read()


@pytest.fixture
def source(tmp_path: Path) -> Path:
    path = tmp_path / "source.gcode"
    path.write_bytes(CONTENT)
    os.utime(path, (1_700_000_000, 1_700_000_000))
    return path


def test_files_written_by_mtools_are_read(image: Image, source: Path):
    names = ["PRINT.G", "lower.g", "Größe 日本.gcode", "n" * 249 + ".gcode"]
    for name in names:
        image.put(source, name)
    image.mtools("mmd", "::Sub Dir", "::Sub Dir/inner")
    image.put(source, "Sub Dir/inner/x.gcode")
    card = image.card()
    assert sorted(entry.name for entry in card.list()) == sorted([*names, "Sub Dir"])
    for name in (*names, "sub dir/INNER/X.gcode", "SUBDIR~1/inner/X~1.GCO", "/größe 日本.GCODE"):
        assert read(card, name) == CONTENT, name
    assert card.find("print.g").short_name == "PRINT.G"
    assert card.find("lower.g").name == "lower.g"
    assert card.find("sub dir").is_directory
    assert card.find("/").is_directory
    card.close()


def test_an_8_3_name_beyond_ascii_gets_one_of_ascii(image: Image, source: Path):
    """Which code page it is of is not on the card; the long name says what it is."""
    for name in ("Würfel.g", "wurfel 2.g"):
        image.put(source, name)
    raw = bytearray(image.path.read_bytes())
    at = next(raw.index(x) for x in (b"WURFEL~1G  ", b"W_RFEL~1G  ") if x in raw)
    card = image.card()
    before = {entry.short_name for entry in card.list()}
    card.close()
    raw[at + 1] = 0x9A  # Ü
    raw[at - 32 + 13] = checksum(raw[at : at + 11])  # of its long name, in one slot
    image.path.write_bytes(raw)
    card = image.card()
    shown = {entry.short_name for entry in card.list()}
    assert len(shown) == 2
    assert all(name.isascii() for name in shown)
    changed = shown - before
    assert len(changed) == 1
    assert read(card, changed.pop()) == CONTENT
    assert read(card, "Würfel.g") == CONTENT
    card.close()


def test_size_and_time_of_a_file_are_read(image: Image, source: Path):
    image.mtools("mcopy", "-m", source, "::a.g")
    card = image.card()
    entry = card.find("A.G")
    assert entry.size == len(CONTENT)
    assert entry.modified == datetime.fromtimestamp(1_700_000_000)
    stamp = entry.modified
    assert entry.fat_timestamp >> 25 == stamp.year - 1980
    assert entry.fat_timestamp & 0x1F == stamp.second // 2
    card.close()


def test_a_fragmented_file_is_read_from_anywhere(image: Image, tmp_path: Path):
    piece = tmp_path / "piece"
    piece.write_bytes(b"x" * 512)
    for number in range(300):
        image.put(piece, f"F{number}.G")
    for number in range(0, 300, 2):
        image.mtools("mdel", f"::F{number}.G")
    card = image.card()
    card._volume.table.next_free = 2
    content = random.Random(4).randbytes(100_000)
    with card.create("scattered.g") as writer:
        writer.write(content)
    card.close()
    assert image.get("scattered.g") == content
    card = image.card()
    draw = random.Random(5)
    with card.open("scattered.g") as reader:
        for _ in range(200):
            at, count = draw.randrange(100_001), draw.randrange(3000)
            assert reader.seek(at) == at
            assert reader.read(count) == content[at : at + count]
    card.close()


@pytest.mark.parametrize("kind", [0x0B, 0x0C])
def test_first_fat32_partition_is_used(make_image: Callable[..., Image], source: Path, kind: int):
    image = make_image(34_000, "-s", "1")
    partitioned(image, [(0x83, 1, 2047), (kind, 2048, 68_000), (0x0C, 3000, 100)])
    image.put(source, "a.g")
    card = image.card()
    assert read(card, "a.g") == CONTENT
    with card.create("b.g") as writer:
        writer.write(CONTENT[::-1])
    card.close()
    assert image.get("b.g") == CONTENT[::-1]
    image.check()


def refused(path: Path) -> dict[str, object]:
    with pytest.raises(CardError) as raised:
        open_card(path)
    assert code(raised) == "card.format"
    return dict(raised.value.problems[0].values)


def test_missing_fat32_partition_is_named(small: Image):
    partitioned(small, [(0x83, 2048, 2048), (0xEE, 2048, 2048), (0x0C, 2048, 99_999)])
    assert refused(small.path)["value"] == "83 EE 0C 00"


@pytest.mark.parametrize(
    ("offset", "data", "key"),
    [
        (510, b"\0\0", "signature"),
        (11, b"\x2c\x01", "bytes a sector"),
        (13, b"\x03", "sectors a cluster"),
        (13, b"\0", "sectors a cluster"),
        (14, b"\0\0", "reserved sectors"),
        (16, b"\x03", "number of FATs"),
        (17, b"\x10\0", "root entries"),
        (22, b"\x01\0", "sectors a FAT (16 bit)"),
        (19, b"\x01\x08", "sectors"),
        (36, b"\0\0\0\0", "sectors a FAT"),
        (36, b"\1\0\0\0", "number of clusters"),
        (36, b"\xff\xff\xff\xff", "sectors a FAT"),
        (40, b"\x82\0", "active FAT"),
        (42, b"\x01\0", "version"),
        (44, b"\x01\0\0\0", "root cluster"),
        (44, b"\xff\xff\0\0", "root cluster"),
    ],
)
def test_impossible_boot_sector_is_refused(small: Image, offset: int, data: bytes, key: str):
    small.poke(offset, data)
    assert refused(small.path)["key"] == key


def test_fat16_is_not_fat32(tmp_path: Path):
    run("mkfs.fat", "-F", "16", "-C", tmp_path / "card.img", "16384")
    assert refused(tmp_path / "card.img")["key"] == "root entries"


def test_exfat_is_named_in_the_error(small: Image):
    small.poke(0, b"\xeb\x76\x90EXFAT   " + bytes(53))
    assert refused(small.path)["value"] == "exFAT"


def test_paths_are_accepted_in_several_forms(tmp_path: Path, small: Image):
    assert isinstance(open_card(tmp_path), FolderCard)
    assert isinstance(open_card(small.path), FatCard)
    for path in ("/dev/null", tmp_path / "nothing"):
        with pytest.raises(CardError) as raised:
            open_card(path)
        assert code(raised) == "card.absent"
    (tmp_path / "empty").touch()
    assert refused(tmp_path / "empty")["key"] == "size"


def test_second_card_cannot_be_mounted(small: Image):
    card = small.card()
    with pytest.raises(CardError) as raised:
        small.card()
    assert code(raised) == "card.busy"
    card.close()
    small.card().close()
