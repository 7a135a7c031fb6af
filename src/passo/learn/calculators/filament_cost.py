"""What a print costs."""

from __future__ import annotations

from math import pi

from passo.learn.bilingual import Text
from passo.learn.experiment import Choice, Experiment, Number, Outcome, Parameter
from passo.learn.pictures import Table

_EURO = "€"


def _compute(
    length_m: float,
    filament_mm: float,
    density_g_cm3: float,
    price_per_kg: float,
    hours: float,
    power_w: float,
    price_per_kwh: float,
) -> Outcome:
    volume_cm3 = pi * (filament_mm / 2) ** 2 * length_m  # mm² · m = cm³
    mass_g = volume_cm3 * density_g_cm3
    filament = mass_g / 1000 * price_per_kg
    energy_kwh = power_w * hours / 1000
    current = energy_kwh * price_per_kwh
    return Outcome(
        numbers=[
            Number("volume_cm3", Text("Volume", "Volume"), volume_cm3, "cm³", 1),
            Number("mass_g", Text("Mass", "Massa"), mass_g, "g", 1),
            Number("filament_cost", Text("Filament", "Filamento"), filament, _EURO),
            Number("energy_kwh", Text("Energy", "Energia"), energy_kwh, "kWh"),
            Number("energy_cost", Text("Electricity", "Elettricità"), current, _EURO),
            Number("total_cost", Text("Together", "Insieme"), filament + current, _EURO),
        ],
        tables=[
            Table(
                Text("Mass by material", "Massa per materiale"),
                [Text("material", "materiale"), "g/cm³", "g"],
                [
                    [name, f"{density:.2f}", f"{volume_cm3 * density:.1f}"]
                    for name, density in (
                        ("PLA", 1.24),
                        ("PETG", 1.27),
                        ("ABS", 1.04),
                        ("TPU", 1.21),
                    )
                ],
            )
        ],
    )


CALCULATOR = Experiment(
    "filament-cost",
    Text("Cost of a print", "Costo di una stampa"),
    Text(
        "From the length of the filament, as `passo estimate` shows it, to mass and price.",
        "Dalla lunghezza del filamento, come la mostra `passo estimate`, a massa e prezzo.",
    ),
    [
        Parameter("length_m", Text("Filament", "Filamento"), 10.0, 0.1, 400.0, 0.1, "m"),
        Parameter(
            "filament_mm",
            Text("Diameter", "Diametro"),
            1.75,
            unit="mm",
            choices=[Choice(1.75), Choice(2.85)],
        ),
        Parameter("density_g_cm3", Text("Density", "Densità"), 1.24, 0.8, 2.0, 0.01, "g/cm³"),
        Parameter(
            "price_per_kg",
            Text("Price of the filament", "Prezzo del filamento"),
            20.0,
            5.0,
            200.0,
            1.0,
            "€/kg",
        ),
        Parameter("hours", Text("Time", "Tempo"), 3.0, 0.1, 100.0, 0.1, "h"),
        Parameter("power_w", Text("Mean power", "Potenza media"), 120.0, 10.0, 1000.0, 10.0, "W"),
        Parameter(
            "price_per_kwh",
            Text("Price of electricity", "Prezzo dell'elettricità"),
            0.3,
            0.0,
            1.0,
            0.01,
            "€/kWh",
        ),
    ],
    _compute,
)
