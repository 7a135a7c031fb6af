"""Errors of macros and of their variables."""

from __future__ import annotations

from collections.abc import Mapping

from passo.catalogue.entry import Entry, bad_input

MACRO: Mapping[str, Entry] = {
    "macro.template": bad_input(
        "macro",
        "macro {axis}, line {limit} of its template: {value}",
        "Correct the template in the machine file, or the parameters of the call",
    ),
    "macro.whole": bad_input(
        "macro",
        "macro {axis}: {value}",
        "Correct the template in the machine file, or the parameters of the call",
    ),
    "macro.nested": bad_input(
        "macro",
        "macro {axis} is called by {limit} macros that call each other",
        "Remove the circle",
    ),
    "macro.raised": bad_input(
        "macro", "macro {axis}: {value}", "The macro has stopped by itself; do what it asks for"
    ),
    "macro.unknown": bad_input(
        "macro", "there is no macro {axis}; known here: {value}", "Correct the name"
    ),
    "macro.no-variable": bad_input(
        "macro",
        "macro {axis} has no variable {value}; known here: {limit}",
        "Correct the name, or add it to the variables of the macro",
    ),
    "macro.value": bad_input(
        "macro",
        "variable {axis}: {value!r} is not a value",
        "Write a number, a text in two kinds of quotes (\"'text'\"), a list, True or False",
    ),
    "macro.saved-unreadable": bad_input(
        "macro",
        "the file of SAVE_VARIABLE is damaged: macros cannot read its variables, and no variable is"
        " stored",
        "Correct the file, which is JSON, or remove it; then restart Passo",
    ),
    "macro.saved-unwritable": bad_input(
        "macro",
        "the variable was not stored: {value}",
        "Check the directory, its permissions and the free space on the disk",
    ),
    "macro.no-delay": bad_input(
        "macro", "there is no [delayed_gcode.{axis}]; known here: {value}", "Correct the name"
    ),
}
