"""A delta: three carriages on towers, and why a straight line is a curve for each of them."""

from __future__ import annotations

from math import cos, pi, sin, sqrt

from passo.learn.bilingual import Text
from passo.learn.experiment import Experiment, Number, Outcome, Parameter
from passo.learn.lesson import Chapter, Lesson, Mistake, OwnPrinter, Question, Source
from passo.learn.pictures import Graph, Line

_RADIUS_MM = 81.0  # from the middle to the towers
_TOWERS = [(_RADIUS_MM * sin(2 * pi * k / 3), _RADIUS_MM * cos(2 * pi * k / 3)) for k in range(3)]
_REACH_MM = 60.0


def _height(tower: int, x: float, y: float, rod_mm: float) -> float:
    """How far a carriage is above the nozzle's joints."""
    at_x, at_y = _TOWERS[tower]
    return sqrt(rod_mm**2 - (at_x - x) ** 2 - (at_y - y) ** 2)


def _compute(x_mm: float, y_mm: float, rod_mm: float) -> Outcome:
    heights = [_height(tower, x_mm, y_mm, rod_mm) for tower in range(3)]
    middle = _height(0, 0.0, 0.0, rod_mm)
    slope = (_height(0, x_mm, y_mm + 0.5, rod_mm) - _height(0, x_mm, y_mm - 0.5, rod_mm)) / 1.0
    xs = [-_REACH_MM + 2 * _REACH_MM * i / 60 for i in range(61)]
    return Outcome(
        numbers=[
            Number(
                "middle_mm",
                Text("Carriages above the middle", "Carrelli sopra il centro"),
                middle,
                "mm",
            ),
            Number("a_mm", Text("Carriage A", "Carrello A"), heights[0], "mm"),
            Number("b_mm", Text("Carriage B", "Carrello B"), heights[1], "mm"),
            Number("c_mm", Text("Carriage C", "Carrello C"), heights[2], "mm"),
            Number(
                "slope",
                Text("Way of A for a millimetre in Y", "Strada di A per un millimetro in Y"),
                slope,
                "mm",
            ),
            Number(
                "radius_mm", Text("Towers from the middle", "Torri dal centro"), _RADIUS_MM, "mm"
            ),
            Number(
                "apart_mm",
                Text("Tower A from the nozzle, seen from above", "Torre A dall'ugello, dall'alto"),
                sqrt((_TOWERS[0][0] - x_mm) ** 2 + (_TOWERS[0][1] - y_mm) ** 2),
                "mm",
            ),
        ],
        graphs=[
            Graph(
                Text("Carriages along a line in X", "Carrelli lungo una linea in X"),
                Text("x, mm", "x, mm"),
                "mm",
                [
                    Line(name, xs, [_height(tower, x, y_mm, rod_mm) for x in xs], tower)
                    for tower, name in enumerate(("A", "B", "C"))
                ],
                values=(middle,),
            )
        ],
    )


EXPERIMENT = Experiment(
    "delta",
    Text("Where the carriages are", "Dove sono i carrelli"),
    Text(
        "Tower A is at the back, B at the front right, C at the front left; all towers stand on"
        " one circle.",
        "La torre A è dietro, B davanti a destra, C davanti a sinistra; tutte stanno su un"
        " cerchio.",
    ),
    [
        Parameter("x_mm", "X", 0.0, -60.0, 60.0, 1.0, unit="mm"),
        Parameter("y_mm", "Y", 0.0, -60.0, 60.0, 1.0, unit="mm"),
        Parameter(
            "rod_mm",
            Text("Length of the rods", "Lunghezza delle aste"),
            180.0,
            170.0,
            300.0,
            5.0,
            unit="mm",
        ),
    ],
    _compute,
)

LESSON = Lesson(
    name="delta",
    chapter=Chapter.MOTION,
    place=115,
    rows=(26,),
    minutes=25,
    title=Text("Delta", "Delta"),
    goal=Text(
        "You compute the carriages of a delta by Pythagoras.",
        "Calcoli i carrelli di una delta con Pitagora.",
    ),
    text=[
        Text(
            "Three carriages slide on three towers. Rods of {rod_mm} hold the nozzle between them."
            " There is no motor for X, none for Y: all three work on every move.",
            "Tre carrelli scorrono su tre torri. Aste di {rod_mm} tengono l'ugello tra loro. Non"
            " c'è un motore per X, né per Y: tutti e tre lavorano a ogni movimento.",
        ),
        Text(
            "Seen from above, a tower is some way from the nozzle, in the middle {radius_mm}. The"
            " rod is the long side of a right triangle, so the carriage is"
            " `√(rod² − distance²)` = {middle_mm} higher than the nozzle.",
            "Vista dall'alto, una torre dista dall'ugello, al centro, {radius_mm}. L'asta è"
            " l'ipotenusa di un triangolo rettangolo, quindi il carrello è"
            " `√(asta² − distanza²)` = {middle_mm} più in alto dell'ugello.",
        ),
        Text(
            "Move the nozzle by {side.y_mm} toward tower A: A climbs to {side.a_mm}, B and C sink"
            " to {side.b_mm}. Along a straight line each carriage makes a curve. A firmware that"
            " drives chords approximates it; Passo solves the time of each step on the curve"
            " itself.",
            "Sposta l'ugello di {side.y_mm} verso la torre A: A sale a {side.a_mm}, B e C scendono"
            " a {side.b_mm}. Lungo una linea retta ogni carrello fa una curva. Un firmware che usa"
            " corde la approssima; Passo calcola il tempo di ogni passo sulla curva stessa.",
        ),
        Text(
            "In the middle a millimetre in Y moves carriage A by {slope}; on the far side, at"
            " {far.y_mm}, by {far.slope}. So speed and resolution change with the place, and near"
            " the edge a carriage may have to run faster than the nozzle.",
            "Al centro un millimetro in Y muove il carrello A di {slope}; dal lato opposto, a"
            " {far.y_mm}, di {far.slope}. Così velocità e risoluzione cambiano col punto, e"
            " vicino al bordo un carrello può dover correre più dell'ugello.",
        ),
    ],
    experiment=EXPERIMENT,
    cases={"side": {"y_mm": 40.0}, "far": {"y_mm": -60.0}},
    questions=[
        Question(
            Text(
                "Rods of {rod_mm}, towers {radius_mm} from the middle, the nozzle at Y = {y_mm},"
                " straight toward tower A. How high is carriage A above the nozzle?",
                "Aste di {rod_mm}, torri a {radius_mm} dal centro, ugello a Y = {y_mm}, dritto"
                " verso la torre A. Quanto sta sopra l'ugello il carrello A?",
            ),
            "a_mm",
            given={"rod_mm": 200.0, "y_mm": 31.0},
            mistakes=[
                Mistake(
                    lambda v: sqrt(v["rod_mm"] ** 2 - (v["radius_mm"] + v["y_mm"]) ** 2),
                    Text(
                        "The nozzle comes nearer to tower A, not farther away.",
                        "L'ugello si avvicina alla torre A, non si allontana.",
                    ),
                ),
                Mistake(
                    lambda v: sqrt(v["rod_mm"] ** 2 - v["radius_mm"] ** 2),
                    Text("That holds in the middle.", "Questo vale al centro."),
                ),
            ],
            why=Text(
                "Seen from above the tower is {apart_mm} away; Pythagoras gives the height.",
                "Dall'alto la torre dista {apart_mm}; Pitagora dà l'altezza.",
            ),
            hint=Text(
                "How far is the tower from the nozzle, seen from above?",
                "Quanto dista la torre dall'ugello, vista dall'alto?",
            ),
            tolerance=0.002,
        ),
        Question(
            Text("And with rods of {rod_mm} in the middle?", "E con aste di {rod_mm} al centro?"),
            "middle_mm",
            given={"rod_mm": 250.0},
            mistakes=[
                Mistake(
                    lambda v: v["rod_mm"] - v["radius_mm"],
                    Text(
                        "The rod leans: it is the long side of a right triangle.",
                        "L'asta è inclinata: è l'ipotenusa di un triangolo rettangolo.",
                    ),
                ),
                Mistake(
                    lambda v: sqrt(v["rod_mm"] ** 2 + v["radius_mm"] ** 2),
                    Text(
                        "The rod is the longest side: subtract the squares.",
                        "L'asta è il lato più lungo: sottrai i quadrati.",
                    ),
                ),
            ],
            why=Text("`√(rod² − radius²)`.", "`√(asta² − raggio²)`."),
            hint=Text("Pythagoras.", "Pitagora."),
            tolerance=0.002,
        ),
    ],
    source=Source("core/geometry/delta.hpp", "Delta"),
    printer=OwnPrinter(
        Text(
            "On a delta, move along X and watch all three carriages.",
            "Su una delta, muovi lungo X e guarda i tre carrelli.",
        ),
        command="passo explain FILE:LINE --machine delta",
        page="learn",
    ),
)
