"""The policy of a print for lines that it cannot execute."""

from __future__ import annotations

from dataclasses import dataclass

from passo.printer.unfit_commands import ALL, Skips


@dataclass(frozen=True, slots=True)
class Policy:
    """The policy of a print for lines that it cannot execute. `clamp` and `ignore_tools` accept
    moves out of range and missing tools; with False the print fails.

    With `checked`, the print makes the checks of the served printer: axes must be homed before they
    move, hotends must be warm before filament moves, and no command may be refused. Without it, for
    a fragment of G-code, the machine counts as homed and warm, and refused commands are warnings.
    `skips` are commands that the print skips with a warning, instead of failing before the first
    move. With `motion_only`, the commands of the file that set filters of the motion or need a
    probe are left out: the filters of the machine file hold, and the bed is flat.
    """

    clamp: bool = False
    ignore_tools: bool = False
    checked: bool = False
    skips: Skips = ALL
    motion_only: bool = False
