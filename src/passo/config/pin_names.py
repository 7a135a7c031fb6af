"""The board of a pin or a socket in a machine file: `tool:PB3` is on the board `tool`."""

from __future__ import annotations

MAIN = ""  # the name of the main board, which pins do not have as a prefix


def bare(pin: str) -> str:
    """The pin's name without `!`, `^` and `~`."""
    return pin.lstrip("!^~")


def placed(written: str) -> tuple[str, str]:
    """The board of a pin or a socket, and the pin without the board's name; marks stay."""
    name = bare(written)
    marks = written[: len(written) - len(name)]
    board, colon, rest = name.partition(":")
    return (board, marks + rest) if colon else (MAIN, written)


def section(board: str) -> tuple[str, ...]:
    """The path of a board's table in the machine file."""
    return ("board",) if board == MAIN else ("boards", board)


def named_on(board: str, pin: str) -> str:
    """A pin of a board in the form of the machine file."""
    if board == MAIN:
        return pin
    name = bare(pin)
    return f"{pin[: len(pin) - len(name)]}{board}:{name}"
