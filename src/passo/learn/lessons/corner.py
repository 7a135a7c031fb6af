"""The speed through a corner: the circle of the junction deviation."""

from __future__ import annotations

from math import cos, hypot, pi, radians, sin, sqrt, tan

from passo.learn.bilingual import Text
from passo.learn.experiment import Experiment, Number, Outcome, Parameter
from passo.learn.lesson import Chapter, Lesson, Link, Mistake, OwnPrinter, Question, Source
from passo.learn.pictures import Graph, Line, Mark, Plane
from passo.learn.planned import planned, shipped

_LEG_MM = 100.0  # each of the two moves: long enough not to limit the speed


def _corner_mm_s(turn_deg: float, deviation_mm: float, acceleration_mm_s2: float) -> float:
    """The speed with which the planner passes a corner of two moves."""
    turn = radians(turn_deg)
    x, y = 100 + _LEG_MM * cos(turn), 100 + _LEG_MM * sin(turn)
    lines = [
        f"M204 P{acceleration_mm_s2:.3f} T{acceleration_mm_s2:.3f}",
        f"M205 J{deviation_mm:.5f}",
        "G1 X100 Y100 F60000",
        "G1 X0 Y100",
        "G1 X100",
        f"G1 X{x:.5f} Y{y:.5f}",
    ]
    moves, _ = planned("\n".join(lines) + "\n", shipped("i3"))
    return moves[-1].start_speed


def _arc(turn: float, radius: float) -> tuple[list[float], list[float]]:
    """The circle between its points of contact; the corner is at 0, 0, the first move comes from
    the left."""
    reach = radius * tan(turn / 2)  # from the corner to a point of contact
    angles = [turn * i / 40 for i in range(41)]
    return (
        [-reach + radius * sin(angle) for angle in angles],
        [radius - radius * cos(angle) for angle in angles],
    )


def _compute(turn_deg: float, deviation_mm: float, acceleration_mm_s2: float) -> Outcome:
    turn = radians(turn_deg)
    s = sin((pi - turn) / 2)
    radius = deviation_mm * s / (1 - s)
    speed = _corner_mm_s(turn_deg, deviation_mm, acceleration_mm_s2)
    across, up = _arc(turn, radius)
    leg = 1.6 * radius * tan(turn / 2)
    nearest = hypot(across[20], up[20])
    turns = [float(angle) for angle in range(10, 171, 4)]
    speeds: list[float] = []
    for angle in turns:
        half = sin((pi - radians(angle)) / 2)
        speeds.append(sqrt(acceleration_mm_s2 * deviation_mm * half / (1 - half)))
    return Outcome(
        numbers=[
            Number(
                "corner_mm_s", Text("Speed in the corner", "Velocità nell'angolo"), speed, "mm/s"
            ),
            Number(
                "radius_mm", Text("Radius of the circle", "Raggio del cerchio"), radius, "mm", 3
            ),
            Number(
                "nearest_mm",
                Text("Its distance from the corner", "Sua distanza dall'angolo"),
                nearest,
                "mm",
                3,
            ),
            Number("enclosed_deg", Text("Enclosed angle", "Angolo racchiuso"), 180 - turn_deg, "°"),
        ],
        planes=[
            Plane(
                Text("The corner, and the circle beside it", "L'angolo, e il cerchio accanto"),
                [
                    Line(
                        Text("path", "percorso"),
                        [-leg, 0.0, leg * cos(turn)],
                        [0.0, 0.0, leg * sin(turn)],
                    ),
                    Line(Text("imagined circle", "cerchio immaginato"), across, up, 1, True),
                ],
                [
                    Mark(across[0], up[0], "", 1),
                    Mark(across[-1], up[-1], "", 1),
                ],
                unit="mm",
            )
        ],
        graphs=[
            Graph(
                Text("Speed in corners", "Velocità negli angoli"),
                Text("turn of the path, degrees", "svolta del percorso, gradi"),
                "mm/s",
                [Line(Text("this deviation", "questa deviazione"), turns, speeds)],
            )
        ],
    )


EXPERIMENT = Experiment(
    "corner",
    Text("Two moves and a corner", "Due movimenti e un angolo"),
    Text(
        "The planner of Passo takes a corner between two long moves on the machine `i3`.",
        "Il pianificatore di Passo percorre un angolo tra due movimenti lunghi sulla macchina"
        " `i3`.",
    ),
    [
        Parameter("turn_deg", Text("Turn of the path", "Svolta"), 90.0, 10.0, 170.0, 1.0, unit="°"),
        Parameter(
            "deviation_mm",
            Text("Junction deviation δ", "Deviazione di giunzione δ"),
            0.02,
            0.005,
            0.2,
            0.005,
            unit="mm",
        ),
        Parameter(
            "acceleration_mm_s2",
            Text("Acceleration", "Accelerazione"),
            3000.0,
            500.0,
            3000.0,
            100.0,
            unit="mm/s²",
        ),
    ],
    _compute,
)

LESSON = Lesson(
    name="corner",
    chapter=Chapter.MOTION,
    place=50,
    rows=(5,),
    minutes=25,
    title=Text("Corners", "Gli angoli"),
    goal=Text(
        "You predict how fast a printer goes through a corner.",
        "Prevedi con quale velocità una stampante percorre un angolo.",
    ),
    text=[
        Text(
            "At a corner the direction changes at once. A head with mass cannot do that at full"
            " speed: the frame takes a blow, and motors lose steps. To stop at each corner is"
            " safe, but slow, and leaves blobs.",
            "In un angolo la direzione cambia di colpo. Una testina con massa non può farlo a piena"
            " velocità: il telaio riceve un urto, e i motori perdono passi. Fermarsi a ogni angolo"
            " è sicuro, ma lento, e lascia grumi.",
        ),
        Text(
            "The rule imagines a circle beside the corner that touches both moves and passes at"
            " most δ = {deviation_mm} from the corner. For a turn of {turn_deg} its radius is"
            " {radius_mm}. The head does not drive this circle: it only takes its speed.",
            "La regola immagina un cerchio accanto all'angolo, che tocca i due movimenti e passa al"
            " massimo a δ = {deviation_mm} dall'angolo. Per una svolta di {turn_deg} il suo raggio"
            " è {radius_mm}. La testina non percorre il cerchio: ne prende solo la velocità.",
        ),
        Text(
            "A circle needs the acceleration `v² / R` toward its centre. With {acceleration_mm_s2}"
            " that allows `v = √(a·R)` = {corner_mm_s}.",
            "Un cerchio richiede l'accelerazione `v² / R` verso il centro. Con {acceleration_mm_s2}"
            " questo permette `v = √(a·R)` = {corner_mm_s}.",
        ),
        Text(
            "A gentle turn of {gentle.turn_deg} is taken at {gentle.corner_mm_s}, a sharp one of"
            " {sharp.turn_deg} at {sharp.corner_mm_s}. The formula for the radius:"
            " `R = δ·s / (1 − s)`, where `s` is the sine of half of the angle that the moves"
            " enclose, here of half of {enclosed_deg}.",
            "Una svolta dolce di {gentle.turn_deg} si percorre a {gentle.corner_mm_s}, una stretta"
            " di {sharp.turn_deg} a {sharp.corner_mm_s}. La formula del raggio:"
            " `R = δ·s / (1 − s)`, dove `s` è il seno di metà dell'angolo racchiuso dai movimenti,"
            " qui metà di {enclosed_deg}.",
        ),
    ],
    experiment=EXPERIMENT,
    cases={"gentle": {"turn_deg": 20.0}, "sharp": {"turn_deg": 150.0}, "start": {}},
    questions=[
        Question(
            Text(
                "The turn is {turn_deg}, δ is {deviation_mm}, the acceleration"
                " {acceleration_mm_s2}. Which speed does the corner have?",
                "La svolta è {turn_deg}, δ è {deviation_mm}, l'accelerazione {acceleration_mm_s2}."
                " Quale velocità ha l'angolo?",
            ),
            "corner_mm_s",
            given={"turn_deg": 60.0, "deviation_mm": 0.05, "acceleration_mm_s2": 2000.0},
            mistakes=[
                Mistake(
                    lambda v: sqrt(
                        v["acceleration_mm_s2"]
                        * v["deviation_mm"]
                        * sin(radians(v["turn_deg"] / 2))
                        / (1 - sin(radians(v["turn_deg"] / 2)))
                    ),
                    Text(
                        "This takes the turn of the path. The formula has the angle that the two"
                        " moves enclose: a straight line encloses `180°`.",
                        "Questo usa la svolta del percorso. La formula ha l'angolo racchiuso dai"
                        " due movimenti: una linea retta racchiude `180°`.",
                    ),
                ),
                Mistake(
                    lambda v: v["acceleration_mm_s2"] * v["radius_mm"],
                    Text("This is `v²`. Take the root.", "Questo è `v²`. Fai la radice."),
                ),
            ],
            why=Text(
                "The moves enclose {enclosed_deg}, so the radius is {radius_mm}, and `v = √(a·R)`.",
                "I movimenti racchiudono {enclosed_deg}, quindi il raggio è {radius_mm}, e"
                " `v = √(a·R)`.",
            ),
            hint=Text(
                "Find the enclosed angle, then `s`, then the radius, then the speed.",
                "Trova l'angolo racchiuso, poi `s`, poi il raggio, poi la velocità.",
            ),
        ),
        Question(
            Text(
                "A square corner is taken at {start.corner_mm_s} with δ = {start.deviation_mm}. At"
                " which speed is it taken with {deviation_mm}?",
                "Un angolo retto si percorre a {start.corner_mm_s} con δ = {start.deviation_mm}. A"
                " quale velocità con {deviation_mm}?",
            ),
            "corner_mm_s",
            given={"deviation_mm": 0.08},
            mistakes=[
                Mistake(
                    lambda v: 4 * sqrt(v["acceleration_mm_s2"] * v["radius_mm"] / 4),
                    Text(
                        "The radius grows in proportion to δ, but the speed only with its root.",
                        "Il raggio cresce in proporzione a δ, ma la velocità solo con la radice.",
                    ),
                ),
                Mistake(
                    lambda v: sqrt(v["acceleration_mm_s2"] * v["radius_mm"] / 4),
                    Text("A larger δ allows more speed.", "Una δ maggiore permette più velocità."),
                ),
            ],
            why=Text(
                "δ is four times as large, so is the radius, and the speed is twice as high.",
                "δ è quattro volte maggiore, così il raggio, e la velocità è il doppio.",
            ),
            hint=Text(
                "How does the radius change? And `√(a·R)`?",
                "Come cambia il raggio? E `√(a·R)`?",
            ),
        ),
    ],
    source=Source("core/plan/junction.hpp", "JunctionRule"),
    printer=OwnPrinter(
        Text(
            "M205 J sets δ. Print a small square twice, with your value and with half of it, and"
            " look at its corners.",
            "M205 J imposta δ. Stampa due volte un quadratino, con il tuo valore e con la metà, e"
            " guarda gli angoli.",
        ),
        command="M205 J",
        page="learn",
    ),
    links=[Link(Text("Planning", "Pianificazione"), document="docs/explanation/planning.md")],
)
