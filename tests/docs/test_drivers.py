"""The machine files of docs/how-to/set-up-drivers.md are right."""

from __future__ import annotations

from pathlib import Path

import pytest
from tests.support.driver_machine import DRIVERS, machine_text

from passo import config

TEXT = (Path(__file__).parents[2] / "docs" / "how-to" / "set-up-drivers.md").read_text()
BLOCKS = [part.split("```")[0] for part in TEXT.split("```toml\n")[1:]]


@pytest.mark.parametrize("block", BLOCKS)
def test_the_examples_are_right(block: str):
    begin, end = DRIVERS.index("[steppers.x]"), DRIVERS.index("[steppers.y]")
    if "run_current_a" not in block:  # more keys of the table by SPI
        by_spi = next(other for other in BLOCKS if "cs_pin" in other)
        block = by_spi + block.removeprefix("[steppers.x.tmc]\n")
    if "driver =" not in block:
        block = '[steppers.x]\nsteps_per_mm = 80.0\nsocket = "X"\ndriver = "TMC5160"\n' + block
    # On their pins they are alone.
    others = DRIVERS[end:].replace("D40", "D16").replace("D2", "A1")
    for n, pin in enumerate(("A13", "A15", "A17", "A19")):
        others = others.replace(pin, f"D{31 + 2 * n}")
    machine = config.load_text(machine_text(DRIVERS[:begin] + block + others), "m.toml")
    assert machine.steppers["x"].tmc is not None
