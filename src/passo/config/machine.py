"""The whole machine: `MachineConfig`, and its plain numbers for the core."""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from typing import Any, Literal

from pydantic import Field

from passo.config.accelerometer import Accelerometer
from passo.config.advance import PathLimits, half_smooth_s
from passo.config.board import Board, Socket
from passo.config.budget import MAX_BUDGETS
from passo.config.electronics import Beeper, Fans, Laser, PowerSupply
from passo.config.heat import Heaters
from passo.config.homing import Homing
from passo.config.inputs import Buttons, FilamentSensors, button_input, sensor_input
from passo.config.jerk import box_s
from passo.config.light_effects import LightEffects
from passo.config.light_templates import LightTemplates
from passo.config.lights import Led, Lights, led_outputs
from passo.config.macros import DelayedGcode, Macro
from passo.config.motion import (
    Axis,
    Backlash,
    Extruder,
    Idle,
    Limits,
    Park,
    Retraction,
    Shaping,
    Stepper,
    Steppers,
    Tool,
)
from passo.config.motor_roles import Drivable, Driven, axis_order
from passo.config.outputs import Outputs, further_name, timed_name
from passo.config.pin_names import MAIN, placed
from passo.config.predefined_moves import PredefinedMove
from passo.config.probing import Levelling, Simulated
from passo.config.servos import Servos, servo_output
from passo.config.shapers import impulses
from passo.config.shown_sensors import ShownSensors
from passo.config.types import (
    AxisName,
    CommandName,
    ExtruderName,
    Model,
    Name,
    Pair,
    PartName,
    ShapedAxis,
    Uuid,
)
from passo.geometry.base import Point, Unreachable
from passo.geometry.registry import AnyGeometry
from passo.probes.registry import AnyProbe


class Bed(Model):
    """The printable area, centred on `center_mm`; a round bed gives its diameter twice."""

    round: bool = False
    """Whether the bed is round."""
    size_mm: Pair
    """Width in X and depth in Y of the printable area; of a round bed its diameter, twice."""
    center_mm: Pair
    """X and Y of the middle of the printable area."""


class MachineConfig(Model):
    """A printer, as described by its machine file. `passo.config.load` makes it. `unhomed_moves`
    decides about moves of an axis that has an endstop and is not homed.
    """

    name: Name
    """The name of the machine in M115 and in reports."""
    uuid: Uuid
    """A number that identifies this machine; `uuidgen` prints one. Stored settings and journals of
    another machine are refused."""
    author: str
    """Who wrote the file."""
    description: str = ""
    """One line about the machine for `passo machines`."""
    geometry: AnyGeometry
    """The geometry, which relates motor positions to the nozzle position."""
    axes: dict[AxisName, Axis]
    """X, Y, Z, and at most four further axes."""
    steppers: Steppers
    """The motors, by name."""
    extruders: dict[ExtruderName, Extruder] = {}
    """The filament motors."""
    tools: list[Tool] = []
    """What T0, T1, … select, in this order. Without tools, one for each extruder."""
    limits: Limits = Field(default_factory=Limits)
    """Limits of the path: accelerations, speed, corners."""
    shaping: dict[ShapedAxis, Shaping] = {}
    """The input shapers of X, Y and Z."""
    backlash: Backlash = Field(default_factory=Backlash)
    """The gaps in the drives of X, Y and Z."""
    homing: dict[Name, Homing] = {}
    """Homing of an axis, a carriage or an arm. An axis without this table has no endstop."""
    park: Park | None = Field(default_factory=Park)
    """The position of the nozzle during a pause."""
    retraction: Retraction = Field(default_factory=Retraction)
    """The retraction of G10 and G11."""
    moves: dict[Name, PredefinedMove] = {}
    """Moves to places, by name, which MOVE_TO, homing or probing makes."""
    idle: Idle = Field(default_factory=Idle)
    """Timeouts after which parts of an idle machine are switched off."""
    unhomed_moves: Literal["refuse", "allow"] = "refuse"
    """Whether a move of an axis that has an endstop and is not homed is an error or allowed."""
    bed: Bed | None = None
    """Sets the printable area."""
    probe: AnyProbe | None = None
    """The probe that measures the bed."""
    accelerometer: Accelerometer | None = None
    """The accelerometer that measures resonances."""
    levelling: Levelling = Field(default_factory=Levelling)
    """The measurement and correction of the bed."""
    simulated: Simulated = Field(default_factory=Simulated)
    """The mechanics around the simulated boards."""
    heaters: Heaters = {}
    """The heaters, by name."""
    fans: Fans = {}
    """The fans, by name."""
    outputs: Outputs = {}
    """Outputs that commands switch, by name."""
    lights: Lights = {}
    """Coloured lights, by name."""
    light_effects: LightEffects = {}
    """Effects of the lights, by name."""
    light_templates: LightTemplates = {}
    """Templates of colours that lights follow, by name."""
    servos: Servos = {}
    """Servos, by name."""
    sensors: ShownSensors = {}
    """Temperature sensors without a heater, by name."""
    laser: Laser | None = None
    """The laser or spindle of M3, M4 and M5."""
    mains: PowerSupply | None = None
    """The output of M80 and M81, which switches the power supply."""
    beeper: Beeper | None = None
    """The buzzer of M300."""
    filament_sensors: FilamentSensors = {}
    """The filament sensors, by name."""
    buttons: Buttons = {}
    """Buttons and other switches that do something, by name."""
    macros: dict[CommandName, Macro] = {}
    """Your own commands, which may replace built-in ones. A name keeps its case in
    `printer["gcode_macro NAME"]`; lines call it in any case."""
    delayed_gcode: dict[PartName, DelayedGcode] = {}
    """G-code that a served printer executes after a delay."""
    klipper: dict[str, dict[str, str]] = {}
    """Options of Klipper's printer.cfg that have no key here, by section, for macros that read them
    in printer.configfile: `[klipper.extruder]` with `nozzle_diameter = "0.6"`. They change nothing
    else. Values of the machine win. For a section of a part that Passo does not drive, such as
    `[klipper."servo arm"]`, macros also read a state, which `passo check` lists; SET_PIN and
    SET_FILAMENT_SENSOR set it."""
    board: Board
    """The main board. Print time is its clock."""
    boards: dict[PartName, Board] = {}
    """Further boards. Their names are the prefix of their pins, as in `tool:PA1`."""

    @property
    def macro_names(self) -> dict[str, str]:
        """The name of each macro by its code, which has only capital letters."""
        return {name.upper(): name for name in self.macros}

    @property
    def all_boards(self) -> dict[str, Board]:
        """All boards by name: the main board, whose name is empty, and those of `boards`."""
        return {MAIN: self.board, **self.boards}

    @property
    def gaps_mm(self) -> dict[str, float]:
        """The gaps in the drives of x, y and z."""
        return {"x": self.backlash.x_mm, "y": self.backlash.y_mm, "z": self.backlash.z_mm}

    def pin(self, written: str) -> str:
        """The microcontroller's pin for a name, on any of the boards."""
        board, name = placed(written)
        return self.all_boards[board].pin(name)

    def socket(self, stepper: str) -> Socket | None:
        """The socket of a motor's driver; None if the motor has no socket."""
        written = self.steppers[stepper].socket
        if written is None:
            return None
        board, name = placed(written)
        return self.all_boards[board].sockets[name]

    def board_of_stepper(self, name: str) -> str:
        """The name of the board to which a motor is wired."""
        stepper = self.steppers[name]
        return placed(stepper.step_pin or stepper.socket or name)[0]

    def pin_of_stepper(self, name: str, written: str) -> str:
        """The microcontroller's pin for a name, on the board of a motor."""
        return self.all_boards[self.board_of_stepper(name)].pin(placed(written)[1])

    @property
    def bed_area_mm(self) -> tuple[float, float, float, float]:
        """X and Y of the first corner of the bed and of the opposite one, mm; without `bed`, the
        area that the axes reach."""
        if self.bed is None:
            x, y = self.axes["x"], self.axes["y"]
            return x.min_mm, y.min_mm, x.max_mm, y.max_mm
        (cx, cy), (width, depth) = self.bed.center_mm, self.bed.size_mm
        return cx - width / 2, cy - depth / 2, cx + width / 2, cy + depth / 2

    @property
    def probe_home_mm(self) -> tuple[float, float]:
        """X and Y of the probe while it homes Z."""
        homing, (x0, y0, x1, y1) = self.homing.get("z"), self.bed_area_mm
        if homing is not None and homing.probe_at_mm is not None:
            x, y = homing.probe_at_mm
            return x, y
        return (x0 + x1) / 2, (y0 + y1) / 2

    @property
    def size_mm(self) -> tuple[float, float, float]:
        """The travel in X, Y, Z between the soft limits, mm."""
        x, y, z = (self.axes[name].max_mm - self.axes[name].min_mm for name in "xyz")
        return x, y, z

    @property
    def moved_axes(self) -> dict[int, str]:
        """The axes by their numbers: all, but not X, Y and Z of a machine that does not move
        them."""
        first = 0 if self.geometry.actuators else 3
        return {i: name for i, name in enumerate(axis_order(self.axes)) if i >= first}

    @property
    def axes_of_arms(self) -> tuple[str, ...]:
        """The axes whose positions depend only on the arms; empty if arms are not homed."""
        if not any(name in self.geometry.arms for name in self.homing):
            return ()
        return self.geometry.axes_of_arms

    @property
    def home_point(self) -> Point:
        """The position of the nozzle in mm when all axes are at their home positions. Raises
        Unreachable."""
        return self._point_at(self._home_of)

    @property
    def rest_point(self) -> Point:
        """The position of the nozzle in mm after all axes have homed. Raises Unreachable."""
        return self._point_at(self._rest_of)

    def _point_at(self, position: Callable[[str], float]) -> Point:
        if not self.axes_of_arms:
            x, y, z = map(position, "xyz")
            return x, y, z
        return self.geometry.forward([*map(position, self.geometry.actuators)])

    @property
    def home_mm(self) -> dict[str, float]:
        """The position of each axis in mm, rounded to 1e-9 mm, when all axes are at their home
        positions. Raises Unreachable."""
        return self._by_axis(self.home_point, self._home_of)

    @property
    def rest_mm(self) -> dict[str, float]:
        """Like `home_mm`, after all axes have homed: an axis that homes by a stall rests off its
        end."""
        return self._by_axis(self.rest_point, self._rest_of)

    def _by_axis(self, at: Point, position: Callable[[str], float]) -> dict[str, float]:
        further = {name: position(name) for name in axis_order(self.axes)[3:]}
        point = (round(mm, 9) + 0.0 for mm in at)  # no -0
        return dict(zip("xyz", point, strict=True)) | further

    def _rest_of(self, name: str) -> float:
        return self.homing[name].rest if name in self.homing else self._home_of(name)

    def _home_of(self, name: str) -> float:
        """The home position of an axis or an arm: at its endstop or, without one, the position in
        the file."""
        if name in self.homing:
            return self.homing[name].position
        if name in self.geometry.free:
            return 0.0
        given, lowest = self.axes[name].home_mm, self.axes[name].min_mm
        return given if given is not None else lowest if self.geometry.homes else 0.0

    @property
    def drivable(self) -> Drivable:
        """The actuators, axes and extruders that the motors of this machine may drive."""
        return Drivable(self.geometry.actuators, axis_order(self.axes), self.extruders)

    def driven_by(self, stepper: str) -> Driven | None:
        """The actuator, axis or extruder that a motor drives; None if it drives nothing. Raises
        KeyError."""
        return self.drivable.of(stepper, self.steppers[stepper].drives)

    @property
    def all_tools(self) -> list[Tool]:
        """The tools T0, T1, …; without a table of tools, one for each extruder."""
        return self.tools or [Tool(extruder=name) for name in self.extruders]

    @property
    def timed_outputs(self) -> dict[str, str]:
        """The names of the outputs on the timeline with their pins as written, in the order of
        their numbers: heaters, fans, laser, the other outputs as `timed_name`, LEDs, servos, then
        all further pins as `further_name`."""
        pins = {name: heater.pin for name, heater in self.heaters.items()}
        pins |= {self.fan_output(name): fan.pin for name, fan in self.fans.items()}
        pins |= {"laser": self.laser.pin} if self.laser else {}
        pins |= {timed_name(name): output.pin for name, output in self.outputs.items()}
        for name, light in self.lights.items():
            pins |= led_outputs(name, light) if isinstance(light, Led) else {}
        pins |= {servo_output(name): servo.pin for name, servo in self.servos.items()}
        return pins | {pin: at for further in self.further_pins.values() for pin, at in further}

    @property
    def further_pins(self) -> dict[str, list[tuple[str, str]]]:
        """The further pins of each output on the timeline that has some: the name of each, as
        `further_name`, and the pin as written."""
        pins = {name: heater.further_pins for name, heater in self.heaters.items()}
        pins |= {self.fan_output(name): fan.further_pins for name, fan in self.fans.items()}
        pins |= {timed_name(name): output.further_pins for name, output in self.outputs.items()}
        return {
            name: [(further_name(name, i), pin) for i, pin in enumerate(written)]
            for name, written in pins.items()
            if written
        }

    def fan_output(self, fan: str) -> str:
        """The name of a fan's output: that of the fan, unless a heater has the same name."""
        return f"{fan}-fan" if fan in self.heaters else fan

    @property
    def input_pins(self) -> dict[str, str]:
        """The pins, as written, of the inputs that boards report, by the names of the inputs."""
        sensors = {
            sensor_input(name): part.pin
            for name, part in self.filament_sensors.items()
            if part.width is None
        }
        return sensors | {button_input(name): part.pin for name, part in self.buttons.items()}

    @property
    def analog_buttons(self) -> dict[str, list[str]]:
        """The buttons on each analog input, by its pin as written."""
        pins: dict[str, list[str]] = {}
        for name, button in self.buttons.items():
            if button.resistance_ohm is not None:
                pins.setdefault(button.pin, []).append(name)
        return pins

    def facing_its_middle(self) -> MachineConfig:
        """A copy whose arm angles are counted so that they fit the axes and the limits of the
        motors."""
        x, y, z = ((axis.min_mm + axis.max_mm) / 2 for axis in (self.axes[n] for n in "xyz"))
        geometry = self.geometry.facing((x, y, z), self.actuator_limits)
        return self.model_copy(update={"geometry": geometry})

    @property
    def actuator_limits(self) -> list[tuple[float, float]]:
        """For each actuator, the range of positions within the limits of its motors, mm or degrees;
        infinite without a limit."""
        limits = [(-inf, inf)] * len(self.geometry.actuators)
        for row in self._steppers_spec():
            if row["drive"] == "actuator":
                limits[row["index"]] = row["min"], row["max"]
        return limits

    @property
    def largest_accel_mm_s2(self) -> float:
        """The largest acceleration limit of X, Y and Z."""
        return max(self.axes[name].accel_mm_s2 for name in "xyz")

    @property
    def path_limits(self) -> PathLimits:
        """The limits of prints until M204 and M205 set others."""
        accel_mm_s2 = self.limits.print_accel_mm_s2 or self._plane_accel_mm_s2
        return PathLimits(accel_mm_s2, self.limits.square_corner_mm_s)

    @property
    def _plane_accel_mm_s2(self) -> float:
        return min(self.axes["x"].accel_mm_s2, self.axes["y"].accel_mm_s2)

    def allows(self, point: Point) -> bool:
        """Whether the motors reach a point of the nozzle, mm, within their limits."""
        try:
            found = self.geometry.inverse(point)
        except Unreachable:
            return False
        at = zip(found, self.actuator_limits, strict=True)
        return all(low <= position <= high for position, (low, high) in at)

    def core_spec(self) -> dict[str, Any]:
        """The machine for `passo._core`: all defaults filled in, times in s, other units kept."""
        return {
            "name": self.name,
            "clock_hz": self.board.clock_hz,
            "tolerance_s": self.board.compression_tolerance_us / 1e6,
            "axes": [self._axis_spec(name) for name in axis_order(self.axes)],
            "extruders": [
                {
                    "name": name,
                    "speed": extruder.speed_mm_s,
                    "accel": extruder.accel_mm_s2,
                    "jerk": extruder.jerk_mm_s,
                    "advance_s": extruder.advance_s or 0.0,
                }
                for name, extruder in self.extruders.items()
            ],
            "tools": self._tools_spec(),
            "geometry": self.geometry.spec(),
            "motor_letters": "".join(
                name.upper() for name in self.geometry.actuators if name not in self.axes
            ),
            "steppers": self._steppers_spec(),
            "limits": self._limits_spec(),
            "retraction": self._retraction_spec(),
            "filters": self._filters_spec(),
            "budgets": self._budgets_spec(),
            "laser": self._laser_spec(),
            "boards": 1 + len(self.boards),
            "output_boards": self._output_boards(),
            "macros": {
                "names": list(self.macro_names),
                "built_in": {
                    macro.rename_existing.upper(): name.upper()
                    for name, macro in self.macros.items()
                    if macro.rename_existing
                },
            },
        }

    @property
    def budget_specs(self) -> dict[str, dict[str, Any]]:
        """The results of `Board.budget_spec` for the boards that have a motor and a budget, by
        name."""
        moving = {self.board_of_stepper(name) for name in self.steppers}
        return {
            name: spec
            for name, board in self.all_boards.items()
            if name in moving and (spec := board.budget_spec(self._longest_pulse_us(name)))
        }

    @property
    def budget_groups(self) -> list[list[str]]:
        """The boards of each budget of the core. A board has a budget of its own for its motors; if
        there are too many, the last boards share one."""
        names = list(self.budget_specs)
        alone = names if len(names) <= MAX_BUDGETS else names[: MAX_BUDGETS - 1]
        rest = names[len(alone) :]
        return [*([name] for name in alone), *([rest] if rest else [])]

    def _budgets_spec(self) -> list[dict[str, Any]]:
        specs, order = self.budget_specs, list(self.all_boards)
        return [
            _least([specs[name] for name in group])
            | {"boards": [order.index(name) for name in group]}
            for group in self.budget_groups
        ]

    def _longest_pulse_us(self, board: str) -> float:
        own = (s for name, s in self.steppers.items() if self.board_of_stepper(name) == board)
        return max((stepper.shortest_pulse_us for stepper in own), default=0.0)

    def _output_boards(self) -> list[int]:
        """Numbers of the boards of the outputs on the timeline."""
        order = list(self.all_boards)
        return [order.index(placed(pin)[0]) for pin in self.timed_outputs.values()]

    def _axis_spec(self, name: str) -> dict[str, Any]:
        axis = self.axes[name]
        return {
            "letter": name.upper(),
            "name": name,
            "min": axis.min_mm,
            "max": axis.max_mm,
            "home": self.rest_mm[name],
            "speed": axis.speed_mm_s,
            "accel": axis.accel_mm_s2,
            "jerk": axis.jerk_mm_s,
            "cornering_steps": axis.cornering_distance_steps,
            "filament": axis.extruder,
            "by_arms": name in self.axes_of_arms and name not in self.homing,
        }

    def _tools_spec(self) -> list[dict[str, Any]]:
        order = list(self.extruders)
        return [
            {
                "extruder": -1 if tool.extruder is None else order.index(tool.extruder),
                "offset": list(tool.offset_mm),
            }
            for tool in self.all_tools
        ]

    def _steppers_spec(self) -> list[dict[str, Any]]:
        drivable = self.drivable
        specs: list[tuple[tuple[int, int], dict[str, Any]]] = []
        for name, stepper in self.steppers.items():
            driven = self.driven_by(name)
            if driven is None:
                raise ValueError(f"stepper {name} drives nothing: load() would have said so")
            board = list(self.all_boards).index(self.board_of_stepper(name))
            spec = {"name": name, "drive": driven.drive, "index": driven.index, "board": board}
            specs.append((drivable.order(driven), spec | _stepper_numbers(stepper)))
        return [spec for _, spec in sorted(specs, key=lambda item: item[0])]

    def _laser_spec(self) -> dict[str, Any] | None:
        laser = self.laser
        if laser is None or not (laser.density_letter or laser.energy_letter):
            return None
        return {
            "density_letter": laser.density_letter or "",
            "energy_letter": laser.energy_letter or "",
            "full_w": laser.power_w,
            "most_w": min(laser.max_power_w or laser.power_w, laser.power_w),
        }

    def _filters_spec(self) -> dict[str, Any]:
        """The settings of motion filters (core/machine/filters/) by name: for each axis or
        extruder, or one for the machine."""
        shapers = [self.shaping.get(name) for name in "xyz"]
        extruders = self.extruders.values()
        return {
            "shapers": [impulses(s.type, s.frequency_hz, s.damping) if s else [] for s in shapers],
            "smooth_s": [half_smooth_s(self.path_limits, extruder) for extruder in extruders],
            "knees": [
                [(speed, advance / (extruder.advance_s or 1.0)) for speed, advance in knees]
                for extruder in extruders
                for knees in [extruder.advance_knees]
            ],
            "shaped": [extruder.shaped for extruder in extruders],
            "box_s": box_s(self.largest_accel_mm_s2, self.limits.jerk_mm_s3 or 0.0),
            "gaps": [(mm, self.backlash.smooth_mm) for mm in self.gaps_mm.values()],
        }

    def _retraction_spec(self) -> dict[str, Any]:
        found = self.retraction
        return {
            "length": found.length_mm,
            "speed": found.speed_mm_s,
            "hop": found.hop_mm,
            "extra": found.extra_mm,
            "return_speed": found.return_mm_s or 0.0,
        }

    def _limits_spec(self) -> dict[str, Any]:
        limits = self.limits
        plane = self._plane_accel_mm_s2
        pushing = [*self.extruders.values(), *(a for a in self.axes.values() if a.extruder)]
        fastest = max((part.accel_mm_s2 for part in pushing), default=plane)
        return {
            "print_accel": self.path_limits.accel_mm_s2,
            "travel_accel": limits.travel_accel_mm_s2 or plane,
            "retract_accel": limits.retract_accel_mm_s2 or fastest,
            "speed": limits.speed_mm_s or inf,
            "junction": limits.junction,
            "junction_deviation": limits.junction_deviation_mm,
            "square_corner": limits.square_corner_mm_s,
            "minimum_cruise_ratio": limits.minimum_cruise_ratio,
            "least_speed_gain": limits.least_speed_gain,
        }


def _least(specs: list[dict[str, Any]]) -> dict[str, Any]:
    """The budget of boards that share one: the minimum of each figure, so that no board is
    overloaded."""
    fewest = min(specs, key=lambda s: s["commands_s"])
    least = {key: min(s[key] for s in specs) for key in ("steps_s", "burst")}
    return fewest | least | {"commits_s": max(s["commits_s"] for s in specs)}


def _first(*values: float | None, default: float) -> float:
    return float(next((value for value in values if value is not None), default))


def _seconds(microseconds: float) -> float:
    """Seconds, rounded to whole nanoseconds so that 0.2 µs is the double nearest to 2e-7."""
    return round(microseconds * 1e3) / 1e9


def _stepper_numbers(stepper: Stepper) -> dict[str, Any]:
    times = stepper.times
    setup = _first(stepper.direction_setup_us, default=times.direction_us)
    hold = _first(stepper.direction_hold_us, default=times.direction_us)
    return {
        "steps_per_unit": stepper.steps_per_unit,
        "invert": stepper.invert,
        "pulse_s": _seconds(stepper.shortest_pulse_us),
        "dir_setup_s": _seconds(setup),
        "dir_hold_s": _seconds(hold),
        "max_rate_hz": _first(stepper.max_rate_hz, default=times.max_rate_hz),
        "speed": _first(stepper.speed_mm_s, stepper.speed_deg_s, default=inf),
        "accel": _first(stepper.accel_mm_s2, stepper.accel_deg_s2, default=inf),
        "min": _first(stepper.min_mm, stepper.min_deg, default=-inf),
        "max": _first(stepper.max_mm, stepper.max_deg, default=inf),
    }
