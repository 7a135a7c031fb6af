"""Stored settings: commands that bring them back, in a file that is whole or refused."""

from __future__ import annotations

import json
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

from passo.errors import CommandError
from passo.job.atomic import replaced

VERSION = 1
_LARGEST = 1 << 20


@dataclass(frozen=True, slots=True)
class Store:
    """The settings file of one machine. A file of another machine, of another version, or damaged
    is refused with the reason."""

    path: Path
    uuid: str

    def save(self, lines: list[str]) -> int:
        """Stores commands; returns their checksum. When this returns they survive a power cut; if
        it raises CommandError, the file holds what it held before."""
        crc = _crc(lines)
        content = {"version": VERSION, "machine": self.uuid, "crc": crc, "settings": lines}
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            with replaced(self.path) as temporary:
                temporary.write_text(json.dumps(content, indent=1))
        except OSError as error:
            raise _refused("settings.unwritable", self.path, str(error.strerror)) from None
        return crc

    def load(self) -> list[str] | None:
        """The stored commands; None if nothing is stored. Raises CommandError with the reason if
        the file must not be used."""
        try:
            with self.path.open("rb") as file:
                raw = file.read(_LARGEST + 1)
        except FileNotFoundError:
            return None
        except OSError as error:
            raise _refused("settings.unreadable", self.path, str(error.strerror)) from None
        try:
            content: Any = json.loads(raw) if len(raw) <= _LARGEST else None
        except (ValueError, RecursionError):
            content = None
        if not isinstance(content, dict):
            raise _refused("settings.unreadable", self.path, "it is torn, or no settings file")
        table = cast("dict[str, Any]", content)
        lines = table.get("settings")
        if table.get("version") != VERSION:
            reason = f"it has version {table.get('version')}, not {VERSION}"
        elif table.get("machine") != self.uuid:
            reason = "it belongs to another machine"
        elif not isinstance(lines, list) or not all(
            isinstance(x, str) for x in cast("list[object]", lines)
        ):
            reason = "it holds no commands"
        elif _crc(cast("list[str]", lines)) != table.get("crc"):
            reason = "its checksum is wrong"
        else:
            return cast("list[str]", lines)
        raise _refused("settings.unreadable", self.path, reason)


def _crc(lines: list[str]) -> int:
    return zlib.crc32("\n".join(lines).encode(errors="surrogatepass"))


def _refused(code: str, path: Path, reason: str) -> CommandError:
    return CommandError.of(code, str(path), value=reason)
