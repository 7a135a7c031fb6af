"""`passo steps`, `passo explain`, `passo report`: files that other programs read."""

from __future__ import annotations

import json

import numpy as np
import pytest
import vcd.reader

from passo import config
from passo.cli.main import main

SHORT = "G28\nM106 S255\nG1 X10 Y5 Z1 E1 F3000\nG1 X0 Y0\nG2 X4 Y0 I2 J0\n"


@pytest.fixture
def short(tmp_path):
    path = tmp_path / "short.gcode"
    path.write_text(SHORT)
    return str(path)


@pytest.mark.parametrize("machine", ["i3", "corexy", "big-fish-i3"])
def test_npz_within_the_bound(short, tmp_path, machine):
    output = tmp_path / "steps.npz"
    assert main(["steps", short, "--output", str(output), "--ideal", "--machine", machine]) == 0
    data = np.load(output)
    hz = float(data["clock_hz"])
    assert (data["clock_hz"].shape, hz) == ((), 16e6)
    for name in {key.rpartition("_")[0] for key in data if key.endswith("_ticks")}:
        ticks, ideal = data[f"{name}_ticks"], data[f"{name}_ideal_s"] * hz
        assert ticks.dtype == np.int64
        assert data[f"{name}_dir"].dtype == np.int8
        gaps = np.diff(ideal, prepend=-1e12, append=1e12)
        bound = np.minimum(32, np.minimum(gaps[:-1], gaps[1:]) / 4) + 0.5
        assert len(ticks) > 0
        assert (np.abs(ticks - ideal) <= bound + 1e-2).all()
        assert (np.diff(ticks) > 0).all()


def test_a_cut_of_time(short, tmp_path):
    whole, part = tmp_path / "whole.npz", tmp_path / "part.npz"
    assert main(["steps", short, "--output", str(whole), "--ideal"]) == 0
    words = ["--from", "0.1", "--to", "0.2", "--ideal"]
    assert main(["steps", short, "--output", str(part), *words]) == 0
    a, b = np.load(whole), np.load(part)
    for name in "xyz":
        ticks = a[f"{name}_ticks"]
        inside = (ticks >= 1_600_000) & (ticks < 3_200_000)
        assert (b[f"{name}_ticks"] == ticks[inside]).all()
        assert (b[f"{name}_ideal_s"] == a[f"{name}_ideal_s"][inside]).all()


@pytest.mark.parametrize("end", ["1", "5"])
def test_a_cut_that_ends_before_it_begins_is_usage(short, tmp_path, capsys, end):
    output = tmp_path / "steps.npz"
    assert main(["steps", short, "--output", str(output), "--from", "5", "--to", end]) == 2
    assert capsys.readouterr() == ("", f"--to {end}: it must be later than --from 5.\n")
    assert not output.exists()


def test_ideal_times_have_no_place_in_a_vcd(short, tmp_path, capsys):
    output = tmp_path / "steps.vcd"
    assert main(["steps", short, "--output", str(output), "--ideal"]) == 2
    assert capsys.readouterr() == ("", f"--ideal: {output} has no place for it, name an .npz.\n")
    assert not output.exists()


def test_vcd_has_the_same_edges(short, tmp_path):
    waves, arrays = tmp_path / "steps.vcd", tmp_path / "steps.npz"
    assert main(["steps", short, "--output", str(waves)]) == 0
    assert main(["steps", short, "--output", str(arrays)]) == 0
    names, rises = {}, {}
    now = 0
    with waves.open("rb") as source:
        for token in vcd.reader.tokenize(source):
            kind = token.kind.name
            if kind == "VAR":
                names[token.var.id_code] = token.var.reference
            elif kind == "CHANGE_TIME":
                now = token.time_change
            elif kind == "CHANGE_SCALAR" and token.scalar_change.value == "1":
                rises.setdefault(names[token.scalar_change.id_code], []).append(now)
    data = np.load(arrays)
    for name in "xyze":
        assert rises[f"{name}_step"] == [int(t) * 625 for t in data[f"{name}_ticks"]]


def test_nothing_half_written(short, tmp_path):
    assert main(["steps", short, "--output", str(tmp_path / "no" / "x.npz")]) == 4
    assert main(["steps", short, "--output", str(tmp_path / "x.txt")]) == 2
    assert sorted(p.name for p in tmp_path.iterdir()) == ["short.gcode"]


def test_explain(short, capsys):
    assert main(["explain", f"{short}:4"]) == 0
    out = capsys.readouterr().out
    assert ":4: G1 X0 Y0" in out
    assert "Planned: a travel move of 11.180 mm" in out
    assert "starts at 1.02 mm/s, reaches 50.00 (at most 50.00), ends at 7.71" in out
    assert "speed is bound by: feedrate; acceleration 3000 mm/s²" in out
    assert "  x: 800, the first at" in out
    assert "queue_step oid=0 interval=" in out


def test_explain_of_lines_without_a_move(short, capsys):
    assert main(["explain", f"{short}:2"]) == 0
    assert "M106: Sets a fan's speed." in capsys.readouterr().out
    assert main(["explain", f"{short}:99"]) == 4
    assert "there is no line 99: the file has 5" in capsys.readouterr().err


def test_report_is_one_page(short, tmp_path):
    page = tmp_path / "r.html"
    assert main(["report", short, "--output", str(page)]) == 0
    text = page.read_text(encoding="utf-8")
    assert "short.gcode on i3" in text
    assert "http" not in text
    assert '"steps' not in text.partition("const data")[0]


@pytest.mark.parametrize(
    "machine", ["i3", "corexy", "delta", "rotary-delta", "scara", "dual-extruder"]
)
def test_report_shows_the_step_rate_of_every_motor(tmp_path, machine):
    model = config.load(machine)
    x, y = ((model.axes[a].min_mm + model.axes[a].max_mm) / 2 for a in "xy")
    program = f"""G28
G1 X{x} Y{y + 25} Z20 F2400
G1 X{x + 30} Y{y + 38} E2
G1 X{x - 20} Y{y + 45} Z22 E4
G1 E-20
"""
    if machine == "dual-extruder":
        program += f"T1\nG92 E0\nG1 X{x} Y{y} E30\n"
    path, page, steps = (tmp_path / name for name in ("a.gcode", "a.html", "a.npz"))
    path.write_text(program)
    assert main(["report", str(path), "--machine", machine, "--output", str(page)]) == 0
    words = ["--machine", machine, "--ideal", "--output", str(steps)]
    assert main(["steps", str(path), *words]) == 0
    text = page.read_text(encoding="utf-8").partition("const data = ")[2]
    rates = json.JSONDecoder().raw_decode(text)[0]["rates"]
    executed = np.load(steps)
    assert set(rates) == {k.removesuffix("_ideal_s") for k in executed if k.endswith("_ideal_s")}
    for name, shown in rates.items():
        times, ways = executed[f"{name}_ideal_s"], executed[f"{name}_dir"]
        same = ways[5:] == ways[:-5]  # five steps on, in one direction
        assert max(shown) == pytest.approx(np.max(5 / (times[5:] - times[:-5])[same]), rel=0.02)
