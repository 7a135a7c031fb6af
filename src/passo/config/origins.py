"""The files that a machine was loaded from, and the line of each key in them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from passo.config.toml_lines import Path, key_lines

if TYPE_CHECKING:
    from passo.config.board_files import Source


@dataclass(frozen=True)
class Origins:
    """The machine file `file` with its text, and the files of its boards; a file that overrides
    another comes before it."""

    file: str
    text: str
    boards: tuple[Source, ...] = ()

    @cached_property
    def lines(self) -> dict[Path, int]:
        """The line of each table and key of the machine file."""
        return key_lines(self.text)

    def place(self, path: Path) -> str | None:
        """The file and line of a key, `FILE:LINE`; None if no file contains the key."""
        return next(self._places(path), None)

    def _places(self, path: Path) -> Iterator[str]:
        if path in self.lines:
            yield f"{self.file}:{self.lines[path]}"
        for source in self.boards:
            lines, depth = key_lines(source.text), len(source.path)
            if path[:depth] == source.path and path[depth:] in lines:
                yield f"{source.file}:{lines[path[depth:]]}"
