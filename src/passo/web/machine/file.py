"""The machine file on disk. Its functions block for as long as the disk takes."""

from __future__ import annotations

import hashlib
import shutil
import threading
from difflib import unified_diff
from pathlib import Path

from passo import config
from passo.config.load import Loaded
from passo.config.machine_text import machine_text
from passo.errors import ConfigError, InputError
from passo.job.durable_files import replaced

_NAME = "machine.toml"  # of a text that a client sends, in messages
_replacing = threading.Lock()  # no other request changes the file between check and replacement


def path_of(source: str) -> Path | None:
    """The file of a machine source, as `Bridge.machine_source`; None if it may not be changed."""
    return config.machine_path(source)


def read(source: str, machine: config.MachineConfig) -> str:
    """The text of the machine file: that of a shipped machine, or made from `machine` if there is
    no file. Raises ConfigError."""
    path = path_of(source)
    if path is not None:
        return config.machine_file_text(path)
    return config.shipped_text(source) if source else machine_text(machine)


def name_of_text(source: str) -> str:
    """The name of a text that a client sends, for messages. Its folder is that of the machine file:
    relative paths in the text begin there."""
    path = path_of(source)
    return _NAME if path is None else str(path.with_name(_NAME))


def loaded(source: str, text: str) -> Loaded:
    """The machine that a text of a client describes. Raises ConfigError."""
    return config.load_text_and_question(text, name_of_text(source))


def digest(text: str) -> str:
    """The SHA-256 of a text, in hexadecimal digits."""
    return hashlib.sha256(text.encode()).hexdigest()


def difference(before: str, after: str) -> str:
    """The difference between two texts, as `diff -u` shows it; empty if there is none."""
    lines = before.splitlines(), after.splitlines()
    return "\n".join(unified_diff(*lines, f"{_NAME} (file)", f"{_NAME} (new)", lineterm=""))


def replace(path: Path, text: str, replaces: str) -> tuple[str, Path]:
    """Puts a text in the place of the machine file, whole and durable, if `replaces` is the digest
    of the text there. Returns that text, and the path of its backup, FILE.toml.bak. Raises
    ConfigError and InputError; then the file holds what it held before."""
    backup = path.with_name(f"{path.name}.bak")
    with _replacing:
        before = config.machine_file_text(path)
        if digest(before) != replaces:
            raise ConfigError.of("machine.file-changed", str(path))
        try:
            with replaced(backup) as temporary:
                shutil.copy(path, temporary)
            with replaced(path) as temporary:
                temporary.write_text(text, encoding="utf-8", newline="")
                shutil.copymode(path, temporary)
        except OSError as error:
            value = error.strerror or str(error)
            raise InputError.of("output.unwritable", str(path), value=value) from None
    return before, backup
