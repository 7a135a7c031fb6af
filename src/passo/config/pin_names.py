"""The board of a pin or a socket in a machine file: `tool:PB3` is on the board `tool`."""

from __future__ import annotations

MAIN = ""  # the name of the main board, which no pin has in front


def bare(pin: str) -> str:
    """The pin's name without `!`, `^` and `~`."""
    return pin.lstrip("!^~")


def placed(written: str) -> tuple[str, str]:
    """The board that a pin or a socket is on, and the same without the board's name; marks stay in
    front."""
    name = bare(written)
    marks = written[: len(written) - len(name)]
    board, colon, rest = name.partition(":")
    return (board, marks + rest) if colon else (MAIN, written)


def section(board: str) -> tuple[str, ...]:
    """Where the machine file describes a board."""
    return ("board",) if board == MAIN else ("boards", board)


def named_on(board: str, pin: str) -> str:
    """A board's pin as a machine file writes it."""
    if board == MAIN:
        return pin
    name = bare(pin)
    return f"{pin[: len(pin) - len(name)]}{board}:{name}"
