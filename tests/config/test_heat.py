"""Heaters in a machine file: what is understood, and what is refused with which sentence."""

from __future__ import annotations

import re

import pytest

from passo import config
from passo.config.sensor_names import NAMED
from passo.config.sensor_tables import sensor_table, share_at
from passo.config.sensors import SensorTable, Thermistor
from passo.config.thermistor import Ntc
from passo.errors import ConfigError
from passo.heat.control import limits_of
from passo.library.machine import Machine

HEAD = "max_c = 285.0\n"


def loaded(text: str, lines: str) -> config.MachineConfig:
    return config.load_text(text.replace(HEAD, HEAD + lines, 1), "my.toml")


def test_heater_defaults_are_those_of_the_reference(i3_text):
    heater = config.load_text(i3_text).heaters["hotend"]
    assert heater.sensor.kind == "thermistor"
    assert heater.control.kind == "pid"
    assert heater.on_fault == "machine"
    assert heater.protection.runaway_c == 4.0


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ("sensor = { kind = 'pt10' }", "sensor.kind is 'pt10': expected one of thermistor, pt100,"),
        ("sensor = { beta_k = 1.0 }", "sensor.kind is missing: expected one of thermistor, pt100,"),
        ("sensor = { kind = 'pt100', gain = 1.0 }", "heaters.hotend.sensor.gain is not a known"),
        (
            "sensor = { kind = 'thermistor', beta_k = 0 }",
            "sensor.beta_k is 0: expected a number of at least 100",
        ),
        (
            "sensor = { kind = 'thermistor', beta_k = 1e9 }",
            "sensor.beta_k is 1000000000.0: expected a number of at most 20000",
        ),
        (
            "sensor = { kind = 'thermistor', r25_ohm = 0.1 }",
            "sensor.r25_ohm is 0.1: expected a number of at least 1",
        ),
        (
            "sensor = { kind = 'thermistor', r25_ohm = 1 }",
            "heaters.hotend.sensor is 'thermistor': expected values with distinct readings from"
            " 5 to 285 °C",
        ),
        ("sensor = { kind = 'pt100', pullup_ohm = 1e9 }", "from 5 to 285 °C"),
        ("sensor = { kind = 'pt1000-amplifier' }", "from 5 to 285 °C"),
        ("sensor = { kind = 'table', points = [[300, 1], [400, 0]] }", "from 5 to 285 °C"),
        ("control = { kind = 'model', kp = 1.0 }", "heaters.hotend.control.kp is not a known key"),
        ("control = { kind = 'pid', drive_min = 1.0 }", "drive_min is 1.0: expected a share of p"),
        ("on_fault = 'job?'", "on_fault is 'job?': expected one of 'machine', 'job' or 'heater'"),
        ("min_c = 300.0", "max_c is 285.0: expected a temperature above min_c"),
        ("sensor = { kind = 'table', points = [[0, 1], [9, 0.5], [12, 0.6]] }", "only rise or on"),
        ("sensor = { kind = 'table', points = [[0, 1], [9, -0.5]] }", "shares from 0 to 1"),
        ("sensor = { kind = 'table', file = 'no.csv' }", "a table that can be read (No such file"),
    ],
)
def test_wrong_heater_values_are_refused(i3_text, line, says):
    with pytest.raises(ConfigError) as error:
        loaded(i3_text, line + "\n")
    (problem,) = error.value.problems
    assert says in str(problem)
    assert problem.line is not None


QUESTIONS = [
    ("hotend", "kp = 0.0844, ki = 0.00417", "kp", "kp = 21.52, ki = 1.063 (multiplied by 255)"),
    ("hotend", "kp = 1.0", "kp", "kp = 255 (multiplied by 255)"),
    ("hotend", "kp = 5489.385", "kp", "kp = 21.53 (divided by 255)"),
    ("hotend", "kp = 5000, kd = 0.0", "kp", "kp = 19.61, kd = 0 (divided by 255)"),
    ("hotend", "kp = 21.5, ki = 300.0", "ki", "ki = 1.176 (divided by 255)"),
    ("hotend", "kp = 21.5, kd = 0.4", "kd", "kd = 102 (multiplied by 255)"),
    ("bed", "kp = 1.27, ki = 0.01", "kp", "kp = 323.9, ki = 2.55 (multiplied by 255)"),
]


@pytest.mark.parametrize(("heater", "gains", "key", "meant"), QUESTIONS)
def test_gains_of_another_unit_are_questioned(i3_text, tmp_path, heater, gains, key, meant):
    head = f"[heaters.{heater}]\n"
    line = f"control = {{ kind = 'pid', {gains} }}\n"
    file = tmp_path / "my.toml"
    file.write_text(i3_text.replace(head, head + line))
    machine, (question,), _ = config.load_and_question(file)
    assert getattr(machine.heaters[heater].control, key) > 0
    assert question.place == f"{file}:{i3_text[: i3_text.index(head)].count(chr(10)) + 2}"
    assert f"heaters.{heater}.control.{key} is " in str(question)
    assert meant in str(question)


@pytest.mark.parametrize(
    ("heater", "gains"),
    [
        ("hotend", "kp = 21.527, ki = 1.063, kd = 108.982"),
        ("hotend", "kp = 7.65, ki = 0.0, kd = 0.0"),
        ("bed", "kp = 10.0, ki = 0.023, kd = 305.4"),
        ("bed", "kp = 690.34, ki = 111.47, kd = 1068.83"),
        ("hotend", ""),
    ],
)
def test_gains_as_owners_copy_them_are_not_questioned(i3_text, tmp_path, heater, gains):
    head = f"[heaters.{heater}]\n"
    gains = f", {gains}" if gains else ""
    file = tmp_path / "my.toml"
    file.write_text(i3_text.replace(head, f"{head}control = {{ kind = 'pid'{gains} }}\n"))
    assert config.load_and_question(file).questions == ()


def test_a_gain_that_no_unit_explains_gets_the_usual_range(i3_text, tmp_path):
    head = "[heaters.hotend]\n"
    file = tmp_path / "my.toml"
    file.write_text(i3_text.replace(head, f"{head}control = {{ kind = 'pid', kp = 0.001 }}\n"))
    (question,) = config.load_and_question(file).questions
    assert str(question).endswith(
        "kp is 0.001: a hotend has 1.5 to 1000, where full power is 255. Copy the gains of Klipper,"
        " Marlin or M303, or leave them out."
    )


def test_unknown_fan_of_a_heater_is_named(i3_text):
    with pytest.raises(ConfigError, match=r"fan is 'prat': .* Did you mean 'part'"):
        config.load_text(i3_text.replace('fan = "part"', 'fan = "prat"'))


def test_max_c_is_within_the_range_of_the_sensor(i3_text):
    line = "sensor = { kind = 'table', points = [[20.0, 0.9], [150.0, 0.2]] }\n"
    with pytest.raises(ConfigError) as raised:
        loaded(i3_text, line)
    assert "heaters.hotend.max_c is 285.0: expected at most 150 °C" in str(raised.value)


def test_sensor_table_is_read_from_a_file(i3_text, tmp_path):
    (tmp_path / "ntc.csv").write_text("# °C, share\n25, 0.9\n\n300.5, 0.5  # hot\n")
    text = i3_text.replace(HEAD, HEAD + "sensor = { kind = 'table', file = 'ntc.csv' }\n", 1)
    machine = tmp_path / "my.toml"
    machine.write_text(text)
    sensor = config.load(machine).heaters["hotend"].sensor
    assert isinstance(sensor, SensorTable)
    assert sensor.points == [[25.0, 0.9], [300.5, 0.5]]
    (tmp_path / "ntc.csv").write_text("25, 0.9\n100\n")
    with pytest.raises(ConfigError, match="line 2 is no"):
        config.load(machine)


DUET = (
    ('base = "ramps"', 'base = "duet-0.6"'),
    ('pin = "D10"\nsensor_pin = "T0"', 'pin = "HE0"\nsensor_pin = "TH0"'),
    ('pin = "D8"\nsensor_pin = "T1"', 'pin = "BED"\nsensor_pin = "TB"'),
    ('pin = "D9"', 'pin = "FAN0"'),
    *((f"{axis}_MIN", f"{axis}_STOP") for axis in "XYZ"),
)


def duet(text: str) -> str:
    for ramps, other in DUET:
        text = text.replace(ramps, other)
    return text


def test_a_board_file_states_its_pull_ups(i3_text):
    heaters = config.load_text(duet(i3_text)).heaters
    assert [getattr(h.sensor, "pullup_ohm", None) for h in heaters.values()] == [1000.0, 1000.0]
    # 100 kΩ at 25 °C, β 3950 K: 743.5 Ω at 200 °C.
    share = share_at(sensor_table(heaters["hotend"].sensor), 200.0)
    assert share == pytest.approx(743.5 / 1743.5, abs=1e-3)


@pytest.mark.parametrize(
    ("sensor", "found"),
    [
        ("{ kind = 'thermistor', beta_k = 4092.0 }", 1000.0),
        ("{ kind = 'thermistor', pullup_ohm = 2200.0 }", 2200.0),
        ("{ kind = 'pt1000' }", 1000.0),
        ("{ kind = 'pt1000-amplifier', gain = 1.0 }", 4400.0),
    ],
)
def test_sensor_overrides_default(i3_text, sensor, found):
    heater = loaded(duet(i3_text), f"sensor = {sensor}\n").heaters["hotend"]
    assert getattr(heater.sensor, "pullup_ohm", None) == found


def test_pull_ups_are_4700_ohm_elsewhere(i3_text):
    sensor = config.load_text(i3_text).heaters["hotend"].sensor
    assert getattr(sensor, "pullup_ohm", None) == 4700.0
    own = i3_text.replace('base = "ramps"', 'base = "ramps"\npullup_ohm = 10_000.0')
    sensor = config.load_text(own).heaters["hotend"].sensor
    assert getattr(sensor, "pullup_ohm", None) == 10_000.0


# °C and ohm of the tables, the latter of Marlin's by its pull-up resistor, and what may be off, °C.
DATA = [
    ("EPCOS 100K B57560G104F", (150.0, 1641.9), 0.02),
    ("EPCOS 100K B57560G104F", (250.0, 226.15), 0.02),
    ("ATC Semitec 104GT-2", (20.0, 126_800.0), 0.02),
    ("ATC Semitec 104GT-2", (300.0, 80.65), 0.02),
    ("ATC Semitec 104NT-4-R025H42G", (160.0, 1074.0), 0.02),
    ("Generic 3950", (150.0, 1770.0), 0.02),
    ("SliceEngineering 450", (400.0, 240.0), 0.05),
    ("TDK NTCG104LH104JT1", (50.0, 31_230.0), 0.02),
    ("Honeywell 100K 135-104LAG-J01", (25.0, 100_000.0), 0.01),
    ("Marlin 1", (250.0, 4700 * 48 / (1024 - 48)), 1.3),
    ("Marlin 11", (150.0, 4700 * 301 / (1024 - 301)), 0.6),
    ("Marlin 11", (209.0, 4700 * 121 / (1024 - 121)), 0.6),
]


@pytest.mark.parametrize(("name", "point", "off_c"), DATA)
def test_a_sensor_by_its_name_reads_as_its_table(i3_text, name, point, off_c):
    sensor = loaded(i3_text, f"sensor = '{name}'\n").heaters["hotend"].sensor
    assert isinstance(sensor, Thermistor)
    celsius, ohm = point
    ntc = Ntc(sensor.r25_ohm, sensor.beta_k, sensor.c_per_k)
    assert ntc.celsius(ohm) == pytest.approx(celsius, abs=off_c)


@pytest.mark.parametrize("named", NAMED, ids=lambda named: named.name)
def test_each_name_loads_with_the_values_of_the_reference(i3_text, named):
    text = i3_text.replace(HEAD, f"max_c = 120.0\nsensor = '{named.name}'\n", 1)
    sensor = config.load_text(text).heaters["hotend"].sensor.model_dump()
    assert {key: sensor[key] for key in named.values} == named.values


@pytest.mark.parametrize(
    ("written", "same"),
    [
        ("'atc semitec 104gt2'", "'ATC Semitec 104GT-2'"),
        ("{ kind = 'Generic 3950' }", "'Generic 3950'"),
        ("5", "'Marlin 5'"),
        ("'5'", "{ kind = 'marlin 5' }"),
        ("{ kind = 1 }", "'Marlin 1'"),
        ("'PT1000'", "{ kind = 'pt1000' }"),
        ("1047", "{ kind = 'pt1000', pullup_ohm = 4700.0 }"),
        ("'AD8495'", "-4"),
        (
            "{ kind = 'Generic 3950', beta_k = 4000.0 }",
            "{ kind = 'thermistor', beta_k = 4000.0, c_per_k = 1.63283e-7 }",
        ),
    ],
)
def test_sensor_names_are_found_in_any_spelling(i3_text, written, same):
    one, other = (loaded(i3_text, f"sensor = {x}\n").heaters["hotend"] for x in (written, same))
    assert one.sensor == other.sensor


def test_sensor_name_takes_pull_up_of_board(i3_text):
    for word, ohm in (
        ("5", 1000.0),
        ("99", 10_000.0),
        ("{ kind = 5, pullup_ohm = 2200.0 }", 2200.0),
    ):
        sensor = loaded(duet(i3_text), f"sensor = {word}\n").heaters["hotend"].sensor
        assert getattr(sensor, "pullup_ohm", None) == ohm


@pytest.mark.parametrize(
    ("written", "key", "near"),
    [
        ("'Generic 3960'", "sensor", "Did you mean 'Generic 3950'?"),
        ("{ kind = 'EPCOS', beta_k = 1 }", "sensor.kind", "Did you mean 'EPCOS 100K B57560G104F'?"),
        ("'104GT2'", "sensor", "Names like it: 'ATC Semitec 104GT-2', "),
        ("'NTC3950'", "sensor", "'Generic 3950', 'NTC 100K beta 3950'"),
        ("66", "sensor", "'Marlin 67'"),
        ("'Marlin-5'", "sensor", "'Marlin 5'"),
        ("'qqq'", "sensor", "docs/reference/sensors.md"),
    ],
)
def test_unknown_sensor_error_lists_similar_names(i3_text, written, key, near):
    with pytest.raises(ConfigError) as error:
        loaded(i3_text, f"sensor = {written}\n")
    (problem,) = error.value.problems
    assert f"heaters.hotend.{key} is " in str(problem)
    assert near in str(problem)


def undescribed(text: str) -> str:
    return re.sub(r"^simulated = .*\n", "", text, flags=re.MULTILINE)


def test_a_heater_that_is_not_described_is_usual_for_its_kind(i3_text):
    text = undescribed(i3_text) + '\n[heaters.case]\nkind = "chamber"\npin = "D11"\n'
    heaters = config.load_text(text + 'sensor_pin = "T2"\nmax_c = 70.0\n').heaters
    rises = {name: heater.simulated.full_power_rise_c for name, heater in heaters.items()}
    assert rises == pytest.approx({"hotend": 380.0, "bed": 110.0, "case": 1.15 * 45.0})
    # A real heater of another power must not look broken.
    assert [limits_of(heater).deviation for heater in heaters.values()] == [0.0, 0.0, 0.0]
    assert limits_of(config.load_text(i3_text).heaters["hotend"]).deviation == 0.25
    asked = loaded(undescribed(i3_text), "protection = { deviation = 0.3 }\n")
    assert limits_of(asked.heaters["hotend"]).deviation == 0.3


def test_a_heater_that_has_only_a_model_heats_like_it(i3_text):
    model = (
        "model = { rise_c = 300.0, time_constant_s = 90.0, sensor_lag_s = 3.0, fan_loss = 0.1 }\n"
    )
    heater = loaded(undescribed(i3_text), model).heaters["hotend"]
    assert heater.simulated.model_dump() == {
        "full_power_rise_c": 300.0,
        "time_constant_s": 90.0,
        "sensor_time_constant_s": 3.0,
        "fan_loss": 0.1,
    }
    assert limits_of(heater).deviation == 0.25


@pytest.mark.parametrize(("heater", "max_power"), [("bed", 0.6), ("bed", 1.0), ("hotend", 0.4)])
def test_a_usual_heater_reaches_its_maximum_temperature(i3_text, tmp_path, heater, max_power):
    """The bed of a Voron has `max_power: 0.6`; some hotends print at 400 °C."""
    hottest = {"bed": 135.0, "hotend": 450.0}[heater]
    lines = f"max_power = {max_power}\nmax_c = {hottest}\n"
    old = {"bed": "max_c = 120.0\n", "hotend": HEAD}[heater]
    pt1000 = 'sensor = "PT1000"\n' if heater == "hotend" else ""
    machine = config.load_text(undescribed(i3_text).replace(old, lines + pt1000), "my.toml")
    rise_c = machine.heaters[heater].simulated.full_power_rise_c
    assert rise_c * max_power == pytest.approx(1.15 * (hottest - 25.0))
    path = tmp_path / "heat.gcode"
    code = {"bed": "M190", "hotend": "M109"}[heater]
    path.write_text(f"{code} S{hottest - 5.0}\n")
    assert 0.0 < Machine(machine).print(path).heat_time_s < 1800.0
