"""The notes of `passo check` about a valid machine file: skipped checks, assumptions, and the notes
of a board's file."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from passo.config.advance import smoothing_note
from passo.config.board_files import known_pins
from passo.config.exporting.settings import Sections
from passo.config.findings import key_text
from passo.config.heat import AMBIENT_C
from passo.config.heater_numbers import number_of
from passo.config.jerk import box_s, right_angle_mm
from passo.config.klipper_options.left_out import sentences
from passo.config.klippers_firmware import NAME
from passo.config.macro_calls import machine_calls
from passo.config.pin_names import section
from passo.config.shapers import impulses

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig

_PINS = {"mcu", "dictionary", "pins"}
_FEW_MOVES = 256  # of a board for which no file says more


def unchecked_boards(machine: MachineConfig) -> list[str]:
    """The tables of boards with unknown pins, because neither their chip nor their dictionary is
    known."""
    return [
        key_text(section(name))
        for name, board in machine.all_boards.items()
        if not known_pins(board.model_dump(include=_PINS, exclude_none=True))
    ]


def notes(machine: MachineConfig) -> Iterator[str]:
    """One or two sentences for each note."""
    for board in unchecked_boards(machine):
        yield (
            f"the pins on {board} are not checked: its firmware's dictionary is not known. Give"
            f' {board} the key dictionary = "klipper.dict", the file of the firmware\'s build'
        )
    for name, board in machine.all_boards.items():
        if not board.knows_clock:
            yield (
                f"{key_text(section(name))}.clock_hz is not known: `passo serve` reads it from the"
                f" firmware. Other commands assume {board.clock_hz / 1e6:g} MHz, so that an"
                " estimate may be longer than the print"
            )
    for name in {machine.board_of_stepper(stepper): None for stepper in machine.steppers}:
        board = machine.all_boards[name]
        if board.base == NAME and board.move_count <= _FEW_MOVES:
            yield _queue_note(key_text(section(name)), board.move_count)
    for name, heater in machine.heaters.items():
        if not heater.known_model:
            number = number_of(machine, name)
            tune = "" if number is None else f". M303 H{number} R5 finds the model of this one"
            hottest_c = AMBIENT_C + heater.simulated.full_power_rise_c
            yield (
                f"heaters.{name} is taken to be a {heater.kind} that full power heats to"
                f" {hottest_c:.0f} °C, and its readings are not compared with a model{tune}"
            )
    for name, extruder in machine.extruders.items():
        if (note := smoothing_note(machine.path_limits, name, extruder)) is not None:
            yield note
    if machine.limits.jerk_mm_s3 is not None:
        yield _jerk_note(machine, machine.limits.jerk_mm_s3)
    for board in machine.all_boards.values():
        yield from board.notes
    for word, part, line in machine_calls(machine):
        yield (
            f"{part}, line {line}, calls {word}, which is neither a command nor a macro here: a"
            f" print stops at this line. Write the macro {word}, or remove the call"
        )
    for sentence in sentences(Sections(machine).left_out) if machine.klipper else ():
        yield f"{sentence}, because Passo does not drive this part (table klipper)"


def _queue_note(board: str, moves: int) -> str:
    """A note on what a short move queue costs, for a board without a file."""
    return (
        f"{board}.base does not name the board, so its queue is taken to hold {moves} moves. Where"
        " a print has dense moves, steps are up to 25 µs beside their times instead of 2 µs. Name"
        f" the board in base (passo firmware list), or give {board}.move_count: 1024 for a chip"
        " with 32 KB of memory or more, such as STM32F4, STM32G0, RP2040, LPC1768"
    )


def _jerk_note(machine: MachineConfig, jerk_mm_s3: float) -> str:
    """A note on the distance by which the jerk limit, with the shapers of the file, cuts
    corners."""
    accel = machine.largest_accel_mm_s2
    box = box_s(accel, jerk_mm_s3)
    shapers = [impulses(s.type, s.frequency_hz, s.damping) for s in machine.shaping.values()]
    at_rest, at_speed = (right_angle_mm(box, shapers, accel, speed) for speed in (0.0, 10.0))
    return (
        f"limits.jerk_mm_s3 averages all positions over {box * 1e3:.1f} ms. At {accel:g} mm/s² the"
        f" filters of this file cut a right angle by up to {at_rest:.3f} mm where the head stops in"
        f" it, and by up to {at_speed:.3f} mm where it passes at 10 mm/s"
    )
