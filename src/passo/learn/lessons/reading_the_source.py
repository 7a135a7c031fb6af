"""A walk from one line of G-code to the pin of a motor, with the values at each stop."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from passo.job.batch.policy import Policy
from passo.learn.bilingual import Text, Words
from passo.learn.experiment import Experiment, Number, Outcome, Parameter
from passo.learn.explain import explain
from passo.learn.explanation import Explanation
from passo.learn.lesson import Chapter, Lesson, Link, Mistake, OwnPrinter, Question, Source
from passo.learn.pictures import Graph, Line, Table, edges
from passo.learn.planned import shipped

_QUEUE = re.compile(r"interval=(-?\d+) count=(\d+) add=(-?\d+)")
_SHOWN_STEPS = 200
_TICKS = Text("ticks", "tick")
_BYTES = Text("bytes", "byte")


@cache
def _explained(length_mm: float, speed_mm_s: float) -> Explanation:
    with TemporaryDirectory() as folder:
        path = Path(folder) / "line.gcode"
        path.write_text(f"G1 X{length_mm:g} F{60 * speed_mm_s:g}\n", encoding="ascii")
        return explain(shipped("i3"), path, 1, Policy())


def _queued(explanation: Explanation) -> list[tuple[int, int, int]]:
    """Interval, count and add of the commands for X."""
    texts = [command.text for command in explanation.wire if command.motor == "x"]
    found = [_QUEUE.search(text) for text in texts]
    return [(int(one[1]), int(one[2]), int(one[3])) for one in found if one]


def _step_ticks(commands: list[tuple[int, int, int]]) -> list[int]:
    """The clock of each step, as the board computes it."""
    ticks: list[int] = []
    now = 0
    for interval, count, add in commands:
        gap = interval
        for _ in range(count):
            now += gap
            ticks.append(now)
            gap += add
    return ticks


def _compute(length_mm: float, speed_mm_s: float) -> Outcome:
    found = _explained(length_mm, speed_mm_s)
    machine = shipped("i3")
    hz = machine.board.clock_hz
    (move,) = found.moves
    (steps,) = (one for one in found.steps if one.motor == "x")
    commands = _queued(found)
    interval, count, add = commands[0]
    ticks = _step_ticks(commands)
    message = next(one for one in found.wire if one.motor == "x" and "queue_step" in one.text)
    size = len(message.payload.split())
    wire_bytes = sum(len(one.payload.split()) for one in found.wire if one.motor == "x")
    rows: list[list[Words]] = [
        ["core/gcode/lexer.hpp", Text("words", "parole"), " ".join(found.commands[0].words)],
        [
            "core/gcode/interpreter.hpp",
            Text("a move in millimetres", "un movimento in millimetri"),
            f"X {move.start_mm[0]:g} → {move.end_mm[0]:g}",
        ],
        [
            "core/plan/planner.hpp",
            Text("speeds", "velocità"),
            f"{move.start_speed:g} → {move.cruise_speed:g} → {move.end_speed:g} mm/s",
        ],
        [
            "core/steps/step_solver.hpp",
            Text("time of the first step", "tempo del primo passo"),
            f"{1000 * (steps.first_s or 0.0):.3f} ms",
        ],
        [
            "core/steps/compressor.hpp",
            Text("interval, count, add", "interval, count, add"),
            f"{interval}, {count}, {add}",
        ],
        ["core/link/link.hpp", Text("bytes", "byte"), message.payload],
        [
            "firmware/core/stepper.c",
            Text("clock of the second step", "istante del secondo passo"),
            f"{ticks[1]}",
        ],
        ["firmware/hal/avr", Text("pulse at the pin", "impulso sul pin"), f"PF0: {steps.count}"],
    ]
    shown = ticks[:_SHOWN_STEPS]
    return Outcome(
        numbers=[
            Number("steps", Text("Steps of X", "Passi di X"), float(steps.count), decimals=0),
            Number(
                "first_ms",
                Text("Time of the first step", "Tempo del primo passo"),
                1000 * ticks[0] / hz,
                "ms",
                decimals=3,
            ),
            Number(
                "interval", Text("First interval", "Primo intervallo"), float(interval), _TICKS, 0
            ),
            Number("count", Text("Its steps", "I suoi passi"), float(count), decimals=0),
            Number("add", Text("Its add", "Il suo add"), float(add), _TICKS, decimals=0),
            Number(
                "second_gap",
                Text("Ticks from the first to the second step", "Tick dal primo al secondo passo"),
                float(ticks[1] - ticks[0]),
                _TICKS,
                decimals=0,
            ),
            Number(
                "commands",
                Text("Commands on the wire", "Comandi sul filo"),
                float(len(commands)),
                decimals=0,
            ),
            Number("size", Text("Bytes of the first", "Byte del primo"), float(size), _BYTES, 0),
            Number(
                "bytes_per_step",
                Text("Bytes for each step", "Byte per ogni passo"),
                wire_bytes / steps.count,
                _BYTES,
            ),
        ],
        graphs=[
            Graph(
                Text("Steps, as the board executes them", "Passi, come li esegue la scheda"),
                Text("time, ms", "tempo, ms"),
                Text("steps", "passi"),
                [
                    Line(
                        "X",
                        *edges(
                            [0.0, *(1000 * tick / hz for tick in shown)],
                            [float(k) for k in range(len(shown) + 1)],
                        ),
                    )
                ],
            )
        ],
        tables=[
            Table(
                Text("The walk", "Il percorso"),
                [Text("stop", "tappa"), Text("what", "che cosa"), Text("value", "valore")],
                rows,
            )
        ],
    )


EXPERIMENT = Experiment(
    "reading-the-source",
    Text("One line on its way to the pin", "Una riga in viaggio verso il pin"),
    Text(
        "Passo prints one `G1` on the simulated board of the machine `i3`, and keeps each value.",
        "Passo stampa un `G1` sulla scheda simulata della macchina `i3`, e conserva ogni valore.",
    ),
    [
        Parameter("length_mm", "X", 10.0, low=1.0, high=60.0, unit="mm"),
        Parameter(
            "speed_mm_s",
            Text("Feedrate", "Velocità richiesta"),
            50.0,
            low=10.0,
            high=200.0,
            step=5.0,
            unit="mm/s",
        ),
    ],
    _compute,
)

LESSON = Lesson(
    name="reading-the-source",
    chapter=Chapter.PRACTICE,
    place=40,
    rows=(30,),
    minutes=40,
    title=Text("From G1 to the pin: reading the source", "Da G1 al pin: leggere il sorgente"),
    goal=Text(
        "You follow one line through the source, and recompute the value at each stop.",
        "Segui una riga attraverso il sorgente, e ricalcoli il valore a ogni tappa.",
    ),
    text=[
        Text(
            "Open the files of the table one after the other. The lexer cuts the line into words."
            " The interpreter makes a move in millimetres of them. The planner finds its speeds.",
            "Apri uno dopo l'altro i file della tabella. Il lexer taglia la riga in parole."
            " L'interprete ne fa un movimento in millimetri. Il pianificatore trova le velocità.",
        ),
        Text(
            "The step solver asks when the axis passes the middle between two steps. For the first"
            " one that is half a step, `0.00625 mm`; with `3000 mm/s²` from rest it takes"
            " `√(2·s/a)`: {first_ms}. In all there are {steps} steps.",
            "Il risolutore chiede quando l'asse passa a metà tra due passi. Per il primo è mezzo"
            " passo, `0.00625 mm`; con `3000 mm/s²` da fermo ci vuole `√(2·s/a)`: {first_ms}. In"
            " tutto i passi sono {steps}.",
        ),
        Text(
            "The compressor puts many steps into one command: the first interval is {interval} of"
            " the board's clock, for {count} steps, and each interval grows by {add}. So only"
            " {commands} commands go over the wire, {bytes_per_step} for each step.",
            "Il compressore mette molti passi in un comando: il primo intervallo è {interval}"
            " dell'orologio della scheda, per {count} passi, e ogni intervallo cresce di {add}."
            " Così sul filo passano solo {commands} comandi, {bytes_per_step} per ogni passo.",
        ),
        Text(
            "The link packs the numbers into bytes, adds a length and a checksum, and sends them at"
            " most `150 ms` early. On the board, `stepper.c` adds interval after interval to its"
            " clock. At each of these times an interrupt sets the pin, and the driver moves its"
            " currents by one microstep.",
            "Il collegamento impacchetta i numeri in byte, aggiunge lunghezza e somma di controllo,"
            " e li manda con al massimo `150 ms` di anticipo. Sulla scheda, `stepper.c` somma un"
            " intervallo dopo l'altro al suo orologio. A ciascuno di questi istanti un interrupt"
            " alza il pin, e il driver sposta le correnti di un micropasso.",
        ),
        Text(
            "You can do the same with any line of any file: `passo explain FILE:LINE`.",
            "Puoi fare lo stesso con ogni riga di ogni file: `passo explain FILE:RIGA`.",
        ),
    ],
    experiment=EXPERIMENT,
    questions=[
        Question(
            Text(
                "The clock of the board has `16 MHz`. The first interval is {interval}. After how"
                " many milliseconds does the first step come?",
                "L'orologio della scheda è a `16 MHz`. Il primo intervallo è {interval}. Dopo"
                " quanti millisecondi arriva il primo passo?",
            ),
            "first_ms",
            given={"length_mm": 20.0, "speed_mm_s": 80.0},
            mistakes=[
                Mistake(
                    lambda v: v["interval"] / 16,
                    Text("These are microseconds.", "Questi sono microsecondi."),
                ),
                Mistake(
                    lambda v: v["interval"] / 2000,
                    Text(
                        "That would be a timer of `2 MHz`, as in older firmwares. Here a tick is"
                        " one clock cycle.",
                        "Così sarebbe un timer a `2 MHz`, come nei vecchi firmware. Qui un tick è"
                        " un ciclo di clock.",
                    ),
                ),
                Mistake(
                    lambda _: 1000 / (80 * 80),
                    Text(
                        "That is the interval at full speed. The first step starts from rest.",
                        "Questo è l'intervallo a piena velocità. Il primo passo parte da fermo.",
                    ),
                ),
            ],
            why=Text(
                "Ticks divided by `16000` per millisecond.",
                "Tick divisi per `16000` al millisecondo.",
            ),
            hint=Text("How many ticks has a millisecond?", "Quanti tick ha un millisecondo?"),
        ),
        Question(
            Text(
                "The first command is interval {interval:n}, count {count}, add {add:n}. How many"
                " ticks lie between the first and the second step?",
                "Il primo comando è interval {interval:n}, count {count}, add {add:n}. Quanti tick"
                " passano tra il primo e il secondo passo?",
            ),
            "second_gap",
            mistakes=[
                Mistake(
                    lambda v: v["interval"],
                    Text(
                        "That is the time before the first step. Each further gap changes by add.",
                        "Questo è il tempo prima del primo passo. Ogni distanza seguente cambia di"
                        " add.",
                    ),
                ),
                Mistake(
                    lambda v: 2 * v["interval"] + v["add"],
                    Text(
                        "That is the clock of the second step. The question is the gap.",
                        "Questo è l'istante del secondo passo. La domanda è la distanza.",
                    ),
                ),
                Mistake(
                    lambda v: v["interval"] - v["add"],
                    Text(
                        "Add has a sign already: the gaps become shorter.",
                        "Add ha già un segno: le distanze si accorciano.",
                    ),
                ),
            ],
            why=Text(
                "Interval plus add. Read `stepper.c`: it needs one addition for each step.",
                "Interval più add. Leggi `stepper.c`: gli basta un'addizione per passo.",
            ),
            hint=Text(
                "The first gap is the interval, the next one is the interval and add.",
                "La prima distanza è interval, la seguente è interval e add.",
            ),
            tolerance=0.001,
        ),
    ],
    source=Source("firmware/core/stepper.c", "command_queue_step"),
    printer=OwnPrinter(
        Text(
            "Take a line of a file of your own, and explain it on your machine. The page does the"
            " same for a line that you type.",
            "Prendi una riga di un tuo file, e fattela spiegare sulla tua macchina. La pagina fa lo"
            " stesso con una riga che scrivi.",
        ),
        command="passo explain FILE:LINE",
        page="learn",
    ),
    links=[
        Link(Text("One line", "Una riga"), document="docs/tutorial/one-line.md"),
        Link(Text("Compression", "Compressione"), document="docs/explanation/compression.md"),
    ],
)
