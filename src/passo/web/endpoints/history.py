"""The history of the printer, as recorded by the server."""

from __future__ import annotations

import time
from typing import Annotated

from msgspec import Meta, Struct

from passo.web.call import Call
from passo.web.operation import operation
from passo.web.roles import Role


class Span(Struct):
    """The length of the requested history, in seconds."""

    span_s: Annotated[float, Meta(gt=0, le=86400)] = 3600.0


class HeaterPast(Struct):
    """The values of a heater, one for each time; null if the sensor had not reported."""

    celsius: list[float | None]
    target_c: list[float | None]
    power: list[float | None]


class Temperatures(Struct):
    """`ages_s` are the times of the samples, in seconds before the answer, oldest first; `sensors`
    are the temperatures of the sensors without a heater, °C."""

    ages_s: list[float]
    heaters: dict[str, HeaterPast]
    sensors: dict[str, list[float | None]]


@operation("history.temperatures", "GET", "/history/temperatures", Role.VIEWER)
async def temperatures(call: Call, query: Span) -> Temperatures:
    """Temperatures, targets and power of all heaters, and other temperatures: one sample per second
    for the last 15 minutes, and one every 15 s for the day before."""
    now_s = time.monotonic()
    samples = call.site.temperatures.since(now_s - query.span_s)
    return Temperatures(
        ages_s=[round(now_s - sample.host_s, 2) for sample in samples],
        heaters={
            name: HeaterPast(
                [_rounded(sample.heaters[name].celsius, 2) for sample in samples],
                [_rounded(sample.heaters[name].target_c, 2) for sample in samples],
                [_rounded(sample.heaters[name].power, 3) for sample in samples],
            )
            for name in call.bridge.machine.heaters
        },
        sensors={
            name: [_rounded(sample.sensors.get(name), 2) for sample in samples]
            for name in call.bridge.machine.sensors
        },
    )


def _rounded(value: float | None, digits: int) -> float | None:
    return None if value is None else round(value, digits)
