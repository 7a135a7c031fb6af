"""The samples that a board reads from a chip at the rate of the chip, and reports in blocks."""

from __future__ import annotations

from statistics import fmean
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from passo.board.connection import Connection
    from passo.board.exchange import Values

_REPORTS = ("sensor_bulk_data", "sensor_bulk_status")
_SEQUENCES = 1 << 16
_BLOCK_BYTES = 51
_SLOW = 2.0  # a status that took this many times as long as the quickest one has no exact clock
_KEPT = 600  # states, for the times


class BulkSamples:
    """The samples of one run, each of `size` bytes. Missing ones repeat the block before them.
    `lost` counts them; `overflows` counts those of the FIFO of the chip: each has lost a sample."""

    def __init__(self, size: int) -> None:
        self._size, self._per_block = size, _BLOCK_BYTES // size
        self._blocks: list[bytes] = []
        self._points: list[tuple[float, int, int]] = []  # clock, samples before it, ticks it took
        self.lost = self.overflows = 0

    @property
    def count(self) -> int:
        """The number of samples so far."""
        return len(self._blocks) * self._per_block

    @property
    def data(self) -> bytes:
        """All samples."""
        return b"".join(self._blocks)

    def since(self, first: int) -> list[bytes]:
        """The samples from the number `first` on."""
        block, skipped = divmod(first, self._per_block)
        data, size = b"".join(self._blocks[block:]), self._size
        return [data[i : i + size] for i in range(skipped * size, len(data), size)]

    def take(self, connection: Connection, oid: int, base: int) -> None:
        """Takes the reports of the object `oid` that have arrived. `base` is the main board's clock
        at print time 0."""
        for name, values in connection.take_responses(*_REPORTS):
            if values["oid"] != oid:
                continue
            if name == "sensor_bulk_data":
                self._take_block(values)
            else:
                self._take_state(connection, values, base)

    def _take_block(self, values: Values) -> None:
        data, sequence = values["data"], values["sequence"]
        assert isinstance(data, bytes) and isinstance(sequence, int)
        missing = (sequence - len(self._blocks)) % _SEQUENCES
        if missing >= _SEQUENCES // 2:
            return  # of an earlier run
        self.lost += missing * self._per_block
        before = self._blocks[-1] if self._blocks else bytes(self._per_block * self._size)
        self._blocks += [before] * missing
        self._blocks.append(data)

    def _take_state(self, connection: Connection, values: Values, base: int) -> None:
        clock, sequence, buffered, ticks = (
            int(values[key]) for key in ("clock", "next_sequence", "buffered", "query_ticks")
        )
        blocks = len(self._blocks) + (sequence - len(self._blocks) + _SEQUENCES // 2) % _SEQUENCES
        blocks -= _SEQUENCES // 2
        samples = blocks * self._per_block + buffered // self._size
        self.overflows = int(values["possible_overflows"])
        main = connection.main_clock(clock & 0xFFFFFFFF)
        self._points.append((main - base, samples, ticks))
        del self._points[:-_KEPT]

    def times(self) -> tuple[float, float]:
        """The print time of the first sample, in ticks of the main board, and the samples in a
        tick: a line through the states that the board has read quickly. The last of the samples so
        far was taken half an interval before, on average. (0, 0) with too few states."""
        quickest = min((ticks for _, _, ticks in self._points), default=0)
        used = [(c, n - 0.5) for c, n, ticks in self._points if ticks <= _SLOW * quickest]
        if len(used) < 2:
            return 0.0, 0.0
        mean_t, mean_n = fmean(t for t, _ in used), fmean(n for _, n in used)
        square = sum((t - mean_t) ** 2 for t, _ in used)
        rate = sum((t - mean_t) * (n - mean_n) for t, n in used) / square if square else 0.0
        return (mean_t - mean_n / rate if rate else 0.0), rate
