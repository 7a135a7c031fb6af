"""FAT32 images made by mkfs.fat, filled and read by mtools, judged by fsck.fat."""

import os
import struct
import subprocess
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

import pytest

from passo.card.fat import FatCard
from passo.errors import CardError

ENVIRONMENT = {**os.environ, "PATH": f"{os.environ['PATH']}:/usr/sbin:/sbin", "LC_ALL": "C.UTF-8"}
FRAME = (
    "fsck.fat 4",
    "Warning: Filesystem is FAT32",
    "  but has only",
    "  This may lead",
    "Leaving",
)
HARMLESS = (
    "Dirty bit is set.",
    "Automatically removing dirty bit.",
    "FATs differ but appear to be intact.",  # the cut came between the writes of the two copies
    "Using first FAT.",
    "Free cluster summary wrong",
    "Auto-correcting.",
    "Reclaimed ",  # lost clusters
)
"""What fsck.fat may say of a card whose power was cut."""

NOON = datetime(2026, 5, 17, 12, 30, 58)


def run(*command: str | Path) -> str:
    """What a program prints; fails the test if the program fails."""
    done = subprocess.run(
        [str(word) for word in command], env=ENVIRONMENT, capture_output=True, check=False
    )
    assert done.returncode == 0, f"{command}: {done.stdout.decode()} {done.stderr.decode()}"
    return done.stdout.decode()


@dataclass
class Image:
    """An image, and where in it the volume begins."""

    path: Path
    start: int = 0

    def card(self) -> FatCard:
        return FatCard(self.path, now=lambda: NOON)

    def complaints(self) -> list[str]:
        """What fsck.fat finds wrong, without its frame."""
        path = self.path
        if self.start:
            path = self.path.with_suffix(".part")
            path.write_bytes(self.path.read_bytes()[self.start :])
        done = subprocess.run(
            ["fsck.fat", "-n", path], env=ENVIRONMENT, capture_output=True, check=False
        )
        lines = (done.stdout + done.stderr).decode().splitlines()
        found = [
            line.strip() for line in lines if line and not line.startswith((*FRAME, str(path)))
        ]
        assert bool(found) == bool(done.returncode), lines
        return found

    def check(self) -> None:
        """Fails the test unless fsck.fat is content and both copies of the table are alike."""
        assert self.complaints() == []

    def mtools(self, name: str, *words: str | Path) -> str:
        """Run mcopy, mdir, mmd, ... on the image."""
        return run(name, "-i", f"{self.path}@@{self.start}", *words)

    def put(self, source: Path, target: str) -> None:
        self.mtools("mcopy", "-o", source, f"::{target}")

    def get(self, source: str) -> bytes:
        target = self.path.with_suffix(".out")
        target.unlink(missing_ok=True)
        self.mtools("mcopy", f"::{source}", target)
        return target.read_bytes()

    def poke(self, offset: int, data: bytes) -> None:
        with self.path.open("r+b") as file:
            file.seek(self.start + offset)
            file.write(data)

    def peek(self, offset: int, layout: str) -> int:
        with self.path.open("rb") as file:
            file.seek(self.start + offset)
            return struct.unpack(layout, file.read(struct.calcsize(layout)))[0]


def partitioned(image: Image, entries: list[tuple[int, int, int]]) -> None:
    """Put a partition table of (type, first sector, sectors) before the volume of an image."""
    table = bytearray(512)
    for at, (kind, start, count) in enumerate(entries):
        struct.pack_into("<4xB3xII", table, 446 + 16 * at, kind, start, count)
    table[510:] = b"\x55\xaa"
    image.path.write_bytes(table + bytes(2047 * 512) + image.path.read_bytes())
    image.start = 1 << 20


Write = tuple[int, bytes]


def code(raised: pytest.ExceptionInfo[CardError]) -> str:
    """The catalogue's code of what a card refused."""
    return raised.value.problems[0].code
