"""The parts of a hotend: hot below, cold above, and what happens if the cold part is not cold."""

from __future__ import annotations

from math import pi

from passo.learn.bilingual import Text
from passo.learn.experiment import Choice, Experiment, Number, Outcome, Parameter
from passo.learn.lesson import Chapter, Lesson, Mistake, OwnPrinter, Question, Source
from passo.learn.pictures import Graph, Line

_ROOM_C = 25.0
_NECK_MM = 2.5  # of the thin part of the heat break
_OUTSIDE_MM, _BORE_MM = 3.0, 2.0
_SINK_K_W = 5.0  # resistance of the heat sink to air at full fan
_STILL_K_W = 25.0  # and without a fan
_STEEL, _TITANIUM, _BRASS = 16.0, 7.0, 110.0  # conductivity, W/(m·K)


def _compute(nozzle_c: float, fan_percent: float, conductivity: float) -> Outcome:
    area_m2 = pi / 4 * (_OUTSIDE_MM**2 - _BORE_MM**2) * 1e-6
    break_k_w = _NECK_MM / 1000 / (conductivity * area_m2)
    # The conductances of still air and of the fan add up.
    air = 1 / _STILL_K_W + (1 / _SINK_K_W - 1 / _STILL_K_W) * fan_percent / 100
    sink_k_w = 1 / air
    watts = (nozzle_c - _ROOM_C) / (break_k_w + sink_k_w)
    cold_c = _ROOM_C + watts * sink_k_w
    soft = 60.0
    fans = [float(percent) for percent in range(0, 101, 5)]
    colds: list[float] = []
    for percent in fans:
        sink = 1 / (1 / _STILL_K_W + (1 / _SINK_K_W - 1 / _STILL_K_W) * percent / 100)
        colds.append(_ROOM_C + (nozzle_c - _ROOM_C) * sink / (break_k_w + sink))
    return Outcome(
        numbers=[
            Number(
                "break_k_w",
                Text("Thermal resistance of the neck", "Resistenza termica del collo"),
                break_k_w,
                "K/W",
                1,
            ),
            Number(
                "sink_k_w",
                Text("Thermal resistance to the air", "Resistenza termica verso l'aria"),
                sink_k_w,
                "K/W",
                1,
            ),
            Number("watts", Text("Heat that climbs up", "Calore che sale"), watts, "W"),
            Number("cold_c", Text("Cold side", "Lato freddo"), cold_c, "°C", 1),
            Number(
                "soft_c", Text("PLA becomes soft at", "Il PLA si ammorbidisce a"), soft, "°C", 0
            ),
            Number(
                "creeps",
                Text("Filament in the cold side", "Filamento nel lato freddo"),
                float(cold_c > soft),
                words=Text("soft: it jams", "molle: si blocca")
                if cold_c > soft
                else Text("hard: it slides", "duro: scorre"),
            ),
        ],
        graphs=[
            Graph(
                Text("Temperature of the cold side", "Temperatura del lato freddo"),
                Text("fan of the heat sink, %", "ventola del dissipatore, %"),
                "°C",
                [
                    Line(Text("cold side", "lato freddo"), fans, colds),
                    Line(
                        Text("PLA becomes soft", "il PLA si ammorbidisce"),
                        [0.0, 100.0],
                        [soft, soft],
                        1,
                        True,
                    ),
                ],
            )
        ],
    )


EXPERIMENT = Experiment(
    "hotend-and-heat-creep",
    Text("Heat on its way up", "Il calore che sale"),
    Text(
        "Heat flows from the nozzle through the neck of the heat break into the heat sink.",
        "Il calore va dall'ugello, attraverso il collo della barriera, al dissipatore.",
    ),
    [
        Parameter("nozzle_c", Text("Nozzle", "Ugello"), 210.0, 180.0, 300.0, 5.0, unit="°C"),
        Parameter(
            "fan_percent",
            Text("Fan of the heat sink", "Ventola del dissipatore"),
            100.0,
            0.0,
            100.0,
            5.0,
            unit="%",
        ),
        Parameter(
            "conductivity",
            Text("Material of the neck", "Materiale del collo"),
            _STEEL,
            unit="W/(m·K)",
            choices=[
                Choice(_STEEL, Text("steel", "acciaio")),
                Choice(_TITANIUM, Text("titanium", "titanio")),
                Choice(_BRASS, Text("brass", "ottone")),
            ],
        ),
    ],
    _compute,
)

LESSON = Lesson(
    name="hotend-and-heat-creep",
    chapter=Chapter.HEAT,
    place=90,
    rows=(23,),
    minutes=20,
    title=Text("Hotend and heat creep", "Hotend e risalita del calore"),
    goal=Text(
        "You know the parts of a hotend, and why a stopped fan jams it.",
        "Conosci le parti di un hotend, e perché una ventola ferma lo blocca.",
    ),
    text=[
        Text(
            "From below: the nozzle, a block with heater and sensor, where filament melts; the"
            " heat break, a tube with a thin neck; the heat sink with its fan. Filament must be"
            " hard down to the neck: it is the piston that presses the melt out.",
            "Dal basso: l'ugello, un blocco con riscaldatore e sensore, dove il filamento fonde; la"
            " barriera termica, un tubo con un collo sottile; il dissipatore con la ventola. Il"
            " filamento deve restare duro fino al collo: è il pistone che spinge il fuso.",
        ),
        Text(
            "Heat climbs through the neck. Its resistance is `length / (conductivity·area)` ="
            " {break_k_w}, that of the heat sink {sink_k_w}. With a nozzle at {nozzle_c} this lets"
            " {watts} up, and the cold side has {cold_c}.",
            "Il calore sale dal collo. La sua resistenza è `lunghezza / (conducibilità·area)` ="
            " {break_k_w}, quella del dissipatore {sink_k_w}. Con l'ugello a {nozzle_c} salgono"
            " {watts}, e il lato freddo è a {cold_c}.",
        ),
        Text(
            "Without the fan the heat sink has {still.sink_k_w}, and the cold side {still.cold_c}."
            " PLA becomes soft at {soft_c}: it swells, sticks to the tube, and the hotend jams."
            " That is heat creep. With a neck of brass even the fan would not help:"
            " {brass.cold_c}.",
            "Senza ventola il dissipatore ha {still.sink_k_w}, e il lato freddo {still.cold_c}. Il"
            " PLA si ammorbidisce a {soft_c}: si gonfia, si attacca al tubo, e l'hotend si blocca."
            " È la risalita del calore. Con un collo di ottone non basterebbe la ventola:"
            " {brass.cold_c}.",
        ),
        Text(
            "So the fan of the heat sink runs whenever the hotend is hot, not by the commands of"
            " the print. A firmware that watches its speed stops before the jam.",
            "Perciò la ventola del dissipatore gira quando l'hotend è caldo, e non secondo i"
            " comandi della stampa. Un firmware che ne sorveglia i giri si ferma prima del blocco.",
        ),
    ],
    experiment=EXPERIMENT,
    cases={"still": {"fan_percent": 0.0}, "brass": {"conductivity": _BRASS}},
    questions=[
        Question(
            Text(
                "The nozzle has {nozzle_c}, the room `25 °C`. The neck has {break_k_w}, the heat"
                " sink {sink_k_w}. What is the temperature of the cold side?",
                "L'ugello è a {nozzle_c}, l'ambiente a `25 °C`. Il collo ha {break_k_w}, il"
                " dissipatore {sink_k_w}. Quale temperatura ha il lato freddo?",
            ),
            "cold_c",
            given={"nozzle_c": 250.0, "fan_percent": 50.0},
            mistakes=[
                Mistake(
                    lambda v: (
                        (v["nozzle_c"] - 25) * v["sink_k_w"] / (v["break_k_w"] + v["sink_k_w"])
                    ),
                    Text(
                        "So much it is above the room. Add the room.",
                        "Di tanto supera l'ambiente. Aggiungi l'ambiente.",
                    ),
                ),
                Mistake(
                    lambda v: 25 + (v["nozzle_c"] - 25) * v["sink_k_w"] / v["break_k_w"],
                    Text(
                        "Both resistances carry the same heat, one after the other: divide by"
                        " their sum.",
                        "Le due resistenze portano lo stesso calore, una dopo l'altra: dividi per"
                        " la somma.",
                    ),
                ),
            ],
            why=Text(
                "The heat is {watts}; the heat sink is that much times its resistance above the"
                " room.",
                "Il calore è {watts}; il dissipatore supera l'ambiente di tanto per la sua"
                " resistenza.",
            ),
            hint=Text(
                "It is a divider, as with resistors: heat like current, temperature like voltage.",
                "È un partitore, come con le resistenze: calore come corrente, temperatura come"
                " tensione.",
            ),
            tolerance=0.02,
        ),
        Question(
            Text(
                "The neck is of titanium, the nozzle at {nozzle_c}, the fan at {fan_percent}. How"
                " many watts climb up? The neck has {break_k_w}, the heat sink {sink_k_w}.",
                "Il collo è di titanio, l'ugello a {nozzle_c}, la ventola al {fan_percent}. Quanti"
                " watt salgono? Il collo ha {break_k_w}, il dissipatore {sink_k_w}.",
            ),
            "watts",
            given={"nozzle_c": 230.0, "conductivity": _TITANIUM},
            mistakes=[
                Mistake(
                    lambda v: (v["nozzle_c"] - 25) / v["break_k_w"],
                    Text(
                        "The heat also has to pass the heat sink: add its resistance.",
                        "Il calore deve passare anche il dissipatore: aggiungi la sua resistenza.",
                    ),
                ),
                Mistake(
                    lambda v: v["nozzle_c"] / (v["break_k_w"] + v["sink_k_w"]),
                    Text(
                        "Only the difference to the room drives heat.",
                        "Solo la differenza con l'ambiente spinge il calore.",
                    ),
                ),
            ],
            why=Text(
                "The difference of temperatures, divided by the sum of the resistances.",
                "La differenza di temperatura, divisa per la somma delle resistenze.",
            ),
            hint=Text("Ohm's law for heat.", "La legge di Ohm per il calore."),
        ),
    ],
    source=Source("src/passo/printer/watch/automatic_fans.py", "AutomaticFans"),
    printer=OwnPrinter(
        Text(
            "M106 and the page show the fans. Heat the hotend, and look whether the fan of its"
            " heat sink turns.",
            "M106 e la pagina mostrano le ventole. Scalda l'hotend, e guarda se la ventola del"
            " dissipatore gira.",
        ),
        page="machine",
    ),
)
