"""Random lives of a card, compared with a dictionary."""

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from tests.support.card_images import NOON, Image

from passo.card import Card, FolderCard
from passo.card.fat import FatCard
from passo.card.names import fold
from passo.errors import CardError

ALL_NAMES = [
    "A.G",
    "a.gcode",
    "Long name one.gcode",
    "long NAME two.gcode",
    "n" * 180 + ".g",
    "größe",
]
ALL_FOLDERS = ["", "sub", "Sub directory"]
NAMES, FOLDERS = st.sampled_from(ALL_NAMES), st.sampled_from(ALL_FOLDERS)
TARGETS = st.tuples(st.integers(0, 2), st.integers(0, 5)).map(list)
Step = tuple[str, str, str, list[int]]
STEPS = st.lists(
    st.one_of(
        st.tuples(st.just("write"), FOLDERS, NAMES, st.lists(st.integers(0, 9_000), max_size=3)),
        st.tuples(st.just("abort"), FOLDERS, NAMES, st.lists(st.integers(0, 9_000), max_size=2)),
        st.tuples(st.just("remove"), FOLDERS, NAMES, st.just([])),
        st.tuples(st.just("rename"), FOLDERS, NAMES, TARGETS),
        st.tuples(st.just("rmdir"), FOLDERS, st.just(""), st.just([])),
        st.tuples(st.just("mkdir"), FOLDERS, st.just(""), st.just([])),
        st.tuples(st.just("remount"), st.just(""), st.just(""), st.just([])),
    ),
    max_size=30,
)


def live(make: Callable[[], Card], steps: list[Step]) -> None:
    """Do the steps on a card and on a dictionary, then compare all files."""
    card = make()
    files: dict[tuple[str, str], bytes] = {}
    folders = {""}
    for number, (what, folder, name, pieces) in enumerate(steps):
        path, key = f"{folder}/{name}", (folder, fold(name))
        expected = ""
        try:
            if what == "remount":
                card.close()
                card = make()
            elif what == "mkdir":
                expected = "card.exists" if folder in folders and folder else ""
                expected = "card.directory" if not folder else expected
                card.make_directory(folder)
                folders.add(folder)
            elif what == "rmdir":
                inside = [key for key in files if key[0] == folder]
                expected = "card.not-empty" if inside else ""
                expected = expected if folder in folders else "card.not-found"
                expected = expected if folder else "card.directory"
                card.remove_directory(folder)
                folders.remove(folder)
            elif what == "rename":
                to, new = ALL_FOLDERS[pieces[0]], ALL_NAMES[pieces[1]]
                target = (to, fold(new))
                expected = "card.exists" if target in files and target != key else ""
                expected = expected if to in folders and key in files else "card.not-found"
                card.rename(path, f"{to}/{new}")
                files[target] = files.pop(key)
                assert new in [entry.name for entry in card.list(to)]
            elif what == "remove":
                expected = "" if key in files else "card.not-found"
                card.remove(path)
                del files[key]
            else:
                expected = "" if folder in folders else "card.not-found"
                content = [bytes([number]) * count for count in pieces]
                writer = card.create(path)
                for piece in content:
                    writer.write(piece)
                if what == "write":
                    writer.close()
                    files[key] = b"".join(content)
                else:
                    writer.abort()
        except CardError as error:
            assert error.problems[0].code == expected
        else:
            assert expected == ""
    card.close()
    card = make()
    for folder in folders:
        found = {entry.name for entry in card.list(folder) if not entry.is_directory}
        assert {fold(name) for name in found} == {n for f, n in files if f == folder}
        shorts = [entry.short_name for entry in card.list(folder)]
        assert len(shorts) == len(set(shorts))
    for (folder, name), content in files.items():
        with card.open(f"{folder}/{name}") as reader:
            assert reader.read() == content
    card.close()


@given(STEPS)
@settings(
    max_examples=120, suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None
)
def test_random_changes_of_a_fat_card_match_the_model(
    image_bytes: tuple[Path, bytes], steps: list[Step]
):
    path, fresh = image_bytes
    path.write_bytes(fresh)
    live(lambda: FatCard(path, now=lambda: NOON), steps)
    Image(path).check()


@pytest.fixture
def image_bytes(small: Image) -> tuple[Path, bytes]:
    return small.path, small.path.read_bytes()


@given(STEPS)
@settings(
    max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None
)
def test_random_changes_of_a_folder_match_the_model(tmp_path: Path, steps: list[Step]):
    folder = tmp_path / "card"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    live(lambda: FolderCard(folder), steps)
    assert not list(folder.rglob(".passo*"))
