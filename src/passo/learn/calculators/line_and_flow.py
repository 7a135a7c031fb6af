"""The filament that a printed line needs."""

from __future__ import annotations

from math import pi

from passo.learn.bilingual import Text
from passo.learn.experiment import Choice, Experiment, Number, Outcome, Parameter
from passo.learn.pictures import Graph, Line

_MM3_S = "mm³/s"
_POINTS = 40


def line_area_mm2(width_mm: float, height_mm: float) -> float:
    """The cross-section of a line: a rectangle with round sides."""
    return height_mm * (width_mm - height_mm) + pi * (height_mm / 2) ** 2


def _compute(
    width_mm: float,
    height_mm: float,
    length_mm: float,
    speed_mm_s: float,
    filament_mm: float,
    flow_percent: float,
) -> Outcome:
    area = line_area_mm2(width_mm, height_mm) * flow_percent / 100
    filament_area = pi * (filament_mm / 2) ** 2
    speeds = [2 * speed_mm_s * k / _POINTS for k in range(_POINTS + 1)]
    return Outcome(
        numbers=[
            Number(
                "area_mm2", Text("Cross-section of the line", "Sezione della linea"), area, "mm²", 4
            ),
            Number("volume_mm3", Text("Volume", "Volume"), area * length_mm, "mm³"),
            Number(
                "filament_area_mm2",
                Text("Cross-section of the filament", "Sezione del filamento"),
                filament_area,
                "mm²",
                3,
            ),
            Number(
                "e_mm",
                Text("Filament for the line (E)", "Filamento per la linea (E)"),
                area * length_mm / filament_area,
                "mm",
                4,
            ),
            Number("flow_mm3_s", Text("Flow", "Flusso"), area * speed_mm_s, _MM3_S),
            Number(
                "filament_mm_s",
                Text("Speed of the filament", "Velocità del filamento"),
                area * speed_mm_s / filament_area,
                "mm/s",
                3,
            ),
        ],
        graphs=[
            Graph(
                Text("Flow", "Flusso"),
                Text("speed, mm/s", "velocità, mm/s"),
                _MM3_S,
                [Line(Text("this line", "questa linea"), speeds, [area * v for v in speeds])],
            )
        ],
    )


LINE_WIDTH = Parameter(
    "width_mm", Text("Width of the line", "Larghezza della linea"), 0.45, 0.3, 1.2, 0.01, "mm"
)
LINE_HEIGHT = Parameter(
    "height_mm", Text("Height of the layer", "Altezza dello strato"), 0.2, 0.05, 0.3, 0.01, "mm"
)

CALCULATOR = Experiment(
    "line-and-flow",
    Text("Line width and flow", "Larghezza della linea e flusso"),
    Text(
        "The plastic of a line, and the filament that the extruder pushes for it.",
        "La plastica di una linea, e il filamento che l'estrusore spinge per essa.",
    ),
    [
        LINE_WIDTH,
        LINE_HEIGHT,
        Parameter("length_mm", Text("Length", "Lunghezza"), 100.0, 1.0, 500.0, 1.0, "mm"),
        Parameter("speed_mm_s", Text("Speed", "Velocità"), 60.0, 5.0, 500.0, 5.0, "mm/s"),
        Parameter(
            "filament_mm",
            Text("Filament", "Filamento"),
            1.75,
            unit="mm",
            choices=[Choice(1.75), Choice(2.85)],
        ),
        Parameter(
            "flow_percent", Text("Flow factor", "Fattore di flusso"), 100.0, 50.0, 150.0, 1.0, "%"
        ),
    ],
    _compute,
)
