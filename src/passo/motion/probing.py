"""Probing: the head descends until the probe stops its motors; that gives the height of the bed."""

from __future__ import annotations

import math
from collections.abc import AsyncGenerator, Awaitable, Callable, Generator, Mapping, Sequence
from contextlib import asynccontextmanager, contextmanager
from dataclasses import dataclass
from statistics import fmean, median
from typing import TYPE_CHECKING, Literal

from pydantic import ValidationError

from passo._core import Within
from passo.config.probing import PROBE
from passo.errors import CommandError, Problem
from passo.geometry.base import Unreachable
from passo.motion.axis_slots import X, Y, Z
from passo.motion.bed_scan import BedScan
from passo.motion.eddy_gauge import EddyGauge
from passo.motion.endstops import probe_switch
from passo.motion.probe_head import ProbeHead
from passo.probes.base import Probe, SensingProbe, Twist
from passo.probes.eddy import EddyProbe
from passo.probes.manual import ManualProbe

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.motion.bed_correction import BedCorrection
    from passo.motion.endstops import Switch
    from passo.motion.rig import Rig
    from passo.motion.trigger_overshoot import TriggerOvershoot
    from passo.motion.triggered_moves import Interrupts, TriggeredMoves

EARLY_MM = 1.0  # a probe that triggers so near to the start did not touch the bed
APART_MM = 1.0  # two descents to one place that differ by more show a fault
COLD_S = 20.0  # heaters stay on in a descent that may take longer
_LIMIT_MM = 1e-3  # to which the lowest place within the limits of the motors is found
_PAPER = ManualProbe(kind="manual")
_CLEAR_MM = 5.0  # above the bed, in a calibration
_LIFT_MM = 0.5  # after each lift by this distance, a triggered probe is read again


@dataclass(frozen=True, slots=True)
class Place:
    """The place where the probe (or the nozzle itself) measures, mm. `name` is its name in
    messages; `offset_mm` is added to the height."""

    x: float
    y: float
    name: str
    offset_mm: float = 0.0
    by_nozzle: bool = False

    def __str__(self) -> str:
        """The place as text for messages."""
        return f"X{self.x:g} Y{self.y:g}"


@dataclass(frozen=True, slots=True)
class Measured:
    """The height of the bed at a place, in mm rounded to nanometres, and the Z of the nozzle when
    the probe triggered."""

    place: Place
    height_mm: float
    trigger_z_mm: float


class Prober:
    """Measures heights of the bed with the probe of one printer. Call it with the motion lock held
    and the machine idle. The nozzle never moves below the `low_mm` of the probe, relative to the
    last measured bed, or to Z 0 without one, nor below the limits of the motors. `offset_mm`,
    `trigger_height_mm` and `twist` are the active values. After a failure, the nozzle is lifted to
    `start_mm`, the heaters have their targets again, and the axes are still homed.
    """

    def __init__(
        self,
        rig: Rig,
        interrupts: Interrupts,
        triggered: TriggeredMoves,
        correction: BedCorrection,
    ) -> None:
        self._rig, self._interrupts = rig, interrupts
        self._triggered, self._correction = triggered, correction
        self._head = ProbeHead(rig, interrupts, triggered)
        self.last_triggered = False
        probe = rig.machine.probe
        self.gauge = (
            EddyGauge(rig, interrupts, triggered, probe) if isinstance(probe, EddyProbe) else None
        )
        # called before each descent, and after each that such a call has begun
        self.before_descent: list[Callable[[], Awaitable[None]]] = []
        self.after_descent: list[Callable[[], Awaitable[None]]] = []
        self._armed = False
        self.reset()
        self.restarted()

    @property
    def _machine(self) -> MachineConfig:
        return self._rig.machine

    def reset(self) -> None:
        """Restores the offsets of the machine file."""
        probe = self._machine.probe
        dx, dy = probe.offset_mm if probe else (0.0, 0.0)
        self.offset_mm = dx, dy
        self.trigger_height_mm = 0.0
        self.twist: dict[Literal["x", "y"], Twist] = {}
        self._sensing = probe if isinstance(probe, SensingProbe) else None
        if self._sensing is not None:
            self.trigger_height_mm = self._sensing.trigger_height_mm
            self.twist = dict(self._sensing.twist)

    def restarted(self) -> None:
        """Call this after the boards have started or been replaced: a servo stows its probe."""
        self._deployed = False  # by M401: the probe stays deployed between runs
        probe = self._machine.probe
        if probe is not None and (pulse := probe.start_pulse()):
            self._head.pulse_at_start(*pulse)

    @property
    def probe(self) -> SensingProbe:
        """The probe with the values that M558 has set. Raises CommandError if the machine has no
        probe, or a manual one."""
        self._require_sensor()
        assert self._sensing is not None
        return self._sensing

    @property
    def kind(self) -> str:
        """The kind of the probe in the machine file; empty without one."""
        return self._machine.probe.kind if self._machine.probe else ""

    def change(self, values: Mapping[str, float]) -> None:
        """M558: replaces values of the machine file until a restart. Raises CommandError for a
        value out of range."""
        probe = self.probe
        try:
            changed = type(probe).model_validate({**probe.model_dump(), **values})
        except ValidationError as error:
            first = error.errors()[0]
            key = ".".join(map(str, first["loc"][-1:]))
            raise CommandError.of(
                "command.value", axis=key, value=first["input"], limit=first["msg"]
            ) from None
        if changed.start_mm <= changed.trigger_height_mm + EARLY_MM:
            limit = f"more than {changed.trigger_height_mm + EARLY_MM:g}"
            raise CommandError.of(
                "command.value", axis="H", value=f"{changed.start_mm:g}", limit=limit
            )
        self._sensing = changed

    @property
    def carried(self) -> Probe:
        """The probe of the machine; a sheet of paper if it has none."""
        return self._machine.probe or _PAPER

    @property
    def _switch(self) -> Switch:
        switch = probe_switch(self._machine)
        assert switch is not None
        return switch

    def nozzle_at(self, place: Place) -> tuple[float, float]:
        """X and Y of the nozzle, mm, when the probe is at `place`."""
        dx, dy = (0.0, 0.0) if place.by_nozzle else self.offset_mm
        return place.x - dx, place.y - dy

    def twisted_mm(self, place: Place) -> float:
        """What the twist of the axes adds to a height that is measured at a place, mm."""
        at = {"x": place.x, "y": place.y}
        return sum(twist.at(at[axis]) for axis, twist in self.twist.items())

    def place_here(self) -> Place:
        """The current place of the probe."""
        x, y, *_ = self._rig.job.machine_position
        dx, dy = self.offset_mm
        return Place(round(x + dx, 6), round(y + dy, 6), "this place")

    @property
    def nozzle_xy_mm(self) -> tuple[float, float]:
        """X and Y of the nozzle in machine coordinates, mm."""
        x, y, *_ = self._rig.job.machine_position
        return round(x, 6), round(y, 6)

    @property
    def z_mm(self) -> float:
        """The height of the nozzle, mm of the machine."""
        return round(self._head.z_mm, 6)

    async def approach(self, place: Place) -> None:
        """Moves the nozzle over a place of the paper test, at the start height. Raises as
        `measure`."""
        self.check([place])
        self._head.heeds_stops = True
        await self.clear_bed()
        x, y = self.nozzle_at(place)
        await self._head.move(self.carried.travel_mm_s, x=x, y=y)
        await self._head.move(self.carried.lift_mm_s, z=self.carried.start_mm)

    async def go_to(self, place: Place, speed_mm_s: float) -> None:
        """Moves the probe, or the nozzle for a manual probe, over a place at its present height.
        Raises as `measure`."""
        self.check([place])
        self._head.heeds_stops = True
        x, y = self.nozzle_at(place)
        await self._head.move(speed_mm_s, x=x, y=y)

    async def to_height(self, z_mm: float, speed_mm_s: float) -> None:
        """Moves the nozzle to `z_mm`. Raises as `measure`."""
        self._head.heeds_stops = True
        await self._head.move(speed_mm_s, z=z_mm)

    async def clear_bed(self) -> None:
        """Lifts the nozzle to the start height, unless it is higher. Raises as `measure`."""
        self._head.heeds_stops = True
        if self._head.z_mm < self.carried.start_mm:
            await self._head.move(self.carried.lift_mm_s, z=self.carried.start_mm)

    def triggered(self) -> bool:
        """Asks the board whether the probe is triggered. Lets time pass; raises MachineError, and
        CommandError for a manual probe."""
        self._require_sensor()
        if self.gauge is not None:
            _ = self.gauge.reader  # has the active settings
        self.last_triggered = self._head.triggered()
        return self.last_triggered

    def _require_sensor(self) -> None:
        if self._sensing is None:
            raise CommandError.of("probe.none" if self._machine.probe is None else "probe.paper")

    def check(self, places: Sequence[Place]) -> None:
        """Raises CommandError unless X, Y and Z are homed, and nozzle and probe can reach all these
        places."""
        locked = [i for i in self._rig.job.locked_axes if i < 3]
        if locked:
            raise CommandError.of("input.not-homed", axis="XYZ"[locked[0]])
        for place in places:
            self.check_place(place)

    def check_place(self, place: Place) -> None:
        """Raises CommandError unless nozzle and probe can reach a place."""
        machine, start = self._machine, self.carried.start_mm
        x, y = self.nozzle_at(place)
        nozzle = f"X{x:g} Y{y:g} Z{start:g}"

        def refused(limit: str) -> CommandError:
            return CommandError.of(
                "probe.out-of-reach",
                axis=place.name.capitalize(),
                value=str(place),
                position=nozzle,
                limit=limit,
            )

        for name, mm in zip("xyz", (x, y, start), strict=True):
            low, high = machine.axes[name].min_mm, machine.axes[name].max_mm
            if not low <= mm <= high:
                raise refused(f"{name.upper()} goes from {low:g} to {high:g}")
        x0, y0, x1, y1 = machine.bed_area_mm
        if not (x0 <= place.x <= x1 and y0 <= place.y <= y1):
            raise refused(f"the bed goes from X{x0:g} Y{y0:g} to X{x1:g} Y{y1:g}")
        try:
            machine.geometry.inverse((x, y, start))
        except Unreachable as error:
            raise refused(str(error)) from None

    async def deploy(self) -> None:
        """M401: the probe stays deployed until M402. Raises as `measure`."""
        self._require_sensor()
        self.check([])
        async with self._session():
            await self._get_down()
            self._deployed = True

    async def stow(self) -> None:
        """M402: stows the probe. Raises as `measure`."""
        self._require_sensor()
        self.check([])
        self._deployed = False
        async with self._session():
            await self._lift(self.probe.start_mm)

    async def pulse(self, width_us: float, seconds: float) -> None:
        """M280: pulses the servo of the probe. Raises as `measure`."""
        if self.carried.servo_pin is None:
            raise CommandError.of("probe.no-servo", value="M280")
        self._head.heeds_stops = True
        await self._head.pulse(width_us, seconds)

    async def _get_down(self) -> None:
        await self._lift(self.probe.start_mm)
        await self.probe.deploy(self._head)

    @asynccontextmanager
    async def _session(self, *, calibrated: bool = True) -> AsyncGenerator[None]:
        """A probing session: the bed correction is off within the block. At the end the probe is
        stowed, unless M401 has deployed it. After an error, the nozzle is also lifted to the start
        height."""
        self._triggered.active, self._head.heeds_stops = True, True
        try:
            with self._correction.suspended(), self._triggered.prepared():
                try:
                    async with self._measuring(calibrated=calibrated):
                        yield
                except BaseException as error:
                    await self._clear_up(error)
                    raise
                if not self._deployed:
                    await self.probe.stow(self._head)
        finally:
            self._triggered.active = False

    @asynccontextmanager
    async def _measuring(self, *, calibrated: bool) -> AsyncGenerator[None]:
        """Within the block, a probe that measures heights does so all the time. Raises CommandError
        if it is to be `calibrated`, and is not."""
        gauge = self.gauge
        if gauge is None:
            yield
            return
        if calibrated:
            _ = gauge.curve  # an error before anything moves
        await gauge.begin()
        try:
            yield
        finally:
            gauge.end()

    async def _clear_up(self, error: BaseException) -> None:
        """After a failure, lifts the nozzle and stows the probe. Errors of these steps are added to
        the report."""
        if self._interrupts.halted:
            return
        self._head.heeds_stops = False
        await self._lift(self.probe.start_mm)
        self._deployed = False
        if self._interrupts.halted:
            return
        further: list[Problem] = []
        try:
            if self._armed:
                await self._end_descent()
        except CommandError as failed:
            further += failed.problems
        try:
            await self.probe.stow(self._head)
        except CommandError as failed:
            further += failed.problems
        if further:
            before = error.problems if isinstance(error, CommandError) else ()
            raise CommandError([*before, *further]) from error

    async def _first(self, place: Place) -> None:
        """Moves over the first place and deploys the probe."""
        travels = self.probe.travels_to_deploy
        if not self._deployed and travels:
            await self._get_down()
        await self._go_over(place)
        if not self._deployed and not travels:
            await self._get_down()

    async def measure(
        self,
        places: Sequence[Place],
        report: Callable[[Measured], None] = lambda _: None,
        above_mm: float | None = None,
    ) -> list[Measured]:
        """Measures the heights at these places, in this order; `report` is called with each height
        at once. At the end, the nozzle is at the start height above the last place, or `above_mm`
        above its trigger position. Raises CommandError, Stopped after M108 or M410, and
        MachineError."""
        self._require_sensor()
        self.check(places)
        found: list[Measured] = []
        async with self._session():
            for place in places:
                await (self._go_over(place) if found else self._first(place))
                found.append(await self._point(place))
                report(found[-1])
                end = self.probe.start_mm
                if above_mm is not None:
                    end = found[-1].trigger_z_mm + above_mm
                await self._lift(end)
        return found

    async def scan(
        self,
        places: Sequence[Place],
        report: Callable[[Measured], None] = lambda _: None,
        *,
        rapid: bool = False,
    ) -> list[Measured]:
        """Measures these places without descents, at `scan_mm`, with a probe that measures heights;
        `rapid`: without stops. Otherwise like `measure`."""
        gauge, probe = self.gauge, self.probe
        if gauge is None or not isinstance(probe, EddyProbe):
            return await self.measure(places, report)
        self.check(places)
        found: list[Measured] = []

        def add(number: int, z_mm: float) -> None:
            place, z = places[number], z_mm + probe.trigger_height_mm
            found.append(Measured(place, round(self._height(place, z), 6), z))
            report(found[-1])

        spots = [self.nozzle_at(place) for place in places]
        async with self._session():
            await self._first(places[0])
            await self._head.move(probe.lift_mm_s, z=probe.scan_mm)
            if rapid:
                scan = BedScan(self._rig, self._interrupts, self._triggered, gauge, spots)
                await scan.run(probe.travel_mm_s, add)
            else:
                for number, (x, y) in enumerate(spots):
                    await self._head.move(probe.travel_mm_s, x=x, y=y)
                    add(number, self._head.z_mm - await gauge.height_mm())
            await self._lift(probe.start_mm)
        return found

    async def frequencies(
        self, place: Place, bed_mm: float, heights_mm: Sequence[float], speed_mm_s: float
    ) -> list[tuple[float, float]]:
        """The frequencies of the probe above a place, with the nozzle at these heights above Z
        `bed_mm`, in this order: pairs of height, mm, and Hz. Each height is approached from above.
        Otherwise like `measure`."""
        gauge = self.gauge
        assert gauge is not None
        self.check([place])
        found: list[tuple[float, float]] = []
        x, y = self.nozzle_at(place)
        async with self._session(calibrated=False):
            await self._lift(bed_mm + _CLEAR_MM)
            await self._head.move(self.probe.travel_mm_s, x=x, y=y)
            for mm in heights_mm:
                await self._head.move(speed_mm_s, z=bed_mm + mm + _LIFT_MM)
                await self._head.move(speed_mm_s, z=bed_mm + mm)
                found.append((mm, await gauge.frequency_hz()))
            await self._lift(bed_mm + _CLEAR_MM)
        return found

    async def height_here(self) -> float:
        """The height of the bed below a probe that measures heights, without a move. Raises as
        `measure`."""
        if self.gauge is None:
            raise CommandError.of("probe.no-scan")
        place = self.place_here()
        self.check([place])
        async with self._session():
            z = await self._measured_z(self.gauge)
        return self._height(place, z)

    async def home(self, farthest_mm: float) -> None:
        """Homes Z by the probe: rises, goes over `homing.z.probe_at_mm`, descends by at most
        `farthest_mm` until the probe triggers, and measures this place like any other. X and Y must
        be homed. At the end, the nozzle is at the start height. After an error, the Z of the plan
        is wrong. Raises as `measure`."""
        job, probe = self._rig.job, self.probe
        if locked := [axis for axis in job.locked_axes if axis < Z]:
            raise CommandError.of("input.not-homed", axis="XY"[locked[0]])
        place = Place(*self._machine.probe_home_mm, "the homing place")
        self.check_place(place)
        x, y = self.nozzle_at(place)
        async with self._session():
            # Whatever the real Z is, this leaves `farthest_mm` of travel down to Z 0
            job.axes.set([(Z, farthest_mm)])
            if not self._deployed and probe.travels_to_deploy:
                await probe.deploy(self._head)
            await self._head.move(probe.travel_mm_s, x=x, y=y)
            if not self._deployed and not probe.travels_to_deploy:
                await probe.deploy(self._head)
            await self._arm()
            self._shift(place, await self._down(place, probe.fast_mm_s, near=False))
            await self._disarm()
            await self._lift(probe.start_mm)
            self._shift(place, (await self._point(place)).trigger_z_mm)
            await self._lift(probe.start_mm)

    def _shift(self, place: Place, trigger_z_mm: float) -> None:
        """Sets Z so that the trigger was at the trigger height of the probe."""
        by = self.trigger_height_mm - self.twisted_mm(place) - trigger_z_mm
        self._rig.job.axes.set([(Z, self._head.z_mm + by)])

    async def samples(self, place: Place, count: int) -> list[float]:
        """The heights of `count` measured descents to one place. Raises as `measure`."""
        self._require_sensor()
        self.check([place])
        async with self._session():
            await self._first(place)
            await self._descend(place, self.probe.fast_mm_s)
            triggers = [await self._again(place) for _ in range(count)]
            await self._lift(self.probe.start_mm)
            return [self._height(place, z) for z in triggers]

    async def _point(self, place: Place) -> Measured:
        """Measures one place: a fast descent, then the measured ones. If the samples differ too
        much, all of them are measured again."""
        probe = self.probe
        first = await self._descend(place, probe.fast_mm_s)
        for left in range(probe.retries, -1, -1):
            samples: list[float] = []
            for _ in range(probe.samples):
                z = await self._again(place)
                if abs(z - first) > APART_MM:
                    limit = f"{APART_MM:g} mm"
                    raise self._failure("probe.apart", place, f"{abs(z - first):.3f} mm", limit)
                samples.append(z)
            spread = max(samples) - min(samples)
            if spread <= probe.tolerance_mm:
                z = median(samples) if probe.result == "median" else fmean(samples)
                return Measured(place, round(self._height(place, z), 6), z)
            if left == 0:
                limit = f"{probe.tolerance_mm:g} mm"
                raise self._failure("probe.unsteady", place, f"{spread:.4f} mm", limit)
        raise AssertionError("a loop of at least one round returns or raises")

    def _height(self, place: Place, trigger_z_mm: float) -> float:
        """The height of the bed, mm, for the Z of the nozzle when the probe triggered."""
        return trigger_z_mm - self.trigger_height_mm + self.twisted_mm(place) + place.offset_mm

    async def _again(self, place: Place) -> float:
        """Lifts the nozzle and makes a measured descent. Returns Z of the nozzle at the trigger."""
        z = self._rig.job.machine_position[Z] + self.probe.retract_mm
        await self._lift(z)
        return await self._descend(place, self.probe.slow_mm_s)

    async def _go_over(self, place: Place) -> None:
        await self._lift(self.probe.start_mm)
        x, y = self.nozzle_at(place)
        await self._head.move(self.probe.travel_mm_s, x=x, y=y)
        await self._head.move(self.probe.lift_mm_s, z=self.probe.start_mm)

    async def _lift(self, z: float) -> None:
        """Lifts the nozzle to `z`, unless it is higher."""
        if self._head.z_mm < z:
            await self._head.move(self.probe.lift_mm_s, z=z)

    async def _descend(self, place: Place, speed_mm_s: float) -> float:
        """Descends until the probe triggers. Returns Z of the nozzle at the trigger."""
        await self._arm()
        z = await self._down(place, speed_mm_s)
        await self._disarm()
        return z

    async def _arm(self) -> None:
        await self.probe.arm(self._head)
        self._armed = True
        for listener in self.before_descent:
            await listener()

    async def _disarm(self) -> None:
        await self.probe.disarm(self._head)
        await self._end_descent()

    async def _end_descent(self) -> None:
        self._armed = False
        for listener in self.after_descent:
            await listener()

    async def _down(self, place: Place, speed_mm_s: float, *, near: bool = True) -> float:
        """Descends until the probe triggers. With `near`, the descent starts at the start height,
        where an immediate trigger is an error."""
        rig, probe = self._rig, self.probe
        if probe.settle_s > 0:
            await self._head.sleep(probe.settle_s)
        await self._open(place)
        switch = self._switch
        finest = max(self._machine.steppers[s].steps_per_unit for s in switch.steppers)

        low, start = self._low_mm(place), self._head.z_mm

        def move() -> None:
            rig.queue.move({Z: low}, speed_mm_s, Within.ANYTHING)

        with self._cold((start - low) / speed_mm_s):
            overshoot = await self._triggered.run([switch], speed_mm_s * finest, move)
        if self._interrupts.halted:
            self._interrupts.raise_if_interrupted()
        endstops = self._triggered.endstops
        hit, lost = PROBE in endstops.hit, PROBE in endstops.expired
        failure = endstops.failed.get(PROBE)
        z = self._machine.geometry.forward(overshoot.triggered(switch))[Z] if hit else 0.0
        self._place(overshoot, switch)
        self._interrupts.raise_if_interrupted()
        if lost:
            raise self._failure("probe.lost", place, "", "")
        if failure is not None:
            raise failure
        if not hit and not near:
            far = f"{start - self._head.z_mm:.1f} mm"
            raise self._failure("probe.home-missed", place, "", far)
        if not hit:
            raise self._failure("probe.missed", place, self._nozzle(), f"Z {low:g} mm")
        if near and z > probe.start_mm - EARLY_MM:
            raise self._failure("probe.early", place, self._nozzle(), f"{EARLY_MM:g} mm")
        return z if self.gauge is None else await self._measured_z(self.gauge)

    async def _measured_z(self, gauge: EddyGauge) -> float:
        """Z at which a probe that measures heights would have triggered, by its height here."""
        return self._head.z_mm - await gauge.height_mm() + self.probe.trigger_height_mm

    async def seek(
        self, target: Mapping[int, float], speed_mm_s: float, *, opening: bool
    ) -> tuple[tuple[float, float, float], bool]:
        """G38: moves in a straight line to `target` (machine mm by slot) until the probe triggers
        or, with `opening`, opens. Returns the position of the nozzle at the trigger, and True; or
        its position at the end of the move, and False if the probe did not trigger or open. Raises
        as `measure`."""
        self.check([])
        rig, machine = self._rig, self._machine
        self._head.heeds_stops = True
        if self.gauge is not None:
            raise CommandError.of("probe.no-touch")
        if self.triggered() != opening:
            raise CommandError.of("probe.wrong-state", value="open" if opening else "triggered")
        switch = probe_switch(machine, ["xyz"[slot] for slot in target])
        assert switch is not None
        finest = max(machine.steppers[s].steps_per_unit for s in switch.steppers)

        def move() -> None:
            rig.queue.move(target, speed_mm_s, Within.ANYTHING)

        end = [target.get(slot, mm) for slot, mm in enumerate(rig.job.machine_position[:3])]
        self._triggered.active = True
        try:
            longest_s = math.dist(self._rig.job.machine_position[:3], end) / speed_mm_s
            off = self._cold(longest_s)
            with self._correction.suspended(), self._triggered.prepared(), off:
                overshoot = await self._triggered.run(
                    [switch], speed_mm_s * finest, move, opening=opening
                )
                if self._interrupts.halted:
                    self._interrupts.raise_if_interrupted()
                hit = PROBE in self._triggered.endstops.hit
                found = machine.geometry.forward(
                    overshoot.triggered(switch) if hit else overshoot.stopped()
                )
                self._place(overshoot, switch)
        finally:
            self._triggered.active = False
        self._interrupts.raise_if_interrupted()
        return found, hit

    def _low_mm(self, place: Place) -> float:
        """The lowest Z of the nozzle at a place: `low_mm` relative to the last measured bed, or to
        Z 0, but not below what the limits of the motors allow."""
        low = round(self.probe.low_mm + self._correction.expected(place.x, place.y), 4)
        x, y, z, *_ = self._rig.job.machine_position
        if self._machine.allows((x, y, low)):
            return low
        above, below = z, low
        while above - below > _LIMIT_MM:
            middle = (above + below) / 2
            if self._machine.allows((x, y, middle)):
                above = middle
            else:
                below = middle
        return above

    def _place(self, overshoot: TriggerOvershoot, switch: Switch) -> None:
        """Sets the axis positions from the step counts of the boards. Axes whose motors were not
        stopped keep the position of the plan, which may be between two steps."""
        point = self._machine.geometry.forward(overshoot.stopped())
        moved = {d.index for s in switch.steppers if (d := self._machine.driven_by(s))}
        axes = (Z,) if switch == self._switch and len(moved) == 1 else (X, Y, Z)
        self._rig.job.axes.set([(axis, point[axis]) for axis in axes], triggered=True)

    async def _open(self, place: Place) -> None:
        """Makes sure that the probe is open before a descent, after a further lift if necessary."""
        lifted = 0.0
        while self.triggered():
            if lifted >= self.probe.open_within_mm:
                limit = f"{lifted:g} mm"
                raise self._failure("probe.triggered", place, self._nozzle(), limit)
            lifted += _LIFT_MM
            await self._lift(self._rig.job.machine_position[Z] + _LIFT_MM)

    @contextmanager
    def _cold(self, longest_s: float) -> Generator[None]:
        """Stops some heaters within the block, unless it may take too long. Their targets stay, so
        that a user may change them in the meantime."""
        names = self.probe.heaters_off if longest_s <= COLD_S else ()
        heaters = [self._rig.connection.heaters[name] for name in names]
        for heater in heaters:
            heater.suspended = True
        try:
            yield
        finally:
            for heater in heaters:
                heater.suspended = False

    def _nozzle(self) -> str:
        x, y, z, *_ = self._rig.job.machine_position
        return f"X{x:.3f} Y{y:.3f} Z{z:.3f}"

    def _failure(self, code: str, place: Place, position: str, limit: str) -> CommandError:
        return CommandError.of(
            code,
            axis=place.name.capitalize(),
            value=str(place),
            position=position,
            limit=limit,
        )
