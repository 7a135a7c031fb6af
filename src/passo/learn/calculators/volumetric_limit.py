"""The speed at which a hotend melts no more."""

from __future__ import annotations

from math import pi

from passo.learn.bilingual import Text
from passo.learn.calculators.line_and_flow import LINE_HEIGHT, LINE_WIDTH, line_area_mm2
from passo.learn.experiment import Experiment, Number, Outcome, Parameter
from passo.learn.pictures import Graph, Line

_FILAMENT_MM2 = pi * (1.75 / 2) ** 2
_POINTS = 50


def _compute(limit_mm3_s: float, width_mm: float, height_mm: float, speed_mm_s: float) -> Outcome:
    area = line_area_mm2(width_mm, height_mm)
    highest = limit_mm3_s / area
    heights = [0.05 + 0.25 * k / _POINTS for k in range(_POINTS + 1)]
    ok = speed_mm_s <= highest
    return Outcome(
        numbers=[
            Number("highest_mm_s", Text("Highest speed", "Velocità massima"), highest, "mm/s", 1),
            Number(
                "flow_mm3_s", Text("Flow asked for", "Flusso richiesto"), area * speed_mm_s, "mm³/s"
            ),
            Number(
                "share_percent",
                Text("Of what the hotend melts", "Di quanto fonde l'hotend"),
                100 * area * speed_mm_s / limit_mm3_s,
                "%",
                1,
            ),
            Number(
                "filament_mm_s",
                Text("Filament at the limit", "Filamento al limite"),
                limit_mm3_s / _FILAMENT_MM2,
                "mm/s",
            ),
            Number(
                "fits",
                Text("Possible", "Possibile"),
                float(ok),
                words=Text("yes", "sì")
                if ok
                else Text("no: slower or thinner", "no: più lento o sottile"),
            ),
        ],
        graphs=[
            Graph(
                Text("Highest speed", "Velocità massima"),
                Text("height of the layer, mm", "altezza dello strato, mm"),
                "mm/s",
                [
                    Line(
                        Text("limit", "limite"),
                        heights,
                        [limit_mm3_s / line_area_mm2(width_mm, h) for h in heights],
                        4,
                    ),
                    Line(
                        Text("speed asked for", "velocità richiesta"),
                        [heights[0], heights[-1]],
                        [speed_mm_s, speed_mm_s],
                        dashed=True,
                    ),
                ],
            )
        ],
    )


CALCULATOR = Experiment(
    "volumetric-limit",
    Text("Volumetric limit", "Limite volumetrico"),
    Text(
        "A hotend melts only so much plastic in a second. That bounds the speed of a line.",
        "Un hotend fonde solo tanta plastica al secondo. Questo limita la velocità di una linea.",
    ),
    [
        Parameter(
            "limit_mm3_s",
            Text("The hotend melts at most", "L'hotend fonde al massimo"),
            11.0,
            1.0,
            60.0,
            0.5,
            "mm³/s",
        ),
        LINE_WIDTH,
        LINE_HEIGHT,
        Parameter("speed_mm_s", Text("Speed", "Velocità"), 150.0, 5.0, 500.0, 5.0, "mm/s"),
    ],
    _compute,
)
