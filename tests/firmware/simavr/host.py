"""The host's own code in front of a chip on the bench: the same connection, in the bench's time."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

from passo import _core
from passo.board.connection import Connection
from passo.board.description import BoardDescription, Sensor

from .bench import AvrBench

QUANTUM = 8000
WORLD = 160_000


class BenchPump:
    """Stands where the native pump does: carries bytes between a link and a bench. What the chip
    says arrives at most `QUANTUM` cycles late. `world` is called every `WORLD` cycles."""

    def __init__(self, link: _core.Link, bench: AvrBench) -> None:
        self._link = link
        self._bench = bench
        self.now = bench.cycle
        self.hz = link.hz
        self.heaters: dict[str, _core.Heater] = {}
        self.world: list[Callable[[], None]] = []
        self._next_world = bench.cycle
        self._faults: dict[str, int] = {}

    def board_clock(self, _: _core.Link) -> int:
        return self.now

    def run(self, until: int, until_heaters: bool = False) -> _core.Stop:
        shut_down = self._link.shut_down  # asked further, it needs time to answer
        while True:
            deadline = self._exchange()
            if self._link.shut_down and not shut_down:
                return _core.Stop.SHUTDOWN
            faults = {name: h.fault.clock for name, h in self.heaters.items() if h.fault}
            if faults != self._faults:
                self._faults = faults
                return _core.Stop.FAULT
            if until_heaters and all(h.target == 0 or h.reached for h in self.heaters.values()):
                return _core.Stop.HEATERS
            deadline = max(min(deadline, self.now + QUANTUM), self.now)
            if deadline > until:
                self.now = max(self.now, until)
                self._bench.run(self.now)
                return _core.Stop.SHUTDOWN if shut_down else _core.Stop.TIME
            self.now = deadline
            if self.now >= self._next_world:
                self._next_world += WORLD
                for part in self.world:
                    part()

    def _exchange(self) -> int:
        while True:
            down, deadline = self._link.poll(self.now)
            self._bench.send(down)
            self._bench.run(self.now)
            up = self._bench.receive()
            if not up:
                return deadline
            self._link.feed(up, self.now)


class BenchPort:
    """A bench as a connection sees it."""

    live = False
    byte_s = 0.0
    pump: BenchPump

    def __init__(self, bench: AvrBench) -> None:
        self._bench = bench

    def attach(self, link: _core.Link) -> BenchPump:
        self.pump = BenchPump(link, self._bench)
        return self.pump


class AvrConnection(Connection):
    """A connection to the chip on a bench."""

    def __init__(self, board: BoardDescription, bench: AvrBench) -> None:
        port = BenchPort(bench)
        super().__init__(board, port)
        self.bench, self.pump = bench, port.pump
        self.pump.heaters = self.heaters


class Hotend:
    """A heated body with a thermistor: `rise_c` above the room at full power, reached with a time
    constant. Called by the pump."""

    def __init__(
        self,
        bench: AvrBench,
        pin: str,
        channel: int,
        sensor: Sensor,
        celsius: float = 25.0,
        rise_c: float = 300.0,
        time_constant_s: float = 10.0,
    ) -> None:
        self._bench, self._pin, self._channel = bench, pin, channel
        self._table = sensor.table
        self._room_c, self._rise_c, self._time_constant_s = 25.0, rise_c, time_constant_s
        self._then, self._high = bench.cycle, bench.high_cycles(pin)
        self.celsius = celsius
        self._show()

    def __call__(self) -> None:
        now, high = self._bench.cycle, self._bench.high_cycles(self._pin)
        seconds = (now - self._then) / self._bench.hz
        duty = (high - self._high) / max(now - self._then, 1)
        self._then, self._high = now, high
        balance = self._room_c + duty * self._rise_c - self.celsius
        self.celsius += balance * seconds / self._time_constant_s
        self._show()

    def _show(self) -> None:
        below, above = next(
            (a, b) for a, b in pairwise(self._table) if self.celsius <= b[0] or b == self._table[-1]
        )
        share = (self.celsius - below[0]) / (above[0] - below[0])
        self._bench.set_voltage(self._channel, 5.0 * (below[1] + share * (above[1] - below[1])))
