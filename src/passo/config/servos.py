"""Servos that commands turn."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated, Any

from pydantic import Field

from passo.config.findings import Finding, number, tables
from passo.config.types import Model, PartName, Pin

SERVO_CYCLE_S = 0.02
"""The interval of the pulses of all servos."""

_Pulse = Annotated[float, Field(ge=100, le=3000)]


class Servo(Model):
    """A servo: an output with a pulse every 20 ms, whose length sets the angle."""

    pin: Pin
    """The output of the servo's signal."""
    min_pulse_us: _Pulse = 1000.0
    """The length of the pulses at 0°."""
    max_pulse_us: _Pulse = 2000.0
    """The length of the pulses at `max_deg`."""
    max_deg: Annotated[float, Field(gt=0, le=360)] = 180.0
    """The largest angle."""
    start_deg: Annotated[float, Field(ge=0, le=360)] | None = None
    """The angle after the start. If not given, the servo has no signal until a command turns it."""
    number: Annotated[int, Field(ge=0, le=255)] | None = None
    """P of M280. If not given, M280 does not turn this servo."""

    def width_us(self, degrees: float) -> float:
        """The length of the pulses for an angle."""
        return self.min_pulse_us + degrees / self.max_deg * (self.max_pulse_us - self.min_pulse_us)


Servos = dict[PartName, Servo]


def servo_output(name: str) -> str:
    """The name of a servo's output on the timeline."""
    return f"servos.{name}"


def share_of(width_us: float) -> float:
    """The fraction of the cycle for which a pulse of this length is on."""
    return width_us * 1e-6 / SERVO_CYCLE_S


def check_servos(data: Mapping[str, Any]) -> Iterator[Finding]:
    """Checks the ranges of servos, and that their numbers differ."""
    owners: dict[float, str] = {}
    for name, servo in tables(data, "servos"):
        path = ("servos", name)
        least, most = number(servo, "min_pulse_us"), number(servo, "max_pulse_us")
        if (least or 1000.0) >= (most or 2000.0):
            limit = "more than min_pulse_us"
            yield Finding("config.value", (*path, "max_pulse_us"), most or 2000.0, limit)
        start, end = number(servo, "start_deg"), number(servo, "max_deg") or 180.0
        if start is not None and start > end:
            yield Finding("config.value", (*path, "start_deg"), start, f"at most max_deg, {end:g}")
        own = number(servo, "number")
        owner = name if own is None else owners.setdefault(own, name)
        if owner != name:
            limit = f"a number of its own: it belongs to servos.{owner}"
            yield Finding("config.conflict", (*path, "number"), own, limit)
