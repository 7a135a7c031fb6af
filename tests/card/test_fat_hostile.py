"""Damaged and hostile cards: CardError, and soon."""

import random
import struct
from collections.abc import Callable

import pytest
from tests.support.card_images import Image, code

from passo.card.fat import FatCard
from passo.errors import CardError

TABLE = 32 * 512
END = 0x0FFFFFFF


def write(card: FatCard, path: str, content: bytes) -> None:
    with card.create(path) as writer:
        writer.write(content)


@pytest.fixture
def laid_out(small: Image) -> Image:
    """Clusters: 2 root, 3 to 12 the file a.g, 13 the directory d, 14 and 15 the file d/b.g."""
    card = small.card()
    write(card, "a.g", bytes(range(250)) * 20)
    card.make_directory("d")
    write(card, "d/b.g", b"G1 X1\n" * 100)
    card.close()
    small.check()
    return small


def link(image: Image, cluster: int, value: int) -> None:
    for table in (TABLE, TABLE + 16 * 512):
        image.poke(table + 4 * cluster, struct.pack("<I", value))


def refused(attempt: Callable[[], object]) -> CardError:
    with pytest.raises(CardError) as raised:
        attempt()
    assert code(raised) == "card.broken"
    return raised.value


@pytest.mark.parametrize(
    ("value", "says"),
    [
        (12, "a loop at 12"),
        (3, "a loop at"),
        (7, "a loop at"),
        (0, "a cluster number is 0x0,"),
        (1, "a cluster number is 0x1,"),
        (5000, "a cluster number is 0x1388,"),
        (0x0FFFFFF7, "a cluster number is 0xffffff7,"),
    ],
)
def test_broken_cluster_chain_cannot_be_changed(laid_out: Image, value: int, says: str):
    link(laid_out, 12, value)
    card = laid_out.card()
    assert card.find("a.g").size == 5000
    assert says in str(refused(lambda: card.remove("a.g")))
    refused(lambda: write(card, "a.g", b"new"))
    with card.open("a.g") as reader:
        assert reader.read() == bytes(range(250)) * 20  # all that its size needs is there
    card.close()


def test_cluster_chain_that_is_too_short_is_an_error(laid_out: Image):
    link(laid_out, 5, END)
    card = laid_out.card()
    with card.open("a.g") as reader:
        assert reader.read(1536) == (bytes(range(250)) * 20)[:1536]
        says = str(refused(lambda: reader.read(1)))
    assert says.startswith(
        "/a.g: the file system is damaged: the cluster chain is 3 long, expected 10"
    )
    card.close()


def test_file_without_clusters_is_an_error(laid_out: Image):
    card = laid_out.card()
    slot = card._volume.layout.root
    where = card._volume.layout.offset(slot)
    card.close()
    data = laid_out.path.read_bytes()[where : where + 512]
    at = where + data.index(b"A       G  ")
    laid_out.poke(at + 26, b"\0\0")
    laid_out.poke(at + 28, b"\xff\xff\xff\xff")
    card = laid_out.card()
    assert card.find("a.g").size == 0xFFFFFFFF
    reader = card.open("a.g")
    refused(lambda: reader.read(10))
    refused(lambda: reader.read())
    card.close()


def test_endless_directory_is_an_error(laid_out: Image):
    link(laid_out, 2, 2)
    card = laid_out.card()
    refused(card.list)
    card.close()


def test_directory_that_contains_itself_is_an_error(laid_out: Image):
    card = laid_out.card()
    where = card._volume.layout.offset(2)
    card.close()
    data = laid_out.path.read_bytes()[where : where + 512]
    laid_out.poke(where + data.index(b"D          ") + 26, b"\x02\0")
    card = laid_out.card()
    assert "a directory is inside itself" in str(refused(lambda: card.list("d")))
    refused(lambda: card.open("d/d/d/a.g"))
    card.close()


def test_directory_with_over_65536_entries_is_an_error(make_image: Callable[..., Image]):
    image = make_image(8192, "-s", "1")
    card = image.card()
    start = card._volume.layout.table_offsets[0]
    card.close()
    chain = struct.pack("<5000I", *range(3, 5003))
    image.poke(start + 8, chain)
    data = image.path.read_bytes()
    layout_bytes = len(data)
    card = image.card()
    first = card._volume.layout.offset(2)
    card.close()
    image.poke(first, (b"\xe5" + bytes(31)) * ((layout_bytes - first) // 32))
    card = image.card()
    assert "a directory's length is more than 2097152 bytes" in str(refused(card.list))
    card.close()


def test_fat_names_with_control_characters_are_hidden(laid_out: Image):
    card = laid_out.card()
    write(card, "Long and harmless.gcode", b"1")
    where = card._volume.layout.offset(2)
    card.close()
    data = laid_out.path.read_bytes()[where : where + 512]
    at = where + data.index("Long".encode("utf-16-le"))
    laid_out.poke(at, "L\nok".encode("utf-16-le"))
    at = where + data.index(b"A       G  ")
    laid_out.poke(at, b"A\nok    G  ")
    card = laid_out.card()
    assert [entry.name for entry in card.list()] == ["d", "LONGAN~1.GCO"]
    card.close()


def visit(card: FatCard) -> None:
    """Use whatever the card offers, as a printer would; every CardError is a fair answer."""
    offers: list[str] = []

    def attempt(step: Callable[..., object], *arguments: object) -> None:
        try:
            step(*arguments)
        except CardError as error:
            assert error.problems[0].code.startswith("card.")

    def look(directory: str) -> None:
        for entry in card.list(directory)[:20]:
            path = f"{directory}/{entry.name}"
            if entry.is_directory and directory.count("/") < 3:
                attempt(look, path)
            offers.append(path)

    def read(path: str) -> None:
        with card.open(path) as reader:
            for at in (0, reader.size // 2, reader.size):
                reader.seek(at)
                reader.read(600)

    attempt(look, "")
    for path in offers[:40]:
        attempt(read, path)
    attempt(write, card, "new.gcode", b"G28\n" * 300)
    attempt(write, card, "a.g", b"G29\n" * 300)
    attempt(card.make_directory, "d/new")
    attempt(card.remove, "d/b.g")
    attempt(lambda: card.free_bytes)
    attempt(card.close)


def test_damaged_fat_structures_never_crash_the_reader(laid_out: Image):
    """700 cards with some bytes of boot sector, FSInfo, tables and directories changed."""
    card = laid_out.card()
    for number in range(12):
        write(card, f"some longer name {number}.gcode", b"M105\n")
    layout = card._volume.layout
    directories = [layout.offset(cluster) for cluster in (2, 13)]
    card.close()
    regions = [(0, 90), (0, 90), (446, 66), (1000, 24), (TABLE, 160), (TABLE, 160)]
    regions += [(where, 512) for where in directories] * 2
    good = laid_out.path.read_bytes()
    draw = random.Random(7)
    for _ in range(700):
        bad = bytearray(good)
        for _ in range(draw.choice((1, 2, 4, 16))):
            start, length = draw.choice(regions)
            bad[start + draw.randrange(length)] = draw.choice(
                (0, 1, 2, 0xFF, 0xE5, 0x80, draw.randrange(256))
            )
        laid_out.path.write_bytes(bad)
        try:
            card = laid_out.card()
        except CardError as error:
            assert error.problems[0].code == "card.format"
            continue
        visit(card)
