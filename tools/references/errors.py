"""The reference page of all errors, made from the catalogue."""

from __future__ import annotations

import re
from collections.abc import Iterator

from passo.catalogue import CATALOGUE, Entry, ExitStatus

_HEAD = """# Errors

Made from the catalogue (`tools/references/errors.py`). Consoles, the `passo` command, the log and
Python programs (`problem.code`) show the same sentences: what happened, with the measured value and
the limit, then what to do. Words in *italics* stand for names and values. The file and the line
come before the sentence where they are known.

| exit status of `passo` | meaning |
|---|---|
"""
_STATUS = {
    ExitStatus.DONE: "all went well",
    ExitStatus.USAGE: "wrong usage of the command",
    ExitStatus.BAD_CONFIG: "the machine file is wrong",
    ExitStatus.BAD_INPUT: "the G-code or another input is wrong",
    ExitStatus.MACHINE_FAULT: "the machine or its board failed",
}
# The placeholders of a sentence, and their names on the page.
_VALUES = {"axis": "name", "key": "key", "value": "value", "limit": "limit", "held": "time"}
# A sentence with this beginning continues the name of a file.
_OF_A_FILE = ("begins", "can", "cannot", "exists", "has", "holds", "is", "needs", "was", "would")
_PLACE = re.compile(r"\{(\w+)[^{}]*(?:\{\w+\}[^{}]*)*\}")


def reference() -> str:
    """The page, in Markdown."""
    return _HEAD + "\n".join(_lines()) + "\n"


def _lines() -> Iterator[str]:
    yield from (f"| {status.value} | {text} |" for status, text in _STATUS.items())
    groups: dict[str, list[tuple[str, Entry]]] = {}
    for code, entry in CATALOGUE.items():
        groups.setdefault(code.partition(".")[0], []).append((code, entry))
    for group, entries in sorted(groups.items()):
        yield f"\n## {group}\n"
        yield "| code | what happened | what to do | exit status |\n|---|---|---|---|"
        for code, entry in sorted(entries):
            says, action = _text(entry.says), _text(entry.action)
            yield f"| `{code}` | {says} | {action} | {entry.status.value} |"


def _text(says: str) -> str:
    text = _PLACE.sub(lambda found: f"*{_VALUES.get(found[1], found[1])}*", says)
    if text.partition(" ")[0] in _OF_A_FILE:
        return f"*file* {text}"
    return text[0].upper() + text[1:]
