"""The bed, the probe, and how the bed is levelled."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from passo.config.importing.draft import bad
from passo.config.importing.marlin.derived import PROBES
from passo.config.importing.marlin.homing import is_inverted, switch_pin

if TYPE_CHECKING:
    from passo.config.importing.draft import KeyPath
    from passo.config.importing.marlin.conversion import Job
    from passo.config.importing.numbers import Read

_START_MM, _ABOVE_MM = 10.0, 3.0  # of a descent, and at least above where the probe triggers
_LOWEST_MM = -2.0  # Marlin's Z_PROBE_LOW_POINT, below where the probe triggers
_SERVO_DEG = (70, 0)
_EDGE_MM = 10.0  # Marlin's margin of the bed
_KINDS = {
    "BLTOUCH": "bltouch",
    "Z_PROBE_SERVO_NR": "servo",
    "FIX_MOUNTED_PROBE": "fixed",
    "Z_PROBE_FIX_MOUNTED": "fixed",
    "NOZZLE_AS_PROBE": "nozzle",
    "PROBE_MANUALLY": "manual",
}
_BY_HAND = "a probe that is fetched, turned or moved: set [probe] kind by hand"
_THREADS = ("M3", "M4", "M5")


def put_bed(job: Job) -> None:
    """Sets the printable area."""
    put, defines = job.draft.put, job.defines
    centred = defines.on("BED_CENTER_AT_0_0")  # as a delta always is
    if job.kind == "delta":
        reach = job.needed("PRINTABLE_RADIUS", "DELTA_PRINTABLE_RADIUS")
        put(("bed", "round"), True, None)
        put(("bed", "size_mm"), [2 * reach.value, 2 * reach.value], reach.place)
        put(("bed", "center_mm"), [0.0, 0.0], None)
        return
    size = [defines.number(f"{axis}_BED_SIZE") for axis in "XY"]
    sides = [one.value for one in size if one is not None]
    if len(sides) < 2 or min(sides) <= 0:
        return
    place = job.place("X_BED_SIZE")
    centre = [0.0, 0.0] if centred else [side / 2 for side in sides]
    put(("bed", "size_mm"), [float(side) for side in sides], place)
    put(("bed", "center_mm"), [*centre], place)


def put_probe(job: Job) -> None:
    """Converts the probe. Sets `job.trigger_mm`, with which Z may be homed. Raises ConfigError."""
    defines, put, path = job.defines, job.draft.put, ("probe",)
    kind, define = _kind(job)
    if define is None:
        return
    if kind is None:
        job.decide(define, _BY_HAND)
        return
    put((*path, "kind"), kind, job.place(define))
    offsets = _offsets(job)
    if kind == "manual" or len(offsets) < 3:
        if kind != "manual":
            job.decide(define, "the offset of the probe is not in the file: probe.offset_mm")
    else:
        put((*path, "offset_mm"), [offsets[0].value, offsets[1].value], offsets[0].place)
    height = -offsets[2].value if len(offsets) > 2 and kind != "manual" else 0.0
    clearance = defines.number("Z_CLEARANCE_BETWEEN_PROBES", "Z_PROBE_BETWEEN_HEIGHT")
    start = clearance.value if clearance else _START_MM
    place = clearance.place if clearance else None
    put((*path, "start_mm"), round(max(start, height + _ABOVE_MM), 3), place)
    job.rows("probe")
    if kind == "manual":
        return
    _put_pin(job, path)
    job.trigger_mm = height
    place = offsets[2].place if len(offsets) > 2 else None
    put((*path, "trigger_height_mm"), round(height, 4), place)
    _put_descent(job, path, height)
    _put_samples(job, path)
    if kind == "servo":
        angles = defines.numbers("Z_SERVO_ANGLES") or []
        down, up = [one.value for one in angles][:2] if len(angles) > 1 else _SERVO_DEG
        put((*path, "deploy_deg"), down, angles[0].place if angles else None)
        put((*path, "stow_deg"), up, angles[0].place if angles else None)
    if kind == "bltouch":
        job.rows("bltouch")
    if defines.on("PROBING_HEATERS_OFF") and job.hotends:
        put((*path, "heaters_off"), [*job.hotends.values()], job.place("PROBING_HEATERS_OFF"))


def _offsets(job: Job) -> list[Read]:
    """X, Y and Z of the probe, or fewer if the file does not have them all."""
    found = job.defines.numbers("NOZZLE_TO_PROBE_OFFSET")
    if found is not None:
        return found
    ends = ("EXTRUDER", "NOZZLE")
    older = [job.defines.number(*(f"{a}_PROBE_OFFSET_FROM_{end}" for end in ends)) for a in "XYZ"]
    return [one for one in older if one is not None]


def _put_descent(job: Job, path: KeyPath, height: float) -> None:
    """Converts the end and the speeds of a descent to a trigger at this height, mm."""
    low = job.defines.number("Z_PROBE_LOW_POINT")
    below = low.value if low and low.value < 0 else _LOWEST_MM
    job.draft.put((*path, "low_mm"), round(height + below, 4), low.place if low else None)
    job.rows("descent")


def _put_samples(job: Job, path: KeyPath) -> None:
    """Converts the number of samples. With two, Marlin descends fast, then slowly, as Passo always
    does."""
    found = job.defines.number("MULTIPLE_PROBING", "Z_PROBE_REPETITIONS")
    extra = job.defines.number("EXTRA_PROBING")
    if found is None:
        return
    total = found.whole(0, 50) + (extra.whole(0, 50) if extra else 0)
    job.draft.put((*path, "samples"), min(total, 50) if total > 2 else 1, found.place)


def _kind(job: Job) -> tuple[str | None, str | None]:
    """The kind of the probe and its define. A kind is None if Passo has none like it."""
    defines = job.defines
    for name, kind in _KINDS.items():
        if defines.on(name) or (name == "Z_PROBE_SERVO_NR" and defines.first(name)):
            return kind, name
    other = next((name for name in PROBES if defines.on(name)), None)
    if other is None and defines.on("MESH_BED_LEVELING"):
        return "manual", "MESH_BED_LEVELING"
    return None, other


def _put_pin(job: Job, path: KeyPath) -> None:
    defines, put = job.defines, job.draft.put
    pins, board = job.pins, job.pins.board
    own = pins.given("Z_MIN_PROBE_PIN")
    shared = defines.on("Z_MIN_PROBE_USES_Z_MIN_ENDSTOP_PIN")
    named = next((n for n in ("PROBE", "Z_PROBE") if n in board.pins), None)
    if own is None and shared:
        pin = switch_pin(job, "Z", "min")
    elif own is None and named is None:
        pin = None
    else:
        end = "Z_MIN_PROBE"
        pull = "^" if defines.on("ENDSTOPPULLUPS", "ENDSTOPPULLUP_ZMIN_PROBE") else ""
        pin = f"{'!' if is_inverted(job, end) else ''}{pull}{own or named}"
    what = next(name for name in (_kind(job)[1],) if name is not None)
    if pin is None:
        limit = f"a pin of the board {board.name}"
        raise bad(defines.place(what), "Z_MIN_PROBE_PIN", "missing", limit)
    put((*path, "pin"), pin, None)
    if job.draft.keys[(*path, "kind")][0] in ("bltouch", "servo"):
        number = defines.number("Z_PROBE_SERVO_NR")
        servo = f"SERVO{number.whole(0, 3) if number else 0}"
        control = pins.given(f"{servo}_PIN") or (servo if servo in board.pins else None)
        if control is None:
            raise bad(defines.place(what), f"{servo}_PIN", "missing", f"a pin of {board.name}")
        put((*path, "control_pin"), control, None)


def put_levelling(job: Job) -> None:
    """Converts the bed correction, the screws, and the motors that level the gantry. Raises
    ConfigError."""
    defines, put = job.defines, job.draft.put
    mesh = ("AUTO_BED_LEVELING_BILINEAR", "AUTO_BED_LEVELING_UBL", "MESH_BED_LEVELING")
    plane = ("AUTO_BED_LEVELING_LINEAR", "AUTO_BED_LEVELING_3POINT")
    chosen = next((name for name in (*mesh, *plane) if defines.on(name)), None)
    if chosen and any(key[0] == "probe" for key in job.draft.keys):
        path, place = ("levelling",), job.place(chosen)
        margin = defines.number("PROBING_MARGIN", "MIN_PROBE_EDGE", "MESH_INSET")
        area = _area(job, margin.value if margin else _EDGE_MM)
        if chosen in plane:
            put((*path, "method"), "linear", place)
            put((*path, "points"), _grid_points(job, area), place)
        else:
            put((*path, "method"), "mesh", place)
            put((*path, "area"), [*area], margin.place if margin else place)
            count = [
                defines.number(
                    f"GRID_MAX_POINTS_{axis}", f"MESH_NUM_{axis}_POINTS", "GRID_MAX_POINTS"
                )
                for axis in "XY"
            ]
            counts = [one.whole(2, 41) for one in count if one is not None]
            if len(counts) == 2:
                put((*path, "count"), [*counts], count[0].place if count[0] else None)
            smooth = defines.on("ABL_BILINEAR_SUBDIVISION")
            put((*path, "interpolation"), "bicubic" if smooth else "bilinear", place)
            job.rows("mesh")
    _put_screws(job)
    _put_motors(job)


def _area(job: Job, edge: float) -> tuple[float, float, float, float]:
    """The rectangle between the margins that the probe gets to: X and Y, then the last X and Y."""
    draft = job.draft
    if job.kind == "delta":  # the square within the circle
        side = round((draft.number(("geometry", "limit_radius")) - edge) / 2**0.5, 1)
        return -side, -side, side, side
    shifts = draft.numbers(("probe", "offset_mm")) or [0.0, 0.0]
    sizes, centres = (draft.numbers(("bed", key)) for key in ("size_mm", "center_mm"))
    spans: list[tuple[float, float]] = []
    for index, axis in enumerate("xy"):
        low, high = (draft.number(("axes", axis, key)) for key in ("min_mm", "max_mm"))
        begin, end, shift = low, high, shifts[index]
        if sizes:
            begin, end = (centres[index] + sign * sizes[index] / 2 for sign in (-1, 1))
        spans.append((max(begin + edge, low + shift, low), min(end - edge, high + shift, high)))
    (x0, x1), (y0, y1) = ((round(low, 3), round(high, 3)) for low, high in spans)
    return x0, y0, x1, y1


def _grid_points(job: Job, area: tuple[float, float, float, float]) -> list[Any]:
    x0, y0, x1, y1 = area
    three = job.defines.on("AUTO_BED_LEVELING_3POINT")
    last = [(round((x0 + x1) / 2, 3), y1)] if three else [(x1, y1), (x0, y1)]
    return [{"x": x, "y": y} for x, y in ((x0, y0), (x1, y0), *last)]


def _put_screws(job: Job) -> None:
    if not job.defines.on("ASSISTED_TRAMMING"):
        return
    places = job.defines.pairs("TRAMMING_POINT_XY") or []
    thread = job.defines.text("TRAMMING_SCREW_THREAD") or "M3_CW"
    size, _, hand = thread.partition("_")
    path, place = ("levelling", "screws"), job.place("ASSISTED_TRAMMING")
    if size in _THREADS and hand in ("CW", "CCW"):
        job.draft.put((*path, "thread"), f"{size} {hand.lower()}", place)
    screws: list[Any] = []
    for number, (x, y) in enumerate(places, 1):
        name = job.defines.text(f"TRAMMING_POINT_NAME_{number}") or f"screw {number}"
        screws.append({"name": name, "x": x, "y": y})
    job.draft.put((*path, "places"), screws, place)


def _put_motors(job: Job) -> None:
    if not job.defines.on("Z_STEPPER_AUTO_ALIGN"):
        return
    pivots = job.defines.pairs("Z_STEPPER_ALIGN_STEPPER_XY")
    points = job.defines.pairs("Z_STEPPER_ALIGN_XY")
    motors = [
        key[1]
        for key in job.draft.keys
        if key[0] == "steppers" and key[2] == "steps_per_mm" and key[1][0] == "z"
    ]
    if not points or len(pivots or points) != len(motors):
        text = "give pivots and points in [levelling.motors], for G34"
        job.decide("Z_STEPPER_AUTO_ALIGN", text)
        return
    path, place = ("levelling", "motors"), job.place("Z_STEPPER_AUTO_ALIGN")
    if pivots is None:
        job.decide(
            "Z_STEPPER_AUTO_ALIGN",
            "levelling.motors.pivots are the places of the probe here: give where the motors carry",
        )
    for motor, (x, y) in zip(motors, pivots or points, strict=True):
        job.draft.put((*path, "pivots", motor), [x, y], place)
    job.draft.put((*path, "points"), [{"x": x, "y": y} for x, y in points], place)
    job.rows("motors")
