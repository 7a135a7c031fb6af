"""Converts a printer.cfg to a draft of a machine file."""

from __future__ import annotations

from pathlib import Path

from passo.config.importing.draft import Draft
from passo.config.importing.klipper.accelerometer import put_accelerometer
from passo.config.importing.klipper.bed import put_mesh, put_probe
from passo.config.importing.klipper.boards import board_of_pins
from passo.config.importing.klipper.cfg import Config
from passo.config.importing.klipper.conversion import Import
from passo.config.importing.klipper.filters import put_shapers
from passo.config.importing.klipper.heat import put_heat
from passo.config.importing.klipper.levelling import put_levelling
from passo.config.importing.klipper.macros import put_macros
from passo.config.importing.klipper.motion import put_motion
from passo.config.importing.klipper.others import OPTIONS, OTHERS
from passo.config.importing.klipper.pins import MAIN, Pins, clock_hz

_BAUD = 250_000
_CAN = "canbus_uuid"
_NO_PORT = {  # what to do, by whether the board is on a CAN bus
    False: "Passo reaches a board over a serial port or TCP: set link and port by hand",
    True: "Passo does not use CAN: flash Klipper's firmware for USB to this board, connect its USB "
    "port to the computer, and set link and port",
}
# Options with values that Passo determines itself, or that have no meaning in Passo.
_SILENT = {
    MAIN: {"restart_method", "max_stepper_error"},
}


def imported(path: Path) -> Draft:
    """The machine file for a printer.cfg, with remarks. Raises ConfigError for a file that cannot
    be read, for an unsupported kind of machine, and for dangerous values."""
    config, draft = Config(path), Draft()
    job = Import(config, draft, Pins(config, draft))
    draft.put_head(path, path.stem)
    put_probe(job)
    put_motion(job)
    put_heat(job)
    probe = [key for key in draft.keys if key[0] == "probe"]
    for key in probe:  # after motion and heat, as in other machine files
        draft.keys[key] = draft.keys.pop(key)
    put_mesh(job)
    put_levelling(job)
    put_shapers(job)
    _put_boards(job)
    put_accelerometer(job)
    put_macros(job)
    _remark_on_the_rest(job)
    return draft


def _put_boards(job: Import) -> None:
    draft = job.draft
    for section in job.config.of(MAIN):
        job.used.add(section.name)
        board = job.pins.further.get(section.rest, "")
        path = ("boards", board) if board else ("board",)
        hz = clock_hz(job.config.comments)
        known = board_of_pins(draft, board, None if board else hz)
        draft.put((*path, "base"), known or "klipper", section.place)
        if known:
            text = f"the pins are those of the board {known}, whose names the file may use now"
            draft.changed(section.place, f"[{section.name}]", text)
        port = section.option("serial")
        if port is not None:
            draft.put((*path, "link"), "serial", port.place)
            draft.put((*path, "port"), port.text, port.place)
            baud = section.whole("baud", 1200, 4_000_000) or _BAUD
            draft.put((*path, "baud"), baud, section.at("baud"))
        else:
            draft.decide(section.place, f"[{section.name}]", _NO_PORT[_CAN in section.options])
            section.used.update(section.options)
        if known:
            continue
        if hz is None:
            hz = 16_000_000
            text = "the file does not name the chip: clock_hz is 16 MHz until you set that of yours"
            draft.decide(section.place, f"[{section.name}]", text)
        draft.put((*path, "clock_hz"), hz, None)


def _remark_on_the_rest(job: Import) -> None:
    """Reports the sections and the options that no module has read."""
    for name, section in job.config.sections.items():
        if name in job.used or section.kind == "board_pins":
            for option, found in section.options.items():
                known = _SILENT.get(section.kind, set[str]())
                if (
                    option not in section.used
                    and option not in known
                    and section.kind != "board_pins"
                ):
                    text = OPTIONS.get(option, "Passo has no such setting")
                    job.draft.dropped(found.place, f"[{name}] {option}", text)
            continue
        other = OTHERS.get(section.kind)
        if other is None:
            job.draft.dropped(section.place, f"[{name}]", "Passo does not have this part")
        else:
            job.draft.other(section.place, f"[{name}]", other)
