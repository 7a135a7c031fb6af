"""All simulated boards of one machine behind one interface: each call goes to the board of its
part."""

from __future__ import annotations

from array import array
from bisect import bisect_left
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from passo import _core
from passo.board.description import together
from passo.config.probing import PROBE
from passo.simulator.board import SimulatedBoard
from passo.simulator.plant import Area

_LATE = 1 << 48  # ticks: years


@dataclass(frozen=True, slots=True)
class Cable:
    """The transmission time of bytes each way: `latency_s` to `latency_s` + `jitter_s`."""

    latency_s: float = 0.0
    jitter_s: float = 0.0


class SimulatedMachine:
    """All simulated boards of a machine, the main one first. Its methods are those of
    `SimulatedBoard`; connections use `devices`, by the names of the boards.

    The main board's clock is host time, and all clocks here are clocks of the main board. `clocks`
    gives, for each further board, its clock at the start, in seconds, and its deviation of
    frequency, in ppm.
    """

    def __init__(
        self,
        boards: Mapping[str, SimulatedBoard],
        clocks: Mapping[str, tuple[float, float]] | None = None,
        cable: Cable | None = None,
    ) -> None:
        self.boards = dict(boards)
        self.board = together({name: board.board for name, board in boards.items()})
        self._main = next(iter(self.boards.values()))
        self.device = self._main.device
        self.devices: dict[str, _core.Bench | _core.Distant] = {
            n: b.device for n, b in boards.items()
        }
        self.drivers = {m: chip for b in boards.values() for m, chip in b.drivers.items()}
        self.stalls = {m: part for b in boards.values() for m, part in b.stalls.items()}
        self.sensor_chips = {n: c for b in boards.values() for n, c in b.sensor_chips.items()}
        self.widths = {name: b for b in boards.values() for name in b.widths}
        self._distant: dict[SimulatedBoard, _core.Distant] = {}
        self._own: dict[tuple[str, str], SimulatedBoard] = {}
        for number, (name, board) in enumerate(boards.items()):
            board.feel(boards.values())
            for part in (
                *("steppers", "outputs", "sensors", "endstops", "counters", "lights"),
                *("analog_inputs", "eddies"),
            ):
                for entry in getattr(board.board, part):
                    self._own[part, entry.name] = board
            for name_of_input in board.board.input_names:
                self._own["inputs", name_of_input] = board
            clock = (clocks or {}).get(name)
            if clock or cable:
                start_s, drift_ppm = clock or (0.0, 0.0)
                hz, delay = board.board.clock_hz, cable or Cable()
                self._distant[board] = self.devices[name] = _core.Distant(
                    board.device,
                    round(start_s * hz),
                    drift_ppm * 1e-6,
                    round(delay.latency_s * hz),
                    round(delay.jitter_s * hz),
                    number + 1,
                )

    def cut_cable(self, board: str, on: bool = True) -> None:
        """A fault: bytes to and from a board are lost; False ends it. Raises KeyError for a board
        without a simulated cable."""
        self._distant[self.boards[board]].cut(on)

    def spoil_cable(self, board: str, share: float) -> None:
        """A fault: this fraction of all bytes is corrupted; 0 ends it. Raises KeyError for a board
        without a simulated cable."""
        self._distant[self.boards[board]].spoil(share)

    def _of(self, part: str, name: str) -> SimulatedBoard:
        return self._own[part, name]

    def _main_clock(self, board: SimulatedBoard, clock: int) -> int:
        """The main board's clock when `board`'s reads `clock`."""
        distant = self._distant.get(board)
        host = clock if distant is None else distant.host_at(clock)
        hz, main_hz = board.board.clock_hz, self._main.board.clock_hz
        return host if hz == main_hz else round(host * main_hz / hz)

    def _own_clock(self, board: SimulatedBoard, clock: int) -> int:
        distant = self._distant.get(board)
        hz, main_hz = board.board.clock_hz, self._main.board.clock_hz
        host = clock if hz == main_hz else round(clock * hz / main_hz)
        return host if distant is None else distant.clock_at(host)

    def net_steps(self, stepper: str) -> int:
        """Steps that the motor has executed so far, forward minus backward. Raises KeyError if the
        host has not configured the motor yet."""
        return self._of("steppers", stepper).net_steps(stepper)

    def steps(self, stepper: str) -> int:
        """Number of steps executed so far, in both directions."""
        return self._of("steppers", stepper).steps(stepper)

    def position(self, stepper: str) -> float:
        """The position of the stepper's actuator now, mm or degrees."""
        return self._of("steppers", stepper).position(stepper)

    def place(self, stepper: str, position: float) -> None:
        """Moves the stepper's actuator to `position` (mm or degrees), as if by hand."""
        self._of("steppers", stepper).place(stepper, position)

    def temperature(self, sensor: str) -> float:
        """Temperature of the body that the sensor belongs to, °C."""
        return self._of("sensors", sensor).temperature(sensor)

    def force_sensor(self, sensor: str, ratio: float | None) -> None:
        """A fault: the ADC reads this fraction of full scale at any temperature; None ends it."""
        self._of("sensors", sensor).force_sensor(sensor, ratio)

    def force_switch(self, endstop: str, pressed: bool | None) -> None:
        """A fault: the endstop is triggered or open at any position; None ends it."""
        self._of("endstops", endstop).force_switch(endstop, pressed)

    def force_input(self, name: str, active: bool | None) -> None:
        """The input has this level, whatever is wired to it; None ends it."""
        self._of("inputs", name).force_input(name, active)

    def force_reading(self, name: str, share: float | None) -> None:
        """The analog input has this reading, of full scale; None ends it."""
        self._of("analog_inputs", name).force_reading(name, share)

    def force_width(self, name: str, diameter_mm: float | None) -> None:
        """The filament in a width sensor has this diameter; None: the nominal one."""
        self.widths[name].force_width(name, diameter_mm)

    def flicker(self, name: str) -> None:
        """A fault: the level of the input changes every 5 ms, until `force_input`."""
        self._of("inputs", name).flicker(name)

    def force_rotor(self, counter: str, *, stalled: bool = False, silent: bool = False) -> None:
        """Faults: the rotor of a fan does not turn, or its tachometer gives no pulses."""
        self._of("counters", counter).force_rotor(counter, stalled=stalled, silent=silent)

    def rotor_rpm(self, counter: str) -> float:
        """The revolutions per minute of a fan."""
        return self._of("counters", counter).rotor_rpm(counter)

    def light(self, light: str) -> bytes:
        """The bytes that a chain of lights shows; none before its first frame."""
        return self._of("lights", light).light(light)

    def led_chip(self, light: str) -> _core.LedChip:
        """The chip that sets the LEDs of a light."""
        return self._of("lights", light).led_chips[light]

    def trace_light(self, light: str) -> None:
        """Records, from now on, the frames of a chain, for `take_light`."""
        self._of("lights", light).trace_light(light)

    def take_light(self, light: str) -> list[tuple[int, bytes]]:
        """(clock of the main board, bytes) of each frame since the last call."""
        board = self._of("lights", light)
        return [(self._main_clock(board, clock), data) for clock, data in board.take_light(light)]

    def fail_light(self, light: str, frames: int) -> None:
        """A fault: the board cannot send so many of the next frames in time."""
        self._of("lights", light).fail_light(light, frames)

    def spoil_probe(
        self,
        *,
        dead_areas: Sequence[Area] = (),
        touchy_areas: Sequence[Area] = (),
        noise_mm: float = 0.0,
        jammed: bool = False,
    ) -> None:
        """Injects faults of the probe from now on: areas where it never triggers, areas where it is
        always triggered, and the standard deviation of its height, mm. `jammed`: it cannot be
        deployed."""
        self._board_of_probe.spoil_probe(
            dead_areas=dead_areas, touchy_areas=touchy_areas, noise_mm=noise_mm, jammed=jammed
        )

    @property
    def _board_of_probe(self) -> SimulatedBoard:
        part = "eddies" if ("eddies", PROBE) in self._own else "endstops"
        return self._of(part, PROBE)

    def break_coil(self, sensor: str, *, open_coil: bool = False, silent: bool = False) -> None:
        """A fault of an eddy current sensor: its coil is broken, or its chip does not answer."""
        chip = self._of("eddies", sensor).eddies[sensor]
        chip.open, chip.plugged = open_coil, not silent

    def tilt_bed(self, rise_mm: float) -> None:
        """A fault: the bed rises by `rise_mm` more over its width; 0 ends it."""
        self._board_of_probe.tilt_bed(rise_mm)

    def force_heater(self, sensor: str, power: float | None) -> None:
        """A fault: the heater of this sensor has this power, 0 to 1, independent of its pin; None
        ends it."""
        self._of("sensors", sensor).force_heater(sensor, power)

    def add_noise(self, sensor: str, share: float) -> None:
        """A fault: the ADC has noise of up to this fraction of full scale; 0 ends it."""
        self._of("sensors", sensor).add_noise(sensor, share)

    def drop_sensor(self, sensor: str, fallen: bool = True) -> None:
        """A fault: the sensor is detached and has room temperature; False ends it."""
        self._of("sensors", sensor).drop_sensor(sensor, fallen)

    def trace_steps(self, stepper: str, from_clock: int, to_clock: int) -> None:
        """Records, from now on, the commands with steps in from_clock…to_clock, for
        `take_steps`."""
        board = self._of("steppers", stepper)
        begin, end = (self._own_clock(board, clock) for clock in (from_clock, to_clock))
        board.trace_steps(stepper, begin, end)

    def take_steps(self, stepper: str, from_clock: int, to_clock: int) -> tuple[bytes, bytes]:
        """Clocks (int64) and directions (int8, +1 forward) of the traced steps executed since the
        last call and within from_clock ≤ clock < to_clock."""
        board = self._of("steppers", stepper)
        if board is self._main:
            return board.take_steps(stepper, from_clock, to_clock)
        own, directions = board.take_steps(stepper, 0, 2**62)
        clocks = array("q", (self._main_clock(board, clock) for clock in array("q", own)))
        first, end = bisect_left(clocks, from_clock), bisect_left(clocks, to_clock)
        return clocks[first:end].tobytes(), directions[first:end]

    def take_commands(self, stepper: str) -> list[tuple[int, int, int, int, int]]:
        """(start clock, interval, count, add, direction ±1) of the traced commands executed since
        the last call; the first step comes `interval` after the start. All are ticks of the
        stepper's own board: see `main_clock`."""
        return self._of("steppers", stepper).take_commands(stepper)

    def main_clock(self, stepper: str, clock: int) -> int:
        """The main board's clock when the clock of the stepper's board reads `clock`."""
        return self._main_clock(self._of("steppers", stepper), clock)

    def own_clock(self, stepper: str, clock: int) -> int:
        """The clock of the stepper's board when the main board's clock reads `clock`."""
        return self._own_clock(self._of("steppers", stepper), clock)

    def carry_accelerometers(self, head: _core.HeadDynamics) -> None:
        """Lets all accelerometers measure the motion of this head."""
        for board in self.boards.values():
            first, last = self._main_clock(board, 0), self._main_clock(board, _LATE)
            for chip in board.accelerometers:
                chip.ride(head, (last - first) / _LATE, first)

    def motor(self, stepper: str) -> tuple[_core.Bench, int, float, float, float]:
        """Like `SimulatedBoard.motor`, followed by two values of the motor's board: the length of
        its tick in ticks of the main board, and the main board's clock when its clock is 0."""
        board = self._of("steppers", stepper)
        first, last = self._main_clock(board, 0), self._main_clock(board, _LATE)
        return *board.motor(stepper), (last - first) / _LATE, first

    def trace_output(self, output: str) -> None:
        """Records, from now on, the changes of an output, for `take_changes`."""
        self._of("outputs", output).trace_output(output)

    def take_changes(self, output: str) -> list[tuple[int, int]]:
        """(clock, value) of each change since the last call."""
        board = self._of("outputs", output)
        return [(self._main_clock(board, c), value) for c, value in board.take_changes(output)]

    def output_value(self, output: str) -> int:
        """The output's value now."""
        return self._of("outputs", output).output_value(output)
