"""How hot the transistor of a heater becomes."""

from __future__ import annotations

from math import inf

from passo.learn.bilingual import Text
from passo.learn.experiment import Choice, Experiment, Number, Outcome, Parameter
from passo.learn.pictures import Graph, Line

_GROWTH_PER_K = 0.006  # of R_DS(on): 1.6 times as much at 125 °C as at 25 °C
_AT_C = 25.0
_MAX_C = 175.0  # of the junction
_PARTS_MOHM = {"STP55NF06L": 18.0, "IRLB8743": 3.5, "IRLB3034": 1.7}
_POINTS = 60
_DRAWN_C = 400.0


def junction_c(power_w: float, rise_c_per_w: float, ambient_c: float) -> float:
    """The temperature of the junction, with the resistance growing with it; infinite if each degree
    makes more heat than one degree leads away."""
    grows = power_w * _GROWTH_PER_K * rise_c_per_w
    if grows >= 1:
        return inf
    cold = power_w * (1 + _GROWTH_PER_K * (ambient_c - _AT_C))
    return ambient_c + rise_c_per_w * cold / (1 - grows)


def _compute(
    part: str, current_a: float, on_mohm: float, rise_c_per_w: float, ambient_c: float
) -> Outcome:
    ohm = _PARTS_MOHM.get(part, on_mohm) / 1000
    power_w = current_a**2 * ohm
    simple_c = ambient_c + power_w * rise_c_per_w
    real_c = junction_c(power_w, rise_c_per_w, ambient_c)
    highest_a = ((_MAX_C - ambient_c) / rise_c_per_w / ohm) ** 0.5
    currents = [1.3 * highest_a * k / _POINTS for k in range(1, _POINTS + 1)]
    grown = [(a, junction_c(a * a * ohm, rise_c_per_w, ambient_c)) for a in currents]
    shown = [(a, c) for a, c in grown if c < _DRAWN_C]
    ok = real_c <= _MAX_C
    return Outcome(
        numbers=[
            Number("power_w", Text("Heat, I²·R", "Calore, I²·R"), power_w, "W", 3),
            Number("rise_c", Text("Rise", "Aumento"), power_w * rise_c_per_w, "°C", 1),
            Number("junction_c", Text("Junction", "Giunzione"), simple_c, "°C", 1),
            Number(
                "hot_junction_c",
                Text("Junction, R grows with it", "Giunzione, R cresce con essa"),
                real_c,
                "°C",
                1,
                words="" if real_c < _DRAWN_C else Text("it is destroyed", "si distrugge"),
            ),
            Number(
                "fits",
                Text("Within the limit", "Entro il limite"),
                float(ok),
                words=Text("yes", "sì")
                if ok
                else Text("no: heat sink or better part", "no: dissipatore o parte migliore"),
            ),
            Number(
                "highest_a",
                Text("Current at the limit, R constant", "Corrente al limite, R costante"),
                highest_a,
                "A",
                1,
            ),
        ],
        graphs=[
            Graph(
                Text("Temperature of the junction", "Temperatura della giunzione"),
                Text("current, A", "corrente, A"),
                "°C",
                [
                    Line(
                        Text("R constant", "R costante"),
                        currents,
                        [ambient_c + a * a * ohm * rise_c_per_w for a in currents],
                    ),
                    Line(
                        Text("R grows with the temperature", "R cresce con la temperatura"),
                        [a for a, _ in shown],
                        [c for _, c in shown],
                        1,
                    ),
                    Line(
                        Text("limit of the part", "limite della parte"),
                        [currents[0], currents[-1]],
                        [_MAX_C, _MAX_C],
                        4,
                        dashed=True,
                    ),
                ],
            )
        ],
    )


CALCULATOR = Experiment(
    "mosfet-heat",
    Text("Heat of a MOSFET", "Calore di un MOSFET"),
    Text(
        "A transistor that switches a heater has a small resistance, and warms up by I²·R.",
        "Il transistor di un riscaldatore ha una piccola resistenza, e si scalda per I²·R.",
    ),
    [
        Parameter(
            "part",
            Text("Part", "Parte"),
            "STP55NF06L",
            choices=[*map(Choice, _PARTS_MOHM), Choice("own", Text("another", "un'altra"))],
        ),
        Parameter("current_a", Text("Current", "Corrente"), 12.0, 0.5, 40.0, 0.5, "A"),
        Parameter(
            "on_mohm",
            Text("R_DS(on) of another part", "R_DS(on) di un'altra parte"),
            10.0,
            0.5,
            50.0,
            0.5,
            "mΩ",
        ),
        Parameter(
            "rise_c_per_w",
            Text("Thermal resistance to the air", "Resistenza termica verso l'aria"),
            62.5,
            5.0,
            80.0,
            0.5,
            "°C/W",
        ),
        Parameter("ambient_c", Text("Air", "Aria"), 25.0, 0.0, 60.0, 1.0, "°C"),
    ],
    _compute,
)
