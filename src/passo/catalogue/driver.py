"""Errors of motor drivers."""

from __future__ import annotations

from collections.abc import Mapping

from passo.catalogue.entry import Entry, ExitStatus


def _driver(says: str, action: str) -> Entry:
    return Entry("driver", f"motor {{axis}}: {says}", action, ExitStatus.MACHINE_FAULT)


DRIVER: Mapping[str, Entry] = {
    "driver.silent": _driver(
        "its driver, a {value} on {limit}, does not answer",
        "Switch the motors' supply on, check the driver's seat, jumpers and these pins, then M999",
    ),
    "driver.deaf": _driver(
        "its driver, a {value} on {limit}, does not accept its settings",
        "Check the wire to it and that no other driver has its address, then M999",
    ),
    "driver.other-chip": _driver(
        "the driver on {limit} reports version {value}, and is not the chip of the machine file",
        "Correct the motor's driver in the machine file, or the pins",
    ),
    "driver.reset": _driver(
        "its driver, a {value}, was reset: its settings are gone",
        "Check the plugs and wires of the motors' supply, then M999",
    ),
    "driver.short-to-ground": _driver(
        "coil {value} has a short circuit to ground; its driver has switched it off",
        "Cut the power, check the motor's cable and plug, then M999",
    ),
    "driver.short-to-supply": _driver(
        "coil {value} has a short circuit to the supply; its driver has switched it off",
        "Cut the power, check the motor's cable and plug, then M999",
    ),
    "driver.overheated": _driver(
        "its driver, a {value}, is too hot and has switched the motor off",
        "Let it cool, check its fan and heat sink or lower its current (M906), then M999",
    ),
    "driver.hot": _driver(
        "its driver, a {value}, is hot and will soon switch the motor off",
        "Cool it better, or lower its current (M906)",
    ),
    "driver.undervoltage": _driver(
        "its driver, a {value}, has too little voltage to switch on fully",
        "Check the motors' supply and its plugs, then M999",
    ),
    "driver.open-coil": _driver(
        "coil {value} looks open; that counts only while the motor turns slowly",
        "If it repeats at low speed, switch the power off and check the motor's cable and plug",
    ),
    "driver.stopped": _driver(
        "its driver, a {value}, has switched the motor off for a moment, because of heat or a short"
        " circuit",
        "Check the motor's cable and the driver's cooling, then M999",
    ),
}
