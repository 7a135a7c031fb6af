"""A folder of the host as a card."""

import errno
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from tests.support.card_images import code

from passo.card import FolderCard
from passo.errors import CardError


@pytest.fixture
def card(tmp_path: Path) -> FolderCard:
    folder = tmp_path / "card"
    folder.mkdir()
    return FolderCard(folder)


def test_written_file_appears_at_close(card: FolderCard, tmp_path: Path):
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


def test_a_power_cut_leaves_the_old_file(card: FolderCard, tmp_path: Path):
    """Everything is on the disk before the new file takes the old one's place, and after."""
    with card.create("a.g") as writer:
        writer.write(b"old")
    steps: list[str] = []
    with pytest.MonkeyPatch.context() as patch:
        for name in ("write", "fsync", "replace"):
            real = getattr(os, name)

            def step(*args: Any, real: Any = real, name: str = name, **more: Any) -> Any:
                seen = (tmp_path / "card/a.g").read_bytes().decode()
                steps.append(f"{name} {seen}")
                return real(*args, **more)

            patch.setattr(os, name, step)
        with card.create("A.G") as writer:
            writer.write(b"new")
    assert steps == ["write old", "fsync old", "replace old", "fsync new"]
    assert [path.name for path in (tmp_path / "card").iterdir()] == ["a.g"]


def test_leftover_of_power_cut_is_overwritten(card: FolderCard, tmp_path: Path):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "unlink", lambda *_, **__: None)
        writer = card.create("a.g")
        writer.write(b"half of it and more")
        writer.abort()
    assert len(list((tmp_path / "card").iterdir())) == 1
    assert card.list() == []
    with card.create("a.g") as writer:
        writer.write(b"all")
    assert [path.name for path in (tmp_path / "card").iterdir()] == ["a.g"]
    assert (tmp_path / "card/a.g").read_bytes() == b"all"


def test_short_names_find_their_files(card: FolderCard, tmp_path: Path):
    (tmp_path / "card/sub dir").mkdir()
    (tmp_path / "card/sub dir/Benchy of the day.gcode").write_bytes(b"G28")
    (directory,) = card.list()
    (entry,) = card.list("SUB DIR")
    assert (directory.is_directory, directory.size) == (True, 0)
    assert entry.short_name == "BED3F5~1.GCO"
    with card.open(f"{directory.short_name}/{entry.short_name.lower()}") as reader:
        assert reader.read() == b"G28"


def test_the_exact_name_goes_first(card: FolderCard, tmp_path: Path):
    (tmp_path / "card/a.g").write_bytes(b"lower")
    (tmp_path / "card/A.G").write_bytes(b"upper")
    for name, content in (("a.g", b"lower"), ("A.G", b"upper")):
        with card.open(name) as reader:
            assert reader.read() == content


@pytest.mark.parametrize(
    ("error", "expected"),
    [
        (errno.ENOSPC, "card.full"),
        (errno.EDQUOT, "card.full"),
        (errno.EROFS, "card.read-only"),
        (errno.EACCES, "card.read-only"),
        (errno.EIO, "card.removed"),
    ],
)
def test_card_reports_errors_of_the_host_disk(
    card: FolderCard, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, error: int, expected: str
):
    with card.create("a.g") as writer:
        writer.write(b"old")

    def failing(*_: object) -> None:
        raise OSError(error, os.strerror(error))

    for name in ("write", "fsync"):
        writer = card.create("a.g")
        with monkeypatch.context() as patch:
            patch.setattr(os, name, failing)
            with pytest.raises(CardError) as raised:
                writer.write(b"new")
                writer.close()
            assert code(raised) == expected
        with pytest.raises(CardError):
            writer.close()
    assert [path.name for path in (tmp_path / "card").iterdir()] == ["a.g"]
    assert (tmp_path / "card/a.g").read_bytes() == b"old"


def test_unfit_paths_are_refused(card: FolderCard, tmp_path: Path):
    card.make_directory("dir")
    with card.create("file.g") as writer:
        writer.write(b"G28")
    cases: list[tuple[Callable[[], object], str]] = [
        (lambda: card.open("nothing.g"), "card.not-found"),
        (lambda: card.list("nothing"), "card.not-found"),
        (lambda: card.list("file.g"), "card.not-directory"),
        (lambda: card.open("dir"), "card.directory"),
        (lambda: card.create("dir"), "card.directory"),
        (lambda: card.remove("dir"), "card.directory"),
        (lambda: card.make_directory("FILE.G"), "card.exists"),
        (lambda: card.create("a:b"), "card.name"),
        (lambda: card.create("日" * 100), "card.name"),
        (lambda: card.create(".passo-part-1"), "card.name"),
        (lambda: FolderCard(tmp_path / "nothing"), "card.absent"),
        (lambda: FolderCard(tmp_path / "card/file.g"), "card.absent"),
    ]
    for attempt, expected in cases:
        with pytest.raises(CardError) as raised:
            attempt()
        assert code(raised) == expected
    with card.open("file.g"):
        for attempt in (lambda: card.remove("FILE.G"), lambda: card.create("file.g")):
            with pytest.raises(CardError) as raised:
                attempt()
            assert code(raised) == "card.busy"
    card.remove("FILE.G")
    assert [entry.name for entry in card.list()] == ["dir"]
    assert card.free_bytes > 0


def test_shrinking_file_and_removed_card_are_errors(card: FolderCard, tmp_path: Path):
    with card.create("a.g") as writer:
        writer.write(bytes(100))
    reader, writer = card.open("a.g"), card.create("b.g")
    os.truncate(tmp_path / "card/a.g", 50)
    with pytest.raises(CardError, match="it has 50 bytes instead of 100") as raised:
        reader.read()
    assert code(raised) == "card.changed"
    card.close()
    card.close()
    attempts: list[Callable[[], object]] = [
        card.list,
        lambda: reader.read(10),
        lambda: writer.write(b"x"),
        writer.close,
    ]
    for attempt in attempts:
        with pytest.raises(CardError) as raised:
            attempt()
        assert code(raised) == "card.removed"
    assert [path.name for path in (tmp_path / "card").iterdir()] == ["a.g"]


def test_a_file_that_is_written_to_while_it_is_read(card: FolderCard, tmp_path: Path):
    """Not a byte of what was read may be of a later file."""
    path = tmp_path / "card/a.g"
    path.write_bytes(b"old " * 1000)
    with card.open("a.g") as reader:
        assert reader.read(8) == b"old old "
        with path.open("r+b") as file:
            file.write(b"new " * 1000)
        os.utime(path, ns=(0, 1))
        with pytest.raises(CardError, match="while in use: it was written to") as raised:
            reader.read(8)
        assert code(raised) == "card.changed"


@pytest.mark.parametrize("removed", [True, False])
def test_a_file_that_is_replaced_is_read_to_its_end_once(
    card: FolderCard, tmp_path: Path, removed: bool
):
    path, other = tmp_path / "card/a.g", tmp_path / "card/b.g"
    path.write_bytes(b"old " * 1000)
    other.write_bytes(b"new " * 1000)
    with card.open("a.g") as reader:
        reader.read(8)
        if removed:
            path.unlink()
        else:
            other.replace(path)
        assert reader.read() == b"old " * 998
        reader.seek(0)
        with pytest.raises(CardError, match="it was replaced or removed") as raised:
            reader.read(8)
        assert code(raised) == "card.changed"


def test_impossible_file_times_are_limited(card: FolderCard, tmp_path: Path):
    (tmp_path / "card/a.g").touch()
    os.utime(tmp_path / "card/a.g", (1 << 40, 1 << 40))
    assert card.find("a.g").modified.year == 2106
    os.utime(tmp_path / "card/a.g", (-5, -5))
    assert card.find("a.g").fat_timestamp == 0x00210000


def test_names_with_control_characters_are_not_on_the_card(card: FolderCard, tmp_path: Path):
    (tmp_path / "card/a\nok").touch()
    (tmp_path / "card" / os.fsdecode(b"\xff.g")).touch()
    assert card.list() == []


def test_open_file_is_not_renamed(card: FolderCard):
    card.make_directory("sub")
    with card.create("sub/a.g") as writer:
        writer.write(b"G28")
    for action in (
        lambda: card.rename("sub/a.g", "b.g"),
        lambda: card.rename("sub", "other"),
        lambda: card.remove_directory("sub"),
    ):
        with card.open("sub/a.g"), pytest.raises(CardError) as raised:
            action()
        assert code(raised) == "card.busy"
    card.rename("sub", "other")
    assert card.find("other/a.g").size == 3


def test_a_folder_is_not_moved_into_itself(card: FolderCard):
    card.make_directory("sub")
    card.make_directory("sub/inner")
    with pytest.raises(CardError) as raised:
        card.rename("sub", "Sub/inner/sub")
    assert code(raised) == "card.into-itself"


def test_rename_cannot_leave_the_card(card: FolderCard, tmp_path: Path):
    (tmp_path / "out").mkdir()
    (tmp_path / "card/link").symlink_to(tmp_path / "out")
    with card.create("a.g") as writer:
        writer.write(b"G28")
    for to, why in (
        ("link/a.g", "card.not-found"),
        ("a\\b.g", "card.name"),
        ("/", "card.directory"),
    ):
        with pytest.raises(CardError) as raised:
            card.rename("a.g", to)
        assert code(raised) == why
    card.rename("a.g", "../../b.g")
    assert (tmp_path / "card/b.g").read_bytes() == b"G28"
    card.rename("b.g", "B.G")
    assert [entry.name for entry in card.list()] == ["B.G"]


def test_a_removed_folder_takes_interrupted_uploads_with_it(card: FolderCard, tmp_path: Path):
    card.make_directory("sub")
    (tmp_path / "card/sub/.passo-part-0").write_bytes(b"half")
    (tmp_path / "card/sub/note").symlink_to(tmp_path)
    with pytest.raises(CardError) as raised:
        card.remove_directory("sub")
    assert code(raised) == "card.not-empty"
    (tmp_path / "card/sub/note").unlink()
    card.remove_directory("sub")
    assert not (tmp_path / "card/sub").exists()


def test_unmounting_leaves_no_partial_file(card: FolderCard, tmp_path: Path):
    writer = card.create("a.g")
    writer.write(b"G28\n")
    card.close()
    assert list((tmp_path / "card").iterdir()) == []
    for action in (lambda: writer.write(b"G1"), writer.close):
        with pytest.raises(CardError) as raised:
            action()
        assert code(raised) == "card.removed"
    writer.abort()
