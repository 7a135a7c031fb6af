"""The current of a stepper motor, and the reference voltage of its driver."""

from __future__ import annotations

from math import sqrt

from passo.learn.bilingual import Text
from passo.learn.experiment import Choice, Experiment, Number, Outcome, Parameter
from passo.learn.pictures import Graph, Line

_COILS = 2
_TMC_FULL_V = 0.32  # over the sense resistor at full scale
_TMC_INNER_OHM = 0.02
_TMC_REFERENCE_V = 2.5
_GAIN = {"A4988": 8.0, "DRV8825": 5.0}
_POINTS = 50


def reference_v(driver: str, peak_a: float, sense_ohm: float) -> float:
    """The voltage at the reference pin for a peak current: the laws of the data sheets."""
    if driver in _GAIN:
        return peak_a * _GAIN[driver] * sense_ohm
    return peak_a * _TMC_REFERENCE_V * (sense_ohm + _TMC_INNER_OHM) / _TMC_FULL_V


def _compute(
    driver: str, rated_a: float, percent: float, sense_ohm: float, coil_ohm: float
) -> Outcome:
    peak_a = rated_a * percent / 100
    rms_a = peak_a / sqrt(2)
    currents = [rated_a * k / _POINTS for k in range(_POINTS + 1)]
    voltage = reference_v(driver, peak_a, sense_ohm)
    return Outcome(
        numbers=[
            Number("peak_a", Text("Peak current", "Corrente di picco"), peak_a, "A", 3),
            Number("rms_a", Text("RMS current", "Corrente efficace"), rms_a, "A", 3),
            Number("reference_v", Text("Reference voltage", "Tensione V_ref"), voltage, "V", 3),
            Number(
                "torque_percent",
                Text("Torque, of that with the rated peak", "Coppia, di quella col picco nominale"),
                percent,
                "%",
                0,
            ),
            Number(
                "heat_w",
                Text("Heat in both coils", "Calore nelle due bobine"),
                _COILS * rms_a**2 * coil_ohm,
                "W",
            ),
        ],
        graphs=[
            Graph(
                Text("Reference voltage", "Tensione V_ref"),
                Text("peak current, A", "corrente di picco, A"),
                "V",
                [
                    Line(driver, currents, [reference_v(driver, a, sense_ohm) for a in currents]),
                    Line(
                        Text("this current", "questa corrente"),
                        [peak_a, peak_a],
                        [0.0, voltage],
                        1,
                        dashed=True,
                    ),
                ],
            )
        ],
    )


CALCULATOR = Experiment(
    "motor-current",
    Text("Motor current and reference voltage", "Corrente del motore e V_ref"),
    Text(
        "From the rated current of a motor to the voltage at the screw of its driver.",
        "Dalla corrente nominale di un motore alla tensione sul trimmer del driver.",
    ),
    [
        Parameter(
            "driver",
            Text("Driver", "Driver"),
            "A4988",
            choices=[Choice("A4988"), Choice("DRV8825"), Choice("TMC2209")],
        ),
        Parameter(
            "rated_a",
            Text("Rated current of a phase", "Corrente nominale di una fase"),
            1.7,
            0.2,
            3.0,
            0.1,
            "A",
        ),
        Parameter(
            "percent",
            Text("Use of it", "Quanta usarne"),
            70.0,
            10.0,
            100.0,
            5.0,
            "%",
        ),
        Parameter(
            "sense_ohm",
            Text("Sense resistor", "Resistenza di misura"),
            0.1,
            unit="Ω",
            choices=[Choice(0.05), Choice(0.068), Choice(0.1), Choice(0.11), Choice(0.2)],
        ),
        Parameter(
            "coil_ohm",
            Text("Resistance of a coil", "Resistenza di una bobina"),
            1.6,
            0.5,
            30.0,
            0.1,
            "Ω",
        ),
    ],
    _compute,
)
