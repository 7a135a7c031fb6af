"""The assignment of endstops to the motors that they stop, from the machine file."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass
from itertools import takewhile
from typing import TYPE_CHECKING

from passo.config.motor_roles import axis_order
from passo.config.probing import PROBE
from passo.config.stalls import watched_motors
from passo.gcode.command import letters_of
from passo.geometry.base import Point
from passo.probes.base import SensingProbe, SwitchProbe

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig

_NUDGE = 1e-3  # mm: a test move that shows which actuators an axis moves


@dataclass(frozen=True, slots=True)
class Switch:
    """An endstop at `pin` that stops `steppers` when `home`, an axis or an actuator, reaches it.
    Reports show it as `label`. `watched` are the motors whose drivers detect its stall; `also` are
    the names of further endstops that stop the same motors."""

    name: str
    home: str
    pin: str
    steppers: tuple[str, ...]
    label: str = ""
    watched: tuple[str, ...] = ()
    also: tuple[str, ...] = ()


def switches(machine: MachineConfig) -> tuple[Switch, ...]:
    """All endstops, in the order of the machine file. An endstop of a whole axis has the name of
    the axis, one of a single motor the name of the motor."""
    found: list[Switch] = []
    for name, homing in machine.homing.items():
        if homing.pin is not None:
            found.append(Switch(name, name, homing.pin, steppers_of(machine, name), name))
        found += [Switch(s, name, pin, (s,), s) for s, pin in homing.stepper_pins.items()]
        found += _stall_switches(machine, name) if homing.stall else []
    return tuple(found)


def _stall_switches(machine: MachineConfig, home: str) -> Iterator[Switch]:
    """Each motor with a stall detection stops itself, and the first one the motors without. If the
    axis moves several actuators, one of its motors stops them all."""
    motors, pins = steppers_of(machine, home), _stall_pins(machine)
    first, *others = watched_motors(machine, home)
    if len({machine.driven_by(name) for name in motors}) > 1:
        others = [name for name in motors if name in pins and name != first]
        also = tuple(map(_stall_name, others))
        yield Switch(*(_stall_name(first), home, pins[first], motors, home), (first, *others), also)
        return
    rest = [name for name in motors if name not in pins]
    for name in (first, *others):
        stopped = (name, *rest) if name == first else (name,)
        label = name if others else home
        yield Switch(_stall_name(name), home, pins[name], stopped, label, (name,))


def _stall_name(motor: str) -> str:
    return f"{motor}_stall"


def _stall_pins(machine: MachineConfig) -> dict[str, str]:
    """The pins of the stall detections, as written, by motor."""
    return {
        name: stepper.tmc.stall_pin
        for name, stepper in machine.steppers.items()
        if stepper.tmc and stepper.tmc.stall_pin
    }


def endstop_pins(machine: MachineConfig) -> dict[str, str]:
    """The pins of all endstops and of a probe with a pin, as written, by the names of the
    endstops."""
    found = {
        switch.name: switch.pin
        for switch in inputs(machine)
        if switch.name != PROBE or isinstance(machine.probe, SwitchProbe)
    }
    also = {name for switch in switches(machine) for name in switch.also}
    further = {_stall_name(motor): pin for motor, pin in _stall_pins(machine).items()}
    return found | {name: pin for name, pin in further.items() if name in also}


def probe_switch(machine: MachineConfig, axes: Iterable[str] = "z") -> Switch | None:
    """The probe as an endstop that stops every motor of these axes, by default of those that lift
    the nozzle."""
    if not isinstance(machine.probe, SensingProbe):
        return None
    steppers = dict.fromkeys(s for axis in axes for s in steppers_of(machine, axis))
    return Switch(PROBE, "z", machine.probe.wired_at, tuple(steppers))


def inputs(machine: MachineConfig) -> tuple[Switch, ...]:
    """All endstops, and the probe, which may stop any motor of X, Y and Z."""
    probe = probe_switch(machine, "xyz")
    return (*switches(machine), probe) if probe else switches(machine)


def motors_of_actuators(machine: MachineConfig) -> tuple[str, ...]:
    """The first motor of each actuator."""
    return _first_motors(machine, "actuator")


def motors_of_extruders(machine: MachineConfig) -> tuple[str, ...]:
    """The first motor of each extruder."""
    return _first_motors(machine, "extruder")


def _first_motors(machine: MachineConfig, drive: str) -> tuple[str, ...]:
    found: dict[int, str] = {}
    for name in machine.steppers:
        driven = machine.driven_by(name)
        if driven is not None and driven.drive == drive:
            found.setdefault(driven.index, name)
    return tuple(found[i] for i in sorted(found))


def steppers_of(machine: MachineConfig, home: str) -> tuple[str, ...]:
    """The motors that move with an axis, or with an actuator that homes by its own endstop."""
    axes = axis_order(machine.axes)
    actuators = machine.geometry.actuators
    if home in axes[3:]:
        wanted = {("axis", axes.index(home))}
    elif is_actuator(machine, home):
        wanted = {("actuator", actuators.index(home))}
    else:
        at = machine.home_point
        before = machine.geometry.square.inverse(at)
        k = axes.index(home)
        after = machine.geometry.square.inverse(_moved(at, k, -_NUDGE))
        moves = zip(before, after, strict=True)
        moved = [i for i, (q0, q1) in enumerate(moves) if abs(q1 - q0) > _NUDGE / 100]
        wanted = {("actuator", i) for i in moved}
    names: list[str] = []
    for name in machine.steppers:
        driven = machine.driven_by(name)
        if driven is not None and (driven.drive, driven.index) in wanted:
            names.append(name)
    return tuple(names)


def homed_axes(machine: MachineConfig) -> set[str]:
    """The axes that are homed by endstops."""
    own = {name for name in machine.homing if not is_actuator(machine, name)}
    return own | set(machine.axes_of_arms)


def named_axes(machine: MachineConfig, letters: str) -> set[str]:
    """The axes that G28 homes for these letters; without letters, all axes that are homed by
    default. Arms home together."""
    axes, homing = axis_order(machine.axes), machine.homing
    names = {name for name in axes if name.upper() in letters}
    names = names or {name for name in axes if name not in homing or homing[name].by_default}
    return names | (set(machine.axes_of_arms) if names & set(machine.axes_of_arms) else set())


def axes_lost(machine: MachineConfig, steppers: Collection[str]) -> set[str]:
    """The axes with an endstop that lose their positions when these motors are switched off."""
    lost = set[str]()
    for name in machine.homing:
        if set(steppers) & set(steppers_of(machine, name)):
            lost.update(machine.axes_of_arms if is_actuator(machine, name) else [name])
    return lost


def named_motors(machine: MachineConfig, text: str) -> list[str]:
    """The motors that M18 or M84 names by letters of axes, actuators or E; without letters, all
    motors."""
    letters = list(takewhile(lambda letter: letter != "S", letters_of(text)))
    if not letters:
        return list(machine.steppers)
    axes = axis_order(machine.axes)
    found: list[str] = []
    for letter in letters:
        name = letter.lower()
        if name in axes:
            found += steppers_of(machine, name)
        elif name == "e":
            found += [
                s for s in machine.steppers if (d := machine.driven_by(s)) and d.drive == "extruder"
            ]
        elif name in machine.steppers:
            found.append(name)
    return found


def is_actuator(machine: MachineConfig, home: str) -> bool:
    """Whether `home` names an arm or a carriage rather than an axis."""
    return home in machine.geometry.arms


def pressed_point(machine: MachineConfig, switch: Switch) -> Point:
    """The nozzle position, mm, at which the endstop of an axis triggers while all other axes are at
    home."""
    x, y, z = (
        machine.homing[name].position if name == switch.home else at
        for name, at in zip("xyz", machine.home_point, strict=True)
    )
    return x, y, z


def _moved(point: Point, k: int, by: float) -> Point:
    x, y, z = (p + by if i == k else p for i, p in enumerate(point))
    return x, y, z


def weights_of(machine: MachineConfig, switch: Switch) -> tuple[tuple[str, float], ...]:
    """The weights of the motor positions whose weighted sum is the distance to an endstop, near
    home; one motor for each actuator. A motor that does not move with the axis may have a weight:
    X of a hybrid CoreXY is A + Y."""
    axes, name = axis_order(machine.axes), switch.home
    if is_actuator(machine, name) or name in axes[3:] or switch.label != name:
        return ((switch.steppers[0], 1.0),)
    geometry = machine.geometry.square
    q, k = geometry.inverse(pressed_point(machine, switch)), axes.index(name)
    weights: list[tuple[str, float]] = []
    for motor in motors_of_actuators(machine):
        if (driven := machine.driven_by(motor)) is not None:
            nudged = [[*q], [*q]]
            for joints, by in zip(nudged, (_NUDGE, -_NUDGE), strict=True):
                joints[driven.index] += by
            above, below = map(geometry.forward, nudged)
            if weight := round((above[k] - below[k]) / (2 * _NUDGE), 9):
                weights.append((motor, weight))
    return tuple(weights)
