"""The status of a printer, as typed values: the one source of M408, the web and the Python API."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from math import isfinite
from typing import TYPE_CHECKING, Any, Literal

from passo.config.lights import Color
from passo.levelling.mesh import Mesh
from passo.levelling.mesh_files import StoredMesh
from passo.motion.axis_slots import E, X, Y, Z

if TYPE_CHECKING:
    from passo import _core


class PrinterState(Enum):
    """The state of a printer; the values are the letters of M408."""

    IDLE = "I"
    BUSY = "B"  # the machine moves, or a command waits
    PRINTING = "P"
    PAUSED = "A"
    HALTED = "H"  # the printer is halted until M999


@dataclass(frozen=True, slots=True)
class HeaterStatus:
    """A heater. `celsius` is the last reading of its sensor, None before the first one; `age_s` is
    0 while the board reports, otherwise the age of this reading in s. `target_c` is 0 while it is
    off; `power` is a fraction of full power; `fault` is the kind of the protection that has
    switched it off (its error is `heat.` and the kind), or empty. Below `min_extrude_c` a hotend
    moves no filament; 0 means no limit (M302), or not a hotend."""

    celsius: float | None
    target_c: float
    power: float
    fault: str = ""
    min_extrude_c: float = 0.0
    age_s: float = 0.0

    @property
    def current_c(self) -> float | None:
        """The reading, unless it is old."""
        return None if self.age_s else self.celsius


@dataclass(frozen=True, slots=True)
class FilamentSensorStatus:
    """A filament sensor: whether it detects filament, whether it is enabled, and whether it
    measures the motion of the filament. A width sensor has the diameter of the filament in it, its
    `reading`, whether it measures, and the factor of the flow for the filament in the nozzle."""

    detected: bool
    enabled: bool
    moves: bool = False
    diameter_mm: float | None = None
    reading: float = 0.0
    measures: bool = False
    flow_factor: float = 1.0


@dataclass(frozen=True, slots=True)
class FaultStatus:
    """An error of the catalogue: its code, the affected part, the sentence, and the next action."""

    code: str
    part: str
    text: str
    action: str


@dataclass(frozen=True, slots=True)
class InputStatus:
    """An input of a filament sensor or a button as its board reports it, without debouncing.
    `active` is None until the first report; `changes` counts the changes since the start, which
    are the pulses of a motion sensor."""

    active: bool | None
    changes: int


@dataclass(frozen=True, slots=True)
class DriverStatus:
    """A motor driver with registers. `run_a` and `hold_a` are its RMS currents; `mode` is
    stealthChop or spreadCycle. `flags` are the fields of its status register that are not 0; None
    until it has reported them, and while it does not answer. `temperature_c` and `supply_v` are
    None unless the chip measures them. `findings` are its faults and warnings, each with the next
    action."""

    chip: str
    run_a: float
    hold_a: float
    microsteps: int
    mode: str
    flags: dict[str, int] | None
    temperature_c: float | None = None
    supply_v: float | None = None
    findings: tuple[FaultStatus, ...] = ()


@dataclass(frozen=True, slots=True)
class SensorStatus:
    """A temperature sensor without a heater. `celsius` is its last reading, None before the first
    one and while the sensor is broken; `lowest_c` and `highest_c` are its extremes since the start.
    `fault` is `open`, `short`, `silent`, `garbled`, `other-chip` or `apart` for a broken sensor,
    `low` or `high` beyond its range, or empty. `age_s` is 0 while the board reports, otherwise the
    age of the reading in s. `humidity`, %, and `pressure_hpa` are None if the sensor does not
    measure them."""

    celsius: float | None
    lowest_c: float | None
    highest_c: float | None
    fault: str = ""
    age_s: float = 0.0
    humidity: float | None = None
    pressure_hpa: float | None = None


@dataclass(frozen=True, slots=True)
class PrintObject:
    """An object that the file labels. `number` is the number in M486, or its index in the file;
    `name` is empty if the file has none. `centre_mm` and `outline_mm`, X and Y, come from
    EXCLUDE_OBJECT_DEFINE; without it they are None and empty."""

    number: int
    name: str
    cancelled: bool = False
    centre_mm: tuple[float, float] | None = None
    outline_mm: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True, slots=True)
class JobStatus:
    """The file that is being printed. `fraction`, 0 to 1, is the part of its print time that is
    done, or of its bytes while its print time is unknown; `line` and `layer` are those of the
    current move (0: none yet); `printed_s` is the print time so far, without pauses; `left_s` is
    the duration of its remaining moves, without heating. `layers` and `left_s` are None while they
    are unknown. `current_object` is the number of the object that is being printed, one of
    `objects`. `path` is its path on the card; `offset` of its `size` bytes are read and planned;
    `elapsed_s` is host time since the start, with pauses; `filament_mm` is the filament of all
    extruders for this print, without moves in pauses; `extruding_s` is the part of `printed_s`
    since the first extrusion, or `printed_s` on a machine without filament. `slicer_layer` and
    `slicer_layers` are those of SET_PRINT_STATS_INFO; None without it. `run` is the run id with
    which the print was started, or empty."""

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
    slicer_layer: int | None = None
    slicer_layers: int | None = None
    run: str = ""


@dataclass(frozen=True, slots=True)
class AxisStatus:
    """An axis. `position_mm` is the plan's current position in program coordinates, `machine_mm`
    the same in machine coordinates. If `homed`, the position is certain. Targets must be between
    `min_mm` and `max_mm`, in machine coordinates."""

    position_mm: float
    machine_mm: float
    homed: bool
    min_mm: float
    max_mm: float
    babystep_mm: float = 0.0


@dataclass(frozen=True, slots=True)
class MotionStatus:
    """The motion of the machine. `speed_mm_s` is the current speed of the nozzle, `filament_mm_s`
    that of the filament; `queued_s` is the duration of the planned motion. `max_speed_mm_s`,
    `max_accel_mm_s2`, `minimum_cruise_ratio`, `junction_deviation_mm` and `square_corner_mm_s` are
    the limits of the path; the first is None if only the axes limit the speed, and the law of
    corners uses at most one of the last two. `absolute`, `absolute_e` and `feedrate_mm_s` apply to
    the next move of the program. That move begins at `end_mm` (X, Y, Z and filament in machine
    coordinates), which is `program_end_mm` in program coordinates."""

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
    square_corner_mm_s: float

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
        """The motion status of a job now; the other arguments are values that the job does not
        have."""
        machine, program = job.machine_position, job.program_position
        absolute, absolute_e, feed_mm_s = job.modes.now
        return cls(
            speed_mm_s=speed_mm_s,
            filament_mm_s=filament_mm_s,
            queued_s=queued_s,
            max_speed_mm_s=speed if isfinite(speed := job.limits.value("speed")) else None,
            max_accel_mm_s2=job.limits.value("print_accel"),
            absolute=absolute,
            absolute_e=absolute_e,
            feedrate_mm_s=feed_mm_s if isfinite(feed_mm_s) else 0.0,
            motors_on=motors_on,
            end_mm=(machine[X], machine[Y], machine[Z], machine[E]),
            program_end_mm=(program[X], program[Y], program[Z], program[-1]),
            minimum_cruise_ratio=job.limits.value("minimum_cruise_ratio"),
            junction_deviation_mm=job.limits.value("junction_deviation"),
            square_corner_mm_s=job.limits.value("square_corner"),
        )


@dataclass(frozen=True, slots=True)
class BoardStatus:
    """A board. `firmware` is the version of its firmware; `bytes_sent` and `bytes_resent` count the
    traffic of its link since the start; `simulated`: the board is software. `awake_s` is the busy
    time of its firmware in the last 5 s; `task_s` and `task_deviation_s` are the mean and the
    standard deviation of one pass of its main loop, in seconds. These are None until the board
    reports them, and always for a simulated chip."""

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
class FilesStatus:
    """The card: whether it is mounted, the path of the file that is selected for printing, and the
    folder of the card; each path may be empty."""

    mounted: bool
    selected: str
    folder: str = ""


@dataclass(frozen=True, slots=True)
class EndedJob:
    """A finished print: its result (done, cancelled or failed), the reason of a failure, and its
    progress. `problems` are the errors of the reason, if they are known."""

    outcome: str
    reason: str
    job: JobStatus
    problems: tuple[FaultStatus, ...] = ()


@dataclass(frozen=True, slots=True)
class LastPrint:
    """The newest finished print of the history, from the card or by a host. `number` identifies it;
    `run` is the run id with which it was started, or empty; `reason` says why it has failed. An
    interrupted print has failed."""

    number: int
    file: str
    run: str
    result: Literal["done", "cancelled", "failed"]
    reason: str


@dataclass(frozen=True, slots=True)
class InterruptedPrint:
    """A print that a power cut, a halt or the end of the program has interrupted, and that M1000
    resumes. `path` is its path on the card, `line` the line where it stopped (0: before its first
    move). `way` continues the sentence "M1000 resumes it": from where, and what to do by hand
    first."""

    path: str
    line: int
    way: str


@dataclass(frozen=True, slots=True)
class QueuedPrint:
    """A queued file of the card; `number` identifies it while it waits."""

    number: int
    path: str


@dataclass(frozen=True, slots=True)
class Queue:
    """The queued prints, the next one first. With `automatic`, the next print starts without
    confirmation after a successful print; otherwise a user must confirm that the bed is clear."""

    prints: tuple[QueuedPrint, ...] = ()
    automatic: bool = False


@dataclass(frozen=True, slots=True)
class BedPoint:
    """A place of the bed and its measured height, mm."""

    x_mm: float
    y_mm: float
    height_mm: float


@dataclass(frozen=True, slots=True)
class BedSurface:
    """The heights that the correction adds to Z, in mm, on an even grid from one corner of the bed
    to the opposite one: rows along X, the front row first."""

    from_mm: tuple[float, float]
    to_mm: tuple[float, float]
    rows_mm: tuple[tuple[float, ...], ...]


@dataclass(frozen=True, slots=True)
class ManualProbeStatus:
    """A paper test: point `number` of `count`, the Z of the nozzle, and the nearest tried heights
    below and above it, mm."""

    number: int
    count: int
    z_mm: float
    below_mm: float | None
    above_mm: float | None


@dataclass(frozen=True, slots=True)
class BedStatus:
    """The measurement and the correction of the bed. `method` and `probe` come from the machine
    file. `on`: the correction is active. `profile` is the name of the active stored mesh, or empty;
    `meshes` are all stored meshes; `mesh` is the active one. `points` are the last measured points;
    `rms_mm` is their RMS deviation from their mean, `left_rms_mm` that from the correction; both
    are None without points. `surface` is the correction itself, None without one; `fade_mm` is the
    height at which it has faded out. `probe_offset_mm` and `trigger_height_mm` are the values of
    M851. During a run, `measured` of `to_measure` points are done; otherwise both are 0. `manual`
    is the paper test in progress. `triggered` is the state of the probe at its last query.
    `holds_babysteps`: Z_OFFSET_APPLY_PROBE stores the babysteps of Z; else Z_OFFSET_APPLY_ENDSTOP
    does."""

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
    holds_babysteps: bool


@dataclass(frozen=True, slots=True)
class ShaperStatus:
    """The input shaper of an axis; 0 Hz: the axis is not shaped."""

    type: str
    frequency_hz: float
    damping: float


@dataclass(frozen=True, slots=True)
class AdvanceStatus:
    """The pressure advance of an extruder, and the time over which it is smoothed."""

    advance_s: float
    smooth_s: float


@dataclass(frozen=True, slots=True)
class RetractionStatus:
    """The retraction of G10 and G11: the length and its speed, the length that G11 returns in
    addition, and the speed of G11."""

    length_mm: float
    speed_mm_s: float
    extra_mm: float
    return_mm_s: float

    @classmethod
    def of(cls, job: _core.Job) -> RetractionStatus:
        """The retraction of a job now."""
        length_mm, speed_mm_s, _, extra_mm, return_mm_s, *_ = job.modes.retraction
        return cls(length_mm, speed_mm_s, extra_mm, return_mm_s or speed_mm_s)


@dataclass(frozen=True, slots=True)
class ScrewStatus:
    """The last measurement of a bed screw. `height_mm` is the height of the bed at the screw.
    `adjust` is how to turn it: `CW` or `CCW`, and turns as `full:minutes`, where 60 minutes are one
    turn. `base` marks the reference screw, which is not turned."""

    name: str
    height_mm: float
    adjust: str
    base: bool


@dataclass(frozen=True, slots=True)
class Status:
    """The status of a printer at one moment. Positions are the current position in program
    coordinates, in mm, by axis and `e`; `homed` are the axes with a certain position; fans are
    fractions of full speed; `time_s` is print time since the start; `halted` is the reason why the
    printer is halted, or empty, and `faults` has the same as errors of the catalogue; `link` is a
    name of `LinkState` in lower case; `message` is the text of M117; `question` is the question
    that waits for an answer of the user (M0, a pause), or empty: M876 S0 answers it; `progress` is
    the fraction of the print that is done; for a print by a host, the host reports it (M73, M532).
    `job` is None while no file is printed; `ended` is the last print, until another file is
    selected; `last_print` is the newest row of the history; `interrupted` is the print that M1000
    resumes, None without one; `queue` are the prints that wait; `started`: the boards have started
    at least once; `macros` are the variables of the macros, by name. Below `min_extrude_c` the
    hotend of `tool` moves no filament; 0 means no limit (M302). `unsaved` are the settings that
    M500 would change, as commands with their values, by headings, without those that files and
    pages change for a while; `saved_variables` are the variables of SAVE_VARIABLE. `bed` is None on
    a machine without a probe. `moving_s` is the print time for which the machine has printed or
    moved without a break. `gantry_level`: the Z motors have levelled the gantry, and have been on
    since then; None on a machine that cannot do this. `skew_profile` is the name of the active
    saved skew, or empty; None without skew and profiles. `screws` are the last measurements of the
    bed screws; `screws_limit_mm` is their allowed difference, if it is exceeded. `shapers` are the
    input shapers by axis, `advances` the pressure advance of each extruder; `retraction` is None on
    a machine without filament. `cooled_c` are the targets of the heaters that a long pause or a
    fault has switched off, °C by name: they warm up before the print resumes. `buttons` are the
    buttons by name, with True while they are pressed. `outputs` are fractions of fully on, without
    outputs that are fixed; `sensors` are those without a heater; `fan_targets_c` are the targets of
    the fans with a thermostat, 0 while they are off. `inputs` are those of filament sensors
    (`filament-` and the name) and buttons (`button-` and the name)."""

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
    question: str = ""
    power_supply: bool = True
    files: FilesStatus = FilesStatus(mounted=False, selected="")
    progress: float | None = None
    job: JobStatus | None = None
    ended: EndedJob | None = None
    last_print: LastPrint | None = None
    interrupted: InterruptedPrint | None = None
    queue: Queue = Queue()
    started: bool = True
    macros: dict[str, dict[str, Any]] = field(default_factory=dict[str, dict[str, Any]])
    min_extrude_c: float = 0.0
    unsaved: dict[str, dict[str, str]] = field(default_factory=dict[str, dict[str, str]])
    saved_variables: dict[str, Any] = field(default_factory=dict[str, Any])
    moving_s: float = 0.0
    bed: BedStatus | None = None
    skew_profile: str | None = None
    gantry_level: bool | None = None
    screws: tuple[ScrewStatus, ...] = ()
    screws_limit_mm: float | None = None
    shapers: dict[str, ShaperStatus] = field(default_factory=dict[str, ShaperStatus])
    advances: tuple[AdvanceStatus, ...] = ()
    retraction: RetractionStatus | None = None
    cooled_c: dict[str, float] = field(default_factory=dict[str, float])
    outputs: dict[str, float] = field(default_factory=dict[str, float])
    fan_targets_c: dict[str, float] = field(default_factory=dict[str, float])
    servos_us: dict[str, float] = field(default_factory=dict[str, float])
    fan_rpm: dict[str, float | None] = field(default_factory=dict[str, float | None])
    lights: dict[str, tuple[Color, ...]] = field(default_factory=dict[str, tuple[Color, ...]])
    sensors: dict[str, SensorStatus] = field(default_factory=dict[str, SensorStatus])
    filament_sensors: dict[str, FilamentSensorStatus] = field(
        default_factory=dict[str, FilamentSensorStatus]
    )
    buttons: dict[str, bool] = field(default_factory=dict[str, bool])
    inputs: dict[str, InputStatus] = field(default_factory=dict[str, InputStatus])
    drivers: dict[str, DriverStatus] = field(default_factory=dict[str, DriverStatus])
