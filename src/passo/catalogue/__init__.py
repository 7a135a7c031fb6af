"""The error catalogue: each possible error has one text, the same on every console, page and log.

An entry names the part of Passo or of the printer that it concerns, the sentence (with the measured
value and the limit in it), the next action of the user, and the exit status. Each file contains the
codes of one subject, or of a few related ones: `heat.runaway` is in heat.py.
"""

from __future__ import annotations

from collections.abc import Mapping

from passo.catalogue.card import CARD
from passo.catalogue.command import COMMAND
from passo.catalogue.config import CONFIG
from passo.catalogue.driver import DRIVER
from passo.catalogue.entry import Entry, ExitStatus
from passo.catalogue.fan import FAN
from passo.catalogue.firmware import FIRMWARE
from passo.catalogue.heat import HEAT, SHOWN
from passo.catalogue.hub import HUB
from passo.catalogue.importing import IMPORT
from passo.catalogue.input import INPUT
from passo.catalogue.job import JOB
from passo.catalogue.learn import LEARN
from passo.catalogue.levelling import LEVELLING
from passo.catalogue.light import LIGHT
from passo.catalogue.link import LINK
from passo.catalogue.machine import MACHINE
from passo.catalogue.macro import MACRO
from passo.catalogue.probe import PROBE
from passo.catalogue.resonance import RESONANCE
from passo.catalogue.settings import SETTINGS
from passo.catalogue.study import STUDY
from passo.catalogue.web import WEB

__all__ = ["CATALOGUE", "Entry", "ExitStatus", "codes_of"]

CATALOGUE: Mapping[str, Entry] = {
    **CONFIG,
    **IMPORT,
    **INPUT,
    **CARD,
    **WEB,
    **JOB,
    **SETTINGS,
    **MACRO,
    **COMMAND,
    **MACHINE,
    **FAN,
    **LIGHT,
    **LINK,
    **PROBE,
    **HEAT,
    **SHOWN,
    **DRIVER,
    **FIRMWARE,
    **LEARN,
    **LEVELLING,
    **RESONANCE,
    **STUDY,
    **HUB,
}


def codes_of(subject: str) -> tuple[str, ...]:
    """All codes that begin with `subject.`."""
    return tuple(code for code in CATALOGUE if code.startswith(f"{subject}."))
