"""Steps per millimetre of an axis with a belt or a lead screw."""

from __future__ import annotations

from passo.config.motion import Stepper
from passo.learn.bilingual import Text
from passo.learn.experiment import Choice, Experiment, Number, Outcome, Parameter
from passo.learn.pictures import Graph, Line

_MICROSTEPS = (1, 2, 4, 8, 16, 32, 64, 128, 256)
_UM = 1000.0
_STEPS_PER_MM = Text("steps/mm", "passi/mm")
_STEPS_PER_ROTATION = Text("steps", "passi")


def _compute(
    drive: str,
    teeth: float,
    pitch_mm: float,
    lead_mm: float,
    full_steps: float,
    microsteps: float,
    gear_ratio: float,
) -> Outcome:
    travel_mm = teeth * pitch_mm if drive == "belt" else lead_mm

    def steps_per_mm(each: float) -> float:
        return Stepper.model_validate(
            {
                "rotation_distance_mm": travel_mm,
                "full_steps_per_rotation": int(full_steps),
                "microsteps": int(each),
                "gear_ratio": gear_ratio,
            }
        ).steps_per_unit

    found = steps_per_mm(microsteps)
    positions_mm = [k / 50 for k in range(51)]  # of the first millimetre
    coarse = steps_per_mm(1)
    return Outcome(
        numbers=[
            Number(
                "travel_mm",
                Text("Travel of one rotation", "Corsa di un giro"),
                travel_mm,
                "mm",
                decimals=1,
            ),
            Number(
                "steps_per_rotation",
                Text("Steps of one rotation", "Passi di un giro"),
                full_steps * microsteps * gear_ratio,
                _STEPS_PER_ROTATION,
                decimals=0,
            ),
            Number(
                "steps_per_mm",
                Text("Steps per millimetre", "Passi al millimetro"),
                found,
                _STEPS_PER_MM,
            ),
            Number("step_um", Text("One step", "Un passo"), _UM / found, "µm"),
        ],
        graphs=[
            Graph(
                Text("Steps for a distance", "Passi per una distanza"),
                Text("distance, mm", "distanza, mm"),
                Text("steps", "passi"),
                [
                    Line(
                        Text("with these microsteps", "con questi micropassi"),
                        positions_mm,
                        [x * found for x in positions_mm],
                    ),
                    Line(
                        Text("with full steps", "a passo intero"),
                        positions_mm,
                        [x * coarse for x in positions_mm],
                        colour=1,
                        dashed=True,
                    ),
                ],
            )
        ],
    )


CALCULATOR = Experiment(
    "steps-per-mm",
    Text("Steps per millimetre", "Passi al millimetro"),
    Text(
        "From pulley or screw, motor and microsteps to the number that the printer needs.",
        "Da puleggia o vite, motore e micropassi al numero che serve alla stampante.",
    ),
    [
        Parameter(
            "drive",
            Text("Drive", "Trasmissione"),
            "belt",
            choices=[
                Choice("belt", Text("belt and pulley", "cinghia e puleggia")),
                Choice("screw", Text("lead screw", "vite")),
            ],
        ),
        Parameter(
            "teeth",
            Text("Teeth of the pulley", "Denti della puleggia"),
            20.0,
            low=10.0,
            high=60.0,
            unit=Text("teeth", "denti"),
        ),
        Parameter(
            "pitch_mm",
            Text("Pitch of the belt", "Passo della cinghia"),
            2.0,
            unit="mm",
            choices=[Choice(2.0), Choice(2.5), Choice(3.0), Choice(5.0)],
        ),
        Parameter(
            "lead_mm",
            Text("Lead of the screw", "Avanzamento della vite"),
            8.0,
            low=0.5,
            high=16.0,
            step=0.05,
            unit="mm",
        ),
        Parameter(
            "full_steps",
            Text("Full steps of the motor", "Passi interi del motore"),
            200.0,
            choices=[
                Choice(200.0, Text("200 (1.8°)", "200 (1,8°)")),
                Choice(400.0, Text("400 (0.9°)", "400 (0,9°)")),
            ],
        ),
        Parameter(
            "microsteps",
            Text("Microsteps", "Micropassi"),
            16.0,
            choices=[Choice(float(each)) for each in _MICROSTEPS],
        ),
        Parameter(
            "gear_ratio",
            Text("Gear ratio", "Rapporto di riduzione"),
            1.0,
            low=1.0,
            high=10.0,
            step=0.01,
        ),
    ],
    _compute,
)
