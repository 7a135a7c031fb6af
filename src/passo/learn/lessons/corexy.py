"""CoreXY: two motors that share both axes."""

from __future__ import annotations

from math import hypot

from passo.learn.bilingual import Text
from passo.learn.experiment import Experiment, Number, Outcome, Parameter
from passo.learn.lesson import Chapter, Lesson, Mistake, OwnPrinter, Question, Source
from passo.learn.pictures import Graph, Line

_STEPS_PER_MM = 80.0


def _compute(x_mm: float, y_mm: float, speed_mm_s: float) -> Outcome:
    a_mm, b_mm = x_mm + y_mm, x_mm - y_mm
    length = hypot(x_mm, y_mm)
    time_s = length / speed_mm_s if length else 0.0
    fastest = max(abs(a_mm), abs(b_mm)) / time_s if time_s else 0.0

    def along(end: float) -> list[float]:
        return [0.0, end]

    return Outcome(
        numbers=[
            Number("a_mm", Text("Motor A", "Motore A"), a_mm, "mm"),
            Number("b_mm", Text("Motor B", "Motore B"), b_mm, "mm"),
            Number("a_steps", Text("Steps of A", "Passi di A"), a_mm * _STEPS_PER_MM, decimals=0),
            Number("b_steps", Text("Steps of B", "Passi di B"), b_mm * _STEPS_PER_MM, decimals=0),
            Number(
                "motor_mm_s",
                Text("Speed of the faster motor", "Velocità del motore più veloce"),
                fastest,
                "mm/s",
            ),
            Number("back_x_mm", Text("X from A and B", "X da A e B"), (a_mm + b_mm) / 2, "mm"),
            Number(
                "scale", Text("Steps per millimetre", "Passi per millimetro"), _STEPS_PER_MM, "", 0
            ),
        ],
        graphs=[
            Graph(
                Text("Way of head and motors", "Strada di testina e motori"),
                Text("time, s", "tempo, s"),
                "mm",
                [
                    Line("X", along(time_s), along(x_mm)),
                    Line("Y", along(time_s), along(y_mm), 1),
                    Line("A", along(time_s), along(a_mm), 2, True),
                    Line("B", along(time_s), along(b_mm), 3, True),
                ],
            )
        ],
    )


EXPERIMENT = Experiment(
    "corexy",
    Text("A move on CoreXY", "Un movimento su CoreXY"),
    Text(
        "The head moves in a straight line. Both motors stand still, and pull one belt each.",
        "La testina va in linea retta. I due motori sono fissi, e ognuno tira una cinghia.",
    ),
    [
        Parameter("x_mm", Text("Way in X", "Strada in X"), 40.0, -100.0, 100.0, 5.0, unit="mm"),
        Parameter("y_mm", Text("Way in Y", "Strada in Y"), 20.0, -100.0, 100.0, 5.0, unit="mm"),
        Parameter(
            "speed_mm_s",
            Text("Speed of the head", "Velocità della testina"),
            100.0,
            10.0,
            300.0,
            10.0,
            unit="mm/s",
        ),
    ],
    _compute,
)

LESSON = Lesson(
    name="corexy",
    chapter=Chapter.MOTION,
    place=110,
    rows=(26,),
    minutes=20,
    title=Text("CoreXY, forward and back", "CoreXY, andata e ritorno"),
    goal=Text(
        "You turn a move of the head into moves of two motors, and back.",
        "Trasformi un movimento della testina in movimenti di due motori, e viceversa.",
    ),
    text=[
        Text(
            "On a usual printer one motor moves X, another one Y and its own weight. On CoreXY"
            " both motors stand still, and two crossed belts pull the head. That makes it light.",
            "Su una stampante comune un motore muove X, un altro Y e il proprio peso. Su CoreXY"
            " entrambi i motori sono fissi, e due cinghie incrociate tirano la testina. Così è"
            " leggera.",
        ),
        Text(
            "If both motors turn alike, the head goes in X. If they turn against each other, it"
            " goes in Y. So `A = X + Y` and `B = X − Y`. A move of {x_mm} in X and {y_mm} in Y is"
            " {a_mm} of A and {b_mm} of B, {a_steps:n} and {b_steps:n} steps.",
            "Se i motori girano uguali, la testina va in X. Se girano al contrario, va in Y."
            " Quindi `A = X + Y` e `B = X − Y`. Un movimento di {x_mm} in X e {y_mm} in Y è {a_mm}"
            " di A e {b_mm} di B, {a_steps:n} e {b_steps:n} passi.",
        ),
        Text(
            "Back again it is `X = (A + B) / 2` and `Y = (A − B) / 2`. Exchange the plugs of both"
            " motors, and X and Y change places or run backwards: that is how one finds a wrong"
            " wire.",
            "All'indietro è `X = (A + B) / 2` e `Y = (A − B) / 2`. Scambia i connettori dei motori,"
            " e X e Y si scambiano o vanno al contrario: così si trova un cavo sbagliato.",
        ),
        Text(
            "On a diagonal one motor does all the work: with {diagonal.x_mm} in both it is"
            " {diagonal.a_mm} of A and {diagonal.b_mm} of B. A then runs at"
            " {diagonal.motor_mm_s}, faster than the head with {diagonal.speed_mm_s}. The planner"
            " must know that, or steps are lost on diagonals only.",
            "In diagonale un solo motore fa tutto il lavoro: con {diagonal.x_mm} in entrambe sono"
            " {diagonal.a_mm} di A e {diagonal.b_mm} di B. A corre allora a {diagonal.motor_mm_s},"
            " più della testina con {diagonal.speed_mm_s}. Il pianificatore deve saperlo, o i passi"
            " si perdono solo in diagonale.",
        ),
    ],
    experiment=EXPERIMENT,
    cases={"diagonal": {"x_mm": 50.0, "y_mm": 50.0}},
    questions=[
        Question(
            Text(
                "The head moves {x_mm} in X and {y_mm} in Y. How many steps does motor B take, at"
                " {scale:n} steps per millimetre?",
                "La testina si muove di {x_mm} in X e {y_mm} in Y. Quanti passi fa il motore B, con"
                " {scale:n} passi per millimetro?",
            ),
            "b_steps",
            given={"x_mm": 15.0, "y_mm": 40.0},
            mistakes=[
                Mistake(lambda v: v["a_steps"], Text("That is motor A.", "Questo è il motore A.")),
                Mistake(
                    lambda v: -v["b_steps"],
                    Text("Mind the sign: `X − Y`.", "Attento al segno: `X − Y`."),
                ),
                Mistake(lambda v: v["b_mm"], Text("In steps, please.", "In passi, per favore.")),
            ],
            why=Text(
                "`X − Y` is {b_mm}, backwards, times the steps per millimetre.",
                "`X − Y` è {b_mm}, all'indietro, per i passi al millimetro.",
            ),
            hint=Text("Use `B = X − Y`.", "Usa `B = X − Y`."),
        ),
        Question(
            Text(
                "The head runs at {speed_mm_s} on an exact diagonal ({x_mm} in X, {y_mm} in Y). How"
                " fast must the faster motor pull its belt?",
                "La testina corre a {speed_mm_s} su una diagonale esatta ({x_mm} in X, {y_mm} in"
                " Y). A quale velocità tira la cinghia il motore più veloce?",
            ),
            "motor_mm_s",
            given={"x_mm": 30.0, "y_mm": 30.0, "speed_mm_s": 200.0},
            mistakes=[
                Mistake(
                    lambda v: v["speed_mm_s"],
                    Text(
                        "One motor does the way of both axes.",
                        "Un motore fa la strada di entrambi gli assi.",
                    ),
                ),
                Mistake(
                    lambda v: 2 * v["speed_mm_s"],
                    Text(
                        "X and Y are each slower than the head: by the root of two.",
                        "X e Y vanno ognuno più piano della testina: per la radice di due.",
                    ),
                ),
            ],
            why=Text(
                "It pulls `X + Y` while the head goes the diagonal: `√2` times as fast.",
                "Tira `X + Y` mentre la testina fa la diagonale: `√2` volte più veloce.",
            ),
            hint=Text(
                "How long is the diagonal, and how long the way of the motor?",
                "Quanto è lunga la diagonale, e quanto la strada del motore?",
            ),
        ),
    ],
    source=Source("core/geometry/core_belts.hpp", "core_xy"),
    printer=OwnPrinter(
        Text(
            "On a CoreXY, move X alone, then Y alone, and watch which way both motors turn.",
            "Su una CoreXY, muovi solo X, poi solo Y, e guarda in che verso girano i motori.",
        ),
        command="passo explain FILE:LINE --machine corexy",
        page="learn",
    ),
)
