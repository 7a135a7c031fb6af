"""The cable of a board that cannot stop by itself goes silent in mid-print, and is not closed."""

import random
from functools import partial

import pytest
from tests.job.test_journal import WALL, journal_of
from tests.support.scenario import Scenario

from passo.printer.setup.connections import connect_simulated
from passo.simulator import Cable

E_OF_LINE = {
    number: float(line.split(" E")[1].split()[0])
    for number, line in enumerate(WALL.split("\n"), 1)
    if " E" in line
}


@pytest.mark.parametrize("seed", range(4))
def test_undelivered_commands_do_not_count_as_printed(monkeypatch, tmp_path, seed):
    monkeypatch.setattr(
        "passo.printer.printer.connect", partial(connect_simulated, cable=Cable(300e-6, 200e-6))
    )
    (tmp_path / "card").mkdir()
    (tmp_path / "card" / "wall.gcode").write_text(WALL)
    with Scenario("i3", card=str(tmp_path / "card"), state=str(tmp_path / "state")) as s:
        s.host.ok("M32 wall.gcode")
        start_mm = random.Random(seed).uniform(1, 8)
        assert s.until(lambda: s.positions()["e"] > start_mm, 200)
        (board,) = s.board.boards
        s.board.spoil_cable(board, 1.0)
        s.host.expect("Printer halted: the board does not answer", 10)
        printed_mm, z_mm = s.positions()["e"], s.positions()["z"]
        assert start_mm < printed_mm < start_mm + 0.5
        moment = journal_of(tmp_path / "state")[1]
        before = max(e for line, e in E_OF_LINE.items() if line < moment.line)
        assert printed_mm - 0.6 < before <= printed_mm
        assert moment.z_mm == pytest.approx(z_mm, abs=0.05)
