"""What Passo writes on a FAT32 card, read by mtools and judged by fsck.fat."""

import random
from collections.abc import Callable

import pytest

from .images import Image

LONG = "Benchy, 0.2 mm – PLA (größer) 日本 🖨 " + "x" * 200 + ".gcode"


def test_mtools_reads_what_was_written(image: Image):
    content = random.Random(1).randbytes(1_000_003)
    card = image.card()
    with card.create("/A.G") as writer:
        writer.write(b"G28\n")
    with card.create("Benchy of the day.gcode") as writer:
        for at in range(0, len(content), 70_001):
            writer.write(content[at : at + 70_001])
    card.make_directory("Grüße 日本")
    with card.create("/grüsse/../GRÜßE 日本/x.gcode") as writer:
        writer.write(b"M105\n" * 7)
    with card.create("empty.g"):
        pass
    card.close()
    assert image.get("/A.G") == b"G28\n"
    assert image.get("/BENCHY~1.GCO") == content
    assert image.get("/Benchy of the day.gcode") == content
    assert image.get("/Grüße 日本/x.gcode") == b"M105\n" * 7
    assert image.get("/empty.g") == b""
    listing = image.mtools("mdir", "::/")
    assert "2026-05-17  12:30" in listing
    assert "BENCHY~1 GCO   1000003 2026-05-17  12:30  Benchy of the day.gcode" in listing


@pytest.mark.parametrize(
    "options",
    [("-s", "1"), ("-s", "8"), ("-S", "4096", "-s", "1"), ("-f", "1"), ("-s", "128"), ("--mbr=y",)],
    ids=" ".join,
)
def test_every_geometry(make_image: Callable[..., Image], options: tuple[str, ...]):
    image = make_image(20_000, *options)
    card = image.card()
    for number in range(60):
        with card.create(f"part number {number}.gcode") as writer:
            writer.write(bytes([number]) * (number * 997))
    for number in range(0, 60, 3):
        card.remove(f"PART NUMBER {number}.GCODE")
    card.close()
    image.check()
    card = image.card()
    assert len(card.list()) == 40
    for number in range(1, 60, 3):
        with card.open(f"part number {number}.gcode") as reader:
            assert reader.read() == bytes([number]) * (number * 997)
