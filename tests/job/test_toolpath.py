"""The path of a planned file, as viewers read it."""

import io
import json
from array import array

import pytest

from passo import config
from passo.job.batch.estimate import estimate_open

PROGRAM = b"""G28
G92 E0
;LAYER_CHANGE
;TYPE:Perimeter
G1 Z0.2 F600
G1 X100 Y50 F6000
G1 X150 Y50 E5 F1200
G1 E4 F1800
;LAYER_CHANGE
;TYPE:Infill
G1 Z0.4 F600
G1 X150 Y100 E10 F1200
"""


@pytest.fixture(scope="module")
def path():
    taken = []
    machine = config.load("i3")
    estimate = estimate_open(
        machine, io.BytesIO(PROGRAM), len(PROGRAM), "a.gcode", checked=False, take_path=taken.append
    )
    return estimate, *decoded(*taken)


def decoded(data):
    assert data[:8] == b"PASSOTP1"
    size = int.from_bytes(data[8:12], "little")
    header, at, columns = json.loads(data[12 : 12 + size]), 12 + size, {}
    assert at % 8 == 0
    for column in header["columns"]:
        values = array({"u1": "B", "u2": "H", "u4": "I", "f4": "f"}[column["type"]])
        end = at + values.itemsize * column["numbers"] * header["rows"]
        values.frombytes(data[at:end])
        columns[column["name"]], at = values, end
    assert at == len(data)
    return header, columns


def test_each_row_is_the_end_of_a_move(path):
    _, header, columns = path
    ends = []
    for row in range(header["rows"]):
        *at, kind = columns["at"][4 * row : 4 * row + 4]
        point = [o + header["unit_mm"] * v for o, v in zip(header["origin_mm"], at, strict=True)]
        ends.append((kind, columns["line"][row], *(round(p, 2) for p in point)))
    assert ends == [
        (0, 5, 0, 0, 0),
        (1, 5, 0, 0, 0.2),
        (1, 6, 100, 50, 0.2),
        (2, 7, 150, 50, 0.2),
        (1, 11, 150, 50, 0.4),
        (2, 12, 150, 100, 0.4),
    ]


def test_rows_have_speed_flow_feature_and_limit(path):
    _, header, columns = path
    unit = {column["name"]: column["unit"] for column in header["columns"]}
    names = [header["features"][i] for i in columns["feature"]]
    assert names[3:] == ["Perimeter", "Infill", "Infill"]
    assert columns["speed"][3] * unit["speed"] == pytest.approx(20)
    took_s = columns["time"][3] - columns["time"][2]
    assert columns["flow"][3] * unit["flow"] == pytest.approx(5 / took_s, abs=0.001)
    assert header["limits"][columns["speed_limit"][3]] == "feedrate"
    assert columns["acceleration"][3] > 0


def test_layers_are_ranges_of_rows_and_of_time(path):
    estimate, header, columns = path
    layers = header["layers"]
    assert [(layer["number"], layer["row"]) for layer in layers[-2:]] == [(1, 0), (2, 4)]
    assert [layer["z_mm"] for layer in layers[-2:]] == [0.2, 0.4]
    assert header["end_s"] == pytest.approx(estimate.moving_s, abs=1e-6)
    assert columns["time"][-1] == pytest.approx(header["end_s"], abs=1e-4)


def test_targets_of_heaters_have_the_time_of_the_plan():
    program = b"G28\nM104 S200\nG1 X100 F6000\nM104 S210\nG1 X150 F6000\n"
    taken = []
    estimate_open(
        config.load("i3"),
        io.BytesIO(program),
        len(program),
        "a.gcode",
        checked=False,
        take_path=taken.append,
    )
    header, columns = decoded(*taken)
    first, second = header["targets"]
    assert (first["heater"], first["celsius"], second["celsius"]) == ("hotend", 200, 210)
    assert first["time_s"] < second["time_s"]
    assert second["time_s"] == pytest.approx(columns["time"][-2], abs=0.01)
