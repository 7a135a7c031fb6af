"""Electrical parts other than motors and heaters: fans, a laser, the power supply, a beeper."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from passo.config.types import Fraction, Letter, Model, Name, NotNegative, PartName, Pin, Positive


class Thermostat(Model):
    """A fan that cools the place of a sensor. While the sensor is broken, the fan has its
    `max_power`. A PID has all three gains; without them the fan is on or off."""

    sensor: PartName
    """One of the `sensors`."""
    target_c: Annotated[float, Field(ge=0, le=1200)] = 40.0
    """The fan keeps the sensor below this temperature. 0: the fan is off."""
    hysteresis_c: NotNegative = 2.0
    """Without gains, the fan turns on this far above the target, and off this far below it."""
    kp: Positive | None = None
    """Proportional gain, in 1/255 of full power per °C, as in Klipper."""
    ki: NotNegative | None = None
    """Integral gain, in 1/255 of full power per °C·s."""
    kd: NotNegative | None = None
    """Derivative gain, in 1/255 of full power per °C/s."""
    min_power: Fraction = 0.3
    """The minimum power with a PID, while the target is not 0."""


class Tachometer(Model):
    """The tachometer of a fan: an output of the fan that gives pulses while it turns."""

    pin: Pin
    """The input, on the board of the fan; most fans need `^`, a pull-up."""
    pulses: Annotated[int, Field(ge=1, le=100)] = 2
    """The pulses in a revolution."""
    poll_ms: Annotated[float, Field(ge=0.1, le=100)] = 1.5
    """The time between two looks of the board, ms. The board counts up to 30 000 / `pulses` /
    `poll_ms` rpm: 10 000 with the defaults."""
    min_rpm: Annotated[float, Field(ge=0, le=100_000)] = 0.0
    """The fan has a fault if it turns slower for 3 s while it has power. A fan that follows a
    heater must turn only while the heater is above `above_c`. 0: no fault."""
    on_fault: Literal["machine", "job", "report"] = "report"
    """Whether a fault halts the printer, pauses the print, or is only reported."""
    simulated_rpm: Annotated[float, Field(gt=0, le=100_000)] = 5000.0
    """The revolutions per minute at full power on the simulated printer."""


class Fan(Model):
    """A fan. The board pulses its output in software."""

    pin: Pin
    """The output. If not given, the output that the board has for such a fan."""
    further_pins: Annotated[list[Pin], Field(max_length=8)] = []
    """Further outputs of the same board, which switch together with `pin`."""
    number: Annotated[int, Field(ge=0, le=255)] = 0
    """P of M106 and M107."""
    min_power: Fraction = 0.0
    """The minimum power of the fan while it turns."""
    max_power: Fraction = 1.0
    """The power at M106 S255."""
    off_below: Fraction = 0.0
    """The fan is off if less than this fraction of `max_power` is asked for."""
    kick_start_s: Annotated[float, Field(ge=0, le=10)] = 0.0
    """The fan starts with `max_power` for this time."""
    kick_start_rise: Fraction = 0.5
    """A rise of power by more than this starts the fan with `max_power`, too."""
    follows: PartName | None = None
    """The heater that switches this fan on. Commands do not control such a fan."""
    follows_heaters: list[PartName] = []
    """Further heaters that switch this fan on, as the one that it `follows`."""
    above_c: Annotated[float, Field(ge=0, le=1200)] = 50.0
    """The fan is on while a heater that it follows is warmer than this."""
    follows_motors: list[Name] = []
    """The fan is on while any of these motors is on. Commands do not control such a fan."""
    stays_on_s: Annotated[float, Field(ge=0, le=3600)] = 60.0
    """The fan stays on for this time after these motors go off."""
    follows_targets: list[PartName] = []
    """The fan is on while any of these heaters has a target, and for `stays_on_s` afterwards.
    Commands do not control such a fan."""
    idle_power: Fraction | None = None
    """The power during `stays_on_s`. If not given, `max_power`."""
    thermostat: Thermostat | None = None
    """The sensor that this fan cools. Commands set the target of such a fan."""
    pwm_hz: Annotated[float, Field(ge=1, le=1000)] = 10.0
    """Pulses per second of the output."""
    tachometer: Tachometer | None = None
    """The tachometer, which measures the speed."""

    @property
    def commanded(self) -> bool:
        """Whether M106 and M107 set this fan."""
        led = self.warmed_by or self.follows_motors or self.follows_targets
        return not led and self.thermostat is None

    @property
    def warmed_by(self) -> list[str]:
        """The heaters that switch this fan on while they are warm."""
        return [*([] if self.follows is None else [self.follows]), *self.follows_heaters]


class Laser(Model):
    """A laser or a spindle. A move is slow enough for the beam to deliver its energy with
    `max_power_w`."""

    pin: Pin
    """An output with hardware PWM."""
    full_scale: Positive = 255.0
    """S of M3 and M4 at full power."""
    energy_letter: Letter | None = None
    """The letter of a G1 that gives the energy of the move, in W·s, as in APrinter."""
    density_letter: Letter | None = None
    """The letter of a G1 that gives the energy per length, in W·s/mm, as in APrinter."""
    power_w: Positive = 100.0
    """The power of the beam when it is fully on."""
    max_power_w: Positive | None = None
    """The maximum power that a move may need. If not given, `power_w`."""


class PowerSupply(Model):
    """The output that switches the power supply of motors and heaters: M80 on, M81 off."""

    pin: Pin
    """The output that switches the power supply. It goes off when the board shuts down."""
    on_at_start: bool = True
    """Whether the power supply is switched on at the start."""


class Beeper(Model):
    """A buzzer without a tone of its own, which the board pulses in software."""

    pin: Pin
    """The output of a buzzer without a tone of its own. That of a fitted display may be used."""


Fans = dict[PartName, Fan]
