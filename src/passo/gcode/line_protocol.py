"""The line protocol of hosts: line numbers, checksums, resends. Takes bytes and returns lines; does
no input or output itself.

A numbered line is `N<number> <command>*<checksum>`. The checksum is the exclusive or of all bytes
before the last `*`, in decimal. The number must be the last number plus one; M110 sets the last
number. Lines without a number are accepted at any time and do not change the count.

At the end of a line without a number, `*` and up to three digits are a checksum if it is right. If
it is wrong, it is part of the text of a command that takes a text (a label, a file name, a
message); any other line is requested again. M117 and M118 without a number have no checksum.

Hosts parse the text after `Error:`. The reasons here contain the words by which hosts recognise a
fault of the link, which a resend repairs; any other text after `Error:` makes them disconnect.
"""

from __future__ import annotations

import re
from collections import deque
from typing import NamedTuple

LONGEST = 65536  # maximum bytes of a line, as in files
_REMEMBERED = 64  # lines, so that a repeated line is recognised, as after two requests for it
_MARK = b"\xef\xbb\xbf"  # of UTF-8
_CTRL_Z = "\x1a"
_ENDING = 16  # bytes at the end of a longer line, which may contain its checksum

_NUMBERED = re.compile(r"\s*[Nn]\s*(-?\d{1,18})(?!\d)\s*(.*)\Z", re.DOTALL)
_CHECKSUM = re.compile(rb"\*\s*(\d{1,3})\s*\Z")
_FRAGMENT = re.compile(r"\s*([Nn]\s*-?|\d+)\s*\Z")  # of a numbered line that was split
_SET_NUMBER = re.compile(r"[Mm]110(?!\d)\s*(?:[NnLl]\s*(-?)0*(\d+))?")
_MAX_DIGITS = 18
_MESSAGE = re.compile(r"\s*[Mm]11[78](?!\d)")
# Commands that take a text.
_TAKES_TEXT = re.compile(
    r"\s*(?:[A-Za-z_]{2}|[Mm]0*(?:[01]|16|2[038]|3[02368]|486|531|550|587|928)(?!\d))"
)
# Commands of this list that do not look like a numbered line with a damaged beginning.
_LABELS = re.compile(r"\s*(?:[A-Za-z_]{4}|[Mm]486\s+(?:[Ss]-?\d+\s*)?[Aa])")
# Commands that name a file, in quotes.
_QUOTED_NAME = re.compile(r'(\s*[Mm]0*(?:2[38]|3[0236]|928)\s+"[^"]*")\s*(?:;|\Z)')
# A command with parameters KEY=VALUE, and its values in quotes: `closing_quote` of the core.
_NAMED = re.compile(r"\s*[A-Za-z_]{2}")
_QUOTED_VALUE = re.compile(r"""(?<![^\s=])(?:"(?:\\.|[^"\\])*"|'[^']*')""")


class Line(NamedTuple):
    """A line to execute, with its `number` or None. `text` is the line without number, checksum and
    comment. Its bytes beyond ASCII are surrogate escapes, so that no pattern reads them as digits
    or blanks."""

    text: str
    number: int | None = None


class Refusal(NamedTuple):
    """A line that is not executed. The host receives `reason`. `resend` is the number of the line
    to request again; the console then sends `ok` too. `text` is the content of an intact line with
    the wrong number, or the beginning of a line that is too long. `lost` if the host will not send
    the line again."""

    reason: str
    resend: int | None
    text: str = ""
    lost: bool = False


class _Incoming:
    """The bytes of a line that has not ended. At most LONGEST bytes are kept. Of a longer line, the
    last bytes and the exclusive or of the bytes between are kept too."""

    def __init__(self) -> None:
        self.kept = bytearray()
        self._between = 0
        self._skipped = False
        self._ending = b""

    @property
    def too_long(self) -> bool:
        """Whether the line is longer than LONGEST."""
        return bool(self._ending)

    def add(self, data: bytes) -> None:
        """Adds the next bytes."""
        room = LONGEST - len(self.kept)
        self.kept += data[:room]
        if len(data) > room:
            ending = self._ending + data[room:]
            self._between ^= _exclusive_or(ending[:-_ENDING])
            self._skipped = self._skipped or len(ending) > _ENDING
            self._ending = ending[-_ENDING:]

    def checksum(self) -> tuple[int, bool] | None:
        """The position of `*` and digits at the end of the line, and whether this checksum is
        right; for a line that is too long the position has no meaning."""
        end = self._ending if self._skipped else bytes(self.kept) + self._ending
        star = end.rfind(b"*")
        found = _CHECKSUM.match(end, star) if star >= 0 else None
        if found is None:
            return None
        total = self._between ^ _exclusive_or(end[:star])
        if self._skipped:
            total ^= _exclusive_or(self.kept)
        return star, total == int(found[1])


class LineProtocol:
    """Splits the bytes of one console into lines and checks them. Keeps at most one unfinished line
    of LONGEST bytes."""

    def __init__(self) -> None:
        self.last = 0  # number of the last accepted line
        self._incoming = _Incoming()
        self._begun = False  # a line has arrived
        self._numbering = False  # a line with a number has arrived
        self._taken: deque[int] = deque(maxlen=_REMEMBERED)  # hashes of the last lines

    @property
    def unfinished(self) -> bool:
        """Whether the beginning of a line has arrived, but not its end."""
        return bool(self._incoming.kept)

    def feed(self, data: bytes) -> list[Line | Refusal]:
        """Returns the lines that these bytes complete, in order, without blank lines and
        comments."""
        # A zero byte is noise that the exclusive or does not detect.
        data = data.replace(b"\0", b"").replace(b"\r", b"\n")
        first, *others = data.split(b"\n")
        self._incoming.add(first)
        found: list[Line | Refusal] = []
        for begins in others:
            if self._incoming.kept:
                line = self._line(self._incoming)
                if line is not None:
                    found.append(line)
                self._incoming = _Incoming()
            self._incoming.add(begins)
        return found

    def _line(self, raw: _Incoming) -> Line | Refusal | None:
        if not self._begun:  # a file from a pipe may begin with a byte order mark
            self._begun = True
            if raw.kept.startswith(_MARK):
                del raw.kept[: len(_MARK)]
        text = raw.kept.decode("ascii", "surrogateescape")
        numbered = _NUMBERED.match(text)
        if numbered is None:
            return self._bare(text, raw)
        self._numbering = True
        checked = raw.checksum()
        if checked is None:
            return self._asked_again("No Checksum with line number")
        star, right = checked
        if not right:
            return self._asked_again("checksum mismatch")
        number = int(numbered[1])
        text = text[numbered.start(2) : None if raw.too_long else star]
        cut = raw.too_long and not _ends_in_comment(text)
        text = uncommented(text)
        set_number = _SET_NUMBER.match(text)
        if set_number:
            if (refusal := self._count_from(set_number, number)) is not None:
                return refusal
        elif number == self.last + 1:
            self.last = number
            self._taken.append(hash(text))
        elif 0 <= self.last - number < len(self._taken) and (
            self._taken[number - self.last - 1] == hash(text)
        ):
            return Refusal(f"line {number} has come already", None)
        else:
            return self._asked_again("Line Number is not Last Line Number+1", text)
        return _left_out(f"line {number}", text) if cut else Line(text, number)

    def _bare(self, text: str, raw: _Incoming) -> Line | Refusal | None:
        if raw.too_long:
            if self._numbering or not _ends_in_comment(text):
                return _left_out("this line", text)
            return Line(line) if (line := uncommented(text)) else None
        if _MESSAGE.match(text):
            return Line(text.strip())
        text = text.rstrip(_CTRL_Z)  # ends a file of DOS
        checked = raw.checksum()
        if checked is not None:
            star, right = checked
            if not right and (_LABELS if self._numbering else _TAKES_TEXT).match(text):
                return Line(uncommented(text))
            if self._numbering or not (right or ";" in text):
                # A line without a number has no checksum here, so its number must be damaged.
                return self._asked_again("checksum mismatch")
            text = text[:star]
        elif self._numbering and _FRAGMENT.match(text):
            # A host has disconnected within a line, and this is the first line of the next host.
            return self._asked_again("checksum mismatch")
        text = uncommented(text)
        set_number = _SET_NUMBER.match(text)
        if set_number and (refusal := self._count_from(set_number, None)) is not None:
            return refusal
        return Line(text) if text else None

    def _count_from(self, command: re.Match[str], number: int | None) -> Refusal | None:
        """Handles M110 in the line `number`: the next number follows its N word, or `number` if it
        has none."""
        sign, digits = command[1], command[2]
        if digits is not None:
            if len(digits) > _MAX_DIGITS:
                limit = f"the line number has more than {_MAX_DIGITS} digits"
                return Refusal(f"M110 is not carried out: {limit}. Send a smaller one", None)
            number = int(sign + digits)
        if number is not None:
            self.last = number
            self._taken.clear()
        return None

    def _asked_again(self, reason: str, text: str = "") -> Refusal:
        return Refusal(f"{reason}, Last Line: {self.last}", self.last + 1, text)


def _left_out(line: str, text: str) -> Refusal:
    reason = f"{line} is longer than {LONGEST} characters and is left out"
    return Refusal(reason, None, text, lost=True)


def _ends_in_comment(text: str) -> bool:
    """Whether this beginning of a line already contains the start of its comment, and so the whole
    command."""
    return ";" in text and not _MESSAGE.match(text)


def decoded(text: str) -> str:
    """The text of a `Line` with its bytes beyond ASCII as characters: of UTF-8, or of Latin-1 if
    they are not UTF-8."""
    if text.isascii():
        return text
    raw = text.encode("utf-8", "surrogateescape")
    try:
        return raw.decode()
    except UnicodeDecodeError:
        return raw.decode("latin-1")


def uncommented(text: str) -> str:
    """The line without the text after `;`, except in the text of M117 and M118, in the quoted name
    of a file, and in the quoted values of an extended command."""
    if ";" not in text or _MESSAGE.match(text):
        return text.strip()
    if _NAMED.match(text):
        masked = _QUOTED_VALUE.sub(lambda value: "_" * len(value[0]), text)
        return text[: len(masked.partition(";")[0])].strip()
    quoted = _QUOTED_NAME.match(text)
    return (quoted[1] if quoted else text.partition(";")[0]).strip()


def _exclusive_or(data: bytes | bytearray) -> int:
    """The exclusive or of all bytes. It folds halves, which is fast for a very long line."""
    total, size = int.from_bytes(data, "big"), len(data)
    while size > 1:
        size = (size + 1) // 2
        total = (total >> 8 * size) ^ (total & ((1 << 8 * size) - 1))
    return total
