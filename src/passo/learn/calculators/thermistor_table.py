"""A table of a thermistor: resistance, voltage and count for each temperature."""

from __future__ import annotations

from passo.config.thermistor import Divider, Ntc
from passo.learn.bilingual import Text
from passo.learn.experiment import Choice, Experiment, Number, Outcome, Parameter
from passo.learn.pictures import Graph, Line, Table

_ROWS_C = [float(c) for c in range(0, 301, 20)]
_CURVE_C = [float(c) for c in range(0, 301, 5)]


def _compute(
    first_ohm: float,
    second_c: float,
    second_ohm: float,
    third_c: float,
    third_ohm: float,
    pullup_ohm: float,
) -> Outcome:
    sensor = Ntc.through((25.0, first_ohm), (second_c, second_ohm), (third_c, third_ohm))
    divider = Divider(pullup_ohm)
    return Outcome(
        numbers=[
            Number(
                "r25_ohm", Text("Resistance at 25 °C", "Resistenza a 25 °C"), sensor.r25_ohm, "Ω", 0
            ),
            Number("beta_k", "β", sensor.beta_k, "K", 0),
            Number("c_per_k", Text("C, in 10⁻⁹/K", "C, in 10⁻⁹/K"), 1e9 * sensor.c_per_k, "", 2),
        ],
        graphs=[
            Graph(
                Text("Part of the supply at the pin", "Parte dell'alimentazione sul pin"),
                Text("temperature, °C", "temperatura, °C"),
                "%",
                [
                    Line(
                        Text("sensor", "sensore"),
                        _CURVE_C,
                        [100 * divider.share(sensor.ohm(c)) for c in _CURVE_C],
                    )
                ],
            )
        ],
        tables=[
            Table(
                Text("Table", "Tabella"),
                ["°C", "Ω", "%", Text("count of 1024", "conteggio su 1024")],
                [
                    [f"{c:.0f}", f"{ohm:.0f}", f"{100 * share:.2f}", f"{int(1024 * share)}"]
                    for c in _ROWS_C
                    for ohm in [sensor.ohm(c)]
                    for share in [divider.share(ohm)]
                ],
            )
        ],
    )


CALCULATOR = Experiment(
    "thermistor-table",
    Text("Table of a thermistor", "Tabella di un termistore"),
    Text(
        "Three points of the data sheet give the equation of Steinhart and Hart, and the table.",
        "Tre punti della scheda tecnica danno l'equazione di Steinhart e Hart, e la tabella.",
    ),
    [
        Parameter(
            "first_ohm",
            Text("Resistance at 25 °C", "Resistenza a 25 °C"),
            100_000.0,
            500.0,
            500_000.0,
            500.0,
            "Ω",
        ),
        Parameter(
            "second_c",
            Text("Second temperature", "Seconda temperatura"),
            150.0,
            60.0,
            170.0,
            5.0,
            "°C",
        ),
        Parameter(
            "second_ohm",
            Text("Resistance there", "Resistenza lì"),
            1642.0,
            100.0,
            20_000.0,
            1.0,
            "Ω",
        ),
        Parameter(
            "third_c",
            Text("Third temperature", "Terza temperatura"),
            250.0,
            180.0,
            300.0,
            5.0,
            "°C",
        ),
        Parameter(
            "third_ohm", Text("Resistance there", "Resistenza lì"), 226.0, 10.0, 1000.0, 1.0, "Ω"
        ),
        Parameter(
            "pullup_ohm",
            Text("Pull-up", "Pull-up"),
            4700.0,
            unit="Ω",
            choices=[Choice(1000.0), Choice(2200.0), Choice(4700.0), Choice(10_000.0)],
        ),
    ],
    _compute,
)
