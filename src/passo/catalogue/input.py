"""Errors of G-code and of other files that Passo reads or writes."""

from __future__ import annotations

from collections.abc import Mapping

from passo.catalogue.entry import Entry, bad_input

INPUT: Mapping[str, Entry] = {
    "input.unreadable": bad_input(
        "file", "cannot be read: {value}", "Check the path and permissions"
    ),
    "input.pipe": bad_input("file", "can be read only once", "Save it to a file first"),
    "input.no-lines": bad_input(
        "file",
        "prints no line, and the laboratory measures printed lines",
        "Give a file and a machine that print",
    ),
    "input.stream": bad_input(
        "file",
        "is not a stream of Klipper's batch mode for this dictionary: {value}",
        "Give the file that klippy.py wrote with -o, and the dictionary that it read with -d",
    ),
    "input.stream-dictionary": bad_input(
        "file",
        "is not the data dictionary of a board: {value}",
        "Give, with --dictionary, the file that klippy.py read with -d",
    ),
    "input.stream-motors": bad_input(
        "file",
        "moves {value} motors, but the machine has {limit}",
        "Choose the machine that printer.cfg describes",
    ),
    "input.stream-path": bad_input(
        "file",
        "moves the motor {axis} by {value:.1f} mm or degrees, but the print moves it by"
        " {limit:.1f}",
        "Give a stream of the same G-code file, from a machine with the same steps per mm",
    ),
    "input.empty": bad_input("file", "holds no command", "Slice the model again"),
    "input.no-known-command": bad_input(
        "file", "holds no command that is known", "Give a sliced file, not a model or a text"
    ),
    "input.garbage": bad_input(
        "gcode", "this is not G-code: {value}", "Give a sliced text file, not a model or a binary"
    ),
    "input.character": bad_input(
        "gcode",
        "{axis} in {value!r} is not a character of G-code",
        "Replace it by an ASCII character, or put a ; before a comment",
    ),
    "input.decimal-comma": bad_input(
        "gcode", "{value!r} has a decimal comma", "Write a decimal point in its place"
    ),
    "input.comma": bad_input(
        "gcode", "{value!r} has a comma", "Put spaces, not commas, between parameters"
    ),
    "input.decimal-points": bad_input(
        "gcode", "{value!r} has two decimal points", "Write one decimal number"
    ),
    "input.parameter": bad_input(
        "gcode",
        "{value!r} is a parameter, an expression or a placeholder, which are not evaluated",
        "Write the number itself, or let the slicer or CAM program write plain G-code",
    ),
    "input.utf-16": bad_input(
        "gcode", "the text is UTF-16, not UTF-8", "Save the file as UTF-8 or ASCII"
    ),
    "input.hole": bad_input(
        "gcode",
        "text follows the zero bytes of line {value}: a part of the file is missing",
        "Copy or slice the file again",
    ),
    "input.after-end": bad_input(
        "gcode",
        "a command follows the Ctrl-Z of line {value}, which ends a text",
        "Remove the Ctrl-Z, or what follows it",
    ),
    "input.number": bad_input(
        "gcode",
        "the word {value!r} has no valid number",
        "Write a decimal number of at most 1e9 without exponent",
    ),
    "input.letter": bad_input(
        "gcode",
        "{axis} has no parameter {value}: the axes of this machine are {limit}",
        "Correct the letter, or write the file for this machine",
    ),
    "input.repeated": bad_input(
        "gcode",
        "the command has more than one {value}",
        "Remove the wrong one. Write a decimal number in place of an exponent",
    ),
    "input.out-of-range": bad_input(
        "motion",
        "{axis} {value:.{decimals}f} mm is beyond the limit of {limit:.{decimals}f} mm",
        "Move the model on the bed, or choose the right machine",
    ),
    "input.unreachable": bad_input(
        "geometry",
        "the point {value} mm cannot be reached by this machine: {limit}",
        "Move the model on the bed, or choose the right machine",
    ),
    "input.actuator": bad_input(
        "geometry",
        "motor {axis} would go to {value:.{decimals}f}{unit}, beyond its limit of"
        " {limit:.{decimals}f}{unit}",
        "Move the model on the bed, or choose the right machine",
    ),
    "input.too-long": bad_input(
        "motion",
        "extruder {axis} would move {value:.0f} mm of filament in one move (limit {limit:.0f} mm)",
        "Correct E (absolute, unless M83 is in force), or use several moves",
    ),
    "input.too-slow": bad_input(
        "motion",
        "the move would take {value:.3g} s (limit {limit:,.0f} s): {axis} is too slow",
        "Correct F, T, M203 or the speeds of the machine file, or use several moves",
    ),
    "input.feedrate": bad_input(
        "gcode", "the feedrate F{value:g} must be above 0", "Give the speed in mm per minute"
    ),
    "input.arc": bad_input(
        "gcode",
        "no circle leads to the end of this arc: {value} does not fit",
        "Give the centre, or an R of at least half the distance to the end",
    ),
    "input.centre": bad_input(
        "gcode",
        "the arc has neither a centre nor a radius: {value} are missing or 0",
        "Give the centre relative to the start of the arc, or the radius R",
    ),
    "input.radii": bad_input(
        "gcode",
        "the arc begins {value:.3f} mm from its centre and ends {limit:.3f} mm from it",
        "Correct I, J or K (relative to the start of the arc), or the end of the arc",
    ),
    "input.checksum": bad_input(
        "gcode",
        "the checksum {value} is wrong: the text of the line has *{limit}",
        "Send the line again",
    ),
    "input.no-line": bad_input(
        "file", "there is no line {value}: the file has {limit}", "Name a line of the file"
    ),
    "input.point": bad_input(
        "heat",
        "{value!r} is not a pair of temperatures from 0 to 400 °C",
        "Write the shown and the true temperature as 200:187",
    ),
    "input.point-far": bad_input(
        "heat",
        "{value:g} °C is too far from the {key:g} °C that is shown: expected {limit}",
        "Look at the thermometer, and whether the machine file names the right thermistor",
    ),
    "input.point-order": bad_input(
        "heat",
        "the true {value:g} °C at {key:g} °C shown is not above the true {limit:g} °C at"
        " {before:g} °C shown",
        "Measure both again, the lower one first",
    ),
    "input.other-answers": bad_input(
        "file",
        "it begins with {value!r}, not with {limit!r}",
        "Delete the file, or start in another folder",
    ),
    "input.missing-tool": bad_input(
        "printer",
        "tool T{value} does not exist: the machine has {limit} tool(s)",
        "Choose a machine with this tool, or slice without it",
    ),
    "input.cold": bad_input(
        "heat",
        "cold extrusion prevented: the hotend is too cold for filament to move",
        "Heat it first (M109), or allow it (M302 P1)",
    ),
    "input.missing-word": bad_input(
        "gcode",
        "{axis} needs {value}",
        "Add it to the command. In a drilling cycle, an earlier command may have it",
    ),
    "input.call": bad_input(
        "gcode",
        "{axis} cannot be carried out: {value}",
        "Correct the call, or put O and the number before the sub-program and M99 at its end",
    ),
    "input.unknown-moves": bad_input(
        "gcode",
        "{value} is unknown here; on other firmware it may move or heat the machine",
        "Replace it by the commands that it stands for",
    ),
    "input.no-macro": bad_input(
        "gcode",
        "{value} is unknown here; it is usually a macro, and the machine file has no"
        " [macros.{value}]",
        "Add this section with its gcode to the machine file",
    ),
    "input.no-levelling": bad_input(
        "gcode",
        "{value} levels the bed, and this machine has {limit}",
        "Remove it from the file and level the bed by hand",
    ),
    "input.unsaved": bad_input(
        "moves", "no position was saved as {value}", "Save one with G60 first"
    ),
    "input.not-homed": bad_input(
        "homing",
        "axis {axis} is not homed",
        "Home it (G28), or set its position (G92)",
    ),
    "input.homing": bad_input(
        "homing", "{axis} has to wait until all axes are homed", "Send it again when G28 is done"
    ),
    "output.exists": bad_input("file", "exists already", "Choose another name"),
    "output.unwritable": bad_input(
        "file", "cannot be written: {value}", "Check the path, its permissions and the free space"
    ),
}
