"""A small wired board on the test bench: two motors, a fan, a hotend, an endstop."""

from __future__ import annotations

from array import array
from dataclasses import dataclass, field

from tests.oracles.wire import step_clocks

from passo import _core
from passo.board.connection import Connection
from passo.board.description import (
    BoardDescription,
    Control,
    Endstop,
    Heater,
    Output,
    Sensor,
    Stepper,
)
from passo.board.ports import InProcess
from passo.simulator import Actuator, Body, PlantDescription, SimulatedBoard, Switch
from passo.simulator.dictionary import Firmware

HZ = 16_000_000
MS = HZ // 1000
START = 2**32 - HZ  # the 32-bit clock wraps one second after power-on

TABLE = ((0.0, 0.98), (25.0, 0.95), (100.0, 0.6), (200.0, 0.2), (300.0, 0.05))
PLANT = PlantDescription(
    actuators=(Actuator("x", 80.0, start=10.0), Actuator("y", 80.0)),
    switches=(Switch("x", (("x", 1.0),), position=0.0),),
    bodies=(Body("hotend", rise_c=300.0, time_constant_s=100.0),),
)


PID = _core.PidControl(kp=12.75, ki=0.51, kd=25.5)


def description(
    move_count: int = 1024, control: Control = PID, pwm: bool = False
) -> BoardDescription:
    """y turns the other way round; the hotend must be renewed within 3 s."""
    heat = (
        Output("hotend", "PB4", "pwm", 1000, max_duration_ticks=3 * HZ)
        if pwm
        else Output("hotend", "PB4", "digital", HZ // 10, max_duration_ticks=3 * HZ)
    )
    return BoardDescription(
        clock_hz=HZ,
        steppers=(Stepper("x", "PF0", "PF1"), Stepper("y", "PF6", "!PF7")),
        outputs=(
            Output("fan", "PH6", "digital", HZ // 100),
            heat,
            Output("light", "PH5", "pwm", 9),
        ),
        sensors=(Sensor("hotend", "PK5", TABLE, min_ratio=0.01, max_ratio=0.99),),
        heaters=(Heater("hotend", "hotend", "hotend", control),),
        endstops=(Endstop("x", "^PE5"),),
        move_count=move_count,
    )


class Kind:
    """What the simulated boards of the tests run: tests/simulator/conftest.py changes it."""

    firmware: Firmware = "virtual"


@dataclass
class Bench:
    """A connected simulated board."""

    board: BoardDescription = field(default_factory=description)

    def __post_init__(self) -> None:
        self.simulated = SimulatedBoard(self.board, PLANT, START, Kind.firmware)
        self.device = self.simulated.device
        self.connection = Connection(self.board, InProcess(self.device, START))
        self.connection.connect()
        self.link = self.connection.link

    def run(self, seconds: float) -> None:
        self.connection.run(self.connection.now + round(seconds * HZ))


class LateLink:
    """A link behind which reports of one kind arrive so much later."""

    def __init__(self, bench: Bench, report: str, seconds: float) -> None:
        self._bench, self._link = bench, bench.link
        self._report, self._ticks = report, round(seconds * HZ)
        self._held: list[tuple[int, tuple[str, dict]]] = []

    def __getattr__(self, name: str):
        return getattr(self._link, name)

    def take_responses(self):
        now = self._bench.connection.now
        for message in self._link.take_responses():
            late = self._ticks if message[0] == self._report else 0
            self._held.append((now + late, message))
        due = [message for clock, message in self._held if clock <= now]
        self._held = [entry for entry in self._held if entry[0] > now]
        return due


@dataclass
class Planner:
    """Fills a queue with steps, and keeps what the board is to execute."""

    queue: _core.MessageQueue = field(default_factory=_core.MessageQueue)
    clocks: dict[int, list[int]] = field(default_factory=dict)
    directions: dict[int, list[int]] = field(default_factory=dict)

    def steps(
        self, target: int, forward: bool, interval: int, count: int, add: int = 0, lead: int = 20
    ) -> None:
        """The command is due `lead` ms before its first step, or with the step before it."""
        clocks = self.clocks.setdefault(target, [])
        done = step_clocks(clocks[-1] if clocks else 0, interval, count, add)
        due = max(clocks[-1] if clocks else 0, done[0] - lead * MS)
        kind = _core.MessageKind
        self.queue.push(kind.SET_DIR, target, due, dir=forward)
        self.queue.push(kind.QUEUE_STEP, target, due, done[-1], interval, count, add, forward)
        clocks += done
        self.directions.setdefault(target, []).extend([1 if forward else -1] * count)

    def pin(self, target: int, clock: int, value: int) -> None:
        self.queue.push(_core.MessageKind.PIN, target, clock, clock, value)


def executed(bench: Bench, name: str, base: int) -> tuple[list[int], list[int]]:
    """Clocks since `base` and directions of the traced steps of a motor."""
    clocks, directions = bench.simulated.take_steps(name, 0, 2**62)
    return [c - base for c in array("q", clocks)], list(array("b", directions))
