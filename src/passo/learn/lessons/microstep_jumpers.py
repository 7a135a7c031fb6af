"""The jumpers MS1 to MS3 of driver modules, and what the firmware does not know of them."""

from __future__ import annotations

from math import pi, sin

from passo.learn.bilingual import Text, Words, figure
from passo.learn.experiment import Choice, Experiment, Number, Outcome, Parameter
from passo.learn.lesson import Chapter, Lesson, Link, Mistake, OwnPrinter, Question, Source
from passo.learn.pictures import Graph, Line, Table

_TRAVEL_MM = 40.0
_FULL_STEPS = 200
# By MS1, MS2, MS3: the data sheets. The TMC modules have no MS3.
_A4988 = {"000": 1, "100": 2, "010": 4, "110": 8, "111": 16}
_DRV8825 = {"000": 1, "100": 2, "010": 4, "110": 8, "001": 16, "101": 32, "011": 32, "111": 32}
_TMC2208 = {"00": 8, "10": 2, "01": 4, "11": 16}
_TMC2209 = {"00": 8, "10": 32, "01": 64, "11": 16}
_TABLES = {"A4988": _A4988, "DRV8825": _DRV8825, "TMC2208": _TMC2208, "TMC2209": _TMC2209}
_PINS = ("MS1", "MS2", "MS3")
_COUNTS = (1, 2, 4, 8, 16, 32, 64, 128, 256)


def _compute(
    driver: str, ms1: float, ms2: float, ms3: float, configured: float, asked_mm: float
) -> Outcome:
    table = _TABLES[driver]
    pins = len(next(iter(table)))
    code = f"{ms1:.0f}{ms2:.0f}{ms3:.0f}"[:pins]
    real = table.get(code, 0)
    pulses = asked_mm * _FULL_STEPS * configured / _TRAVEL_MM
    moved_mm = pulses * _TRAVEL_MM / (_FULL_STEPS * real) if real else 0.0
    undefined = "" if real else Text("not in the data sheet", "non nel foglio dati")
    return Outcome(
        numbers=[
            Number(
                "real",
                Text("Microsteps that the driver makes", "Micropassi che fa il driver"),
                float(real),
                decimals=0,
                words=undefined,
            ),
            Number(
                "pulses", Text("Pulses of the board", "Impulsi della scheda"), pulses, decimals=0
            ),
            Number(
                "moved_mm",
                Text("Real movement", "Movimento reale"),
                moved_mm,
                "mm",
                words=undefined,
            ),
            Number(
                "step_um",
                Text("One microstep at the belt", "Un micropasso alla cinghia"),
                1000 * _TRAVEL_MM / (_FULL_STEPS * real) if real else 0.0,
                "µm",
                words=undefined,
            ),
            Number(
                "torque_percent",
                Text("Torque of one microstep", "Coppia di un micropasso"),
                100 * sin(pi / 2 / real) if real else 0.0,
                "%",
                decimals=1,
                words=undefined,
            ),
        ],
        graphs=[
            Graph(
                Text("Torque after one microstep", "Coppia dopo un micropasso"),
                Text("microsteps of a full step", "micropassi di un passo intero"),
                Text("% of the holding torque", "% della coppia di tenuta"),
                [
                    Line(
                        Text("one microstep", "un micropasso"),
                        [float(each) for each in _COUNTS],
                        [100 * sin(pi / 2 / each) for each in _COUNTS],
                    )
                ],
            )
        ],
        tables=[_table(driver, table, pins)],
    )


def _table(driver: str, table: dict[str, int], pins: int) -> Table:
    rows: list[list[Words]] = [
        [*code, figure(microsteps, 0)]
        for code, microsteps in sorted(table.items(), key=lambda row: (row[1], row[0]))
    ]
    return Table(
        Text(f"Jumpers, {driver} (1: inserted)", f"Jumper, {driver} (1: inserito)"),
        [*_PINS[:pins], Text("microsteps", "micropassi")],
        rows,
    )


def _jumper(name: str) -> Parameter:
    return Parameter(
        name.lower(),
        name,
        1.0,
        choices=[
            Choice(0.0, Text("open", "aperto")),
            Choice(1.0, Text("inserted", "inserito")),
        ],
    )


EXPERIMENT = Experiment(
    "microstep-jumpers",
    Text("Jumpers under a driver", "Jumper sotto un driver"),
    Text(
        "The driver reads its jumpers, the firmware reads its file: do they agree?",
        "Il driver legge i jumper, il firmware legge il suo file: sono d'accordo?",
    ),
    [
        Parameter(
            "driver", Text("Driver", "Driver"), "A4988", choices=[Choice(each) for each in _TABLES]
        ),
        *map(_jumper, _PINS),
        Parameter(
            "configured",
            Text("Microsteps in the machine file", "Micropassi nel file macchina"),
            16.0,
            choices=[Choice(float(each)) for each in _COUNTS[:7]],
        ),
        Parameter(
            "asked_mm",
            Text("Requested movement", "Movimento richiesto"),
            10.0,
            low=1.0,
            high=100.0,
            unit="mm",
        ),
    ],
    _compute,
)

_NO_JUMPERS: dict[str, float | str] = {"ms1": 0.0, "ms2": 0.0, "ms3": 0.0}

LESSON = Lesson(
    name="microstep-jumpers",
    chapter=Chapter.ELECTRICITY,
    place=20,
    rows=(8,),
    minutes=20,
    title=Text("Jumpers for microsteps", "I jumper dei micropassi"),
    goal=Text(
        "You read the jumper table of a driver, and predict how far an axis moves if it does not"
        " agree with the machine file.",
        "Leggi la tabella dei jumper di un driver, e prevedi quanto si muove un asse se non"
        " concorda con il file macchina.",
    ),
    text=[
        Text(
            "Under a driver module there are up to three jumpers: MS1, MS2 and MS3. They set how"
            " many microsteps the driver makes of a full step. The board cannot read them. It"
            " believes its file.",
            "Sotto un modulo driver ci sono fino a tre jumper: MS1, MS2 e MS3. Stabiliscono quanti"
            " micropassi fa il driver per ogni passo intero. La scheda non può leggerli. Si fida"
            " del suo file.",
        ),
        Text(
            "An A4988 with all three makes {real}. For {asked_mm} the board sends {pulses} pulses,"
            " and the axis moves {moved_mm}. Put a DRV8825 into the same place: it makes {drv.real}"
            " with the same jumpers, and the same pulses move only {drv.moved_mm}.",
            "Un A4988 con tutti e tre ne fa {real}. Per {asked_mm} la scheda manda {pulses}"
            " impulsi, e l'asse si muove di {moved_mm}. Metti un DRV8825 allo stesso posto: con gli"
            " stessi jumper ne fa {drv.real}, e gli stessi impulsi muovono solo di {drv.moved_mm}.",
        ),
        Text(
            "A TMC2208 or TMC2209 on its own has two such pins, with other tables. Without jumpers"
            " it makes {tmc.real}. If its registers are connected to the board (UART), the board"
            " sets the microsteps itself, and on a TMC2209 the two pins become its address.",
            "Un TMC2208 o TMC2209 da solo ha due pin di questo tipo, con altre tabelle. Senza"
            " jumper ne fa {tmc.real}. Se i suoi registri sono collegati alla scheda (UART), è la"
            " scheda a stabilire i micropassi, e su un TMC2209 i due pin diventano l'indirizzo.",
        ),
        Text(
            "More microsteps are smoother and quieter, but not more exact in the same measure. One"
            " microstep adds only a small part of the torque: `sin(90° / microsteps)`, with {real}"
            " it is {torque_percent}. If friction is larger, the rotor waits until several"
            " microsteps have added up.",
            "Più micropassi rendono il moto più dolce e silenzioso, ma non altrettanto più esatto."
            " Un micropasso aggiunge solo una piccola parte della coppia: `sin(90° / micropassi)`,"
            " con {real} è {torque_percent}. Se l'attrito è maggiore, il rotore aspetta che più"
            " micropassi si sommino.",
        ),
    ],
    experiment=EXPERIMENT,
    cases={"drv": {"driver": "DRV8825"}, "tmc": {"driver": "TMC2209"} | _NO_JUMPERS},
    questions=[
        Question(
            Text(
                "You replace an A4988 by a {driver} without jumpers. The file still says"
                " {configured} microsteps. How far does the axis move for {asked_mm}?",
                "Sostituisci un A4988 con un {driver} senza jumper. Il file dice ancora"
                " {configured} micropassi. Di quanto si muove l'asse per {asked_mm}?",
            ),
            "moved_mm",
            given={"driver": "TMC2209", "asked_mm": 30.0} | _NO_JUMPERS,
            mistakes=[
                Mistake(
                    lambda v: v["asked_mm"] * v["real"] / v["configured"],
                    Text(
                        "The other way round: with fewer microsteps each pulse moves further.",
                        "Al contrario: con meno micropassi ogni impulso muove di più.",
                    ),
                ),
                Mistake(
                    lambda v: v["asked_mm"],
                    Text(
                        "Without jumpers this driver makes {real}, not {configured}.",
                        "Senza jumper questo driver ne fa {real}, non {configured}.",
                    ),
                ),
                Mistake(
                    lambda v: v["asked_mm"] * v["configured"],
                    Text(
                        "An A4988 without jumpers makes full steps. This one makes {real}.",
                        "Un A4988 senza jumper fa passi interi. Questo ne fa {real}.",
                    ),
                ),
            ],
            why=Text(
                "The board sends {pulses} pulses, enough for {configured} microsteps. Each is a"
                " larger part of a full step here.",
                "La scheda manda {pulses} impulsi, giusti per {configured} micropassi. Qui ognuno è"
                " una parte più grande del passo intero.",
            ),
            hint=Text(
                "Look up the microsteps in the table of this driver, then compare with the file.",
                "Cerca i micropassi nella tabella di questo driver, poi confronta con il file.",
            ),
        ),
        Question(
            Text(
                "How many percent of the holding torque does one microstep make, if the driver"
                " makes {real} of a full step?",
                "Quale percentuale della coppia di tenuta dà un micropasso, se il driver ne fa"
                " {real} per passo intero?",
            ),
            "torque_percent",
            given={"ms3": 0.0},
            mistakes=[
                Mistake(
                    lambda v: 100 / v["real"],
                    Text(
                        "The torque is not in proportion to the angle. It is the sine of a part of"
                        " `90°`, which is steeper at its beginning.",
                        "La coppia non è proporzionale all'angolo. È il seno di una parte di `90°`,"
                        " che all'inizio è più ripido.",
                    ),
                ),
                Mistake(
                    lambda _: 100.0,
                    Text(
                        "So much takes a full step of load angle.",
                        "Per tanto serve un angolo di carico di un passo intero.",
                    ),
                ),
            ],
            why=Text(
                "`sin(90° / microsteps)`: the load angle that one pulse makes while the rotor still"
                " rests.",
                "`sin(90° / micropassi)`: l'angolo di carico che fa un impulso mentre il rotore è"
                " ancora fermo.",
            ),
            hint=Text(
                "A full step of load angle is `90°`, and the torque is its sine.",
                "Un passo intero di angolo di carico è `90°`, e la coppia è il suo seno.",
            ),
            tolerance=0.02,
        ),
    ],
    source=Source("src/passo/board/trinamic/settings.py", "DriverSettings.values"),
    printer=OwnPrinter(
        Text(
            "M350 reports the microsteps of drivers with registers. With jumpers, let an axis move"
            " by a known distance and measure: half or double is a wrong jumper.",
            "M350 riporta i micropassi dei driver con registri. Con i jumper, muovi un asse di una"
            " distanza nota e misura: metà o doppio è un jumper sbagliato.",
        ),
        command="M350",
        page="calibrate/steps",
    ),
    links=[Link(Text("Drivers", "Driver"), document="docs/how-to/set-up-drivers.md")],
)
