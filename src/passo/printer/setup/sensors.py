"""The descriptions of temperature sensors, from a machine file."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.board.description import I2cPins, I2cSensor, Sensor
from passo.config.chip_sensors import PIN, chip_sensor_table
from passo.config.i2c_sensors import I2cSensor as I2cSensorConfig
from passo.config.pin_names import MAIN, placed
from passo.config.sensor_tables import (
    converter_of,
    converter_setup,
    open_is_high,
    sensor_table,
    share_at,
)
from passo.config.shown_sensors import ChipSensor, CombinedSensor, HostSensor
from passo.printer.setup.drivers import converter_wires

if TYPE_CHECKING:
    from collections.abc import Iterator

    from passo.config.heat import Heater as HeaterConfig
    from passo.config.machine import MachineConfig
    from passo.config.sensors import AnySensor


def sensor_of(machine: MachineConfig, name: str, heater: HeaterConfig) -> Sensor:
    """The description of a heater's sensor; also used for `Connection.set_sensor`."""
    table = sensor_table(heater.sensor)
    low, high = sorted((share_at(table, heater.min_c), share_at(table, heater.max_c)))
    return _sensor(machine, name, heater.sensor, heater.sensor_pin, (low, high))


def shown_sensors(machine: MachineConfig, board: str) -> Iterator[Sensor]:
    """The sensors of a board that no heater uses. The board reads them over their whole range: the
    host decides about readings beyond `min_c` and `max_c`."""
    for name, shown in machine.sensors.items():
        sensor, pin = shown.sensor, shown.sensor_pin
        if isinstance(sensor, ChipSensor):
            table = chip_sensor_table(machine.all_boards[board].mcu)
            if (sensor.board or MAIN) == board and table is not None:
                yield Sensor(name, PIN, table, of_chip=True)
        elif isinstance(sensor, HostSensor | CombinedSensor | I2cSensorConfig):
            continue
        elif pin and placed(pin)[0] == board:
            yield _sensor(machine, name, sensor, pin, (0.0, 1.0))


def i2c_sensors_of(machine: MachineConfig, board: str) -> Iterator[I2cSensor]:
    """The sensor chips on the I2C buses of a board."""
    for name, shown in machine.sensors.items():
        sensor = shown.sensor
        if not isinstance(sensor, I2cSensorConfig) or sensor.written_board != board:
            continue
        scl, sda = (machine.pin(pin) if pin else "" for pin in (sensor.scl_pin, sensor.sda_pin))
        bus = placed(sensor.i2c_bus)[1] if sensor.i2c_bus else ""
        wire = I2cPins(scl, sda, sensor.used_address, sensor.i2c_hz, bus)
        yield I2cSensor(name, sensor.kind, wire, sensor.period_s, shown.ambient_c)


def _sensor(
    machine: MachineConfig, name: str, sensor: AnySensor, pin: str, range_: tuple[float, float]
) -> Sensor:
    """A sensor that shuts the board down outside of a range, in fractions of full scale."""
    setup = converter_setup(sensor)
    return Sensor(
        name,
        machine.pin(pin),
        sensor_table(sensor),
        *range_,
        open_is_high(sensor),
        converter_of(sensor),
        converter_wires(machine, sensor, pin),
        setup.words,
        setup.clears_faults,
    )
