"""Errors of commands that reached a board too late."""

from __future__ import annotations

from collections.abc import Mapping

from passo.catalogue.entry import Entry, ExitStatus


def _late(says: str, action: str) -> Entry:
    head = "commands reached the board {value} they were due (needed: {limit:.0f} ms before)"
    return Entry("link", f"{head}: {says}", action, ExitStatus.MACHINE_FAULT)


LINK: Mapping[str, Entry] = {
    "late.stall": _late(
        "the computer did not let Passo run for {held:.2f} s",
        "End other programs on it, or give Passo a higher priority",
    ),
    "late.plan": _late(
        "the moves were planned {held:.2f} s late",
        "End other programs on the computer, take a faster one, or slice with fewer short moves",
    ),
    "late.bytes": _late(
        "the link took no more bytes for {held:.2f} s",
        "Raise the baud rate, or set link_bytes_s in [board.budget] of the machine file",
    ),
    "late.retransmits": _late(
        "bytes were lost and sent again for {held:.2f} s, {bytes} of them so far",
        "Use a shorter cable away from the motors' wires, or 115200 baud",
    ),
    "late.slots": _late(
        "the board's move queue of {slots} commands was full for {held:.2f} s",
        "Set [board.budget] in the machine file, or print more slowly",
    ),
}
