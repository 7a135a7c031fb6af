"""Converts a heater of the machine file to the core's controller, protections and model."""

from __future__ import annotations

from passo import _core
from passo.config.heat import BangBangControl, Heater, ModelControl
from passo.heat.rules import FULL_POWER

_SETTLES_S = 10.0


def model_of(heater: Heater) -> _core.HeatModel:
    """The thermal model that a tune has found, or, before a tune, that of the simulated heater."""
    if (m := heater.model) is not None:
        return _core.HeatModel(m.rise_c, m.time_constant_s, m.sensor_lag_s, m.fan_loss, m.ambient_c)
    s = heater.simulated
    return _core.HeatModel(
        s.full_power_rise_c, s.time_constant_s, s.sensor_time_constant_s, s.fan_loss
    )


def control_of(heater: Heater) -> _core.PidControl | _core.OnOffControl | _core.ModelControl:
    """The heater's controller."""
    control, model = heater.control, model_of(heater)
    if isinstance(control, BangBangControl):
        return _core.OnOffControl(control.hysteresis_c, control.interval_s)
    if isinstance(control, ModelControl):
        return _core.ModelControl(model, control.horizon_s)
    kp, ki, kd = pid_gains(model)
    return _core.PidControl(
        kp=kp if control.kp is None else control.kp,
        ki=ki if control.ki is None else control.ki,
        kd=kd if control.kd is None else control.kd,
        filter_s=control.filter_s,
        drive_min=control.drive_min,
        drive_max=control.drive_max,
        range_c=control.range_c,
    )


def pid_gains(model: _core.HeatModel) -> tuple[float, float, float]:
    """kp, ki, kd in 1/255 of full power, by the SIMC rules (S. Skogestad, 2003) for an integrating
    process. The sensor's lag is the dead time θ and the desired time constant: Kc = τ / (k 2θ) and
    τI = 8θ."""
    lag = model.sensor_lag_s
    kp = FULL_POWER * model.time_constant_s / model.rise_c / (2 * lag)
    return kp, kp / (8 * lag), 0.0


def arrival_of(heater: Heater) -> _core.Arrival:
    """The condition under which a heater has reached its target."""
    a, swings = heater.arrival, isinstance(heater.control, BangBangControl)
    usual_s = 0.0 if swings else _SETTLES_S
    return _core.Arrival(a.window_c, a.leaves_c, usual_s if a.seconds is None else a.seconds)


def limits_of(heater: Heater) -> _core.ProtectionLimits:
    """The heater's protections. Without a thermal model in the file, the model deviation is
    monitored only if the file asks for it: the default figures would be wrong for a heater of
    another power."""
    p = heater.protection
    judged = heater.known_model or "deviation" in p.model_fields_set
    return _core.ProtectionLimits(
        min_c=heater.min_c,
        max_c=heater.max_c,
        jump_c=p.jump_c,
        watch_rise_c=p.watch_rise_c,
        watch_s=heater.watch_s,
        runaway_c=p.runaway_c,
        runaway_s=p.runaway_s,
        stuck_on_c=p.stuck_on_c,
        stuck_on_s=p.stuck_on_s,
        deviation=p.deviation if judged else 0.0,
        deviation_s=p.deviation_s,
    )
