"""Shipped boards and the boards of machine files as plain tables: merges the boards that extend
others, and resolves pin names."""

from __future__ import annotations

import json
import re
import tomllib
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path as FilePath
from typing import Any, cast

from passo.config.board import Board, joined_marks, pin_behind
from passo.config.budget import klippers_budget
from passo.config.chips import chip, chip_names, numbering, numberings
from passo.config.companion_files import MAX_BYTES, read_companion
from passo.config.console_checks import check_console
from passo.config.findings import Finding, array, did_you_mean, table, tables
from passo.config.klippers_firmware import ASSUMED_CLOCK_HZ, runs_klippers
from passo.config.pin_names import placed, section
from passo.config.toml_lines import Path

Tables = dict[str, Any]

_BOARDS = FilePath(__file__).parent / "boards"
_NAMED = ("outputs", "thermistors", "endstops", "pins")
_RESERVES = "RESERVE_PINS_"
_SOCKET_PINS = {
    "step": "STEP",
    "direction": "DIR",
    "enable": "ENABLE",
    "select": "SELECT",
    "uart": "UART",
    "uart_send": "UART_SEND",
}


@dataclass(frozen=True, slots=True)
class Source:
    """A file with values of the board at `path` of the machine file. The keys in that file do not
    begin with `path`."""

    file: str
    text: str
    path: Path = ("board",)


def shipped_boards() -> list[str]:
    """Names of the boards that come with Passo, sorted."""
    return sorted(path.stem for path in _BOARDS.glob("*.toml"))


def meant_board(base: object) -> str | None:
    """The shipped board of this name, or of the most similar name; None if no name is similar."""
    names, name = shipped_boards(), str(base)
    if name in names:
        return name
    from difflib import get_close_matches

    return next(iter(get_close_matches(name, names, 1)), None)


@cache
def load_board(name: str) -> Board:
    """The shipped board of that name. Raises KeyError if there is none."""
    if name not in shipped_boards():
        raise KeyError(name)
    data = shipped_tables(name)[0] | {"base": name}
    _put_klippers_budget(data, {})
    resolve_names(data)
    return Board.model_validate(data)


def shipped_tables(name: str) -> tuple[Tables, list[Source]]:
    """The tables of a shipped board merged with those of the boards that it extends, and their
    files, nearest first."""
    text = (_BOARDS / f"{name}.toml").read_text()
    data, sources = tomllib.loads(text), [Source(f"boards/{name}.toml", text)]
    base = data.pop("base", None)
    if base is not None:
        beneath, further = shipped_tables(base)
        data, sources = _merged(beneath, data), [*sources, *further]
    return data, sources


def _merged(beneath: Mapping[str, Any], above: Mapping[str, Any]) -> Tables:
    """Merges tables; any other value replaces the one below."""
    result = dict(beneath)
    for key, value in above.items():
        old = result.get(key)
        if isinstance(value, Mapping) and isinstance(old, Mapping):
            value = _merged(cast("Tables", old), cast("Tables", value))
        result[key] = value
    return result


def put_boards(data: Tables, folder: FilePath, sources: list[Source]) -> Iterator[Finding]:
    """Fills in the values of shipped boards that the machine file `data` does not give, and
    replaces pin names by pins of the microcontroller. Appends the shipped files to `sources`."""
    if own := table(data, "board"):
        data["board"] = board = dict(own)
        yield from _put_board(board, ("board",), folder, sources)
    if isinstance(data.get("boards"), Mapping):
        data["boards"] = boards = dict(table(data, "boards"))
        for name, own in tables(data, "boards"):
            boards[name] = board = dict(own)
            yield from _put_board(board, ("boards", name), folder, sources)


def _put_board(
    board: Tables, place: Path, folder: FilePath, sources: list[Source]
) -> Iterator[Finding]:
    own = dict(board)
    base = own.get("base")
    if base is not None:
        if base not in shipped_boards():
            hint, limit = did_you_mean(base, shipped_boards()), "the name of a shipped board"
            yield Finding("config.value", (*place, "base"), base, limit, hint)
            # With a substitute board, the other checks can continue without reporting its keys as
            # missing.
            base = meant_board(base) or "ramps"
        beneath, files = shipped_tables(base)
        sources += [replace(file, path=place) for file in files]
        board.update(_merged(beneath, own))
    console = table(board, "console")
    if "baud" in own and "baud" in console and "baud" not in table(own, "console"):
        # the firmware is built for this baud rate
        board["console"] = {**console, "baud": own["baud"]}
    elif "baud" in console:
        board.setdefault("baud", console["baud"])
    printed = board.get("numbering")
    if isinstance(printed, str) and printed not in numberings():
        hint, limit = did_you_mean(printed, numberings()), "a numbering of pins"
        yield Finding("config.value", (*place, "numbering"), printed, limit, hint)
    if "dictionary" in board:
        if "clock_hz" not in own:
            board.pop("clock_hz", None)  # the clock of the dictionary applies
        yield from _read_dictionary(board, (*place, "dictionary"), folder)
    elif not runs_klippers(board) and "clock_hz" not in board:
        limit = "the frequency of the board's clock"
        yield Finding("config.missing-key", (*place, "clock_hz"), None, limit)
    _put_klippers_budget(board, own)
    variants = table(board, "variants")
    variant = board.get("variant")
    if variant is not None and str(variant) not in variants:
        hint, limit = did_you_mean(variant, variants), "one of the board's variants"
        yield Finding("config.value", (*place, "variant"), variant, limit, hint)
    resolve_names(board)
    if not runs_klippers(board):
        mcu, known = board.get("mcu"), chip_names()
        if mcu in known:
            yield from check_console(board, own, place)
        elif isinstance(mcu, str):
            limit = f"a chip of Passo's firmware ({', '.join(known)}), or Klipper's firmware"
            yield Finding("config.value", (*place, "mcu"), mcu, limit, did_you_mean(mcu, known))


def _put_klippers_budget(board: Tables, own: Mapping[str, Any]) -> None:
    """Fills in the default budget of Klipper's firmware where the machine file does not give one.
    The budget of a shipped board applies only to Passo's firmware."""
    clock_hz, stated = board.get("clock_hz", ASSUMED_CLOCK_HZ), own.get("budget", {})
    if runs_klippers(board) and isinstance(clock_hz, int) and isinstance(stated, Mapping):
        board["budget"] = {**klippers_budget(clock_hz), **table(own, "budget")}


# Exceptions of reading a file that is not a dictionary.
_NO_DICTIONARY = (
    ValueError,
    LookupError,
    TypeError,
    AttributeError,
    OverflowError,
    RecursionError,
    zlib.error,
)


def _read_dictionary(board: Tables, path: Path, folder: FilePath) -> Iterator[Finding]:
    """Pins and clock of the data dictionary that the key `dictionary` names."""
    name = board["dictionary"]
    if not isinstance(name, str):
        return
    try:
        raw = read_companion(folder, name)
        found = json.loads(raw if raw.lstrip()[:1] == b"{" else _decompressed(raw))
        pins = _dictionary_pins(found["enumerations"]["pin"])
        board.setdefault("clock_hz", int(found["config"]["CLOCK_FREQ"]))
    except OSError as error:
        board.setdefault("clock_hz", ASSUMED_CLOCK_HZ)
        yield Finding("config.value", path, name, f"a file to read ({error.strerror})")
    except _NO_DICTIONARY:
        board.setdefault("clock_hz", ASSUMED_CLOCK_HZ)
        yield Finding("config.value", path, name, "a data dictionary of Klipper's protocol")
    else:
        board["pins"] = {**pins, **table(board, "pins")}
        board["reserved"] = {
            **_dictionary_reserves(found["config"], pins),
            **table(board, "reserved"),
        }


def _decompressed(raw: bytes) -> bytes:
    """Decompresses. Raises ValueError if the result is larger than a file may be, and
    zlib.error."""
    stream = zlib.decompressobj()
    content = stream.decompress(raw, MAX_BYTES)
    if not stream.eof:
        raise ValueError("cut short, or too large")
    return content


def _dictionary_pins(names: Mapping[str, Any]) -> dict[str, str]:
    """Each pin name, with the first name of the same pin: a Linux process has `gpio4` and
    `gpiochip0/gpio4` for one pin."""
    numbers: dict[str, int] = {}
    for name, value in names.items():
        if isinstance(value, int):
            numbers[name] = value
            continue
        match = re.fullmatch(r"(.*?)(\d+)", name)
        number, count = int(value[0]), int(value[1])
        if match is None or not 0 < count <= 4096:
            raise ValueError(name)
        stem, first = match[1], int(match[2])
        numbers.update({f"{stem}{first + i}": number + i for i in range(count)})
    names_of: dict[int, str] = {}
    return {name: names_of.setdefault(number, name) for name, number in numbers.items()}


def _dictionary_reserves(
    constants: Mapping[str, Any], pins: Mapping[str, str]
) -> dict[str, list[str]]:
    """The pins that constants such as RESERVE_PINS_USB reserve for the board itself."""
    return {
        key.removeprefix(_RESERVES): [pin for pin in value.split(",") if pin in pins]
        for key, value in constants.items()
        if key.startswith(_RESERVES) and isinstance(value, str)
    }


def resolve_names(board: Tables) -> None:
    """Fills `pins` with all names of a board, replaces every pin by that of the microcontroller,
    and sets `functions` to those of the chosen variant. Values of the wrong type are skipped here;
    the models report them."""
    names: dict[str, str] = {}
    printed = board.get("numbering")
    if isinstance(printed, str) and printed in numberings():
        names.update(numbering(printed))
    for key in _NAMED:
        names.update(_texts(table(board, key)))
    for name, socket in tables(board, "sockets"):
        for key, word in _SOCKET_PINS.items():
            if isinstance(socket.get(key), str):
                names.setdefault(f"{name}_{word}", socket[key])
        for i, pin in enumerate(array(socket, "microstep"), 1):
            if isinstance(pin, str):
                names.setdefault(f"{name}_MS{i}", pin)
    resolved = {name: _pin_behind(names, name) for name in names}
    if "variant" in board:
        chosen = table(board, "variants", str(board["variant"]))
        board["functions"] = {**chosen, **table(board, "functions")}
    for key in ("sockets", "outputs", "thermistors", "endstops", "card", "displays", "reserved"):
        if key in board:
            board[key] = _resolved(board[key], resolved)
    console = table(board, "console")
    if "pins" in console:
        board["console"] = {**console, "pins": _resolved(console["pins"], resolved)}
    if isinstance(board.get("pins", {}), Mapping):
        board["pins"] = {**table(board, "pins"), **resolved}


def pin_of(data: Mapping[str, Any], written: str) -> tuple[str, str]:
    """The board that a pin of a machine file is on, and the microcontroller's pin for its name,
    with the marks of both."""
    board, name = placed(written)
    return board, pin_behind(table(data, *section(board), "pins"), name)


def _texts(content: Mapping[str, Any]) -> dict[str, str]:
    return {name: pin for name, pin in content.items() if isinstance(pin, str)}


def _pin_behind(names: Mapping[str, str], name: str) -> str:
    pin, seen = names[name], {name}
    while (bare := pin.lstrip("!^~")) in names and bare not in seen:
        seen.add(bare)
        pin = joined_marks(pin, names[bare])
    return pin


def _resolved(value: Any, names: Mapping[str, str]) -> Any:
    """A copy of tables and lists, with names replaced by pins of the microcontroller."""
    if isinstance(value, str):
        bare = value.lstrip("!^~")
        return joined_marks(value, names[bare]) if bare in names else value
    if isinstance(value, Mapping):
        content = cast("Mapping[str, Any]", value)
        return {
            key: item if key == "compare" else _resolved(item, names)
            for key, item in content.items()
        }
    if isinstance(value, list):
        return [_resolved(item, names) for item in cast("list[Any]", value)]
    return value


def known_pins(board: Mapping[str, Any]) -> set[str]:
    """The pins of the board's microcontroller, or of its dictionary; empty if unknown."""
    mcu = board.get("mcu")
    if isinstance(mcu, str) and mcu in chip_names():
        return set(chip(mcu).pins)
    if "dictionary" in board:
        return {pin for name, pin in table(board, "pins").items() if name == pin}
    return set()
