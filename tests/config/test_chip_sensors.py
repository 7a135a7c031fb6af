"""Temperature sensors in microcontrollers: the typical values of their data sheets."""

import pytest

from passo.config.chip_sensors import chip_sensor_table
from passo.config.sensor_tables import share_at


@pytest.mark.parametrize(
    ("mcu", "volt", "celsius"),
    [
        ("rp2040", 0.706, 27.0),  # RP2040 data sheet, 4.9.5: T = 27 - (V - 0.706) / 0.001721
        ("rp2040", 0.706 - 0.001721 * 23, 50.0),
        ("stm32f103xe", 1.43, 25.0),  # DS5792, 5.3.21
        ("stm32f103xe", 1.215, 75.0),
        ("stm32f446xx", 0.76, 25.0),  # DS10693, 6.3.22
        ("stm32f446xx", 0.8225, 50.0),
        ("stm32h743xx", 0.62, 30.0),  # DS12110: 2 mV/°C
        ("stm32h743xx", 0.66, 50.0),
        ("sam3x8e", 0.8, 27.0),  # SAM3X: 2.65 mV/°C
        ("sam4e8e", 1.44, 27.0),  # SAM4E: 4.7 mV/°C
    ],
)
def test_voltage_of_a_chip_gives_its_temperature(mcu: str, volt: float, celsius: float) -> None:
    table = chip_sensor_table(mcu)
    assert table is not None
    rows = tuple((share, c) for c, share in table)
    assert share_at(tuple(sorted(rows)), volt / 3.3) == pytest.approx(celsius, abs=0.1)


@pytest.mark.parametrize("mcu", ["atmega2560", "linux", "lpc1769"])
def test_chip_without_a_sensor_has_no_table(mcu: str) -> None:
    assert chip_sensor_table(mcu) is None
