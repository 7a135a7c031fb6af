"""The machine file on disk. What is here blocks for as long as the disk takes."""

from __future__ import annotations

import hashlib
import os
import shutil
from difflib import unified_diff
from pathlib import Path

from passo import config
from passo.config.machine_text import machine_text
from passo.errors import ConfigError, InputError
from passo.job.durable_files import replaced


def path_of(source: str) -> Path | None:
    """The file of a machine source, as `Bridge.machine_source`; None where it is not one that may
    be changed."""
    return Path(source) if source.endswith(".toml") or os.sep in source else None


def read(source: str, machine: config.MachineConfig) -> str:
    """The text of the machine file: that of a shipped machine, or made from `machine`, where there
    is no file. Raises ConfigError."""
    path = path_of(source)
    if path is None:
        return config.shipped_text(source) if source else machine_text(machine)
    try:
        return path.read_text(encoding="utf-8-sig")
    except OSError as error:
        reason = error.strerror or str(error)
    except UnicodeDecodeError:
        raise ConfigError.of("config.encoding", str(path), value="it was changed") from None
    raise ConfigError.of("config.unreadable", str(path), value=reason)


def digest(text: str) -> str:
    """The SHA-256 of a text, in hexadecimal digits."""
    return hashlib.sha256(text.encode()).hexdigest()


def difference(before: str, after: str, name: str) -> str:
    """What differs between two texts, as `diff -u` shows it; empty if nothing does."""
    lines = before.splitlines(), after.splitlines()
    return "\n".join(unified_diff(*lines, f"{name} (file)", f"{name} (new)", lineterm=""))


def replace(path: Path, text: str) -> Path:
    """Puts a text in the place of the machine file, whole and durable; returns the path of the
    backup, FILE.toml.bak, that holds the text before. Raises InputError; then the file holds what
    it held before."""
    backup = path.with_name(f"{path.name}.bak")
    try:
        with replaced(backup) as temporary:
            shutil.copy(path, temporary)
        with replaced(path) as temporary:
            temporary.write_text(text, encoding="utf-8", newline="")
            shutil.copymode(path, temporary)
    except OSError as error:
        value = error.strerror or str(error)
        raise InputError.of("output.unwritable", str(path), value=value) from None
    return backup
