"""Resumes a print after a power cut or a crash: homes, heats, approaches the position, and finds
the offset in the file."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from passo._core import Within
from passo.errors import CommandError
from passo.job.live.journal import Moment, Program, crc_of_macros
from passo.job.live.line_offsets import offset_of_line
from passo.job.live.preamble_scan import PreambleScan
from passo.job.live.reader import Reader
from passo.motion.axis_slots import E, X, Y, Z
from passo.motion.travel import go_over
from passo.printer.input_errors import problem_of
from passo.printer.wait_requests import NullReply, WaitForTemperatures

if TYPE_CHECKING:
    from passo.printer.commands.outputs import Outputs
    from passo.printer.control import Control
    from passo.printer.machine_parts import MachineParts


class Recovery:
    """The recovery of one interrupted print. The printer must be idle. The caller must hold the
    motion lock. Raises CommandError, MachineError, Stopped."""

    def __init__(
        self,
        control: Control,
        parts: MachineParts,
        program: Program,
        moment: Moment,
        reader: Reader,
    ) -> None:
        self._control, self._parts, self._motion = control, parts, parts.motion
        self._heat, self._program = parts.heat, program
        self._moment, self._reader = moment, reader
        if Program.of(program.machine, program.path, reader) != program:
            raise CommandError.of("job.other-file", program.path)
        machine = control.machine
        if program.macros != crc_of_macros(machine):
            raise CommandError.of("job.other-macros", program.path)
        wanted = {f"heater {n}" for n, c in moment.targets_c.items() if c > 0}
        wanted |= {
            n for n, (_, share) in moment.overrides.items() if n.startswith("fan ") and share > 0
        }
        wanted -= {f"heater {n}" for n in machine.heaters} | {f"fan {n}" for n in machine.fans}
        if wanted:
            raise CommandError.of("job.no-part", program.path, value=", ".join(sorted(wanted)))

    async def run(self) -> int:
        """Moves the machine to the position at which the print resumes. Returns the offset in the
        file from which to read."""
        control = self._control
        for line in self._program.settings:
            control.dispatch.take_setting(line, NullReply())
        if self._moment.line == 0:
            for line in self._program.modes:
                control.dispatch.take_setting(line, NullReply())
            return 0
        offset = offset_of_line(self._reader, self._moment.line)
        past = PreambleScan(
            *(control, self._parts, self._program, self._reader, offset),
            self._moment.overrides,
        )
        state = past.job
        for axis, mm in self._moment.babysteps_mm.items():
            if not state.plan.shift("xyz".index(axis), mm):
                raise CommandError(
                    [problem_of(state, self._program.path, control.machine.geometry)]
                )
        state.flush()
        at = state.machine_position
        for line in past.settings:
            control.dispatch.take_setting(line, NullReply())
        self._motion.offsets.home_mm |= past.homed_mm
        await self._lift_and_home(past.unhomed)
        self._motion.offsets.home_mm |= past.home_offset_mm
        await self._warm(past.commands.outputs)
        if state.tool != control.rig.job.tool:
            # select the tool first, because its nozzle is primed
            control.dispatch.take_setting(f"T{state.tool}", NullReply())
        await self._approach(at)
        control.rig.job.adopt(state)
        control.rig.commands.follow_tool()
        control.rig.commands.set_points.take_tool_temperatures(past.commands.set_points)
        control.rig.commands.macros.take_variables(past.commands.macros)
        control.rig.job.limits.set_speed_factor(state.limits.speed_factor)
        control.rig.commands.factors.kept = past.commands.factors.kept
        self._motion.offsets.babysteps_mm |= self._moment.babysteps_mm
        return offset

    async def _lift_and_home(self, unhomed: set[str]) -> None:
        """Lifts and homes. A machine with an independent Z takes Z from the journal, and homes the
        other axes after a lift; a machine whose arms move together homes upwards. Axes that were
        homed after the interruption, or by an earlier attempt, keep their positions. Raises
        CommandError if homing cannot find the position of an axis again, because the print had set
        it without homing (`unhomed`)."""
        control, machine = self._control, self._control.machine
        raise_mm = machine.park.raise_mm if machine.park else 0.0
        if control.rig.positions.restore(self._moment.origins):
            z = control.rig.job.machine_position[Z]
            top = max(machine.axes["z"].max_mm, z)
            if control.rig.queue.move({Z: min(z + raise_mm, top)}, math.inf):
                control.rig.queue.flush()
            return
        found = "xyz" if machine.geometry.lifts_together else "xy"
        if lost := [name.upper() for name in found if name in unhomed]:
            raise CommandError.of("job.never-homed", self._program.path, value=", ".join(lost))
        if machine.geometry.lifts_together:
            await self._motion.homer.home("")
            return
        known = control.rig.positions.known
        offset_mm, was_mm = self._motion.offsets.home_mm["z"], self._motion.homer.offset_mm
        z = self._moment.z_mm
        if "z" in known:  # the program's coordinates refer to its own homing
            z = control.rig.job.machine_position[Z] + offset_mm - was_mm.get("z", offset_mm)
        control.rig.job.axes.set([(Z, z)])
        known.add("z")
        was_mm["z"] = offset_mm
        z = control.rig.job.machine_position[Z]
        await self._go({Z: min(z + raise_mm, max(machine.axes["z"].max_mm, z))}, math.inf)
        if not machine.homing:
            if not known.issuperset("xy"):
                point = machine.home_point
                control.rig.job.axes.set([(axis, point[axis]) for axis in (X, Y)])
                known.update("xy")
            return
        await self._motion.homer.home("XY")

    async def _warm(self, past: Outputs) -> None:
        """Reaches the temperatures, and sets fans and outputs as before the interruption."""
        control = self._control
        hot = tuple(n for n, celsius in self._moment.targets_c.items() if celsius > 0)
        for name in control.machine.heaters:
            target = self._moment.targets_c.get(name, 0.0)
            control.targets.set_target(name, target, at_once=True)
        await control.waits.wait(WaitForTemperatures(hot), NullReply())
        control.state.raise_if_interrupted()
        for fan in control.rig.commands.outputs.commanded_fans:
            control.rig.set_fan(fan, past.fans.get(fan, 0.0))
        for name, share in past.values.items():
            control.rig.set_free(name, share)

    async def _approach(self, at: list[float]) -> None:
        """Moves above the position, primes the nozzle with a little filament, and lowers it."""
        park = self._control.machine.park
        speed = park.speed_mm_s if park else math.inf
        if self._control.machine.axes_of_arms == ("x", "y"):
            await self._motion.homer.swing(at[X], at[Y])
        else:
            place = {X: at[X], Y: at[Y], Z: at[Z]}
            await self._arrive(reached=go_over(self._control.rig, place, speed))
        if park and park.prime_mm > 0 and self._heat.settings.can_extrude():
            e = self._control.rig.job.machine_position[E]
            await self._go({E: e + park.prime_mm}, park.prime_mm_s)
        await self._go({Z: at[Z]}, math.inf)

    async def _go(self, target: dict[int, float], speed_mm_s: float) -> None:
        reached = self._control.rig.queue.move(target, speed_mm_s, Within.REACH)
        await self._arrive(reached=reached)

    async def _arrive(self, *, reached: bool) -> None:
        control = self._control
        if not reached:
            raise CommandError.of("job.other-file", self._program.path)
        control.rig.queue.flush()
        await control.rig.queue.until(
            lambda: control.rig.queue.standing or control.state.interrupted
        )
        control.state.raise_if_interrupted()
