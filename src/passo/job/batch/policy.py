"""The policy of a print for lines that it cannot carry out."""

from __future__ import annotations

from dataclasses import dataclass

from passo.printer.unfit_commands import ALL, Skips


@dataclass(frozen=True, slots=True)
class Policy:
    """The policy of a print for lines that it cannot carry out. `clamp` and `ignore_tools` accept
    moves out of range and missing tools; with False the print fails.

    `checked` makes the checks of the served printer: axes must be homed before they move, hotends
    must be warm before filament moves, and no command may be refused. Without it the machine counts
    as homed and warm, for a piece of G-code, and refused commands are warnings. `skips` are
    commands that the print leaves out with a warning instead of failing before the first move.
    """

    clamp: bool = False
    ignore_tools: bool = False
    checked: bool = False
    skips: Skips = ALL
