"""The line of each key of a TOML text: path of keys and indices → line, counted from 1.

`tomllib` gives values without lines. This scanner reads only the structure, of a text that
`tomllib` has accepted.
"""

from __future__ import annotations

import re
import tomllib

Path = tuple[str | int, ...]

_BLANK = re.compile(r"(?:[ \t\r\n]|#[^\n]*)*")
_INLINE_BLANK = re.compile(r"[ \t]*")
_STRING = re.compile(
    r'"""(?:[^\\]|\\.)*?"{3,5}' r"|'''.*?'{3,5}" r'|"(?:[^"\\\n]|\\.)*"' r"|'[^'\n]*'", re.DOTALL
)
_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")
_SCALAR = re.compile(r"[^,\]}\n#]+")


class _Scanner:
    """Reads a valid TOML text once, and records the line of each path. Methods raise ValueError if
    the text is not TOML."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.at = 0
        self._line, self._counted = 1, 0  # the line at this offset
        self.lines: dict[Path, int] = {}
        self.tables_in: dict[Path, int] = {}  # number of elements so far, by array of tables

    def note(self, path: Path) -> None:
        """Records this line for the path and the tables around it, unless they have an earlier
        line. Call it in the order of the text."""
        self._line += self.text.count("\n", self._counted, self.at)
        self._counted = self.at
        for length in range(1, len(path) + 1):
            self.lines.setdefault(path[:length], self._line)

    def skip(self, pattern: re.Pattern[str]) -> str:
        """Skips the text that matches the pattern here, and returns it."""
        found = pattern.match(self.text, self.at)
        if found is None:
            raise ValueError(f"no TOML at offset {self.at}")
        self.at = found.end()
        return found.group()

    def take(self, token: str) -> bool:
        """Skips the token if it is here; returns whether it was."""
        if self.text.startswith(token, self.at):
            self.at += len(token)
            return True
        return False

    def key(self) -> Path:
        """Reads a key with its dots."""
        parts: list[str] = []
        while True:
            self.skip(_INLINE_BLANK)
            quoted = self.text[self.at] in "\"'"
            raw = self.skip(_STRING if quoted else _BARE_KEY)
            parts.append(tomllib.loads(f"k = {raw}")["k"] if quoted else raw)
            self.skip(_INLINE_BLANK)
            if not self.take("."):
                return tuple(parts)

    def below(self, keys: Path) -> Path:
        """The full path of a header; the name of an array of tables means its last element."""
        path: Path = ()
        for key in keys:
            path += (key,)
            if path in self.tables_in:
                path += (self.tables_in[path] - 1,)
        return path

    def header(self) -> Path:
        """Reads a header after its first bracket; returns the path of the table."""
        array = self.take("[")
        keys = self.key()
        if not array:
            path = self.below(keys)
        else:
            name = self.below(keys[:-1]) + keys[-1:]
            self.tables_in[name] = self.tables_in.get(name, 0) + 1
            path = (*name, self.tables_in[name] - 1)
        self.note(path)
        self.take("]")
        self.take("]")
        return path

    def pair(self, table: Path) -> None:
        """Reads `key = value` of this table."""
        start = self.at
        path = table + self.key()
        self.at, after = start, self.at
        self.note(path)
        self.at = after
        self.take("=")
        self.skip(_INLINE_BLANK)
        self.value(path)

    def value(self, path: Path) -> None:
        """Reads a value, and records the paths within it."""
        if self.take("["):
            index = 0
            self.skip(_BLANK)
            while not self.take("]"):
                self.note((*path, index))
                self.value((*path, index))
                self.skip(_BLANK)
                self.take(",")
                self.skip(_BLANK)
                index += 1
        elif self.take("{"):
            self.skip(_BLANK)
            while not self.take("}"):
                self.pair(path)
                self.skip(_BLANK)
                self.take(",")
                self.skip(_BLANK)
        else:
            self.skip(_STRING if self.text[self.at] in "\"'" else _SCALAR)


def key_lines(text: str) -> dict[Path, int]:
    """The line of each table, key and array element of a valid TOML text."""
    scanner = _Scanner(text.replace("\r\n", "\n"))
    table: Path = ()
    scanner.skip(_BLANK)
    while scanner.at < len(scanner.text):
        if scanner.take("["):
            table = scanner.header()
        else:
            scanner.pair(table)
        scanner.skip(_BLANK)
    return scanner.lines


def line_of(lines: dict[Path, int], path: Path) -> int:
    """The line of `path`, or of the nearest table around it; 1 if there is none."""
    for length in range(len(path), 0, -1):
        if path[:length] in lines:
            return lines[path[:length]]
    return 1
