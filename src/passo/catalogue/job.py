"""Errors of prints, of the queue and of the history."""

from __future__ import annotations

from collections.abc import Mapping

from passo.catalogue.entry import Entry, ExitStatus, bad_input

JOB: Mapping[str, Entry] = {
    "job.at-end": bad_input(
        "job", "{value} has been printed to its end", "Rewind it with M26 S0, then send M24"
    ),
    "job.no-file": bad_input(
        "job", "no file is selected", "Select one (M23), after listing the card"
    ),
    "job.failed": bad_input(
        "job",
        "{value}",
        "Correct the cause, then continue after this command (M24), or cancel (M524)",
    ),
    "job.no-objects": bad_input(
        "job",
        "no file that labels its objects is being printed",
        "Start one that was sliced with labels (M486 or EXCLUDE_OBJECT), then send it again",
    ),
    "job.no-object": bad_input(
        "job",
        "{value} is not an object of this print: expected {limit}, or a name",
        "List the objects with M486, then name one",
    ),
    "job.several-objects": bad_input(
        "job",
        "several objects have the name {value}: {limit}",
        "Choose one by its number (M486 P)",
    ),
    "job.no-current-object": bad_input(
        "job",
        "no object is being printed at this moment",
        "Name the object: M486 P<number> or EXCLUDE_OBJECT NAME=<name>",
    ),
    "job.no-object-order": bad_input(
        "job", "{value} names no object: expected {limit}", "Correct it and send it again"
    ),
    "job.objects-and-laser": bad_input(
        "job",
        "objects cannot be cancelled on a machine with a laser, which would burn at standstill",
        "Cancel the print (M524)",
    ),
    "job.other-macros": bad_input(
        "job",
        "the macros of the machine file have changed since the print began, so the position in the"
        " file cannot be found",
        "Restore the macros as they were, then send M1000",
    ),
    "job.never-homed": bad_input(
        "job",
        "set the position of {value} by G92, without homing; that position is lost since the"
        " interruption",
        "Forget the print (M1000 C)",
    ),
    "job.no-part": bad_input(
        "job",
        "needs {value}, which is missing from the machine file",
        "Restore that section and restart Passo, or forget the print (M1000 C)",
    ),
    "job.other-file": bad_input(
        "job",
        "is not the file that was printed, or cannot be resumed on this machine",
        "Put back the card with that file, or forget the print (M1000 C)",
    ),
    "job.other-machine": bad_input(
        "job", "was printed on another machine", "Forget the print (M1000 C)"
    ),
    "job.nothing-interrupted": bad_input(
        "job", "no print was interrupted", "Select a file (M23) and start it (M24)"
    ),
    "job.printing": bad_input(
        "job", "{value} is being printed", "Wait until it is done, or cancel it (M524)"
    ),
    "job.stopped": Entry(
        "job",
        "the print stopped: {value}",
        "Remove the cause, then print the file again",
        ExitStatus.MACHINE_FAULT,
    ),
    "queue.empty": bad_input("queue", "no print waits in the queue", "Add a file to it first"),
    "queue.full": bad_input(
        "queue", "{limit} prints wait already, the maximum", "Start or remove one of them first"
    ),
    "queue.unknown": bad_input(
        "queue", "there is no print {value} in the queue", "Read the queue again"
    ),
    "queue.bed": bad_input(
        "queue", "the bed is not confirmed to be clear", "Clear the bed, then confirm that"
    ),
    "queue.unwritable": bad_input(
        "queue",
        "the queue was not changed, because it cannot be stored: {value}",
        "Check the directory, its permissions and the free space on the disk",
    ),
    "run.unknown": bad_input(
        "job",
        "no print was started with the run id {value}; the printer keeps the last {limit}",
        "Start the print with this run id, if no printer has printed it",
    ),
    "run.invalid": bad_input(
        "job", "{value!r} is not a run id: expected a UUID", "Make one with `uuidgen`"
    ),
    "run.unwritable": bad_input(
        "job",
        "the print was not started, because its run id cannot be stored: {value}",
        "Check the directory, its permissions and the free space on the disk",
    ),
    "run.damaged": bad_input(
        "job",
        "is damaged, so it is unknown which prints have started, and none was started: {value}",
        "Check what this printer has printed, delete the file, then restart Passo",
    ),
    "history.unusable": bad_input(
        "job",
        "the history of prints cannot be used: {value}",
        "Close it in other programs; if it is damaged, move it away and start again",
    ),
}
