"""The files of a configuration, which may include each other."""

from __future__ import annotations

from pathlib import Path

from passo.errors import ConfigError

MAX_BYTES = 4 << 20  # of all files together
MAX_DEPTH = 20
MAX_FILES = 1000
MAX_LINE = 20_000


class Sources:
    """Reads files, and refuses those that no configuration needs: files that include each other,
    more than `MAX_BYTES` or `MAX_FILES` in total, and lines of more than `max_line` characters."""

    def __init__(self, max_line: int = MAX_LINE) -> None:
        self._max_line = max_line
        self._bytes = self._files = 0

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
        self._files += 1
        if self._files > MAX_FILES:
            raise ConfigError.of("import.files", str(path), limit=MAX_FILES)
        self._bytes += len(raw)
        if self._bytes > MAX_BYTES:
            raise ConfigError.of("import.size", str(path), limit=MAX_BYTES)
        text = raw.decode("utf-8-sig", errors="replace")
        for number, line in enumerate(text.splitlines(), 1):
            if len(line) > self._max_line:
                raise ConfigError.of("import.long-line", str(path), number, limit=self._max_line)
        return text
