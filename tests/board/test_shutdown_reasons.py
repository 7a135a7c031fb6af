"""A board's reason for its shutdown, in words that a user can act on."""

from __future__ import annotations

import asyncio

import pytest

from passo.board.faults import shutdown_error
from passo.clock import ScaledLoop, VirtualLoop, time_scale

LATE = "Missed scheduling of next digital out event"


@pytest.mark.parametrize("reason", [LATE, "Timer too close", "Stepper too far in past"])
def test_late_commands_are_explained_by_a_slow_computer(reason):
    assert str(shutdown_error(reason, reason, 20.0)) == (
        f"the board shut down: {reason}. Commands reached it after their time: this computer was"
        " too slow for --clock 20. End other programs or use a lower --clock, then send M999."
    )
    real = str(shutdown_error(reason, f"{reason} (board tool)", 1.0))
    assert real == (
        f"the board shut down: {reason} (board tool). Commands reached it after their time: this"
        " computer was too slow or too busy. End other programs or use a faster computer or a"
        " better cable, then send M999."
    )


@pytest.mark.parametrize(
    ("reason", "says"),
    [
        ("ADC out of range", "A temperature sensor reads outside of its heater's min_c to max_c."),
        ("Rescheduled timer in the past", "Its processor was overloaded."),
        ("I2C START NACK", "A device on I2C, such as an accelerometer or a sensor, did not"),
        ("Command request", "Remove the cause, then start again or send M999."),
        ("anything else", "Remove the cause, then start again or send M999."),
    ],
)
def test_unknown_reasons_have_an_action(reason, says):
    text = str(shutdown_error(reason, reason, 1.0))
    assert text.startswith(f"the board shut down: {reason}. {says}")
    assert text.endswith("send M999.")


@pytest.mark.parametrize(("make", "scale"), [(lambda: ScaledLoop(20.0), 20.0), (VirtualLoop, 1.0)])
def test_print_time_scale_comes_from_the_running_loop(make, scale):
    async def asked() -> float:
        return time_scale()

    loop: asyncio.AbstractEventLoop = make()
    try:
        assert loop.run_until_complete(asked()) == scale
    finally:
        loop.close()
    assert time_scale() == 1.0
