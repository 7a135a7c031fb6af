"""The layers of a print as its slicer numbers them."""

from __future__ import annotations

MAX_LAYERS = 1_000_000


class SlicerLayers:
    """The current layer and the number of layers that SET_PRINT_STATS_INFO has given for a print;
    None before that."""

    def __init__(self) -> None:
        self.current: int | None = None
        self.total: int | None = None

    def set(self, total: int | None, current: int | None) -> None:
        """TOTAL_LAYER and CURRENT_LAYER. A total of 0 forgets both; the current layer is at most
        the total."""
        if total is not None:
            self.total, self.current = total or None, None
        if current is not None and total != 0:
            self.current = current if self.total is None else min(current, self.total)
