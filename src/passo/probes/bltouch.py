"""BLTouch and 3DTouch: a pin that a coil puts out, commanded by the pulses of a servo.

The widths are those of Antclabs' BLTouch. At a touch the pin draws back by itself, and the output
is high for some 10 ms. In touch mode it is a level: high while the pin is in or touches.
"""

from __future__ import annotations

from typing import Literal

from passo.config.types import Pin
from passo.probes.base import Head, Mechanism, SensingProbe, not_deployed, not_stowed

PIN_DOWN, TOUCH_MODE, PIN_UP = 650.0, 1165.0, 1475.0  # µs
SELF_TEST, STORE, SET_5V, SET_OD, RESET = 1780.0, 1884.0, 1988.0, 2091.0, 2190.0
COMMANDS = {
    "pin_down": PIN_DOWN,
    "touch_mode": TOUCH_MODE,
    "pin_up": PIN_UP,
    "self_test": SELF_TEST,
    "set_5V_output_mode": SET_5V,
    "set_OD_output_mode": SET_OD,
    "output_mode_store": STORE,
    "reset": RESET,
}
"""Pulses, µs, by the names of Klipper's BLTOUCH_DEBUG."""
_COMMAND_S = 0.1  # five pulses
_MOVE_S = 0.68  # of the pin, out or in
_TRIES = 3


class BLTouch(SensingProbe):
    """A BLTouch or a 3DTouch. Passo verifies before a run that its pin is up, that it is felt, and
    that it gets down, and after each descent that it is up again."""

    kind: Literal["bltouch"]
    """BLTouch or 3DTouch."""
    control_pin: Pin
    """The output of its servo signal, on the board of `pin`."""
    touch_mode: bool = False
    """Measures with the pin's level in place of its pulse of 10 ms; the pin stays out between the
    samples of a point."""
    verify: bool = True
    """Whether the probe shows in touch mode that its pin is up or down. Some copies do not."""
    output: Literal["5v", "od"] | None = None
    """The mode of its output, which Passo stores in a BLTouch 3.1 at the first deployment: 5 V, or
    open drain. If not given, it stays as it is."""

    @property
    def servo_pin(self) -> str:
        """The output of its signal."""
        return self.control_pin

    @property
    def mechanism(self) -> Mechanism:
        """A BLTouch."""
        return Mechanism("bltouch")

    def start_pulse(self) -> tuple[float, float]:
        """The pin is put up."""
        return PIN_UP, _MOVE_S

    async def deploy(self, head: Head) -> None:
        """Verifies the sensor; the pin goes out before each descent."""
        if self.output:
            for width in (SET_5V if self.output == "5v" else SET_OD, STORE):
                await head.pulse(width, _COMMAND_S)
        await self._put_up(head)
        if not self.verify:
            return
        await head.pulse(TOUCH_MODE, _COMMAND_S)
        if not head.triggered():
            raise not_deployed("open", "triggered in touch mode with its pin up")
        await head.pulse(PIN_DOWN, _MOVE_S)
        await head.pulse(TOUCH_MODE, _COMMAND_S)
        if head.triggered():
            await head.pulse(RESET, _COMMAND_S)
            raise not_deployed("triggered", "open in touch mode with its pin down")

    async def arm(self, head: Head) -> None:
        """Puts the pin out. An alarm, which keeps the output high, is released once."""
        for left in (1, 0):
            await head.pulse(PIN_DOWN, _MOVE_S)
            if self.touch_mode:
                await head.pulse(TOUCH_MODE, _COMMAND_S)
            if not head.triggered():
                return
            if left:
                await head.pulse(RESET, _COMMAND_S)
                await head.sleep(1.0)
        raise not_deployed("triggered", "open with its pin down; its lamp blinks in an alarm")

    async def disarm(self, head: Head) -> None:
        """Puts the pin up."""
        if not self.touch_mode:
            await head.pulse(PIN_UP, _MOVE_S)

    async def stow(self, head: Head) -> None:
        """Puts the pin up, and verifies that."""
        await self._put_up(head)

    async def _put_up(self, head: Head) -> None:
        for left in range(_TRIES, 0, -1):
            await head.pulse(PIN_UP, _MOVE_S)
            if not head.triggered():
                return
            if left > 1:
                await head.pulse(RESET, _COMMAND_S)
                await head.sleep(1.0)
        raise not_stowed("triggered", f"open with its pin up, in {_TRIES} attempts")
