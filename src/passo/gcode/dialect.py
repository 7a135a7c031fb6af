"""The dialect table: one row a command. Documentation, warnings and the printer follow it."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple


class Kind(Enum):
    """Who carries a command out."""

    MOTION = "motion"  # the interpreter in the core
    PRINTER = "printer"  # a handler of the printer
    PERSON = "person"  # waits for a person; a headless print goes on
    QUIET = "quiet"  # means nothing here, and does no harm


class Row(NamedTuple):
    """A command: its code, who carries it out, its parameters, and one sentence."""

    code: str
    kind: Kind
    parameters: str
    text: str


_M, _P, _H, _Q = Kind.MOTION, Kind.PRINTER, Kind.PERSON, Kind.QUIET

TABLE: tuple[Row, ...] = (
    Row("G0", _M, "X Y Z E F(mm/min) T(s) R", "Moves in a straight line, without work."),
    Row("G1", _M, "X Y Z E F(mm/min) T(s) R S(laser)", "Moves in a straight line."),
    Row("G2", _M, "X Y Z E F I J K R P(turns)", "Moves clockwise on an arc or a helix."),
    Row("G3", _M, "X Y Z E F I J K R P(turns)", "Moves counter-clockwise on an arc or a helix."),
    Row("G4", _M, "S(s) P(ms)", "Waits."),
    Row("G10", _M, "", "Retracts the filament; with P it sets a tool's temperatures instead."),
    Row("G11", _M, "", "Takes the retraction back."),
    Row("G17", _M, "", "Arcs lie in XY."),
    Row("G18", _M, "", "Arcs lie in ZX."),
    Row("G19", _M, "", "Arcs lie in YZ."),
    Row("G20", _M, "", "Lengths are inches."),
    Row("G21", _M, "", "Lengths are millimetres."),
    Row("G28", _P, "X Y Z", "Homes: for now sets the axes to their home positions."),
    Row("G90", _M, "", "Positions are absolute."),
    Row("G91", _M, "", "Positions are relative, the extruder's too."),
    Row("G92", _M, "X Y Z E", "Sets the program's position without motion."),
    Row("M0", _H, "", "Waits for a person."),
    Row("M1", _H, "", "Waits for a person."),
    Row("M2", _P, "", "Ends the program."),
    Row("M3", _P, "S", "Laser or spindle on."),
    Row("M4", _P, "S", "Laser or spindle on, power with speed."),
    Row("M5", _P, "", "Laser or spindle off."),
    Row("M18", _P, "", "Motors off when the machine is still."),
    Row("M25", _H, "", "Pauses."),
    Row("M30", _P, "", "Ends the program."),
    Row("M82", _M, "", "The extruder's positions are absolute."),
    Row("M83", _M, "", "The extruder's positions are relative."),
    Row("M84", _P, "", "Motors off when the machine is still."),
    Row("M104", _P, "S(°C) T", "Sets the hotend's temperature."),
    Row("M106", _P, "S(0-255) P", "Sets a fan's speed."),
    Row("M107", _P, "P", "Turns a fan off."),
    Row("M109", _P, "S(°C) R(°C) T", "Sets the hotend's temperature and waits for it."),
    Row("M116", _P, "", "Waits for all temperatures."),
    Row("M140", _P, "S(°C)", "Sets the bed's temperature."),
    Row("M141", _P, "S(°C)", "Sets the chamber's temperature."),
    Row("M190", _P, "S(°C) R(°C)", "Sets the bed's temperature and waits for it."),
    Row("M191", _P, "S(°C) R(°C)", "Sets the chamber's temperature and waits for it."),
    Row("M201", _P, "X Y Z E (mm/s²)", "Sets the axes' accelerations, at most the machine's."),
    Row("M203", _P, "X Y Z E (mm/s)", "Sets the axes' speeds, at most the machine's."),
    Row("M204", _P, "S P R T (mm/s²)", "Sets accelerations: all, print, retract, travel."),
    Row("M205", _P, "J(mm)", "Sets the junction deviation."),
    Row("M207", _M, "S(mm) F Z(mm) R(mm)", "Sets how G10 retracts."),
    Row("M208", _M, "S(mm) F", "Sets how G11 takes it back."),
    Row("M220", _P, "S(%)", "Scales the speed."),
    Row("M221", _M, "S(%)", "Scales the extrusion."),
    Row("M400", _P, "", "Waits until the machine is still."),
    Row("M600", _H, "", "Waits for a person to change the filament."),
    Row("T", _M, "", "Selects a tool."),
    Row(
        "SET_VELOCITY_LIMIT",
        _P,
        "VELOCITY ACCEL MINIMUM_CRUISE_RATIO SQUARE_CORNER_VELOCITY",
        "Sets limits of speed, acceleration and corners.",
    ),
    *(
        Row(code, _Q, "", text)
        for code, text in (
            ("G43", "Tool length offset."),
            ("G54", "First work coordinate system."),
            ("G94", "Feed by minute."),
            ("M6", "Tool change: the T word has selected the tool."),
            ("M7", "Mist coolant."),
            ("M8", "Coolant."),
            ("M9", "Coolant off."),
            ("M17", "Motors on: a move turns them on anyway."),
            ("M73", "Progress for a display."),
            ("M105", "Temperature report for a host."),
            ("M115", "Firmware report for a host."),
            ("M117", "Message for a display."),
            ("M118", "Message for a host."),
            ("M300", "Beep."),
            ("M486", "Object labels."),
            ("M862", "Checks of a Prusa printer."),
            ("M900", "Linear advance."),
            ("M907", "Motor current."),
            ("EXCLUDE_OBJECT_DEFINE", "Object labels."),
            ("EXCLUDE_OBJECT_START", "Object labels."),
            ("EXCLUDE_OBJECT_END", "Object labels."),
            ("SET_PRINT_STATS_INFO", "Progress for a display."),
        )
    ),
)

BY_CODE = {row.code: row for row in TABLE}
