"""A folder of the host as a card."""

import os
from pathlib import Path

import pytest

from passo.card import FolderCard
from passo.errors import CardError

from .images import code


@pytest.fixture
def card(tmp_path: Path) -> FolderCard:
    folder = tmp_path / "card"
    folder.mkdir()
    return FolderCard(folder)


def test_what_is_written_is_there_after_close_and_not_before(card: FolderCard, tmp_path: Path):
    writer = card.create("/Benchy.gcode")
    assert writer.write(b"G28\n") == 4
    assert card.list() == []
    writer.write(b"G1 X1\n")
    writer.close()
    writer.close()
    assert (tmp_path / "card/Benchy.gcode").read_bytes() == b"G28\nG1 X1\n"
    assert [entry.name for entry in card.list()] == ["Benchy.gcode"]
    assert card.find("BENCHY.GCODE").size == 10


def test_a_reader_seeks_and_reads(card: FolderCard):
    with card.create("a.g") as writer:
        writer.write(bytes(range(100)))
    with card.open("A.G") as reader:
        assert reader.size == 100
        assert reader.read(3) == b"\0\1\2"
        assert reader.seek(-2, os.SEEK_END) == 98
        assert reader.read() == b"\x62\x63"
        assert reader.read(5) == b""
        assert reader.tell() == 100


def test_nothing_outside_the_folder_can_be_reached(card: FolderCard, tmp_path: Path):
    (tmp_path / "secret.g").write_text("M112")
    (tmp_path / "card/link.g").symlink_to(tmp_path / "secret.g")
    (tmp_path / "card/out").symlink_to(tmp_path)
    os.mkfifo(tmp_path / "card/pipe.g")
    for path in (
        "../secret.g",
        "/../secret.g",
        "a/../../secret.g",
        "link.g",
        "out/secret.g",
        "pipe.g",
    ):
        with pytest.raises(CardError) as raised:
            card.open(path)
        assert code(raised) == "card.not-found"
    assert card.list() == []
