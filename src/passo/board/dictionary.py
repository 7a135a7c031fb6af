"""The data dictionary of a board: its messages, its constants, the names of its pins."""

from __future__ import annotations

import json
import re
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from passo import _core

RUNS_KLIPPERS = 'it runs Klipper\'s firmware, or the like, which `firmware = "klipper"` would say'
RUNS_PASSOS = "it runs Passo's firmware, and is taken to run Klipper's (base, firmware)"

_MAX_PINS = 4096  # the maximum in one range of an enumeration
# Exceptions of reading data that is not a dictionary.
_NO_DICTIONARY = (
    ValueError,
    LookupError,
    TypeError,
    AttributeError,
    OverflowError,
    RecursionError,
    zlib.error,
)


class DictionaryError(ValueError):
    """The dictionary is damaged, or a text uses a name that is not in it."""


@dataclass(frozen=True, slots=True)
class Dictionary:
    """`commands` and `reports` are (id, declaration) pairs; `enumerations` map a parameter's kind
    and a name to its number; `constants` are the board's figures (`CLOCK_FREQ`, `ADC_MAX`, …)."""

    commands: tuple[tuple[int, str], ...]
    reports: tuple[tuple[int, str], ...]
    enumerations: Mapping[str, Mapping[str, int]]
    constants: Mapping[str, Any]
    version: str = ""

    @classmethod
    def parse(cls, compressed: bytes) -> Dictionary:
        """Reads the compressed dictionary that a board sends for `identify`. Raises DictionaryError
        if it is damaged."""
        try:
            raw: dict[str, Any] = json.loads(zlib.decompress(compressed))
            return cls(
                commands=tuple((int(i), str(text)) for text, i in raw["commands"].items()),
                reports=tuple((int(i), str(text)) for text, i in raw["responses"].items()),
                enumerations={
                    str(kind): _expand(names) for kind, names in raw["enumerations"].items()
                },
                constants=dict(raw["config"]),
                version=str(raw.get("version", "")),
            )
        except _NO_DICTIONARY as error:
            raise DictionaryError(f"the board's data dictionary is damaged: {error}") from error

    def number(self, constant: str, default: int = 0) -> int:
        """A numeric constant, `default` if the board does not declare it. Raises DictionaryError if
        it is not a number."""
        value = self.constants.get(constant, default)
        try:
            return int(value)
        except (ValueError, TypeError, OverflowError):
            raise DictionaryError(f"the board's {constant} is {value!r}, not a number") from None

    def values(self, text: str) -> tuple[str, list[int | bytes]]:
        """Splits `name a=1 pin=PA0` into the name and its values in the order of the declaration.

        Raises DictionaryError for an unknown message, parameter or enumeration name.
        """
        name, *words = text.split()
        given: dict[str, str] = {}
        for word in words:
            key, equals, value = word.partition("=")
            if not equals or key in given:
                raise DictionaryError(f"{word!r} in {text!r} is no parameter")
            given[key] = value
        try:
            parameters: list[tuple[str, bool]] = _core.Formats(list(self.commands)).parameters(name)
        except ValueError as error:
            raise DictionaryError(str(error)) from error
        if set(given) != {key for key, _ in parameters}:
            raise DictionaryError(f"{text!r} does not match the declaration of {name}")
        return name, [
            bytes.fromhex(given[key]) if blob else self._integer(key, given[key])
            for key, blob in parameters
        ]

    def takes(self, command: str, parameter: str) -> bool:
        """Whether the board has this command with this parameter."""
        texts = (text for _, text in self.commands if text.split(" ", 1)[0] == command)
        return any(word.startswith(f"{parameter}=") for text in texts for word in text.split())

    def name_of(self, kind: str, number: int) -> str:
        """The enumeration's name for a number, or the number itself as text."""
        for name, value in self.enumerations.get(kind, {}).items():
            if value == number:
                return name
        return str(number)

    def _integer(self, parameter: str, text: str) -> int:
        for kind, names in self.enumerations.items():
            if parameter == kind or parameter.endswith(f"_{kind}"):
                if text not in names:
                    raise DictionaryError(f"the board has no {kind} {text!r}")
                return names[text]
        return int(text)


def _expand(names: Mapping[str, Any]) -> dict[str, int]:
    """`{"PA0": [0, 8]}` stands for PA0 = 0 … PA7 = 7."""
    expanded: dict[str, int] = {}
    for name, value in names.items():
        if isinstance(value, int):
            expanded[name] = value
            continue
        start, count = int(value[0]), int(value[1])
        if count > _MAX_PINS:
            raise ValueError(f"{name} begins {count} pins")
        match = re.fullmatch(r"(.*?)(\d+)", name)
        if match is None or not 0 < count <= 4096:
            raise ValueError(f"bad range {name}")
        stem, first = match[1], int(match[2])
        expanded.update({f"{stem}{first + i}": start + i for i in range(count)})
    return expanded


def decode(data: bytes, dictionary: Dictionary, *, from_board: bool = False) -> list[str]:
    """Every message in the frames of `data`, one line each, as text.

    Acknowledgements and bytes that are not a frame appear as such. `from_board` reads reports
    instead of commands. Raises ValueError for a message that the dictionary does not have.
    """
    formats = _core.Formats(list(dictionary.reports if from_board else dictionary.commands))
    lines: list[str] = []
    for frame in _core.FrameScanner().feed(data):
        lines += frame_lines(frame, formats)
    return lines


def frame_lines(
    frame: tuple[int, bytes] | None,
    formats: _core.Formats,
    labels: Mapping[tuple[str, int], str] | None = None,
) -> list[str]:
    """A line for each message of `frame`, which is the pair (sequence, payload). None stands for
    bytes that are not a frame, and gives one line. `labels` maps a parameter and its value to a
    name: ("oid", 3) to `stepper x`, for example. Raises ValueError for a message that is not among
    the formats."""
    if frame is None:
        return ["(bytes that are not a frame)"]
    sequence, payload = frame
    if not payload:
        return [f"(acknowledge {sequence})"]
    messages: list[tuple[str, dict[str, int | bytes]]] = formats.decode(payload)
    return [_line(name, values, labels or {}) for name, values in messages]


def _line(
    name: str, values: Mapping[str, int | bytes], labels: Mapping[tuple[str, int], str]
) -> str:
    words = [name]
    for key, value in values.items():
        words.append(f"{key}={value.hex() if isinstance(value, bytes) else value}")
        if isinstance(value, int) and (label := labels.get((key, value))):
            words.append(f"({label})")
    return " ".join(words)
