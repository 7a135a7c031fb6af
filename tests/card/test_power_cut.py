"""A power cut at any moment leaves the card as before or as after, with lost clusters at worst.

Every write is recorded by sectors, and every barrier. A cut keeps all writes before some barrier
and, of those after it, either the first few or any choice: a medium may keep them in any order.
"""

import random
from collections.abc import Callable, Iterator
from copy import deepcopy
from pathlib import Path

import pytest
from tests.support.card_images import HARMLESS, Image, Write

from passo.card.fat import FatCard

LONGEST, OLD_LONGEST = "new" * 80, "old" * 80
OLD, NEW = b"old " * 1500, b"new " * 2100


def cuts(before: bytes, epochs: list[list[Write]]) -> Iterator[bytearray]:
    """The images that a cut may leave: prefixes, and some choices of each epoch's writes."""
    draw = random.Random(2)
    base = bytearray(before)
    for epoch in epochs:
        choices = [epoch[:count] for count in range(len(epoch) + 1)]
        choices += [
            [write for write in epoch if draw.random() < 0.5] for _ in range(len(epoch) // 2)
        ]
        for kept in choices:
            image = bytearray(base)
            for offset, data in kept:
                image[offset : offset + len(data)] = data
            yield image
        for offset, data in epoch:
            base[offset : offset + len(data)] = data


def create(card: FatCard) -> None:
    with card.create("A new file with a long name.gcode") as writer:
        writer.write(NEW)


def replace(card: FatCard) -> None:
    with card.create("OLD.G") as writer:
        writer.write(NEW)


def lengthen(card: FatCard) -> None:
    with card.create("full/A new file with a long name.gcode") as writer:
        writer.write(NEW)


def remove(card: FatCard) -> None:
    card.remove("a long name that goes.gcode")


def make_directory(card: FatCard) -> None:
    card.make_directory("new directory")


def abort(card: FatCard) -> None:
    writer = card.create("never there.gcode")
    writer.write(bytes(300_000))
    writer.abort()


def rename_in_place(card: FatCard) -> None:
    card.rename("a long name that goes.gcode", "its other name.gcode")


def rename_by_copy(card: FatCard) -> None:
    card.rename("OLD.G", "full/another name in another place.gcode")


def rename_directory(card: FatCard) -> None:
    card.rename("room", "its other name.dir")


def remove_directory(card: FatCard) -> None:
    card.remove_directory("room")


def create_longest(card: FatCard) -> None:
    with card.create(LONGEST) as writer:
        writer.write(NEW)


def remove_longest(card: FatCard) -> None:
    card.remove(OLD_LONGEST)


CASES: dict[Callable[[FatCard], None], tuple[str, bytes | None, bytes | None]] = {
    create: ("A new file with a long name.gcode", None, NEW),
    replace: ("OLD.G", OLD, NEW),
    lengthen: ("full/A new file with a long name.gcode", None, NEW),
    remove: ("a long name that goes.gcode", OLD, None),
    create_longest: (LONGEST, None, NEW),
    remove_longest: (OLD_LONGEST, OLD, None),
}


RENAMES: dict[Callable[[FatCard], None], tuple[str, str]] = {
    rename_in_place: ("a long name that goes.gcode", "its other name.gcode"),
    rename_by_copy: ("OLD.G", "full/another name in another place.gcode"),
}

ROOMS = {
    rename_directory: [{"full", "room"}, {"full", "its other name.dir"}],
    remove_directory: [{"full", "room"}, {"full"}],
}

CHANGES = (*CASES, *RENAMES, make_directory, rename_directory, remove_directory, abort)


def content(card: FatCard, path: str) -> bytes | None:
    directory, _, name = path.rpartition("/")
    if name not in [entry.name for entry in card.list(directory)]:
        return None
    with card.open(path) as reader:
        return reader.read()


def check_harmless(image: Image, change: Callable[[FatCard], None]) -> None:
    harmless = HARMLESS
    if change in (create_longest, remove_longest):  # their names do not fit into one sector
        harmless += ("Orphaned long file name part", "Auto-deleting.")
    complaints = image.complaints()
    assert all(line.startswith(harmless) for line in complaints), complaints


@pytest.mark.parametrize("change", CHANGES)
def test_power_cut_at_any_write_leaves_old_or_new_file(
    change: Callable[[FatCard], None],
    make_image: Callable[..., Image],
    recorded: list[list[Write]],
    tmp_path: Path,
):
    image = make_image(512, "-s", "1")
    card = image.card()
    card.make_directory("full")
    for name in ("OLD.G", "a long name that goes.gcode", OLD_LONGEST):
        with card.create(name) as writer:
            writer.write(OLD)
    for number in range(14):  # with . and .. the first cluster of the directory is full
        with card.create(f"full/F{number}.G"):
            pass
    card.make_directory("room")
    card.close()
    image.check()
    before = image.path.read_bytes()
    recorded[:] = [[]]
    card = image.card()
    change(card)
    card.close()
    image.check()
    path, old, new = CASES.get(change, ("", None, None))
    epochs, seen = deepcopy(recorded), list[bytes | None]()
    renamed: list[list[bytes | None]] = []
    for number, left in enumerate(cuts(before, epochs)):
        image.path.write_bytes(left)
        check_harmless(image, change)
        card = image.card()
        assert len(card.list("full")) in (14, 15)
        if path:
            seen.append(content(card, path))
            assert seen[-1] in (old, new)
        if change in RENAMES:
            found = [content(card, name) for name in RENAMES[change]]
            assert found in ([OLD, None], [None, OLD], [OLD, OLD])
            assert change is rename_by_copy or None in found
            renamed.append(found)
        rooms = {entry.name for entry in card.list() if entry.is_directory}
        assert rooms - {"new directory"} in ROOMS.get(change, [{"full", "room"}])
        if number % 5 == 0:  # the card goes on being used without a repair
            with card.create("full/and then another one.gcode") as writer:
                writer.write(NEW)
            assert content(card, "full/and then another one.gcode") == NEW
            assert not path or content(card, path) == seen[-1]
            card.close()
            check_harmless(image, change)
        card.close()
    assert not path or (seen[0], seen[-1]) == (old, new)
    assert not renamed or (renamed[0], renamed[-1]) == ([OLD, None], [None, OLD])
