"""The files of a configuration, which may include each other."""

from __future__ import annotations

from pathlib import Path

from passo.errors import ConfigError

MAX_BYTES = 4 << 20  # of all files together
MAX_DEPTH = 20


class Sources:
    """Reads files, and refuses what no configuration needs: files that include each other, and
    more than `MAX_BYTES` together."""

    def __init__(self) -> None:
        self._bytes = 0

    def read(self, path: Path, within: tuple[Path, ...] = ()) -> str:
        """The text of a file that is included by those in `within`, whose paths are resolved.
        Raises ConfigError."""
        real = path.resolve()
        if real in within or len(within) == MAX_DEPTH:
            chain = " → ".join(one.name for one in (*within, real))
            raise ConfigError.of("import.include", str(path), value=chain)
        try:
            if not path.is_file():
                raise IsADirectoryError(21, "not a file")
            with path.open("rb") as file:
                raw = file.read(MAX_BYTES + 1)
        except OSError as error:
            raise ConfigError.of(
                "config.unreadable", str(path), value=error.strerror or str(error)
            ) from None
        self._bytes += len(raw)
        if self._bytes > MAX_BYTES:
            raise ConfigError.of("import.size", str(path), limit=MAX_BYTES)
        return raw.decode("utf-8-sig", errors="replace")
