"""The tables of docs/explanation/heat.md hold what is in use."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from passo import config
from passo.config.sensor_tables import sensor_table, share_at
from passo.config.sensors import CONVERTERS, PlatinumConverter, Thermistor, UniversalConverter
from passo.heat.control import limits_of
from passo.heat.rules import RULES

PAGE = (Path(__file__).parents[2] / "docs" / "explanation" / "heat.md").read_text(encoding="utf-8")


def rows(heading: str) -> list[list[str]]:
    """The cells of the table that begins with this row."""
    _, *lines = PAGE.split(f"| {heading} |\n")[1].split("\n\n")[0].splitlines()
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]


def test_documented_tuning_rules_are_right():
    number = re.compile(r"[\d.]+")
    for row, rule in zip(rows("R | rule | Kp | Ki | Kd"), RULES, strict=True):
        assert row[:2] == [str(RULES.index(rule)), rule.name]
        factors = [float(number.match(cell)[0]) for cell in row[2:]]
        assert factors == pytest.approx([rule.p, rule.i, rule.d], rel=0.01)
        assert [number.sub("", cell).strip() for cell in row[2:]] == ["Ku", "Ku/Tu", "Ku·Tu"]


def test_documented_protection_defaults_are_right():
    heaters = config.load("i3").heaters
    limits = limits_of(heaters["hotend"])
    told = " ".join(row[2] for row in rows("fault | when | default"))
    found = re.findall(r"`(\w+)` ([\d.]+)", told)
    names = {"min_c", "jump_c", "watch_rise_c", "watch_s", "runaway_c", "runaway_s", "stuck_on_c"}
    assert {name for name, _ in found} == names | {"stuck_on_s", "deviation", "deviation_s"}
    assert [(name, getattr(limits, name)) for name, _ in found] == [
        (name, float(value)) for name, value in found
    ]
    assert f"{limits_of(heaters['bed']).watch_s:g} s for a bed" in told


def test_documented_sensors_and_defaults_are_right():
    table = {row[0]: row[2] for row in rows("kind | what it is | further keys")}
    assert {kind for kinds in table for kind in re.findall(r"`([\w-]+)`", kinds)} >= set(CONVERTERS)
    for model, kind in ((UniversalConverter, "max31856"), (PlatinumConverter, "max31865")):
        told = dict(re.findall(r"`(\w+)` \(`?(\w+)`?\)", table[f"`{kind}`"]))
        fields = model.model_fields.items()
        defaults = {key: field.default for key, field in fields if not field.is_required()}
        assert told == {key: str(value).removesuffix(".0") for key, value in defaults.items()}


def test_page_has_the_reading_of_a_wrong_pull_up():
    shown = share_at(sensor_table(Thermistor(pullup_ohm=4700.0)), 200.0)
    true_c = int(re.search(r"a hotend that shows 200 °C has (\d+) °C", PAGE)[1])
    assert share_at(sensor_table(Thermistor(pullup_ohm=1000.0)), true_c) == pytest.approx(
        shown, rel=0.01
    )
