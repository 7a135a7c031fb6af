"""The commands that turn a bare board into the one that a description asks for."""

from __future__ import annotations

import zlib
from collections.abc import Iterable
from dataclasses import dataclass

from passo.board.description import BoardDescription, Output, bare, inverted
from passo.board.dictionary import Dictionary

SENSOR_SAMPLES = 8
SENSOR_SAMPLE_S = 0.001
SENSOR_PERIOD_S = 0.25
SENSOR_RANGE_CHECKS = 4


@dataclass(frozen=True, slots=True)
class Oids:
    """Numbers of the board's objects: steppers, outputs, sensors, endstops, then a trsync for each
    endstop: the group of motors that it stops."""

    steppers: dict[str, int]
    outputs: dict[str, int]
    sensors: dict[str, int]
    endstops: dict[str, int]
    trsyncs: dict[str, int]
    count: int

    @classmethod
    def of(cls, board: BoardDescription) -> Oids:
        count = 0

        def numbered(names: Iterable[str]) -> dict[str, int]:
            nonlocal count
            numbers = {name: count + i for i, name in enumerate(names)}
            count += len(numbers)
            return numbers

        return cls(
            numbered(s.name for s in board.steppers),
            numbered(o.name for o in board.outputs),
            numbered(s.name for s in board.sensors),
            numbered(e.name for e in board.endstops),
            numbered(e.name for e in board.endstops),
            count,
        )


def full_scale(output: Output, dictionary: Dictionary) -> int:
    """The value that means fully on."""
    if output.kind == "pwm":
        return dictionary.number("PWM_MAX", 255)
    return max(output.cycle_ticks, 1)


def commands(board: BoardDescription, dictionary: Dictionary) -> list[str]:
    """The configuration as text, `allocate_oids` first, without `finalize_config`."""
    oids = Oids.of(board)
    lines = [f"allocate_oids count={oids.count}"]
    for s in board.steppers:
        lines.append(
            f"config_stepper oid={oids.steppers[s.name]} step_pin={bare(s.step_pin)}"
            f" dir_pin={bare(s.dir_pin)} invert_step={int(inverted(s.step_pin))}"
            f" step_pulse_ticks={s.pulse_ticks}"
        )
    for o in board.outputs:
        lines += _output(o, oids.outputs[o.name], full_scale(o, dictionary))
    lines += [
        f"config_analog_in oid={oids.sensors[s.name]} pin={bare(s.pin)}" for s in board.sensors
    ]
    lines += [
        f"config_endstop oid={oids.endstops[e.name]} pin={bare(e.pin)} pull_up={int('^' in e.pin)}"
        for e in board.endstops
    ]
    lines += [f"config_trsync oid={oid}" for oid in oids.trsyncs.values()]
    return lines


def _output(output: Output, oid: int, full: int) -> list[str]:
    on = int(output.default_on)
    if output.kind == "pwm":
        return [
            f"config_pwm_out oid={oid} pin={output.pin} cycle_ticks={output.cycle_ticks}"
            f" value={on * full} default_value={on * full}"
            f" max_duration={output.max_duration_ticks}"
        ]
    lines = [
        f"config_digital_out oid={oid} pin={output.pin} value={on} default_value={on}"
        f" max_duration={output.max_duration_ticks}"
    ]
    if output.cycle_ticks:
        lines.append(f"set_digital_out_pwm_cycle oid={oid} cycle_ticks={output.cycle_ticks}")
    return lines


def checksum(lines: list[str]) -> int:
    """CRC-32 of the configuration's text: a board that reports it is configured alike."""
    return zlib.crc32("\n".join(lines).encode())


def queries(board: BoardDescription, dictionary: Dictionary, clock: int) -> list[str]:
    """Starts the reports of every sensor, the first at board clock `clock`, evenly spread."""
    oids = Oids.of(board)
    full = dictionary.number("ADC_MAX", 1023) * SENSOR_SAMPLES
    hz = board.clock_hz
    lines: list[str] = []
    for i, sensor in enumerate(board.sensors):
        begin = clock + int(SENSOR_PERIOD_S * hz * i / len(board.sensors))
        lines.append(
            f"query_analog_in oid={oids.sensors[sensor.name]} clock={begin & 0xFFFFFFFF}"
            f" sample_ticks={int(SENSOR_SAMPLE_S * hz)} sample_count={SENSOR_SAMPLES}"
            f" rest_ticks={int(SENSOR_PERIOD_S * hz)} bytes_per_report=2"
            f" min_value={int(sensor.min_ratio * full)} max_value={int(sensor.max_ratio * full)}"
            f" range_check_count={SENSOR_RANGE_CHECKS}"
        )
    return lines
