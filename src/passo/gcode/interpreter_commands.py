"""Commands that the interpreter in the core executes, without a handler in Python.
`core/gcode/word_grammar.hpp` has the same rules for their words."""

from __future__ import annotations

from passo.gcode.parameters import TOOL, Parameter, axes, ignored, integer, number, text
from passo.gcode.registry import Declaration, Kind, Subject, When, declare

READ_FIRST = frozenset({"G28", "M5", "M98", "M99", "M486"})
"""Commands with a handler in Python that the interpreter in the core reads first."""

_MOVE = (
    axes("X Y Z E", "the end of the move", "mm"),
    number("F", "the feedrate", "mm/min"),
    number("T", "the duration, in place of F", "s"),
    text("R", "the axes that are relative; the others are absolute"),
)
_ARC = (
    axes("X Y Z E", "the end of the arc", "mm"),
    number("F", "the feedrate", "mm/min"),
    number("I J K", "the centre, from the start", "mm"),
    number("R", "the radius, in place of the centre", "mm"),
    integer("P", "full turns", 0),
)
_HOLE = (
    number("X Y Z", "the hole and its depth", "mm"),
    number("R", "the level to which the drill returns", "mm"),
    integer("L", "repeats", 0),
    number("F", "the feedrate", "mm/min"),
)


def _declare(subject: Subject, *rows: tuple[str, str, *tuple[Parameter, ...]]) -> None:
    """The code, text and parameters of each command."""
    for code, about, *parameters in rows:
        declare(Declaration(code, subject, When.PLANNED, about, tuple(parameters), Kind.MOTION))


_declare(
    Subject.MOVES,
    (
        "G0",
        "Travels in a straight line. F or T holds for this line and the next ones. Laser and"
        " spindle do no work.",
        *_MOVE,
    ),
    (
        "G1",
        "Moves in a straight line. R makes all positions absolute except those of its letters,"
        " which are relative. With H1, H2 or letters of motors it is G1 H1, G1 H2 or G1 A.",
        *_MOVE,
        number("S", "the power of the laser", low=0),
        integer("H", "1 and 2: as G1 H1 and G1 H2", 0, 2),
    ),
    (
        "G2",
        "Moves clockwise on an arc or a helix.",
        *_ARC,
    ),
    (
        "G3",
        "Moves counter-clockwise on an arc or a helix.",
        *_ARC,
    ),
    (
        "G4",
        "Waits for this time (dwell).",
        number("S", "seconds", "s", 0),
        number("P", "milliseconds", "ms", 0),
    ),
    (
        "G61",
        "Moves these axes to the saved position S, each with its number as an offset. Without"
        " letters it moves X, Y and Z.",
        integer("S", "the memory", 0, 1, default=0),
        axes("X Y Z E", "an offset from the saved position", "mm", alone=True),
        number("F", "the feedrate", "mm/min"),
    ),
)
_declare(
    Subject.POSITIONS,
    ("G17", "Selects the plane XY for arcs."),
    ("G18", "Selects the plane ZX for arcs."),
    ("G19", "Selects the plane YZ for arcs."),
    ("G20", "Sets the unit of lengths to inches."),
    ("G21", "Sets the unit of lengths to millimetres."),
    (
        "G53",
        "Makes the positions of this line absolute machine positions, after G91 too. Offsets of"
        " G92 and of tools do not count.",
    ),
    ("G90", "Makes positions absolute."),
    ("G91", "Makes positions relative, those of the extruder too."),
    (
        "G92",
        "Sets the position of the program without a move. Letters of motors set the positions of"
        " the motors.",
        axes("X Y Z E", "the position that counts from now on", "mm"),
    ),
    ("M82", "Makes positions of the extruder absolute."),
    ("M83", "Makes positions of the extruder relative."),
)
_declare(
    Subject.DRILLING,
    (
        "G73",
        "Drills to Z in steps of Q, and backs off by 0.254 mm after each step. Parameters as G81.",
        *_HOLE,
        number("Q", "the depth of a step", "mm"),
    ),
    (
        "G81",
        "Drills: travels to X Y, travels to R, feeds to Z with F, travels back (G98, G99). The next"
        " lines need only the words that change, until G80 or G0 to G3. K is L. After G91, R counts"
        " from the position of the axis, Z from R, and X Y move on with each repeat. In G18 and G19"
        " the hole is along Y and X.",
        *_HOLE,
    ),
    (
        "G82",
        "Drills as G81, and waits P seconds at the bottom.",
        *_HOLE,
        number("P", "the wait at the bottom", "s", 0),
    ),
    (
        "G83",
        "Drills as G73, but travels back to R after each step, and then down to 0.254 mm above the"
        " last depth.",
        *_HOLE,
        number("Q", "the depth of a step", "mm"),
    ),
    (
        "G98",
        "Between holes, cycles return to the level before the first hole, or to R if R is higher.",
    ),
    ("G99", "Between holes, cycles return to R."),
)
_declare(
    Subject.FILAMENT,
    (
        "G10",
        "Retracts the filament, with S1 by the length for a tool change. With P it sets the"
        " temperatures of a tool instead.",
        number("S", "1: the length for a tool change; with P the temperature of the tool"),
        integer("P", "a tool, whose temperatures S and R are", 0),
        number("R", "with P its temperature while another tool is in use", "°C"),
    ),
    ("G11", "Unretracts the filament."),
    ("T", "Selects a tool. The next move of an axis carries out the tool's offset on all axes."),
    (
        "M207",
        "Sets the retraction of G10: length, feedrate, hop. R is S of M208, W the length with S1.",
        number("S", "the length", "mm", 0),
        number("F", "the feedrate", "mm/min", 0),
        number("Z", "the hop", "mm", 0),
        number("R", "S of M208", "mm"),
        number("W", "the length of G10 S1", "mm", 0),
    ),
    (
        "M208",
        "Sets the extra length of G11, W after G10 S1; below 0 it is left out. F0 is the feedrate"
        " of M207.",
        number("S", "the extra length", "mm"),
        number("F", "the feedrate; 0: that of M207", "mm/min", 0),
        number("W", "the extra length after G10 S1", "mm"),
    ),
    (
        "M701",
        "Loads filament, with the nozzle raised by Z meanwhile.",
        TOOL,
        number("L", "the length; M603 sets the usual one", "mm"),
        number("Z", "how high the nozzle is meanwhile", "mm"),
    ),
    (
        "M702",
        "Unloads filament, with the nozzle raised by Z meanwhile.",
        TOOL,
        number("U", "the length; M603 sets the usual one", "mm"),
        number("Z", "how high the nozzle is meanwhile", "mm"),
        ignored("C"),
    ),
)
