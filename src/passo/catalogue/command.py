"""Errors of commands that the printer refuses."""

from __future__ import annotations

from collections.abc import Mapping

from passo.catalogue.entry import Entry, bad_input

COMMAND: Mapping[str, Entry] = {
    "command.no-mains": bad_input(
        "command", "the power supply is off", "Switch it on (M80), then send the command again"
    ),
    "command.fixed": bad_input(
        "command",
        "{value} is fixed while the printer runs",
        "Change it in the machine file, then restart Passo",
    ),
    "command.real-board": bad_input(
        "command",
        "the boards of this machine are real, and no fault can be simulated on them",
        "Start passo serve with --simulated",
    ),
    "command.no-fault": bad_input(
        "command", "{value} is not a fault of this machine: expected {limit}", "Name one of these"
    ),
    "command.fault-order": bad_input(
        "command", "{value} is not understood: expected {limit}", "Write the fault in this form"
    ),
    "motors.print": bad_input(
        "motors",
        "{axis} moves single motors, which is not allowed while a print is running or paused",
        "Wait until the print is done, or cancel it (M524)",
    ),
    "motors.relative": bad_input(
        "motors",
        "the position of {axis} is not known, because axes are not homed",
        "Home them (G28), or move by a distance (G91)",
    ),
    "motors.mixed": bad_input(
        "motors",
        "one command cannot move motors of arms together with motors of axes",
        "Send a command for each kind",
    ),
    "motors.reach": bad_input(
        "motors", "the motors would leave their range: {value}", "Give a shorter distance"
    ),
    "move.not-made": bad_input(
        "moves",
        "the move {axis} was not made: {value}",
        "Correct it in [moves] of the machine file, or with SET_MOVE",
    ),
    "command.failed": bad_input(
        "command", "{value}", "Remove the cause, then send the command again"
    ),
    "command.halted": bad_input(
        "command",
        "the board is stopped and reports nothing: {value}",
        "Make the printer safe, then send M999",
    ),
    "command.not-yet": bad_input(
        "command",
        "{axis} is not there yet: {value}",
        "Take the command out of the file or the macro",
    ),
    "command.missing-value": bad_input("command", "{axis} needs {value}", "Add it to the command"),
    "command.no-part": bad_input(
        "command",
        "{axis} does nothing here: {value}",
        "Leave the command out, or add the part to the machine file",
    ),
    "command.loop-in-macro": bad_input(
        "command",
        "{axis} is in a macro or a sub-program, where no lines repeat",
        "Write it into the main program of the file, or use for in the macro, M98 L for the call",
    ),
    "command.only-in-file": bad_input(
        "command",
        "{axis} is for files that can be read again: of the card, or of a disk",
        "Write it into a file, and print that from the card",
    ),
    "command.in-file": bad_input(
        "command",
        "{axis} controls prints from files, so a file that is printed must not contain it",
        "Take it out of the file or the macro",
    ),
    "command.no-package": bad_input(
        "command",
        "{axis} needs the Python package {value}, which is not installed",
        "Install it with pip, in the environment of Passo",
    ),
    "command.aside": bad_input(
        "command",
        "{value} would change steps per mm or the geometry while a print is paused",
        "Resume (M24) or cancel (M524), then send the command again",
    ),
    "command.value": bad_input(
        "command", "{axis} is {value}: expected {limit}", "Send the command with such a value"
    ),
    "command.nothing-moves": bad_input(
        "command",
        "unknown axis {axis}; this machine has {limit}",
        "Send the command with one of these letters",
    ),
}
