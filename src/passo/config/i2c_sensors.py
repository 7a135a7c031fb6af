"""Temperature sensors on an I2C bus, which may also measure humidity and pressure."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, Literal, NamedTuple, TypeAlias, get_args

from pydantic import Field

from passo.config.buses import BUS, I2C_WIRES, check_bus
from passo.config.findings import Finding, did_you_mean, table, tables
from passo.config.pin_names import placed
from passo.config.types import Model, Pin

I2cKind: TypeAlias = Literal[
    "bme280",
    "bmp280",
    "bmp180",
    "bme680",
    "htu21d",
    "si7013",
    "si7020",
    "si7021",
    "sht21",
    "sht3x",
    "aht1x",
    "aht2x",
    "aht3x",
    "lm75",
]
I2C_KINDS: tuple[str, ...] = get_args(I2cKind)


class I2cFamily(NamedTuple):
    """What chips of a family have in common: Klipper's name for an object of theirs, the usual
    address, and the option of Klipper for the time between two readings."""

    name: str
    address: int
    report_option: str = ""


_BOSCH = I2cFamily("bme280", 0x76)
_HTU = I2cFamily("htu21d", 0x40, "htu21d_report_time")
_AHT = I2cFamily("aht10", 0x38, "aht10_report_time")
FAMILIES: Mapping[str, I2cFamily] = {
    **dict.fromkeys(("bme280", "bmp280", "bme680"), _BOSCH),
    "bmp180": _BOSCH._replace(address=0x77),
    **dict.fromkeys(("htu21d", "si7013", "si7020", "si7021", "sht21"), _HTU),
    "sht3x": I2cFamily("sht3x", 0x44),
    **dict.fromkeys(("aht1x", "aht2x", "aht3x"), _AHT),
    "lm75": I2cFamily("lm75", 0x48, "lm75_report_time"),
}


class I2cSensor(Model):
    """A sensor chip on an I2C bus: on two pins, or on `i2c_bus` of a board with Klipper's firmware.
    A chip that does not answer is reported, and stops nothing."""

    kind: I2cKind
    """A sensor chip on I2C: of temperature (`lm75`), with humidity (`htu21d`, `si7013`, `si7020`,
    `si7021`, `sht21`, `sht3x`, `aht1x`, `aht2x`, `aht3x`), with pressure (`bmp180`, `bmp280`), with
    both (`bme280`, `bme680`)."""
    scl_pin: Pin | None = None
    """The clock of the I2C bus, which other chips may share. Its board is the board of the chip."""
    sda_pin: Pin | None = None
    """The data of the I2C bus."""
    i2c_bus: Annotated[str, Field(pattern=BUS)] | None = None
    """The bus in the words of Klipper's firmware, such as `i2c1` or `rpi:i2c.1`, in place of the
    two pins."""
    address: Annotated[int, Field(ge=1, le=127)] | None = None
    """The address of the chip. If not given, the usual one of its kind."""
    i2c_hz: Annotated[int, Field(ge=10_000, le=400_000)] = 100_000
    """The clock of the I2C bus, in Hz. A lower one allows longer wires."""
    period_s: Annotated[float, Field(ge=0.5, le=300)] = 2.0
    """The time between two readings, in s. Frequent readings warm some chips."""

    @property
    def written_board(self) -> str:
        """The name of the board of the chip."""
        return placed(self.scl_pin or self.i2c_bus or "")[0]

    @property
    def used_address(self) -> int:
        """The address of the chip."""
        return FAMILIES[self.kind].address if self.address is None else self.address


def check_i2c_sensors(data: Mapping[str, Any]) -> Iterator[Finding]:
    """Checks that each chip has a bus, and that no two chips have one address on the same bus."""
    owners: dict[tuple[object, ...], str] = {}
    for name, shown in tables(data, "sensors"):
        sensor, path = table(shown, "sensor"), ("sensors", name, "sensor")
        kind = sensor.get("kind")
        if kind not in I2C_KINDS:
            continue
        yield from check_bus(data, path, sensor, "i2c_bus")
        bus, boards = sensor.get("i2c_bus"), table(data, "boards")
        if isinstance(bus, str) and (board := placed(bus)[0]) and board not in boards:
            limit, hint = (
                "the name of one of the boards before the colon",
                did_you_mean(board, boards),
            )
            yield Finding("config.value", (*path, "i2c_bus"), bus, limit, hint)
        address = sensor.get("address", FAMILIES[str(kind)].address)
        place = (*(sensor.get(key) for key in ("i2c_bus", *I2C_WIRES)), address)
        owner = owners.setdefault(place, name)
        if owner != name:
            limit = f"an address of its own: sensors.{owner} has this one"
            yield Finding("config.conflict", (*path, "address"), address, limit)
