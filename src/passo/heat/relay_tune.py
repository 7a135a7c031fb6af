"""Relay autotune (K. J. Åström and T. Hägglund, 1984): PID gains from an oscillation."""

from __future__ import annotations

from math import pi

from passo import _core
from passo.heat.rules import FULL_POWER, RULES, Gains

MIN_CYCLES, MAX_CYCLES = 3, 20
HEADROOM_C = 15.0  # minimum distance of a target from the heater's limit

_OVERSHOOT_C = 20.0
_TIMEOUT_S = 1200.0  # limit for the sum of the times since the last two switchings
_FIRST_USED = 2  # cycles before it are not yet balanced
_MIN_SWING_COUNTS = 4.0  # a smaller swing is the coarseness of the sensor, not the heater's
_BAND_COUNTS = 2.5  # above and below the target, where the heater alone swings less


class TuneError(ValueError):
    """A tune that cannot start; the text is the reply."""


class RelayTune:
    """Relay autotune of one heater. The caller gives the heater `control` and the target, and
    passes its samples to `feed`. The temperature oscillates around `target_c`; each cycle gives
    gains by rule number `rule`. When `done` is True, `result` has the gains of the last cycle, or
    `failed` has the reason. Then switch the heater off, or set a controller with these gains.
    `label` is the name of the heater in the lines of the reply: `Hotend:0`, `BED` or `CHAMBER`.

    A heater that swings by less than four counts of its sensor gets a wider relay, which switches
    2.5 counts beyond the target, and the cycles begin again: the swing then measures the heater.
    The owner reads `control` after each `feed`."""

    fan = 0.0

    def __init__(
        self,
        label: str,
        target_c: float,
        cycles: int = 5,
        rule: int = 0,
        *,
        clock_hz: float,
        limit_c: float,
        count_c: float = 0.0,
    ) -> None:
        """`cycles` is clamped to 3 to 20; `count_c` is one count of the sensor at the target, °C.
        Raises TuneError for a target above `limit_c` - 15."""
        if target_c > limit_c - HEADROOM_C:
            raise TuneError("PID Autotune failed! Temperature too high")
        if not 0 <= rule < len(RULES):
            raise TuneError(f"PID Autotune failed! R is 0 to {len(RULES) - 1}")
        self.label = label
        self.target_c = target_c
        self.control = _core.RelayControl()
        self.cycles = min(max(cycles, MIN_CYCLES), MAX_CYCLES)
        self.rule = rule
        self.result: Gains | None = None
        self.failed = ""
        self._hz = clock_hz
        self._count = 0
        self._high = True
        self._swing = 0.0
        self._switched_s = [0.0, 0.0]  # to low, to high
        self._high_s = 0.0
        self._least_c = self._most_c = target_c
        self._gains: Gains | None = None
        self._count_c = count_c

    @property
    def done(self) -> bool:
        """Whether the tune has ended."""
        return self.result is not None or bool(self.failed)

    def begin(self, note: str = "") -> list[str]:
        """Begins the tune. Returns the first lines of the reply, with `note` at their end."""
        cycles = f"Cycles:{self.cycles} Method:{self.rule}"
        return ["PID Autotune start", f"{self.label} Temp:{self.target_c:g} {cycles}{note}"]

    def feed(self, sample: _core.HeatSample) -> list[str]:
        """Takes a sample. Returns the lines to reply after it; usually none."""
        if self.done or sample.target != self.target_c:
            return []
        now_s = sample.clock / self._hz
        if self._swing == 0.0:
            self._switched_s = [now_s, now_s]
            self._swing = abs(sample.terms.d)
        self._least_c = min(self._least_c, sample.celsius)
        self._most_c = max(self._most_c, sample.celsius)
        if sample.celsius > self.target_c + _OVERSHOOT_C:
            return self._fail("Temperature too high")
        if sum(now_s - then for then in self._switched_s) > _TIMEOUT_S:
            return self._fail("timeout")
        high = sample.terms.d > 0
        if high == self._high:
            return []
        self._high = high
        if high:
            return self._cycle(sample, now_s)
        self._high_s = now_s - self._switched_s[1]
        self._switched_s[0] = now_s
        self._most_c = self.target_c
        return []

    def _cycle(self, sample: _core.HeatSample, now_s: float) -> list[str]:
        """Evaluates a cycle, which ends when the power rises again."""
        lines: list[str] = []
        if self._count > 0:
            bias, swing = (
                round(FULL_POWER * abs(share)) for share in (sample.terms.p, sample.terms.d)
            )
            extremes = f"min:{self._least_c:.2f} max:{self._most_c:.2f}"
            lines.append(f" bias:{bias} d:{swing} {extremes}")
        if self._count > _FIRST_USED and self._is_coarse:
            if self.control.band_c > 0:
                return [*lines, *self._fail(f"{self._too_small}; R5 measures a rise in its place")]
            self.control = _core.RelayControl(band_c=_BAND_COUNTS * self._count_c)
            lines.append(f" {self._too_small}. The tune continues with a larger one")
            self._count = 0
        elif self._count > _FIRST_USED:
            lines += self._compute_gains(self._high_s + now_s - self._switched_s[0])
        self._count += 1
        self._switched_s[1] = now_s
        self._swing = abs(sample.terms.d)
        self._least_c = self.target_c
        if self._count > self.cycles and self._gains is not None:
            self.result = self._gains
            lines += ["PID Autotune finished!", f" {self._gains}"]
        return lines

    @property
    def _is_coarse(self) -> bool:
        return self._most_c - self._least_c < _MIN_SWING_COUNTS * self._count_c

    @property
    def _too_small(self) -> str:
        swing, least = self._most_c - self._least_c, _MIN_SWING_COUNTS * self._count_c
        return (
            f"A swing of {swing:.2f} C is too small to measure: {_MIN_SWING_COUNTS:g} steps of the"
            f" sensor are {least:.2f} C"
        )

    def _compute_gains(self, tu_s: float) -> list[str]:
        """Ku = 4 d / (π a), for a relay of amplitude d and a temperature oscillation of amplitude
        a."""
        ku = 4 * FULL_POWER * self._swing / (pi * (self._most_c - self._least_c) / 2)
        rule = RULES[self.rule]
        self._gains = rule.gains(ku, tu_s)
        return [f" Ku:{ku:.2f} Tu:{tu_s:.2f}", f" {rule.name}", f" {self._gains}"]

    def _fail(self, reason: str) -> list[str]:
        self.failed = f"PID Autotune failed! {reason}"
        return [f"Error:{self.failed}"]
