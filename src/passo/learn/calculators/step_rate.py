"""Steps in a second, and the speed at which a board has enough of them."""

from __future__ import annotations

from functools import cache

from passo.config.board_files import load_board
from passo.config.drivers import DRIVERS
from passo.learn.bilingual import Text
from passo.learn.experiment import Choice, Experiment, Number, Outcome, Parameter
from passo.learn.pictures import Graph, Line

_BOARDS = (
    "ramps",
    "melzi",
    "duet-0.6",
    "radds",
    "teensy3-mk20dx256",
    "stm32f407-discovery",
    "pico",
)
_US = 1e6
_STEPS_S = Text("steps/s", "passi/s")


@cache
def board_steps_s(board: str) -> float:
    """Steps per second of all motors together that the planner allows on a board."""
    spec = load_board(board).budget_spec(DRIVERS["A4988"].pulse_us)
    assert spec is not None, board
    return float(spec["steps_s"])


def _compute(speed_mm_s: float, steps_per_mm: float, motors: float, board: str) -> Outcome:
    rate = speed_mm_s * steps_per_mm
    most = board_steps_s(board)
    highest = most / motors / steps_per_mm
    ok = speed_mm_s <= highest
    speeds = [0.0, 1.5 * max(speed_mm_s, highest)]
    return Outcome(
        numbers=[
            Number("rate_hz", Text("Steps of one motor", "Passi di un motore"), rate, _STEPS_S, 0),
            Number(
                "interval_us", Text("Time between steps", "Tempo tra i passi"), _US / rate, "µs"
            ),
            Number(
                "all_hz",
                Text("Steps of all motors", "Passi di tutti i motori"),
                rate * motors,
                _STEPS_S,
                0,
            ),
            Number("board_hz", Text("The board makes", "La scheda ne fa"), most, _STEPS_S, 0),
            Number("highest_mm_s", Text("Highest speed", "Velocità massima"), highest, "mm/s", 1),
            Number(
                "fits",
                Text("Within the board", "Entro la scheda"),
                float(ok),
                words=Text("yes", "sì")
                if ok
                else Text("no: Passo moves slower", "no: Passo rallenta"),
            ),
        ],
        graphs=[
            Graph(
                Text("Steps in a second", "Passi al secondo"),
                Text("speed, mm/s", "velocità, mm/s"),
                _STEPS_S,
                [
                    Line(
                        Text("all motors", "tutti i motori"),
                        speeds,
                        [v * steps_per_mm * motors for v in speeds],
                    ),
                    Line(Text("board", "scheda"), speeds, [most, most], 4, dashed=True),
                ],
            )
        ],
    )


CALCULATOR = Experiment(
    "step-rate",
    Text("Step rate of a board", "Passi al secondo di una scheda"),
    Text(
        "Speed times steps per millimetre, for the motors that move together. The limit of each"
        " board is the one that the planner uses.",
        "Velocità per passi al millimetro, per i motori che si muovono insieme. Il limite di ogni"
        " scheda è quello che usa il pianificatore.",
    ),
    [
        Parameter("speed_mm_s", Text("Speed", "Velocità"), 100.0, 5.0, 1000.0, 5.0, "mm/s"),
        Parameter(
            "steps_per_mm",
            Text("Steps per millimetre", "Passi al millimetro"),
            80.0,
            10.0,
            1600.0,
            10.0,
            Text("steps/mm", "passi/mm"),
        ),
        Parameter(
            "motors", Text("Motors at this speed", "Motori a questa velocità"), 2.0, 1.0, 5.0, 1.0
        ),
        Parameter("board", Text("Board", "Scheda"), "ramps", choices=[*map(Choice, _BOARDS)]),
    ],
    _compute,
)
