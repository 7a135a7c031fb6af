"""A whole printer on the simulated chip homes: fast, back, and slowly onto each switch."""

from __future__ import annotations

from dataclasses import replace

import pytest
from tests.support.scenario import Scenario

from passo import config
from passo.board.boards import Boards
from passo.board.description import bare
from passo.printer.setup.boards import board_description
from passo.toolchain.avr import AvrBoard, Motor

from .bench import AvrBench
from .boards import image
from .host import AvrConnection

AWAY_MM = {"x": 7.0, "y": 4.0, "z": 1.0}
SENSORS = (13, 14)
SWITCHES = {"x": "PE5", "y": "PJ1", "z": "PD3"}


def test_a_printer_finds_its_switches(monkeypatch: pytest.MonkeyPatch) -> None:
    machine = config.load("i3")
    description = replace(board_description(machine), survives=None)
    pins = {s.name: (bare(s.step_pin), bare(s.dir_pin)) for s in description.steppers}
    bench = AvrBench(image(AvrBoard("atmega2560", tuple(Motor(*p) for p in pins.values()))).elf)
    for channel in SENSORS:
        bench.set_voltage(channel, 4.75)
    per_mm = {name: machine.steppers[name].steps_per_unit for name in AWAY_MM}
    carriages = {
        name: bench.add_carriage(*pins[name], round(mm * per_mm[name]), SWITCHES[name])
        for name, mm in AWAY_MM.items()
    }

    def on_bench(_: object) -> tuple[Boards, AvrBench]:
        connection = AvrConnection(description, bench)
        connection.connect()
        return Boards([connection]), bench

    monkeypatch.setattr("passo.printer.printer.connect", on_bench)
    with Scenario(machine) as scenario:
        host = scenario.host
        assert host.ok("M119")[1:4] == ["x_min: open", "y_min: open", "z_min: open"]
        host.ok("G28", 60)
        assert host.ok("M119")[1:4] == [f"{name}_min: TRIGGERED" for name in AWAY_MM]
        found = {name: bench.position(carriage) for name, carriage in carriages.items()}
        assert all(-4 <= at < 0 for at in found.values()), found
        for name, mm in AWAY_MM.items():
            # To the switch, back by 3 mm, to it again; a few more until it is noticed.
            way = round((mm + 2 * 3.0) * per_mm[name])
            assert way < bench.rises(pins[name][0]) <= way + 12, name
        assert "X:0.000 Y:0.000 Z:0.000" in host.ok("M114")[0]
        host.ok("G1 X5 Y2.5 Z1 F3000")
        host.ok("M400")
        moved = {name: bench.position(c) - found[name] for name, c in carriages.items()}
        assert moved == {"x": 400, "y": 200, "z": 400}
