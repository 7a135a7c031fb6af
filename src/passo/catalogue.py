"""The error catalogue: what may go wrong, said once, the same on every console, page and log.

An entry names the part of Passo or of the printer that it concerns, the sentence (with the measured
value and the limit in it), the next action for the person who reads it, and the exit status.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum


class ExitStatus(IntEnum):
    """What the `passo` command returns to the shell."""

    DONE = 0
    USAGE = 2
    BAD_CONFIG = 3
    BAD_INPUT = 4
    MACHINE_FAULT = 5


@dataclass(frozen=True, slots=True)
class Entry:
    """One row of the catalogue; `says` is a format string over a problem's values."""

    part: str
    says: str
    action: str
    status: ExitStatus


def _config(says: str, action: str) -> Entry:
    return Entry("config", says, action, ExitStatus.BAD_CONFIG)


def _input(part: str, says: str, action: str) -> Entry:
    return Entry(part, says, action, ExitStatus.BAD_INPUT)


def _levelling(says: str, action: str) -> Entry:
    return Entry("levelling", says, action, ExitStatus.BAD_INPUT)


def _card(says: str, action: str) -> Entry:
    return Entry("card", says, action, ExitStatus.BAD_INPUT)


def _firmware(says: str, action: str, status: ExitStatus = ExitStatus.USAGE) -> Entry:
    return Entry("firmware", says, action, status)


def _web(says: str, action: str) -> Entry:
    return Entry("web", says, action, ExitStatus.USAGE)


def _heat(says: str, action: str) -> Entry:
    return Entry("heat", says, f"{action}, then send M922", ExitStatus.MACHINE_FAULT)


def _late(says: str, action: str) -> Entry:
    head = "commands reached the board {value} they were due, {limit:.0f} ms before is needed"
    return Entry("link", f"{head}: {says}", action, ExitStatus.MACHINE_FAULT)


def _probe(says: str, action: str) -> Entry:
    return Entry("probe", says, action, ExitStatus.MACHINE_FAULT)


def _driver(says: str, action: str) -> Entry:
    return Entry("driver", f"motor {{axis}}: {says}", action, ExitStatus.MACHINE_FAULT)


CATALOGUE: Mapping[str, Entry] = {
    "config.unknown-machine": _config(
        "there is no machine called {value!r}",
        "Name a shipped machine (see `passo machines`) or the path of a TOML file",
    ),
    "config.unreadable": _config("cannot be read: {value}", "Check the path and its permissions"),
    "config.encoding": _config("is not UTF-8 text: {value}", "Save the file as UTF-8"),
    "config.syntax": _config("is not valid TOML: {value}", "Correct the syntax at this place"),
    "machine.no-file": _config(
        "{value} is not a file that can be changed: it comes with Passo, or a program made it",
        "Save the text as a file of your own, and start with --machine FILE.toml",
    ),
    "machine.file-changed": _config(
        "the machine file has changed since it was read", "Read it again, and compare the two"
    ),
    "machine.no-restart": _config(
        "this printer cannot be restarted from the web: a program opened it, or it has --stdin",
        "Stop Passo and start it again",
    ),
    "config.unknown-key": _config("{key} is not a known key", "Remove it or correct its name"),
    "config.missing-key": _config("{key} is missing: expected {limit}", "Add the key"),
    "config.value": _config("{key} is {value!r}: expected {limit}", "Correct the value"),
    "config.conflict": _config("{key} is {value!r}: expected {limit}", "Change or remove it"),
    "config.home-side": _config(
        "{key} is {value!r}: expected {limit}",
        "Give the position at which the endstop triggers, or change the direction",
    ),
    "config.gain": _config(
        "{key} is {value!r}: {limit}",
        "Copy the gains of Klipper, Marlin or M303, or leave them out",
    ),
    "input.unreadable": _input("file", "cannot be read: {value}", "Check the path and permissions"),
    "input.pipe": _input("file", "can be read only once, and not again", "Save it to a file first"),
    "input.empty": _input("file", "holds no command", "Slice the model again"),
    "input.no-known-command": _input(
        "file", "holds no command that is known", "Give a sliced file, not a model or a text"
    ),
    "input.garbage": _input(
        "gcode", "this is not G-code: {value}", "Give a sliced text file, not a model or a binary"
    ),
    "input.character": _input(
        "gcode",
        "{axis} in {value!r} is not a character of G-code",
        "Replace it by an ASCII character, or put a ; before a comment",
    ),
    "input.decimal-comma": _input(
        "gcode", "{value!r} has a decimal comma", "Write a decimal point in its place"
    ),
    "input.comma": _input(
        "gcode", "{value!r} has a comma", "Put blanks, not commas, between words"
    ),
    "input.decimal-points": _input(
        "gcode", "{value!r} has two decimal points", "Write one decimal number"
    ),
    "input.parameter": _input(
        "gcode",
        "{value!r} is a parameter, an expression or a placeholder, which are not evaluated",
        "Write the number itself, or let the slicer or CAM program write plain G-code",
    ),
    "input.utf-16": _input(
        "gcode", "the text is UTF-16, not UTF-8", "Save the file as UTF-8 or ASCII"
    ),
    "input.hole": _input(
        "gcode",
        "text follows the zero bytes of line {value}: a part of the file is missing",
        "Copy or slice the file again",
    ),
    "input.after-end": _input(
        "gcode",
        "a command follows the Ctrl-Z of line {value}, which ends a text",
        "Remove the Ctrl-Z, or what follows it",
    ),
    "input.number": _input(
        "gcode",
        "the word {value!r} has no valid number",
        "Write a decimal number of at most 1e9 without exponent",
    ),
    "input.repeated": _input(
        "gcode",
        "the command has more than one {value}",
        "Remove the word that is not meant. In place of an exponent, write a decimal number",
    ),
    "input.out-of-range": _input(
        "motion",
        "{axis} {value:.{decimals}f} mm is beyond the limit of {limit:.{decimals}f} mm",
        "Move the model on the bed, or choose the right machine",
    ),
    "input.unreachable": _input(
        "geometry",
        "the point {value} mm cannot be reached by this machine: {limit}",
        "Move the model on the bed, or choose the right machine",
    ),
    "input.actuator": _input(
        "geometry",
        "motor {axis} would go to {value:.{decimals}f}{unit}, beyond its limit of"
        " {limit:.{decimals}f}{unit}",
        "Move the model on the bed, or choose the right machine",
    ),
    "input.too-long": _input(
        "motion",
        "extruder {axis} would move {value:.0f} mm of filament in one move, of at most {limit:.0f}",
        "Correct E, which counts from G92 unless M83 is in force, or use several moves",
    ),
    "input.too-slow": _input(
        "motion",
        "the move would take {value:.3g} s (limit {limit:,.0f} s): {axis} is too slow",
        "Correct F, T, M203 or the speeds of the machine file, or use several moves",
    ),
    "input.feedrate": _input(
        "gcode", "the feed rate F{value:g} must be above 0", "Give the speed in mm per minute"
    ),
    "input.arc": _input(
        "gcode",
        "the arc has no circle: {value} does not fit its end",
        "Give the centre, or an R of at least half the distance",
    ),
    "input.centre": _input(
        "gcode",
        "the arc has neither a centre nor a radius: {value} are missing, or 0",
        "Give the centre from where the arc begins, or the radius R",
    ),
    "input.radii": _input(
        "gcode",
        "the arc begins {value:.3f} mm from its centre and ends {limit:.3f} mm from it",
        "Correct I, J or K, which count from where the arc begins, or its end",
    ),
    "input.checksum": _input(
        "gcode",
        "the checksum {value} is wrong: the line's is *{limit}",
        "Send the line again",
    ),
    "input.no-line": _input(
        "file", "there is no line {value}: the file has {limit}", "Name a line of the file"
    ),
    "input.point": _input(
        "heat",
        "{value!r} is no pair of temperatures from 0 to 400 °C",
        "Write the shown and the true temperature as 200:187",
    ),
    "input.point-far": _input(
        "heat",
        "{value:g} °C is too far from the {key:g} °C that is shown: expected {limit}",
        "Look at the thermometer, and whether the machine file names the right thermistor",
    ),
    "input.point-order": _input(
        "heat",
        "{value:g} °C where {key:g} °C is shown is no more than the {limit:g} °C at {before:g} °C",
        "Measure again, from the lower of the two",
    ),
    "input.other-answers": _input(
        "file",
        "it begins with {value!r}, not with {limit!r}",
        "Delete it, or start elsewhere",
    ),
    "input.missing-tool": _input(
        "printer",
        "tool T{value} does not exist: the machine has {limit} tool(s)",
        "Choose a machine with this tool, or slice without it",
    ),
    "output.unwritable": _input(
        "file", "cannot be written: {value}", "Check the path, its permissions and the free space"
    ),
    "card.absent": _card(
        "there is no card: {value}", "Insert the card or correct the path, then mount it again"
    ),
    "card.format": _card(
        "holds no FAT32 file system: {key} is {value}, expected {limit}",
        "Format the card as FAT32 on a computer, after saving what is on it",
    ),
    "card.broken": _card(
        "the file system is damaged: {key} is {value}, expected {limit}",
        "Check and repair the card on a computer (fsck.fat or chkdsk)",
    ),
    "card.not-found": _card("is not on the card", "List the card and name what is there"),
    "card.directory": _card("is a directory, not a file", "Name a file in it"),
    "card.not-directory": _card("is a file, not a directory", "Name a directory of the card"),
    "card.exists": _card("exists already", "Choose another name"),
    "card.not-empty": _card("is not empty: {value} is in it", "Delete what it holds first"),
    "card.into-itself": _card(
        "cannot be moved into itself", "Choose a directory that is not within it"
    ),
    "card.no-slots": _card(
        "cannot become {value!r} on this card: its directory has no place for that in one write",
        "Make a directory with that name and move the files, or rename it on a computer",
    ),
    "card.name": _card(
        "the name {value!r} is not allowed on a card: expected {limit}", "Choose another name"
    ),
    "card.full": _card(
        "the card is full: {value} bytes are needed, {limit} are free",
        "Delete files or take another card",
    ),
    "card.too-long": _card(
        "would be {value} bytes long, beyond the limit of {limit}", "Write it in several parts"
    ),
    "card.read-only": _card(
        "cannot be written: {value}", "Remove the write protection (the card's switch, permissions)"
    ),
    "card.busy": _card("is in use: {value}", "Wait until that has ended, or stop it"),
    "card.removed": _card(
        "was removed while in use, or fails: {value}",
        "Insert the card again and mount it; replace it if that recurs",
    ),
    "card.changed": _card(
        "was changed on the computer while in use: {value}",
        "Select it again (M23) and print it from its beginning",
    ),
    "card.line-refused": _card(
        "a line of it was not taken: {value}", "Shorten it, then upload the file again"
    ),
    "console.unopened": Entry(
        "console",
        "{axis} cannot be opened: {value}",
        "Check the name, its permissions, and that no other program has it",
        ExitStatus.USAGE,
    ),
    "upload.binary": _input(
        "file",
        "is binary G-code, which is not read here",
        'Switch off "Supports binary G-code" in the slicer\'s printer settings, and slice again',
    ),
    "upload.kind": _input(
        "file", "is not a G-code file: expected {limit}", "Slice the model and upload its G-code"
    ),
    "upload.content": _input(
        "file", "does not hold G-code: {value}", "Slice the model and upload its G-code"
    ),
    "upload.malformed": _input(
        "upload", "the request cannot be read: {value}", "Correct it and send it again"
    ),
    "upload.slow": _input(
        "upload",
        "only {value} bytes have come within {limit} s",
        "Look at the network, then send the file again",
    ),
    "upload.too-many": _input(
        "upload", "{limit} files are being uploaded already", "Wait until one of them is whole"
    ),
    "upload.offset": _input(
        "upload",
        "the upload goes on at byte {limit}, not at {value}",
        "Ask for its offset, and send what follows it",
    ),
    "web.invalid": _web(
        "the {where} of the request is not valid at {pointer!r}: {value}",
        "Correct it as the API reference describes it",
    ),
    "web.malformed": _web(
        "the request cannot be read: {value}", "Correct it as the API reference describes it"
    ),
    "web.media-type": _web(
        "the body of the request is {value!r}: expected {limit}", "Set its Content-Type"
    ),
    "web.not-found": _web("there is no {value}", "Read what there is, then name one of these"),
    "web.method": _web(
        "{value} is not possible here: expected {limit}", "Use one of these methods"
    ),
    "web.too-large": _web(
        "the body of the request is larger than {limit} bytes", "Send less at once"
    ),
    "web.log-in": _web(
        "this needs a log-in or an API key", "Log in, or send a key in the header X-Api-Key"
    ),
    "web.role": _web(
        "{value} may not do that: it needs the role {limit}",
        "Log in as an account with that role, or ask the administrator",
    ),
    "web.host": _web(
        "the request is for the host {value!r}, which is not a name of this printer",
        "Use its IP address, or start with --http-name NAME",
    ),
    "web.origin": _web(
        "the request comes from another web page: {value}",
        "Use the printer's own page; a script sends an API key in the header X-Api-Key",
    ),
    "web.too-many": _web(
        "there were too many attempts to log in: the next one may come in {limit} s",
        "Wait so long, then try again",
    ),
    "web.password": _web(
        "this needs the password again, entered within the last {limit} minutes",
        "Confirm the log-in with the password",
    ),
    "web.credentials": _web("the name or the password is wrong", "Check both, then try again"),
    "web.code": _web(
        "the one-time code is wrong", "Copy it from where `passo serve` has printed it"
    ),
    "web.no-administrator": _web(
        "this needs a password, and there is no account yet",
        "Create the administrator first",
    ),
    "web.set-up": _web("there is an administrator already", "Log in"),
    "web.account-exists": _web("there is an account {value} already", "Choose another name"),
    "web.last-administrator": _web(
        "{value} is the last administrator", "Make another account an administrator first"
    ),
    "web.accounts": _web(
        "the accounts cannot be used: {value}",
        "Check the folder of --state, its permissions and the free space on the disk",
    ),
    "web.scripts": _web(
        "{limit} scripts of this client are under way already", "Wait for their answers"
    ),
    "web.slow": _web(
        "the body of the request did not come within {limit} s",
        "Look at the network, then try again",
    ),
    "web.unreachable": _web(
        "{value} cannot be reached: {limit}", "Check the address, and that `passo serve` runs"
    ),
    "web.program": Entry(
        "web",
        "an unexpected fault of the program: {value}",
        "Report it, with the log of the printer",
        ExitStatus.MACHINE_FAULT,
    ),
    "card.no-name": _card("no file is named", "Name one after the command, as M20 lists it"),
    "card.no-console": _card("only a console can send a file", "Send it from a console"),
    "job.at-end": _input(
        "job", "{value} has been printed to its end", "Rewind it with M26 S0, then send M24"
    ),
    "job.no-file": _input("job", "no file is selected", "Select one (M23), after listing the card"),
    "queue.empty": _input("queue", "no print waits in the queue", "Add a file to it first"),
    "queue.full": _input(
        "queue", "{limit} prints wait already, the maximum", "Start or remove one of them first"
    ),
    "queue.unknown": _input(
        "queue", "there is no print {value} in the queue", "Read the queue again"
    ),
    "queue.bed": _input(
        "queue", "the bed is not confirmed to be clear", "Clear the bed, then confirm that"
    ),
    "queue.unwritable": _input(
        "queue",
        "the queue was not changed, because it cannot be stored: {value}",
        "Check the directory, its permissions and the free space on the disk",
    ),
    "settings.nowhere": _input(
        "settings", "there is no place to store settings", "Start with --state DIRECTORY"
    ),
    "state.busy": _input(
        "printer",
        "another printer keeps its prints and settings there",
        "Stop that one, or give each a folder of its own (--state)",
    ),
    "settings.none": _input("settings", "no settings are stored", "Store them first (M500)"),
    "settings.unreadable": _input(
        "settings",
        "the stored settings are not used: {value}",
        "Store new ones (M500); until then the machine file's hold",
    ),
    "settings.unwritable": _input(
        "settings",
        "the settings were not stored: {value}",
        "Check the directory, its permissions and the free space on the disk",
    ),
    "job.failed": _input(
        "job", "{value}", "Correct it and continue after it (M24), or cancel (M524)"
    ),
    "history.unusable": _input(
        "job",
        "the history of prints cannot be used: {value}",
        "Close it in other programs; if it is damaged, move it away and start again",
    ),
    "job.no-objects": _input(
        "job",
        "no file that labels its objects is being printed",
        "Start one that was sliced with labels (M486 or EXCLUDE_OBJECT), then send it again",
    ),
    "job.no-object": _input(
        "job",
        "{value} is not an object of this print: expected {limit}, or a name",
        "List the objects with M486, then name one",
    ),
    "job.several-objects": _input(
        "job",
        "several objects have the name {value}: {limit}",
        "Choose one by its number (M486 P)",
    ),
    "job.no-current-object": _input(
        "job",
        "no object is being printed at this moment",
        "Name the object: M486 P<number> or EXCLUDE_OBJECT NAME=<name>",
    ),
    "job.no-object-order": _input(
        "job", "{value} names no object: expected {limit}", "Correct it and send it again"
    ),
    "job.objects-and-laser": _input(
        "job",
        "objects cannot be cancelled on a machine with a laser, which would burn where it stands",
        "Cancel the print (M524)",
    ),
    "job.other-macros": _input(
        "job",
        "the macros of the machine file have changed since the print began, so its place cannot be"
        " found",
        "Restore the macros as they were, then send M1000",
    ),
    "job.no-part": _input(
        "job",
        "needs {value}, which is missing from the machine file",
        "Restore that section and start again, or forget the print (M1000 C)",
    ),
    "job.other-file": _input(
        "job",
        "is not the file that was printed, or cannot be resumed on this machine",
        "Put back the card with that file, or forget the print (M1000 C)",
    ),
    "job.other-machine": _input(
        "job", "was printed on another machine", "Forget the print (M1000 C)"
    ),
    "job.nothing-interrupted": _input(
        "job", "no print was interrupted", "Select a file (M23) and start it (M24)"
    ),
    "job.printing": _input(
        "job", "{value} is being printed", "Wait until it is done, or cancel it (M524)"
    ),
    "machine.switch-missed": Entry(
        "homing",
        "{axis} was not homed: {value} was not triggered within {limit} towards {position}",
        "Check that the axis moved towards it, and what M119 reports while you press it",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.switch-lost": Entry(
        "homing",
        "{axis} was not homed: {value} and a motor of it are on boards that lost each other",
        "Look at the cables of the boards, and at how busy this computer is",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.switch-stuck": Entry(
        "homing",
        "{axis} was not homed: {value} is still triggered {limit} away from {position}",
        "Check its wiring and the ! in front of its pin, or raise its retract distance",
        ExitStatus.MACHINE_FAULT,
    ),
    "probe.none": _probe("this machine has no probe", "Describe it in [probe] of the machine file"),
    "probe.out-of-reach": _probe(
        "{axis} is out of reach: with the probe at {value} the nozzle is at {position},"
        " and {limit}",
        "Move the point, or correct offset_mm of [probe]",
    ),
    "probe.triggered": _probe(
        "{axis} was not measured: the probe is triggered at {value} with the nozzle at {position},"
        " also after a lift by {limit}",
        "Look whether something touches the probe, at its cable, and at the ! in front of its pin",
    ),
    "probe.missed": _probe(
        "{axis} was not measured: the probe was not triggered at {value} down to {limit} of the"
        " nozzle, which was at {position}",
        "Look at the cable of the probe, at what M119 reports while you trigger it, and at the"
        " height of the bed",
    ),
    "probe.early": _probe(
        "{axis} was not measured: the probe was triggered at {value} with the nozzle at {position},"
        " less than {limit} below the start of the descent",
        "Look at the cable of the probe; a sensor that is shaken needs settle_s",
    ),
    "probe.apart": _probe(
        "{axis} was not measured: at {value} two descents differ by {position}, of at most {limit}",
        "Clean the nozzle and the bed, and look whether the probe is loose",
    ),
    "probe.unsteady": _probe(
        "{axis} was not measured: at {value} the samples differ by {position}, of at most {limit}",
        "Clean the nozzle and the bed, look whether the probe is loose, or raise tolerance_mm",
    ),
    "probe.lost": _probe(
        "{axis} was not measured: the boards of the probe and of a motor lost each other",
        "Look at the cables of the boards, and at how busy this computer is",
    ),
    "input.cold": _input(
        "heat",
        "cold extrusion prevented: the hotend is too cold for filament to move",
        "Heat it first (M109), or allow it (M302 P1)",
    ),
    "input.missing-word": _input(
        "gcode",
        "{axis} needs {value}",
        "Add the word to the command, or to one before it in the cycle",
    ),
    "input.call": _input(
        "gcode",
        "{axis} cannot be carried out: {value}",
        "Correct the call, or put O and the number before the sub-program and M99 at its end",
    ),
    "macro.template": _input(
        "macro",
        "macro {axis}, line {limit} of its template: {value}",
        "Correct the template in the machine file, or the parameters of the call",
    ),
    "macro.whole": _input(
        "macro",
        "macro {axis}: {value}",
        "Correct the template in the machine file, or the parameters of the call",
    ),
    "macro.nested": _input(
        "macro",
        "macro {axis} is called by {limit} macros that call each other",
        "Let no macro call itself; the command that it replaces has the name of rename_existing",
    ),
    "macro.raised": _input(
        "macro", "macro {axis}: {value}", "The macro has stopped by itself; do what it asks for"
    ),
    "macro.unknown": _input(
        "macro", "there is no macro {axis}; known here: {value}", "Correct the name"
    ),
    "macro.no-variable": _input(
        "macro",
        "macro {axis} has no variable {value}; known here: {limit}",
        "Correct the name, or add it to the variables of the macro",
    ),
    "macro.value": _input(
        "macro",
        "variable {axis}: {value!r} is not a value",
        "Write a number, a text in two kinds of quotes (\"'text'\"), a list, True or False",
    ),
    "macro.saved-unreadable": _input(
        "macro",
        "the variables of SAVE_VARIABLE are damaged: no macro has them, and none is stored",
        "Correct the file, which is JSON, or remove it, and restart the program",
    ),
    "macro.saved-unwritable": _input(
        "macro",
        "the variable was not stored: {value}",
        "Check the directory, its permissions and the free space on the disk",
    ),
    "macro.no-delay": _input(
        "macro", "there is no [delayed_gcode.{axis}]; known here: {value}", "Correct the name"
    ),
    "input.unknown-moves": _input(
        "gcode",
        "{value} is unknown here; on other firmware it may move or heat the machine",
        "Replace it by the commands that it stands for",
    ),
    "input.no-macro": _input(
        "gcode",
        "{value} is unknown here; it is usually a macro, and the machine file has no"
        " [macros.{value}]",
        "Add this section with its gcode to the machine file",
    ),
    "input.no-levelling": _input(
        "gcode",
        "{value} levels the bed, and this machine has no probe",
        "Remove it from the file and level the bed by hand",
    ),
    "option.unknown": _input(
        "settings",
        "UnknownOption: there is no option {value}",
        "Name one as APrinter does, such as XStepsPerUnit",
    ),
    "command.no-mains": _input(
        "command", "the power supply is off", "Switch it on (M80), then send the command again"
    ),
    "command.fixed": _input(
        "command",
        "{value} is fixed while the printer runs",
        "Change it in the machine file and start again",
    ),
    "command.real-board": _input(
        "command",
        "the boards of this machine are real, and no fault can be simulated on them",
        'Start with a machine file whose [board] table has link = "simulated"',
    ),
    "command.no-fault": _input(
        "command", "{value} is not a fault of this machine: expected {limit}", "Name one of these"
    ),
    "command.fault-order": _input(
        "command", "{value} is not understood: expected {limit}", "Write it like that"
    ),
    "command.failed": _input("command", "{value}", "Remove the cause, then send the command again"),
    "job.stopped": Entry(
        "job",
        "the print stopped: {value}",
        "Remove the cause, then print the file again",
        ExitStatus.MACHINE_FAULT,
    ),
    "command.halted": _input(
        "command",
        "the board is stopped and reports nothing: {value}",
        "Make the printer safe, then send M999",
    ),
    "command.aside": _input(
        "command",
        "{value} changes scales, in which the moves of the paused print are counted",
        "Resume (M24) or cancel (M524), then send the command again",
    ),
    "command.value": _input(
        "command", "{axis} is {value}: expected {limit}", "Send the command with such a value"
    ),
    "command.nothing-moves": _input(
        "command",
        "unknown axis {axis}; this machine has {limit}",
        "Send the command with one of these letters",
    ),
    "heat.unknown": _input(
        "heat",
        "there is no {axis} with number {value}; the machine has {limit}",
        "Give another T or P, or add the heater to the machine file",
    ),
    "heat.no-pid": _input(
        "heat", "heater {axis} is not controlled by PID", "Change its control in the machine file"
    ),
    "heat.no-model": _input(
        "heat",
        "heater {axis} is not controlled by its model",
        "Change its control in the machine file",
    ),
    "heat.no-thermistor": _input(
        "heat", "the sensor of {axis} is not a thermistor", "Change it in the machine file"
    ),
    "heat.reads-nothing": _input(
        "heat",
        "these thermistor values of {axis} give no distinct readings from {limit} °C",
        "Send its R25, beta and pull-up resistor as they are",
    ),
    "heat.unsafe-target": _input(
        "heat",
        "heater {axis} was switched off: {value:g} °C is outside of its safe range, {limit} °C",
        "Give a temperature within it, or change min_c and max_c of the heater",
    ),
    "input.unsaved": _input("moves", "no position was saved as {value}", "Save one with G60 first"),
    "input.not-homed": _input(
        "homing",
        "axis {axis} is not homed",
        "Home it (G28), or set its position (G92)",
    ),
    "input.homing": _input(
        "homing", "{axis} has to wait until all axes are homed", "Send it again when G28 is done"
    ),
    "machine.emergency-stop": Entry(
        "job",
        "emergency stop by M112",
        "Take it out of the file, or end the program there with M2",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.restart": Entry(
        "printer",
        "the printer restarts, as RESTART or FIRMWARE_RESTART asks",
        "Home it before you move it",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.stopped": Entry(
        "job",
        "the print was stopped by M410",
        "Take it out of the file, or end the program there with M2",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.slow-heater": Entry(
        "heat",
        "heater {axis} has reached only {value:.1f} °C of {limit:.1f} °C in an hour",
        "Check its cartridge, its supply, and that its sensor is seated",
        ExitStatus.MACHINE_FAULT,
    ),
    "heat.sensor-open": _heat(
        "heater {axis} was switched off: its sensor reads {value:.1f} °C; below {limit:.1f} °C"
        " means a broken cable",
        "Check the sensor's plug and wires",
    ),
    "heat.sensor-open-high": _heat(
        "heater {axis} was switched off: its sensor reads {value:.1f} °C, which means a broken"
        " cable",
        "Check the sensor's plug and wires",
    ),
    "heat.sensor-short": _heat(
        "heater {axis} was switched off: its sensor reads {value:.1f} °C; above {limit:.1f} °C"
        " means a short circuit in its cable",
        "Check the sensor's wires where they may touch",
    ),
    "heat.sensor-short-low": _heat(
        "heater {axis} was switched off: its sensor reads {value:.1f} °C, which means a short"
        " circuit in its cable",
        "Check the sensor's wires where they may touch",
    ),
    "heat.sensor-erratic": _heat(
        "heater {axis} was switched off: its sensor, at {value:.1f} °C now, keeps jumping by more"
        " than {limit:.1f} °C",
        "Check the sensor's plug and wires where they move",
    ),
    "heat.min-temperature": _heat(
        "heater {axis} was switched off: it is at {value:.1f} °C, below its minimum of {limit:.1f}"
        " °C",
        "Check the sensor, and that the room is not too cold",
    ),
    "heat.max-temperature": _heat(
        "heater {axis} was switched off: it is at {value:.1f} °C, above its maximum of {limit:.1f}"
        " °C",
        "Let it cool, and check its sensor and its control",
    ),
    "heat.heating-failed": _heat(
        "heater {axis} was switched off: it is at {value:.1f} °C and did not reach {limit:.1f} °C"
        " in time",
        "Check its cartridge, its supply, and that its sensor sits where it heats",
    ),
    "heat.runaway": _heat(
        "heater {axis} was switched off: it fell to {value:.1f} °C and stayed below {limit:.1f} °C",
        "Check its cartridge, its supply, and that its sensor sits where it heats",
    ),
    "heat.stuck-on": _heat(
        "heater {axis} gets hotter without power: it is at {value:.1f} °C, above {limit:.1f} °C",
        "Cut its power at once: its MOSFET or relay may be broken",
    ),
    "heat.model-deviation": _heat(
        "heater {axis} was switched off: at {value:.1f} °C it does not behave as its model, by more"
        " than {limit:.2f} of full power",
        "Check cartridge, sensor and fan, or tune its model again",
    ),
    "driver.silent": _driver(
        "its driver, a {value} on {limit}, does not answer",
        "Switch the motors' supply on, check the driver's seat, jumpers and these pins, then M999",
    ),
    "driver.deaf": _driver(
        "its driver, a {value} on {limit}, does not take its settings",
        "Check the wire to it and that no other driver has its address, then M999",
    ),
    "driver.other-chip": _driver(
        "the driver on {limit} is another chip than the machine file says, of version {value}",
        "Correct the motor's driver in the machine file, or the pins",
    ),
    "driver.reset": _driver(
        "its driver, a {value}, was reset: its settings are gone",
        "Check the plugs and wires of the motors' supply, then M999",
    ),
    "driver.short-to-ground": _driver(
        "coil {value} has a short circuit to ground; its driver has switched it off",
        "Cut the power, check the motor's cable and plug, then M999",
    ),
    "driver.short-to-supply": _driver(
        "coil {value} has a short circuit to the supply; its driver has switched it off",
        "Cut the power, check the motor's cable and plug, then M999",
    ),
    "driver.overheated": _driver(
        "its driver, a {value}, is too hot and has switched the motor off",
        "Let it cool, check its fan and heat sink or lower its current (M906), then M999",
    ),
    "driver.hot": _driver(
        "its driver, a {value}, is hot and will soon switch the motor off",
        "Cool it better, or lower its current (M906)",
    ),
    "driver.undervoltage": _driver(
        "its driver, a {value}, has too little voltage to switch on fully",
        "Check the motors' supply and its plugs, then M999",
    ),
    "driver.stopped": _driver(
        "its driver, a {value}, has switched the motor off for a moment: heat or a short circuit",
        "Check the motor's cable and the driver's cooling, then M999",
    ),
    "firmware.board": _firmware(
        "there is no board called {value!r}",
        "Name one of `passo firmware list`, or the path of a machine file",
    ),
    "firmware.none": _firmware(
        "there is no firmware of Passo for {axis}: {value}", "See `passo firmware list`"
    ),
    "firmware.busy": _firmware(
        "firmware is being built already", "Wait until it is done, or cancel it"
    ),
    "firmware.image": _firmware(
        "{value} is no image for {axis}: expected {limit}",
        "Build one (`passo firmware build`), or name the right file",
    ),
    "firmware.port": _firmware(
        "{axis} cannot be flashed through {value}: expected {limit}",
        "Plug the board in and name its port with --port",
    ),
    "firmware.no-port": _firmware(
        "no port was named for {axis}: it needs {limit}",
        "Plug the board in and name its port with --port",
    ),
    "firmware.nobody": _firmware(
        "no confirmation received after: {value}", "Flash from an interactive terminal"
    ),
    "firmware.tool": _firmware(
        "the program {value} is missing, which {axis} needs", "Install it, and try again"
    ),
    "firmware.clock": _firmware(
        "{axis} has a clock of {value} MHz, where the firmware of its chip counts at {limit} MHz",
        "Leave clock_hz out of the machine file: it is for simulated boards and for AVR chips",
    ),
    "firmware.build": _firmware(
        "the firmware of {axis} could not be built: {value}",
        "Check the pins of the motors, and the compiler",
        ExitStatus.BAD_INPUT,
    ),
    "firmware.flash": _firmware(
        "{axis} was not flashed: {value}",
        "Check the cable, the port and the manual steps, and try again",
        ExitStatus.MACHINE_FAULT,
    ),
    "firmware.silent": _firmware(
        "{axis} does not identify itself at {value}",
        "Do the manual steps after flashing, then reset the board; or flash it again",
        ExitStatus.MACHINE_FAULT,
    ),
    "firmware.other": _firmware(
        "{axis} runs another image than the one that was flashed: {value}",
        "Flash it again, and check that this is the board on that port",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.unreachable": Entry(
        "board",
        "the board cannot be reached at {axis}: {value}",
        "Check its cable and supply, and link and port in the machine file",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.silent": Entry(
        "board",
        "the board does not answer {value}",
        "Check its supply, the baud rate, and that its firmware is Passo's or Klipper's",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.dictionary": Entry(
        "board",
        "the board's dictionary does not fit the machine file: {value}",
        "Choose the right board and firmware in the machine file, or build the firmware for it",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.no-reset": Entry(
        "board",
        "{value} is in use and cannot be restarted by a command",
        "Switch its supply off and on (restart the program klipper_mcu of a Linux computer), then"
        " try again",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.old-firmware": Entry(
        "board",
        "the board's firmware is older than this program",
        "Build and flash it again: passo firmware flash",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.closed": Entry(
        "board",
        "the connection to the board has ended",
        "Check its cable and supply, and start again",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.link-failed": Entry(
        "board",
        "the connection to the board was ended: {value}",
        "Check that its firmware is Passo's or Klipper's and fits the machine file",
        ExitStatus.MACHINE_FAULT,
    ),
    "late.stall": _late(
        "the computer did not let Passo run for {held:.2f} s",
        "End other programs on it, or give Passo a higher priority",
    ),
    "late.plan": _late(
        "the moves were planned {held:.2f} s late",
        "End other programs on the computer, take a faster one, or slice with fewer short moves",
    ),
    "late.bytes": _late(
        "the link took no more bytes for {held:.2f} s",
        "Raise the baud rate, or set link_bytes_s in [board.budget] of the machine file",
    ),
    "late.retransmits": _late(
        "bytes were lost and sent again for {held:.2f} s, {bytes} of them so far",
        "Use a shorter cable away from the motors' wires, or 115200 baud",
    ),
    "late.slots": _late(
        "the board's move queue of {slots} commands was full for {held:.2f} s",
        "Set [board.budget] in the machine file, or print more slowly",
    ),
    "machine.alone": Entry(
        "board",
        "the board ran out of commands and braked to a stop",
        "End other programs on the computer, use a shorter or faster link, or start again",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.began-anew": Entry(
        "board",
        "{value} restarted (reset or power failure); position lost",
        "Home the machine; M1000 resumes a print from the card",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.place-unknown": Entry(
        "board",
        "the board does not report where it stopped when the link was lost",
        "Home the machine; M1000 resumes a print from the card",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.displaced": Entry(
        "board",
        "motor {axis} stopped at {value} steps when the link was lost, not at {limit}",
        "Home the machine; M1000 resumes a print from the card",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.no-power": Entry(
        "board",
        "the power supply is off, and a motor was to move",
        "Make the printer safe, switch the power supply on (M80), then send M999",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.idle": Entry(
        "job",
        "idle for {value:g} s (M85)",
        "Make the printer safe, then send M999",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.unstopped": Entry(
        "board",
        "the emergency stop has not reached {value}, which may heat for up to a minute",
        "Cut the printer's power, or bring the link back",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.program": Entry(
        "program",
        "a fault of the program, {value}",
        "Report it, with the last lines that the host has sent",
        ExitStatus.MACHINE_FAULT,
    ),
    "machine.shutdown": Entry(
        "board",
        "the board shut down: {value}",
        "Remove the cause, then start again or send M999",
        ExitStatus.MACHINE_FAULT,
    ),
    "levelling.no-points": _levelling(
        "the machine file has no enabled points to measure", "Add points to [levelling]"
    ),
    "levelling.no-area": _levelling(
        "the machine file has no area to measure", "Add area to [levelling], or another method"
    ),
    "levelling.none": _levelling(
        "the bed was not measured, and no correction is stored", "Measure it (G29 or G32)"
    ),
    "levelling.too-much": _levelling(
        "the bed would be corrected by {value} mm, of at most {limit} mm (max_correction_mm)",
        "Adjust the bed or its endstop, and measure it again",
    ),
    "levelling.too-steep": _levelling(
        "the correction would rise by {value} mm each mm, of at most {limit} (max_slope)",
        "Adjust the bed, and measure it again",
    ),
    "levelling.few-points": _levelling(
        "{value} points are too few for the {method} correction: at least {limit} are needed",
        "Enable or add points of [levelling]",
    ),
    "levelling.close-points": _levelling(
        "points {first} and {second} are {value:.3f} mm apart and count as one: at least {limit:g}"
        " mm are needed",
        "Move or remove one of them",
    ),
    "levelling.line": _levelling(
        "the {value} points deviate from a line by at most {deviation:.3f} mm: at least {limit:g}"
        " mm are needed",
        "Move points, so that they surround the bed",
    ),
    "levelling.conic": _levelling(
        "the {value} points lie on one curve of second degree: they determine {rank} of {limit}"
        " coefficients",
        "Add a point in the middle, or use the linear correction",
    ),
    "levelling.no-height": _levelling(
        "the height at point {place} is {value}, not a finite number", "Probe the bed again"
    ),
    "levelling.mesh-size": _levelling(
        "the mesh has {value}: expected {limit}", "Give a height for each point, or probe again"
    ),
    "levelling.uneven": _levelling(
        "{axis} {value:g} is not on the even grid of the mesh: expected {limit:g} mm",
        "Give points at even distances, in ascending order",
    ),
    "levelling.empty-area": _levelling(
        "no point of the grid is within {value:g} mm of its middle", "Give a larger radius"
    ),
    "levelling.outside-job": _levelling(
        "the job covers {value}, outside of the mesh: {limit}",
        "Move the objects onto the mesh, or probe the whole bed",
    ),
    "levelling.bad-area": _levelling(
        "the area {value} is empty", "Give its lower corner first: [x0, y0, x1, y1]"
    ),
    "levelling.overlap": _levelling(
        "the areas to avoid {value} and {limit} overlap", "Make one area of both"
    ),
    "levelling.all-avoided": _levelling(
        "point {value} lies in the area to avoid {limit}, and no place around it is on the mesh",
        "Make the area smaller, or the mesh larger",
    ),
    "levelling.fade": _levelling(
        "the correction fades over {value:g} mm, but the bed differs by {limit:.3f} mm: the fade"
        " must be longer than that",
        "Give a greater end of the fade, or correct the bed by its screws",
    ),
    "levelling.motor-adjustment": _levelling(
        "motor {axis} would move {value:.3f} mm against another: at most {limit:g} mm are allowed",
        "Level the gantry by hand, check the pivots, or raise max_adjust_mm",
    ),
    "levelling.motor-order": _levelling(
        "the points differ by {value:.3f} mm, after {limit:.3f} mm in the round before: the"
        " adjustment makes the tilt worse, and the Z motors {order} may be in another order",
        "Compare the order of motors and pivots; move one motor and see which corner rises",
    ),
    "levelling.skew": _levelling(
        "no parallelogram has the lengths {value} of AC, BD and AD",
        "Measure both diagonals and the side AD of the printed square again",
    ),
    "levelling.delta-rods": _levelling(
        "rods cannot be found from heights alone: measured distances are needed",
        "Calibrate 6 factors, or give distances of a print",
    ),
    "levelling.delta-points": _levelling(
        "the {value} measurements determine {rank} of {limit} parameters",
        "Probe more points, in the middle and around the bed",
    ),
    "levelling.delta-nowhere": _levelling(
        "the calibration leads to a delta that cannot reach the probed points: {value}",
        "Correct radius, rods and endstops of the machine file, then calibrate again",
    ),
    "levelling.delta-worse": _levelling(
        "the points deviate after the calibration by rms {value:.4f} mm, before it {limit:.4f} mm",
        "The old parameters stay. Check the probe, then calibrate again",
    ),
    "levelling.delta-change": _levelling(
        "{axis} would change from {before:.4f} to {value:.4f}: at most {limit:g} {unit} are"
        " allowed",
        "The old parameters stay. Correct the machine file, or check the probe",
    ),
    "levelling.mesh-name": _levelling(
        "{value!r} cannot be the name of a mesh",
        "Use at most 40 letters, digits, dots, dashes and underscores; first a letter or digit",
    ),
    "levelling.mesh-file": _levelling(
        "holds {value!r} in a mesh: expected {limit}",
        "Probe the bed again, or restore the file",
    ),
}


def codes_of(subject: str) -> tuple[str, ...]:
    """All codes that begin with `subject.`."""
    return tuple(code for code in CATALOGUE if code.startswith(f"{subject}."))
