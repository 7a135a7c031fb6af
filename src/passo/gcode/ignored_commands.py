"""Commands that are accepted and have no effect, each with the reason."""

from __future__ import annotations

from passo.gcode.parameters import Parameter, anything, rest
from passo.gcode.registry import Declaration, Kind, Subject, When, declare


def _declare(kind: Kind, takes: Parameter, *rows: tuple[str, str]) -> None:
    """Declares codes, with the reason of each."""
    declare(
        *(
            Declaration(code, Subject.NO_EFFECT, When.PLANNED, reason, (takes,), kind)
            for codes, reason in rows
            for code in codes.split()
        )
    )


_declare(
    Kind.QUIET,
    anything(),
    ("G40", "Passo has no tool radius compensation."),
    ("G43 G49", "Passo has no tool length compensation."),
    ("G54", "Passo has one coordinate system; G92 moves its zero."),
    ("G94", "F is always in mm per minute."),
    ("M6", "T selects the tool."),
    ("M7 M8 M9", "Passo has no coolant."),
    ("M413", "A print can always be resumed if the printer has a folder for its journal."),
    (
        "M862 M862.1 M862.2 M862.3 M862.4 M862.5 M862.6",
        "The command checks that the printer is a Prusa.",
    ),
    ("M907", "M906 and the machine file set motor currents."),
    ("CLEAR_PAUSE", "A pause is over when its print is."),
)
_declare(
    Kind.NOT_BUILT,
    rest(),
    ("G12", "Passo has no nozzle wiper."),
    (
        "RUN_SHELL_COMMAND",
        "Passo starts no program of the computer; a program can call it, by the web API.",
    ),
    ("SET_DISPLAY_GROUP", "Passo has no display yet."),
    ("MANUAL_STEPPER", "Passo has no motors beside axes and extruders."),
    ("BED_MESH_OFFSET", "The correction of the bed follows the nozzle of the tool in use (M218)."),
    ("G27 M125", "M25 and M601 park the head."),
    ("M111", "Passo has no debug levels; see passo serve --log."),
    ("M192", "Passo does not wait for a cooler. M142 sets its temperature."),
    ("M163 M164 M165 M166", "Passo has no mixing extruder."),
    ("M202", "M201 limits the axes in every move, M204 T all travel."),
    ("M222", "Purges have the flow of M221."),
    ("M250", "Passo has no display yet."),
    ("M281", "The machine file sets the angles of the servo of a probe."),
    ("M351", "The machine file sets microsteps."),
    (
        "M512 M604",
        "M591 reports filament sensors; the machine file has their lengths.",
    ),
    ("M428", "M206 sets home offsets."),
    ("M595", "The machine file sets the values of amplifiers."),
    ("M605", "Passo has one carriage for all tools."),
    ("M800", "M1000 resumes a print that was interrupted."),
    ("M908", "M906 and the machine file set motor currents."),
)
declare(
    Declaration(
        "G1 A0",
        Subject.NO_EFFECT,
        When.PLANNED,
        "A0, B0 or C0 in a move of a machine without this axis: post-processors of CAM programs,"
        " Fusion 360 for one, write the angle of a rotary axis that never turns. Slicers write"
        " G92 E0 for a machine without an extruder, too.",
        (),
        Kind.NOT_BUILT,
    )
)
