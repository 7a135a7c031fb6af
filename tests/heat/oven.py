"""The heaters of an i3 on a simulated board, with a fan that cools its hotend."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from passo import _core, config
from passo.board.faults import HeaterFault
from passo.printer.setup.connections import connect

HOTEND = "max_c = 285.0\n"
BED = "max_c = 120.0\n"
FAN_LOSS = 0.3


@dataclass
class Oven:
    """`hotend` and `bed` are further lines of these heaters' tables. `rows` are (s, °C of the body,
    °C of the sensor, power) of the heater `name`, every quarter of a second of `run`."""

    hotend: str = ""
    bed: str = ""
    name: str = "hotend"
    rows: list[tuple[float, float, float, float]] = field(default_factory=list)
    faults: list[HeaterFault] = field(default_factory=list)

    def __post_init__(self) -> None:
        text = config.shipped_text("i3")
        text = text.replace(HOTEND, f"{HOTEND}{self.hotend}\n", 1)
        text = text.replace(BED, f"{BED}{self.bed}\n", 1)
        self.machine = config.load_text(text)
        boards, self.board = connect(self.machine)
        self.connection = boards.main
        self.connection.on_fault = lambda _, fault: self.faults.append(fault)
        self.hz = self.machine.board.clock_hz
        self.heater = self.connection.heaters[self.name]
        self.queue = _core.MessageQueue()
        self.base = self.connection.start_job(self.queue)
        self.start = self.connection.now

    @property
    def now_s(self) -> float:
        return (self.connection.now - self.start) / self.hz

    def run(self, seconds: float) -> list[tuple[float, float, float, float]]:
        """Lets time pass; returns the rows of it."""
        begin = len(self.rows)
        for _ in range(round(4 * seconds)):
            self.connection.run(self.connection.now + self.hz // 4)
            body = self.board.temperature(self.name)
            self.rows.append((self.now_s, body, self.heater.celsius, self.heater.power))
        return self.rows[begin:]

    def run_until(self, condition: Callable[[], bool], limit_s: float = 600.0) -> float:
        """Lets time pass until the condition holds; returns how long it took."""
        begin = self.now_s
        while not condition():
            assert self.now_s < begin + limit_s
            self.run(0.25)
        return self.now_s - begin

    def heat(self, celsius: float) -> None:
        self.connection.set_target(self.name, celsius)

    def blow(self, speed: float) -> None:
        """The fan, as a job commands it."""
        names = [output.name for output in self.connection.board.outputs]
        clock = self.connection.now - self.base + self.hz // 4
        value = round(speed * self.connection.full_scale("part"))
        self.queue.push(_core.MessageKind.PIN, names.index("part"), clock, clock, value)

    def output(self) -> int:
        return self.board.output_value(self.name)
