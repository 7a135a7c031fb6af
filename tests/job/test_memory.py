"""What a print leaves behind: nothing that would wait for Python to look for garbage."""

from __future__ import annotations

import gc
from pathlib import Path

from tests.console.scenario import Scenario

from passo.printer.commands.program import Commands

PRINT = "G92 X0 Y0 Z0 E0\nM302 P1\nM83\nG1 X10 E1 F3000\nG1 Y10 E1\n"


def test_the_plans_of_a_card_file_go_when_it_is_done(tmp_path: Path) -> None:
    card = tmp_path / "card"
    card.mkdir()
    (card / "a.g").write_text(PRINT)
    with Scenario(card=str(card)) as s:

        def prints() -> None:
            s.host.send("M23 a.g", "M24")
            s.host.expect("Done printing", within=60)

        prints()
        gc.collect()
        before = plans()
        gc.disable()
        try:
            prints()
            assert plans() == before
        finally:
            gc.enable()


def plans() -> int:
    return sum(isinstance(x, Commands) for x in gc.get_objects())
