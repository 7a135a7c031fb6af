"""The layers of a print as its slicer numbers them."""

from __future__ import annotations

from collections.abc import Mapping

from passo.errors import CommandError

_MAX_LAYERS = 1_000_000


class SlicerLayers:
    """The current layer and the number of layers that SET_PRINT_STATS_INFO has given for a print;
    None before that."""

    def __init__(self) -> None:
        self.current: int | None = None
        self.total: int | None = None

    def set(self, words: Mapping[str, str]) -> None:
        """TOTAL_LAYER and CURRENT_LAYER. A total of 0 forgets both; the current layer is at most
        the total. Raises CommandError, without any change."""
        total, current = (_whole(words, key) for key in ("TOTAL_LAYER", "CURRENT_LAYER"))
        if total is not None:
            self.total, self.current = total or None, None
        if current is not None and total != 0:
            self.current = current if self.total is None else min(current, self.total)


def _whole(words: Mapping[str, str], key: str) -> int | None:
    text = words.get(key)
    if text is None:
        return None
    if text.isascii() and text.isdigit() and len(text) < 10 and int(text) <= _MAX_LAYERS:
        return int(text)
    limit = f"a whole number, 0 to {_MAX_LAYERS:,}"
    raise CommandError.of("command.value", axis=key, value=text, limit=limit)
