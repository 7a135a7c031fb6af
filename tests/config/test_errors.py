"""Wrong machine files: every problem at once, each with line, key, value and what was expected."""

import re
from pathlib import Path

import pytest

from passo import config
from passo.errors import ConfigError, Problem

MANY_ERRORS = """\
name = "many"
uuid = "18f717cd-3177-5839-85a4-a9cc721823f1"
author = "nobody"
colour = "red"

[geometry]
kind = "cartesian"

[axes.x]
max_mm = 200
speed_mms = 300
speed_mm_s = 300
accel_mm_s2 = -3000

[axes.y]
min_mm = 10
max_mm = 5
speed_mm_s = "fast"
accel_mm_s2 = 3000

[axes.z]
max_mm = 200
speed_mm_s = 12

[steppers]
x = { steps_per_mm = 80, socket = "X", driver = "A4989" }
y = { steps_per_mm = 80, socket = "Y", rotation_distance_mm = 40 }
z = { steps_per_mm = 400, socket = "X" }

[[tools]]
extruder = "e"

[board]
base = "rampz"
"""


def problems_of(text: str) -> tuple[Problem, ...]:
    with pytest.raises(ConfigError) as caught:
        config.load_text(text, "many.toml")
    return caught.value.problems


def test_eleven_errors_are_reported_at_once_in_order() -> None:
    found = [(p.line, p.code, p.values["key"], p.values["value"]) for p in problems_of(MANY_ERRORS)]
    assert found == [
        (4, "config.unknown-key", "colour", "red"),
        (11, "config.unknown-key", "axes.x.speed_mms", 300),
        (13, "config.value", "axes.x.accel_mm_s2", -3000),
        (17, "config.value", "axes.y.max_mm", 5),
        (18, "config.value", "axes.y.speed_mm_s", "fast"),
        (21, "config.missing-key", "axes.z.accel_mm_s2", None),
        (26, "config.value", "steppers.x.driver", "A4989"),
        (27, "config.conflict", "steppers.y.rotation_distance_mm", 40),
        (28, "config.conflict", "steppers.z.socket", "X"),
        (31, "config.value", "tools[0].extruder", "e"),
        (34, "config.value", "board.base", "rampz"),
    ]


def test_a_problem_reads_as_a_sentence() -> None:
    sentences = {p.line: str(p) for p in problems_of(MANY_ERRORS)}
    assert sentences[11] == (
        "many.toml:11: axes.x.speed_mms is not a known key. Did you mean 'speed_mm_s'?"
    )
    assert sentences[13] == (
        "many.toml:13: axes.x.accel_mm_s2 is -3000: expected a number of at least 0.1. "
        "Correct the value."
    )
    assert sentences[18] == (
        "many.toml:18: axes.y.speed_mm_s is 'fast': expected a number. Correct the value."
    )
    assert sentences[21] == (
        "many.toml:21: axes.z.accel_mm_s2 is missing: expected a number. Add the key."
    )
    assert sentences[28] == (
        "many.toml:28: steppers.z.socket is 'X': expected a pin of its own: PF0 belongs to "
        "steppers.x.socket (many.toml:26). Change or remove it."
    )
    assert sentences[34].endswith("Did you mean 'ramps'?")


@pytest.mark.parametrize(
    ("old", "new", "key", "expected"),
    [
        ('"cartesian"', '"cartesain"', "geometry.kind", "Did you mean 'cartesian'?"),
        ('kind = "cartesian"', "", "geometry.kind", "is missing: expected one of"),
        ('kind = "cartesian"', 'kind = "cartesian"\nrods = [1]', "geometry.rods", "not a known"),
        ('"cartesian"', '"corexy"', "steppers.x.drives", "expected the name of an actuator"),
        ("[steppers.z]", "[steppers.q]", "steppers.q.drives", "Known here: e, x, y, z."),
        ("[steppers.z]", "[steppers.x1]", "steppers.z", "a motor that drives actuator z"),
        ('socket = "Z"', 'socket = "W"', "steppers.z.socket", "expected a socket of the board"),
        ('socket = "Z"', 'step_pin = "PA0"', "steppers.z.direction_pin", "a pin, or the key"),
        ('pin = "D9"', 'pin = "D10"', "fans.part.pin", "PB4 belongs to heaters.hotend.pin"),
        ('sensor_pin = "T1"', 'sensor_pin = "T0"', "heaters.bed.sensor_pin", "PK5 belongs to"),
        ('pin = "D9"', 'pin = "9"', "fans.part.pin", "expected a pin such as PB4"),
        ("max_c = 285.0", "max_c = 2", "heaters.hotend.max_c", "a temperature above min_c"),
        ("max_c = 285.0", "max_c = true", "heaters.hotend.max_c", "expected a number"),
        ("steps_per_mm = 400.0\n", "", "steppers.z.steps_per_mm", "or rotation_distance_mm"),
        ("steps_per_mm = 400.0", "steps_per_degree = 4", "steppers.z.steps_per_degree", "linear"),
        ("steps_per_mm = 400.0", "steps_per_mm = 400\nmin_deg = 1", "steppers.z.min_deg", "min_mm"),
        ("steps_per_mm = 400.0", "steps_per_mm = inf", "steppers.z.steps_per_mm", "a finite"),
        (
            "steps_per_mm = 400.0",
            "steps_per_mm = 400\nmax_rate_hz = 0.99",
            "steppers.z.max_rate_hz",
            "at least 1",
        ),
        ("jerk_mm_s = 0.4", "home_mm = 300", "axes.z.home_mm", "a position between 0 and 250"),
        ("[board]", "[park]\nposition_mm = [9, 999]\n[board]", "park.position_mm", "Y between"),
        ("[board]", "[park]\nretract_mm = 2e4\n[board]", "park.retract_mm", "at most 1000"),
        ('name = "i3"', 'name = "I 3"', "name", "a name of lower-case letters"),
        ('name = "i3"', "name = 3", "name", "expected a text in quotes"),
        ("[axes.z]", "[axes.q]", "axes.z", "expected a table with its limits"),
        ("[axes.z]", "[axes.q]", "axes.q", "an axis: x, y, z, a, b, c, u, v or w"),
        (
            "[limits]",
            "[limits]\nminimum_cruise_ratio = 1",
            "limits.minimum_cruise_ratio",
            "less than 1",
        ),
        ('junction = "deviation"', 'junction = "jrek"', "limits.junction", "Did you mean 'jerk'?"),
        ('base = "ramps"', 'base = "ramps"\nclock_hz = 1', "board.clock_hz", "at least 1000000"),
        ('base = "ramps"', 'base = "ramps"\nlink = "serial"', "board.port", "a serial device such"),
        ('base = "ramps"', 'base = "ramps"\nlink = "tcp"\nport = "a:x"', "board.port", "host:port"),
        ('base = "ramps"', 'base = "ramps"\nlink = "usb"', "board.link", "one of"),
        ("[fans.part]", "[fans.a]\npin = 'D4'\n[fans.part]", "fans.part.number", "fans.a"),
        ("[fans.part]", "[fans]\npart = 3\n[fans.b]", "fans.part", "expected a table"),
        ("[board]", "[laser]\npim = 'D4'\n[board]", "laser.pim", "Did you mean 'pin'?"),
        ("[board]", "[laser]\n[board]", "laser.pin", "expected a pin in quotes"),
        (
            "[board]",
            "[fans.b]\nnumber = 1\n[board]",
            "fans.b.pin",
            "expected a pin in quotes: the board's variant HFB has no output for fan1.",
        ),
        ("[board]", "[bed]\ncenter_mm = [1, 1]\n[board]", "bed.size_mm", "a list in brackets"),
        ('direction = "min"\n', "", "homing.x.direction", "is missing: expected one of min, max."),
        (
            "[geometry]",
            "[geometry]\nkind = true\n[q]",
            "geometry.kind",
            "is 'True': expected one of",
        ),
        ("[geometry]\n", "geometry = 3\n[q]\n", "geometry", "is 3: expected a table. "),
        ('pin = "^X_MIN"\n', "", "homing.x.pin", "is missing: expected either pin, or"),
        (
            '"^X_MIN"',
            '"^X_MIN"\nstepper_pins = { x = "D4" }',
            "homing.x.pin",
            "expected either pin",
        ),
        ('pin = "^X_MIN"', 'stepper_pins = { q = "D4" }', "homing.x.stepper_pins.q", "a motor of"),
        ("max_c = 285.0", "max_c = 1979-05-27", "heaters.hotend.max_c", "is 1979-05-27: expected"),
        (
            "max_c = 285.0",
            "max_c = [true, nan]",
            "heaters.hotend.max_c",
            "is [true, nan]: expected",
        ),
        (
            "[steppers.z]",
            "[steppers]\nz = 2\n[steppers.e9]",
            "steppers.z",
            "is 2: expected a table",
        ),
        ('"^Z_MIN"', '"^Z_MIN"\n[steppers]\nq = 2', "steppers.q", "expected a table"),
        (
            "max_c = 285.0",
            "control = 3\nmax_c = 285.0",
            "heaters.hotend.control",
            "is 3: expected a table",
        ),
        ('base = "ramps"', 'base = "ramps"\nvariant = []', "board.variant", "the board's variants"),
        ('socket = "X"', 'socket = "X"\npulse_us = 9e9', "steppers.x.pulse_us", "at most 30"),
        (
            'base = "ramps"',
            'base = "ramps"\nbudget = { cycles_per_step = 1e300 }',
            "board.budget.cycles_per_step",
            "at most 1000000",
        ),
        (
            'base = "ramps"',
            'base = "ramps"\nbudget = { command_share = 1e-300 }',
            "board.budget.command_share",
            "at least 0.001",
        ),
        (
            'base = "ramps"',
            'base = "ramps"\nconsole = { baud = 0.5 }',
            "board.console.baud",
            "a whole number",
        ),
        (
            'base = "ramps"',
            'base = "ramps"\nconsole = { baud = inf }',
            "board.console.baud",
            "a whole number",
        ),
        ('base = "ramps"', 'base = "ramps"\nclock_hz = nan', "board.clock_hz", "a whole number"),
        ("max_mm = 250.0", "max_mm = 0.0", "axes.x.max_mm", "more than min_mm, which is 0"),
    ],
)
def test_wrong_value_names_its_place(
    i3_text: str, old: str, new: str, key: str, expected: str
) -> None:
    assert old in i3_text
    found = [str(p) for p in problems_of(i3_text.replace(old, new, 1)) if p.values["key"] == key]
    assert len(found) == 1
    assert expected in found[0]


def test_no_pins_are_printed_for_an_unknown_board() -> None:
    text = config.shipped_text("delta")
    assert len(problems_of(re.sub('base = ".*"', 'base = "skr"', text))) == 1
    # The nearest one is taken for it: it has other pins.
    assert len(problems_of(re.sub('base = ".*"', 'base = "rampss"', text))) > 1


def test_five_further_axes_are_one_too_many(i3_text: str) -> None:
    axes = "".join(
        f"[axes.{name}]\nmax_mm = 1\nspeed_mm_s = 1\naccel_mm_s2 = 1\n" for name in "abcuv"
    )
    messages = [str(problem) for problem in problems_of(i3_text + axes)]
    assert any("axes is 'a, b, c, u, v': expected at most 4 axes" in text for text in messages)


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("name = \n", 1, "Invalid value"),
        ("name = 'x'\n[board\n", 2, "Expected ']'"),
        ("a = 1\na = 2\n", 2, "Cannot overwrite a value"),
        ("a = 1\nb = [1,\n2", 3, "Unclosed array"),
    ],
)
def test_syntax_errors_have_a_line(text: str, line: int, words: str) -> None:
    (problem,) = problems_of(text)
    assert (problem.code, problem.line) == ("config.syntax", line)
    assert words in str(problem)


def test_an_empty_file_lacks_every_table() -> None:
    missing = {problem.values["key"] for problem in problems_of("")}
    assert missing == {"name", "uuid", "author", "geometry", "axes", "steppers", "board"} | {
        f"axes.{name}" for name in "xyz"
    }


def test_binary_machine_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "binary.toml"
    path.write_bytes(b"name = '\xff'")
    with pytest.raises(ConfigError, match=r":1: is not UTF-8 text: byte 0xFF at column 9\. Save"):
        config.load(path)
    path.write_bytes('# café\nname = "J\xfcrgen"\n'.encode("latin-1"))
    with pytest.raises(ConfigError, match=r":1: is not UTF-8 text: byte 0xE9 at column 6\. Save"):
        config.load(path)


@pytest.mark.parametrize("code", ["utf-16", "utf-16-le", "utf-16-be"])
def test_utf_16_is_named(tmp_path: Path, code: str) -> None:
    path = tmp_path / "mine.toml"
    path.write_bytes(config.shipped_text("i3").encode(code))
    with pytest.raises(ConfigError, match=r"it is UTF-16\. Save the file as UTF-8"):
        config.load(path)


def test_byte_order_mark_of_a_machine_file_is_ignored(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_bytes(config.shipped_text("i3").encode("utf-8-sig"))
    assert config.load(path).name == "i3"


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ("name = “i3”", "the line has a left double quotation mark (U+201C)"),
        ("name\xa0= 'i3'", "the line has a no-break space (U+00A0)"),
        ("max_mm = 250,5 # mm", "250,5 has a decimal comma, write a point"),
    ],
)
def test_typographic_characters_are_named(line: str, sentence: str) -> None:
    with pytest.raises(ConfigError) as caught:
        config.load_text(f"uuid = 'x'\n{line}\n")
    (problem,) = caught.value.problems
    assert (problem.code, problem.line) == ("config.syntax", 2)
    assert problem.values["value"].endswith(sentence)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("x = " + 5000 * "[" + 5000 * "]", "many.toml: is not valid TOML: it is nested too deeply"),
        (f"[{3000 * 'a.'}a]", "many.toml: is not valid TOML: it is nested too deeply"),
        (f"x = {5000 * '9'}", "many.toml: is not valid TOML: an integer has too many digits"),
        (
            f"a = 1\nx = [0x{5000 * 'f'}]",
            "many.toml:2: x[0] is 'an integer of 20000 bits': "
            "expected an integer of at most 64 bits",
        ),
    ],
)
def test_text_beyond_parser_limits_is_one_sentence(text: str, sentence: str) -> None:
    (problem,) = problems_of(text)
    assert str(problem).startswith(f"{sentence}. ")
    assert problem.entry.status == 3


def test_a_byte_order_mark_is_not_part_of_the_text(tmp_path: Path, i3_text: str) -> None:
    path = tmp_path / "mark.toml"
    path.write_bytes(b"\xef\xbb\xbf" + i3_text.encode())
    assert config.load(path).name == "i3"


@pytest.mark.parametrize(
    ("new", "key", "limit"),
    [
        ("steps_per_mm = 1e8", "steps_per_mm", "a number of at most 100000"),
        ("steps_per_mm = 1e-300", "steps_per_mm", "a number of at least 0.001"),
        (
            "rotation_distance_mm = 1e-300",
            "rotation_distance_mm",
            "0.001 to 100,000 microsteps per mm or degree, and these parts make 3.2e+303",
        ),
        (
            "rotation_distance_mm = 1e12",
            "rotation_distance_mm",
            "0.001 to 100,000 microsteps per mm or degree, and these parts make 3.2e-09",
        ),
    ],
)
def test_impossible_scales_are_refused(i3_text: str, new: str, key: str, limit: str) -> None:
    text = i3_text.replace("steps_per_mm = 80.0", new, 1)
    (problem,) = problems_of(text)
    assert problem.values["key"] == f"steppers.x.{key}"
    assert problem.values["limit"] == limit


@pytest.mark.parametrize(
    ("key", "value", "limit"),
    [
        ("speed_mm_s", "1e300", "a number of at most 1000000"),
        ("accel_mm_s2", "1e300", "a number of at most 10000000"),
        ("speed_mm_s", "0.00099", "a number of at least 0.001"),
        ("accel_mm_s2", "1e-300", "a number of at least 0.1"),
        ("max_mm", "1e300", "a number of at most 1000000"),
        ("jerk_mm_s", "1e300", "a number of at most 1000000"),
    ],
)
def test_impossible_motion_limits_are_refused(
    i3_text: str, key: str, value: str, limit: str
) -> None:
    text = re.sub(rf"(?m)^{key} = .*\n", "", i3_text.partition("[axes.y]")[0])
    text += f"{key} = {value}\n[axes.y]{i3_text.partition('[axes.y]')[2]}"
    (problem,) = problems_of(text)
    assert problem.values["key"] == f"axes.x.{key}"
    assert problem.values["limit"] == limit


def test_an_unknown_table_gets_the_list_of_tables(i3_text):
    with pytest.raises(ConfigError) as error:
        config.load_text(f'{i3_text}\n[bltouch]\npin = "D11"\n')
    assert "Known tables: [accelerometer], [axes], [backlash], " in str(error.value)
    assert "[tools]." in str(error.value)
    assert "uuid" not in str(error.value)


def test_an_unknown_key_gets_the_list_of_its_table_however_long(i3_text):
    with pytest.raises(ConfigError) as error:
        config.load_text(i3_text.replace("[board]\n", "[board]\nqqq = 1\n"))
    assert "board.qqq is not a known key. Known here: base, baud, budget, " in str(error.value)


def test_heater_without_a_kind_is_one_error(i3_text):
    with pytest.raises(ConfigError) as error:
        config.load_text(f'{i3_text}\n[heaters.x]\npin = "D11"\nsensor_pin = "T2"\nmax_c = 90.0\n')
    (problem,) = error.value.problems
    assert "heaters.x.kind is missing: expected one of hotend, bed, chamber" in str(problem)
