"""Names on a card: what is allowed, how they compare, paths, and the 8.3 form.

Source: Microsoft, "FAT: General Overview of On-Disk Format" 1.03 (fatgen103), "Long Directory
Entries" and "Name Limits and Character Sets".
"""

from __future__ import annotations

import re
import unicodedata
import zlib
from collections.abc import Callable, Collection

from passo.errors import CardError

MAX_UNITS = 255
"""The maximum length of a name, in UTF-16 units."""

_FORBIDDEN = re.compile(r'["*/:<>?\\|]')
_UNPRESENTABLE = re.compile("[\x00-\x1f\x7f-\x9f\u2028\u2029\ud800-\udfff]")
_SHORT = re.compile(r"[A-Z0-9!#$%&'()\-@^_`{}~]{1,8}(\.[A-Z0-9!#$%&'()\-@^_`{}~]{1,3})?")
_NOT_SHORT = re.compile(r"[^A-Z0-9!#$%&'()\-@^_`{}~]")


def fold(name: str) -> str:
    """The form in which names are compared: upper case letter by letter, so that ß stays ß, and
    accents composed with their letters (NFC), because some systems store them separately."""
    if name.isascii():
        return name.upper()
    composed = unicodedata.normalize("NFC", name)
    return "".join(up if len(up := letter.upper()) == 1 else letter for letter in composed)


def is_presentable(name: str) -> bool:
    """Whether a name can be shown on a console: no control characters, line ends or lone
    surrogates."""
    return not _UNPRESENTABLE.search(name)


def check(name: str, path: str) -> None:
    """Raise `card.name` unless a file or directory may be given this name."""
    limit = ""
    if _FORBIDDEN.search(name) or not is_presentable(name):
        limit = 'no control character and none of "*/:<>?\\|'
    elif name.endswith((".", " ")) or name.startswith(" "):
        limit = "no space at the ends and no dot at the end"
    elif len(name.encode("utf-16-le")) > 2 * MAX_UNITS:
        limit = f"at most {MAX_UNITS} UTF-16 units"
    if limit:
        raise CardError.of("card.name", path, value=name, limit=limit)


def cleaned(name: str) -> str:
    """The allowed name nearest to a name that a client gives to a new file: `_` in place of each
    forbidden character, no space at the ends and no dot at the end. A name that consists only of
    dots and spaces, and control characters, stay as they are, so that `check` refuses them."""
    return _FORBIDDEN.sub("_", name).strip(" ").rstrip(" .") or name


def split(path: str) -> list[str]:
    """The names of a path from the root on; `..` removes the last name and stops at the root."""
    names: list[str] = []
    for name in path.split("/"):
        if name == "..":
            del names[-1:]
        elif name not in ("", "."):
            names.append(name)
    return names


def _basis(name: str) -> tuple[str, str]:
    """The 8.3 base and extension nearest to a long name."""
    bare = fold(name).replace(" ", "").lstrip(".")
    base, dot, extension = bare.rpartition(".")
    if not dot:
        base, extension = bare, ""
    return (
        _NOT_SHORT.sub("_", base.replace(".", ""))[:8] or "_",
        _NOT_SHORT.sub("_", extension)[:3],
    )


def _first_free(name: str, taken: Collection[str], numbered: Callable[[str, int], str]) -> str:
    """The name itself if it is a free 8.3 name, else its first numbered form that is free."""
    short = fold(name)
    if _SHORT.fullmatch(short) and short not in taken:
        return short
    base, extension = _basis(name)
    number = 1
    while True:
        short = numbered(base, number) + (f".{extension}" if extension else "")
        if short not in taken:
            return short
        number += 1


def short_name(name: str, taken: Collection[str]) -> str:
    """The 8.3 name for a new file: with a numeric tail unless the name is 8.3 itself.

    The basis-name generation algorithm of fatgen103, "Generating 8.3 names from long names".
    """

    def numbered(base: str, number: int) -> str:
        tail = f"~{number}"
        return base[: 8 - len(tail)] + tail

    return _first_free(name, taken, numbered)


def stable_short_name(name: str, taken: Collection[str]) -> str:
    """The 8.3 name of a file in a host folder. It contains a checksum of the long name, so that it
    does not change when other files are added or deleted.
    """
    digest = f"{zlib.crc32(fold(name).encode('utf-8', 'surrogatepass')) & 0xFFFF:04X}"

    def numbered(base: str, number: int) -> str:
        tail = f"{digest}~{number}"
        return base[: 8 - len(tail)] + tail

    return _first_free(name, taken, numbered)
