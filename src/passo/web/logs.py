"""Logs and reports for download, without secrets."""

from __future__ import annotations

import re
from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path

from passo.errors import WebError

_KEY = re.compile(r"passo_[0-9a-f]{40}")
# Commands of other firmwares with a password or network credentials, anywhere in a line.
_COMMAND = re.compile(r"\b([Mm]0*(?:551|58[6-9])(?:\.\d+)?)\b[^\n]*")
_PASSWORD = re.compile(r"(?i)(\"?(?:password|api[-_ ]?key|cookie|authorization)\"?\s*[:=]\s*)\S+")


@dataclass(frozen=True, slots=True)
class Log:
    """A file: its size in bytes, and the time of its last change, in seconds since 1970."""

    name: str
    size: int
    changed_s: float


class Logs:
    """The files whose paths begin with one of the stems, such as `FILE`, `FILE.1` and
    `FILE-halt-0001.txt`. Its methods block during access to the disk."""

    def __init__(self, stems: Collection[Path] = ()) -> None:
        self._stems = stems

    def found(self) -> list[Log]:
        """The files, newest first."""
        logs: list[Log] = []
        for path in self._paths().values():
            stat = path.stat()
            logs.append(Log(path.name, stat.st_size, stat.st_mtime))
        return sorted(logs, key=lambda log: log.changed_s, reverse=True)

    def text(self, name: str) -> str:
        """The text of one of these files, without secrets. Raises WebError."""
        path = self._paths().get(name)
        if path is None:
            raise WebError.of("web.not-found", value=f"log {name}")
        return without_secrets(path.read_text(encoding="utf-8", errors="replace"))

    def _paths(self) -> dict[str, Path]:
        return {
            path.name: path
            for stem in self._stems
            if stem.parent.is_dir()
            for path in stem.parent.iterdir()
            if path.name.startswith(stem.name) and path.is_file() and not path.is_symlink()
        }


def without_secrets(text: str) -> str:
    """A text without keys, passwords, and commands that may contain one."""
    text = _COMMAND.sub(r"\1 (not shown)", _KEY.sub("(key not shown)", text))
    return _PASSWORD.sub(r"\1(not shown)", text)
