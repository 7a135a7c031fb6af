"""Power of a heater, and the time that it needs."""

from __future__ import annotations

from math import exp, inf, isfinite, log

from passo.learn.bilingual import Text
from passo.learn.experiment import Choice, Experiment, Number, Outcome, Parameter
from passo.learn.pictures import Graph, Line

_NEVER = Text("never", "mai")
_POINTS = 80


def _compute(
    supply_v: float,
    rated_v: float,
    rated_w: float,
    ambient_c: float,
    target_c: float,
    capacity_j_per_k: float,
    loss_w_per_k: float,
) -> Outcome:
    ohm = rated_v**2 / rated_w
    power_w = supply_v**2 / ohm
    final_c = ambient_c + power_w / loss_w_per_k
    constant_s = capacity_j_per_k / loss_w_per_k
    reached = target_c < final_c
    warm_s = -constant_s * log((final_c - target_c) / (final_c - ambient_c)) if reached else inf
    end_s = 1.3 * warm_s if isfinite(warm_s) else 5 * constant_s
    times_s = [end_s * k / _POINTS for k in range(_POINTS + 1)]
    hold = loss_w_per_k * (target_c - ambient_c) / power_w
    return Outcome(
        numbers=[
            Number("ohm", Text("Resistance", "Resistenza"), ohm, "Ω"),
            Number("current_a", Text("Current", "Corrente"), supply_v / ohm, "A"),
            Number("power_w", Text("Power", "Potenza"), power_w, "W", 1),
            Number(
                "warm_s",
                Text("Time to the target", "Tempo fino all'obiettivo"),
                warm_s,
                "s",
                0,
                words="" if reached else _NEVER,
            ),
            Number(
                "hold_percent",
                Text("Power to keep it", "Potenza per mantenerla"),
                100 * hold,
                "%",
                1,
            ),
            Number("final_c", Text("Where it would end", "Dove finirebbe"), final_c, "°C", 0),
        ],
        graphs=[
            Graph(
                Text("Temperature at full power", "Temperatura a piena potenza"),
                Text("time, s", "tempo, s"),
                "°C",
                [
                    Line(
                        Text("heater", "riscaldatore"),
                        times_s,
                        [final_c + (ambient_c - final_c) * exp(-s / constant_s) for s in times_s],
                        4,
                    ),
                    Line(
                        Text("target", "obiettivo"),
                        [0.0, end_s],
                        [target_c, target_c],
                        0,
                        dashed=True,
                    ),
                ],
            )
        ],
    )


CALCULATOR = Experiment(
    "heater-power",
    Text("Power and time of a heater", "Potenza e tempo di un riscaldatore"),
    Text(
        "A heater is a resistor: another voltage gives another power. The body loses heat in"
        " proportion to its temperature above the air.",
        "Un riscaldatore è una resistenza: un'altra tensione dà un'altra potenza. Il corpo perde"
        " calore in proporzione alla sua temperatura oltre quella dell'aria.",
    ),
    [
        Parameter(
            "supply_v",
            Text("Supply", "Alimentazione"),
            12.0,
            unit="V",
            choices=[Choice(12.0), Choice(24.0)],
        ),
        Parameter(
            "rated_v",
            Text("Voltage on the label", "Tensione sull'etichetta"),
            12.0,
            unit="V",
            choices=[Choice(12.0), Choice(24.0)],
        ),
        Parameter(
            "rated_w",
            Text("Power on the label", "Potenza sull'etichetta"),
            40.0,
            5.0,
            500.0,
            5.0,
            "W",
        ),
        Parameter("ambient_c", Text("Air", "Aria"), 25.0, 0.0, 60.0, 1.0, "°C"),
        Parameter("target_c", Text("Target", "Obiettivo"), 200.0, 40.0, 300.0, 5.0, "°C"),
        Parameter(
            "capacity_j_per_k",
            Text("Heat for one degree", "Calore per un grado"),
            16.0,
            2.0,
            1000.0,
            1.0,
            "J/K",
        ),
        Parameter(
            "loss_w_per_k",
            Text("Loss for one degree", "Perdita per un grado"),
            0.12,
            0.02,
            5.0,
            0.01,
            "W/K",
        ),
    ],
    _compute,
)
