"""Interrupts and what blocks: a chip that plans and steps, and a board that only steps."""

from __future__ import annotations

from dataclasses import dataclass

from passo.learn.bilingual import Text
from passo.learn.experiment import Choice, Experiment, Number, Outcome, Parameter
from passo.learn.lesson import Chapter, Lesson, Link, Mistake, OwnPrinter, Question, Source
from passo.learn.pictures import Graph, Line

_STEPS_PER_MM = 80.0
_ISR_US = 25.0  # of a step interrupt
_PLAN_MS = 1.5  # to read and plan one line on the chip
_HOST_QUEUE_MS = 850.0  # 150 ms at the board, 700 ms in the link
_STALL_AT_MS = 200.0
_SHOWN_MS = 2000
_EVERY_MS = 20
_SHOWN_STEPS = 12
_BLOCKED_STEP = 3
_STEPS = 400


@dataclass(frozen=True, slots=True)
class _Interrupts:
    """When each step is due, when its interrupt begins and ends, µs."""

    due: list[float]
    begins: list[float]
    ends: list[float]

    @property
    def latest_us(self) -> float:
        return max(begin - due for begin, due in zip(self.begins, self.due, strict=True))

    @property
    def late(self) -> int:
        return sum(begin > due + 1e-6 for begin, due in zip(self.begins, self.due, strict=True))


def _interrupts(interval_us: float, blocked_us: float) -> _Interrupts:
    due = [k * interval_us for k in range(_STEPS)]
    begins: list[float] = []
    ends: list[float] = []
    free = 0.0
    for k, at in enumerate(due):
        begins.append(max(at, free))
        free = begins[-1] + _ISR_US + (blocked_us if k == _BLOCKED_STEP else 0.0)
        ends.append(free)
    return _Interrupts(due, begins, ends)


def _queued(full_ms: float, stall_ms: float, refill: float) -> tuple[list[float], list[float]]:
    """Time, and how much motion is queued, ms, around a pause of the sender. After it the queue
    grows by `refill` ms in each ms."""
    times = [float(t) for t in range(0, _SHOWN_MS + 1, _EVERY_MS)]
    held: list[float] = []
    level = full_ms
    for t in times:
        held.append(level)
        stalled = _STALL_AT_MS <= t < _STALL_AT_MS + stall_ms
        level += -_EVERY_MS if stalled else refill * _EVERY_MS
        level = min(full_ms, max(0.0, level))
    return times, held


def _compute(
    speed_mm_s: float, segment_mm: float, queue_moves: float, stall_ms: float, blocked_us: float
) -> Outcome:
    interval_us = 1e6 / (speed_mm_s * _STEPS_PER_MM)
    move_ms = 1000 * segment_mm / speed_mm_s
    queue_ms = queue_moves * move_ms
    steps_percent = 100 * _ISR_US / interval_us
    plan_percent = 100 * _PLAN_MS / move_ms
    found = _interrupts(interval_us, blocked_us)
    left = max(0.0, 100 - steps_percent)  # for the planning of the chip
    refill = left / plan_percent - 1
    own, host = _queued(queue_ms, stall_ms, refill), _queued(_HOST_QUEUE_MS, stall_ms, 1.0)
    return Outcome(
        numbers=[
            Number("interval_us", Text("Time of a step", "Tempo di un passo"), interval_us, "µs"),
            Number(
                "steps_percent",
                Text("Step interrupts use", "Gli interrupt dei passi usano"),
                steps_percent,
                "%",
                decimals=1,
            ),
            Number(
                "plan_percent",
                Text("Planning on the chip uses", "La pianificazione sul chip usa"),
                plan_percent,
                "%",
                decimals=1,
            ),
            Number("move_ms", Text("Time of a move", "Tempo di un movimento"), move_ms, "ms"),
            Number(
                "queue_ms",
                Text("Motion in the queue of the chip", "Moto nella coda del chip"),
                queue_ms,
                "ms",
                decimals=1,
            ),
            Number(
                "stands_ms",
                Text("The chip stands still for", "Il chip resta fermo per"),
                max(0.0, stall_ms - queue_ms),
                "ms",
                decimals=1,
            ),
            Number(
                "passo_stands_ms",
                Text("Passo stands still for", "Passo resta fermo per"),
                max(0.0, stall_ms - _HOST_QUEUE_MS),
                "ms",
                decimals=1,
            ),
            Number(
                "late_steps", Text("Late steps", "Passi in ritardo"), float(found.late), decimals=0
            ),
            Number(
                "latest_us",
                Text("Longest delay of a step", "Ritardo massimo di un passo"),
                found.latest_us,
                "µs",
                decimals=0,
            ),
        ],
        graphs=[
            Graph(
                Text(
                    "Queued motion while the sender stalls", "Moto in coda se il mittente si ferma"
                ),
                Text("time, ms", "tempo, ms"),
                "ms",
                [
                    Line(Text("chip that plans", "chip che pianifica"), *own, 1),
                    Line(Text("Passo and its board", "Passo e la sua scheda"), *host),
                ],
            ),
            _timeline(found),
        ],
    )


def _timeline(found: _Interrupts) -> Graph:
    """Who has the processor: the interrupt above, the main loop below."""
    x: list[float] = [0.0]
    y: list[float] = [0.0]
    for begin, end in zip(found.begins[:_SHOWN_STEPS], found.ends[:_SHOWN_STEPS], strict=True):
        x += [begin, begin, end, end]
        y += [0.0, 1.0, 1.0, 0.0]
    due_x: list[float] = []
    due_y: list[float] = []
    for at in found.due[:_SHOWN_STEPS]:
        due_x += [at, at, at]
        due_y += [-0.5, -0.1, -0.5]
    return Graph(
        Text("Who has the processor", "Chi ha il processore"),
        Text("time, µs", "tempo, µs"),
        Text("1: interrupt, 0: main loop", "1: interrupt, 0: ciclo principale"),
        [
            Line(Text("interrupt", "interrupt"), x, y),
            Line(Text("step is due", "il passo è dovuto"), due_x, due_y, 1),
        ],
        values=(-0.5, 1.0),
    )


EXPERIMENT = Experiment(
    "interrupts-and-queue",
    Text("The clock of a board", "L'orologio di una scheda"),
    Text(
        "One motor with 80 steps/mm. A step interrupt takes 25 µs; to read and plan a line on the"
        " chip takes 1.5 ms.",
        "Un motore con 80 passi/mm. Un interrupt di passo dura 25 µs; leggere e pianificare una"
        " riga sul chip dura 1,5 ms.",
    ),
    [
        Parameter(
            "speed_mm_s", Text("Speed", "Velocità"), 100.0, 10.0, 400.0, step=10.0, unit="mm/s"
        ),
        Parameter(
            "segment_mm",
            Text("Length of a move", "Lunghezza di un movimento"),
            0.5,
            low=0.1,
            high=5.0,
            step=0.1,
            unit="mm",
        ),
        Parameter(
            "queue_moves",
            Text("Moves in the queue of the chip", "Movimenti nella coda del chip"),
            16.0,
            choices=[Choice(1.0), Choice(16.0), Choice(64.0)],
        ),
        Parameter(
            "stall_ms",
            Text("The sender stalls for", "Il mittente si ferma per"),
            300.0,
            low=0.0,
            high=1500.0,
            step=20.0,
            unit="ms",
        ),
        Parameter(
            "blocked_us",
            Text("One interrupt also does something else for", "Un interrupt fa anche altro per"),
            0.0,
            low=0.0,
            high=5000.0,
            step=50.0,
            unit="µs",
        ),
    ],
    _compute,
)

LESSON = Lesson(
    name="interrupts-and-queue",
    chapter=Chapter.ELECTRICITY,
    place=90,
    rows=(27,),
    minutes=30,
    title=Text("Interrupts, and what blocks", "Interrupt, e ciò che blocca"),
    goal=Text(
        "You compute how long a queue lasts, and what a slow interrupt does to steps.",
        "Calcoli quanto dura una coda, e che cosa fa ai passi un interrupt lento.",
    ),
    text=[
        Text(
            "A chip does one thing at a time. Its main loop reads lines and plans. A timer"
            " interrupts it for each step: at {speed_mm_s} every {interval_us}, which takes"
            " {steps_percent} of the time. While an interrupt runs, all others wait.",
            "Un chip fa una cosa alla volta. Il suo ciclo principale legge righe e pianifica. Un"
            " timer lo interrompe per ogni passo: a {speed_mm_s} ogni {interval_us}, cioè"
            " {steps_percent} del tempo. Mentre gira un interrupt, tutti gli altri aspettano.",
        ),
        Text(
            "So an interrupt must be short. An older teaching firmware printed text in its step"
            " interrupt. If one takes {blocked.blocked_us} longer, {blocked.late_steps} steps are"
            " late, the first by {blocked.latest_us}. After that they follow one another without a"
            " pause: the motor jerks, and may lose them.",
            "Quindi un interrupt deve essere breve. Un vecchio firmware didattico stampava testo"
            " nell'interrupt dei passi. Se uno dura {blocked.blocked_us} in più,"
            " {blocked.late_steps} passi sono in ritardo, il primo di {blocked.latest_us}. Poi si"
            " susseguono senza pausa: il motore sobbalza, e può perderli.",
        ),
        Text(
            "A chip that plans itself keeps a few moves in a queue, here {queue_moves}. Each of"
            " {segment_mm} lasts {move_ms}: together {queue_ms}. If the sender stalls for"
            " {stall_ms}, the machine stands still for {stands_ms} in the middle of the print.",
            "Un chip che pianifica da solo tiene pochi movimenti in coda, qui {queue_moves}."
            " Ognuno di {segment_mm} dura {move_ms}: insieme {queue_ms}. Se il mittente si ferma"
            " per {stall_ms}, la macchina resta ferma per {stands_ms} a metà stampa.",
        ),
        Text(
            "Planning needs the rest of the time. With moves of {short.segment_mm} at"
            " {short.speed_mm_s} it would take {short.plan_percent}, and the steps"
            " {short.steps_percent}: more than all of it. The queue runs empty by itself.",
            "La pianificazione usa il resto del tempo. Con movimenti di {short.segment_mm} a"
            " {short.speed_mm_s} userebbe il {short.plan_percent:n} per cento, e i passi il"
            " {short.steps_percent:n}: più di tutto. La coda si svuota da sola.",
        ),
        Text(
            "Passo divides the work as Klipper does. The computer plans and computes the clock of"
            " each step. The board receives finished lists, and its interrupt only takes the next"
            " time. Up to a second of motion is under way, so the same stall stops it for"
            " {passo_stands_ms}.",
            "Passo divide il lavoro come Klipper. Il computer pianifica e calcola l'istante di ogni"
            " passo. La scheda riceve elenchi pronti, e il suo interrupt prende solo il tempo"
            " seguente. È in viaggio quasi un secondo di moto, quindi la stessa pausa lo ferma per"
            " {passo_stands_ms}.",
        ),
    ],
    experiment=EXPERIMENT,
    cases={
        "blocked": {"blocked_us": 1750.0},
        "short": {"segment_mm": 0.2, "speed_mm_s": 200.0},
    },
    questions=[
        Question(
            Text(
                "A curve has moves of {segment_mm}, driven at {speed_mm_s}. How long do"
                " {queue_moves} moves in the queue last?",
                "Una curva ha movimenti di {segment_mm}, percorsi a {speed_mm_s}. Quanto durano"
                " {queue_moves} movimenti in coda?",
            ),
            "queue_ms",
            given={"segment_mm": 0.2, "speed_mm_s": 80.0},
            mistakes=[
                Mistake(
                    lambda v: v["move_ms"],
                    Text(
                        "That is one move. The queue has {queue_moves}.",
                        "Questo è un movimento. La coda ne ha {queue_moves}.",
                    ),
                ),
                Mistake(
                    lambda v: v["queue_ms"] / 1000,
                    Text("These are seconds.", "Questi sono secondi."),
                ),
                Mistake(
                    lambda v: v["queue_moves"] * v["speed_mm_s"] / v["segment_mm"],
                    Text(
                        "Time is distance divided by speed, not the other way round.",
                        "Il tempo è distanza divisa per velocità, non il contrario.",
                    ),
                ),
            ],
            why=Text(
                "`16 · length / speed`. A pause of the sender that is longer stops the machine.",
                "`16 · lunghezza / velocità`. Una pausa più lunga del mittente ferma la macchina.",
            ),
            hint=Text("How long does one move last?", "Quanto dura un movimento?"),
        ),
        Question(
            Text(
                "A step interrupt takes `25 µs`, the scale is `80` steps per millimetre. How much"
                " of the time do the interrupts use at {speed_mm_s}?",
                "Un interrupt di passo dura `25 µs`, la scala è `80` passi al millimetro. Quanta"
                " parte del tempo usano gli interrupt a {speed_mm_s}?",
            ),
            "steps_percent",
            given={"speed_mm_s": 150.0},
            mistakes=[
                Mistake(
                    lambda v: v["interval_us"] / 25,
                    Text(
                        "That is how often the interrupt fits. The question is the other way round,"
                        " in percent.",
                        "Questo è quante volte ci sta l'interrupt. La domanda è il contrario, in"
                        " percento.",
                    ),
                ),
                Mistake(
                    lambda v: v["speed_mm_s"] * 25 / 1e4,
                    Text(
                        "You counted millimetres. Each has `80` steps.",
                        "Hai contato i millimetri. Ognuno ha `80` passi.",
                    ),
                ),
            ],
            why=Text(
                "A step every {interval_us}. Three motors at once would use three times as much.",
                "Un passo ogni {interval_us}. Tre motori insieme ne userebbero il triplo.",
            ),
            hint=Text(
                "How many steps are there in a second, and how long do all their interrupts take?",
                "Quanti passi ci sono in un secondo, e quanto durano tutti i loro interrupt?",
            ),
        ),
        Question(
            Text(
                "The sender stalls for {stall_ms}. {queue_moves} moves of {segment_mm} at"
                " {speed_mm_s} are queued on the chip. How long does the machine stand still?",
                "Il mittente si ferma per {stall_ms}. Sul chip sono in coda {queue_moves} movimenti"
                " di {segment_mm} a {speed_mm_s}. Per quanto resta ferma la macchina?",
            ),
            "stands_ms",
            given={"segment_mm": 1.0, "speed_mm_s": 80.0, "stall_ms": 500.0},
            mistakes=[
                Mistake(
                    lambda v: v["stall_ms"],
                    Text(
                        "It moves on until the queue is empty.",
                        "Continua finché la coda non è vuota.",
                    ),
                ),
                Mistake(
                    lambda v: v["queue_ms"],
                    Text(
                        "So long it still moves. What remains of the pause?",
                        "Per tanto si muove ancora. Che cosa resta della pausa?",
                    ),
                ),
                Mistake(
                    lambda v: v["stall_ms"] - v["move_ms"],
                    Text(
                        "You used only one of the {queue_moves} moves.",
                        "Hai usato solo uno dei {queue_moves} movimenti.",
                    ),
                ),
            ],
            why=Text(
                "The queue lasts {queue_ms}. A nozzle that stands leaves a blob.",
                "La coda dura {queue_ms}. Un ugello fermo lascia un grumo.",
            ),
            hint=Text(
                "First the time of the queue; subtract it from the pause.",
                "Prima il tempo della coda; toglilo dalla pausa.",
            ),
        ),
    ],
    source=Source("firmware/core/scheduler.c", "timers_run"),
    printer=OwnPrinter(
        Text(
            "M122 reports late commands. Load your computer during a simulated print, and see"
            " whether any command is late.",
            "M122 riporta i comandi in ritardo. Carica il computer durante una stampa simulata, e"
            " guarda se qualche comando è in ritardo.",
        ),
        command="M122",
    ),
    links=[
        Link(Text("Time", "Tempo"), document="docs/explanation/time.md"),
        Link(Text("Compression", "Compressione"), document="docs/explanation/compression.md"),
    ],
)
