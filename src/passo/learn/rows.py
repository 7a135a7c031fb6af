"""The subjects of the course, and where the ones without a lesson are taught."""

from __future__ import annotations

from dataclasses import dataclass

from passo.learn.bilingual import Text


@dataclass(frozen=True, slots=True)
class Subject:
    """A subject with its number. `elsewhere` is a document, or a part of the page, that teaches it
    with numbers to try; empty if only lessons do."""

    number: int
    title: Text
    elsewhere: str = ""


_ONE_LINE = "docs/tutorial/one-line.md"

SUBJECTS: tuple[Subject, ...] = (
    Subject(1, Text("From G-code to steps", "Dal G-code ai passi"), _ONE_LINE),
    Subject(2, Text("Times of steps", "Tempi dei passi"), _ONE_LINE),
    Subject(3, Text("Bresenham's method", "Il metodo di Bresenham")),
    Subject(4, Text("Profile of the speed", "Profilo della velocità")),
    Subject(5, Text("Junctions", "Giunzioni"), _ONE_LINE),
    Subject(6, Text("Look-ahead", "Look-ahead")),
    Subject(7, Text("Steps per millimetre", "Passi al millimetro")),
    Subject(8, Text("Microsteps", "Micropassi")),
    Subject(9, Text("Coils of a stepper motor", "Bobine di un motore passo-passo")),
    Subject(10, Text("Endstops", "Finecorsa")),
    Subject(11, Text("Thermistor and ADC", "Termistore e ADC")),
    Subject(
        12, Text("Calibration of β", "Calibrazione di β"), "docs/how-to/calibrate-a-thermistor.md"
    ),
    Subject(13, Text("PID by hand", "PID a mano")),
    Subject(14, Text("On-off control against PID", "Controllo on-off e PID")),
    Subject(15, Text("Automatic tuning", "Taratura automatica"), "docs/how-to/tune-a-heater.md"),
    Subject(16, Text("Protections", "Protezioni"), "docs/how-to/simulate-faults.md"),
    Subject(17, Text("Heat of a MOSFET", "Calore di un MOSFET")),
    Subject(18, Text("Power budget", "Bilancio di potenza")),
    Subject(19, Text("Software PWM", "PWM software")),
    Subject(20, Text("Serial protocol", "Protocollo seriale")),
    Subject(21, Text("Stored settings", "Impostazioni salvate"), "docs/reference/serve.md"),
    Subject(22, Text("Whole and broken steps", "Passi interi e frazionari")),
    Subject(23, Text("Parts of a hotend", "Parti di un hotend")),
    Subject(24, Text("Extrusion arithmetic", "Aritmetica dell'estrusione")),
    Subject(
        25,
        Text("Pressure advance", "Pressure advance"),
        "docs/how-to/print-fast-without-ringing.md",
    ),
    Subject(26, Text("Geometries", "Geometrie"), _ONE_LINE),
    Subject(27, Text("Interrupts, and what blocks", "Interrupt, e ciò che blocca")),
    Subject(28, Text("Homing and coordinates", "Homing e coordinate")),
    Subject(29, Text("Arcs", "Archi")),
    Subject(30, Text("Reading the source", "Leggere il sorgente")),
    Subject(31, Text("Counters and service", "Contatori e manutenzione")),
    Subject(
        32, Text("Configuration as an experiment", "La configurazione come esperimento"), _ONE_LINE
    ),
)
