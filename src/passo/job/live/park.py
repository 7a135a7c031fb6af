"""Parks the nozzle while a print is paused, and returns it to the exact point."""

from __future__ import annotations

import logging
import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING

from passo import _core
from passo.config.machine import MachineConfig
from passo.config.motor_roles import axis_order
from passo.errors import CommandError
from passo.motion.axis_slots import E, X, Y, Z, slot_of_axis
from passo.motion.travel import go_back
from passo.printer.wait_requests import NullReply, WaitForTemperatures

if TYPE_CHECKING:
    from passo.printer.control import Control
    from passo.printer.machine_parts import MachineParts

_log = logging.getLogger(__name__)

_SAME_MM = 1e-3  # positions that differ by less are equal


def check_words(words: Mapping[str, float], machine: MachineConfig) -> None:
    """Raises CommandError if a parameter of M600 (see `Park.leave`) exceeds the limits of this
    machine, or the maximum length that M701 extrudes at once."""
    z = machine.axes["z"]
    longest = {"Z": z.max_mm - z.min_mm} | dict.fromkeys("ELU", _core.LONGEST_CHANGE_MM)
    ranges = {letter: (-mm, mm) for letter, mm in longest.items()}
    ranges |= {a.upper(): (machine.axes[a].min_mm, machine.axes[a].max_mm) for a in "xy"}
    for letter, (low, high) in ranges.items():
        if letter in words and not low <= words[letter] <= high:
            raise CommandError.bad_value(letter, words[letter], f"{low:g} to {high:g} mm")


class Park:
    """Lifts the nozzle, retracts a little filament and moves to the park position of the machine,
    while the print is suspended. The caller must hold the motion lock, and have suspended the job.
    The nozzle returns to the stop position of the print or, with `here`, to its position at
    `leave`."""

    def __init__(self, control: Control, parts: MachineParts, *, here: bool = False) -> None:
        self._control = control
        self._suspension, self._heat = parts.suspension, parts.heat
        self._here = here
        self._left: list[float] | None = None  # the position at `leave`, with `here`
        self._away = False
        self._warm = False  # whether the hotend was warm at `leave`
        self._retracted_mm = 0.0
        self.owed_mm = 0.0  # mm of filament retracted by other parks during this pause
        self._load_mm = 0.0
        axes = control.machine.axes
        order = enumerate(axis_order(axes))
        self._places = {i: slot_of_axis(i) for i, name in order if not axes[name].extruder}
        self._celsius: float | None = None

    async def leave(
        self, words: Mapping[str, float] = MappingProxyType({}), *, by_macro: bool = False
    ) -> None:
        """Moves the nozzle to the parking position. Without a parking position, or if an axis is
        not homed, the nozzle stays. The words of M600 replace the machine's values: E is the
        retraction, Z the lift, X and Y the position, U the length to unload there, L the length to
        load before the return (all in mm), and S the temperature of the hotend for loading, °C.
        `by_macro`: the macro that has paused the print parks the nozzle. Only if the nozzle is
        still at the stop position, because the macro has failed or moves nothing, it is parked
        here."""
        control = self._control
        park = control.machine.park
        self._away = False
        self._warm = (
            self._heat.settings.can_extrude() and not control.targets.cooled_c
        )  # a heater in `cooled_c` may have failed, so its reading does not count
        self._celsius = words.get("S")
        self._left = control.rig.job.machine_position if self._here else None
        if park is None or control.rig.job.locked_axes:
            return
        await control.rig.queue.until(
            lambda: control.rig.queue.standing or bool(control.state.halted)
        )
        control.state.raise_if_halted()
        if not control.rig.job.stops.suspended:
            return  # cancelled in the meantime
        if by_macro and self._has_moved():
            return
        self._take_tool()
        queue, at = control.rig.queue, self._place()
        extrudes = self._heat.settings.can_extrude()
        self._retracted_mm = abs(words.get("E", park.retract_mm)) if extrudes else 0.0
        self._load_mm = abs(words.get("L", 0.0))
        lift_mm = abs(words.get("Z", park.raise_mm))
        top = control.machine.axes["z"].max_mm
        self._away = True
        self._push(-self._retracted_mm, park.retract_mm_s)
        # A macro that pauses the print may have lifted the nozzle higher.
        lifted = max(min(at[Z] + lift_mm, max(top, at[Z])), control.rig.job.machine_position[Z])
        queue.move({Z: lifted}, math.inf)
        place = dict(zip((X, Y), park.position_mm or (), strict=False))
        place |= {slot: words[letter] for slot, letter in ((X, "X"), (Y, "Y")) if letter in words}
        if place and not queue.move(place, park.speed_mm_s):
            problem = control.rig.commands.problem()
            text = f"The nozzle stays over the print: {problem}"
            control.state.announce(_log, logging.WARNING, text, problem)
        if extrudes:
            self._push(-abs(words.get("U", 0.0)), _core.UNLOAD_MM_S)
        await self._wait_for_moves()

    def take_over(self, other: Park) -> None:
        """Takes over the filament that another park has retracted during this pause without
        restoring it."""
        if other._away:
            self.owed_mm += other._retracted_mm

    def _take_tool(self) -> None:
        """Selects the tool of the print; with `here`, the active tool stays selected."""
        if not self._here:
            self._suspension.take_tool()

    def _place(self) -> list[float]:
        """The position to which the nozzle returns, machine mm."""
        return self._left or self._control.rig.job.stops.position

    def _has_moved(self) -> bool:
        """Whether the nozzle is no longer at the position to which it returns."""
        at, place = self._control.rig.job.machine_position, self._place()
        return any(abs(at[i] - place[i]) > _SAME_MM for i in self._places.values())

    def _push(self, mm: float, speed_mm_s: float) -> None:
        """Moves filament by `mm`; a positive length extrudes."""
        if mm:
            at = self._control.rig.job.machine_position[E]
            self._control.rig.queue.move({E: at + mm}, speed_mm_s)

    async def come_back(self) -> None:
        """Returns the nozzle to the position that it left: first above it, then down. Babysteps
        during the pause shift this position, even if the nozzle was not parked. Raises CommandError
        if a heater fails or is off, or if the arms cannot reach the position; the caller may try
        again."""
        control = self._control
        park = control.machine.park
        await self._wait_for_moves()  # this also waits until queued targets are set
        control.state.raise_if_halted()
        if self._celsius is not None:
            await self._reach(self._celsius)
        job = control.rig.job
        if job.stops.suspended:
            self._take_tool()
            await control.waits.warm_again()
            await self._melt()
        if self._away and job.stops.suspended and self._heat.settings.can_extrude():
            self._push(self._load_mm, _core.LOAD_MM_S)
            self._load_mm = 0.0
        at: list[float] | None = None
        while job.stops.suspended and at != self._place():
            at = self._place()
            # Axes that are not homed stay where a failed homing has left them.
            unknown = job.locked_axes
            job.axes.set([(i, at[self._places[i]]) for i in unknown])
            for i in unknown:
                job.axes.lock(i, True)
            place = {slot: at[slot] for i, slot in self._places.items() if i not in unknown}
            if not go_back(control.rig, place, park.speed_mm_s if park else math.inf):
                raise CommandError([control.rig.commands.problem()])
            if park is not None and self._heat.settings.can_extrude():
                mm = self.owed_mm + (self._retracted_mm if self._away else 0.0)
                self._push(mm, park.retract_mm_s)
            self._away, self.owed_mm = False, 0.0
            await self._wait_for_moves()

    async def _melt(self) -> None:
        """Waits until a hotend that was warm at the pause is warm again. Raises CommandError if it
        is not being heated."""
        control = self._control
        if (
            not self._warm
            or not control.rig.job.stops.suspended
            or self._heat.settings.can_extrude()
        ):
            return
        hotend = control.rig.commands.set_points.heater("hotend")
        if control.rig.connection.heaters[hotend].target > 0:
            await control.waits.wait(WaitForTemperatures((hotend,)), NullReply())
        if control.rig.job.stops.suspended and not self._heat.settings.can_extrude():
            raise CommandError.of("input.cold")

    async def _reach(self, celsius: float) -> None:
        """Heats the hotend of the active tool to the temperature for the new filament."""
        control = self._control
        hotend = control.rig.commands.set_points.heater("hotend")
        control.targets.set_target(hotend, celsius, at_once=True)
        await control.waits.wait(WaitForTemperatures((hotend,), cooling=True), NullReply())
        self._celsius = None

    async def _wait_for_moves(self) -> None:
        control = self._control
        control.rig.queue.flush()
        await control.rig.queue.until(
            lambda: control.rig.queue.standing or bool(control.state.halted)
        )
