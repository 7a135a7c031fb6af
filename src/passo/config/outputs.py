"""Outputs that commands switch: lights, relays, pumps, and pins that are set once."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from passo.config.types import Fraction, Model, PartName, Pin, Positive


class Output(Model):
    """An output for SET_PIN and M42. It changes in order with the moves, as fans do."""

    pin: Pin
    """The output."""
    further_pins: Annotated[list[Pin], Field(max_length=8)] = []
    """Further outputs of the same board, which switch together with `pin`."""
    pwm: Literal["none", "software", "hardware"] = "none"
    """Whether the output is only on or off, or is pulsed by the board's software or hardware."""
    pwm_hz: Annotated[float, Field(ge=0.1, le=100_000)] = 10.0
    """Pulses per second of an output with `pwm`."""
    start: Fraction = 0.0
    """The value after the start, as a fraction of fully on."""
    at_halt: Fraction = 0.0
    """The value while the board is shut down, as a fraction of fully on. If the link is lost, the
    output keeps its value, unless `max_on_s` is set."""
    max_on_s: Annotated[float, Field(ge=0, le=5)] = 0.0
    """The board switches to `at_halt` if the host has not renewed the output for this time.
    Firmware of Klipper also shuts down. 0: never."""
    scale: Positive = 1.0
    """VALUE of SET_PIN that means fully on."""
    number: Annotated[int, Field(ge=0, le=255)] | None = None
    """P of M42. If not given, M42 does not set this output."""
    fixed: bool = False
    """Whether the output keeps its `start`: no command sets it, and clients do not show it."""
    use: Literal["light", "camera"] | None = None
    """The command that sets this output, too: M355 a `light`; M240 switches a `camera` on for
    0.1 s."""


Outputs = dict[PartName, Output]


_FURTHER = "+"  # between the name of an output and the number of a further pin


def further_name(output: str, index: int) -> str:
    """The name of an output's further pin, the first of which has the index 0."""
    return f"{output}{_FURTHER}{index + 1}"


def first_name(output: str) -> str:
    """The name of the output to which a further pin belongs; that of the output itself."""
    return output.partition(_FURTHER)[0]


def timed_name(output: str) -> str:
    """The name of an output among those on the timeline, where heaters and fans have theirs."""
    return f"outputs.{output}"
