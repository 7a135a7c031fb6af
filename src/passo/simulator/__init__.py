"""The simulated printer: a complete board in virtual time with mechanics and heat around it."""

from passo.simulator.board import SimulatedBoard
from passo.simulator.fault_injector import SimulatedFaults
from passo.simulator.machine import Cable, SimulatedMachine
from passo.simulator.plant import (
    Actuator,
    Air,
    Bed,
    BedProbe,
    Body,
    FilamentInSensor,
    InputSwitch,
    Lift,
    PlantDescription,
    Rotor,
    StallPin,
    Switch,
    TravelStop,
)
from passo.simulator.wires import without_buses

__all__ = [
    "Actuator",
    "Air",
    "Bed",
    "BedProbe",
    "Body",
    "Cable",
    "FilamentInSensor",
    "InputSwitch",
    "Lift",
    "PlantDescription",
    "Rotor",
    "SimulatedBoard",
    "SimulatedFaults",
    "SimulatedMachine",
    "StallPin",
    "Switch",
    "TravelStop",
    "without_buses",
]
