"""A converter of a thermocouple, asked by a real chip over pins of its own."""

from __future__ import annotations

import pytest

from passo import _core
from passo.board.description import BoardDescription, Sensor, SpiPins
from passo.errors import MachineError

from .boards import HZ, bench
from .host import AvrConnection

TABLE = ((-270.0, 0.434), (1800.0, 0.939))
SPI = SpiPins("PH3", "PH4", "PH5", "PH6", mode=0)


def test_converter_words_and_faults_are_reported():
    chip = bench()
    sensor = Sensor("t", "PH3", TABLE, converter=_core.Converter.MAX31855, spi=SPI)
    connection = AvrConnection(BoardDescription(HZ, sensors=(sensor,)), chip)
    chip.set_pin("PH6", False)
    connection.connect()
    chip.watch(["PH4"], 2)
    before = chip.rises("PH4")
    connection.run(connection.now + HZ)
    words = connection.take_responses("thermocouple_result")
    assert [values["value"] for _, values in words] == [0] * len(words)
    assert 3 <= len(words) <= 5
    assert (chip.rises("PH4") - before) % 32 == 0
    chip.set_pin("PH6", True)
    with pytest.raises(MachineError, match="Thermocouple ADC out of range"):
        connection.run(connection.now + 2 * HZ)
    chip.close()
