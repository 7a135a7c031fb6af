"""Loading: shipped machines, boards beneath machines, and what the core is told."""

import json
import re
from itertools import product
from math import inf
from pathlib import Path
from typing import get_args

import pytest
from pydantic_core import PydanticUndefined

from passo import config
from passo.config.drivers import DRIVERS
from passo.config.findings import did_you_mean
from passo.errors import ConfigError, ExitStatus
from passo.geometry.registry import GEOMETRIES

I3 = config.shipped_text("i3")
REQUIRED = {
    "i3",
    "big-fish-i3",
    "corexy",
    "delta",
    "rotary-delta",
    "scara",
    "dual-extruder",
    "multi-material",
    # APrinter's examples; those of its two deltas are above
    "radds",
    "ramps-fd",
    "four-pi",
    "teensy3",
    "ramps-13",
    "melzi",
    "stm32f407-discovery",
    "stm32f429-discovery",
    "linux-test",
    # with Klipper's firmware
    "voron-2-4",
    "voron-0",
    "ender3-v2",
    "prusa-mk3s",
    "kossel",
}
CLOCKS = {
    "Duet 0.6": 42_000_000,
    "RADDS": 42_000_000,
    "RAMPS-FD": 42_000_000,
    "4pi": 96_000_000,
    "Teensy 3.2": 72_000_000,
    "STM32F407 Discovery": 84_000_000,
    "STM32F429 Discovery": 84_000_000,
    "Linux process": 50_000_000,
    "Octopus V1.1": 180_000_000,
    "SKR Mini E3 V2.0": 72_000_000,
    "Creality 4.2.2": 72_000_000,
    "SKR V1.3": 100_000_000,
}


def test_all_required_machines_are_shipped() -> None:
    assert set(config.shipped_machines()) >= REQUIRED


@pytest.mark.parametrize("name", config.shipped_machines())
def test_shipped_machine_loads_under_its_own_name(name: str) -> None:
    machine = config.load(name)
    assert machine.name == name
    assert machine.board.clock_hz == CLOCKS.get(machine.board.name, 16_000_000)
    spec = machine.core_spec()
    assert len(spec["steppers"]) == len(machine.steppers)
    assert [axis["letter"] for axis in spec["axes"]][:3] == ["X", "Y", "Z"]


def test_shipped_machines_have_different_uuids() -> None:
    uuids = [config.load(name).uuid for name in config.shipped_machines()]
    assert len(set(uuids)) == len(uuids)


def test_i3_is_compiled_for_the_core() -> None:
    spec = config.load("i3").core_spec()
    assert spec["clock_hz"] == 16_000_000
    assert spec["tolerance_s"] == 2e-6
    assert [(a["min"], a["max"], a["speed"], a["accel"], a["jerk"]) for a in spec["axes"]] == [
        (0.0, 250.0, 300.0, 3000.0, 10.0),
        (0.0, 220.0, 300.0, 3000.0, 10.0),
        (0.0, 250.0, 12.0, 100.0, 0.4),
    ]
    assert spec["axes"][0]["cornering_steps"] == 40.0
    assert spec["extruders"] == [
        {"name": "e", "speed": 100.0, "accel": 5000.0, "jerk": 1.0, "advance_s": 0.0}
    ]
    assert spec["tools"] == [{"extruder": 0, "offset": [0.0, 0.0, 0.0]}]
    assert spec["geometry"]["kind"] == "cartesian"
    assert spec["laser"] is None
    assert spec["limits"] == {
        "print_accel": 3000.0,
        "travel_accel": 3000.0,
        "retract_accel": 5000.0,
        "speed": inf,
        "junction": "deviation",
        "junction_deviation": 0.02,
        "square_corner": 5.0,
        "minimum_cruise_ratio": 0.0,
        "least_speed_gain": 0.0,
    }
    assert spec["steppers"][3] == {
        "name": "e",
        "drive": "extruder",
        "index": 0,
        "board": 0,
        "steps_per_unit": 95.5,
        "invert": False,
        "pulse_s": 1e-6,
        "dir_setup_s": 2e-7,
        "dir_hold_s": 2e-7,
        "max_rate_hz": 500_000.0,
        "speed": inf,
        "accel": inf,
        "min": -inf,
        "max": inf,
    }
    assert [s["steps_per_unit"] for s in spec["steppers"]] == [80.0, 80.0, 400.0, 95.5]


def test_big_fish_lifts_with_two_motors_of_reversed_direction() -> None:
    steppers = config.load("big-fish-i3").core_spec()["steppers"]
    assert [(s["name"], s["drive"], s["index"], s["invert"]) for s in steppers] == [
        ("x", "actuator", 0, False),
        ("y", "actuator", 1, False),
        ("z", "actuator", 2, True),
        ("z1", "actuator", 2, True),
        ("e", "extruder", 0, True),
    ]
    assert [s["max_rate_hz"] for s in steppers] == [4e5, 4e5, 5e5, 5e5, 4e5]


def test_fisher_delta_has_its_tower_angles() -> None:
    spec = config.load("delta").core_spec()
    assert spec["geometry"]["radius"] == 81.0
    assert spec["geometry"]["rods"] == [160.0, 160.0, 160.0]
    assert spec["geometry"]["limit_radius"] == 75.1
    tower = spec["steppers"][0]
    assert (tower["steps_per_unit"], tower["speed"], tower["accel"]) == (87.489, 250.0, 4000.0)
    assert (tower["min"], tower["max"]) == (30.0, 318.0)
    assert [axis["home"] for axis in spec["axes"]] == [0.0, 0.0, 180.018117131]


def test_arm_motors_are_scaled_in_degrees() -> None:
    arm = config.load("rotary-delta").core_spec()["steppers"][2]
    assert arm["name"] == "c"
    assert (arm["steps_per_unit"], arm["min"], arm["max"]) == (218.18, -30.0, 80.0)
    assert (arm["speed"], arm["accel"]) == (220.0, 1100.0)


def test_five_tools_share_one_extruder() -> None:
    tools = config.load("multi-material").core_spec()["tools"]
    assert [tool["extruder"] for tool in tools] == [0] * 5


def test_two_extruders_have_two_motors_and_an_offset() -> None:
    spec = config.load("dual-extruder").core_spec()
    assert [tool["extruder"] for tool in spec["tools"]] == [0, 1]
    assert spec["tools"][1]["offset"] == [25.0, 0.0, 0.0]
    assert [(s["name"], s["index"]) for s in spec["steppers"][3:]] == [("e", 0), ("e1", 1)]


def test_machine_loads_by_path_or_name(tmp_path: Path, i3_text: str) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(i3_text.replace('name = "i3"', 'name = "mine"'))
    assert config.load(path).core_spec()["steppers"] == config.load("i3").core_spec()["steppers"]


def test_a_machine_overrides_its_board(i3_text: str) -> None:
    text = i3_text + "clock_hz = 20_000_000\ncompression_tolerance_us = 5\n"
    machine = config.load_text(text)
    assert machine.core_spec()["clock_hz"] == 20_000_000
    assert machine.core_spec()["tolerance_s"] == 5e-6
    assert machine.board.mcu == "atmega2560"
    assert machine.board.sockets["X"].step == "PF0"


def test_further_axes_come_after_z_and_before_extruders(i3_text: str) -> None:
    text = i3_text + (
        "[axes.u]\nmax_mm = 60\nspeed_mm_s = 20\naccel_mm_s2 = 200\n"
        "[steppers.u]\nsteps_per_mm = 160\nsocket = 'E1'\n"
    )
    spec = config.load_text(text).core_spec()
    assert [axis["letter"] for axis in spec["axes"]] == ["X", "Y", "Z", "U"]
    assert [(s["name"], s["drive"], s["index"]) for s in spec["steppers"][3:]] == [
        ("u", "axis", 3),
        ("e", "extruder", 0),
    ]


def test_steps_from_rotation_distance_and_gears(i3_text: str) -> None:
    scale = "rotation_distance_mm = 8\nmicrosteps = 32\nfull_steps_per_rotation = 400\n"
    text = i3_text.replace("steps_per_mm = 400.0\n", scale + "gear_ratio = 2\n")
    stepper = config.load_text(text).core_spec()["steppers"][2]
    assert stepper["steps_per_unit"] == 400 * 32 * 2 / 8


def test_single_times_override_the_drivers(i3_text: str) -> None:
    times = "pulse_us = 1.9\ndirection_setup_us = 20\ndirection_hold_us = 0.65\n"
    text = i3_text.replace("[steppers.x]\n", f"[steppers.x]\n{times}driver = 'TB6560'\n")
    stepper = config.load_text(text).core_spec()["steppers"][0]
    assert stepper["pulse_s"] == 1.9e-6
    assert stepper["dir_setup_s"] == 20e-6
    assert stepper["dir_hold_s"] == 6.5e-7
    assert stepper["max_rate_hz"] == 15_000.0


def test_laser_letters_reach_the_core_only_if_given(i3_text: str) -> None:
    laser = i3_text + "[laser]\npin = 'D4'\n"
    assert config.load_text(laser).core_spec()["laser"] is None
    letters = laser + "energy_letter = 'L'\ndensity_letter = 'M'\n"
    spec = config.load_text(letters).core_spec()["laser"]
    powers = {"full_w": 100.0, "most_w": 100.0}
    assert spec == {"density_letter": "M", "energy_letter": "L"} | powers
    weaker = letters + "power_w = 5\nmax_power_w = 4\n"
    spec = config.load_text(weaker).core_spec()["laser"]
    assert (spec["full_w"], spec["most_w"]) == (5.0, 4.0)


@pytest.mark.parametrize("microsteps", [1, 2, 4, 8, 16, 32, 64, 128, 256])
def test_microsteps_of_a_motor(microsteps) -> None:
    scale = f"rotation_distance_mm = 40\nmicrosteps = {microsteps}"
    machine = config.load_text(I3.replace("steps_per_mm = 400.0", scale))
    assert machine.steppers["z"].steps_per_unit == 5 * microsteps


def test_an_axis_may_be_at_home_below_zero() -> None:
    z = I3.index("[axes.z]")
    text = I3[:z] + I3[z:].replace("min_mm = 0.0", "min_mm = -10\nhome_mm = HOME", 1)
    for mm in (-10, -5, 250):
        assert config.load_text(text.replace("HOME", str(mm))).axes["z"].home_mm == mm
    with pytest.raises(ConfigError, match="a position between -10 and 250"):
        config.load_text(text.replace("HOME", "-10.1"))


def test_fan_numbers_are_from_0_to_255() -> None:
    for number in (0, 255):
        machine = config.load_text(I3.replace('pin = "D9"', f'pin = "D9"\nnumber = {number}'))
        assert machine.fans["part"].number == number
    for number in (-1, 256):
        with pytest.raises(ConfigError, match=r"fans\.part\.number"):
            config.load_text(I3.replace('pin = "D9"', f'pin = "D9"\nnumber = {number}'))


def test_known_words_are_reported_if_they_are_few() -> None:
    assert did_you_mean("d9", ["D8", "D9"]) == "Did you mean 'D9'?"
    assert did_you_mean("q", []) == ""
    assert did_you_mean("q", map(str, range(17))) == ""
    assert did_you_mean("q", map(str, range(16))).startswith("Known here: 0, 1, 10, ")


def test_unknown_machine_names_the_close_one() -> None:
    with pytest.raises(ConfigError) as caught:
        config.load("corexz")
    assert caught.value.status == ExitStatus.BAD_CONFIG
    assert str(caught.value) == "there is no machine called 'corexz'. Did you mean 'corexy'?"


def test_a_file_without_the_ending_toml_is_not_a_machine(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "ok.g").touch()
    with pytest.raises(ConfigError) as caught:
        config.load("ok.g")
    told = "there is no machine called 'ok.g'. A machine file's name ends in .toml."
    assert str(caught.value) == told


def test_missing_file_and_directory_are_named(tmp_path: Path) -> None:
    for path in (tmp_path / "none.toml", tmp_path):
        with pytest.raises(ConfigError) as caught:
            config.load(path)
        assert [problem.code for problem in caught.value.problems] == ["config.unreadable"]
        assert caught.value.problems[0].file == str(path)


def test_the_documented_driver_table_is_the_one_in_use() -> None:
    text = (Path(__file__).parents[2] / "docs" / "how-to" / "write-a-machine-file.md").read_text()
    rows = [line.strip("|").split("|") for line in text.splitlines() if " µs |" in line]
    table = {
        name.strip(): (
            float(pulse.replace("µs", "")),
            float(direction.replace("µs", "")),
            float(rate.replace(" ", "")),
        )
        for name, pulse, direction, rate in rows
    }
    tmc = table.pop("TMC2100 ... TMC5160")
    for driver, times in DRIVERS.items():
        assert tuple(times) == (tmc if driver.startswith("TMC") else table.pop(driver))
    assert not table


def test_the_documented_geometries_are_those_that_there_are() -> None:
    text = (Path(__file__).parents[2] / "docs" / "how-to" / "write-a-machine-file.md").read_text()
    table = text.partition("## Geometries")[2].partition("\n## ")[0]
    rows = [line.strip("|").split("|") for line in table.splitlines() if line.startswith("| `")]
    told = {kind.strip(" `"): (motors.split(), keys) for kind, motors, _, keys in rows}
    for model in GEOMETRIES:
        fields = dict(model.model_fields)
        (kind,) = get_args(fields.pop("kind").annotation)
        for key in ("skew", "reach_x_mm", "reach_y_mm"):  # docs/how-to/correct-skew.md
            fields.pop(key, None)
        motors, keys = told.pop(kind)
        assert tuple(motors) == model.motors
        values = re.findall(r"`(\w+)`(?: (-?\d+(?:\.\d+)?|true|\[.*?\])(?![°\w]))?", keys)
        defaults = {key: json.loads(value) if value else PydanticUndefined for key, value in values}
        assert defaults == {key: field.default for key, field in fields.items()}
    assert not told


def test_documented_machine_excerpt_is_valid() -> None:
    text = (Path(__file__).parents[2] / "docs" / "how-to" / "write-a-machine-file.md").read_text()
    example = text.split("```toml\n")[1].split("```")[0]
    with pytest.raises(ConfigError) as caught:
        config.load_text(example)
    missing = {problem.values["key"] for problem in caught.value.problems}
    assert missing == {"axes.y", "axes.z", "steppers.x", "steppers.y", "steppers.e"}


@pytest.mark.parametrize("name", ["rotary-delta", "scara"])
def test_arms_reach_all_that_the_soft_limits_allow(name: str) -> None:
    machine = config.load(name)
    spec = machine.core_spec()
    spans = [(axis["min"], (axis["min"] + axis["max"]) / 2, axis["max"]) for axis in spec["axes"]]
    for point in product(*spans):
        angles = machine.geometry.inverse(point)
        for stepper, angle in zip(spec["steppers"], angles, strict=False):
            assert stepper["min"] <= angle <= stepper["max"], (point, stepper["name"])


def test_fisher_carriages_stay_on_their_towers() -> None:
    machine = config.load("delta")
    for z in (0.0, 180.0):
        carriages = machine.geometry.inverse((0.0, 0.0, z))
        assert carriages == pytest.approx([z + 137.982] * 3, abs=1e-3)
        assert all(30 <= carriage <= 318 for carriage in carriages)


@pytest.mark.parametrize(
    ("driver", "cycles"), [("DRV8825", 90), ("TB6600", 90 + 16), ("TB6560", 90 + 28 * 16)]
)
def test_a_long_pulse_takes_its_time_from_the_budget(
    i3_text: str, driver: str, cycles: int
) -> None:
    machine = config.load_text(i3_text.replace('"Z"', f'"Z"\ndriver = "{driver}"'))
    budget = machine.core_spec()["budgets"][0]
    assert budget["steps_s"] == pytest.approx(0.65 * 16e6 / cycles)


def test_a_board_brings_its_budget(i3_text: str) -> None:
    spec = config.load("i3").core_spec()["budgets"][0]
    assert spec["steps_s"] == pytest.approx(0.65 * 16e6 / 90)
    assert spec["commands_s"] == pytest.approx(0.3 * 16e6 / 1950)
    assert spec["burst"] == 401 / 2
    assert spec["bound"] == "commands"
    slow = config.load_text(i3_text + "budget = { link_bytes_s = 8300 }\nmove_count = 152\n")
    serial = 'link = "serial"\nport = "/dev/x"\nbaud = 83_000\n'
    bound = pytest.approx((7885 - 20 / 0.075) / 8.3)
    assert config.load_text(i3_text + serial).core_spec()["budgets"][0]["commands_s"] == bound
    bound, burst = pytest.approx(1000), pytest.approx(60)
    less = spec | {"commands_s": bound, "burst": burst, "bound": "link"}
    assert slow.core_spec()["budgets"][0] == less


@pytest.mark.parametrize(
    ("board", "kept"),
    [
        ('link = "serial"\nport = "/dev/x"\n', 20 / 0.075),
        ('link = "tcp"\nport = "x:1"\nbudget = { link_bytes_s = 20_000 }\n', 20 / 0.075),
        ('link = "tcp"\nport = "x:1"\nbudget = { link_bytes_s = 400 }\n', 200.0),
        ('firmware = "passo"\nbudget = { link_bytes_s = 20_000 }\n', 20 / 0.075),
        ('firmware = "passo"\n', 20 / 0.075),
        ("budget = { link_bytes_s = 20_000 }\n", 0.0),
    ],
)
def test_a_part_of_the_link_is_kept_for_commits(i3_text: str, board: str, kept: float) -> None:
    machine = config.load_text(i3_text + board)
    assert machine.board.commit_bytes_s == pytest.approx(kept)
    spec, simulated = machine.core_spec()["budgets"][0], config.load("i3").core_spec()["budgets"][0]
    assert (spec["commits_s"] > 0) == (kept > 0)
    by_link = (machine.board.link_bytes_s - kept) / 8.3
    by_slots = 401 / (0.2 if kept else 0.15)
    rate = min(simulated["commands_s"], by_link, by_slots)
    assert spec["commands_s"] == pytest.approx(rate)
    if machine.board.link_bytes_s == inf:
        assert spec["burst"] == pytest.approx(min(simulated["burst"], 0.1 * by_slots))
    else:  # a link must have carried a burst away before it makes commands late
        burst_s = 0.035 if kept else 0.06
        assert spec["burst"] == pytest.approx(min(0.1 * spec["commands_s"], burst_s * by_link))


def test_a_board_with_klippers_firmware_keeps_nothing() -> None:
    board = config.load_board("klipper")
    live = board.model_copy(update={"link": "serial", "port": "/dev/x"})
    assert not live.survives
    assert live.commit_bytes_s == 0.0
