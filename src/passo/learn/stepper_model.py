"""A stepper motor with its driver and a carriage on a belt, as a rotor that follows a field."""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot, pi, sin, sqrt, tanh

from passo.config.trinamic.known_motors import known_motors

TRAVEL_MM = 40.0  # of the belt in a rotation: 20 teeth of 2 mm
RADIUS_M = TRAVEL_MM / 1000 / (2 * pi)
TEETH = 50  # of the rotor: cycles of the currents in a rotation
CYCLE_MM = TRAVEL_MM / TEETH
_MOTOR = known_motors()["ldo-42sth40-2004mah"]
_ROTOR_KGM2 = 5.4e-6
_DAMPING = 0.1  # of the critical one
_STEP_S = 2e-4
_SETTLE_S = 0.15  # after the last step
_STICK_RAD_S = 0.5  # below this speed friction falls
_POINTS = 250


@dataclass(frozen=True, slots=True)
class Drive:
    """Motor, driver and carriage. `current_a` is the peak of a coil."""

    current_a: float
    supply_v: float
    mass_kg: float
    drag_n: float

    @property
    def torque_per_a(self) -> float:
        """With the rated current in both coils the motor has its holding torque."""
        return _MOTOR["holding_torque_nm"] / (sqrt(2) * _MOTOR["max_current_a"])

    @property
    def inertia_kgm2(self) -> float:
        """Of the rotor and the carriage, at the shaft."""
        return _ROTOR_KGM2 + self.mass_kg * RADIUS_M**2

    def pull_out_nm(self, rad_s: float) -> float:
        """The largest torque at a speed: that of the current, or what the supply leaves of it
        against the inductance of the coils and the voltage that the rotor induces."""
        ohm, henry = _MOTOR["resistance_ohm"], _MOTOR["inductance_mh"] / 1000
        impedance = hypot(ohm, TEETH * rad_s * henry)
        induced_v = self.torque_per_a * rad_s
        possible_a = self.supply_v / impedance - induced_v * ohm / impedance**2
        return self.torque_per_a * max(0.0, min(self.current_a, possible_a))


@dataclass(frozen=True, slots=True)
class Move:
    """A move from rest to rest. The obstacle pushes while the steps are within `obstacle_mm`."""

    length_mm: float
    acceleration_mm_s2: float
    speed_mm_s: float
    obstacle_mm: tuple[float, float]

    @property
    def ramp_s(self) -> float:
        """The time until it has its speed."""
        return self.speed_mm_s / self.acceleration_mm_s2

    @property
    def end_s(self) -> float:
        """The time of the move."""
        return self.ramp_s + self.length_mm / self.speed_mm_s

    def at(self, t: float) -> tuple[float, float]:
        """Position, mm, and speed, mm/s, of the steps at a time."""
        a = self.acceleration_mm_s2
        if t < self.ramp_s:
            return a * t * t / 2, a * t
        if t < self.end_s - self.ramp_s:
            return self.speed_mm_s * (t - self.ramp_s / 2), self.speed_mm_s
        left_s = max(0.0, self.end_s - t)
        return self.length_mm - a * left_s**2 / 2, a * left_s


def shaft_rad(mm: float) -> float:
    """The angle of the shaft for a distance; also for a speed or an acceleration."""
    return 2 * pi * mm / TRAVEL_MM


def run(
    drive: Drive, move: Move, obstacle_n: float
) -> tuple[list[float], list[float], list[float]]:
    """Time, and position in mm of the steps and of the carriage, during a move and shortly after
    it."""
    inertia, friction_nm = drive.inertia_kgm2, drive.drag_n * RADIUS_M
    damping = 2 * _DAMPING * sqrt(inertia * TEETH * drive.pull_out_nm(0.0))
    count = int((move.end_s + _SETTLE_S) / _STEP_S)
    every = max(1, count // _POINTS)
    low_mm, high_mm = move.obstacle_mm
    times: list[float] = []
    ideal: list[float] = []
    real: list[float] = []
    angle = speed = 0.0
    for i in range(count):
        t = i * _STEP_S
        want_mm, want_mm_s = move.at(t)
        want, want_rad_s = shaft_rad(want_mm), shaft_rad(want_mm_s)
        if i % every == 0:
            times.append(t)
            ideal.append(want_mm)
            real.append(angle * TRAVEL_MM / (2 * pi))
        against = friction_nm + (obstacle_n * RADIUS_M if low_mm < want_mm < high_mm else 0.0)
        torque = drive.pull_out_nm(want_rad_s) * sin(TEETH * (want - angle))
        torque -= against * tanh(speed / _STICK_RAD_S) + damping * (speed - want_rad_s)
        speed += torque / inertia * _STEP_S
        angle += speed * _STEP_S
    return times, ideal, real
