"""The tables of docs/how-to/use-filament-sensors.md are right."""

import re
from pathlib import Path

from passo.config.load import load_text, shipped_text

PAGE = Path(__file__).parents[2] / "docs" / "how-to" / "use-filament-sensors.md"


def test_tables_are_those_of_a_machine_file():
    tables = "\n".join(re.findall(r"```toml\n(.*?)```", PAGE.read_text(), re.DOTALL))
    machine = load_text(f"{shipped_text('i3')}\n{tables}", "i3.toml")
    assert list(machine.filament_sensors) == ["roll", "encoder", "meter"]
    assert list(machine.buttons) == ["door", "stop", "light", "up", "down"]
