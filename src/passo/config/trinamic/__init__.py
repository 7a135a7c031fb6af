"""Motor drivers with registers: the table of chips, their currents, and their keys in a machine
file."""

from passo.config.trinamic.chips import CHIPS, THRESHOLD_MAX, Bus, Chip, ChipName, chip_of
from passo.config.trinamic.currents import CurrentLaw, CurrentNumbers
from passo.config.trinamic.keys import STALL_PINS, Tmc
from passo.config.trinamic.motor import MotorConstants, tuned_fields
from passo.config.trinamic.registers import Field, Register

__all__ = [
    "CHIPS",
    "STALL_PINS",
    "THRESHOLD_MAX",
    "Bus",
    "Chip",
    "ChipName",
    "CurrentLaw",
    "CurrentNumbers",
    "Field",
    "MotorConstants",
    "Register",
    "Tmc",
    "chip_of",
    "tuned_fields",
]
