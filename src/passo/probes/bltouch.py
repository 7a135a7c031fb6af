"""BLTouch and 3DTouch: a coil moves a pin, on command of servo pulses. The pulse widths are those
of Antclabs' BLTouch. At a touch the pin retracts by itself, and the output is high for about 10 ms.
In touch mode the output is a level: high while the pin is retracted or touches.
"""

from __future__ import annotations

from typing import Literal

from passo.config.types import Pin
from passo.probes.base import Head, Mechanism, SwitchProbe, not_deployed, not_stowed

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
_MOVE_S = 0.68  # of the pin, to deploy or stow
_TRIES = 3


class BLTouch(SwitchProbe):
    """A BLTouch or a 3DTouch. Before a run, Passo verifies that the pin is stowed, that the output
    reports it, and that the pin can be deployed; after each descent, that the pin is stowed
    again."""

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
        """The pulses that stow the pin."""
        return PIN_UP, _MOVE_S

    async def deploy(self, head: Head) -> None:
        """Verifies the sensor. The pin itself is deployed before each descent."""
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
        """Deploys the pin. If the output stays high, which is an alarm, the alarm is reset once."""
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
        """Stows the pin."""
        if not self.touch_mode:
            await head.pulse(PIN_UP, _MOVE_S)

    async def stow(self, head: Head) -> None:
        """Stows the pin, and verifies it."""
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
