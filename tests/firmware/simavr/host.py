"""The host's own code in front of a chip on the bench: the same connection, in the bench's time."""

from __future__ import annotations

from passo import _core
from passo.board.connection import Connection
from passo.board.description import BoardDescription

from .bench import AvrBench

QUANTUM = 8000


class BenchPump:
    """Stands where the native pump does: carries bytes between a link and a bench. What the chip
    says arrives at most `QUANTUM` cycles late."""

    def __init__(self, link: _core.Link, bench: AvrBench) -> None:
        self._link = link
        self._bench = bench
        self.now = bench.cycle
        self.heaters: dict[str, _core.Heater] = {}

    def run(self, until: int, until_heaters: bool = False) -> _core.PumpStop:
        while True:
            deadline = self._exchange()
            if self._link.shut_down:
                return _core.PumpStop.SHUTDOWN
            if any(h.fault is not None for h in self.heaters.values()):
                return _core.PumpStop.FAULT
            if until_heaters and all(h.target == 0 or h.reached for h in self.heaters.values()):
                return _core.PumpStop.HEATERS
            deadline = max(min(deadline, self.now + QUANTUM), self.now)
            if deadline > until:
                self.now = max(self.now, until)
                self._bench.run(self.now)
                return _core.PumpStop.TIME
            self.now = deadline

    def _exchange(self) -> int:
        while True:
            down, deadline = self._link.poll(self.now)
            self._bench.send(down)
            self._bench.run(self.now)
            up = self._bench.receive()
            if not up:
                return deadline
            self._link.feed(up, self.now)


class AvrConnection(Connection):
    """A connection to the chip on a bench."""

    def __init__(self, board: BoardDescription, bench: AvrBench) -> None:
        never_used = _core.VirtualBoard(float(board.clock_hz), 1, 1, 1, b"")
        super().__init__(board, never_used, bench.cycle)
        self.bench = bench
        self.pump = BenchPump(self.link, bench)
        self.pump.heaters = self.heaters
