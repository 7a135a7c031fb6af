"""Normally closed or normally open: what a broken wire does."""

from __future__ import annotations

from passo.learn.bilingual import Text, Words
from passo.learn.experiment import Choice, Experiment, Number, Outcome, Parameter
from passo.learn.lesson import Chapter, Lesson, Link, Mistake, OwnPrinter, Question, Source
from passo.learn.pictures import Graph, Line, Mark, Plane, Table, edges

_SUPPLY_V = 5.0
_OVERRUN = 1.2  # of the axis: the longest way of a search
_HOMES, _REFUSES, _CRASHES = 0.0, 1.0, 2.0
_ENDS = {
    _HOMES: Text("the axis homes", "l'asse fa l'homing"),
    _REFUSES: Text("it stops with an error", "si ferma con un errore"),
    _CRASHES: Text("it pushes against the frame", "spinge contro il telaio"),
}
_CONTACTS = {
    "NC": Text("NC, normally closed", "NC, normalmente chiuso"),
    "NO": Text("NO, normally open", "NO, normalmente aperto"),
}
_WIRES = {
    "intact": Text("intact", "intatto"),
    "broken": Text("broken, or plug off", "rotto, o spina staccata"),
    "short": Text("short circuit to ground", "corto circuito a massa"),
}
_SAY = {True: Text("triggered", "attivo"), False: Text("open", "libero")}


def _touches(contact: str, *, pressed: bool) -> bool:
    """Whether the contact itself is closed."""
    return pressed == (contact == "NO")


def _closed(contact: str, wire: str, *, pressed: bool) -> bool:
    """Whether pin and ground are connected."""
    if wire != "intact":
        return wire == "short"
    return _touches(contact, pressed=pressed)


def _end(contact: str, wire: str, *, inverted: bool) -> float:
    """How homing ends. A high level is a triggered endstop, unless the pin is inverted."""
    away, reached = (
        _closed(contact, wire, pressed=pressed) == inverted for pressed in (False, True)
    )
    if away:
        return _REFUSES
    return _HOMES if reached else _CRASHES


def _compute(
    contact: str,
    wire: str,
    pressed: float,
    inverted: float,
    pull_up_ohm: float,
    axis_mm: float,
    distance_mm: float,
) -> Outcome:
    closed = _closed(contact, wire, pressed=bool(pressed))
    triggered = closed == bool(inverted)
    end = _end(contact, wire, inverted=bool(inverted))
    places = [-2.0, 0.0, distance_mm]
    levels = [_level(contact, wire, pressed=at) for at in (True, False, False)]
    return Outcome(
        numbers=[
            Number("volt", Text("Voltage at the pin", "Tensione sul pin"), _volt(closed), "V"),
            Number(
                "triggered",
                Text("The board reads", "La scheda legge"),
                float(triggered),
                words=_SAY[triggered],
            ),
            Number(
                "current_ma",
                Text("Current through the contact", "Corrente nel contatto"),
                1000 * _SUPPLY_V / pull_up_ohm if closed else 0.0,
                "mA",
            ),
            Number("end", Text("Homing", "Homing"), end, words=_ENDS[end]),
            Number(
                "push_mm",
                Text("Way against the frame", "Corsa contro il telaio"),
                _OVERRUN * axis_mm - distance_mm if end == _CRASHES else 0.0,
                "mm",
                decimals=1,
            ),
        ],
        graphs=[
            Graph(
                Text("Voltage on the way to the endstop", "Tensione lungo la via al finecorsa"),
                Text("distance from the endstop, mm", "distanza dal finecorsa, mm"),
                "V",
                [Line(Text("pin", "pin"), *edges(places, levels))],
                values=(0.0, _SUPPLY_V),
            )
        ],
        planes=[_circuit(wire, contact, pull_up_ohm, pressed=bool(pressed))],
        tables=[_table()],
    )


def _volt(closed: bool) -> float:
    return 0.0 if closed else _SUPPLY_V


def _level(contact: str, wire: str, *, pressed: bool) -> float:
    return _volt(_closed(contact, wire, pressed=pressed))


def _circuit(wire: str, contact: str, pull_up_ohm: float, *, pressed: bool) -> Plane:
    volt = _level(contact, wire, pressed=pressed)
    tip = (0.0, 1.2) if _touches(contact, pressed=pressed) else (0.35, 1.15)
    lines = [
        Line("", [0, 0, -0.2, -0.2, 0.2, 0.2, 0, 0], [2, 2.4, 2.4, 3.4, 3.4, 2.4, 2.4, 2]),
        Line("", [0, 0], [3.4, 4]),
        Line("", [0, 1.6], [2, 2], 1),
        Line("", [0, tip[0]], [0.5, tip[1]], 2),
        Line("", [0, 0], [0, 0.5]),
        Line("", [-0.4, 0.4], [0, 0], 6),
    ]
    if wire == "broken":
        lines.append(Line("", [-0.2, 0.2], [1.5, 1.8], 4))
        lines.append(Line("", [-0.2, 0.2], [1.8, 1.5], 4))
    else:
        lines.append(Line("", [0, 0], [1.2, 2]))
    if wire == "short":
        lines.append(Line("", [0, -0.8, -0.8, 0], [1.6, 1.6, 0.25, 0.25], 4))
    return Plane(
        Text("Pull-up and contact", "Pull-up e contatto"),
        lines,
        [
            Mark(0, 4, f"{_SUPPLY_V:g} V", 4, beside="above"),
            Mark(0.2, 2.9, f"{pull_up_ohm:.0f} Ω", dot=False),
            Mark(1.6, 2, f"pin: {volt:g} V", 1),
            Mark(0.35, 0.8, contact, 2, dot=False),
            Mark(0, 0, Text("ground", "massa"), dot=False, beside="below"),
        ],
    )


def _table() -> Table:
    rows: list[list[Words]] = []
    for contact, name in _CONTACTS.items():
        for wire, state in _WIRES.items():
            rows.append([name, state, _ENDS[_end(contact, wire, inverted=contact == "NO")]])
    return Table(
        Text("Homing with each contact and wire", "Homing con ogni contatto e cavo"),
        [Text("contact", "contatto"), Text("wire", "cavo"), "homing"],
        rows,
    )


EXPERIMENT = Experiment(
    "endstops",
    Text("A switch at the end of an axis", "Un interruttore alla fine di un asse"),
    Text(
        "The contact connects the pin with ground; a pull-up lifts an open pin.",
        "Il contatto collega il pin a massa; un pull-up alza un pin aperto.",
    ),
    [
        Parameter(
            "contact",
            Text("Contact", "Contatto"),
            "NC",
            choices=[Choice(key, words) for key, words in _CONTACTS.items()],
        ),
        Parameter(
            "wire",
            Text("Wire", "Cavo"),
            "intact",
            choices=[Choice(key, words) for key, words in _WIRES.items()],
        ),
        Parameter(
            "pressed",
            Text("Switch", "Interruttore"),
            0.0,
            choices=[
                Choice(0.0, Text("not pressed", "non premuto")),
                Choice(1.0, Text("pressed", "premuto")),
            ],
        ),
        Parameter(
            "inverted",
            Text("Pin in the machine file", "Pin nel file macchina"),
            0.0,
            choices=[Choice(0.0, "^X_MIN"), Choice(1.0, "^!X_MIN")],
        ),
        Parameter(
            "pull_up_ohm",
            Text("Pull-up", "Pull-up"),
            35_000.0,
            unit="Ω",
            choices=[
                Choice(1000.0, Text("1 kΩ on the board", "1 kΩ sulla scheda")),
                Choice(35_000.0, Text("35 kΩ in the chip", "35 kΩ nel chip")),
            ],
        ),
        Parameter(
            "axis_mm",
            Text("Length of the axis", "Lunghezza dell'asse"),
            200.0,
            low=50.0,
            high=500.0,
            step=10.0,
            unit="mm",
        ),
        Parameter(
            "distance_mm",
            Text("Distance from the endstop", "Distanza dal finecorsa"),
            40.0,
            low=1.0,
            high=50.0,
            unit="mm",
        ),
    ],
    _compute,
)

_NO: dict[str, float | str] = {"contact": "NO", "inverted": 1.0}

LESSON = Lesson(
    name="endstops",
    chapter=Chapter.ELECTRICITY,
    place=40,
    rows=(10,),
    minutes=20,
    title=Text("Endstops: break the wire", "Finecorsa: rompi il cavo"),
    goal=Text(
        "You choose the contact of an endstop by what happens when its wire breaks.",
        "Scegli il contatto di un finecorsa in base a ciò che accade se il cavo si rompe.",
    ),
    text=[
        Text(
            "An endstop is a switch between a pin of the board and ground. An open pin would pick"
            " up any noise, so a resistor, the pull-up, lifts it to the supply. Open contact:"
            " {reached.volt}. Closed contact: {volt}, and {current_ma} flow through it.",
            "Un finecorsa è un interruttore tra un pin della scheda e la massa. Un pin aperto"
            " raccoglierebbe ogni disturbo, quindi una resistenza, il pull-up, lo alza"
            " all'alimentazione. Contatto aperto: {reached.volt}. Contatto chiuso: {volt}, e"
            " passano {current_ma}.",
        ),
        Text(
            "A switch has two kinds of contact. NC is closed until the carriage presses it; NO is"
            " open until then. Both work if the file agrees: `^X_MIN` calls the high level"
            " triggered, `^!X_MIN` the low one.",
            "Un interruttore ha due tipi di contatto. NC è chiuso finché il carrello non lo preme;"
            " NO è aperto fino ad allora. Entrambi funzionano se il file è d'accordo: `^X_MIN`"
            " considera attivo il livello alto, `^!X_MIN` quello basso.",
        ),
        Text(
            "Now break the wire. With NC the pin rises as if the switch were pressed:"
            " {nc_broken.end}. With NO the broken wire looks like a switch that is not pressed:"
            " {no_broken.end}, here for {no_broken.push_mm}, while the motor loses steps.",
            "Ora rompi il cavo. Con NC il pin sale come se l'interruttore fosse premuto:"
            " {nc_broken.end}. Con NO il cavo rotto sembra un interruttore che nessuno preme:"
            " {no_broken.end}, qui per {no_broken.push_mm}, mentre il motore perde passi.",
        ),
        Text(
            "Wires break, and plugs come loose, far more often than two wires touch. So NC is the"
            " safe choice. It does not help against everything: with a short circuit to ground"
            " {nc_short.end}.",
            "I cavi si rompono, e le spine si staccano, molto più spesso di quanto due fili si"
            " tocchino. Perciò NC è la scelta sicura. Non aiuta contro tutto: con un corto circuito"
            " a massa {nc_short.end}.",
        ),
        Text(
            "Passo searches an endstop for at most the length of the axis and a fifth more. Then it"
            " stops with an error. Try an endstop with a finger before you home for the first"
            " time.",
            "Passo cerca un finecorsa per al massimo la lunghezza dell'asse e un quinto in più. Poi"
            " si ferma con un errore. Prova il finecorsa con un dito prima del primo homing.",
        ),
    ],
    experiment=EXPERIMENT,
    cases={
        "reached": {"pressed": 1.0},
        "nc_broken": {"wire": "broken"},
        "no_broken": _NO | {"wire": "broken"},
        "nc_short": {"wire": "short"},
    },
    questions=[
        Question(
            Text(
                "The wire of a NO endstop is broken. The axis is {axis_mm} long, the carriage"
                " {distance_mm} from the endstop. How far does the motor push against the frame?",
                "Il cavo di un finecorsa NO è rotto. L'asse è lungo {axis_mm}, il carrello è a"
                " {distance_mm} dal finecorsa. Per quanta corsa il motore spinge contro il telaio?",
            ),
            "push_mm",
            given=_NO | {"wire": "broken", "axis_mm": 300.0, "distance_mm": 30.0},
            mistakes=[
                Mistake(
                    lambda v: v["axis_mm"] - v["distance_mm"],
                    Text(
                        "The search is longer than the axis: a fifth more, so that it reaches an"
                        " endstop outside of the limits, too.",
                        "La ricerca è più lunga dell'asse: un quinto in più, per raggiungere anche"
                        " un finecorsa fuori dai limiti.",
                    ),
                ),
                Mistake(
                    lambda v: 1.2 * v["axis_mm"],
                    Text(
                        "The first part of this way is free. Subtract it.",
                        "La prima parte di questa corsa è libera. Sottraila.",
                    ),
                ),
                Mistake(
                    lambda _: 0.0,
                    Text(
                        "So it would be with NC. A broken NO contact never triggers.",
                        "Così sarebbe con NC. Un contatto NO rotto non si attiva mai.",
                    ),
                ),
            ],
            why=Text(
                "The search is `1.2 · length`. What remains after the free way is lost steps.",
                "La ricerca è `1.2 · lunghezza`. Ciò che resta dopo la via libera sono passi"
                " persi.",
            ),
            hint=Text(
                "How long is the search, and how much of it is free?",
                "Quanto è lunga la ricerca, e quanta parte è libera?",
            ),
        ),
        Question(
            Text(
                "A NO switch is connected, but the file has `^X_MIN`, as for NC. You home X."
                " What happens?",
                "È collegato un interruttore NO, ma il file ha `^X_MIN`, come per NC. Fai l'homing"
                " di X. Che cosa succede?",
            ),
            "end",
            given={"contact": "NO"},
            options=list(_ENDS.items()),
            mistakes=[
                Mistake(
                    lambda _: _HOMES,
                    Text(
                        "An open contact is a high level. What does `^X_MIN` call a high level?",
                        "Un contatto aperto è un livello alto. Come considera `^X_MIN` un livello"
                        " alto?",
                    ),
                ),
                Mistake(
                    lambda _: _CRASHES,
                    Text(
                        "That needs a pin that reads open on the whole way. This one reads"
                        " triggered from the start.",
                        "Per questo il pin dovrebbe leggere libero per tutta la via. Questo legge"
                        " attivo dall'inizio.",
                    ),
                ),
            ],
            why=Text(
                "Away from the switch the pin is at {volt}: {triggered}. Passo moves away from the"
                " switch, the pin stays so, and Passo reports it.",
                "Lontano dall'interruttore il pin è a {volt}: {triggered}. Passo si allontana, il"
                " pin resta così, e Passo lo riporta.",
            ),
            hint=Text(
                "Which level has the pin while the switch is not pressed?",
                "Quale livello ha il pin quando l'interruttore non è premuto?",
            ),
        ),
    ],
    source=Source("firmware/core/endstop.c", "command_endstop_home"),
    printer=OwnPrinter(
        Text(
            "Send M119, press the switch with a finger, send it again. Then pull the plug while"
            " nothing moves: a safe endstop reports triggered.",
            "Manda M119, premi l'interruttore con un dito, mandalo di nuovo. Poi stacca la spina"
            " mentre nulla si muove: un finecorsa sicuro riporta attivo.",
        ),
        command="M119",
    ),
    links=[
        Link(Text("First print", "Prima stampa"), document="docs/how-to/first-print.md"),
        Link(Text("Simulate faults", "Simula guasti"), document="docs/how-to/simulate-faults.md"),
    ],
)
