"""Errors of SD cards and of the files on them."""

from __future__ import annotations

from collections.abc import Mapping

from passo.catalogue.entry import Entry, ExitStatus


def _card(says: str, action: str) -> Entry:
    return Entry("card", says, action, ExitStatus.BAD_INPUT)


CARD: Mapping[str, Entry] = {
    "card.absent": _card(
        "there is no card: {value}", "Insert the card or correct the path, then mount it again"
    ),
    "card.format": _card(
        "has no FAT32 file system: {key} is {value}, expected {limit}",
        "Format the card as FAT32 on a computer, after saving what is on it",
    ),
    "card.broken": _card(
        "the file system is damaged: {key} is {value}, expected {limit}",
        "Check and repair the card on a computer (fsck.fat or chkdsk)",
    ),
    "card.not-found": _card(
        "is not on the card", "List the files (M20), and give one of these names"
    ),
    "card.directory": _card("is a directory, not a file", "Name a file in it"),
    "card.not-directory": _card("is a file, not a directory", "Name a directory of the card"),
    "card.exists": _card("exists already", "Choose another name"),
    "card.not-empty": _card("is not empty: {value} is in it", "Delete its contents first"),
    "card.into-itself": _card(
        "cannot be moved into itself", "Choose a directory that is not within it"
    ),
    "card.no-slots": _card(
        "cannot be renamed to {value!r}: the entries of its directory leave no space for this name",
        "Make a directory with that name and move the files into it, or rename it on a computer",
    ),
    "card.name": _card(
        "the name {value!r} is not allowed on a card: expected {limit}", "Choose another name"
    ),
    "card.full": _card(
        "the card is full: {value} bytes are needed, {limit} are free",
        "Delete files or take another card",
    ),
    "card.too-long": _card(
        "would be {value} bytes long, beyond the limit of {limit}", "Divide it into several files"
    ),
    "card.read-only": _card(
        "cannot be written: {value}", "Remove the write protection (the card's switch, permissions)"
    ),
    "card.busy": _card("is in use: {value}", "Wait until that has ended, or stop it"),
    "card.removed": _card(
        "was removed while in use, or fails: {value}",
        "Insert the card again and mount it; replace it if that recurs",
    ),
    "card.changed": _card(
        "was changed on the computer while in use: {value}",
        "Select it again (M23) and print it from its beginning",
    ),
    "card.line-refused": _card(
        "a line of the file was refused: {value}", "Shorten the line, then upload the file again"
    ),
    "card.no-name": _card(
        "the command names no file", "Write a name from the list of M20 after the command"
    ),
    "card.no-console": _card("only a console can send a file", "Send it from a console"),
}
