"""Which value holds after a restart: machine file, stored settings, or a command."""

from __future__ import annotations

from passo.job.settings_store import same
from passo.learn.bilingual import Text, Words, short_figure
from passo.learn.experiment import Choice, Experiment, Number, Outcome, Parameter
from passo.learn.lesson import Chapter, Lesson, Link, Mistake, OwnPrinter, Question, Source
from passo.learn.pictures import Graph, Line, Table, edges

_DAYS = 365.0
_SOURCES = (
    Text("the machine file", "il file macchina"),
    Text("the stored settings", "le impostazioni salvate"),
    Text("a command", "un comando"),
)
_FILE, _STORED, _COMMAND = 0, 1, 2
# What follows M92, until the restart.
_ACTIONS = {
    "none": Text("nothing", "nulla"),
    "M500": "M500",
    "M500 M502": Text("M500, later M502", "M500, poi M502"),
    "M500 M502 M500": Text("M500, M502, M500", "M500, M502, M500"),
}


def _compute(
    file: float, commanded: float, action: str, edited: float, writes_per_day: float, writes: float
) -> Outcome:
    now, source = commanded, _COMMAND
    stored: float | None = None
    names: list[Words] = [Text("start", "avvio"), f"M92 X{short_figure(commanded, 2)}"]
    values = [file, now]
    sources = [_FILE, source]
    for command in action.split() if action != "none" else []:
        if command == "M502":
            now, source = file, _FILE
        elif same(str(now), str(file)):
            stored = None  # the store holds only what differs from the machine file
        else:
            stored, source = now, _STORED
        names.append(command)
        values.append(now)
        sources.append(source)
    before, before_source = now, source
    if stored is None or same(str(stored), str(edited)):
        now, source = edited, _FILE
    else:
        now, source = stored, _STORED
    names.append(Text("file edited, restart", "file modificato, riavvio"))
    values.append(now)
    sources.append(source)
    return Outcome(
        numbers=[
            Number("before", Text("Before the restart", "Prima del riavvio"), before),
            Number(
                "before_source",
                Text("It comes from", "Viene da"),
                float(before_source),
                words=_SOURCES[before_source],
            ),
            Number("after", Text("After the restart", "Dopo il riavvio"), now),
            Number(
                "after_source",
                Text("It comes from", "Viene da"),
                float(source),
                words=_SOURCES[source],
            ),
            Number(
                "error_percent",
                Text("Error of the movement", "Errore del movimento"),
                100 * (now / edited - 1),
                "%",
                decimals=1,
            ),
            Number(
                "years",
                Text("Life of an EEPROM cell", "Vita di una cella EEPROM"),
                writes / writes_per_day / _DAYS,
                Text("years", "anni"),
                decimals=1,
            ),
        ],
        graphs=[
            Graph(
                Text("Value in force at each event", "Valore in vigore a ogni evento"),
                Text("event", "evento"),
                Text("steps/mm", "passi/mm"),
                [
                    Line(
                        Text("in force", "in vigore"),
                        *edges([float(k) for k in range(len(values) + 1)], [*values, values[-1]]),
                    )
                ],
                values=(),
            )
        ],
        tables=[
            Table(
                Text("Events", "Eventi"),
                [Text("event", "evento"), Text("value", "valore"), Text("source", "origine")],
                [
                    [name, short_figure(value, 2), _SOURCES[one]]
                    for name, value, one in zip(names, values, sources, strict=True)
                ],
            )
        ],
    )


def _scale(name: str, label: Text, default: float) -> Parameter:
    unit = Text("steps/mm", "passi/mm")
    return Parameter(name, label, default, low=40.0, high=200.0, step=0.5, unit=unit)


EXPERIMENT = Experiment(
    "stored-settings",
    Text("A value with three sources", "Un valore con tre origini"),
    Text(
        "The scale of X: in the machine file, set by M92, perhaps stored; then the file is edited"
        " and the printer restarts.",
        "La scala di X: nel file macchina, impostata con M92, forse salvata; poi il file viene"
        " modificato e la stampante riavviata.",
    ),
    [
        _scale("file", Text("In the machine file", "Nel file macchina"), 80.0),
        _scale("commanded", Text("Set by M92", "Impostata con M92"), 82.0),
        Parameter(
            "action",
            Text("Then you send", "Poi mandi"),
            "M500",
            choices=[Choice(key, words) for key, words in _ACTIONS.items()],
        ),
        _scale("edited", Text("File edited to", "File modificato in"), 100.0),
        Parameter(
            "writes_per_day",
            Text("Writes to an EEPROM per day", "Scritture su EEPROM al giorno"),
            24.0,
            low=1.0,
            high=1440.0,
        ),
        Parameter(
            "writes",
            Text("Writes that a cell allows", "Scritture ammesse da una cella"),
            100_000.0,
            choices=[Choice(10_000.0), Choice(100_000.0), Choice(1_000_000.0)],
        ),
    ],
    _compute,
)

LESSON = Lesson(
    name="stored-settings",
    chapter=Chapter.PRACTICE,
    place=20,
    rows=(21,),
    minutes=20,
    title=Text("Stored settings: which value won?", "Impostazioni salvate: quale valore ha vinto?"),
    goal=Text(
        "You predict which of several values holds, and find out where a value comes from.",
        "Prevedi quale di più valori vale, e scopri da dove viene un valore.",
    ),
    text=[
        Text(
            "A value can come from three places: the machine file says {file}, M92 sets"
            " {commanded}, M500 stores what is in force. A command acts at once, but only until"
            " the next start, if you do not store it.",
            "Un valore può venire da tre posti: il file macchina dice {file}, M92 imposta"
            " {commanded}, M500 salva ciò che è in vigore. Un comando agisce subito, ma solo fino"
            " al prossimo avvio, se non lo salvi.",
        ),
        Text(
            "At the start Passo reads the file, then the store. So after M500 the stored value"
            " wins, even if you edit the file to {edited} later: {after} holds, from"
            " {after_source}. The movement then has an error of {error_percent}. This is the usual"
            " reason why a change in a file has no effect.",
            "All'avvio Passo legge il file, poi le impostazioni salvate. Quindi dopo M500 vince il"
            " valore salvato, anche se poi modifichi il file in {edited}: vale {after}, da"
            " {after_source}. L'asse si muove allora con un errore di {error_percent}. È il motivo"
            " più comune per cui una modifica al file non ha effetto.",
        ),
        Text(
            "Without M500 the edited file wins: {lost.after}. M502 goes back to the file, but only"
            " in memory. If you do not store again, the old value returns at the next start:"
            " {back.after}. With M500 after it, the store is empty and {clean.after} holds.",
            "Senza M500 vince il file modificato: {lost.after}. M502 torna al file, ma solo in"
            " memoria. Se non salvi di nuovo, al prossimo avvio torna il vecchio valore:"
            " {back.after}. Con un M500 dopo, il salvataggio è vuoto e vale {clean.after}.",
        ),
        Text(
            "Passo stores only what differs from the file, and names it at each start, with the"
            " value that it overrides. The page shows the source of every value.",
            "Passo salva solo ciò che differisce dal file, e lo nomina a ogni avvio, con il valore"
            " che sostituisce. La pagina mostra l'origine di ogni valore.",
        ),
        Text(
            "Boards with firmwares for AVR keep such values in an EEPROM: bytes in a fixed order,"
            " with a version and a checksum. After an update with another order the version"
            " differs, and all values fall back to defaults. A cell wears out: with"
            " {writes_per_day} writes a day it lasts {years}.",
            "Le schede con firmware per AVR tengono questi valori in una EEPROM: byte in un ordine"
            " fisso, con una versione e una somma di controllo. Dopo un aggiornamento con un altro"
            " ordine la versione è diversa, e tutti i valori tornano ai predefiniti. Una cella si"
            " consuma: con {writes_per_day} scritture al giorno dura {years}.",
        ),
    ],
    experiment=EXPERIMENT,
    cases={
        "lost": {"action": "none"},
        "back": {"action": "M500 M502"},
        "clean": {"action": "M500 M502 M500"},
    },
    questions=[
        Question(
            Text(
                "The file has {file}. You send M92 with {commanded}, M500, later M502, and nothing"
                " else. Then you edit the file to {edited} and restart. Which value holds?",
                "Il file ha {file}. Mandi M92 con {commanded}, M500, poi M502, e nient'altro. Poi"
                " modifichi il file in {edited} e riavvii. Quale valore vale?",
            ),
            "after",
            given={"action": "M500 M502", "commanded": 95.0, "edited": 160.0},
            mistakes=[
                Mistake(
                    lambda v: v["edited"],
                    Text(
                        "The store still has its value: M502 changed the memory only.",
                        "Il salvataggio ha ancora il suo valore: M502 ha cambiato solo la memoria.",
                    ),
                ),
                Mistake(
                    lambda v: v["file"],
                    Text(
                        "M502 was before the restart. At the start file and store are read again.",
                        "M502 era prima del riavvio. All'avvio file e salvataggio si rileggono.",
                    ),
                ),
            ],
            why=Text(
                "It comes from {after_source}. Send M502, then M500, to clear it.",
                "Viene da {after_source}. Manda M502, poi M500, per cancellarlo.",
            ),
            hint=Text(
                "What is in the store at the restart? Only M500 writes it.",
                "Che cosa c'è nel salvataggio al riavvio? Solo M500 lo scrive.",
            ),
        ),
        Question(
            Text(
                "You calibrate {commanded} with M92 and print well. You do not send M500. The next"
                " day, after a restart, where does the value come from?",
                "Calibri {commanded} con M92 e stampi bene. Non mandi M500. Il giorno dopo, dopo un"
                " riavvio, da dove viene il valore?",
            ),
            "after_source",
            given={"action": "none", "edited": 80.0},
            options=[(float(k), words) for k, words in enumerate(_SOURCES)],
            mistakes=[
                Mistake(
                    lambda _: float(_STORED),
                    Text(
                        "Nothing was stored: M92 writes no file.",
                        "Nulla è stato salvato: M92 non scrive alcun file.",
                    ),
                ),
                Mistake(
                    lambda _: float(_COMMAND),
                    Text(
                        "A command lives in memory. The restart forgets it.",
                        "Un comando vive in memoria. Il riavvio lo dimentica.",
                    ),
                ),
            ],
            why=Text(
                "The calibration is lost: {after} holds again.",
                "La calibrazione è persa: vale di nuovo {after}.",
            ),
            hint=Text("What survives a restart?", "Che cosa sopravvive a un riavvio?"),
        ),
        Question(
            Text(
                "A firmware stores a counter in the EEPROM {writes_per_day} times a day, always in"
                " the same cells, which allow {writes:n} writes. How many years do they last?",
                "Un firmware salva un contatore nella EEPROM {writes_per_day} volte al giorno,"
                " sempre nelle stesse celle, che ammettono {writes:n} scritture. Quanti anni"
                " durano?",
            ),
            "years",
            given={"writes_per_day": 48.0},
            mistakes=[
                Mistake(
                    lambda v: v["years"] * 365,
                    Text("These are days.", "Questi sono giorni."),
                ),
                Mistake(
                    lambda v: v["writes"] / 24 / 365,
                    Text("That is one write in each hour.", "Questa è una scrittura ogni ora."),
                ),
            ],
            why=Text(
                "Writes divided by writes per day, and by `365`. So counters are stored rarely, or"
                " only when they change.",
                "Scritture divise per scritture al giorno, e per `365`. Perciò i contatori si"
                " salvano di rado, o solo quando cambiano.",
            ),
            hint=Text(
                "For how many days are the writes enough?",
                "Per quanti giorni bastano le scritture?",
            ),
            tolerance=0.02,
        ),
    ],
    source=Source("src/passo/console/settings_commands.py", "SettingsCommands.load_at_start"),
    printer=OwnPrinter(
        Text(
            "M503 prints the values in force. The machine page shows for each whether it comes from"
            " the file, the store or a command.",
            "M503 stampa i valori in vigore. La pagina della macchina mostra per ognuno se viene"
            " dal file, dal salvataggio o da un comando.",
        ),
        command="M503",
        page="machine",
    ),
    links=[Link(Text("Serve", "Servire"), document="docs/reference/serve.md")],
)
