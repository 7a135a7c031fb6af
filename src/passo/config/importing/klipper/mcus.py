"""[mcu]: the boards, their links and their clocks."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.board_files import load_board
from passo.config.importing.klipper.boards import boards_of_pins
from passo.config.importing.klipper.chips import LINUX, ChipOfKlipper, chips_in, chips_of_pins
from passo.config.importing.klipper.pins import MAIN as MCU
from passo.config.klippers_firmware import NAME
from passo.config.pin_names import MAIN, bare, placed
from passo.config.pin_names import section as board_path

if TYPE_CHECKING:
    from passo.config.importing.draft import KeyPath
    from passo.config.importing.klipper.cfg import Section
    from passo.config.importing.klipper.conversion import Import

_BAUD = 250_000
_OF_MOTORS = ("step_pin", "direction_pin", "enable_pin")
_CAN = "canbus_uuid"
_NO_PORT = {  # what to do, by whether the board is on a CAN bus
    False: "Passo reaches a board over a serial port or TCP: set link and port by hand",
    True: "Passo does not use CAN: flash Klipper's firmware for USB to this board, connect its USB "
    "port to the computer, and set link and port",
}
_UNKNOWN = (
    "the file does not name the chip: Passo reads its clock from the firmware when it connects; "
    "estimates assume 16 MHz until clock_hz, or the board's name in base, is given"
)

_ON_BOARDS = (
    *("steppers", "heaters", "fans", "homing", "probe", "accelerometer"),
    *("filament_sensors", "buttons", "outputs", "lights", "servos", "sensors"),
)


def put_boards(job: Import, base: str | None) -> None:
    """Imports all boards after the parts whose pins they have. `base` is the name of the main
    board's file, if the user has given it."""
    for section in job.config.of(MCU):
        job.used.add(section.name)
        board = _board(job, section)
        _put_link(job, section, board_path(board))
        _put_kind(job, section, board, base if board == MAIN else None)


def finish_boards(job: Import) -> None:
    """Leaves out further boards on which the machine file has no part, and makes all boards
    simulated if one has no port, or if a heater was left out. Call it when all parts are there."""
    used = {
        placed(value)[0]
        for path, (value, _) in job.draft.keys.items()
        if path[0] in _ON_BOARDS and isinstance(value, str)
    }
    waits = [f"heaters.{name} is decided" for name in job.lost_heaters]
    for section in job.config.of(MCU):
        board, what = _board(job, section), f"[{section.name}]"
        path = board_path(board)
        if board != MAIN and board not in used:
            job.draft.keys = {k: v for k, v in job.draft.keys.items() if k[: len(path)] != path}
            text = "the board is left out: no part of the machine file is on it"
            job.draft.dropped(section.place, what, text)
        elif (*path, "port") not in job.draft.keys:
            job.draft.decide(section.place, what, _NO_PORT[_CAN in section.options])
            waits.append(f"{'.'.join(path)} has link and port")
    if waits:
        job.draft.simulate(" and ".join(waits))


def _board(job: Import, section: Section) -> str:
    """The name of a board in the machine file."""
    return job.pins.further.get(section.rest, MAIN)


def _put_link(job: Import, section: Section, path: KeyPath) -> None:
    draft, port = job.draft, section.option("serial")
    if port is None or not port.text:
        section.used.update(section.options)
        return
    draft.put((*path, "link"), "serial", port.place)
    draft.put((*path, "port"), port.text, port.place)
    draft.put((*path, "baud"), section.whole("baud") or _BAUD, section.at("baud"))


def _put_kind(job: Import, section: Section, board: str, base: str | None) -> None:
    """Sets the board file, or what is known of the chip without one."""
    draft, path, place = job.draft, board_path(board), section.place
    chips = chips_in(section.text("serial"))[:1]  # an identity of the port has one name
    if not chips and board == MAIN:
        chips = chips_in("\n".join(job.config.comments))
    chips = chips or chips_of_pins(_pins_on(job, board))
    names = [base] if base else _fitting(job, board, chips)
    draft.put((*path, "base"), names[0] if names else NAME, place)
    if not names:
        _put_chip(job, section, path, chips)
        return
    known = load_board(names[0])
    if not base:
        text = f"the pins are those of the board {names[0]}, whose names the file may use now"
        draft.changed(place, f"[{section.name}]", text)
        if names[1:]:
            text = f"the board is {names[0]}, or {' or '.join(names[1:])}: set base to yours"
            draft.decide(place, f"[{section.name}]", text)
    if not known.is_klippers:
        draft.put((*path, "firmware"), NAME, place)
        _put_chip(job, section, path, chips or chips_in(known.mcu))
    elif chips and known.clock_hz not in [chip.clock_hz for chip in chips]:
        draft.put((*path, "clock_hz"), chips[0].clock_hz, section.at("serial"))


def _pins_on(job: Import, board: str) -> set[str]:
    """The pins of a board that the motors of the draft use."""
    pins = [
        placed(str(value))
        for path, (value, _) in job.draft.keys.items()
        if path[0] == "steppers" and path[-1] in _OF_MOTORS
    ]
    return {bare(pin) for on, pin in pins if on == board}


def _fitting(job: Import, board: str, chips: list[ChipOfKlipper]) -> list[str]:
    """The boards with these pins: those with the clock of the chip, if there are any."""
    comments = "\n".join(job.config.comments)
    names = boards_of_pins(job.draft, board, comments if board == MAIN else "")
    clocks = [chip.clock_hz for chip in chips[:1]]
    return [name for name in names if load_board(name).clock_hz in clocks] or names


def _put_chip(job: Import, section: Section, path: KeyPath, chips: list[ChipOfKlipper]) -> None:
    """Sets the clock and the move queue of a board without a file."""
    place = section.at("serial")
    if not chips:
        job.draft.changed(section.place, f"[{section.name}]", _UNKNOWN)
        return
    chip = chips[0]
    job.draft.put((*path, "clock_hz"), chip.clock_hz, place)
    job.draft.put((*path, "move_count"), chip.moves, place)
    if chip.name == LINUX:
        text = "the board is a process on a computer: let it drive no motor and no heater"
        job.draft.changed(section.place, f"[{section.name}]", text)
