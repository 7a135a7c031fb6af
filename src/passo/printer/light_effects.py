"""The effects of lights that run."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import TYPE_CHECKING

from passo.board.lights import PERIOD_S
from passo.printer.effect_colors import Seen, effect_colors
from passo.printer.light_templates import FollowedTemplates

if TYPE_CHECKING:
    from passo.config.light_effects import LightEffect
    from passo.config.lights import Color
    from passo.errors import PassoError
    from passo.printer.live_rig import LiveRig

_PROGRESS_S = 1.0  # between two readings of the progress


class RunningEffects:
    """The running effects of one printer's lights, the last started one last. `base` gives the
    colours of a light without its effects, `show` shows others; `progress` gives the fraction of
    the print that is done. `templates` are those that lights follow, below the effects; `failed`
    receives their errors."""

    def __init__(
        self,
        rig: LiveRig,
        base: Callable[[str], tuple[Color, ...]],
        show: Callable[[str, tuple[Color, ...]], None],
        progress: Callable[[], float | None],
        failed: Callable[[PassoError], None],
    ) -> None:
        self.templates = FollowedTemplates(rig, failed)
        self._rig, self._base, self._show = rig, base, show
        self._progress = progress
        self._effects = rig.machine.light_effects
        self._since_s: dict[str, float] = {}  # by effect
        self._next_s = self._read_s = 0.0
        self._done: float | None = None
        self._loop = asyncio.get_running_loop()
        self.shown: dict[str, tuple[Color, ...]] = {}  # by light, while effects run

    def reset(self) -> None:
        """Call this after the boards have started."""
        self._since_s = {name: 0.0 for name, effect in self._effects.items() if effect.starts}
        self.templates.reset()
        self.shown.clear()

    def start(self, name: str, *, replaces: bool) -> None:
        """Starts an effect, above others on the same light; `replaces`: these end."""
        if replaces:
            light = self._effects[name].light
            self._since_s = {
                n: since for n, since in self._since_s.items() if self._effects[n].light != light
            }
        self._since_s.pop(name, None)
        self._since_s[name] = self._loop.time()
        self._next_s = 0.0

    def stop(self, names: list[str]) -> None:
        """Ends effects: their lights have their own colours again."""
        for name in names:
            self._since_s.pop(name, None)
        self._next_s = 0.0

    def time_passed(self) -> None:
        """Call this as time passes: shows the colours of this time."""
        now_s = self._loop.time()
        if not (self._since_s or self.shown or self.templates.active) or now_s < self._next_s:
            return
        self._next_s = now_s + PERIOD_S
        found: dict[str, list[Color]] = {}
        self.templates.paint(now_s, found, self._base)
        for name, since_s in self._since_s.items():
            effect = self._effects[name]
            colors = found.setdefault(effect.light, list(self._base(effect.light)))
            leds = [led - 1 for led in effect.leds] or list(range(len(colors)))
            seen = self._seen(effect, now_s, since_s)
            for led, color in zip(leds, effect_colors(effect, len(leds), seen), strict=True):
                colors[led] = color
        ended = self.shown.keys() - found.keys()
        self.shown = {light: tuple(colors) for light, colors in found.items()}
        for light in ended:
            self._show(light, self._base(light))
        for light, colors in self.shown.items():
            self._show(light, colors)

    def _seen(self, effect: LightEffect, now_s: float, since_s: float) -> Seen:
        if effect.kind == "progress" and now_s >= self._read_s:
            self._done, self._read_s = self._progress(), now_s + _PROGRESS_S
        heater = self._rig.connection.heaters.get(effect.heater or "")
        celsius = heater.celsius if heater is not None and heater.reported is not None else None
        target_c = heater.target if heater is not None else None
        return Seen(now_s - since_s, celsius, target_c, self._done)
