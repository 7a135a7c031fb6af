"""Homing by the stall detection of drivers: which motors an axis watches, and the checks of its
keys."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

from passo.config.findings import Finding
from passo.config.motor_roles import axis_order
from passo.config.trinamic import CHIPS, STALL_PINS, ChipName, chip_of

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig


class StallKind(NamedTuple):
    """How a chip detects stalls: the field of its threshold, the keys of its pins, and whether it
    does so in stealthChop rather than in spreadCycle."""

    field: str
    silent: bool
    pins: tuple[str, ...]


_IN_STEALTHCHOP = StallKind("sgthrs", silent=True, pins=("diag_pin",))
_IN_SPREADCYCLE = StallKind("sgt", silent=False, pins=("diag0_pin", "diag1_pin"))
STALL_KINDS: dict[ChipName, StallKind] = {
    "TMC2209": _IN_STEALTHCHOP,
    "TMC2226": _IN_STEALTHCHOP,
    "TMC2130": _IN_SPREADCYCLE,
    "TMC5160": _IN_SPREADCYCLE,
    "TMC2240": _IN_SPREADCYCLE,
}


def threshold_range(chip: ChipName) -> tuple[int, int]:
    """The least and the greatest threshold of a chip."""
    field = CHIPS[chip].field(STALL_KINDS[chip].field)
    assert field is not None
    return field.least, field.most


def watched_motors(machine: MachineConfig, home: str) -> list[str]:
    """The motors of the axis or actuator `home` whose drivers have a pin for their stall detection,
    those with its number first."""
    arms = machine.geometry.arms
    among = machine.geometry.actuators if home in arms else axis_order(machine.axes)
    own = [
        name
        for name in machine.steppers
        if (driven := machine.driven_by(name)) is not None
        and driven.drive != "extruder"
        and driven.index == among.index(home)
    ]
    return [name for name in own if (tmc := machine.steppers[name].tmc) and tmc.stall_pin]


def _on_belts(machine: MachineConfig, name: str) -> bool:
    """Whether an axis is moved by belts of other names, which move other axes too."""
    geometry = machine.geometry
    return name in "xyz" and name not in (*geometry.arms, *geometry.actuators)


def _stall_motors(machine: MachineConfig) -> list[str]:
    """All motors whose drivers have a pin for their stall detection."""
    return [n for n, s in machine.steppers.items() if s.tmc and s.tmc.stall_pin]


def check_stalls(machine: MachineConfig) -> Iterator[Finding]:
    """Checks that the drivers of an axis with stall detection have it, with its pin and a threshold
    and a current within their ranges."""
    for name, stepper in machine.steppers.items():
        chip, tmc = chip_of(stepper.driver), stepper.tmc
        kind = STALL_KINDS.get(chip) if chip else None
        for key in STALL_PINS:
            pin, allowed = getattr(tmc, key, None), kind.pins if kind else ()
            if pin is not None and key not in allowed:
                limit = f"{' or '.join(allowed)} for a {chip}"
                limit = limit if allowed else f"no such key: a {chip} does not detect stalls"
                yield Finding("config.conflict", ("steppers", name, "tmc", key), pin, limit)
        if tmc and tmc.diag0_pin and tmc.diag1_pin:
            limit = "one of diag0_pin and diag1_pin"
            path = ("steppers", name, "tmc", "diag0_pin")
            yield Finding("config.conflict", path, tmc.diag0_pin, limit)
    arms = [name for name in machine.homing if name in machine.geometry.arms]
    stalled = [name for name in machine.homing if machine.homing[name].stall]
    for name in stalled:
        yield from _check_stall(machine, name)
        if name in arms and not set(arms) <= set(stalled):
            limit = "a stall detection of all arms or of none, because they home together"
            yield Finding("config.conflict", ("homing", name, "stall"), "given", limit)


def _check_stall(machine: MachineConfig, name: str) -> Iterator[Finding]:
    stall, path = machine.homing[name].stall, ("homing", name, "stall")
    assert stall is not None
    motors = watched_motors(machine, name)
    if not motors:
        limit = "the pin diag_pin, diag0_pin or diag1_pin in the table tmc of a motor of this axis"
        yield Finding("config.missing-key", path, None, limit)
    boards = {machine.board_of_stepper(motor) for motor in _stall_motors(machine)}
    if _on_belts(machine, name) and len(boards) > 1:
        limit = "motors with stall detection on one board"
        yield Finding("config.conflict", path, f"on {len(boards)} boards", limit)
    for motor in motors:
        stepper = machine.steppers[motor]
        chip, tmc = chip_of(stepper.driver), stepper.tmc
        if chip not in STALL_KINDS or tmc is None:
            continue
        field = STALL_KINDS[chip].field
        if field in tmc.registers:
            where = ("steppers", motor, "tmc", "registers", field)
            limit = f"no such register: homing.{name}.stall.threshold sets it"
            yield Finding("config.conflict", where, tmc.registers[field], limit)
        least, most = threshold_range(chip)
        if not least <= stall.threshold <= most:
            limit = f"{least} to {most} for the {chip} of motor {motor}"
            yield Finding("config.value", (*path, "threshold"), stall.threshold, limit)
        law, resistor = CHIPS[chip].currents, tmc.resistor_ohm(chip)
        least_a, most_a = law.least_ma(resistor) / 1000, law.largest_ma(resistor) / 1000
        if stall.current_a is not None and not least_a <= stall.current_a <= most_a:
            limit = f"{least_a:g} to {most_a:g} A for the driver of motor {motor}"
            yield Finding("config.value", (*path, "current_a"), stall.current_a, limit)
