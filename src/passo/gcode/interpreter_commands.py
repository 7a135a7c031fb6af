"""Commands that the interpreter in the core executes, without a handler in Python.
`core/gcode/word_grammar.hpp` has the same rules for their words."""

from __future__ import annotations

from passo.gcode.registry import AXES, Declaration, Kind, Subject, When, declare


def _declare(subject: Subject, *rows: tuple[str, str, str]) -> None:
    """The code, parameters and text of each command."""
    for code, parameters, text in rows:
        declare(Declaration(code, subject, When.PLANNED, parameters, text, Kind.MOTION))


_declare(
    Subject.MOVES,
    (
        "G0",
        "X Y Z E F(mm/min) T(s) R(letters)",
        "Travels in a straight line. F or T holds for this line and the next ones. Laser and"
        " spindle do no work.",
    ),
    (
        "G1",
        "X Y Z E F(mm/min) T(s) R(letters) S(laser) H(0-2)",
        "Moves in a straight line. R makes all positions absolute except those of its letters,"
        " which are relative. With H1, H2 or letters of motors it is G1 H1, G1 H2 or G1 A.",
    ),
    ("G2", "X Y Z E F I J K R P(turns)", "Moves clockwise on an arc or a helix."),
    ("G3", "X Y Z E F I J K R P(turns)", "Moves counter-clockwise on an arc or a helix."),
    ("G4", "S(s) P(ms)", "Waits for this time (dwell)."),
)
declare(
    Declaration(
        "G61",
        Subject.MOVES,
        When.PLANNED,
        "S(0-1) X Y Z E F(mm/min)",
        "Moves these axes to the saved position S, each with its number as an offset. Without"
        " letters it moves X, Y and Z.",
        Kind.MOTION,
        bare=AXES,
    )
)
_declare(
    Subject.POSITIONS,
    ("G17", "", "Selects the plane XY for arcs."),
    ("G18", "", "Selects the plane ZX for arcs."),
    ("G19", "", "Selects the plane YZ for arcs."),
    ("G20", "", "Sets the unit of lengths to inches."),
    ("G21", "", "Sets the unit of lengths to millimetres."),
    (
        "G53",
        "",
        "Makes the positions of this line absolute machine positions, after G91 too. Offsets of"
        " G92 and of tools do not count.",
    ),
    ("G90", "", "Makes positions absolute."),
    ("G91", "", "Makes positions relative, those of the extruder too."),
    (
        "G92",
        "X Y Z E, A B C",
        "Sets the position of the program without a move. Letters of motors set the positions of"
        " the motors.",
    ),
    ("M82", "", "Makes positions of the extruder absolute."),
    ("M83", "", "Makes positions of the extruder relative."),
)
_declare(
    Subject.DRILLING,
    (
        "G73",
        "X Y Z R Q L(repeats) F",
        "Drills to Z in steps of Q, and backs off by 0.254 mm after each step. Parameters as G81.",
    ),
    (
        "G81",
        "X Y Z R L(repeats) F",
        "Drills: travels to X Y, travels to R, feeds to Z with F, travels back (G98, G99). The next"
        " lines need only the words that change, until G80 or G0 to G3. K is L. After G91, R counts"
        " from the position of the axis, Z from R, and X Y move on with each repeat. In G18 and G19"
        " the hole is along Y and X.",
    ),
    ("G82", "X Y Z R P(s) L(repeats) F", "Drills as G81, and waits P seconds at the bottom."),
    (
        "G83",
        "X Y Z R Q L(repeats) F",
        "Drills as G73, but travels back to R after each step, and then down to 0.254 mm above the"
        " last depth.",
    ),
    (
        "G98",
        "",
        "Between holes, cycles return to the level before the first hole, or to R if R is higher.",
    ),
    ("G99", "", "Between holes, cycles return to R."),
)
_declare(
    Subject.FILAMENT,
    (
        "G10",
        "S1",
        "Retracts the filament, with S1 by the length for a tool change. With P it sets the"
        " temperatures of a tool instead.",
    ),
    ("G11", "", "Unretracts the filament."),
    (
        "T",
        "",
        "Selects a tool. The next move of an axis carries out the tool's offset on all axes.",
    ),
    (
        "M207",
        "S(mm) F Z(mm) R(mm) W(mm)",
        "Sets the retraction of G10: length, feedrate, hop. R is S of M208, W the length with S1.",
    ),
    (
        "M208",
        "S(mm) F W(mm)",
        "Sets the extra length of G11, W after G10 S1; below 0 it is left out. F0 is the feedrate"
        " of M207.",
    ),
    ("M701", "T L(mm) Z(mm)", "Loads filament, with the nozzle raised by Z meanwhile."),
)
declare(
    Declaration(
        "M702",
        Subject.FILAMENT,
        When.PLANNED,
        "T U(mm) Z(mm)",
        "Unloads filament, with the nozzle raised by Z meanwhile.",
        Kind.MOTION,
        bare="C",
    )
)
