"""The dialect table: one row a command. Documentation and warnings follow it, and a test holds the
printer to it."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple


class Kind(Enum):
    """Who carries a command out."""

    MOTION = "motion"  # the interpreter in the core
    PRINTER = "printer"  # a handler of the printer
    PERSON = "person"  # waits for a person; a headless print goes on
    QUIET = "quiet"  # means nothing without a console, and does no harm
    SERVED = "served"  # changes a printer that is served; a print without consoles is warned
    NOT_BUILT = "not built"  # means nothing here: a console hears why, a headless print is warned


class When(Enum):
    """When a command of a console acts."""

    IMMEDIATE = "immediate"  # as soon as its line is reached, whoever moves the machine
    PLANNED = "planned"  # in its place among the moves
    EXCLUSIVE = "exclusive"  # when the machine stands, and nobody else moves it meanwhile
    AHEAD = "ahead"  # before all lines that wait


class Row(NamedTuple):
    """A command: its code, who carries it out in a print without consoles, when it acts on a
    console, its parameters, one sentence, and which letters need no number or may be repeated."""

    code: str
    kind: Kind
    when: When
    parameters: str
    text: str
    bare: str | None = ""  # letters that may stand alone; None: what follows is not read as words
    nan: bool = False  # `S nan` is no number, and switches the heater off
    repeats: str = ""  # letters that may come more than once
    lacks: str = ""  # why it does nothing on a machine without the part; else `text` says it


ANY = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"
_AXES = "ABCDEHIJKUVWXYZ"  # also names of motors

_M, _P, _H, _Q = Kind.MOTION, Kind.PRINTER, Kind.PERSON, Kind.QUIET
_S, _B = Kind.SERVED, Kind.NOT_BUILT
_I, _N, _X, _A = When.IMMEDIATE, When.PLANNED, When.EXCLUSIVE, When.AHEAD

TABLE: tuple[Row, ...] = (
    Row(
        "G0", _M, _N, "X Y Z E F(mm/min) T(s) R(letters)", "Moves in a straight line, without work."
    ),
    Row(
        "G1",
        _M,
        _N,
        "X Y Z E F(mm/min) T(s) R(letters) S(laser)",
        "Moves in a straight line; with R to absolute positions, but relative ones of its letters.",
    ),
    Row("G2", _M, _N, "X Y Z E F I J K R P(turns)", "Moves clockwise on an arc or a helix."),
    Row(
        "G3", _M, _N, "X Y Z E F I J K R P(turns)", "Moves counter-clockwise on an arc or a helix."
    ),
    Row("G4", _M, _N, "S(s) P(ms)", "Waits."),
    Row(
        "G10",
        _M,
        _N,
        "S1",
        "Retracts the filament, with S1 as for a change of tools; with P it sets a tool's"
        " temperatures instead.",
    ),
    Row("G11", _M, _N, "", "Takes the retraction back."),
    Row("G17", _M, _N, "", "Arcs lie in XY."),
    Row("G18", _M, _N, "", "Arcs lie in ZX."),
    Row("G19", _M, _N, "", "Arcs lie in YZ."),
    Row("G20", _M, _N, "", "Lengths are inches."),
    Row("G21", _M, _N, "", "Lengths are millimetres."),
    Row(
        "G28",
        _P,
        _X,
        "X Y Z O B",
        "Homes these axes, all without letters, with O only those that do not know where they are;"
        " with B it goes back to where it was. Without a console it sets them to home.",
        bare=ANY,
    ),
    Row(
        "G53",
        _M,
        _N,
        "",
        "Absolute positions of this line count from the machine's zero, after G91 too: without what"
        " G92 and tools' offsets shift.",
    ),
    Row("G60", _M, _N, "S(0-1)", "Saves the position."),
    Row(
        "G61",
        _M,
        _N,
        "S(0-1) X Y Z E F(mm/min)",
        "Moves these axes to the saved position, or so far beside it; X, Y and Z without letters.",
        bare=_AXES,
    ),
    Row(
        "G73",
        _M,
        _N,
        "X Y Z R Q L(repeats) F",
        "Drills to Z by Q at a time, and backs off by 0.254 mm in between. Words as G81.",
    ),
    Row(
        "G80",
        _P,
        _N,
        "",
        "Ends a canned cycle. Where filament is printed and there is no cycle, it asks for bed"
        " levelling, as Prusa's firmware does.",
        bare=ANY,
    ),
    Row(
        "G81",
        _M,
        _N,
        "X Y Z R L(repeats) F",
        "Drills: rapidly to X Y, rapidly to R, with F to Z, rapidly back (G98, G99). Lines that"
        " follow need only what changes, until G80 or G0 to G3. K is L. After G91 R counts from"
        " where the axis is, Z from R, and each repeat is X Y further. In G18 and G19 the hole lies"
        " along Y and X.",
    ),
    Row("G82", _M, _N, "X Y Z R P(s) L(repeats) F", "As G81, and waits P seconds at the bottom."),
    Row(
        "G83",
        _M,
        _N,
        "X Y Z R Q L(repeats) F",
        "As G73, but goes rapidly back to R in between, and down to 0.254 mm above the last depth.",
    ),
    Row("G90", _M, _N, "", "Positions are absolute."),
    Row("G91", _M, _N, "", "Positions are relative, the extruder's too."),
    Row(
        "G92",
        _M,
        _N,
        "X Y Z E, A B C",
        "Sets the program's position without motion; letters of motors say where these are.",
    ),
    Row(
        "G98",
        _M,
        _N,
        "",
        "Between holes cycles go to the level that the axis had before the first, or R if that is"
        " higher.",
    ),
    Row("G99", _M, _N, "", "Between holes cycles go to R."),
    Row("M0", _H, _X, "S(s) P(ms) text", "Waits for a person, M108 or the time.", bare=None),
    Row("M1", _H, _X, "S(s) P(ms) text", "Waits for a person, M108 or the time.", bare=None),
    Row("M2", _P, _X, "", "Ends the program."),
    Row("EOF", _P, _X, "", "Ends the program."),
    Row("M3", _P, _N, "S", "Laser or spindle on.", bare="I"),
    Row(
        "M4",
        _P,
        _N,
        "S",
        "Laser on; less power where the head is slower, off at standstill and on G0.",
        bare="I",
    ),
    Row("M5", _P, _N, "", "Laser or spindle off.", bare="I"),
    Row("M17", _Q, _N, "X Y Z E", "Motors on; a move turns them on anyway.", bare=_AXES + "RS"),
    Row(
        "M18",
        _P,
        _X,
        "X Y Z E S(s)",
        "Motors off when the machine is still; S: after standing idle so long, with no heater on.",
        bare=_AXES,
    ),
    Row(
        "M20",
        _Q,
        _I,
        "L T, D(directory)",
        "Lists the card's programs, with long names (L) and times (T); D lists one directory.",
        bare=None,
    ),
    Row("M21", _Q, _I, "", "Mounts the SD card again."),
    Row("M22", _S, _I, "", "Releases the SD card."),
    Row(
        "M23",
        _S,
        _I,
        "name, or F(file) D(directory) R",
        "Selects a file to print; D and R choose the directory that names count from.",
        bare=None,
    ),
    Row(
        "M24",
        _S,
        _I,
        "S(byte) U",
        "Prints the selected file, or ends a pause; U1 also where it has unknown commands that may"
        " move the machine, or levels a bed that has no probe.",
    ),
    Row("M25", _H, _I, "", "Pauses the print: brakes on the path, and parks."),
    Row("M26", _S, _I, "S(byte)", "The next start begins at this byte; in a pause S0 cancels."),
    Row(
        "M27",
        _Q,
        _I,
        "C S(s)",
        "Tells how far the print is, by itself every S seconds; C names the file.",
        bare="C",
    ),
    Row("M28", _S, _I, "name", "What follows goes into a file, until M29.", bare=None),
    Row("M29", _S, _I, "", "Ends the file that is written: now it is on the card.", bare=None),
    Row("M30", _P, _I, "name", "Deletes a file. In a program it ends it.", bare=None),
    Row("M31", _Q, _I, "", "Tells how long the print has taken."),
    Row("M32", _S, _I, "name", "Selects a file and prints it.", bare=None),
    Row(
        "M33",
        _Q,
        _I,
        "name",
        "Tells a file's long name; without a name it cancels the print.",
        bare=None,
    ),
    Row("M34", _Q, _I, "", "Files are always sorted by name.", bare=None),
    Row("M36", _Q, _I, "name", "Tells a file's size and time.", bare=None),
    Row(
        "M73",
        _Q,
        _I,
        "P(%) R(min)",
        "A slicer's progress, where nothing better is known; without words tells it.",
        bare="PR",
    ),
    Row("M75", _Q, _I, "", "Starts the print timer.", bare=None),
    Row("M76", _Q, _I, "", "Halts the print timer.", bare=None),
    Row("M77", _Q, _I, "", "Stops the print timer and tells it.", bare=None),
    Row("M78", _Q, _I, "S78", "Tells what was printed; S78 forgets it."),
    Row("M80", _Q, _X, "S", "Power supply on; S reports whether it is.", bare="S"),
    Row("M81", _S, _X, "", "Heaters and motors off, and the power supply if it has a pin."),
    Row("M82", _M, _N, "", "The extruder's positions are absolute."),
    Row("M83", _M, _N, "", "The extruder's positions are relative."),
    Row("M84", _P, _X, "X Y Z E S(s)", "As M18.", bare=_AXES),
    Row("M85", _S, _I, "S(s)", "Everything off after standing idle so long; 0: never."),
    Row(
        "M92",
        _S,
        _X,
        "X Y Z E T, H(microsteps) L(mm)",
        "Steps for a millimetre; H and L tell which layer heights are whole steps of Z's motor.",
    ),
    Row("CANCEL_PRINT", _S, _I, "", "Cancels the print, as M524.", bare=None),
    Row("PAUSE", _H, _I, "", "Pauses the print, as M25.", bare=None),
    Row("RESUME", _S, _I, "", "Ends a pause, as M24.", bare=None),
    Row(
        "SDCARD_PRINT_FILE",
        _S,
        _I,
        "FILENAME",
        "Selects a file by its path on the card, and prints it.",
        bare=None,
    ),
    Row("SDCARD_RESET_FILE", _S, _I, "", "No file is selected any more.", bare=None),
    Row(
        "SET_GCODE_VARIABLE",
        _P,
        _N,
        "MACRO VARIABLE VALUE",
        "Sets a variable of a macro, until the program ends.",
        bare=None,
    ),
    Row(
        "UPDATE_DELAYED_GCODE",
        _S,
        _N,
        "ID DURATION(s)",
        "Carries out the delayed G-code of this name after this time; with 0 not at all.",
        bare=None,
    ),
    Row(
        "M98",
        _P,
        _N,
        "P(number) L(repeats)",
        "Carries out the sub-program of this O number, or from this N number on, up to M99: of a"
        " file, behind the M30, M2 or M99 that ends its main program. Up to 10 within each other.",
        bare=None,
    ),
    Row(
        "M99",
        _P,
        _X,
        "",
        "Ends a sub-program; in the main program of a file it ends the program. With axes:"
        " backlash, which is not made up for.",
        bare=ANY,
    ),
    Row(
        "M104",
        _P,
        _N,
        "S(°C) I T P F",
        "Sets the hotend's temperature, by S or a material I of M145; without them it goes off,"
        " with F at once.",
        bare="F",
        nan=True,
    ),
    Row("M105", _Q, _I, "", "Tells the temperatures.", bare="R"),
    Row(
        "M106",
        _P,
        _N,
        "S(0-255) P F",
        "Sets a fan's speed. F: at once. Without S it is full, but settings of the machine file"
        " alone (U I H L X T, F with a number) change nothing.",
        bare="F",
    ),
    Row("M107", _P, _N, "P F", "Turns a fan off. F: at once.", bare="F"),
    Row("M108", _Q, _A, "", "Cancels the current wait."),
    Row(
        "M109",
        _P,
        _X,
        "S(°C) R(°C) I T P",
        "Sets the hotend's temperature and waits for it; R waits for cooling too, I is a material"
        " of M145.",
        bare="F",
        nan=True,
    ),
    Row("M110", _Q, _I, "N", "The number of the line before the next one.", bare=None),
    Row(
        "M112",
        _P,
        _A,
        "",
        "Everything off at once; M999 restarts. A print without consoles fails there.",
    ),
    Row("M113", _Q, _I, "S(s)", "How often a command that waits says so.", bare="S"),
    Row(
        "M114",
        _Q,
        _I,
        "D R",
        "Tells the position: where the program is; R where the machine is now; D both.",
        bare="DRE",
    ),
    Row("M115", _Q, _I, "", "Tells firmware and capabilities.", bare=None),
    Row(
        "M116",
        _P,
        _X,
        "T B C",
        "Waits for these heaters, all without letters.",
        bare="TPBC",
        repeats="TPBC",
    ),
    Row("M117", _Q, _I, "text", "A message for displays and hosts.", bare=None),
    Row("M118", _Q, _I, "E1 A1 text", "A line for all consoles.", bare=None),
    Row("M119", _Q, _I, "", "Reports which endstops are triggered."),
    Row("M120", _S, _I, "", "Endstops are watched while the machine moves."),
    Row("M121", _S, _I, "", "Endstops count only for homing."),
    Row(
        "M122",
        _Q,
        _I,
        "S",
        "Tells the limits of the axes, which always hold, and of drivers and link.",
        bare="IVXYZE",
    ),
    Row("M123", _Q, _I, "X Y Z", "Tells the logic of the switches, which the machine file sets."),
    Row("M124", _Q, _I, "X Y Z", "As M123: it tells the pull-ups, too."),
    Row(
        "M140",
        _P,
        _N,
        "S(°C) I P F",
        "Sets the bed's temperature, by S or a material I of M145.",
        bare="F",
        nan=True,
    ),
    Row("M141", _P, _N, "S(°C) P F", "Sets the chamber's temperature.", bare="F", nan=True),
    Row(
        "M145",
        _P,
        _I,
        "S H B F",
        "Sets a material, 0 to 2, for the I of M104, M109, M140 and M190; without S it tells them.",
    ),
    Row("M154", _Q, _I, "S(s)", "Tells the position every S seconds.", bare="S"),
    Row("M155", _Q, _I, "S(s)", "Tells the temperatures every S seconds.", bare="S"),
    Row("M149", _Q, _I, "C", "Temperatures are in °C; other units are refused.", bare="CKF"),
    Row(
        "M190",
        _P,
        _X,
        "S(°C) R(°C) I P",
        "Sets the bed's temperature, by S, R or a material I of M145, and waits for it.",
        bare="F",
        nan=True,
    ),
    Row(
        "M191",
        _P,
        _X,
        "S(°C) R(°C) P",
        "Sets the chamber's temperature and waits for it.",
        bare="F",
        nan=True,
    ),
    Row(
        "M200",
        _M,
        _N,
        "D(mm) T S",
        "E is a volume of filament with this diameter, in mm³; with D0 or S0 a length again.",
    ),
    Row("M201", _P, _N, "X Y Z E T (mm/s²)", "Axes' accelerations, at most the machine's."),
    Row("M203", _P, _N, "X Y Z E T (mm/s)", "Axes' speeds, at most the machine's."),
    Row(
        "M204",
        _P,
        _N,
        "S P R T V (mm/s²)",
        "Sets accelerations: all but retract, print, retract, travel; V is T.",
    ),
    Row(
        "M205",
        _P,
        _N,
        "J(mm), X Y Z E(mm/s) T",
        "Corners: the junction deviation (J), or the jerk of each axis up to the machine's limit,"
        " whichever the machine file chooses. There are no minimum speeds.",
    ),
    Row("M206", _S, _N, "X Y Z (mm)", "Added to the axes' home positions."),
    Row(
        "M207",
        _M,
        _N,
        "S(mm) F Z(mm) R(mm) W(mm)",
        "Sets how G10 retracts; W: with S1; R as M208 S.",
    ),
    Row(
        "M208",
        _M,
        _N,
        "S(mm) F W(mm)",
        "Sets what G11 adds, or leaves out below 0; W: after G10 S1; F0: as fast as M207 says.",
    ),
    Row(
        "M209",
        _M,
        _N,
        "S",
        "S1: moves of E alone, by 0.1 to 10 mm, retract as G10 and G11 do.",
    ),
    Row(
        "M218",
        _S,
        _N,
        "T X Y Z (mm)",
        "A tool's offset. For the tool in use, the next move of an axis carries it out.",
    ),
    Row(
        "M220",
        _P,
        _I,
        "S(%) B R",
        "Scales the speed; during a print also that of queued moves. B stores the current factor, R"
        " restores it.",
        bare="BRS",
    ),
    Row(
        "M221",
        _P,
        _I,
        "T S(%)",
        "Scales a tool's extrusion; during a print also that of queued moves.",
        bare="SRXYZ",
    ),
    Row(
        "M290",
        _P,
        _I,
        "X Y Z (mm)",
        "Babysteps: shifts all moves that are not done yet, at once.",
        bare="R",
    ),
    Row(
        "M302",
        _Q,
        _I,
        "S(°C) P T",
        "Allows cold extrusion, P of tool T alone, or tells of it.",
        bare="S",
    ),
    Row(
        "M300",
        _Q,
        _N,
        "S(Hz) P(ms)",
        "Sounds the [beeper] of the machine file; S0 is a pause.",
        bare=ANY,
        lacks="The machine file has no [beeper].",
    ),
    Row(
        "M301",
        _S,
        _I,
        "H P I D",
        "A heater's PID gains, in 1/255 of full power as in the machine file; H-1 is the bed.",
    ),
    Row(
        "M303",
        _S,
        _X,
        "H S(°C) C R(0-5) U",
        "Tunes a heater: a relay's swings, with R5 its model.",
        bare="U",
    ),
    Row("M304", _S, _I, "P I D", "As M301 for the bed."),
    Row("M305", _S, _I, "H A B C R L O", "A heater's thermistor: R25, beta, C, pull-up, offsets."),
    Row("M306", _S, _I, "H A B", "Bounds of a PID's integral, in 1/255; tells the limits, too."),
    Row("M307", _S, _I, "H A C D F R", "A heater's model: °C, s, s of its sensor, fan, room."),
    Row("M350", _Q, _N, "", "Tells the microsteps of the drivers that can be set up."),
    Row("M400", _P, _X, "", "Waits until the machine is still."),
    Row("M408", _Q, _I, "S(0-3)", "The printer's state as JSON; S2 with machine, S3 with print."),
    Row(
        "M410",
        _P,
        _A,
        "",
        "Brakes to a stop and forgets what was planned, and moves in hand. A print without consoles"
        " fails there.",
    ),
    Row(
        "M486",
        _P,
        _I,
        "P(object) U(object) C T(count) S(object) A(name)",
        "P cancels an object of the print from the card, C the one that is printed, U prints it"
        " again; alone it lists them. Files label their objects with T, S and A.",
        bare=None,
    ),
    Row("M500", _S, _N, "", "Stores the settings."),
    Row("M501", _S, _X, "", "Takes the stored settings."),
    Row("M502", _S, _X, "", "Takes the machine file's settings."),
    Row("M503", _Q, _N, "S0", "Tells the settings as commands.", bare="SC"),
    Row("M504", _Q, _N, "", "Checks the stored settings."),
    Row("M524", _S, _I, "", "Cancels the print."),
    Row("M530", _Q, _I, "S", "A host's print begins (S1) or ends (S0): its time is counted."),
    Row("M531", _Q, _I, "name", "The name of a host's print.", bare=None),
    Row("M532", _Q, _I, "X(%) L", "As M73 P."),
    Row(
        "M540",
        _S,
        _I,
        "S",
        "S1: an endstop that is hit stops the machine; tells it without S.",
        bare="S",
    ),
    Row(
        "M569",
        _S,
        _N,
        "S X Y Z E I T",
        "Tells of the drivers; S1: stealthChop, S0: spreadCycle.",
        bare=_AXES,
    ),
    Row(
        "M600",
        _H,
        _X,
        "T E Z X Y U L(mm) S(C) B",
        "Parks, waits for a person to change the filament, and comes back. E takes filament back, Z"
        " lifts, X and Y are the place; U unloads there, L loads when the hotend has reached S. T"
        " is the tool in use; B has no beeper.",
    ),
    Row("M601", _H, _X, "", "Parks, waits for a person, and comes back."),
    Row("M602", _S, _I, "", "Ends a pause."),
    Row("M603", _M, _N, "T L(mm) U(mm)", "Lengths of filament that M701 loads and M702 unloads."),
    Row("M701", _M, _N, "T L(mm) Z(mm)", "Loads filament, lifted by Z meanwhile."),
    Row("M702", _M, _N, "T U(mm) Z(mm)", "Unloads filament, lifted by Z meanwhile.", bare="C"),
    Row("M876", _Q, _I, "S P", "The answer to a prompt."),
    Row("M906", _S, _N, "X Y Z E(mA) I T", "Currents of the drivers that can be set up."),
    Row("M911", _Q, _N, "", "Tells which drivers were hot."),
    Row("M912", _Q, _N, "X Y Z E", "Forgets that drivers were hot.", bare=_AXES),
    Row("M921", _Q, _I, "S(s)", "Tells what each heater's controller does, every S seconds."),
    Row("M922", _S, _I, "", "Heaters that a fault has switched off may heat again."),
    Row("M925", _Q, _I, "I(option)", "Tells one of APrinter's options.", bare=None),
    Row(
        "M926",
        _S,
        _I,
        "I(option) V",
        "Notes a new value of an option, the first one without V.",
        bare=None,
    ),
    Row("M928", _S, _I, "name", "As M28, and the lines are carried out as well.", bare=None),
    Row("M930", _S, _X, "", "Applies the options that M926 has noted."),
    Row("M932", _Q, _I, "", "After a failure nothing of this console is carried out."),
    Row("M933", _Q, _I, "", "Ends M932."),
    Row("M937", _Q, _I, "", "Corrections of the bed: none yet."),
    Row("M940", _Q, _I, "", "The network is the computer's."),
    Row("M999", _S, _I, "", "Restarts after a halt."),
    Row("M1000", _S, _X, "C", "Goes on with a print that was interrupted; C forgets it.", bare="C"),
    Row(
        "T",
        _M,
        _N,
        "",
        "Selects a tool. The next move of an axis carries out its offset on all axes.",
    ),
    Row(
        "SIMULATE_FAULT",
        _S,
        _I,
        "NAME VALUE AFTER(s) DURATION(s)",
        "Gives a part of the simulated printer a fault, or none; without parameters it lists them.",
    ),
    Row(
        "EXCLUDE_OBJECT",
        _P,
        _I,
        "NAME CURRENT RESET",
        "NAME= cancels an object of the print from the card, CURRENT=1 the one that is printed;"
        " RESET=1 prints all again, with NAME= this one; alone it lists them.",
        bare=None,
    ),
    Row(
        "EXCLUDE_OBJECT_DEFINE",
        _M,
        _I,
        "NAME CENTER POLYGON",
        "Names an object of a file on the card.",
        bare=None,
    ),
    Row(
        "EXCLUDE_OBJECT_START",
        _M,
        _I,
        "NAME",
        "What follows in a file belongs to this object.",
        bare=None,
    ),
    Row(
        "EXCLUDE_OBJECT_END",
        _M,
        _I,
        "NAME",
        "What follows in a file belongs to no object.",
        bare=None,
    ),
    Row(
        "SET_VELOCITY_LIMIT",
        _P,
        _N,
        "VELOCITY ACCEL MINIMUM_CRUISE_RATIO SQUARE_CORNER_VELOCITY",
        "Sets limits of speed, acceleration and corners.",
    ),
    *(
        Row(code, _Q, _N, "", text, bare=ANY)
        for code, text in (
            ("G40", "Radii of tools are not kept."),
            ("G43", "Lengths of tools are not kept."),
            ("G49", "Lengths of tools are not kept."),
            ("G54", "There is one coordinate system; G92 moves its zero."),
            ("G94", "F is always in mm per minute."),
            ("M6", "The T word has selected the tool."),
            ("M7", "There is no coolant."),
            ("M8", "There is no coolant."),
            ("M9", "There is no coolant."),
            ("M413", "A print can always be resumed where there is a place for its journal."),
            *(
                (code, "It asks whether this is a Prusa printer.")
                for code in ("M862", *(f"M862.{i}" for i in range(1, 7)))
            ),
            ("M900", "Linear advance is not built."),
            ("M907", "M906 and the machine file set motor currents."),
            ("SET_PRINT_STATS_INFO", "There is no display yet."),
        )
    ),
    *(
        Row(code, _B, _N, "", text, bare=None)
        for codes, text in (
            ("G12", "There is no place to wipe the nozzle."),
            ("G27 M125", "The head parks when a print pauses, by M25 or M601."),
            ("G29 G31 G32 M420 M421 M561", "Bed levelling is not built."),
            ("G30 M48 M401 M402 M851", "There is no probe yet."),
            ("M111", "There are no levels of messages."),
            ("M142 M192", "There is no cooler."),
            ("M150 M355", "There is no light."),
            ("M163 M164 M165 M166", "There is no mixing extruder."),
            ("M202", "M201 bounds axes in every move, M204 T all travel."),
            ("M222", "Purges have the flow of M221."),
            ("M240", "There is no camera."),
            ("M250", "There is no display yet."),
            ("M280 M281", "There is no servo."),
            ("M351", "Microsteps belong to the machine file."),
            ("M404 M405 M406 M407 M512 M604", "There is no sensor of filament yet."),
            ("M428", "M206 sets home offsets."),
            ("M595", "Values of amplifiers belong to the machine file."),
            ("M605", "There is one carriage for all tools."),
            ("M666", "Each motor's switch has its place in the machine file."),
            ("M800", "M1000 goes on with a print that was interrupted."),
            ("M908", "M906 and the machine file set motor currents."),
        )
        for code in codes.split()
    ),
)

BY_CODE = {row.code: row for row in TABLE}


def row_of(code: str) -> Row | None:
    """The row of a command. G1.1 is not G1: it has none."""
    return BY_CODE.get(code)
