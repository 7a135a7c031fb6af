"""What a printer counts, and when it needs service."""

from __future__ import annotations

from passo.learn.bilingual import Text, Words
from passo.learn.experiment import Experiment, Number, Outcome, Parameter
from passo.learn.lesson import Chapter, Lesson, Link, Mistake, OwnPrinter, Question, Source
from passo.learn.pictures import Graph, Line, Table

_WEEKS = 52
_WEEK_H = 168.0
_SERVICE: tuple[tuple[Text, float], ...] = (
    (Text("clean the nozzle and the gear", "pulisci ugello e ingranaggio"), 100.0),
    (Text("grease the lead screw", "ingrassa la vite"), 300.0),
    (Text("check belts, screws and cables", "controlla cinghie, viti e cavi"), 500.0),
)


def _compute(
    prints_per_week: float,
    print_h: float,
    failed_percent: float,
    filament_m: float,
    speed_mm_s: float,
    service_h: float,
) -> Outcome:
    week_h = prints_per_week * print_h
    year_h = _WEEKS * week_h
    prints = _WEEKS * prints_per_week
    weeks = [float(k) for k in range(_WEEKS + 1)]
    rows: list[list[Words]] = [
        [name, f"{hours:.0f}", f"{hours / week_h:.1f}"] for name, hours in _SERVICE
    ]
    return Outcome(
        numbers=[
            Number("prints", Text("Prints in a year", "Stampe in un anno"), prints, decimals=0),
            Number(
                "failed",
                Text("Failed ones", "Fallite"),
                prints * failed_percent / 100,
                decimals=0,
            ),
            Number("year_h", Text("Print time", "Tempo di stampa"), year_h, "h", decimals=0),
            Number("on_h", Text("Power-on time", "Tempo di accensione"), _WEEKS * _WEEK_H, "h", 0),
            Number(
                "use_percent",
                Text("Use of the printer", "Uso della stampante"),
                100 * week_h / _WEEK_H,
                "%",
                decimals=1,
            ),
            Number(
                "filament_km",
                Text("Filament", "Filamento"),
                prints * filament_m / 1000,
                "km",
            ),
            Number(
                "belt_km",
                Text("Way of the carriage", "Strada del carrello"),
                year_h * 3600 * speed_mm_s / 1e6,
                "km",
                decimals=0,
            ),
            Number(
                "service_weeks",
                Text("Weeks until the service", "Settimane fino alla manutenzione"),
                service_h / week_h,
                Text("weeks", "settimane"),
                decimals=1,
            ),
        ],
        graphs=[
            Graph(
                Text("Hours over a year", "Ore in un anno"),
                Text("weeks", "settimane"),
                "h",
                [
                    Line(Text("print time", "tempo di stampa"), weeks, [k * week_h for k in weeks]),
                    Line(
                        Text("service is due", "manutenzione dovuta"),
                        [0.0, float(_WEEKS)],
                        [service_h, service_h],
                        colour=4,
                        dashed=True,
                    ),
                ],
            )
        ],
        tables=[
            Table(
                Text("Service by print time", "Manutenzione per tempo di stampa"),
                [Text("work", "lavoro"), "h", Text("weeks", "settimane")],
                rows,
            )
        ],
    )


EXPERIMENT = Experiment(
    "counters-and-service",
    Text("A year of a printer", "Un anno di una stampante"),
    Text(
        "What the counters show after a year, if the printer stays switched on.",
        "Che cosa mostrano i contatori dopo un anno, se la stampante resta accesa.",
    ),
    [
        Parameter("prints_per_week", Text("Prints a week", "Stampe a settimana"), 6.0, 1.0, 28.0),
        Parameter(
            "print_h", Text("Time of a print", "Durata di una stampa"), 4.0, 0.5, 6.0, 0.5, "h"
        ),
        Parameter(
            "failed_percent", Text("Failed prints", "Stampe fallite"), 5.0, 0.0, 50.0, unit="%"
        ),
        Parameter(
            "filament_m",
            Text("Filament of a print", "Filamento per stampa"),
            12.0,
            1.0,
            100.0,
            unit="m",
        ),
        Parameter(
            "speed_mm_s", Text("Mean speed", "Velocità media"), 50.0, 10.0, 200.0, 5.0, "mm/s"
        ),
        Parameter(
            "service_h",
            Text("Print time between services", "Tempo di stampa tra manutenzioni"),
            300.0,
            50.0,
            1000.0,
            10.0,
            "h",
        ),
    ],
    _compute,
)

LESSON = Lesson(
    name="counters-and-service",
    chapter=Chapter.PRACTICE,
    place=30,
    rows=(31,),
    minutes=15,
    title=Text("Counters and service", "Contatori e manutenzione"),
    goal=Text(
        "You plan service from the counters of a printer instead of from a calendar.",
        "Pianifichi la manutenzione dai contatori di una stampante invece che dal calendario.",
    ),
    text=[
        Text(
            "A printer wears by printing, not by age. So it counts: prints, finished and failed"
            " ones, print time, power-on time, filament. M78 shows them.",
            "Una stampante si consuma stampando, non invecchiando. Perciò conta: stampe, riuscite e"
            " fallite, tempo di stampa, tempo di accensione, filamento. M78 li mostra.",
        ),
        Text(
            "With {prints_per_week:n} prints a week of {print_h} it prints for {year_h} in a year."
            " If it stays on, its power-on time is {on_h}: the printer works for {use_percent} of"
            " that. Fans and power supply age with the second number, belts and nozzle with the"
            " first.",
            "Con {prints_per_week:n} stampe a settimana da {print_h} stampa per {year_h} l'anno. Se"
            " resta accesa, il tempo di accensione è {on_h}: la stampante lavora per il"
            " {use_percent} di questo. Ventole e alimentatore invecchiano con il secondo numero,"
            " cinghie e ugello con il primo.",
        ),
        Text(
            "The carriage moves further than one expects: at {speed_mm_s} on average that is"
            " {belt_km} in a year. The filament is {filament_km}. A nozzle of brass wears with it,"
            " and much faster with filled filament.",
            "Il carrello fa più strada di quanto si pensi: a {speed_mm_s} in media sono {belt_km}"
            " in un anno. Il filamento è {filament_km}. Un ugello di ottone si consuma con esso, e"
            " molto più in fretta con filamento caricato.",
        ),
        Text(
            "A service each {service_h} of print time is due after {service_weeks}. For a printer"
            " that works twice as much, {busy.service_weeks}. A growing part of failed prints says"
            " that service is due earlier.",
            "Una manutenzione ogni {service_h} di stampa è dovuta dopo {service_weeks}. Per una"
            " stampante che lavora il doppio, {busy.service_weeks}. Se le stampe fallite aumentano,"
            " la manutenzione serve prima.",
        ),
    ],
    experiment=EXPERIMENT,
    cases={"busy": {"prints_per_week": 12.0}},
    questions=[
        Question(
            Text(
                "{prints_per_week:n} prints a week of {print_h} each; service is due each"
                " {service_h} of print time. After how many weeks?",
                "{prints_per_week:n} stampe a settimana da {print_h}; la manutenzione è dovuta ogni"
                " {service_h} di stampa. Dopo quante settimane?",
            ),
            "service_weeks",
            given={"prints_per_week": 10.0, "print_h": 2.5, "service_h": 400.0},
            mistakes=[
                Mistake(
                    lambda v: v["service_h"] / 168,
                    Text(
                        "A week has so many hours, but the printer works only in some of them.",
                        "Una settimana ha tante ore, ma la stampante lavora solo in alcune.",
                    ),
                ),
                Mistake(
                    lambda v: v["service_h"] / v["print_h"],
                    Text(
                        "That is the number of prints. How many are there in a week?",
                        "Questo è il numero di stampe. Quante sono in una settimana?",
                    ),
                ),
            ],
            why=Text(
                "Each week adds the print time of its prints, {year_h} in a year.",
                "Ogni settimana aggiunge il tempo delle sue stampe, {year_h} in un anno.",
            ),
            hint=Text(
                "How many hours does it print in a week?",
                "Quante ore stampa in una settimana?",
            ),
        ),
        Question(
            Text(
                "The printer prints for {year_h} in a year with a mean speed of {speed_mm_s}. How"
                " many kilometres does the carriage move?",
                "La stampante stampa per {year_h} l'anno con una velocità media di {speed_mm_s}."
                " Quanti chilometri fa il carrello?",
            ),
            "belt_km",
            given={"print_h": 3.0, "speed_mm_s": 60.0},
            mistakes=[
                Mistake(
                    lambda v: v["year_h"] * v["speed_mm_s"] / 1e6,
                    Text(
                        "The speed is for each second. An hour has `3600` of them.",
                        "La velocità è al secondo. Un'ora ne ha `3600`.",
                    ),
                ),
                Mistake(
                    lambda v: v["belt_km"] * 1000,
                    Text("These are metres.", "Questi sono metri."),
                ),
                Mistake(
                    lambda v: v["on_h"] * 3600 * v["speed_mm_s"] / 1e6,
                    Text(
                        "You used the power-on time. It moves only while it prints.",
                        "Hai usato il tempo di accensione. Si muove solo mentre stampa.",
                    ),
                ),
            ],
            why=Text(
                "Hours times `3600` times mm/s, divided by a million.",
                "Ore per `3600` per mm/s, diviso un milione.",
            ),
            hint=Text("First the millimetres of one hour.", "Prima i millimetri di un'ora."),
        ),
    ],
    source=Source("src/passo/job/live/statistics.py", "Statistics"),
    printer=OwnPrinter(
        Text(
            "M78 prints the counters of your printer. Note them at each service; M78 S78 clears"
            " them.",
            "M78 stampa i contatori della tua stampante. Annotali a ogni manutenzione; M78 S78 li"
            " azzera.",
        ),
        command="M78",
    ),
    links=[Link(Text("Use the page", "Usa la pagina"), document="docs/how-to/use-the-page.md")],
)
