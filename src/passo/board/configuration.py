"""The commands that configure a board according to its description."""

from __future__ import annotations

import zlib
from collections.abc import Hashable, Iterable
from dataclasses import dataclass, replace
from typing import TypeVar

from passo import _core
from passo.board.description import (
    BoardDescription,
    Eddy,
    Heater,
    I2cPins,
    Input,
    Output,
    Sensor,
    SpiPins,
    UartPins,
    bare,
    inverted,
)
from passo.board.dictionary import Dictionary
from passo.board.inputs import RETRANSMIT_COUNT, SAMPLE_S, groups_of, inversion
from passo.board.lights import BIT_MAX_S, RESET_S, SLOW_BIT_MAX_S
from passo.config.chip_sensors import chip_sensor_table

_Key = TypeVar("_Key", bound=Hashable)

SENSOR_SAMPLES = 8
SENSOR_SAMPLE_S = 0.001
SENSOR_PERIOD_S = 0.25
SENSOR_RANGE_CHECKS = 4
COUNTER_PERIOD_S = 1.0

_UART_BAUD = 40_000
_SLOW_UART_BAUD = 9_000  # the minimum that the drivers support
_FAST_HZ = 20_000_000


@dataclass(frozen=True, slots=True)
class Oids:
    """The object number of each part of the board, in this order: steppers, outputs, sensors,
    endstops, trsyncs, UARTs, SPI devices, I2C devices, accelerometers, groups of inputs, analog
    inputs, counters, chains of lights, eddy current sensors with their triggers and filters. A
    trsync is the group of motors on this board that one endstop stops; the endstop may be on
    another board. UARTs, devices and accelerometers are found by their pins."""

    steppers: dict[str, int]
    outputs: dict[str, int]
    sensors: dict[str, int]
    endstops: dict[str, int]
    trsyncs: dict[str, int]
    uarts: dict[UartPins, int]
    spi_devices: dict[SpiPins, int]
    i2c_devices: dict[I2cPins, int]
    accelerometers: dict[SpiPins | I2cPins, int]
    inputs: dict[tuple[Input, ...], int]
    analog_inputs: dict[str, int]
    counters: dict[str, int]
    chains: dict[str, int]
    eddies: dict[str, int]
    triggers: dict[str, int]
    filters: dict[str, int]
    count: int

    @classmethod
    def of(cls, board: BoardDescription) -> Oids:
        """Numbers all objects of a board from 0; equal descriptions get equal numbers."""
        count = 0

        def numbered(names: Iterable[_Key]) -> dict[_Key, int]:
            nonlocal count
            numbers = {name: count + i for i, name in enumerate(names)}
            count += len(numbers)
            return numbers

        return cls(
            numbered(s.name for s in board.steppers),
            numbered(o.name for o in board.outputs),
            numbered(s.name for s in board.sensors),
            numbered(e.name for e in board.endstops),
            numbered(
                [e.name for e in (*board.endstops, *board.eddies)] + [*board.endstops_elsewhere]
            ),
            numbered(board.uarts),
            numbered(board.spi_devices),
            numbered(board.i2c_devices),
            numbered(a.wire for a in board.accelerometers),
            numbered(groups_of(board.inputs)),
            numbered(a.name for a in board.analog_inputs),
            numbered(c.name for c in board.counters),
            numbered(light.name for light in board.chains),
            numbered(e.name for e in board.eddies),
            numbered(e.name for e in board.eddies),
            numbered(e.name for e in board.eddies),
            count,
        )


def full_scale(output: Output, dictionary: Dictionary) -> int:
    """The value of an output that means fully on."""
    if output.kind == "pwm":
        return dictionary.number("PWM_MAX", 255)
    return max(output.cycle_ticks, 1)


def on_wire(output: Output, share: float, full: int) -> int:
    """The value that a board receives for a fraction of fully on, whose value is `full`."""
    value = round(share * full)
    return full - value if inverted(output.pin) else value


def sensors_known_to(board: BoardDescription, dictionary: Dictionary) -> BoardDescription:
    """The board without a sensor of its chip that its firmware cannot read, or with that of the
    chip that the firmware names."""
    pins = dictionary.enumerations.get("pin", {})
    table = chip_sensor_table(str(dictionary.constants.get("MCU", "")))
    read = [
        replace(s, table=table) if s.of_chip and table else s
        for s in board.sensors
        if not s.of_chip or (bare(s.pin) in pins and table)
    ]
    return replace(board, sensors=tuple(read)) if any(s.of_chip for s in board.sensors) else board


def commands(board: BoardDescription, dictionary: Dictionary) -> list[str]:
    """The configuration commands as text, from `allocate_oids` on, without `finalize_config`."""
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
        f"config_analog_in oid={oids.sensors[s.name]} pin={bare(s.pin)}"
        for s in board.sensors
        if s.spi is None
    ]
    lines += [
        f"config_endstop oid={oids.endstops[e.name]} pin={bare(e.pin)} pull_up={int('^' in e.pin)}"
        for e in board.endstops
    ]
    lines += [f"config_trsync oid={oid}" for oid in oids.trsyncs.values()]
    for pins, oid in oids.uarts.items():
        lines.append(
            f"config_tmcuart oid={oid} rx_pin={bare(pins.rx_pin)} pull_up={int('^' in pins.rx_pin)}"
            f" tx_pin={bare(pins.tx_pin)} bit_time={uart_bit_ticks(board.clock_hz)}"
        )
    for pins, oid in oids.spi_devices.items():
        lines += _spi_device(pins, oid, board.clock_hz, dictionary)
    for pins, oid in oids.i2c_devices.items():
        lines += _i2c_device(pins, oid, board.clock_hz, dictionary)
    # Only firmware of early versions of Passo has this parameter.
    early = dictionary.takes("config_thermocouple", "consecutive_fault_limit")
    limit = f" consecutive_fault_limit={SENSOR_RANGE_CHECKS - 1}" if early else ""
    for s in board.sensors:
        if s.spi is not None:
            lines.append(
                f"config_thermocouple oid={oids.sensors[s.name]}"
                f" spi_oid={oids.spi_devices[s.spi]} thermocouple_type={s.converter.name}{limit}"
            )
    for a in board.accelerometers:
        oid = oids.accelerometers[a.wire]
        if isinstance(a.wire, SpiPins):
            bus, kind = oids.spi_devices[a.wire], "spi"
        else:
            bus, kind = oids.i2c_devices[a.wire], "i2c"
        if a.chip == "adxl345":
            lines.append(f"config_adxl345 oid={oid} spi_oid={bus}")
        else:
            lines.append(
                f"config_lis2dw oid={oid} bus_oid={bus} bus_oid_type={kind} lis_chip_type=LIS2DW"
            )
    for group, oid in oids.inputs.items():
        lines.append(f"config_buttons oid={oid} button_count={len(group)}")
        lines += [
            f"buttons_add oid={oid} pos={i} pin={bare(entry.pin)} pull_up={int('^' in entry.pin)}"
            for i, entry in enumerate(group)
        ]
    lines += [
        f"config_analog_in oid={oids.analog_inputs[a.name]} pin={bare(a.pin)}"
        for a in board.analog_inputs
    ]
    lines += [
        f"config_counter oid={oids.counters[c.name]} pin={bare(c.pin)} pull_up={int('^' in c.pin)}"
        for c in board.counters
    ]
    lines += [
        f"config_neopixel oid={oids.chains[light.name]} pin={light.wire} data_size={light.size}"
        f" bit_max_ticks={bit_max_ticks(board.clock_hz)}"
        f" reset_min_ticks={int(RESET_S * board.clock_hz)}"
        for light in board.chains
    ]
    for e in board.eddies:
        lines += _eddy(e, oids, dictionary)
    return lines


def bit_max_ticks(clock_hz: int) -> int:
    """The longest bit of a chain of lights, within which an interrupt of a slow board fits."""
    return int((BIT_MAX_S if clock_hz >= _FAST_HZ else SLOW_BIT_MAX_S) * clock_hz)


def uart_bit_ticks(clock_hz: int) -> int:
    """The length of a bit on the drivers' UARTs: longer on slow boards, and a multiple of the four
    samples in which the firmware finds the beginning of an answer."""
    baud = _UART_BAUD if clock_hz >= _FAST_HZ else _SLOW_UART_BAUD
    return clock_hz // baud // 4 * 4


def _spi_device(pins: SpiPins, oid: int, clock_hz: int, dictionary: Dictionary) -> list[str]:
    if pins.bus:
        device = f"config_spi oid={oid} pin={bare(pins.cs_pin)} cs_active_high=0"
        if not pins.cs_pin:
            device = f"config_spi_without_cs oid={oid}"
        return [device, f"spi_set_bus oid={oid} spi_bus={pins.bus} mode={pins.mode} rate={pins.hz}"]
    wires = (
        f"miso_pin={bare(pins.miso_pin)} mosi_pin={bare(pins.mosi_pin)}"
        f" sclk_pin={bare(pins.clock_pin)} mode={pins.mode}"
    )
    if dictionary.takes("spi_set_sw_bus", "pulse_ticks"):
        bus = f"spi_set_sw_bus oid={oid} {wires} pulse_ticks={clock_hz // (2 * pins.hz)}"
    else:  # older firmware
        bus = f"spi_set_software_bus oid={oid} {wires} rate={pins.hz}"
    if not pins.cs_pin:
        return [f"config_spi_without_cs oid={oid}", bus]
    return [f"config_spi oid={oid} pin={bare(pins.cs_pin)} cs_active_high=0", bus]


def _i2c_device(pins: I2cPins, oid: int, clock_hz: int, dictionary: Dictionary) -> list[str]:
    if pins.bus:
        bus = f"i2c_set_bus oid={oid} i2c_bus={pins.bus} rate={pins.hz} address={pins.address}"
        return [f"config_i2c oid={oid}", bus]
    wires = f"scl_pin={bare(pins.scl_pin)} sda_pin={bare(pins.sda_pin)}"
    if dictionary.takes("i2c_set_sw_bus", "pulse_ticks"):
        ticks = clock_hz // (2 * pins.hz)
        bus = f"i2c_set_sw_bus oid={oid} {wires} pulse_ticks={ticks} address={pins.address}"
    else:  # older firmware
        bus = f"i2c_set_software_bus oid={oid} {wires} rate={pins.hz} address={pins.address}"
    return [f"config_i2c oid={oid}", bus]


def has_triggers(dictionary: Dictionary) -> bool:
    """Whether a board compares the values of all its sensors in one way. Klipper's firmware before
    2026 has commands of its own for each."""
    return dictionary.takes("config_trigger_analog", "sos_filter_oid")


def _eddy(part: Eddy, oids: Oids, dictionary: Dictionary) -> list[str]:
    oid, bus = oids.eddies[part.name], oids.i2c_devices[part.wire]
    if part.intb_pin:
        first = f"config_ldc1612_with_intb oid={oid} i2c_oid={bus} intb_pin={bare(part.intb_pin)}"
    else:
        first = f"config_ldc1612 oid={oid} i2c_oid={bus}"
    if not has_triggers(dictionary):
        return [first]
    trigger, filtered = oids.triggers[part.name], oids.filters[part.name]
    return [
        first,
        f"config_sos_filter oid={filtered} max_sections=0",
        f"config_trigger_analog oid={trigger} sos_filter_oid={filtered}",
        f"ldc1612_attach_trigger_analog oid={oid} trigger_analog_oid={trigger}",
    ]


def _output(output: Output, oid: int, full: int) -> list[str]:
    start, at_halt = (on_wire(output, share, full) for share in (output.start, output.at_halt))
    if output.kind == "pwm":
        return [
            f"config_pwm_out oid={oid} pin={bare(output.pin)} cycle_ticks={output.cycle_ticks}"
            f" value={start} default_value={at_halt}"
            f" max_duration={output.max_duration_ticks}"
        ]
    lines = [
        f"config_digital_out oid={oid} pin={bare(output.pin)} value={int(start == full)}"
        f" default_value={int(at_halt == full)} max_duration={output.max_duration_ticks}"
    ]
    if output.cycle_ticks:
        lines.append(f"set_digital_out_pwm_cycle oid={oid} cycle_ticks={output.cycle_ticks}")
    return lines


def checksum(lines: list[str]) -> int:
    """CRC-32 of the configuration's text. A board that reports the same CRC has the same
    configuration."""
    return zlib.crc32("\n".join(lines).encode())


def queries(board: BoardDescription, dictionary: Dictionary, clock: int) -> list[str]:
    """The commands that follow the configuration: they set values that are set once, start outputs
    that blink, and start the sensors' reports. The first report is due at board clock `clock`; the
    sensors' reports are evenly spread."""
    oids = Oids.of(board)
    # Older firmware has no parameter for the number of bytes of a report.
    size = " bytes_per_report=2" if dictionary.takes("query_analog_in", "bytes_per_report") else ""
    # Klipper's firmware before v0.11 has no parameter for the number of faults.
    counts = dictionary.takes("query_thermocouple", "max_invalid_count")
    count = f" max_invalid_count={SENSOR_RANGE_CHECKS}" if counts else ""
    lines = [
        f"spi_send oid={oids.spi_devices[setting.spi]} data={word.hex()}"
        for setting in board.settings
        for word in setting.words
    ]
    for i, sensor in enumerate(board.sensors):
        begin = clock + int(SENSOR_PERIOD_S * board.clock_hz * i / len(board.sensors))
        q = sensor_query(board, sensor, dictionary)
        if sensor.spi is not None:
            spi = oids.spi_devices[sensor.spi]
            lines += [f"spi_send oid={spi} data={word.hex()}" for word in sensor.setup]
            lines.append(
                f"query_thermocouple oid={oids.sensors[sensor.name]} clock={begin & 0xFFFFFFFF}"
                f" rest_ticks={q.rest_ticks} min_value={q.minimum} max_value={q.maximum}{count}"
            )
            continue
        lines.append(
            f"query_analog_in oid={oids.sensors[sensor.name]} clock={begin & 0xFFFFFFFF}"
            f" sample_ticks={q.sample_ticks} sample_count={q.sample_count}"
            f" rest_ticks={q.rest_ticks}{size}"
            f" min_value={q.minimum} max_value={q.maximum} range_check_count={q.range_checks}"
        )
    lines += [
        f"queue_digital_out oid={oids.outputs[o.name]} clock={clock & 0xFFFFFFFF}"
        f" on_ticks={o.cycle_ticks // 2}"
        for o in board.outputs
        if o.blinks
    ]
    lines += [
        f"buttons_query oid={oid} clock={clock & 0xFFFFFFFF}"
        f" rest_ticks={int(SAMPLE_S * board.clock_hz)} retransmit_count={RETRANSMIT_COUNT}"
        f" invert={inversion(group)}"
        for group, oid in oids.inputs.items()
    ]
    lines += [
        f"query_analog_in oid={oids.analog_inputs[a.name]} clock={clock & 0xFFFFFFFF}"
        f" sample_ticks={int(SENSOR_SAMPLE_S * board.clock_hz)} sample_count={SENSOR_SAMPLES}"
        f" rest_ticks={int(a.period_s * board.clock_hz)}{size}"
        f" min_value=0 max_value={0xFFFF} range_check_count=0"
        for a in board.analog_inputs
    ]
    lines += [
        f"query_counter oid={oids.counters[c.name]} clock={clock & 0xFFFFFFFF}"
        f" poll_ticks={int(c.poll_s * board.clock_hz)}"
        f" sample_ticks={int(COUNTER_PERIOD_S * board.clock_hz)}"
        for c in board.counters
    ]
    return lines


def adc_full(dictionary: Dictionary) -> int:
    """The value of a sensor's report, which is a sum of samples, at the ADC's full scale."""
    return dictionary.number("ADC_MAX", 1023) * SENSOR_SAMPLES


def sensor_query(
    board: BoardDescription, sensor: Sensor, dictionary: Dictionary
) -> _core.SensorQuery:
    """The command that makes the board sample a sensor."""
    if sensor.spi is not None:
        words = _core.converter_words(sensor.converter, sensor.min_ratio, sensor.max_ratio)
        return _core.SensorQuery(
            sample_ticks=0,
            sample_count=0,
            rest_ticks=int(SENSOR_PERIOD_S * board.clock_hz),
            minimum=words[0],
            maximum=words[1],
            range_checks=SENSOR_RANGE_CHECKS,
        )
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
    """The settings of a heater's control loop for the core, in units of this board."""
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
        adc_full=_core.converter_full(sensor.converter) if sensor.spi else adc_full(dictionary),
        query=sensor_query(board, sensor, dictionary),
        longest_s=output.max_duration_ticks / board.clock_hz,
        max_power=heater.max_power,
        arrival=heater.arrival,
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
        converter=sensor.converter,
        spi_oid=oids.spi_devices[sensor.spi] if sensor.spi else 0,
        clears_faults=sensor.clears_faults,
        further=[
            (oids.outputs[o.name], inverted(o.pin))
            for o in board.outputs
            if o.name in heater.further
        ],
    )
