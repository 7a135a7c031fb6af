"""The options that Klipper has for each kind of section, with their types and defaults: facts of
Klipper's reference, for the settings that macros and clients read."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from passo.config.klipper_options.bed import BED
from passo.config.klipper_options.commands import COMMANDS
from passo.config.klipper_options.drivers import DRIVERS
from passo.config.klipper_options.heat import HEAT
from passo.config.klipper_options.motion import MOTION
from passo.config.klipper_options.outputs import OUTPUTS

if TYPE_CHECKING:
    from collections.abc import Mapping

    from passo.config.klipper_options.option import Option, Options

OPTIONS: Mapping[str, Options] = {**MOTION, **DRIVERS, **HEAT, **BED, **OUTPUTS, **COMMANDS}
"""The options by the kind of section."""


def kind_of(section: str) -> str:
    """The kind of a section: `stepper` for stepper_z1, `extruder` for extruder1, else the first
    word of its name."""
    first = section.split()[0]
    numbered = re.fullmatch(r"(stepper(?=_)|extruder).*", first) if first == section else None
    return numbered[1] if numbered else first


def option_of(section: str, name: str) -> Option | None:
    """The row of an option, by the names of its section and its own; `screw1` is `screw#`. None if
    Klipper has no such option."""
    pattern = re.sub(r"\d+", "#", name)
    rows = OPTIONS.get(kind_of(section), ())
    return next((row for row in rows if row.name in (name, pattern)), None)
