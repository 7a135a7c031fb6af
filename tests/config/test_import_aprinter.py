"""APrinter's JSON becomes a machine file. The document here is our own."""

import copy
import json
from pathlib import Path
from typing import Any

import pytest

from passo import config
from passo.cli.main import main
from passo.config.importing.aprinter import imported
from passo.errors import ConfigError


def port(name: str, step: str, direction: str, enable: str) -> dict[str, Any]:
    pins = {"StepPin": step, "DirPin": direction, "EnablePin": enable}
    return {"Name": name, "EnableLevel": False, **pins}


def switch(name: str, pin: str) -> dict[str, Any]:
    return {"Name": name, "Pin": pin, "InputMode": {"PullMode": "Pull-up"}}


def sensor(name: str, pin: str) -> dict[str, Any]:
    return {"Name": name, "Driver": {"Pin": pin}}


def output(name: str, pin: str, *, inverted: bool = False) -> dict[str, Any]:
    soft = {"_compoundName": "SoftPwm", "OutputPin": pin, "OutputInvert": inverted}
    return {"Name": name, "Backend": soft}


BOARD = {
    "name": "RAMPS 1.3",
    "stepper_ports": [
        port("X", "MegaPin54", "MegaPin55", "MegaPin38"),
        port("Y", "MegaPin60", "MegaPin61", "MegaPin56"),
        port("Z", "MegaPin46", "MegaPin48", "MegaPin62"),
        port("E0", "MegaPin26", "MegaPin28", "MegaPin24"),
        port("mine", "MegaPin36", "MegaPin34", "MegaPin32"),
    ],
    "digital_inputs": [
        switch("X-", "MegaPin3"),
        switch("Y+", "MegaPin15"),
        switch("Z-", "MegaPin18"),
        switch("Z+", "MegaPin19"),
    ],
    "analog_inputs": [sensor("T0", "MegaPinA13"), sensor("T1", "MegaPinA14")],
    "pwm_outputs": [
        output("D8", "MegaPin8"),
        {
            "Name": "D10",
            "Backend": {
                "_compoundName": "HardPwm",
                "HardPwmDriver": {"OutputPin": "AvrPin<AvrPortB,4>", "Invert": True},
            },
        },
        output("D9", "MegaPin9"),
    ],
}


def stepper(name: str, *ports: str, **more: Any) -> dict[str, Any]:
    slaves = [
        {"stepper_port": p, "InvertDir": p == "Z", "MicroSteps": 0, "Current": 0} for p in ports
    ]
    return {
        "Name": name,
        "StepsPerUnit": 80,
        "MinPos": 0,
        "MaxPos": 200,
        "MaxSpeed": 300,
        "MaxAccel": 1500,
        "CorneringDistance": 42,
        "IsExtruder": False,
        "homing": {"_compoundName": "no_homing"},
        "delay": {"_compoundName": "Delay", "StepHighTime": 2, "DirSetTime": 0.5},
        "slave_steppers": slaves,
        **more,
    }


def homing(name: str, *, upward: bool = False, inverted: bool = False) -> dict[str, Any]:
    return {
        "_compoundName": "homing",
        "HomeEndstopInput": name,
        "HomeDir": upward,
        "HomeEndInvert": inverted,
        "HomeOffset": 1.5,
        "HomeFastSpeed": 40,
        "HomeRetractDist": 4,
        "HomeSlowSpeed": 6,
        "HomeFastMaxDist": 230,
    }


def heater(kind: str, where: str, reads: str, low: float, high: float) -> dict[str, Any]:
    return {
        "Type": {"_compoundName": kind, "Number": 0},
        "pwm_output": where,
        "ThermistorInput": reads,
        "MinSafeTemp": low,
        "MaxSafeTemp": high,
        "conversion": {
            "_compoundName": "conversion",
            "R0": 100000,
            "Beta": 3960,
            "ResistorR": 4600,
        },
        "control": {
            "PidP": 0.05,
            "PidI": 0.001,
            "PidD": 0.2,
            "PidIStateMin": 0.0,
            "PidIStateMax": 0.6,
            "PidDHistory": 0.75,
            "ControlInterval": 0.2,
        },
        "observer": {"ObserverTolerance": 2.5, "ObserverMinTime": 4},
        "cold_extrusion_prevention": {"ExtruderAxes": ["U"] if kind == "Extruder" else []},
    }


DOCUMENT: dict[str, Any] = {
    "version": 1,
    "selected_config": "Mine",
    "boards": [BOARD],
    "configurations": [
        {"name": "Other"},
        {
            "name": "Mine",
            "board": "RAMPS 1.3",
            "InactiveTime": 300,
            "transform": {"_compoundName": "NoTransform"},
            "steppers": [
                stepper("X", "X", homing=homing("X-", inverted=True)),
                stepper("Y", "Y", homing=homing("Y+", upward=True)),
                stepper("Z", "Z", StepsPerUnit=400, homing=homing("Z-")),
                stepper("E", "E0", IsExtruder=True, MaxSpeed=45),
                stepper("U", "mine", IsExtruder=True),
            ],
            "heaters": [
                heater("Extruder", "D10", "T0", 10, 280),
                heater("Bed", "D8", "T1", 9, 120),
            ],
            "fans": [{"Number": 2, "pwm_output": "D9"}],
            "lasers": [],
            "probe_config": {
                "probe": {
                    "_compoundName": "Probe",
                    "ProbePin": "Z+",
                    "InvertInput": True,
                    "OffsetX": -18,
                    "OffsetY": -10,
                    "GeneralZOffset": -4.5,
                    "StartHeight": 9,
                    "LowHeight": 2,
                    "RetractDist": 1,
                    "MoveSpeed": 120,
                    "FastSpeed": 3,
                    "RetractSpeed": 8,
                    "SlowSpeed": 0.6,
                    "ProbePoints": [
                        {"Enabled": True, "X": 40, "Y": 40, "Z-offset": 0.1},
                        {"Enabled": True, "X": 150, "Y": 40, "Z-offset": 0},
                        {"Enabled": True, "X": 40, "Y": 150, "Z-offset": 0},
                        {"Enabled": False, "X": 150, "Y": 150, "Z-offset": 0},
                    ],
                    "correction": {
                        "_compoundName": "Correction",
                        "QuadraticCorrectionEnabled": False,
                    },
                }
            },
            "Moves": {
                "Moves": [
                    {
                        "HookType": "After homing",
                        "HookPriority": 11,
                        "Enabled": True,
                        "Speed": 90,
                        "Coordinates": [
                            {"AxisName": "X", "Value": 20},
                            {"AxisName": "Z", "Value": 30},
                        ],
                    }
                ]
            },
        },
    ],
}


@pytest.fixture
def load(tmp_path: Path):
    """A function from changes of the configuration, and of its text, to its draft and machine."""

    def convert(*changes: tuple[str, str], stored: str = "", **replaced: Any):
        found = copy.deepcopy(DOCUMENT)
        found["configurations"][1] |= replaced
        text = json.dumps(found, indent=1)
        for old, new in changes:
            assert old in text
            text = text.replace(old, new)
        path, further = tmp_path / "aprinter_config.json", tmp_path / "aprinter.cfg"
        path.write_text(text, encoding="utf-8")
        further.write_text(stored, encoding="utf-8")
        draft = imported(path, further if stored else None)
        return draft, config.load_text(draft.text("From a test."), "printer.toml")

    return convert


def test_aprinter_motors_and_axes_are_imported(load) -> None:
    _, machine = load()
    x, u = machine.axes["x"], machine.axes["u"]
    assert (x.min_mm, x.max_mm, x.speed_mm_s, x.accel_mm_s2) == (0, 200, 300, 1500)
    assert (x.cornering_distance_steps, machine.limits.junction) == (42, "cornering_distance")
    assert (u.extruder, u.heater, machine.extruders["e"].speed_mm_s) == (True, "hotend", 45)
    motors = machine.steppers
    assert [motors[name].socket for name in "xyze"] == ["X", "Y", "Z", "E0"]
    own = motors["u"]
    assert (own.socket, own.step_pin, own.enable_pin) == (None, "D36", "!D32")
    assert (motors["z"].steps_per_unit, motors["z"].invert, motors["x"].invert) == (
        400,
        True,
        False,
    )
    assert (motors["x"].pulse_us, motors["x"].direction_setup_us) == (2, 0.5)
    assert machine.idle.motors_off_s == 300


def test_aprinter_homing_is_imported(load) -> None:
    _, machine = load()
    x, y = machine.homing["x"], machine.homing["y"]
    assert (x.direction, x.position, x.pin) == ("min", 1.5, "!^D3")
    assert (x.fast, x.retract, x.slow, x.max_travel) == (40, 4, 6, 230)
    assert (y.direction, y.position, y.pin) == ("max", 201.5, "^D15")


def test_aprinter_heaters_and_fans_are_imported(load) -> None:
    """Gains of full power become those of 255; a filter that keeps 3/4 in 0.2 s has 0.6 s."""
    _, machine = load()
    hotend, bed = machine.heaters["hotend"], machine.heaters["bed"]
    assert (hotend.pin, hotend.sensor_pin, hotend.min_c, hotend.max_c) == ("!PB4", "A13", 10, 280)
    sensor = hotend.sensor
    assert (sensor.r25_ohm, sensor.beta_k, sensor.pullup_ohm) == (100_000, 3960, 4600)
    control = hotend.control
    assert (control.kp, control.ki, control.kd) == (12.75, 0.255, 51)
    assert (control.drive_max, control.filter_s) == (0.6, pytest.approx(0.6))
    assert (hotend.arrival.window_c, hotend.arrival.seconds) == (2.5, 4)
    assert (bed.kind, bed.pin, bed.max_c) == ("bed", "D8", 120)
    assert (machine.fans["fan2"].pin, machine.fans["fan2"].number) == ("D9", 2)
    platinum = ('"_compoundName": "conversion"', '"_compoundName": "PtRtdFormula", "PtR0": 1000')
    assert load(platinum)[1].heaters["bed"].sensor.kind == "pt1000"


def test_aprinter_probe_points_and_moves_are_imported(load) -> None:
    _, machine = load()
    probe, levelling = machine.probe, machine.levelling
    assert (probe.pin, probe.offset_mm, probe.trigger_height_mm) == ("!^D19", [18, 10], 4.5)
    assert (probe.start_mm, probe.low_mm, probe.retract_mm, probe.travel_mm_s) == (9, 2, 1, 120)
    assert (probe.fast_mm_s, probe.lift_mm_s, probe.slow_mm_s) == (3, 8, 0.6)
    points = [(p.x, p.y, p.offset, p.enabled) for p in levelling.points]
    assert points[0] == (40, 40, 0.1, True)
    assert points[3] == (150, 150, 0, False)
    assert levelling.method == "linear"
    move = machine.moves["move-1"]
    assert (move.position_mm, move.speed_mm_s) == ({"x": 20, "z": 30}, 90)
    assert (move.hook, move.priority) == ("after_homing", 11)


def test_stored_options_override_aprinter_defaults(load) -> None:
    """The lines of aprinter.cfg, and those that M503 answers, are read alike."""
    stored = "XStepsPerUnit=81.5\nZMaxPos=180\nExtruderHeater0PidP=0.1\nXInvertDir=1\n"
    stored += "M926 IProbeP2X V140\nProbeOffsetX=-20\nMaxStepsPerCycle=1\nno option\n"
    draft, machine = load(stored=stored)
    assert machine.steppers["x"].steps_per_unit == 81.5
    assert machine.steppers["x"].invert
    assert machine.axes["z"].max_mm == 180
    assert machine.heaters["hotend"].control.kp == 25.5
    assert (machine.levelling.points[1].x, machine.probe.offset_mm) == (140, [20, 10])
    assert "steps_per_mm = 81.5  # aprinter.cfg:1" in draft.text("")
    dropped = [remark.what for remark in draft.remarks if remark.fate == "dropped"]
    assert dropped == ["MaxStepsPerCycle"]
    with pytest.raises(ConfigError, match=r"aprinter.cfg:1: XMaxPos is 'far'"):
        load(stored="XMaxPos=far")


def axis(name: str, high: float, **more: Any) -> dict[str, Any]:
    none = {"_compoundName": "no_homing"}
    return {"Name": name, "MinPos": 0, "MaxPos": high, "MaxSpeed": 250, "homing": none, **more}


def test_aprinter_core_belts_are_imported(load) -> None:
    ends = homing("X-"), homing("Y+", upward=True)
    for end in ends:
        del end["HomeOffset"]
    transform = {
        "_compoundName": "CoreXY",
        "Steppers": {f"TransformStepper{i}": {"StepperName": name} for i, name in enumerate("BA")},
        "CartesianAxes": {
            "VirtualAxis0": axis("X", 180, homing=ends[0]),
            "VirtualAxis1": axis("Y", 190, homing=ends[1]),
        },
    }
    steppers = [stepper("A", "X"), stepper("B", "Y"), stepper("Z", "Z", homing=homing("Z-"))]
    _, machine = load(transform=transform, steppers=steppers, Moves={}, probe_config={})
    assert (machine.geometry.kind, machine.axes["x"].max_mm) == ("corexy", 180)
    assert (machine.steppers["a"].socket, machine.steppers["b"].socket) == ("Y", "X")
    assert (machine.homing["y"].direction, machine.homing["y"].position) == ("max", 190)


def test_aprinter_delta_is_imported(load) -> None:
    transform = {
        "_compoundName": "Delta",
        "DiagnalRod": 200,
        "DiagonalRodCorr2": 0.5,
        "SmoothRodOffset": 150,
        "EffectorOffset": 20,
        "CarriageOffset": 10,
        "LimitRadius": 80,
        "Steppers": {f"TransformStepper{i}": {"StepperName": name} for i, name in enumerate("CAB")},
        "CartesianAxes": {
            f"VirtualAxis{i}": axis(name, 100, MinPos=-100 if i < 2 else 0)
            for i, name in enumerate("XYZ")
        },
    }
    ends = [homing("X-", upward=True), homing("Y+", upward=True), homing("Z-", upward=True)]
    steppers = [
        stepper(name, p, MaxPos=260, homing=end)
        for name, p, end in zip("ABC", "XYZ", ends, strict=True)
    ]
    _, machine = load(transform=transform, steppers=steppers, Moves={}, probe_config={})
    geometry = machine.geometry
    assert (geometry.radius, geometry.rods, geometry.limit_radius) == (120, [200, 200.5, 200], 80)
    assert [machine.steppers[tower].socket for tower in "abc"] == ["Z", "X", "Y"]
    assert machine.homing["a"].position == 261.5
    assert machine.axes["z"].home_mm == pytest.approx(100)  # of 101.5 - 0.5 and 101.5 mm
    assert machine.steppers["a"].max_mm == 260


def arms(kind: str, axes: str, motors: str, reach: float = 100, **values: Any) -> dict[str, Any]:
    """A transform whose motors turn. X and Y get `reach` far from the middle."""
    return {
        "_compoundName": kind,
        **values,
        "Steppers": {f"TransformStepper{i}": {"StepperName": n} for i, n in enumerate(motors)},
        "CartesianAxes": {
            f"VirtualAxis{i}": axis(name, reach, MinPos=-reach if i < 2 else 0)
            for i, name in enumerate(axes)
        },
    }


def test_aprinter_rotational_delta_is_imported(load) -> None:
    lengths = {"EndEffectorLength": 30, "BaseLength": 40, "RodLength": 130, "ArmLength": 80}
    transform = arms("RotationalDelta", "XYZ", "ABC", **lengths, ZOffset=150)
    ends = [homing("X-"), homing("Y+"), homing("Z-")]
    for end in ends:
        end["HomeOffset"] = 0
    steppers = [
        stepper(name, p, MinPos=-30, MaxPos=80, homing=end)
        for name, p, end in zip("ABC", "XYZ", ends, strict=True)
    ]
    draft, machine = load(transform=transform, steppers=steppers, Moves={}, probe_config={})
    geometry = machine.geometry
    assert (geometry.kind, geometry.effector_length, geometry.base_length) == (
        "rotary_delta",
        30,
        40,
    )
    assert (geometry.rod_length, geometry.arm_length, geometry.z_offset) == (130, 80, 150)
    motor = machine.steppers["a"]
    assert (motor.min_deg, motor.max_deg, motor.steps_per_degree) == (-30, 80, 80)
    assert machine.homing["c"].position == -30
    # The arms point up by 30°: their elbows are 150 + 80 sin 30° high, 2.887 + 80 cos 30° outside
    # of the joints, to which the rods go down.
    height = 150 + 40 - (130**2 - (10 / 12**0.5 + 40 * 3**0.5) ** 2) ** 0.5
    home = [machine.axes[name].home_mm for name in "xyz"]
    assert home == pytest.approx([0, 0, height], abs=1e-3)
    limit = machine.axes["x"].accel_mm_s2
    assert limit == pytest.approx(motor.accel_deg_s2 * 3.14159265 / 180 * 210, rel=1e-5)
    assert any(f"{limit:g} mm/s²" in remark.text for remark in draft.remarks)
    with pytest.raises(ConfigError, match="arms that meet"):
        lengths["RodLength"] = 40
        load(transform=transform | lengths, steppers=steppers, Moves={}, probe_config={})


@pytest.mark.parametrize("external", [True, False])
def test_aprinter_scara_is_imported(load, external: bool) -> None:
    values = {"Arm1Length": 150, "Arm2Length": 140, "XOffset": 50, "YOffset": -60}
    transform = arms("SCARA", "XY", "BA", **values, ExternalArm2Motor=external)
    steppers = [
        stepper("A", "X", MinPos=-30, MaxPos=260, homing=homing("X-")),
        stepper("B", "Y", MinPos=-60, MaxPos=150, homing=homing("Y+")),
        stepper("Z", "Z", homing=homing("Z-")),
    ]
    _, machine = load(
        transform=transform,
        steppers=steppers,
        Moves={},
        probe_config={},
        stored="SCARAArm2Length=141\n",
    )
    geometry = machine.geometry
    assert (geometry.kind, geometry.arm1, geometry.arm2) == ("scara", 150, 141)
    assert (geometry.x_offset, geometry.y_offset, geometry.external_motor) == (50, -60, external)
    assert (machine.steppers["a"].socket, machine.steppers["b"].socket) == ("Y", "X")
    assert (machine.steppers["b"].max_deg, machine.steppers["z"].steps_per_mm) == (260, 80)
    assert machine.axes["x"].home_mm is None  # with the arms at their ends the nozzle is outside


def test_aprinter_dual_scara_is_imported(load) -> None:
    values = {"Arm1ShoulderXCoord": -40, "Arm2ShoulderXCoord": 45, "XOffset": 5, "YOffset": -90}
    values |= {"Arm1ProximalSideLength": 61, "Arm2ProximalSideLength": 62}
    values |= {"Arm1DistalSideLength": 71, "Arm2DistalSideLength": 72}
    steppers = [
        stepper("A", "X", MinPos=-90, MaxPos=90),
        stepper("B", "Y", MinPos=-90, MaxPos=90),
        stepper("Z", "Z", homing=homing("Z-")),
    ]
    _, machine = load(
        transform=arms("DualSCARA", "XY", "AB", 20, **values),
        steppers=steppers,
        Moves={},
        probe_config={},
    )
    found = machine.geometry
    assert (found.shoulder1_x, found.shoulder2_x, found.proximal1) == (-40, 45, 61)
    assert (found.proximal2, found.distal1, found.distal2) == (62, 71, 72)
    assert (found.x_offset, found.y_offset) == (5, -90)


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ('"NoTransform"', '"Polar"', "the kind of machine is 'Polar'"),
        ('"board": "RAMPS 1.3"', '"board": "Mine"', "the board is 'Mine'"),
        ('"MaxSafeTemp": 280', '"MaxSafe": 280', "MaxSafeTemp is missing"),
        ('"_compoundName": "conversion"', '"_compoundName": "Max31855Formula"', "Max31855Formula"),
        ('"ThermistorInput": "T0"', '"ThermistorInput": "T9"', "analog_inputs is 'T9'"),
        ("MegaPinA13", "MegaPinA99", "Pin is 'MegaPinA99'"),
        ('"StepsPerUnit": 400', '"StepsPerUnit": "many"', "StepsPerUnit is 'many'"),
        ('"StepsPerUnit": 400', '"StepsPerUnit": 1e999', "a number from -1e+12"),
        ('"version": 1,', '"version": 1', "the document is '"),
        ('"version": 1,', '"version": .,', "the document is '.,"),
        ('"version": 1,', '"version": ' + "[" * 50, "the document is '["),
        ('"version": 1,', '"version": "\\u00zz",', "the document is"),
    ],
)
def test_wrong_values_have_a_sentence(load, old: str, new: str, sentence: str) -> None:
    with pytest.raises(ConfigError) as caught:
        load((old, new))
    assert sentence in str(caught.value)
    assert caught.value.problems[0].line


def test_command_imports_by_the_ending(tmp_path: Path, capsys) -> None:
    path, stored = tmp_path / "aprinter_config.json", tmp_path / "dump.txt"
    path.write_text(json.dumps(DOCUMENT), encoding="utf-8")
    stored.write_text("M926 IXMaxPos V190\nok\n", encoding="utf-8")
    output = tmp_path / "mine.toml"
    words = ["import", str(path), "--output", str(output)]
    assert main([*words, "--stored", str(stored)]) == 0
    assert config.load(output).axes["x"].max_mm == 190
    other = tmp_path / "printer.cfg"
    other.write_text("[printer]\n")
    words = ["import", str(other), "--output", str(tmp_path / "other.toml")]
    assert main([*words, "--stored", str(stored)]) == 3
    assert "contains its stored values" in capsys.readouterr().err
