"""The text of a macro with its comments. Klipper cuts comments off before Jinja2 reads the text;
here they become comments of Jinja2, which nothing reads either."""

from __future__ import annotations

from collections.abc import Callable


class CommentedText:
    """The lines of one option. Comments within an expression of several lines are left out,
    because Jinja2 has none there."""

    def __init__(self) -> None:
        self._lines: list[str] = []
        self._waiting: list[str] = []  # comments that another line of the option may follow
        self._depth = 0  # braces that are open

    @property
    def text(self) -> str:
        """The lines without blank ones at both ends."""
        return "\n".join(self._lines).strip("\n")

    def line(self, content: str, comment: str) -> None:
        """Adds a line without its comment, and the comment at its end (empty: none)."""
        self._lines += self._waiting
        self._waiting = []
        self._depth = _depth(content, self._depth)
        after = _comment(comment) if comment and self._depth == 0 else ""
        if after and content:
            after = f" {after.replace('{#', '{#-', 1)}"  # takes the blank before it off
        if content or after:
            self._lines.append(content + after)

    def comment(self, text: str, *, indented: bool) -> None:
        """Adds a line that has only a comment. At the end of the option, it belongs to the option
        only if it is indented."""
        if self._depth:
            return
        self._waiting.append(_comment(text))
        if indented:
            self._lines += self._waiting
            self._waiting = []

    def replace(self, change: Callable[[str], str]) -> None:
        """Changes the text of each line."""
        self._lines = [change(line) for line in self._lines]


def _comment(text: str) -> str:
    words = text.strip().lstrip("#;").strip().replace("#}", "# }")
    return f"{{# {words} #}}" if words else ""


def _depth(text: str, depth: int) -> int:
    """How many braces are open after a text. Quotation marks count only within braces."""
    quote, escaped = "", False
    for mark in text:
        if quote:
            if mark == quote and not escaped:
                quote = ""
            escaped = mark == "\\" and not escaped
        elif depth and mark in "'\"":
            quote = mark
        elif mark == "{":
            depth += 1
        elif mark == "}":
            depth = max(depth - 1, 0)
    return depth
