"""Settings, journals and outputs replace what was there only when they are on the disk."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from passo.job.durable_files import MAX_JSON_BYTES, load_json, replaced, store_json


@pytest.fixture
def steps(monkeypatch):
    """What is made durable, and what takes another's place, in order."""
    done = []
    fsync, replace = os.fsync, Path.replace

    def noted_fsync(fd):
        done.append(("fsync", Path(f"/proc/self/fd/{fd}").readlink().name))
        fsync(fd)

    def noted_replace(path, target):
        done.append(("replace", path.name, Path(target).name))
        return replace(path, target)

    monkeypatch.setattr(os, "fsync", noted_fsync)
    monkeypatch.setattr(Path, "replace", noted_replace)
    return done


def test_the_new_text_is_durable_before_it_takes_the_place(tmp_path, steps):
    path = tmp_path / "a.json"
    path.write_text("old")
    with replaced(path) as temporary:
        temporary.write_text("new")
        assert path.read_text() == "old"
    assert path.read_text() == "new"
    assert steps == [
        ("fsync", temporary.name),
        ("replace", temporary.name, "a.json"),
        ("fsync", tmp_path.name),
    ]


def test_failed_write_leaves_old_text_only(tmp_path, steps):
    path = tmp_path / "a.json"
    path.write_text("old")
    with pytest.raises(OSError, match="full"), replaced(path) as temporary:
        temporary.write_text("ne")
        raise OSError("the disk is full")
    assert path.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["a.json"]
    assert steps == []


def test_object_is_stored_and_loaded_with_its_directory(tmp_path):
    path = tmp_path / "state" / "a.json"
    assert load_json(path) is None
    store_json(path, {"a": [1, "é"]})
    assert load_json(path) == {"a": [1, "é"]}


def test_object_that_could_not_be_loaded_is_not_stored(tmp_path):
    path = tmp_path / "a.json"
    store_json(path, {"a": 1})
    with pytest.raises(OSError, match="File too large"):
        store_json(path, {"a": "é" * (MAX_JSON_BYTES // 6)})  # six bytes each, escaped
    assert load_json(path) == {"a": 1}


@pytest.mark.parametrize("text", ["", "[]", '{"a": 1', '{"a":' + "[" * 100_000, b"\xff"])
def test_file_that_holds_no_object_is_refused(tmp_path, text):
    path = tmp_path / "a.json"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(ValueError):
        load_json(path)
