"""Finds characters that are not G-code, and names them."""

from __future__ import annotations

import re
import unicodedata

from passo import _core
from passo.errors import Problem

_ODD = re.compile(r"[,#\[{=?]|[^\x00-\x7f]|\.\d*\.")  # allowed in few commands
_DECIMAL_COMMA = re.compile(r"(?<=\d),(?=\d)")
_HINTS = {  # by Unicode's category
    "Pd": "Write - for a minus; a comment begins with ;",
    "Pi": 'Write " for a quote',
    "Pf": 'Write " for a quote',
    "Zs": "Replace it by a blank",
    "Cf": "Remove it; an editor that shows control characters finds it",
}
_NAMES = {0xFEFF: "byte order mark"}
_MINUS = 0x2212  # its category is that of symbols, not of dashes


def stray_of(text: str, *, any_character: bool) -> Problem | None:
    """The first character of a command's text that is not G-code. Without `any_character`, it
    ignores characters that neither change the meaning of the text nor come from a word processor.
    """
    if not any_character and _ODD.search(text) is None:
        return None
    token, code = _core.find_stray(text, any_character)
    return stray_problem(token, code) if code else None


def stray_problem(token: str, code: int, file: str = "", line: int | None = None) -> Problem:
    """The problem for a word that contains the character `code` (Unicode); a negative code means a
    byte that is not UTF-8."""
    values = {"value": token}
    if code < 0:
        values["axis"] = f"the byte 0x{-code:02X} (not UTF-8)"
        hint = "Save the file as UTF-8, or remove the character"
        return Problem("input.character", file, line, values, hint)
    character = chr(code)
    if character == ",":
        if _DECIMAL_COMMA.search(token) is None:
            return Problem("input.comma", file, line, values)
        hint = f"Write a point: {_DECIMAL_COMMA.sub('.', token)}"
        return Problem("input.decimal-comma", file, line, values, hint)
    if character == ".":
        return Problem("input.decimal-points", file, line, values)
    if character in "#[]{}=<>":
        return Problem("input.parameter", file, line, values)
    if character == "?":
        values["axis"] = "the question mark"
        hint = "Remove it; it may stand for a byte that is not UTF-8"
        return Problem("input.character", file, line, values, hint)
    name = _NAMES.get(code) or unicodedata.name(character, "character").lower()
    values["axis"] = f"the {name} (U+{code:04X})"
    hint = _HINTS.get(unicodedata.category(character) if code != _MINUS else "Pd", "")
    plain = unicodedata.normalize("NFKC", character)
    if plain.isascii() and plain.isprintable() and not hint:
        hint = f"Write {plain}"
    return Problem("input.character", file, line, values, hint)
