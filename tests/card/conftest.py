"""Cards to test on."""

from collections.abc import Callable, Generator
from pathlib import Path

import pytest
from tests.support.card_images import Image, Write, run

from passo.card.device import Device


@pytest.fixture
def make_image(tmp_path: Path) -> Callable[..., Image]:
    """Makes an image of so many KiB with mkfs.fat; mtools reads those of 65525 clusters or more."""

    def make(kib: int = 34_000, *options: str) -> Image:
        path = tmp_path / f"card{len(list(tmp_path.iterdir()))}.img"
        run("mkfs.fat", "-F", "32", "--invariant", *options, "-C", path, str(kib))
        return Image(path)

    return make


@pytest.fixture
def image(make_image: Callable[..., Image]) -> Generator[Image]:
    """A card of 34 MB in clusters of one sector, found clean at the end of the test."""
    made = make_image(34_000, "-s", "1")
    yield made
    made.check()


@pytest.fixture
def small(make_image: Callable[..., Image]) -> Image:
    """A card of 1 MB: quick to copy; mtools takes it for FAT16."""
    return make_image(1024, "-s", "1")


@pytest.fixture
def recorded(monkeypatch: pytest.MonkeyPatch) -> list[list[Write]]:
    """The writes of all devices, cut into sectors; a new list begins at each barrier."""
    epochs: list[list[Write]] = [[]]
    write, flush = Device.write, Device.flush

    def recording_write(self: Device, offset: int, data: bytes) -> None:
        for at in range(0, len(data), 512):
            epochs[-1].append((offset + at, bytes(data[at : at + 512])))
        write(self, offset, data)

    def recording_flush(self: Device) -> None:
        epochs.append([])
        flush(self)

    monkeypatch.setattr(Device, "write", recording_write)
    monkeypatch.setattr(Device, "flush", recording_flush)
    return epochs
