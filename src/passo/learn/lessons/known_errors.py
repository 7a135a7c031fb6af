"""What is wrong here? Errors in older texts and firmwares, each to be recomputed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import exp, log

from passo.learn.bilingual import Text, Words, short_figure
from passo.learn.calculators.mosfet_heat import junction_c
from passo.learn.experiment import Choice, Experiment, Number, Outcome, Parameter
from passo.learn.lesson import Chapter, Lesson, Link, Mistake, OwnPrinter, Question, Source
from passo.learn.pictures import Graph, Line, Table, edges

_STEPS_PER_TURN = 3200.0
_BELT, _SCREW = 80.0, 400.0  # steps/mm
_R25_OHM, _T25_K, _BETA_K = 100_000.0, 298.15, 3950.0
_SHOWN_C, _MEASURED_C = 210.0, 187.0
_MOVES, _MOVE_MM = 1000, 0.0123
_HOT_W, _RISE_C_PER_W, _AIR_C = 0.504, 62.5, 25.0  # 12 A through 3.5 mΩ


@dataclass(frozen=True, slots=True)
class _Claim:
    name: Text
    unit: Words
    claimed: Callable[[float, float], float]
    right: Callable[[float, float], float]
    """Both from a length in mm and a temperature in °C."""
    fault: Text


def _ohm(celsius: float) -> float:
    return _R25_OHM * exp(_BETA_K * (1 / (celsius + 273.15) - 1 / _T25_K))


def _inverse_k(celsius: float) -> float:
    return 1 / _T25_K + log(_ohm(celsius) / _R25_OHM) / _BETA_K


_CLAIMS = {
    "belt": _Claim(
        Text("pulses for a way of a belt", "impulsi per una corsa della cinghia"),
        Text("pulses", "impulsi"),
        lambda mm, _: _STEPS_PER_TURN * mm,
        lambda mm, _: _BELT * mm,
        Text("pulses of a rotation, not of a millimetre", "impulsi di un giro, non di un mm"),
    ),
    "screw": _Claim(
        Text("pulses for a way of a screw", "impulsi per una corsa della vite"),
        Text("pulses", "impulsi"),
        lambda mm, _: _STEPS_PER_TURN * _SCREW * mm / 10,
        lambda mm, _: _SCREW * mm,
        Text("the scale contains the rotation already", "la scala contiene già il giro"),
    ),
    "beta": _Claim(
        Text("new β from shown and measured", "nuovo β da mostrata e misurata"),
        "K",
        lambda _, __: 4479.0,
        lambda _, __: _BETA_K * _SHOWN_C / _MEASURED_C,
        Text("a slip of arithmetic", "un errore di calcolo"),
    ),
    "thermistor": _Claim(
        Text("temperature from a resistance", "temperatura da una resistenza"),
        "°C",
        lambda _, c: _inverse_k(c),
        lambda _, c: 1 / _inverse_k(c) - 273.15,
        Text("printed as T, but it is 1/T", "stampata come T, ma è 1/T"),
    ),
    "fahrenheit": _Claim(
        Text("degrees Fahrenheit", "gradi Fahrenheit"),
        "°F",
        lambda _, c: (c - 32) * 5 / 9,
        lambda _, c: c * 9 / 5 + 32,
        Text("the conversion backwards", "la conversione al contrario"),
    ),
    "truncation": _Claim(
        Text("steps of a thousand tiny moves", "passi di mille piccoli movimenti"),
        Text("steps", "passi"),
        lambda _, __: float(_MOVES * int(_MOVE_MM * _BELT)),
        lambda _, __: float(round(_MOVES * _MOVE_MM * _BELT)),
        Text("each move is cut to whole steps", "ogni movimento è troncato a passi interi"),
    ),
    "mosfet": _Claim(
        Text("junction of a MOSFET", "giunzione di un MOSFET"),
        "°C",
        lambda _, __: _AIR_C + _HOT_W * _RISE_C_PER_W,
        lambda _, __: junction_c(_HOT_W, _RISE_C_PER_W, _AIR_C),
        Text("R_DS(on) grows when it is hot", "R_DS(on) cresce da caldo"),
    ),
}


def _compute(claim: str, length_mm: float, celsius: float) -> Outcome:
    one = _CLAIMS[claim]
    claimed, right = one.claimed(length_mm, celsius), one.right(length_mm, celsius)
    rows: list[list[Words]] = []
    for each in _CLAIMS.values():
        values = each.claimed(length_mm, celsius), each.right(length_mm, celsius)
        rows.append(
            [each.name, *(short_figure(value, 4) for value in values), each.unit, each.fault]
        )
    return Outcome(
        numbers=[
            Number(
                "claimed",
                Text("The text says", "Il testo dice"),
                claimed,
                one.unit,
                1 if claimed >= 1 else 4,
            ),
            Number("right", Text("Right is", "Giusto è"), right, one.unit, decimals=1),
            Number(
                "factor",
                Text("Wrong by the factor", "Sbagliato del fattore"),
                claimed / right,
                decimals=4,
            ),
            Number("fault", Text("What is wrong", "Che cosa è sbagliato"), 0.0, words=one.fault),
        ],
        graphs=[
            Graph(
                Text("Text and truth", "Testo e verità"),
                Text("left: the text, right: right", "a sinistra il testo, a destra il giusto"),
                one.unit,
                [Line(one.name, *edges([0.0, 1.0, 2.0], [claimed, right, right]))],
            )
        ],
        tables=[
            Table(
                Text("What is wrong here?", "Che cosa è sbagliato qui?"),
                [
                    Text("claim", "affermazione"),
                    Text("text", "testo"),
                    Text("right", "giusto"),
                    Text("unit", "unità"),
                    Text("fault", "errore"),
                ],
                rows,
            )
        ],
    )


EXPERIMENT = Experiment(
    "known-errors",
    Text("Claims of older texts", "Affermazioni di testi più vecchi"),
    Text(
        "Each claim was printed in a manual, or is in a firmware that many have learned from.",
        "Ogni affermazione era in un manuale, o è in un firmware da cui molti hanno imparato.",
    ),
    [
        Parameter(
            "claim",
            Text("Claim", "Affermazione"),
            "belt",
            choices=[Choice(key, one.name) for key, one in _CLAIMS.items()],
        ),
        Parameter("length_mm", Text("Way", "Corsa"), 10.0, low=1.0, high=100.0, unit="mm"),
        Parameter(
            "celsius", Text("Temperature", "Temperatura"), 200.0, low=20.0, high=280.0, unit="°C"
        ),
    ],
    _compute,
)

LESSON = Lesson(
    name="known-errors",
    chapter=Chapter.PRACTICE,
    place=50,
    rows=(2, 11, 12, 22),
    minutes=30,
    title=Text("What is wrong here?", "Che cosa è sbagliato qui?"),
    goal=Text(
        "You find errors in texts and firmwares by computing a number yourself.",
        "Trovi errori in testi e firmware calcolando tu stesso un numero.",
    ),
    text=[
        Text(
            "Manuals and firmwares have errors, good ones too. The best test is a number: compute"
            " it in another way, and see whether its size can be true. Cover the right column of"
            " the table, and try each row.",
            "Manuali e firmware hanno errori, anche quelli buoni. La prova migliore è un numero:"
            " calcolalo per un'altra via, e guarda se la grandezza può essere vera. Copri la"
            " colonna giusta della tabella, e prova ogni riga.",
        ),
        Text(
            "A translated guide says that a belt needs {claimed} for {length_mm}. That is wrong by"
            " the factor {factor}: {fault}. Right is {right}.",
            "Una guida tradotta dice che una cinghia richiede {claimed} per {length_mm}. È"
            " sbagliato del fattore {factor}: {fault}. Giusto è {right}.",
        ),
        Text(
            "A manual calibrates a thermistor by its own rule, `3950 · 210 / 187`, and then sends"
            " M305 with {beta.claimed}. The rule gives {beta.right}. An error of a percent in β is"
            " some degrees at the nozzle.",
            "Un manuale calibra un termistore con la propria regola, `3950 · 210 / 187`, e poi"
            " manda M305 con {beta.claimed}. La regola dà {beta.right}. Un errore di un percento"
            " su β sono alcuni gradi all'ugello.",
        ),
        Text(
            "Errors in code look the same. A firmware cut each move to whole steps:"
            " {truncation.claimed} in place of {truncation.right}, and the axis does not move at"
            " all. Another converted to Fahrenheit backwards: {celsius} became"
            " {fahrenheit.claimed} in place of {fahrenheit.right}.",
            "Gli errori nel codice si riconoscono allo stesso modo. Un firmware troncava ogni"
            " movimento a passi interi: {truncation.claimed} invece di {truncation.right}, e l'asse"
            " non si muove affatto. Un altro convertiva in Fahrenheit al contrario: {celsius}"
            " diventavano {fahrenheit.claimed} invece di {fahrenheit.right}.",
        ),
        Text(
            "Some errors have no number, and are worse: protections against overheating that are"
            " off by default; endstops that stop a move away from them; text printed inside of an"
            " interrupt; a heater fault that stops one heater while the print continues. Read a"
            " default before you trust it.",
            "Alcuni errori non hanno un numero, e sono peggiori: protezioni dal surriscaldamento"
            " disattivate di serie; finecorsa che fermano un movimento che se ne allontana; testo"
            " stampato dentro un interrupt; un guasto che spegne un riscaldatore mentre la stampa"
            " continua. Leggi un valore predefinito prima di fidarti.",
        ),
    ],
    experiment=EXPERIMENT,
    cases={
        "beta": {"claim": "beta"},
        "truncation": {"claim": "truncation"},
        "fahrenheit": {"claim": "fahrenheit"},
    },
    questions=[
        Question(
            Text(
                "“The screw has `400` steps per millimetre and `3200` per rotation, so"
                " {length_mm} need {claimed}.” How many are right?",
                "“La vite ha `400` passi al millimetro e `3200` al giro, quindi {length_mm}"
                " richiedono {claimed}.” Quanti sono quelli giusti?",
            ),
            "right",
            given={"claim": "screw", "length_mm": 25.0},
            mistakes=[
                Mistake(
                    lambda v: v["claimed"],
                    Text(
                        "The same error: `400` steps per millimetre contain the rotation already.",
                        "Lo stesso errore: `400` passi al millimetro contengono già il giro.",
                    ),
                ),
                Mistake(
                    lambda v: 3200 * v["length_mm"],
                    Text(
                        "That would be one rotation for each millimetre. The lead is `8 mm`.",
                        "Così sarebbe un giro per ogni millimetro. Il passo è `8 mm`.",
                    ),
                ),
            ],
            why=Text(
                "Steps per millimetre times millimetres, and nothing else: {fault}.",
                "Passi al millimetro per millimetri, e nient'altro: {fault}.",
            ),
            hint=Text(
                "What does “steps per millimetre” mean, word by word?",
                "Che cosa significa “passi al millimetro”, parola per parola?",
            ),
        ),
        Question(
            Text(
                "A manual: old β `3950`, the printer shows `210 °C` on average, the thermometer in"
                " the nozzle `187 °C`, hence {claimed}. By its rule, β times shown by measured,"
                " which β is right?",
                "Un manuale: vecchio β `3950`, la stampante mostra in media `210 °C`, il termometro"
                " nell'ugello `187 °C`, quindi {claimed}. Con la sua regola, β per mostrata su"
                " misurata, quale β è giusto?",
            ),
            "right",
            given={"claim": "beta"},
            tolerance=0.001,
            mistakes=[
                Mistake(
                    lambda v: v["claimed"],
                    Text(
                        "That is the printed number. Compute it.",
                        "Questo è il numero stampato. Calcolalo.",
                    ),
                ),
                Mistake(
                    lambda _: _BETA_K * _MEASURED_C / _SHOWN_C,
                    Text(
                        "The other way round: the new β is larger than the old one.",
                        "Al contrario: il nuovo β è più grande del vecchio.",
                    ),
                ),
            ],
            why=Text(
                "The rule itself is only a first approach: a fit over all pairs is better.",
                "La regola stessa è solo un primo approccio: meglio adattare tutte le coppie.",
            ),
            hint=Text(
                "Type it into a calculator, and do not trust the paper.",
                "Mettilo in una calcolatrice, e non fidarti della carta.",
            ),
        ),
        Question(
            Text(
                "A firmware shows {celsius} as {claimed}. Which number in Fahrenheit is right?",
                "Un firmware mostra {celsius} come {claimed}. Quale numero in Fahrenheit è giusto?",
            ),
            "right",
            given={"claim": "fahrenheit", "celsius": 60.0},
            mistakes=[
                Mistake(
                    lambda v: v["claimed"],
                    Text(
                        "That is lower than the Celsius value. Can that be, above freezing?",
                        "È più basso del valore Celsius. È possibile, sopra lo zero?",
                    ),
                ),
                Mistake(
                    lambda v: v["celsius"] * 9 / 5,
                    Text(
                        "The scales do not begin at the same point: add `32`.",
                        "Le scale non partono dallo stesso punto: aggiungi `32`.",
                    ),
                ),
                Mistake(
                    lambda v: (v["celsius"] + 32) * 9 / 5,
                    Text(
                        "First the factor, then the `32`.",
                        "Prima il fattore, poi i `32`.",
                    ),
                ),
            ],
            why=Text("`C · 9/5 + 32`.", "`C · 9/5 + 32`."),
            hint=Text(
                "Check the formula with boiling water: `100 °C` are `212 °F`.",
                "Verifica la formula con l'acqua bollente: `100 °C` sono `212 °F`.",
            ),
        ),
    ],
    source=Source("src/passo/config/thermistor.py", "Ntc.celsius"),
    printer=OwnPrinter(
        Text(
            "Take three values of your own printer from M503 and recompute them: scale, thermistor,"
            " highest speed in steps per second.",
            "Prendi da M503 tre valori della tua stampante e ricalcolali: scala, termistore,"
            " velocità massima in passi al secondo.",
        ),
        command="M503",
    ),
    links=[
        Link(
            Text("Calibrate a thermistor", "Calibra un termistore"),
            document="docs/how-to/calibrate-a-thermistor.md",
        )
    ],
)
