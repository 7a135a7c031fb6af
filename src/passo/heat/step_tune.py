"""Step-response tune: finds the thermal model of a heater from full power, then from a constant
temperature."""

from __future__ import annotations

from passo import _core
from passo.heat.relay_tune import HEADROOM_C, TuneError
from passo.heat.step_fit import fit_step

_MIN_RISE_C = 20.0
_COLD_C = 45.0  # a heater that starts hotter is not at ambient temperature
_MIN_SAMPLES = 20
_TIMEOUT_S = 3600.0
_LAGS_BEFORE = 6.0  # settling time, in lags of the sensor, before the power is averaged
_HOLD_S = 40.0
# The assumed effect of the fan until it is measured: close enough for the protections with any fan.
_ANY_FAN_LOSS = 0.5


class StepTune:
    """Step-response tune of a heater that starts at room temperature. The caller sets the target,
    passes the samples to `feed`, and after each sample sets the heater's controller to `control`
    and its fan to the speed `fan`, 0 to 1. The heater runs at full power up to the target; then the
    tune holds the target without the fan and, `with_fan`, with it. When `done`, `result` has the
    model, or `failed` has the reason.
    """

    def __init__(
        self,
        label: str,
        target_c: float,
        *,
        clock_hz: float,
        limit_c: float,
        with_fan: bool = True,
    ) -> None:
        """Raises TuneError for a target above `limit_c` - 15."""
        if target_c > limit_c - HEADROOM_C:
            raise TuneError("MPC Autotune failed! Temperature too high")
        self.label = label
        self.target_c = target_c
        self.control: _core.OnOffControl | _core.ModelControl = _core.OnOffControl(0.0)
        self.fan = 0.0
        self.result: _core.HeatModel | None = None
        self.failed = ""
        self._with_fan = with_fan
        self._hz = clock_hz
        self._start: _core.HeatSample | None = None
        self._rows: list[tuple[float, float]] = []
        self._model: _core.HeatModel | None = None
        self._still_power = 0.0
        self._phase_s = 0.0
        self._powers: list[float] = []

    @property
    def done(self) -> bool:
        """Whether the tune has ended."""
        return self.result is not None or bool(self.failed)

    def begin(self, note: str = "") -> list[str]:
        """Begins the tune. Returns the first lines of the reply, with `note` at their end."""
        return ["MPC Autotune start", f"{self.label} Temp:{self.target_c:g}{note}"]

    def feed(self, sample: _core.HeatSample) -> list[str]:
        """Takes a sample. Returns the lines to reply after it; usually none."""
        if self.done or sample.target != self.target_c:
            return []
        now_s = sample.clock / self._hz
        if self._start is None:
            if sample.power <= 0:
                return []
            self._start = sample
            if sample.celsius > min(_COLD_C, self.target_c - _MIN_RISE_C):
                return self._fail("It must start cold")
        if now_s - self._start.clock / self._hz > _TIMEOUT_S:
            return self._fail("timeout")
        if self._model is None:
            return self._step(sample, now_s)
        return self._hold(sample, now_s, self._model)

    def _step(self, sample: _core.HeatSample, now_s: float) -> list[str]:
        start = self._start
        assert start is not None
        if sample.celsius < self.target_c:
            self._rows.append((now_s - start.clock / self._hz, sample.celsius))
            return []
        if len(self._rows) < _MIN_SAMPLES:
            return self._fail("It heats too fast")
        rise, time_constant, lag = fit_step(self._rows, start.celsius)
        model = _core.HeatModel(rise / start.power, time_constant, lag, ambient_c=start.celsius)
        if not self._with_fan:
            return self._finish(model, 0.0)
        self._model = model
        self.control = _core.ModelControl(model)
        self._phase_s = now_s
        return [f" rise:{rise:.1f} time constant:{time_constant:.1f} sensor lag:{lag:.2f}"]

    def _hold(self, sample: _core.HeatSample, now_s: float, model: _core.HeatModel) -> list[str]:
        settled_s = self._phase_s + _LAGS_BEFORE * model.sensor_lag_s
        if now_s < settled_s:
            return []
        self._powers.append(sample.power)
        if now_s < settled_s + _HOLD_S:
            return []
        power = sum(self._powers) / len(self._powers)
        self._powers.clear()
        self._phase_s = now_s
        if power <= 0:
            return self._fail("It holds without power")
        line = f" power:{power:.3f} fan:{self.fan:g}"
        if self.fan == 0:
            self._still_power = power
            self.fan = 1.0
            self.control = _core.ModelControl(_with_fan_loss(model, _ANY_FAN_LOSS))
            return [line]
        return [line, *self._finish(model, power / self._still_power - 1)]

    def _finish(self, model: _core.HeatModel, fan_loss: float) -> list[str]:
        self.fan = 0.0
        self.result = _with_fan_loss(model, max(fan_loss, 0.0))
        figures = f"rise:{model.rise_c:.1f} time constant:{model.time_constant_s:.1f}"
        rest = f"sensor lag:{model.sensor_lag_s:.2f} fan loss:{self.result.fan_loss:.3f}"
        return ["MPC Autotune finished!", f" {figures} {rest}"]

    def _fail(self, reason: str) -> list[str]:
        self.failed = f"MPC Autotune failed! {reason}"
        return [f"Error:{self.failed}"]


def _with_fan_loss(m: _core.HeatModel, fan_loss: float) -> _core.HeatModel:
    return _core.HeatModel(m.rise_c, m.time_constant_s, m.sensor_lag_s, fan_loss, m.ambient_c)
