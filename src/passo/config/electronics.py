"""What is wired to a board besides motors and heaters: fans, a laser, the mains, a beeper."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from passo.config.types import Fraction, Letter, Model, Name, Pin, Positive


class Fan(Model):
    """A fan; `number` is the P of M106 and M107. The board pulses it in software, `pwm_hz` times a
    second. Its power is at most `max_power`, which is also what is asked for as 1; while it turns
    it is at least `min_power`, below which it would stand still. What is asked for below
    `off_below` is off. To start, and where its power rises by more than `kick_start_rise`, it gets
    `max_power` for `kick_start_s` first. One that `follows` a heater, or motors, hears no commands:
    it is on while the heater is warmer than `above_c`, and while any of the motors is on and for
    `stays_on_s` after that."""

    pin: Pin
    number: Annotated[int, Field(ge=0, le=255)] = 0
    min_power: Fraction = 0.0
    max_power: Fraction = 1.0
    off_below: Fraction = 0.0
    kick_start_s: Annotated[float, Field(ge=0, le=10)] = 0.0
    kick_start_rise: Fraction = 0.5
    follows: Name | None = None
    above_c: Annotated[float, Field(ge=0, le=1200)] = 50.0
    follows_motors: list[Name] = []
    stays_on_s: Annotated[float, Field(ge=0, le=3600)] = 60.0
    pwm_hz: Annotated[float, Field(ge=1, le=1000)] = 10.0

    @property
    def commanded(self) -> bool:
        """It hears M106 and M107."""
        return self.follows is None and not self.follows_motors


class Laser(Model):
    """A laser or a spindle. S of M3 and M4 at full power is `full_scale`. The two letters are
    APrinter's words of a G1 (energy in W·s, density in W·s/mm); only if given do they belong to a
    move. `power_w` is the power of the beam fully on; no move goes faster than it gets its energy
    with `max_power_w`, which is the same by default."""

    pin: Pin
    full_scale: Positive = 255.0
    energy_letter: Letter | None = None
    density_letter: Letter | None = None
    power_w: Positive = 100.0
    max_power_w: Positive | None = None


class Mains(Model):
    """What switches the power supply of motors and heaters: M80 on, M81 off, the board when it
    shuts down."""

    pin: Pin
    on_at_start: bool = True


class Beeper(Model):
    """What sounds at M300: a buzzer without a tone of its own, which the board pulses in
    software."""

    pin: Pin


Fans = dict[Name, Fan]
