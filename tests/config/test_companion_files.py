"""Files that a machine file names."""

import os

import pytest

from passo.config.companion_files import MAX_BYTES, read_companion


def test_relative_path_begins_at_the_folder(tmp_path):
    (tmp_path / "a.dict").write_bytes(b"{}")
    assert read_companion(tmp_path, "a.dict") == b"{}"


def test_device_and_pipe_are_refused_at_once(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    for name in ("pipe", "/dev/zero"):
        with pytest.raises(OSError, match="not a regular file"):
            read_companion(tmp_path, name)


def test_file_that_is_too_large_is_refused(tmp_path):
    (tmp_path / "large").write_bytes(bytes(MAX_BYTES + 1))
    with pytest.raises(OSError, match="File too large"):
        read_companion(tmp_path, "large")
