"""Errors of heaters and of their sensors."""

from __future__ import annotations

from collections.abc import Mapping

from passo.catalogue.entry import Entry, ExitStatus, bad_input


def _heat(says: str, action: str) -> Entry:
    return Entry("heat", says, f"{action}, then send M922", ExitStatus.MACHINE_FAULT)


def _shown(says: str, action: str) -> Entry:
    return Entry("sensor", says, action, ExitStatus.MACHINE_FAULT)


SHOWN: Mapping[str, Entry] = {
    "sensor.open": _shown(
        "sensor {axis} is broken: its cable is open", "Check the sensor's plug and wires"
    ),
    "sensor.short": _shown(
        "sensor {axis} is broken: its cable has a short circuit",
        "Check the sensor's wires where they may touch",
    ),
    "sensor.silent": _shown(
        "sensor {axis} does not answer at {limit}: the bus reports {value}",
        "Check its plug and wires, and its kind, address and pins in the machine file",
    ),
    "sensor.garbled": _shown(
        "sensor {axis} at {limit} sends {value}",
        "Use shorter or shielded wires, or a lower i2c_hz in the machine file",
    ),
    "sensor.other-chip": _shown(
        "the chip at {limit} is not the one of sensor {axis}: it reports {value}",
        "Correct the kind or the address of the sensor in the machine file",
    ),
    "sensor.apart": _shown(
        "the sensors of {axis} read {value} apart, of at most {limit}",
        "Check which of them is wrong, or change max_deviation_c in the machine file",
    ),
    "sensor.no-reading": _shown(
        "sensor {axis} has given no temperature for {value:g} s, so it cannot be waited for",
        "Check the sensor, its board and its firmware; M105 and the page show its readings",
    ),
    "sensor.low": _shown(
        "sensor {axis} reads {value:.1f} °C, below its minimum of {limit:.1f} °C",
        "Check the sensor, or change its min_c in the machine file",
    ),
    "sensor.high": _shown(
        "sensor {axis} reads {value:.1f} °C, above its maximum of {limit:.1f} °C",
        "Let it cool and check its fan, or change its max_c in the machine file",
    ),
}
"""Sensors without a heater."""
HEAT: Mapping[str, Entry] = {
    "heat.unknown": bad_input(
        "heat",
        "there is no {axis} with number {value}; the machine has {limit}",
        "Give another T or P, or add the heater to the machine file",
    ),
    "heat.no-pid": bad_input(
        "heat", "heater {axis} is not controlled by PID", "Change its control in the machine file"
    ),
    "heat.no-model": bad_input(
        "heat",
        "heater {axis} is not controlled by its model",
        "Change its control in the machine file",
    ),
    "heat.no-thermistor": bad_input(
        "heat", "the sensor of {axis} is not a thermistor", "Change it in the machine file"
    ),
    "heat.reads-nothing": bad_input(
        "heat",
        "with these values, the thermistor of {axis} has no distinct reading for each temperature"
        " from {limit} °C",
        "Send the true R25, beta and pull-up resistor of this thermistor",
    ),
    "heat.unsafe-target": bad_input(
        "heat",
        "heater {axis} was switched off: {value:g} °C is outside of its safe range, {limit} °C",
        "Give a temperature in this range, or change min_c and max_c of the heater",
    ),
    "heat.sensor-open": _heat(
        "heater {axis} was switched off: its sensor reads {value:.1f} °C; below {limit:.1f} °C"
        " means a broken cable",
        "Check the sensor's plug and wires",
    ),
    "heat.sensor-open-high": _heat(
        "heater {axis} was switched off: its sensor reads {value:.1f} °C, which means a broken"
        " cable",
        "Check the sensor's plug and wires",
    ),
    "heat.sensor-short": _heat(
        "heater {axis} was switched off: its sensor reads {value:.1f} °C; above {limit:.1f} °C"
        " means a short circuit in its cable",
        "Check the sensor's wires where they may touch",
    ),
    "heat.sensor-short-low": _heat(
        "heater {axis} was switched off: its sensor reads {value:.1f} °C, which means a short"
        " circuit in its cable",
        "Check the sensor's wires where they may touch",
    ),
    "heat.sensor-erratic": _heat(
        "heater {axis} was switched off: its sensor, at {value:.1f} °C now, keeps jumping by more"
        " than {limit:.1f} °C",
        "Check the sensor's plug and wires where they move",
    ),
    "heat.min-temperature": _heat(
        "heater {axis} was switched off: it is at {value:.1f} °C, below its minimum of {limit:.1f}"
        " °C",
        "Check the sensor, and that the room is not too cold",
    ),
    "heat.max-temperature": _heat(
        "heater {axis} was switched off: it is at {value:.1f} °C, above its maximum of {limit:.1f}"
        " °C",
        "Let it cool, and check its sensor and its control",
    ),
    "heat.heating-failed": _heat(
        "heater {axis} was switched off: it is at {value:.1f} °C and did not reach {limit:.1f} °C"
        " in time",
        "Check its cartridge, its supply, and that its sensor sits where it heats",
    ),
    "heat.runaway": _heat(
        "heater {axis} was switched off: it fell to {value:.1f} °C and stayed below {limit:.1f} °C",
        "Check its cartridge, its supply, and that its sensor sits where it heats",
    ),
    "heat.stuck-on": _heat(
        "heater {axis} gets hotter without power: it is at {value:.1f} °C, above {limit:.1f} °C",
        "Cut its power at once: its MOSFET or relay may be broken",
    ),
    "heat.model-deviation": _heat(
        "heater {axis} was switched off: at {value:.1f} °C its power differs from that of its"
        " model by more than {limit:.2f} of full power",
        "Check cartridge, sensor and fan, or tune its model again (M303 R5)",
    ),
}
