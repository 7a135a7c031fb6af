"""The lights of a running printer that boards send frames to."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

from passo.config.lights import Led, start_color
from passo.errors import MachineError
from passo.printer.light_effects import RunningEffects

if TYPE_CHECKING:
    from passo.board.boards import Boards
    from passo.config.lights import Color
    from passo.errors import PassoError
    from passo.printer.live_rig import LiveRig
    from passo.printer.state import State

_log = logging.getLogger(__name__)

_MARKS = 1 << 31  # values of a mark


class LightFrames:
    """The lights of one printer: what they show, and what they will show when print time reaches
    their marks. A light keeps its colours while the printer is halted. `progress` gives the
    fraction of the print that is done."""

    def __init__(self, rig: LiveRig, state: State, progress: Callable[[], float | None]) -> None:
        self._rig, self._state = rig, state
        lights = rig.machine.lights.items()
        self._lights = {n: light for n, light in lights if not isinstance(light, Led)}
        self.shown: dict[str, tuple[Color, ...]] = {}
        self._planned: dict[int, Callable[[], None]] = {}  # by the value of the mark
        self.effects = RunningEffects(rig, self._base, self._overlay, progress, self._failed)
        self._number = 0

    def reset(self, boards: Boards) -> None:
        """Call this after the boards have started: the lights show the colours of the start."""
        self._planned.clear()
        self.effects.reset()
        for name, light in self._lights.items():
            self._show(boards, name, (start_color(light),) * light.count)

    def set_light(self, light: str, colors: Sequence[Color], *, at_once: bool) -> None:
        """Shows these colours when the moves so far are done, or at once."""
        shown = tuple(colors)
        self._when(lambda: self._show(self._rig.connection, light, shown), at_once=at_once)

    def set_effect(self, effect: str, *, on: bool, replaces: bool = False) -> None:
        """Starts or ends an effect when the moves so far are done."""
        effects = self.effects
        if on:
            self._when(lambda: effects.start(effect, replaces=replaces))
        else:
            self._when(lambda: effects.stop([effect]))

    def follow(
        self, light: str, leds: Sequence[int], template: str | None, values: Mapping[str, object]
    ) -> None:
        """Lets LEDs, from 0, follow a template when the moves so far are done, or none."""
        self._when(lambda: self.effects.templates.follow(light, leds, template, values))

    def _failed(self, error: PassoError) -> None:
        self._state.announce(_log, logging.WARNING, str(error), error.problems[0])

    def _when(self, act: Callable[[], None], *, at_once: bool = False) -> None:
        """Acts when the moves so far are done, or at once."""
        if at_once:
            act()
            return
        self._number = (self._number + 1) % _MARKS
        self._planned[self._number] = act
        self._rig.job.outputs.mark(len(self._rig.machine.heaters) + 1, self._number)

    def mark_reached(self, value: int) -> None:
        """Call this when print time reaches the mark of a light or an effect."""
        if (act := self._planned.pop(value, None)) is not None:
            act()

    def plan_forgotten(self) -> None:
        """Call this when the plan is discarded, and its colours with it."""
        self._planned.clear()

    def _show(self, boards: Boards, light: str, colors: tuple[Color, ...]) -> None:
        self.shown[light] = colors
        if light not in self.effects.shown:
            boards.show_light(light, self._lights[light].frame(colors))

    def _base(self, light: str) -> tuple[Color, ...]:
        """The colours of a light without its effects."""
        commanded = self._rig.commands.lights.colors[light]
        return self.shown[light] if light in self._lights else tuple(commanded)

    def _overlay(self, light: str, colors: tuple[Color, ...]) -> None:
        """Shows the colours of effects, or those of the light again."""
        if light in self._lights:
            self._rig.connection.show_light(light, self._lights[light].frame(colors))
        else:
            self._rig.commands.lights.show_leds(light, colors[0])

    def time_passed(self) -> None:
        """Call this as time passes: sends the frames that are due."""
        if self._state.halted or self._rig.queue.interrupted:
            return
        self.effects.time_passed()
        for light in self._rig.connection.work_lights():
            failed = MachineError.of("light.late", axis=light)
            self._state.announce(_log, logging.WARNING, str(failed), failed.problems[0])
