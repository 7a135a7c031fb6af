"""Lines with a number and a checksum, as hosts send them."""

from __future__ import annotations

from functools import reduce
from operator import xor


def numbered(*lines: tuple[int, str]) -> list[str]:
    """Each text with its number before it, and the checksum of both after it."""
    texts = [f"N{number} {text}" for number, text in lines]
    return [f"{text}*{reduce(xor, text.encode())}" for text in texts]
