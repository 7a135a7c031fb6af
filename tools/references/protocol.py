"""The reference page of the firmware's protocol, made from the declarations in its sources."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from passo.toolchain.build import firmware_folder
from passo.toolchain.declarations import Declarations, gather, message_name
from passo.toolchain.protocol_words import (
    COMMANDS,
    CONSTANTS,
    ENUMERATIONS,
    LACKING,
    REPORTS,
    SHUTDOWNS,
)

_HEAD = """# What the firmware says and understands

Made from the declarations in `firmware/core/` (`tools/references/protocol.py`). Frames,
messages and meanings are those of Klipper's protocol, so that hosts made for it can drive a board.
What is marked *Passo's* is not known to others, and nothing depends on it: while `survive` is off
the board behaves as one without it. Kalico and Klipper hosts up to v0.13 query analog inputs
with other parameters (`query_analog_in` without `bytes_per_report`, one value in
`analog_in_state`): `passo firmware build BOARD --for-older-hosts` makes an image for them. All
other messages are the same.

A frame is its length (5 to 64, all of it), 0x10 and a number that counts to 15, commands or one
report, a CRC of 16 bits, and 0x7E. The dictionary of a board has the numbers of its messages;
only those of `identify` (1) and its answer (0) are known beforehand. Types: `%c` a byte, `%hu` and
`%hi` 16 bits, `%u` and `%i` 32 bits, `%s` bytes. Times are ticks of the board's clock
(`CLOCK_FREQ`), 32 bits of it; `oid` is the number that the host has given an object.
"""
_OWN = ("survive", "get_counters", "counters")


def reference() -> str:
    """The page, in Markdown. Raises KeyError if a declaration has no description."""
    found = gather(sorted(firmware_folder().glob("core/*.c")))
    return "\n".join([_HEAD, *_commands(found), *_lacking(), *_reports(found), *_rest(found)])


def _commands(found: Declarations) -> Iterator[str]:
    by_name = {message_name(c.format): c for c in found.commands}
    yield "## Commands\n"
    yield "*S*: obeyed after a shutdown too. All others are answered by `is_shutdown` then.\n"
    for title, words in COMMANDS.items():
        yield f"### {title}\n"
        rows = [
            (
                f"`{name}`",
                _parameters(by_name[name].format),
                "*S*" if by_name[name].flags == "IN_SHUTDOWN" else "",
                _meaning(name, text),
            )
            for name, text in words.items()
        ]
        yield from _table(("command", "parameters", "", "what it does"), rows)


def _lacking() -> Iterator[str]:
    yield "### Of Klipper's words, these are not known\n"
    yield "A host that needs one of them finds that out when it reads the dictionary.\n"
    rows = [(f"`{words}`", text) for words, text in LACKING.items()]
    yield from _table(("words", "for"), rows)


def _reports(found: Declarations) -> Iterator[str]:
    yield "## Reports\n"
    by_name = {message_name(text): text for text in found.reports}
    rows = [
        (f"`{name}`", _parameters(by_name[name]), _meaning(name, text))
        for name, text in REPORTS.items()
    ]
    yield from _table(("report", "parameters", "content"), rows)


def _rest(found: Declarations) -> Iterator[str]:
    yield "## Reasons for a shutdown\n"
    yield (
        "Reported by number; the dictionary's `static_string_id` has the texts. A shutdown stops"
        " all motors, sets all\noutputs to their defaults and informs SPI devices. Where hosts"
        " explain a reason, its words are the usual ones.\n"
    )
    rows = [(text, _meaning(name.lower(), SHUTDOWNS[name])) for name, text in _in_order(found)]
    yield from _table(("reason", "when"), rows)
    yield "## Constants\n"
    rows = [
        (f"`{name}`", str(found.constants.get(name, "the board's")), _meaning(name.lower(), text))
        for name, text in CONSTANTS.items()
    ]
    yield from _table(("constant", "value", "what it is"), rows)
    yield "## Enumerations\n"
    yield "And `pin`: the names of the board's pins. `static_string_id`: see above.\n"
    rows = [
        (
            f"`{name}`",
            ", ".join(f"{key} {value}" for key, value in found.enumerations[name].items()),
            _meaning(name, text),
        )
        for name, text in ENUMERATIONS.items()
    ]
    yield from _table(("enumeration", "values", "of what"), rows)


def _in_order(found: Declarations) -> list[tuple[str, str]]:
    return [(name, found.shutdowns[name]) for name in SHUTDOWNS]


def _parameters(text: str) -> str:
    return " ".join(f"`{re.sub(r'[.]?[*]s', 's', word)}`" for word in text.split(" ")[1:])


def _meaning(name: str, text: str) -> str:
    return f"*Passo's*. {text}".rstrip() if name.startswith(_OWN) else text


def _table(head: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> Iterator[str]:
    yield "| " + " | ".join(head) + " |"
    yield "|---" * len(head) + "|"
    yield from ("| " + " | ".join(row) + " |" for row in rows)
    yield ""
