"""The commands that turn a bare board into the one that a description asks for."""

from __future__ import annotations

import zlib
from collections.abc import Iterable
from dataclasses import dataclass

from passo import _core
from passo.board.description import BoardDescription, Heater, Output, Sensor, bare, inverted
from passo.board.dictionary import Dictionary

SENSOR_SAMPLES = 8
SENSOR_SAMPLE_S = 0.001
SENSOR_PERIOD_S = 0.25
SENSOR_RANGE_CHECKS = 4


@dataclass(frozen=True, slots=True)
class Oids:
    """Numbers of the board's objects: steppers, outputs, sensors, endstops, then a trsync for each
    endstop, on this board or elsewhere: the group of motors here that it stops."""

    steppers: dict[str, int]
    outputs: dict[str, int]
    sensors: dict[str, int]
    endstops: dict[str, int]
    trsyncs: dict[str, int]
    count: int

    @classmethod
    def of(cls, board: BoardDescription) -> Oids:
        """Numbers from 0 for all objects of a board, the same for the same description."""
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
            numbered([*(e.name for e in board.endstops), *board.endstops_elsewhere]),
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
    on = int(output.default_on != inverted(output.pin))
    if output.kind == "pwm":
        return [
            f"config_pwm_out oid={oid} pin={bare(output.pin)} cycle_ticks={output.cycle_ticks}"
            f" value={on * full} default_value={on * full}"
            f" max_duration={output.max_duration_ticks}"
        ]
    lines = [
        f"config_digital_out oid={oid} pin={bare(output.pin)} value={on} default_value={on}"
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
    # Older firmware does not ask how many bytes make a report.
    size = " bytes_per_report=2" if dictionary.takes("query_analog_in", "bytes_per_report") else ""
    lines: list[str] = []
    for i, sensor in enumerate(board.sensors):
        begin = clock + int(SENSOR_PERIOD_S * board.clock_hz * i / len(board.sensors))
        q = sensor_query(board, sensor, dictionary)
        lines.append(
            f"query_analog_in oid={oids.sensors[sensor.name]} clock={begin & 0xFFFFFFFF}"
            f" sample_ticks={q.sample_ticks} sample_count={q.sample_count}"
            f" rest_ticks={q.rest_ticks}{size}"
            f" min_value={q.minimum} max_value={q.maximum} range_check_count={q.range_checks}"
        )
    return lines


def adc_full(dictionary: Dictionary) -> int:
    """A sensor's report (sum of its samples) at the ADC's full scale."""
    return dictionary.number("ADC_MAX", 1023) * SENSOR_SAMPLES


def sensor_query(
    board: BoardDescription, sensor: Sensor, dictionary: Dictionary
) -> _core.SensorQuery:
    """How the board is asked to sample a sensor."""
    full = adc_full(dictionary)
    return _core.SensorQuery(
        sample_ticks=int(SENSOR_SAMPLE_S * board.clock_hz),
        sample_count=SENSOR_SAMPLES,
        rest_ticks=int(SENSOR_PERIOD_S * board.clock_hz),
        minimum=int(sensor.min_ratio * full),
        maximum=int(sensor.max_ratio * full),
        range_checks=SENSOR_RANGE_CHECKS,
    )


def heater_options(
    board: BoardDescription, heater: Heater, dictionary: Dictionary
) -> _core.HeaterOptions:
    """What the loop of a heater must know."""
    oids = Oids.of(board)
    output = next(o for o in board.outputs if o.name == heater.output)
    sensor = next(s for s in board.sensors if s.name == heater.sensor)
    fans = [o for o in board.outputs if o.name == heater.fan]
    table = sorted((ratio, celsius) for celsius, ratio in sensor.table)
    return _core.HeaterOptions(
        sensor_oid=oids.sensors[sensor.name],
        output_oid=oids.outputs[output.name],
        pwm=output.kind == "pwm",
        full=full_scale(output, dictionary),
        adc_full=adc_full(dictionary),
        query=sensor_query(board, sensor, dictionary),
        max_power=heater.max_power,
        tolerance_c=heater.tolerance_c,
        celsius=table,
        low_share=table[0][0],
        high_share=table[-1][0],
        open_is_high=sensor.open_is_high,
        control=heater.control,
        limits=heater.limits,
        model=heater.model,
        fan_target=board.output_targets[board.outputs.index(fans[0])] if fans else -1,
        fan_full=full_scale(fans[0], dictionary) if fans else 1,
        inverted=inverted(output.pin),
    )
