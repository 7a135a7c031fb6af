"""The status of a printer, as typed values: the one source of M408, the web and the Python API."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from math import isfinite
from typing import TYPE_CHECKING, Any

from passo.config.motor_roles import axis_order
from passo.levelling.mesh import Mesh
from passo.levelling.mesh_files import StoredMesh
from passo.motion.axis_slots import E, X, Y, Z

if TYPE_CHECKING:
    from collections.abc import Mapping

    from passo import _core
    from passo.config.machine import MachineConfig


class PrinterState(Enum):
    """The state of a printer; the values are the letters of M408."""

    IDLE = "I"
    BUSY = "B"  # it moves, or a command waits
    PRINTING = "P"
    PAUSED = "A"
    HALTED = "H"  # nothing moves or heats until M999


@dataclass(frozen=True, slots=True)
class HeaterStatus:
    """A heater. `celsius` is None until its sensor has reported; `target_c` is 0 while it is off;
    `power` is a fraction of full power; `fault` is the sentence of a protection, or empty. Below
    `min_extrude_c` a hotend moves no filament; 0: it does at any temperature (M302), or it is not a
    hotend."""

    celsius: float | None
    target_c: float
    power: float
    fault: str = ""
    min_extrude_c: float = 0.0


@dataclass(frozen=True, slots=True)
class PrintObject:
    """An object that the file labels. `number` is the one of M486, or its index in the file; `name`
    is empty if the file has none. `centre_mm` and `outline_mm`, X and Y, are those of
    EXCLUDE_OBJECT_DEFINE, else None and empty."""

    number: int
    name: str
    cancelled: bool = False
    centre_mm: tuple[float, float] | None = None
    outline_mm: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True, slots=True)
class JobStatus:
    """The file that is printed. `fraction` is the part of its time that is done, or of its bytes
    while its time is not known yet, 0 to 1; `line` and `layer` are those of the current move (0:
    none yet); `printed_s` is the print time so far, without pauses; `left_s` is the time that the
    rest of its moves takes, without heating. `layers` and `left_s` are None while they are not
    known. `current_object` is the number, among `objects`, of the one that is printed now. `path`
    is its path on the card; `offset` of its `size` bytes are read and planned; `elapsed_s` is host
    time since the start, with pauses; `filament_mm` is the filament that all extruders have pushed
    for it, without pauses; `extruding_s` is the part of `printed_s` since the first extrusion, or
    all of it on a machine without filament."""

    file: str
    fraction: float
    line: int
    layer: int
    layers: int | None
    printed_s: float
    left_s: float | None
    objects: tuple[PrintObject, ...] = ()
    current_object: int | None = None
    path: str = ""
    size: int = 0
    offset: int = 0
    elapsed_s: float = 0.0
    filament_mm: float = 0.0
    extruding_s: float = 0.0


@dataclass(frozen=True, slots=True)
class AxisStatus:
    """An axis. `position_mm` is the plan's current position, in the program's coordinates;
    `machine_mm` the same in the machine's. `homed`: its position is certain. Targets are kept
    between `min_mm` and `max_mm`, in machine coordinates."""

    position_mm: float
    machine_mm: float
    homed: bool
    min_mm: float
    max_mm: float
    babystep_mm: float = 0.0


@dataclass(frozen=True, slots=True)
class MotionStatus:
    """The motion of the machine. `speed_mm_s` is that of the nozzle now, `filament_mm_s` that of
    the filament; `queued_s` is the duration of the planned motion. `max_speed_mm_s`,
    `max_accel_mm_s2`, `minimum_cruise_ratio` and `junction_deviation_mm` are the limits of the
    path; the first is None if the axes alone limit it. `absolute`, `absolute_e` and `feedrate_mm_s`
    hold for the next move of the program. It begins at `end_mm` of the machine, X, Y, Z and
    filament, which is `program_end_mm` of the program."""

    speed_mm_s: float
    filament_mm_s: float
    queued_s: float
    max_speed_mm_s: float | None
    max_accel_mm_s2: float
    absolute: bool
    absolute_e: bool
    feedrate_mm_s: float
    motors_on: bool
    end_mm: tuple[float, float, float, float]
    program_end_mm: tuple[float, float, float, float]
    minimum_cruise_ratio: float
    junction_deviation_mm: float

    @classmethod
    def of(
        cls,
        job: _core.Job,
        *,
        speed_mm_s: float = 0.0,
        filament_mm_s: float = 0.0,
        queued_s: float = 0.0,
        motors_on: bool = True,
    ) -> MotionStatus:
        """The motion status of a job now; the arguments are the values that the job does not
        know."""
        machine, program = job.machine_position, job.program_position
        absolute, absolute_e, feed_mm_s = job.modal
        return cls(
            speed_mm_s=speed_mm_s,
            filament_mm_s=filament_mm_s,
            queued_s=queued_s,
            max_speed_mm_s=speed if isfinite(speed := job.limit("speed")) else None,
            max_accel_mm_s2=job.limit("print_accel"),
            absolute=absolute,
            absolute_e=absolute_e,
            feedrate_mm_s=feed_mm_s if isfinite(feed_mm_s) else 0.0,
            motors_on=motors_on,
            end_mm=(machine[X], machine[Y], machine[Z], machine[E]),
            program_end_mm=(program[X], program[Y], program[Z], program[-1]),
            minimum_cruise_ratio=job.limit("minimum_cruise_ratio"),
            junction_deviation_mm=job.limit("junction_deviation"),
        )


@dataclass(frozen=True, slots=True)
class BoardStatus:
    """A board. `firmware` is the version of its firmware; `bytes_sent` and `bytes_resent` count the
    traffic of its link since the start; `simulated`: it is software. `awake_s` is how much of the
    last 5 s its firmware had work; `task_s` and `task_deviation_s` are mean and standard deviation
    of one pass of its work. None until it reports them, and for a simulated chip."""

    firmware: str
    mcu: str
    clock_hz: float
    simulated: bool
    bytes_sent: int
    bytes_resent: int
    awake_s: float | None = None
    task_s: float | None = None
    task_deviation_s: float | None = None


@dataclass(frozen=True, slots=True)
class FaultStatus:
    """An error of the catalogue: its code, the part that it concerns, the sentence, and the next
    action."""

    code: str
    part: str
    text: str
    action: str


@dataclass(frozen=True, slots=True)
class FilesStatus:
    """The card: whether it is mounted, the path of the file that is selected to print, or empty,
    and the folder that is the card, or empty."""

    mounted: bool
    selected: str
    folder: str = ""


@dataclass(frozen=True, slots=True)
class EndedJob:
    """A print that is over: done, cancelled or failed, why it failed, and its progress."""

    outcome: str
    reason: str
    job: JobStatus


@dataclass(frozen=True, slots=True)
class BedPoint:
    """A place of the bed, mm, and its height as it was measured."""

    x_mm: float
    y_mm: float
    height_mm: float


@dataclass(frozen=True, slots=True)
class BedSurface:
    """What the correction adds to Z, in mm, at even places from one corner of the bed to the
    opposite one: rows along X, the front one first."""

    from_mm: tuple[float, float]
    to_mm: tuple[float, float]
    rows_mm: tuple[tuple[float, ...], ...]


@dataclass(frozen=True, slots=True)
class ManualProbeStatus:
    """A paper test: point `number` of `count`, Z of the nozzle, and the nearest heights that were
    tried below and above it, mm."""

    number: int
    count: int
    z_mm: float
    below_mm: float | None
    above_mm: float | None


@dataclass(frozen=True, slots=True)
class BedStatus:
    """How the bed is measured and corrected. `method` and `probe` are those of the machine file;
    `on`: the correction is in force; `profile` is the stored mesh in use, or empty, and `meshes`
    are all that are stored; `mesh` is the one in use. `points` are those that were measured last;
    `rms_mm` is what they deviate from their mean, `left_rms_mm` from the correction; both are None
    without any. `surface` is the correction itself, None without one; `fade_mm` the height at which
    it has faded out. `probe_offset_mm` and `trigger_height_mm` are as M851 has set them. `measured`
    of `to_measure` points are done in a run; both are 0 without one. `manual` is the paper test
    under way; `triggered` is what the probe was when it was asked last."""

    method: str
    on: bool
    profile: str
    points: tuple[BedPoint, ...]
    rms_mm: float | None
    left_rms_mm: float | None
    surface: BedSurface | None
    fade_mm: float | None
    probe: str
    probe_offset_mm: tuple[float, float]
    trigger_height_mm: float
    measured: int
    to_measure: int
    manual: ManualProbeStatus | None
    mesh: Mesh | None
    meshes: dict[str, StoredMesh]
    triggered: bool


@dataclass(frozen=True, slots=True)
class ScrewStatus:
    """A screw of the bed as it was measured last: the height of the bed there, mm, and what to
    turn: `adjust` are turns and minutes of a clock, `CW` or `CCW` before them. `base`: it stays."""

    name: str
    height_mm: float
    adjust: str
    base: bool


@dataclass(frozen=True, slots=True)
class Status:
    """A printer at one moment. Positions are the program's coordinates of where the machine is, in
    mm, by axis and `e`; `homed` are the axes whose position is certain; fans
    are fractions of full speed; `time_s` is print time since the start; `halted` says why nothing
    moves or heats, or is empty, and `faults` the same as errors of the catalogue; `link` is a name
    of `LinkState` in lower case; `message` is the text of M117; `progress` is the fraction of a
    print that is done, also of a host's that reports it (M73, M532); `job` is None while no file is
    printed; `ended` is the last print, until another file is selected; `started`: the boards have
    started at least once; `macros` are the variables of the macros, by name. Below `min_extrude_c`
    the hotend of `tool` moves no filament; 0: it does at any temperature (M302). `unsaved` are the
    settings that M500 would change on its medium, as commands with their values, by headings;
    `saved_variables` are those of SAVE_VARIABLE. `bed` is None on a machine without a probe.
    `moving_s` is the print time for which the machine has printed or moved without a rest.
    `gantry_level`: the motors of Z have levelled the gantry, and were on since then; None where
    they cannot. `screws` are those of the bed as they were measured last, `screws_limit_mm` what
    they may differ by, if they differ by more.
    """

    state: PrinterState
    halted: str
    time_s: float
    position_mm: dict[str, float]
    homed: frozenset[str]
    tool: int
    heaters: dict[str, HeaterStatus]
    fans: dict[str, float]
    speed_factor: float
    motion: MotionStatus
    axes: dict[str, AxisStatus]
    boards: dict[str, BoardStatus]
    flow_factors: list[float] = field(default_factory=list[float])
    faults: tuple[FaultStatus, ...] = ()
    link: str = "connected"
    message: str = ""
    power_supply: bool = True
    files: FilesStatus = FilesStatus(mounted=False, selected="")
    progress: float | None = None
    job: JobStatus | None = None
    ended: EndedJob | None = None
    started: bool = True
    macros: dict[str, dict[str, Any]] = field(default_factory=dict[str, dict[str, Any]])
    min_extrude_c: float = 0.0
    unsaved: dict[str, dict[str, str]] = field(default_factory=dict[str, dict[str, str]])
    saved_variables: dict[str, Any] = field(default_factory=dict[str, Any])
    moving_s: float = 0.0
    bed: BedStatus | None = None
    gantry_level: bool | None = None
    screws: tuple[ScrewStatus, ...] = ()
    screws_limit_mm: float | None = None


def planned_status(
    machine: MachineConfig,
    job: _core.Job,
    targets_c: Mapping[str, float],
    fans: Mapping[str, float],
) -> Status:
    """The status of a program that is planned without a printer: `targets_c`, as commands have set
    them, count as reached."""
    reached = {name: targets_c.get(name, 0.0) for name in machine.heaters}
    axes, locked = axis_order(machine.axes), job.locked_axes
    return Status(
        state=PrinterState.PRINTING,
        halted="",
        time_s=job.clock / machine.board.clock_hz,
        position_mm={},
        homed=frozenset(name for i, name in enumerate(axes) if i not in locked),
        tool=job.tool,
        heaters={name: HeaterStatus(c if c > 0 else None, c, 0.0) for name, c in reached.items()},
        fans={name: fans.get(name, 0.0) for name in machine.fans},
        speed_factor=job.speed_factor,
        motion=MotionStatus.of(job),
        axes={},
        boards={},
        flow_factors=list(job.flows),
    )
