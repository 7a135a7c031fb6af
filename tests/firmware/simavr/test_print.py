"""A minute of a sliced file, printed by the host's code on the simulated chip: every step."""

from __future__ import annotations

import lzma
from array import array
from dataclasses import dataclass, replace
from pathlib import Path

from passo import config
from passo.board.boards import Boards
from passo.board.description import bare, inverted
from passo.job.batch.simulated_print import Print
from passo.printer.setup.boards import board_description
from passo.toolchain.avr import AvrBoard, Motor

from .bench import RISES, AvrBench
from .boards import image
from .host import AvrConnection, Hotend

DEMO = Path(__file__).parents[3] / "examples" / "demo.gcode.xz"
SLOW = ("M104", "M109", "M140", "M190", "G4", "G28")
MOVES = 700
RAM_BEGIN = 0x200
STACK_SPARE = 300
CHANNELS = {"PK5": 13, "PK6": 14}


def _program(path: Path) -> Path:
    """The file's first moves; heaters and fan run, but nothing waits for heat."""
    lines = lzma.decompress(DEMO.read_bytes()).decode().splitlines()
    kept = [line for line in lines if not line.startswith(SLOW)]
    moves = [i for i, line in enumerate(kept) if line.startswith("G1")]
    path.write_text(
        "M104 S150\nM140 S50\nM106 S200\nG28\n" + "\n".join(kept[: moves[MOVES]]) + "\n"
    )
    return path


@dataclass
class Traced:
    """What a print looks at of the board: counts; and the steps as they were made."""

    bench: AvrBench
    connection: AvrConnection

    def __post_init__(self) -> None:
        board = self.connection.board
        self.pins = {s.name: bare(s.step_pin) for s in board.steppers}
        self.carriages = {
            s.name: self.bench.add_carriage(bare(s.step_pin), bare(s.dir_pin))
            for s in board.steppers
        }
        self.turned = {s.name: s.invert != inverted(s.dir_pin) for s in board.steppers}
        self.cycles = {s.name: array("q") for s in board.steppers}
        self._names = {pin: name for name, pin in self.pins.items()}
        self.bench.watch(self.pins.values(), RISES)
        self.connection.pump.world.append(self.collect)

    def collect(self) -> None:
        for edge in self.bench.edges():
            self.cycles[self._names[edge.pin]].append(edge.cycle)

    def steps(self, stepper: str) -> int:
        return self.bench.rises(self.pins[stepper])

    def net_steps(self, stepper: str) -> int:
        steps = self.bench.position(self.carriages[stepper])
        return -steps if self.turned[stepper] else steps


def _expected(machine, path):
    """The clocks of all steps, from the start of the job, and the print's result."""
    printing = Print(machine)
    printing.trace_until(1e6)
    result = printing.run(path)
    clocks = {}
    for stepper in printing.connection.board.steppers:
        rows = printing.board.take_steps(stepper.name, 0, 2**62)[0]
        clocks[stepper.name] = [clock - printing.base for clock in array("q", rows)]
    return clocks, result


def test_a_minute_of_a_print_is_exact(tmp_path, monkeypatch):
    machine = config.load("i3")
    path = _program(tmp_path / "minute.gcode")
    clocks, expected = _expected(machine, path)
    description = replace(board_description(machine), survives=None)
    motors = tuple(Motor(bare(s.step_pin), bare(s.dir_pin)) for s in description.steppers)
    board = AvrBoard("atmega2560", motors)
    bench = AvrBench(image(board).elf)
    bodies = []
    for heater in description.heaters:
        output = next(o for o in description.outputs if o.name == heater.output)
        sensor = next(s for s in description.sensors if s.name == heater.sensor)
        real = machine.heaters[heater.name].simulated
        bodies.append(
            Hotend(
                bench,
                output.pin,
                CHANNELS[sensor.pin],
                sensor,
                rise_c=real.full_power_rise_c,
                time_constant_s=real.time_constant_s,
            )
        )

    def on_bench(_):
        connection = AvrConnection(description, bench)
        connection.connect()
        connection.pump.world += bodies
        return Boards([connection]), Traced(bench, connection)

    monkeypatch.setattr("passo.job.batch.simulated_print.connect_simulated", on_bench)
    # This bench keeps no steps for the first layer.
    monkeypatch.setattr(Print, "_watch_first_layer", lambda _: None)
    printing = Print(machine)
    result = printing.run(path)
    traced = printing.board
    traced.collect()
    assert result.errors == []
    assert result.print_time_s >= 60
    assert result.stream_hash == expected.stream_hash
    assert result.steps == expected.steps
    assert result.final_steps == expected.final_steps
    for name, cycles in traced.cycles.items():
        late = sorted(c - clock for c, clock in zip(cycles, clocks[name], strict=True))
        assert late[len(late) * 99 // 100] - late[0] <= 250, name
        assert late[-1] - late[0] <= 900, name  # when alarms of several parts coincide
    assert bench.rescues > 0
    # The stack grows down from the end of the memory, towards the static data.
    bottom = RAM_BEGIN + image(board).ram
    assert not any(bench.ram(bottom + i) for i in range(STACK_SPARE))
    assert sum(result.steps.values()) > 120_000
