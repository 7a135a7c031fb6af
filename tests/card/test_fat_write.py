"""What Passo writes on a FAT32 card, read by mtools and judged by fsck.fat."""

import random
from collections.abc import Callable

import pytest
from tests.support.card_images import Image, code

from passo.errors import CardError


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
def test_every_fat32_geometry_is_written_and_read(
    make_image: Callable[..., Image], options: tuple[str, ...]
):
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


def test_long_names_of_every_length(image: Image):
    card = image.card()
    stems = [("ab" * 128)[:length] for length in range(1, 252, 6)]
    for number, stem in enumerate(stems):
        with card.create(stem + ".gco") as writer:
            writer.write(bytes([number]))
    assert [entry.name for entry in card.list()] == [stem + ".gco" for stem in stems]
    for stem in stems[::2]:
        card.remove(stem + ".gco")
    with card.create("🖨 and others.gcode"):
        pass
    assert card.find("🖨 AND OTHERS.GCODE").name == "🖨 and others.gcode"
    card.remove("🖨 and others.gcode")
    card.close()
    for number, stem in enumerate(stems):
        if number % 2:
            assert image.get(f"/{stem}.gco") == bytes([number])


def test_slots_of_deleted_files_are_used_again(small: Image):
    card = small.card()
    for number in range(200):
        with card.create(f"a longer name {number}.gcode"):
            pass
        card.remove(f"a longer name {number}.gcode")
    assert card.free_bytes == 1983 * 512  # the root has not grown
    card.close()
    small.check()


def test_entries_after_the_end_mark_are_ignored(small: Image):
    card = small.card()
    where = card._volume.layout.offset(2)
    card.close()
    small.poke(where + 32, b"GARBAGE G  " * 43)
    card = small.card()
    assert card.list() == []
    for name in ("A.G", "a longer name.gcode", "B.G"):
        with card.create(name):
            pass
    assert [entry.name for entry in card.list()] == ["a longer name.gcode", "A.G", "B.G"]
    card.close()
    small.check()


def test_two_files_can_be_written_at_the_same_time(small: Image):
    card = small.card()
    first, second = card.create("one.g"), card.create("two.g")
    for number in range(8):
        first.write(bytes([number]) * 50_000)
        second.write(bytes([255 - number]) * 50_000)
    first.close()
    second.close()
    with card.open("one.g") as one, card.open("two.g") as two:
        assert one.read() == b"".join(bytes([n]) * 50_000 for n in range(8))
        assert two.read() == b"".join(bytes([255 - n]) * 50_000 for n in range(8))
    card.close()
    small.check()


def test_exception_during_write_leaves_no_file(small: Image):
    card = small.card()
    free = card.free_bytes
    with pytest.raises(ZeroDivisionError), card.create("a.g") as writer:
        writer.write(bytes(400_000))
        raise ZeroDivisionError
    assert card.list() == []
    assert card.free_bytes == free
    with pytest.raises(ValueError, match="closed"):
        writer.write(b"x")
    card.close()
    small.check()


def test_a_directory_that_cannot_be_renamed_in_one_write_keeps_its_name(image: Image):
    card = image.card()
    card.make_directory("AA")
    for number in range(16):  # the sector is full
        with card.create(f"F{number}.G"):
            pass
    with pytest.raises(CardError) as raised:
        card.rename("AA", "a long name.dir")
    assert code(raised) == "card.no-slots"
    card.rename("AA", "BB")
    card.rename("F3.G", "a file is copied instead.gcode")
    with card.create("BB/kept.g") as writer:
        writer.write(b"G28\n")
    card.close()
    assert image.get("/BB/kept.g") == b"G28\n"
    assert image.get("/a file is copied instead.gcode") == b""


def test_removing_a_directory_frees_its_cluster(image: Image):
    card = image.card()
    before = card.free_bytes
    card.make_directory("sub")
    with card.create("sub/a.g"):
        pass
    with pytest.raises(CardError) as raised:
        card.remove_directory("sub")
    assert code(raised) == "card.not-empty"
    card.remove("sub/a.g")
    card.remove_directory("sub")
    assert (card.list(), card.free_bytes) == ([], before)
    card.close()
