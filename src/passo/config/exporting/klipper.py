"""A machine as a printer.cfg of Klipper."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from passo.config.exporting.cfg import Cfg
from passo.config.exporting.heat import put_heat
from passo.config.exporting.inputs import put_inputs
from passo.config.exporting.motors import put_stepper
from passo.config.exporting.outputs import put_outputs
from passo.config.pin_names import placed
from passo.config.square_corner import corner_mm_s
from passo.errors import ConfigError
from passo.geometry.delta import Delta, rise_mm
from passo.geometry.skewable import SkewableModel
from passo.probes.base import SensingProbe, SwitchProbe
from passo.probes.eddy import EddyProbe

if TYPE_CHECKING:
    from passo.config.calibration import Screws
    from passo.config.machine import MachineConfig

# Kinematics of Klipper that are not exported.
_OWN_KINDS = ("rotary_delta", "polar", "winch", "none")
# The motor of Passo: Klipper's letter of its stepper.
_STEPPERS = {
    "cartesian": {"x": "x", "y": "y", "z": "z"},
    "corexy": {"a": "x", "b": "y", "z": "z"},
    "corexz": {"a": "x", "y": "y", "b": "z"},
    "hybrid_corexy": {"a": "x", "y": "y", "z": "z"},
    "hybrid_corexz": {"a": "x", "y": "y", "z": "z"},
    "delta": {"a": "a", "b": "b", "c": "c"},
}
_COMMENT = re.compile(r"\{#-?(.*?)-?#\}([^\n]*)", re.DOTALL)
_NOZZLE_MM, _FILAMENT_MM = 0.4, 1.75
_RESULTS = {"median": "median", "mean": "average"}


def exported(machine: MachineConfig) -> Cfg:
    """The sections of a printer.cfg for the machine, and remarks on its parts that have no option
    there. Raises ConfigError for a geometry that is not exported."""
    kind = machine.geometry.kind
    if kind not in _STEPPERS:
        raise ConfigError.of("export.kinematics", value=kind, limit=", ".join(_STEPPERS))
    cfg = _converted(machine, kind)
    _remark_on_the_rest(cfg)
    return cfg


def sections_of(machine: MachineConfig) -> dict[str, dict[str, str]]:
    """The sections of a printer.cfg for any machine, for programs that read the settings of a
    machine. The geometries that are not exported are shown as cartesian machines with the limits of
    the axes, and each probe as one that can measure a mesh."""
    kind = machine.geometry.kind
    if kind in _STEPPERS:
        cfg = _converted(machine, kind)
    else:
        cfg = _converted(machine, "cartesian")
        for letter in "xyz":
            cfg.put(f"stepper_{letter}", position_endstop=machine.home_mm[letter])
        if kind in _OWN_KINDS:  # macros park in the middle of a round bed
            cfg.put("printer", kinematics=kind)
    if machine.probe is not None:
        _put_mesh(cfg)
    return cfg.sections


def _converted(machine: MachineConfig, kind: str) -> Cfg:
    cfg = Cfg(machine)
    for name, board in machine.all_boards.items():
        port = board.port or "/dev/serial/by-id/..."
        usual = None if board.baud == 250_000 else board.baud
        cfg.put(f"mcu {name}" if name else "mcu", serial=port, baud=usual)
    _put_printer(cfg, kind)
    for motor, letter in _STEPPERS[kind].items():
        _put_axis(cfg, kind, motor, letter)
    for number, name in enumerate(machine.extruders):
        _put_extruder(cfg, name, f"extruder{number or ''}")
    put_heat(cfg)
    put_outputs(cfg)
    _put_probe(cfg)
    _put_levelling(cfg)
    for axis, shaper in machine.shaping.items():
        cfg.put(
            "input_shaper",
            **{
                f"shaper_type_{axis}": shaper.type,
                f"shaper_freq_{axis}": shaper.frequency_hz,
                f"damping_ratio_{axis}": shaper.damping,
            },
        )
    _put_accelerometer(cfg)
    _put_commands(cfg)
    put_inputs(cfg)
    _put_macros(cfg)
    _put_kept(cfg)
    return cfg


def _put_accelerometer(cfg: Cfg) -> None:
    part = cfg.machine.accelerometer
    if part is None:
        return
    board = part.written_board
    pins = (part.cs_pin, part.clock_pin, part.mosi_pin, part.miso_pin, part.scl_pin, part.sda_pin)
    select, clock, mosi, miso, scl, sda = (cfg.pin(pin) if pin else None for pin in pins)
    axes = ", ".join(part.axes_map)
    if part.on_i2c:
        cfg.put(
            part.chip,
            i2c_address=part.i2c_address,
            i2c_mcu=board or None,
            i2c_bus=placed(part.i2c_bus)[1] if part.i2c_bus else None,
            i2c_software_scl_pin=scl,
            i2c_software_sda_pin=sda,
            i2c_speed=part.i2c_hz,
            axes_map=axes,
        )
    else:
        cfg.put(
            part.chip,
            cs_pin=select or (f"{board}:None" if board else "None"),
            spi_bus=placed(part.spi_bus)[1] if part.spi_bus else None,
            spi_software_sclk_pin=clock,
            spi_software_mosi_pin=mosi,
            spi_software_miso_pin=miso,
            axes_map=axes,
            # a lis2dw has one rate in Klipper
            rate=part.rate_hz if part.chip == "adxl345" else None,
        )
    x, y, z = part.point_of(cfg.machine.bed_area_mm, cfg.machine.axes["z"].max_mm)
    cfg.put(
        "resonance_tester",
        accel_chip=part.chip,
        probe_points=f"{x:g}, {y:g}, {z:g}",
        accel_per_hz=part.accel_per_hz,
        max_smoothing=part.max_smoothing_mm,
    )


def _put_printer(cfg: Cfg, kind: str) -> None:
    """Writes [printer]. Klipper has one limit for X and Y, and a speed at square corners, which is
    that of the junction deviation, or the limit of the jerk."""
    machine, limits = cfg.machine, cfg.machine.limits
    x, y, z = (machine.axes[axis] for axis in "xyz")
    accel = min(limits.print_accel_mm_s2 or x.accel_mm_s2, x.accel_mm_s2, y.accel_mm_s2)
    speed = min(limits.speed_mm_s or x.speed_mm_s, x.speed_mm_s, y.speed_mm_s)
    if (x.speed_mm_s, x.accel_mm_s2) != (y.speed_mm_s, y.accel_mm_s2):
        cfg.left_out.append("X and Y have one speed and one acceleration: the smaller ones")
    corner: float | None = None
    if limits.junction == "square_corner":
        corner = limits.square_corner_mm_s
    elif limits.junction == "deviation":
        corner = corner_mm_s(limits.junction_deviation_mm, accel)
    elif limits.junction == "jerk":
        corner = min(x.jerk_mm_s, y.jerk_mm_s)
    else:
        cfg.left_out.append("limits.junction: set square_corner_velocity by hand")
    upright = kind != "delta"
    cfg.put(
        "printer",
        kinematics=kind,
        max_velocity=speed,
        max_accel=accel,
        max_z_velocity=z.speed_mm_s if upright or z.speed_mm_s != speed else None,
        max_z_accel=z.accel_mm_s2 if upright else None,
        square_corner_velocity=corner,
        minimum_cruise_ratio=limits.minimum_cruise_ratio,
    )
    geometry = machine.geometry
    if isinstance(geometry, Delta):
        cfg.put(
            "printer",
            delta_radius=geometry.radius,
            print_radius=geometry.limit_radius,
            minimum_z_position=z.min_mm,
        )


def _put_axis(cfg: Cfg, kind: str, motor: str, letter: str) -> None:
    machine, section = cfg.machine, f"stepper_{letter}"
    driven = machine.drivable.by_name.get(motor)  # None for the X of an arm
    motors = [name for name in machine.steppers if driven and machine.driven_by(name) == driven]
    for number, name in enumerate(motors):
        put_stepper(cfg, name, f"{section}{number or ''}")
    delta = kind == "delta"
    homing = machine.homing.get(motor if delta else letter)
    if not delta:
        axis = machine.axes[letter]
        cfg.put(section, position_min=axis.min_mm, position_max=axis.max_mm)
    if homing is None:
        text = f"{letter.upper()} has no endstop: Klipper starts when [{section}] has endstop_pin"
        cfg.left_out.append(text)
        return
    pins = homing.stepper_pins or ({motors[0]: homing.pin} if homing.pin else {})
    for number, name in enumerate(motors):
        if name in pins:
            cfg.put(f"{section}{number or ''}", endstop_pin=cfg.pin(pins[name]))
    if homing.offsets_mm:
        cfg.left_out.append(f"homing.{motor}.offsets_mm: endstops trigger at one height")
    if homing.probe:
        cfg.put(section, endstop_pin="probe:z_virtual_endstop")
    else:
        position = homing.position
        geometry = machine.geometry
        if isinstance(geometry, Delta):
            index = "abc".index(letter)
            position -= rise_mm(geometry.rods[index], geometry.radius)
            cfg.put(section, arm_length=geometry.rods[index], angle=geometry.angles[index])
        cfg.put(section, position_endstop=round(position, 6))
    if not delta:
        cfg.put(section, homing_positive_dir=homing.direction == "max")
    cfg.put(
        section,
        homing_speed=homing.fast,
        second_homing_speed=homing.slow,
        homing_retract_dist=homing.retract,
    )


def _put_extruder(cfg: Cfg, name: str, section: str) -> None:
    extruder = cfg.machine.extruders[name]
    motors = [
        motor
        for motor in cfg.machine.steppers
        if cfg.machine.driven_by(motor) == cfg.machine.drivable.by_name[name]
    ]
    own = cfg.machine.klipper.get(section, {})
    for motor in motors[:1]:
        put_stepper(cfg, motor, section)
    if motors[1:]:
        cfg.left_out.append(f"steppers.{', '.join(motors[1:])}: an extruder has one motor")
    cfg.put(
        section,
        nozzle_diameter=float(own.get("nozzle_diameter", _NOZZLE_MM)),
        filament_diameter=float(own.get("filament_diameter", _FILAMENT_MM)),
        max_extrude_only_velocity=extruder.speed_mm_s,
        max_extrude_only_accel=extruder.accel_mm_s2,
        min_extrude_temp=cfg.machine.limits.min_extrude_c,
        instantaneous_corner_velocity=extruder.jerk_mm_s,
        pressure_advance=extruder.advance_s,
        pressure_advance_smooth_time=extruder.advance_smooth_s,
    )
    if extruder.advance_knees:
        cfg.left_out.append(f"extruders.{name}.advance_knees: Klipper's advance has one value")


def _put_probe(cfg: Cfg) -> None:
    probe = cfg.machine.probe
    if probe is None:
        return
    if not isinstance(probe, SensingProbe):
        cfg.left_out.append(f"probe: the kind {probe.kind} has no section of its own")
        return
    if isinstance(probe, EddyProbe):
        _put_eddy(cfg, probe)
        return
    if probe.kind not in ("fixed", "nozzle", "bltouch"):
        cfg.left_out.append(f"probe: [probe] does not know how to deploy the kind {probe.kind}")
    assert isinstance(probe, SwitchProbe)
    touch = probe.kind == "bltouch"
    section = "bltouch" if touch else "probe"
    cfg.put(
        section,
        **{"sensor_pin" if touch else "pin": cfg.pin(probe.pin)},
        control_pin=cfg.pin(probe.servo_pin) if touch and probe.servo_pin else None,
        z_offset=probe.trigger_height_mm,
        **_of_samples(probe),
    )
    _put_probe_home(cfg, probe)


def _put_eddy(cfg: Cfg, probe: EddyProbe) -> None:
    bus = placed(probe.i2c_bus) if probe.i2c_bus else None
    cfg.put(
        f"probe_eddy_current {probe.name}",
        sensor_type="ldc1612",
        i2c_software_scl_pin=cfg.pin(probe.scl_pin) if probe.scl_pin else None,
        i2c_software_sda_pin=cfg.pin(probe.sda_pin) if probe.sda_pin else None,
        i2c_mcu=bus[0] or None if bus else None,
        i2c_bus=bus[1] if bus else None,
        i2c_address=probe.i2c_address,
        i2c_speed=probe.i2c_hz,
        intb_pin=cfg.pin(probe.intb_pin) if probe.intb_pin else None,
        reg_drive_current=probe.drive_current,
        frequency=probe.chip_hz,
        max_sensor_hz=probe.max_coil_hz,
        descend_z=probe.trigger_height_mm,
        calibrate=", ".join(f"{p.mm:.6f}:{p.hz:.3f}" for p in probe.calibration) or None,
        **_of_samples(probe),
    )
    _put_probe_home(cfg, probe)


def _of_samples(probe: SensingProbe) -> dict[str, str | float]:
    return {
        "x_offset": probe.offset_mm[0],
        "y_offset": probe.offset_mm[1],
        "speed": probe.slow_mm_s,
        "lift_speed": probe.lift_mm_s,
        "sample_retract_dist": probe.retract_mm,
        "samples": probe.samples,
        "samples_result": _RESULTS[probe.result],
        "samples_tolerance": probe.tolerance_mm,
        "samples_tolerance_retries": probe.retries,
    }


def _put_probe_home(cfg: Cfg, probe: SensingProbe) -> None:
    if probe.fast_mm_s != probe.slow_mm_s:
        cfg.left_out.append("probe.fast_mm_s: Klipper's probe has one speed, slow_mm_s")
    if probe.heaters_off:
        cfg.left_out.append("probe.heaters_off: heaters stay on while Klipper probes")
    home = cfg.machine.homing.get("z")
    if home is not None and home.probe:
        (x, y), (dx, dy) = cfg.machine.probe_home_mm, probe.offset_mm
        cfg.put("safe_z_home", home_xy_position=f"{x - dx:g}, {y - dy:g}", z_hop=probe.start_mm)


def _put_levelling(cfg: Cfg) -> None:
    """Writes the screws and the motors. Klipper's positions for them are those of the nozzle when
    the probe is over them."""
    machine, levelling = cfg.machine, cfg.machine.levelling
    dx, dy = machine.probe.offset_mm if machine.probe else (0.0, 0.0)
    sensing = isinstance(machine.probe, SensingProbe)
    if levelling.method == "mesh" and sensing:
        _put_mesh(cfg)
    elif levelling.method != "none":
        cfg.left_out.append(f"levelling.method {levelling.method}: Klipper has a mesh")
    if levelling.screws is not None:
        _put_screws(cfg, levelling.screws, (dx, dy) if sensing else None)
    motors = levelling.motors
    if motors is None or not sensing:
        return
    points = "".join(f"\n{point.x - dx:g}, {point.y - dy:g}" for point in motors.points)
    pivots = list(motors.pivots.values())
    common = {"points": points, "retry_tolerance": motors.tolerance_mm, "retries": motors.retries}
    if len(pivots) == 4:
        corners = f"\n{pivots[0][0]:g}, {pivots[0][1]:g}\n{pivots[2][0]:g}, {pivots[2][1]:g}"
        cfg.put("quad_gantry_level", gantry_corners=corners, max_adjust=motors.max_adjust_mm)
        cfg.put("quad_gantry_level", **common)
    else:
        cfg.put("z_tilt", z_positions="".join(f"\n{x:g}, {y:g}" for x, y in pivots), **common)


def _put_mesh(cfg: Cfg) -> None:
    levelling, probe = cfg.machine.levelling, cfg.machine.probe
    x0, y0, x1, y1 = levelling.area or cfg.machine.bed_area_mm
    bicubic = levelling.interpolation == "bicubic"
    cfg.put(
        "bed_mesh",
        mesh_min=f"{x0:g}, {y0:g}",
        mesh_max=f"{x1:g}, {y1:g}",
        probe_count=f"{levelling.count[0]}, {levelling.count[1]}",
        algorithm="bicubic" if bicubic and min(levelling.count) > 3 else "lagrange",
        speed=probe.travel_mm_s if probe else None,
        horizontal_move_z=probe.start_mm if probe else None,
        fade_end=levelling.fade_mm,
        adaptive_margin=levelling.margin_mm,
        zero_reference_position=", ".join(f"{mm:g}" for mm in levelling.reference or []) or None,
    )
    for number, (x0, y0, x1, y1) in enumerate(levelling.avoid, 1):
        region = f"faulty_region_{number}"
        cfg.put("bed_mesh", **{f"{region}_min": f"{x0:g}, {y0:g}"})
        cfg.put("bed_mesh", **{f"{region}_max": f"{x1:g}, {y1:g}"})


def _put_screws(cfg: Cfg, screws: Screws, offset: tuple[float, float] | None) -> None:
    """Writes the screws, for a probe with this offset or for a nozzle, None."""
    section = "bed_screws" if offset is None else "screws_tilt_adjust"
    dx, dy = offset or (0.0, 0.0)
    for number, screw in enumerate(screws.places, 1):
        at, name = f"{screw.x - dx:g}, {screw.y - dy:g}", screw.name
        cfg.put(section, **{f"screw{number}": at, f"screw{number}_name": name})
    size, _, hand = screws.thread.partition(" ")
    if offset is None:
        cfg.left_out.append("levelling.screws.thread: [bed_screws] has none")
    else:
        cfg.put(section, screw_thread=f"{hand.upper()}-{size}")


def _put_commands(cfg: Cfg) -> None:
    """Writes the sections with the commands that Passo always has, which web pages use."""
    cfg.put("virtual_sdcard", path="~/printer_data/gcodes")
    cfg.put("force_move", enable_force_move=True)
    if cfg.machine.idle.motors_off_s:
        cfg.put("idle_timeout", timeout=cfg.machine.idle.motors_off_s)
    retraction = cfg.machine.retraction
    cfg.put(
        "firmware_retraction",
        retract_length=retraction.length_mm,
        retract_speed=retraction.speed_mm_s,
        unretract_extra_length=retraction.extra_mm,
        unretract_speed=retraction.return_mm_s or retraction.speed_mm_s,
    )
    if retraction.hop_mm:
        cfg.left_out.append("retraction.hop_mm: [firmware_retraction] does not raise Z")
    for section in ("pause_resume", "display_status", "exclude_object", "respond", "gcode_arcs"):
        cfg.put(section)


def _put_kept(cfg: Cfg) -> None:
    """Adds the options that the machine file keeps for macros. Values of the machine itself win."""
    for section, options in cfg.sections.items():
        kept = cfg.machine.klipper.get(section, {})
        cfg.put(section, **{name: text for name, text in kept.items() if name not in options})


def _put_macros(cfg: Cfg) -> None:
    for name, macro in cfg.machine.macros.items():
        section = f"gcode_macro {name}"
        for variable, value in macro.values().items():
            text = repr(value)
            cfg.put(section, **{f"variable_{variable}": text})
        cfg.put(
            section,
            description=macro.description or None,
            rename_existing=macro.rename_existing,
            gcode=_gcode(macro.gcode),
        )
    for name, delayed in cfg.machine.delayed_gcode.items():
        cfg.put(
            f"delayed_gcode {name}",
            initial_duration=delayed.initial_duration_s,
            gcode=_gcode(delayed.gcode),
        )


def _gcode(template: str) -> str:
    """The text of a macro. Klipper cuts each line at its first #, so comments of Jinja2 become
    those of Klipper; a comment before other text is left out."""

    def comment(found: re.Match[str]) -> str:
        if found[2].strip():
            return found[2]
        return "\n".join(f"# {line.strip()}" for line in found[1].strip().splitlines()) or ""

    return "\n" + _COMMENT.sub(comment, template.strip())


def _remark_on_the_rest(cfg: Cfg) -> None:
    machine = cfg.machine
    for part in ("laser", "mains", "beeper"):
        if getattr(machine, part) is not None:
            cfg.left_out.append(f"{part}: write a section of Klipper by hand")
    further = [name for name, axis in machine.axes.items() if name not in "xyz" or axis.extruder]
    cfg.left_out += [f"axes.{name}: Klipper has no such axis" for name in further]
    if machine.moves:
        cfg.left_out.append("moves: write them as macros")
    if len(machine.tools) > 1:
        cfg.left_out.append("tools: write macros T0, T1 with ACTIVATE_EXTRUDER and the offsets")
    if any(tool.fans or tool.fan_factor != 1 for tool in machine.tools):
        cfg.left_out.append("tools: write a macro M106 with the fans and the factor of each tool")
    if isinstance(machine.geometry, SkewableModel) and any(machine.geometry.skew):
        cfg.left_out.append("geometry.skew: send SET_SKEW, and save it")
