"""`passo config explain` and `passo schema`."""

import json
import tomllib
from pathlib import Path

import jsonschema_rs
import pytest

from passo import config
from passo.cli.main import main


def test_explain_names_value_unit_range_and_the_line_that_sets_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(config.shipped_text("i3"), encoding="utf-8")
    assert main(["config", "explain", "axes.x.speed_mm_s", "--machine", str(path)]) == 0
    assert capsys.readouterr().out == (
        "axes.x.speed_mm_s = 300.0\n"
        "  The maximum speed.\n"
        "  Unit: mm/s. Range: 0.001 to 1000000. Default: required.\n"
        f"  Set in {path}:13.\n"
        "  M203 X changes it on a running printer, and M500 stores that.\n"
    )


@pytest.mark.parametrize(
    ("key", "value", "source"),
    [
        ("board.sockets.X.step", ' = "PF0"', "Set in boards/ramps.toml:29."),
        ("homing.x.slow", " = 4.0", "Not in a file: the default."),
        ("homing.x.max_travel", "", "Not set."),
        ("tools[0].offset_mm", "", "Not set."),
        ("probe.samples", "", "Not set."),
    ],
)
def test_explain_names_the_source_of_a_value(
    key: str, value: str, source: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["config", "explain", key]) == 0
    first, *_, last = capsys.readouterr().out.splitlines()
    assert first == f"{key}{value}"
    assert last.strip() == source


def test_explain_of_a_table_has_each_of_its_keys(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["config", "explain", "axes"]) == 0
    heads = [part.split()[0] for part in capsys.readouterr().out.split("\n\n")]
    assert {"axes.x.min_mm", "axes.x.max_mm", "axes.z.jerk_mm_s"} <= set(heads)
    assert {head[:7] for head in heads} == {"axes.x.", "axes.y.", "axes.z."}


@pytest.mark.parametrize(
    ("key", "hint"), [("axis.x", "Did you mean 'axes'?"), ("axes.q.min_mm", "Known here: x, y, z.")]
)
def test_explain_of_unknown_key_names_a_similar_key(
    key: str, hint: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["config", "explain", key]) == 3
    assert f"{key} is not a known key. {hint}" in capsys.readouterr().err


def test_explain_shows_no_secret(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(config.shipped_text("i3"), encoding="utf-8")
    assert main(["config", "explain", "uuid", "--machine", str(path)]) == 0
    out = capsys.readouterr().out
    assert out.startswith('uuid = "(not shown)"\n')
    assert config.load("i3").uuid not in out


@pytest.fixture(scope="module")
def validator() -> jsonschema_rs.Draft202012Validator:
    from passo.config.machine_schema import schema

    return jsonschema_rs.Draft202012Validator(schema())


def test_schema_is_valid_and_is_what_the_command_prints(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["schema"]) == 0
    printed = json.loads(capsys.readouterr().out)
    jsonschema_rs.meta.validate(printed)
    assert printed["$defs"]["Axis"]["properties"]["speed_mm_s"]["x-unit"] == "mm/s"


@pytest.mark.parametrize("name", config.shipped_machines())
def test_schema_accepts_each_shipped_machine(
    name: str, validator: jsonschema_rs.Draft202012Validator
) -> None:
    assert list(validator.iter_errors(tomllib.loads(config.shipped_text(name)))) == []


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("speed_mm_s = 300.0", "spede_mm_s = 300.0", "'spede_mm_s' was unexpected"),
        ("max_c = 285.0", 'max_c = "hot"', 'is not of type "number"'),
        ('base = "ramps"', "", '"mcu" is a required property'),
        ('fan = "part"', 'sensor = { kind = "Marlin 1" }', ""),
        ('fan = "part"', "sensor = 5", ""),
    ],
)
def test_schema_refuses_what_the_loader_refuses(
    old: str, new: str, message: str, validator: jsonschema_rs.Draft202012Validator
) -> None:
    machine = tomllib.loads(config.shipped_text("i3").replace(old, new))
    errors = [error.message for error in validator.iter_errors(machine)]
    assert any(message in error for error in errors) if message else errors == []
