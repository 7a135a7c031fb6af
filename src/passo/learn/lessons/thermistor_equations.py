"""β and R_INF from two points, and how far they lead astray."""

from __future__ import annotations

from math import exp, log

from passo.config.thermistor import Ntc
from passo.learn.bilingual import Text
from passo.learn.experiment import Experiment, Number, Outcome, Parameter
from passo.learn.lesson import Chapter, Lesson, Link, Mistake, OwnPrinter, Question, Source
from passo.learn.pictures import Graph, Line

_ZERO_K = 273.15
_ROOM_C = 25.0
_R25_OHM = 100_000.0
# The true sensor of this lesson: three points of a data sheet.
_SENSOR = Ntc.through((_ROOM_C, _R25_OHM), (150.0, 1642.0), (250.0, 226.0))


def _beta(hot_c: float, hot_ohm: float) -> float:
    return log(_R25_OHM / hot_ohm) / (1 / (_ROOM_C + _ZERO_K) - 1 / (hot_c + _ZERO_K))


def _compute(hot_c: float, true_c: float) -> Outcome:
    hot_ohm = _SENSOR.ohm(hot_c)
    beta = _beta(hot_c, hot_ohm)
    r_inf = _R25_OHM * exp(-beta / (_ROOM_C + _ZERO_K))

    def shown_c(celsius: float) -> float:
        return beta / log(_SENSOR.ohm(celsius) / r_inf) - _ZERO_K

    temperatures = [30.0 + 5 * i for i in range(55)]
    return Outcome(
        numbers=[
            Number("hot_ohm", Text("Resistance there", "Resistenza lì"), hot_ohm, "Ω", 1),
            Number("beta_k", "β", beta, "K", 0),
            Number("r_inf_ohm", "R_INF", r_inf, "Ω", 4),
            Number(
                "true_ohm",
                Text("Resistance of the sensor", "Resistenza del sensore"),
                _SENSOR.ohm(true_c),
                "Ω",
                1,
            ),
            Number(
                "shown_c", Text("Temperature by β", "Temperatura secondo β"), shown_c(true_c), "°C"
            ),
            Number("error_c", Text("Error", "Errore"), shown_c(true_c) - true_c, "°C"),
            Number(
                "r25_ohm",
                Text("Resistance in the room", "Resistenza in ambiente"),
                _R25_OHM,
                "Ω",
                0,
            ),
            Number("room_c", Text("Room", "Ambiente"), _ROOM_C, "°C", 0),
        ],
        graphs=[
            Graph(
                Text("Error of β from two points", "Errore di β da due punti"),
                Text("true temperature, °C", "temperatura vera, °C"),
                "°C",
                [
                    Line(
                        Text("shown − true", "mostrata − vera"),
                        temperatures,
                        [shown_c(celsius) - celsius for celsius in temperatures],
                    )
                ],
            )
        ],
    )


EXPERIMENT = Experiment(
    "thermistor-equations",
    Text("Two points of one sensor", "Due punti di un sensore"),
    Text(
        "The resistance is measured in the room and once more when hot. β follows from both.",
        "La resistenza si misura in ambiente e un'altra volta a caldo. Ne segue β.",
    ),
    [
        Parameter(
            "hot_c",
            Text("Second temperature", "Seconda temperatura"),
            150.0,
            60.0,
            250.0,
            5.0,
            unit="°C",
        ),
        Parameter(
            "true_c",
            Text("True temperature", "Temperatura vera"),
            215.0,
            30.0,
            300.0,
            5.0,
            unit="°C",
        ),
    ],
    _compute,
)

LESSON = Lesson(
    name="thermistor-equations",
    chapter=Chapter.HEAT,
    place=20,
    rows=(12,),
    minutes=30,
    title=Text("β, R_INF and three points", "β, R_INF e tre punti"),
    goal=Text(
        "You compute β from two measurements, and know why a third one helps.",
        "Calcoli β da due misure, e sai perché una terza aiuta.",
    ),
    text=[
        Text(
            "The resistance of a thermistor falls by a factor with each degree. The law"
            " `R = R_INF·e^(β/T)` says so, with `T` in kelvin: `0 °C` is `273.15 K`. Two"
            " measurements give its two numbers.",
            "La resistenza di un termistore cala di un fattore a ogni grado. Lo dice la legge"
            " `R = R_INF·e^(β/T)`, con `T` in kelvin: `0 °C` è `273.15 K`. Due misure danno i suoi"
            " due numeri.",
        ),
        Text(
            "This sensor has {r25_ohm} at {room_c} and {hot_ohm} at {hot_c}. So"
            " `β = ln(R1/R2) / (1/T1 − 1/T2)` = {beta_k}, and `R_INF = R1·e^(−β/T1)` ="
            " {r_inf_ohm}: the resistance at infinite heat, which no sensor lives to see.",
            "Questo sensore ha {r25_ohm} a {room_c} e {hot_ohm} a {hot_c}. Quindi"
            " `β = ln(R1/R2) / (1/T1 − 1/T2)` = {beta_k}, e `R_INF = R1·e^(−β/T1)` = {r_inf_ohm}:"
            " la resistenza a calore infinito, che nessun sensore vede.",
        ),
        Text(
            "Between both points the law is good; beyond them it strays. At {true_c} the board"
            " shows {shown_c}: an error of {error_c}. With a second point at {near.hot_c}, near"
            " to where one prints, it is {near.error_c}.",
            "Tra i due punti la legge è buona; oltre si allontana. A {true_c} la scheda mostra"
            " {shown_c}: un errore di {error_c}. Con un secondo punto a {near.hot_c}, vicino a dove"
            " si stampa, è {near.error_c}.",
        ),
        Text(
            "Steinhart and Hart (`1968`) add a third term, `1/T = A + B·ln R + C·(ln R)³`, which"
            " needs three points. The calculator `thermistor-table` finds it from a data sheet,"
            " and the task of the page from your own measurements.",
            "Steinhart e Hart (`1968`) aggiungono un terzo termine,"
            " `1/T = A + B·ln R + C·(ln R)³`, che richiede tre punti. Il calcolatore"
            " `thermistor-table` lo trova da una scheda tecnica, e l'attività della pagina dalle"
            " tue misure.",
        ),
    ],
    experiment=EXPERIMENT,
    cases={"near": {"hot_c": 250.0}},
    questions=[
        Question(
            Text(
                "A sensor has {r25_ohm} at {room_c} and {hot_ohm} at {hot_c}. What is its β, in"
                " kelvin?",
                "Un sensore ha {r25_ohm} a {room_c} e {hot_ohm} a {hot_c}. Quale β ha, in kelvin?",
            ),
            "beta_k",
            given={"hot_c": 100.0},
            mistakes=[
                Mistake(
                    lambda v: log(v["r25_ohm"] / v["hot_ohm"]) / (1 / v["room_c"] - 1 / v["hot_c"]),
                    Text(
                        "The temperatures must be in kelvin: add `273.15`.",
                        "Le temperature devono essere in kelvin: aggiungi `273.15`.",
                    ),
                ),
                Mistake(
                    lambda v: log(v["r25_ohm"] / v["hot_ohm"]) * (v["hot_c"] - v["room_c"]),
                    Text(
                        "The law has `1/T`: take the difference of the reciprocals.",
                        "La legge ha `1/T`: prendi la differenza dei reciproci.",
                    ),
                ),
            ],
            why=Text(
                "The logarithm of the ratio, divided by the difference of `1/T`.",
                "Il logaritmo del rapporto, diviso per la differenza di `1/T`.",
            ),
            hint=Text(
                "Write the law for both points and divide one by the other.",
                "Scrivi la legge per i due punti e dividi l'una per l'altra.",
            ),
        ),
        Question(
            Text(
                "With β from {hot_c}, the board believes the law. The true temperature is"
                " {true_c}. How many degrees is it wrong, with its sign (shown − true)? Use the"
                " experiment.",
                "Con β da {hot_c}, la scheda crede alla legge. La temperatura vera è {true_c}. Di"
                " quanti gradi sbaglia, col segno (mostrata − vera)? Usa l'esperimento.",
            ),
            "error_c",
            given={"hot_c": 100.0, "true_c": 280.0},
            mistakes=[
                Mistake(
                    lambda v: -v["error_c"],
                    Text(
                        "The sign: what is shown, less what is true.",
                        "Il segno: ciò che si mostra, meno il vero.",
                    ),
                ),
                Mistake(
                    lambda v: v["shown_c"],
                    Text(
                        "That is the temperature that the board shows.",
                        "Questa è la temperatura che la scheda mostra.",
                    ),
                ),
            ],
            why=Text(
                "It shows {shown_c}. So far from its second point the law of two numbers is only a"
                " guess.",
                "Mostra {shown_c}. Così lontano dal secondo punto la legge di due numeri è solo una"
                " stima.",
            ),
            hint=Text(
                "Set both temperatures in the experiment.",
                "Imposta le due temperature nell'esperimento.",
            ),
        ),
    ],
    source=Source("src/passo/config/thermistor.py", "Ntc"),
    printer=OwnPrinter(
        Text(
            "Measure your sensor at three temperatures: the page's task finds both laws, and shows"
            " what is left over.",
            "Misura il tuo sensore a tre temperature: l'attività della pagina trova le due leggi, e"
            " mostra i residui.",
        ),
        page="calibrate",
    ),
    links=[
        Link(
            Text("Calibrate a thermistor", "Calibrare un termistore"),
            document="docs/how-to/calibrate-a-thermistor.md",
        )
    ],
)
