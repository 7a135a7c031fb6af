"""The text of a printer.cfg: sections of options, with included files and the block that
SAVE_CONFIG writes. The syntax is that of Klipper's documentation."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from passo.config.importing.draft import Place, bad
from passo.config.importing.klipper.commented import CommentedText
from passo.config.importing.numbers import NUMBER, Read, number_of
from passo.config.importing.sources import MAX_LINE, Sources
from passo.errors import ConfigError, Problem

_HEADER = re.compile(r"\[(.*)\]")
_OPTION = re.compile(r"([^\s:=][^:=]*?)\s*[:=]\s?(.*)")
_INLINE = re.compile(r"\s;.*")
_SAVED = "#*#"
_SAVED_HEAD = f"\n{_SAVED} <---------------------- SAVE_CONFIG ---------------------->\n"
_CONSTANT = re.compile(r"\$\{(?:([^{}.]+)\.)?([^{}.]+)\}")  # of Kalico: ${section.option}
_MOST_CONSTANTS = 10  # within each other
_MOST_WILD = 2  # parts of a path with wildcards, as in `*/*.cfg`


@dataclass
class Option:
    """A value as written, without comments, and its place. `commented` has the comments, too."""

    text: str
    place: Place
    commented: CommentedText = field(default_factory=CommentedText)


@dataclass
class Section:
    """A section: its name, its place, its options by name in lower case, and the names of the
    options that were read."""

    name: str
    place: Place
    options: dict[str, Option] = field(default_factory=dict[str, Option])
    used: set[str] = field(default_factory=set[str])

    @property
    def kind(self) -> str:
        """The first word of the name: `heater_fan`."""
        return next(iter(self.name.split(maxsplit=1)), "")

    @property
    def rest(self) -> str:
        """The name without its first word; may be empty."""
        return self.name.partition(" ")[2].strip()

    def option(self, name: str) -> Option | None:
        """An option, which is marked as read."""
        self.used.add(name)
        return self.options.get(name)

    def text(self, name: str, default: str = "") -> str:
        """The text of an option, which is marked as read; `default` without the option."""
        found = self.option(name)
        return default if found is None else found.text

    def commented(self, name: str) -> str:
        """The text of a template with its comments; the option is marked as read."""
        found = self.option(name)
        return "" if found is None else found.commented.text

    def number(self, name: str, default: float | None = None) -> float | None:
        """The number of an option; `default` without the option. Raises ConfigError."""
        found = self.option(name)
        if found is None or not found.text:
            return default
        try:
            return number_of(found.text)
        except ValueError:
            raise self.wrong(name, NUMBER) from None

    def whole(self, name: str) -> int | None:
        """The whole number of an option, from 0; None without it. Raises ConfigError for another
        number."""
        found = self.read(name)
        return None if found is None else found.whole()

    def read(self, name: str) -> Read | None:
        """The number of an option with its place; None without it. Raises ConfigError."""
        value = self.number(name)
        return None if value is None else Read(value, f"{name} in [{self.name}]", self.at(name))

    def needed(self, name: str) -> float:
        """The number of an option. Raises ConfigError without the option."""
        value = self.number(name)
        if value is None:
            raise self.missing(name)
        return value

    def missing(self, name: str, why: str = "the option that Klipper needs") -> ConfigError:
        """The error of a missing option; `why` completes the sentence "expected"."""
        key = f"{name} in [{self.name}]"
        return ConfigError.of(
            "config.missing-key", self.place.file, self.place.line, key=key, limit=why
        )

    def wrong(self, name: str, limit: str, value: str | None = None) -> ConfigError:
        """The error of an option outside its limit."""
        written = self.text(name) if value is None else value
        return bad(self.at(name), f"{name} in [{self.name}]", written, limit)

    def pair(self, name: str) -> tuple[float, float] | None:
        """Two numbers separated by a comma, or one number for both; None without the option.
        Raises ConfigError."""
        numbers = self.numbers(name, "two numbers")
        return None if numbers is None else (numbers[0], numbers[-1])

    def numbers(self, name: str, limit: str) -> list[float] | None:
        """The numbers of an option, separated by commas; None without it. Raises ConfigError with
        this limit."""
        found = self.option(name)
        if found is None:
            return None
        try:
            return [number_of(part.strip()) for part in found.text.split(",")]
        except ValueError:
            raise self.wrong(name, limit) from None

    def flag(self, name: str, default: bool) -> bool:
        """Whether an option is true."""
        return self.text(name, str(default)).lower() in ("true", "yes", "on", "1")

    def at(self, name: str) -> Place:
        """The place of an option, or of its default if the section does not have it."""
        found = self.options.get(name)
        return self.place._replace(default=True) if found is None else found.place


class Missing(NamedTuple):
    """An include of a file that does not exist."""

    file: str
    place: Place
    folder: Path

    @property
    def problem(self) -> Problem:
        """The error of this include."""
        values = {"value": self.file, "limit": str(self.folder)}
        return Problem("import.missing", self.place.file, self.place.line, values)


class Config:
    """All sections of a printer.cfg, in the order of the files. The options of repeated sections
    are merged; the last value wins. `missing` has the includes of files that do not exist. Raises
    ConfigError with file and line."""

    def __init__(self, path: Path) -> None:
        self.sections: dict[str, Section] = {}
        self.comments: list[str] = []
        self.missing: list[Missing] = []
        self._sources = Sources()
        self._read(path, ())
        for section in self.sections.values():
            for option in section.options.values():
                self._fill_in(option)

    def of(self, kind: str) -> list[Section]:
        """The sections whose names start with this word."""
        return [section for section in self.sections.values() if section.kind == kind]

    def get(self, name: str) -> Section | None:
        """The section of this name."""
        return self.sections.get(name)

    def _fill_in(self, option: Option) -> None:
        """Replaces the constants in an option by their values. Those that do not exist stay. Raises
        ConfigError for a text that becomes too long."""

        def value(match: re.Match[str]) -> str:
            section = self.sections.get(match[1] or "constants")
            found = section.option(match[2].lower()) if section else None
            return match[0] if found is None else found.text

        for _ in range(_MOST_CONSTANTS if "${" in option.text else 0):
            option.text = _CONSTANT.sub(value, option.text)
            if len(option.text) > MAX_LINE:
                limit = f"at most {MAX_LINE} characters with its constants"
                raise bad(option.place, "option", option.text, limit)
            option.commented.replace(lambda text: _CONSTANT.sub(value, text))

    def _read(self, path: Path, within: tuple[Path, ...]) -> None:
        text = self._sources.read(path, within)
        plain, _, saved = text.partition(_SAVED_HEAD)
        self._take(plain, path, within, 1)
        lines = [line.removeprefix(_SAVED).removeprefix(" ") for line in saved.splitlines()]
        body = [line if re.match(r"\[|\s|[^\s:=]+\s*[:=]", line) else "" for line in lines]
        self._take("\n".join(body), path, within, plain.count("\n") + 3)

    def _take(self, text: str, path: Path, within: tuple[Path, ...], first: int) -> None:
        section: Section | None = None
        option: Option | None = None
        for number, line in enumerate(text.splitlines(), first):
            place = Place(path.name, number)
            content, _, comment = line.partition("#")
            self.comments += [comment] if comment else []
            content = _INLINE.sub("", content).rstrip()
            cut = line[len(content) :]
            if not content or content.startswith(";"):
                if option is not None and line.strip():
                    option.commented.comment(line, indented=line[0].isspace())
                continue
            if content[0].isspace():
                if option is not None:
                    option.text = f"{option.text}\n{content.strip()}".lstrip("\n")
                    option.commented.line(content.strip(), cut)
                continue
            option = None
            if header := _HEADER.match(content):
                section = self._section(header[1], place, path, within)
            elif section is None or (found := _OPTION.fullmatch(content)) is None:
                raise ConfigError.of("import.line", str(path), number, value=content[:60])
            else:
                option = Option(found[2].strip(), place)
                option.commented.line(option.text, cut)
                section.options[found[1].strip().lower()] = option

    def _section(
        self, written: str, place: Place, path: Path, within: tuple[Path, ...]
    ) -> Section | None:
        name = " ".join(written.split())
        if name.startswith("include "):
            pattern = name.partition(" ")[2]
            files = _included(path, pattern, place)
            if files is None:
                self.missing.append(Missing(pattern, place, path.parent))
            for file in files or ():
                self._read(file, (*within, path.resolve()))
            return None
        return self.sections.setdefault(name, Section(name, place))


def _included(path: Path, pattern: str, place: Place) -> list[Path] | None:
    """The files of an include, whose path may be absolute. A pattern may match none; None if a
    plain name does not exist. As in Klipper, `~` is a plain character, and `**` is `*`. Raises
    ConfigError for a pattern that could search a whole disk."""
    parts = [part.replace("**", "*") for part in Path(pattern).parts]
    wild = [at for at, part in enumerate(parts) if any(mark in part for mark in "*?[")]
    if len(wild) > _MOST_WILD:
        limit = f"wildcards in at most {_MOST_WILD} parts of the path"
        raise bad(place, "include", pattern, limit)
    if wild:
        folder = path.parent.joinpath(*parts[: wild[0]])
        found = sorted(folder.glob("/".join(parts[wild[0] :])))
        return [file for file in found if not file.name.startswith(".")]
    file = path.parent / pattern
    return [file] if file.is_file() else None
