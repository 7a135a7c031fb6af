"""The text of a loaded machine: it describes the same machine, without its secrets."""

import pytest

from passo.config import load, shipped_machines
from passo.config.load import load_text
from passo.config.machine_text import HIDDEN, machine_text


@pytest.mark.parametrize("name", shipped_machines())
def test_machine_written_as_text_loads_equal(name):
    machine = load(name)
    text = machine_text(machine)
    assert text.count(HIDDEN) == 1
    assert machine.uuid not in text
    assert load_text(text.replace(HIDDEN, f'"{machine.uuid}"')) == machine
