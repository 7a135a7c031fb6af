"""APrinter's run-time options that Passo supports; docs/reference/options.md lists all."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, NamedTuple

from passo import _core
from passo.board.configuration import SENSOR_PERIOD_S
from passo.board.description import inverted
from passo.config import platinum
from passo.config.sensor_tables import sensor_table
from passo.config.sensors import Platinum, PlatinumAmplifier, Thermistor
from passo.heat.rules import FULL_POWER
from passo.motion.endstop_search import SLOW_OVERRUN
from passo.printer.commands.extruder_words import extruders
from passo.probes.base import SensingProbe

if TYPE_CHECKING:
    from passo.printer.settings import Settings

_KINDS = {"hotend": "ExtruderHeater", "bed": "BedHeater", "chamber": "ChamberHeater"}


class Option(NamedTuple):
    """An option: its current value, and the command that sets it, with `{}` for the value; empty if
    only the machine file sets it."""

    name: str
    value: Callable[[], float]
    command: str = ""
    scale: float = 1.0  # from the option's unit to the command's


def options(settings: Settings) -> Iterator[Option]:
    """All options of a printer, in APrinter's units: mm, s, °C, mA, steps."""
    machine = settings.rig.machine
    yield Option("InactiveTime", lambda: settings.outputs.motors.idle_s, "M84 S{}")
    for axis in machine.axes:
        yield from _axis(settings, axis)
    for tool, extruder in extruders(settings.rig.machine):
        yield from _limits(settings, extruder, extruder.upper(), f" {tool}E")
    for name in machine.drivable.by_name:
        yield from _motors(settings, name)
    for name in machine.homing:
        yield from _homing(settings, name)
    for name, value in machine.geometry.options().items():
        yield Option(name, lambda value=value: value)
    for name in machine.heaters:
        yield from _heater(settings, name)
        yield from _sensor(settings, name)
    yield from _probe(settings)
    yield from _moves(settings)
    laser = machine.laser
    if laser is not None:
        letter = laser.density_letter or laser.energy_letter or "L"
        yield Option(f"{letter}LaserPower", lambda: laser.power_w)
        yield Option(f"{letter}MaxPower", lambda: laser.max_power_w or laser.power_w)


# -- motion ---------------------------------------------------------------------------------------


def _limits(settings: Settings, name: str, prefix: str, words: str) -> Iterator[Option]:
    """The options for limits of an axis or extruder; `words` select it in a command."""
    for suffix, what, code in (("MaxSpeed", "speed", "M203"), ("MaxAccel", "accel", "M201")):
        yield Option(
            f"{prefix}{suffix}",
            lambda what=what: settings.rig.job.limits.of_axis(name, what),
            f"{code}{words}{{}}",
        )


def _axis(settings: Settings, name: str) -> Iterator[Option]:
    axis, letter = settings.rig.machine.axes[name], name.upper()
    yield from _limits(settings, name, letter, f" {letter}")
    yield Option(f"{letter}CorneringDistance", lambda: axis.cornering_distance_steps)
    if axis.extruder:
        return
    yield Option(f"{letter}MinPos", lambda: axis.min_mm)
    yield Option(f"{letter}MaxPos", lambda: axis.max_mm)
    offsets = settings.motion.offsets.home_mm
    yield Option(f"{letter}HomeOffset", lambda: offsets[name], f"M206 {letter}{{}}")


def _motors(settings: Settings, name: str) -> Iterator[Option]:
    """The options of the motors of an actuator, axis or extruder; the second motor is APrinter's
    slave 1."""
    machine, letter = settings.rig.machine, name.upper()
    words = {extruder: f"{tool}E" for tool, extruder in extruders(settings.rig.machine)}
    if name in machine.extruders and name not in words:
        return  # no tool uses this extruder
    word = words.get(name, letter)
    yield Option(
        f"{letter}StepsPerUnit", lambda: settings.motion.settings.scale_of(name), f"M92 {word}{{}}"
    )
    driven = machine.drivable.by_name[name]
    pushing = settings.outputs.motors.named("E")
    motors = [motor for motor in machine.steppers if machine.driven_by(motor) == driven]
    for k, motor in enumerate(motors):
        prefix = f"{letter}S{k}" if k else letter
        stepper = machine.steppers[motor]
        yield Option(f"{prefix}InvertDir", lambda stepper=stepper: float(stepper.invert))
        current = f"T{pushing.index(motor)} E" if motor in pushing else letter
        if motor in settings.drivers.states:
            yield Option(
                f"{prefix}Current",
                lambda motor=motor: 1000 * settings.drivers.states[motor].settings.run_a,
                "" if k else f"M906 {current}{{}}",
            )
    stepper = machine.steppers[motors[0]]
    if name not in machine.axes:
        for suffix, given in (
            ("MinPos", (stepper.min_mm, stepper.min_deg)),
            ("MaxPos", (stepper.max_mm, stepper.max_deg)),
            ("MaxSpeed", (stepper.speed_mm_s, stepper.speed_deg_s)),
            ("MaxAccel", (stepper.accel_mm_s2, stepper.accel_deg_s2)),
        ):
            value = next((v for v in given if v is not None), None)
            if value is not None:
                yield Option(f"{letter}{suffix}", lambda value=value: value)


def _homing(settings: Settings, name: str) -> Iterator[Option]:
    homing, prefix = settings.rig.machine.homing[name], f"{name.upper()}Home"
    pins = [homing.pin, *homing.stepper_pins.values()]
    low = any(inverted(pin) for pin in pins if pin is not None)
    for suffix, value in (
        ("ByDefault", homing.by_default),
        ("Dir", homing.direction == "max"),
        ("EndInvert", low),
        ("FastMaxDist", settings.motion.homer.travel(name)),
        ("RetractDist", homing.retract),
        ("SlowMaxDist", SLOW_OVERRUN * homing.retract),
        ("FastSpeed", homing.fast),
        ("RetractSpeed", homing.fast),
        ("SlowSpeed", homing.slow),
    ):
        yield Option(f"{prefix}{suffix}", lambda value=value: float(value))


# -- heat -----------------------------------------------------------------------------------------


def _prefix(settings: Settings, name: str) -> str:
    heaters = settings.rig.machine.heaters
    kind = heaters[name].kind
    return f"{_KINDS[kind]}{[n for n, h in heaters.items() if h.kind == kind].index(name)}"


def _heater(settings: Settings, name: str) -> Iterator[Option]:
    config, prefix = settings.rig.machine.heaters[name], _prefix(settings, name)
    number = settings.heat.controls.number_of(name)
    yield Option(f"{prefix}MinSafeTemp", lambda: config.min_c)
    yield Option(f"{prefix}MaxSafeTemp", lambda: config.max_c)
    yield Option(f"{prefix}ControlInterval", lambda: SENSOR_PERIOD_S)
    if config.kind == "hotend":
        yield Option(
            f"{prefix}MinExtrusionTemp", lambda: settings.heat.settings.cold.cold_c, "M302 S{}"
        )
    wired = next(h for h in settings.rig.connection.board.heaters if h.name == name)
    yield Option(f"{prefix}ObserverInterval", lambda: SENSOR_PERIOD_S)
    yield Option(f"{prefix}ObserverTolerance", lambda: wired.arrival.window_c)
    yield Option(f"{prefix}ObserverMinTime", lambda: wired.arrival.seconds)
    if config.control.kind != "pid":
        return
    for suffix, letter, key in (("Min", "A", "drive_min"), ("Max", "B", "drive_max")):
        yield Option(
            f"{prefix}PidIState{suffix}",
            lambda key=key: _of_pid(settings, name, key),
            "" if number is None else f"M306 H{number} {letter}{{}}",
            FULL_POWER,
        )
    share = config.control.filter_s / (SENSOR_PERIOD_S + config.control.filter_s)
    yield Option(f"{prefix}PidDHistory", lambda: share)
    for letter, key in (("P", "kp"), ("I", "ki"), ("D", "kd")):
        yield Option(
            f"{prefix}Pid{letter}",
            lambda key=key: _of_pid(settings, name, key) / FULL_POWER,
            "" if number is None else f"M301 H{number} {letter}{{}}",
            FULL_POWER,
        )


def _of_pid(settings: Settings, name: str, key: str) -> float:
    control = settings.heat.controls.control(name)
    return float(getattr(control, key)) if isinstance(control, _core.PidControl) else 0.0


def _sensor(settings: Settings, name: str) -> Iterator[Option]:
    """The options of a sensor. Those of a thermistor can be set; those of a platinum resistor are
    given by its standard."""
    prefix, sensors = _prefix(settings, name), settings.heat.controls.sensors
    sensor, number = sensors[name], settings.heat.controls.number_of(name)
    if isinstance(sensor, Thermistor):
        for option, letter, key in (
            ("TempR0", "A", "r25_ohm"),
            ("TempBeta", "B", "beta_k"),
            ("TempResistorR", "R", "pullup_ohm"),
        ):
            yield Option(
                f"{prefix}{option}",
                lambda key=key: float(getattr(sensors[name], key)),
                "" if number is None else f"M305 H{number} {letter}{{}}",
            )
    elif isinstance(sensor, Platinum | PlatinumAmplifier):
        yield Option(f"{prefix}TempResistorR", lambda: sensor.pullup_ohm)
        yield Option(f"{prefix}TempPtR0", lambda: sensor.r0_ohm)
        yield Option(f"{prefix}TempPtA", lambda: platinum.A_PER_C)
        yield Option(f"{prefix}TempPtB", lambda: platinum.B_PER_C2)
    yield Option(f"{prefix}TempMinTemp", lambda: sensor_table(sensors[name])[0][0])
    yield Option(f"{prefix}TempMaxTemp", lambda: sensor_table(sensors[name])[-1][0])


# -- probe ----------------------------------------------------------------------------------------


def _probe(settings: Settings) -> Iterator[Option]:
    """The options of the probe. Their signs are opposite to those of other firmwares: APrinter adds
    ProbeOffset to a point, and ProbeGeneralZOffset to a height."""
    probe, prober, levelling = (
        settings.rig.machine.probe,
        settings.motion.prober,
        settings.levelling.bed,
    )
    if probe is None:
        return
    for index, letter in enumerate("XY"):
        yield Option(
            f"ProbeOffset{letter}",
            lambda index=index: -prober.offset_mm[index],
            f"M851 {letter}{{}}",
            -1.0,
        )
    yield Option("ProbeGeneralZOffset", lambda: -prober.trigger_height_mm, "M851 Z{}")
    if isinstance(probe, SensingProbe):
        yield Option("ProbeStartHeight", lambda: probe.start_mm)
        yield Option("ProbeLowHeight", lambda: probe.low_mm)
        yield Option("ProbeRetractDist", lambda: probe.retract_mm)
        yield Option("ProbeMoveSpeed", lambda: probe.travel_mm_s)
        yield Option("ProbeFastSpeed", lambda: probe.fast_mm_s)
        yield Option("ProbeRetractSpeed", lambda: probe.lift_mm_s)
        yield Option("ProbeSlowSpeed", lambda: probe.slow_mm_s)
    for n in range(1, len(levelling.points) + 1):
        for suffix, key, word in (
            ("X", "x", "X"),
            ("Y", "y", "Y"),
            ("ZOffset", "offset", "OFFSET"),
            ("Enabled", "enabled", "ENABLED"),
        ):
            yield Option(
                f"ProbeP{n}{suffix}",
                lambda n=n, key=key: float(getattr(levelling.points[n - 1], key)),
                f"SET_PROBE_POINT N={n} {word}={{}}",
            )


# -- predefined moves -----------------------------------------------------------------------------


def _moves(settings: Settings) -> Iterator[Option]:
    """APrinter numbers the moves from 1."""
    moves = settings.motion.predefined.moves
    for n, (name, move) in enumerate(moves.items(), 1):
        yield Option(
            f"Move{n}Enabled",
            lambda name=name: float(moves[name].enabled),
            f"SET_MOVE NAME={name} ENABLED={{}}",
        )
        yield Option(
            f"Move{n}Speed",
            lambda name=name: moves[name].speed_mm_s,
            f"SET_MOVE NAME={name} SPEED={{}}",
        )
        for axis in move.position_mm:
            yield Option(
                f"Move{n}{axis.upper()}",
                lambda name=name, axis=axis: moves[name].position_mm[axis],
                f"SET_MOVE NAME={name} {axis.upper()}={{}}",
            )
