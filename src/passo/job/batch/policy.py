"""What a print does where it cannot do what its file says."""

from __future__ import annotations

from dataclasses import dataclass

from passo.printer.unfit_commands import ALL, Skips


@dataclass(frozen=True, slots=True)
class Policy:
    """What a print does where it cannot do what the file says. `clamp` and `ignore_tools`: moves
    out of range and tools that are missing; False: it fails.

    `checked` makes the checks of the served printer: axes must be homed before they move, hotends
    warm before filament moves, and no command may be refused. Without it the machine is taken as
    homed and warm, as a piece of G-code needs it, and refused commands are warnings. `skips` are
    commands that the print leaves out with a warning instead of failing before the first move."""

    clamp: bool = False
    ignore_tools: bool = False
    checked: bool = False
    skips: Skips = ALL
