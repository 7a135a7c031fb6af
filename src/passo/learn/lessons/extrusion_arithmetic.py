"""How much filament a line needs, and what flow and retraction change."""

from __future__ import annotations

from math import pi

from passo.learn.bilingual import Text
from passo.learn.calculators.line_and_flow import CALCULATOR
from passo.learn.lesson import Chapter, Lesson, Mistake, OwnPrinter, Question, Source

LESSON = Lesson(
    name="extrusion-arithmetic",
    chapter=Chapter.MOTION,
    place=130,
    rows=(24,),
    minutes=20,
    title=Text("Extrusion arithmetic", "Aritmetica dell'estrusione"),
    goal=Text(
        "You compute the E of a line from its width, height and length.",
        "Calcoli la E di una linea da larghezza, altezza e lunghezza.",
    ),
    text=[
        Text(
            "Plastic is not lost: what goes in as filament comes out as line. A line of {width_mm}"
            " by {height_mm} has a rectangle in its middle and round sides; its cross-section is"
            " {area_mm2}.",
            "La plastica non si perde: ciò che entra come filamento esce come linea. Una linea di"
            " {width_mm} per {height_mm} ha un rettangolo al centro e lati rotondi; la sua sezione"
            " è {area_mm2}.",
        ),
        Text(
            "Filament of {filament_mm} has {filament_area_mm2}, many times as much. So the"
            " filament moves far less than the head: {length_mm} of line need {e_mm} of it. That"
            " is the E of the G-code.",
            "Il filamento di {filament_mm} ha {filament_area_mm2}, molto di più. Perciò il"
            " filamento si muove molto meno della testina: {length_mm} di linea ne richiedono"
            " {e_mm}. Questa è la E del G-code.",
        ),
        Text(
            "At {speed_mm_s} the line takes {flow_mm3_s}. Every hotend has a limit for that: it"
            " must melt so much each second. Beyond it the gears slip, and lines become thin.",
            "A {speed_mm_s} la linea richiede {flow_mm3_s}. Ogni hotend ha un limite: deve fonderne"
            " tanto ogni secondo. Oltre, gli ingranaggi slittano, e le linee diventano sottili.",
        ),
        Text(
            "The flow factor (`M221`) multiplies every E: with {less.flow_percent} the same line"
            " gets {less.e_mm}. Use it for what you have measured, such as filament that is"
            " thinner than it says. A retraction pulls filament back before a travel move; it"
            " prints nothing, and the next line needs the same length again.",
            "Il fattore di flusso (`M221`) moltiplica ogni E: con {less.flow_percent} la stessa"
            " linea riceve {less.e_mm}. Usalo per ciò che hai misurato, come un filamento più"
            " sottile del dichiarato. Una retrazione tira indietro il filamento prima di uno"
            " spostamento; non stampa nulla, e la linea seguente richiede la stessa lunghezza.",
        ),
    ],
    experiment=CALCULATOR,
    cases={"less": {"flow_percent": 95.0}},
    questions=[
        Question(
            Text(
                "A line of {width_mm} by {height_mm}, {length_mm} long, from filament of"
                " {filament_mm}. How many millimetres of filament?",
                "Una linea di {width_mm} per {height_mm}, lunga {length_mm}, da filamento di"
                " {filament_mm}. Quanti millimetri di filamento?",
            ),
            "e_mm",
            given={"width_mm": 0.6, "height_mm": 0.3, "length_mm": 200.0},
            mistakes=[
                Mistake(
                    lambda v: (
                        v["width_mm"]
                        * v["height_mm"]
                        * v["length_mm"]
                        / (pi * v["filament_mm"] ** 2 / 4)
                    ),
                    Text(
                        "The sides of a line are round: it has less than a rectangle.",
                        "I lati di una linea sono rotondi: è meno di un rettangolo.",
                    ),
                ),
                Mistake(
                    lambda v: v["volume_mm3"] / (pi * v["filament_mm"] ** 2),
                    Text(
                        "That takes the diameter of the filament as its radius.",
                        "Così il diametro del filamento è preso come raggio.",
                    ),
                ),
            ],
            why=Text(
                "The volume is {volume_mm3}, divided by {filament_area_mm2} of filament.",
                "Il volume è {volume_mm3}, diviso per {filament_area_mm2} di filamento.",
            ),
            hint=Text(
                "Cross-section of the line, its volume, then the length of filament with the same"
                " volume.",
                "Sezione della linea, volume, poi la lunghezza di filamento con lo stesso volume.",
            ),
        ),
        Question(
            Text(
                "The first layer is {width_mm} by {height_mm}, at {speed_mm_s}. How many cubic"
                " millimetres flow each second?",
                "Il primo strato è {width_mm} per {height_mm}, a {speed_mm_s}. Quanti millimetri"
                " cubi scorrono al secondo?",
            ),
            "flow_mm3_s",
            given={"width_mm": 0.5, "height_mm": 0.25, "speed_mm_s": 40.0},
            mistakes=[
                Mistake(
                    lambda v: v["filament_mm_s"],
                    Text(
                        "That is the speed of the filament.", "Questa è la velocità del filamento."
                    ),
                ),
                Mistake(
                    lambda v: v["width_mm"] * v["height_mm"] * v["speed_mm_s"],
                    Text(
                        "The sides are round: use the cross-section of the lesson.",
                        "I lati sono rotondi: usa la sezione della lezione.",
                    ),
                ),
            ],
            why=Text(
                "The cross-section {area_mm2}, pushed forward at {speed_mm_s}.",
                "La sezione {area_mm2}, spinta avanti a {speed_mm_s}.",
            ),
            hint=Text(
                "Cross-section times the speed of the head.",
                "Sezione per la velocità della testina.",
            ),
        ),
    ],
    source=Source("src/passo/learn/calculators/line_and_flow.py", "line_area_mm2"),
    printer=OwnPrinter(
        Text(
            "M221 shows the flow factor. Measure your filament in three places before you change"
            " it.",
            "M221 mostra il fattore di flusso. Misura il filamento in tre punti prima di"
            " cambiarlo.",
        ),
        command="M221",
    ),
)
