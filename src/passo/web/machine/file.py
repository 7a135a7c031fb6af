"""The machine file on disk. The functions block during access to the disk."""

from __future__ import annotations

import hashlib
import shutil
import threading
from pathlib import Path

from passo import config
from passo.config.load import Loaded
from passo.config.machine_text import machine_text
from passo.errors import ConfigError, InputError
from passo.job.durable_files import replaced

_NAME = "machine.toml"  # name in messages for a text from a client
_replacing = threading.Lock()  # no other request changes the file between check and replacement


def path_of(source: str) -> Path | None:
    """The path of a machine source (see `Bridge.machine_source`); None if there is no file to
    change."""
    return config.machine_path(source)


def read(source: str, machine: config.MachineConfig) -> str:
    """The text of the machine file, or of a shipped machine; it is made from `machine` if there is
    no file. Raises ConfigError."""
    path = path_of(source)
    if path is not None:
        return config.machine_file_text(path)
    return config.shipped_text(source) if source else machine_text(machine)


def name_of_text(source: str) -> str:
    """The name of a text from a client, for messages. Its folder is the folder of the machine file,
    to which paths in the text are relative."""
    path = path_of(source)
    return _NAME if path is None else str(path.with_name(_NAME))


def loaded(source: str, text: str) -> Loaded:
    """The machine that a text from a client describes. Raises ConfigError."""
    return config.load_text_and_question(text, name_of_text(source))


def digest(text: str) -> str:
    """The SHA-256 of a text, in hexadecimal digits."""
    return hashlib.sha256(text.encode()).hexdigest()


def difference(before: str, after: str) -> str:
    """The difference between two texts, as `diff -u` shows it; empty if there is none."""
    from difflib import unified_diff

    lines = before.splitlines(), after.splitlines()
    return "\n".join(unified_diff(*lines, f"{_NAME} (file)", f"{_NAME} (new)", lineterm=""))


def save(path: Path, text: str) -> None:
    """Writes a machine file completely and durably; makes its folder, and keeps a copy of an
    earlier file as FILE.toml.bak. Raises InputError."""
    with _replacing:
        try:
            if path.exists():
                shutil.copy(path, path.with_name(f"{path.name}.bak"))
            path.parent.mkdir(parents=True, exist_ok=True)
            with replaced(path) as temporary:
                temporary.write_text(text, encoding="utf-8", newline="")
        except OSError as error:
            value = error.strerror or str(error)
            raise InputError.of("output.unwritable", str(path), value=value) from None


def replace(path: Path, text: str, replaces: str) -> tuple[str, Path]:
    """Replaces the machine file, completely and durably, if `replaces` is the digest of its present
    text. Returns the earlier text, and the path of its backup, FILE.toml.bak. Raises ConfigError
    and InputError; then the file is unchanged."""
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
