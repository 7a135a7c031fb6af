"""A probe on the arm of a servo."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from passo.config.types import Pin
from passo.probes.base import Head, Mechanism, SwitchProbe, not_deployed, not_stowed

_Degrees = Annotated[float, Field(ge=0, le=180)]


class ServoProbe(SwitchProbe):
    """A switch on the arm of a servo. The arm turns down before a measurement and up after it."""

    kind: Literal["servo"]
    """On the arm of a servo."""
    control_pin: Pin
    """The output of the servo's signal, on the board of `pin`."""
    deploy_deg: _Degrees = 70.0
    """The angle of the servo with the probe at the bed; 0° is a pulse of 544 µs, 180° of
    2400 µs."""
    stow_deg: _Degrees = 0.0
    """The angle of the servo with the probe away from the bed."""
    turn_s: Annotated[float, Field(ge=0.1, le=5)] = 0.3
    """How long the servo takes; after that it is without a signal."""
    triggered_when_stowed: bool = False
    """Whether the switch is triggered while it is stowed. Then Passo checks that it is, and that it
    is not at the bed."""

    @property
    def servo_pin(self) -> str:
        """The output of the servo."""
        return self.control_pin

    @property
    def mechanism(self) -> Mechanism:
        """A servo with this switch."""
        return Mechanism(
            "servo",
            self.width_us(self.deploy_deg),
            self.width_us(self.stow_deg),
            stowed_reads=self.triggered_when_stowed,
        )

    def start_pulse(self) -> tuple[float, float]:
        """The pulses that turn the arm up."""
        return self.width_us(self.stow_deg), self.turn_s

    async def deploy(self, head: Head) -> None:
        """Turns the arm down."""
        await head.pulse(self.width_us(self.deploy_deg), self.turn_s)
        if self.triggered_when_stowed and head.triggered():
            raise not_deployed("triggered", f"open with the servo at {self.deploy_deg:g}°")

    async def stow(self, head: Head) -> None:
        """Turns the arm up."""
        await head.pulse(self.width_us(self.stow_deg), self.turn_s)
        if self.triggered_when_stowed and not head.triggered():
            raise not_stowed("open", f"triggered with the servo at {self.stow_deg:g}°")
