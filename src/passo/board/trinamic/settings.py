"""The settings of a driver, and the registers that hold them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import floor

from passo.config.trinamic import CHIPS, THRESHOLD_MAX, Chip, ChipName, CurrentNumbers

# Registers in the order of writing. The chopper is the last one, because it lets current flow.
_LAST = ("PWMCONF", "CHOPCONF")


@dataclass(frozen=True, slots=True)
class DriverSettings:
    """A driver's settings. Currents are RMS values in A. `threshold` is TPWMTHRS, in clocks of the
    chip per 1/256 of a full step: the driver uses stealthChop while a step takes longer, and
    spreadCycle while it takes less. None: always spreadCycle. `fields` are other fields of the
    registers by name; they replace the start values of the chip."""

    chip: ChipName
    run_a: float
    hold_a: float
    resistor_ohm: float
    microsteps: int = 16
    interpolate: bool = True
    threshold: int | None = None
    fields: Mapping[str, int] = field(default_factory=dict[str, int])

    @property
    def currents(self) -> CurrentNumbers:
        """The currents as numbers for the registers, which round them."""
        return CHIPS[self.chip].currents.numbers(self.resistor_ohm, self.run_a, self.hold_a)

    @property
    def values(self) -> dict[str, int]:
        """All fields that are written, by name; the others are 0."""
        chip = CHIPS[self.chip]
        made = {
            **chip.start,
            **self.currents.fields,
            "mres": 8 - (self.microsteps.bit_length() - 1),
            "intpol": int(self.interpolate),
        }
        if chip.mode:
            stealth = self.threshold is not None
            made[chip.mode] = int(stealth == (chip.mode == "en_pwm_mode"))
            made["tpwmthrs"] = self.threshold or 0
        return {**made, **self.fields}

    def registers(self) -> dict[str, int]:
        """Registers and their values, in the order of writing. Raises ValueError for a value that
        does not fit its field, KeyError for a field that the chip does not have."""
        chip, packed = CHIPS[self.chip], dict[str, int]()
        for name, value in self.values.items():
            found = chip.field(name)
            if found is None:
                raise KeyError(name)
            packed[found.register] = packed.get(found.register, 0) | found.placed(value)
        first = sorted(set(packed) - set(_LAST), key=lambda name: chip.registers[name].address)
        return {name: packed[name] for name in (*first, *_LAST) if name in packed}

    def writes(self) -> list[tuple[int, int]]:
        """Addresses of registers and their values, in the order of writing; clears the flags of
        past faults."""
        chip = CHIPS[self.chip]
        found = [(chip.registers[name].address, value) for name, value in self.registers().items()]
        general = chip.registers.get("GSTAT")
        return [*found, (general.address, flags_of(chip))] if general else found


def flags_of(chip: Chip) -> int:
    """All flags of GSTAT."""
    return sum(field.placed(1) for field in chip.registers["GSTAT"].fields.values())


def speed_of(chip: ChipName, threshold: int, microsteps: int) -> float:
    """The speed of a threshold, in microsteps per second."""
    return CHIPS[chip].clock_hz * microsteps / (256 * threshold)


def threshold_of(chip: ChipName, microsteps_s: float, microsteps: int) -> int:
    """TPWMTHRS, TCOOLTHRS or THIGH for a speed in microsteps per second; `microsteps` is the number
    of microsteps in a full step. TSTEP counts clocks per 1/256 of a full step."""
    if microsteps_s <= 0:
        return THRESHOLD_MAX
    counts = CHIPS[chip].clock_hz * microsteps / (256 * microsteps_s)
    return min(floor(counts + 0.5), THRESHOLD_MAX)
