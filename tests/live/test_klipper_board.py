"""Passo's host on a board that speaks as Klipper's firmware does, which is no work of Passo's."""

from __future__ import annotations

import asyncio
import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from tests.config.test_pins import KLIPPER
from tests.support.klipper_board import KlipperBoard, dictionary, on_its_pins
from tests.support.scenario import Scenario

from passo import config
from passo.config.machine import MachineConfig
from passo.printer.setup.connections import with_reported_clocks


@pytest.fixture(params=["avr", "stm32, newer", "linux"])
def board(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[KlipperBoard]:
    chip, _, newer = request.param.partition(", ")
    told = dictionary(chip=chip, newer=bool(newer))
    analog = round(0.95 * told["config"]["ADC_MAX"])  # some 25 °C
    board = KlipperBoard(told, tmp_path, analog)
    yield board
    board.close()


def machine(board: KlipperBoard, folder: Path) -> MachineConfig:
    (folder / "board.dict").write_text(json.dumps(board.told))
    text = on_its_pins(KLIPPER + f'link = "serial"\nport = "{board.path}"\n', board.told)
    return config.load_text(text, str(folder / "my.toml"))


def test_klipper_firmware_moves_heats_and_resets(board: KlipperBoard, tmp_path: Path) -> None:
    it = machine(board, tmp_path)
    with Scenario(it, loop=asyncio.new_event_loop()) as scenario:
        host, connection = scenario.host, scenario.printer.rig.connection
        assert not connection.main.survives
        assert re.search(r"T:2\d\.\d+ /0", host.ok("M105")[0])
        host.ok("M302 P1")
        host.ok("G92 X0 Y0 Z0 E0")
        for i in range(8):
            host.send(f"G1 X{10 if i % 2 else 0} Y{i / 4} E{i / 10} F9000")
        host.send("M104 S60", "M106 S128", "M400", "M118 done")
        host.expect("done", 30.0)
        assert scenario.printer.state.halted == ""
        oids = connection.main.oids
        steps = {name: board.steps.get(oid, 0) for name, oid in oids.steppers.items()}
        assert steps == {"x": 800, "y": 140, "z": 0, "e": round(0.7 * 95.5)}
        hot, fan = (oids.outputs[name] for name in ("hotend", "part"))
        scenario.until(lambda: bool(_values(board, "queue_digital_out", hot)), 5.0)
        assert _values(board, "queue_digital_out", hot)[-1]["on_ticks"] > 0
        cycle = _values(board, "set_digital_out_pwm_cycle", fan)[0]["cycle_ticks"]
        half = _values(board, "queue_digital_out", fan)[-1]["on_ticks"]
        assert half == pytest.approx(cycle * 128 / 255, abs=1)
        assert (board.is_config, board.crc) == (1, _values(board, "finalize_config")[0]["crc"])
        assert board.resets == 0
        host.send("M112")
        host.expect("Printer halted", 5.0)
        assert board.is_shutdown == 1
        host.send("M999")
        host.expect("ready again", 20.0)
        assert (board.resets, board.is_shutdown, board.is_config) == (1, 0, 1)
    assert board.wrong == []
    assert len(board.of_oid) == board.oids == 19


def test_clock_that_no_file_gives_is_that_of_the_firmware(
    board: KlipperBoard, tmp_path: Path
) -> None:
    text = KLIPPER.replace('dictionary = "board.dict"', 'link = "serial"')
    text = on_its_pins(f'{text}port = "{board.path}"\n', board.told)
    it = with_reported_clocks(config.load_text(text, str(tmp_path / "my.toml")))
    assert it.board.clock_hz == board.told["config"]["CLOCK_FREQ"]
    with Scenario(it, loop=asyncio.new_event_loop()) as scenario:
        host, x = scenario.host, scenario.printer.rig.connection.main.oids.steppers["x"]
        host.ok("G92 X0")
        began = scenario.printer.rig.connection.now
        host.send("G1 X30 F600", "M400", "M118 done")
        host.expect("done", 20.0)
        passed_s = (scenario.printer.rig.connection.now - began) / it.board.clock_hz
        assert board.steps[x] == 2400
        assert 3.0 < passed_s < 6.0
    assert board.wrong == []


def _values(board: KlipperBoard, name: str, oid: int | None = None) -> list[dict[str, Any]]:
    return [v for said, v in board.said if said == name and v.get("oid") == oid]
