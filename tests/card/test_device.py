"""A block device is a card like an image, but nobody else's meanwhile."""

import errno
import os
import random
from collections.abc import Callable
from pathlib import Path

import pytest
from tests.support.card_devices import BlockDevice
from tests.support.card_images import Image, code, partitioned

from passo.card import open_card
from passo.card.device import Device
from passo.card.fat import FatCard
from passo.errors import CardError

CONTENT = random.Random(8).randbytes(1_000_003)
HOLDS = os.O_RDWR | os.O_CLOEXEC | os.O_EXCL


def refused(path: Path) -> CardError:
    with pytest.raises(CardError) as raised:
        open_card(path)
    return raised.value


@pytest.mark.parametrize("entries", [[], [(0x0C, 2048, 68_000)]], ids=["whole", "partition"])
def test_block_device_and_mtools_read_each_other(
    make_image: Callable[..., Image],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    entries: list[tuple[int, int, int]],
):
    image = make_image(34_000, "-s", "1")
    if entries:
        partitioned(image, entries)
    (tmp_path / "source").write_bytes(CONTENT[::-1])
    image.put(tmp_path / "source", "by mtools.gcode")
    size = image.path.stat().st_size
    assert size == 34_000 * 1024 + image.start
    with monkeypatch.context() as patch:
        shown = BlockDevice(image.path, patch)
        assert image.path.is_block_device()
        assert image.path.stat().st_size == 0
        device = Device(image.path)
        assert (device.size, device.read_only) == (size, False)
        assert device.read(size - 512, 512) == bytes(512)
        with pytest.raises(CardError) as raised:
            device.read(size - 511, 512)
        assert code(raised) == "card.removed"
        device.close()
        card = open_card(image.path)
        assert isinstance(card, FatCard)
        assert shown.opened == [HOLDS, HOLDS]
        free = card.free_bytes
        with card.create("A long name.gcode") as writer:
            for at in range(0, len(CONTENT), 70_001):
                writer.write(CONTENT[at : at + 70_001])
        assert card.free_bytes == free - 1954 * 512
        card.make_directory("dir")
        with card.create("dir/b.g") as writer:
            writer.write(b"M105\n" * 999)
        with card.open("by mtools.gcode") as reader:
            assert reader.read() == CONTENT[::-1]
        draw = random.Random(9)
        with card.open("ALONGN~1.GCO") as reader:
            for _ in range(200):
                at, count = draw.randrange(len(CONTENT)), draw.randrange(5000)
                assert reader.seek(at) == at
                assert reader.read(count) == CONTENT[at : at + count]
        card.remove("by mtools.gcode")
        card.close()
    assert image.path.stat().st_size == size
    assert image.get("A long name.gcode") == CONTENT
    assert image.get("dir/b.g") == b"M105\n" * 999
    assert "BYMTOO~1" not in image.mtools("mdir", "::/")
    image.check()


def test_block_device_in_use_is_refused(small: Image, monkeypatch: pytest.MonkeyPatch):
    shown = BlockDevice(small.path, monkeypatch)
    mounted = os.open(small.path, os.O_RDONLY | os.O_EXCL)
    for _ in range(2):
        assert str(refused(small.path)).startswith(
            f"{small.path}: is in use: it is mounted, or another program has it."
        )
        assert refused(small.path).problems[0].code == "card.busy"
    os.close(mounted)
    card = small.card()
    assert refused(small.path).problems[0].code == "card.busy"
    card.close()
    small.card().close()
    assert shown.opened[1:] == [HOLDS, HOLDS]
    small.check()


def test_image_is_opened_without_exclusive_flag(small: Image, monkeypatch: pytest.MonkeyPatch):
    """O_EXCL without O_CREAT means nothing for a file."""
    flags: list[int] = []
    real = os.open
    monkeypatch.setattr(os, "open", lambda name, how: flags.append(how) or real(name, how))
    Device(small.path).close()
    assert flags == [HOLDS & ~os.O_EXCL]


def test_empty_card_reader_is_named(small: Image, monkeypatch: pytest.MonkeyPatch):
    """Some open and have no bytes, some do not."""
    shown = BlockDevice(small.path, monkeypatch)
    shown.refuses = lambda _: errno.ENOMEDIUM
    error = refused(small.path)
    assert error.problems[0].code == "card.absent"
    assert "No medium found" in str(error)
    shown.refuses = lambda _: 0
    content = small.path.read_bytes()
    small.path.write_bytes(b"")
    error = refused(small.path)
    assert error.problems[0].code == "card.format"
    assert (error.problems[0].values["key"], error.problems[0].values["value"]) == ("size", 0)
    small.path.write_bytes(content)  # and a card is put in
    card = small.card()
    assert card.list() == []
    card.close()


@pytest.mark.parametrize("error", [errno.EROFS, errno.EACCES, errno.EPERM])
def test_a_block_device_that_is_write_protected_is_read(
    small: Image, monkeypatch: pytest.MonkeyPatch, error: int
):
    card = small.card()
    with card.create("a.g") as writer:
        writer.write(CONTENT[:300_000])
    card.close()
    before = small.path.read_bytes()
    shown = BlockDevice(small.path, monkeypatch)
    shown.refuses = lambda flags: error if flags & os.O_ACCMODE == os.O_RDWR else 0
    card = small.card()
    assert shown.opened == [os.O_RDONLY | os.O_CLOEXEC | os.O_EXCL]
    attempts: list[Callable[[], object]] = [
        lambda: card.create("b.g"),
        lambda: card.remove("a.g"),
        lambda: card.make_directory("dir"),
    ]
    for attempt in attempts:
        with pytest.raises(CardError) as raised:
            attempt()
        assert code(raised) == "card.read-only"
    with card.open("a.g") as reader:
        assert reader.read() == CONTENT[:300_000]
    assert refused(small.path).problems[0].code == "card.busy"
    card.close()
    assert small.path.read_bytes() == before
    small.check()
