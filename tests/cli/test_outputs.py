"""`passo steps`, `passo explain`: files that other programs read."""

from __future__ import annotations

import os
import random
import re
import signal
import subprocess
import sys
from array import array
from fractions import Fraction
from functools import partial
from pathlib import Path

import numpy as np
import pytest
import vcd.reader

from passo.cli.main import main
from passo.config.load import shipped_text
from passo.job.batch.simulated_print import Print
from passo.job.batch.vcd import write_vcd

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


def test_steps_prints_the_warnings_of_print(capsys, tmp_path):
    path = tmp_path / "a.gcode"
    path.write_text("G28\nM999999\nG1 X5 F3000\nM0\nG1 X6\n")
    assert main(["print", str(path), "--assume-ready"]) == 0
    warnings = capsys.readouterr().err.splitlines()
    assert len(warnings) == 2
    assert main(["steps", str(path), "--output", str(tmp_path / "a.npz")]) == 0
    written = f"{tmp_path / 'a.npz'}: steps x 480, y 0, z 0, e 0"
    assert capsys.readouterr().err.splitlines() == [*warnings, written]


@pytest.mark.parametrize("time", ["-1", "nan", "inf", "1e9", "", "5s", "-0.001"])
def test_wrong_times_are_named(capsys, short, tmp_path, time):
    output = tmp_path / "a.npz"
    assert main(["steps", short, "--output", str(output), f"--from={time}"]) == 2
    assert f"argument --from: {time!r} is not a time in seconds" in capsys.readouterr().err
    assert not output.exists()


def test_steps_around_a_stop_are_within_the_bound(tmp_path):
    """A target between two steps: the last step is due as the motor stops, and the next one, back,
    as it starts."""
    rng = random.Random(3)
    path, output = tmp_path / "stops.gcode", tmp_path / "steps.npz"
    moves = [f"G1 X{5 + rng.randrange(800) * 0.0125 + 0.00625:.5f} F3000" for _ in range(200)]
    path.write_text("G28\n" + "\nM400\n".join(moves) + "\n")
    assert main(["steps", str(path), "--output", str(output), "--ideal"]) == 0
    data = np.load(output)
    ticks, ideal = data["x_ticks"], data["x_ideal_s"] * float(data["clock_hz"])
    gaps = np.diff(ideal, prepend=-1e12, append=1e12)
    bound = np.minimum(32, np.minimum(gaps[:-1], gaps[1:]) / 4) + 0.5
    assert len(ticks) > 10_000
    assert np.max(np.abs(ticks - ideal) - bound) <= 1e-2
    turns = data["x_dir"][1:] != data["x_dir"][:-1]
    assert np.min(np.diff(ticks)[turns]) >= 32  # A4988: 1 us pulse, and 0.2 us about the direction


def test_time_range_limits_the_steps_output(short, tmp_path):
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
def test_reversed_time_range_is_a_usage_error(short, tmp_path, capsys, end):
    output = tmp_path / "steps.npz"
    assert main(["steps", short, "--output", str(output), "--from", "5", "--to", end]) == 2
    assert capsys.readouterr() == ("", f"--to {end}: it must be later than --from 5.\n")
    assert not output.exists()


def test_ideal_times_are_refused_for_vcd(short, tmp_path, capsys):
    output = tmp_path / "steps.vcd"
    assert main(["steps", short, "--output", str(output), "--ideal"]) == 2
    assert capsys.readouterr() == ("", f"--ideal: {output} has no place for it, name an .npz.\n")
    assert not output.exists()


def test_vcd_has_the_same_edges(short, tmp_path):
    waves, arrays = tmp_path / "steps.vcd", tmp_path / "steps.npz"
    assert main(["steps", short, "--output", str(waves)]) == 0
    assert main(["steps", short, "--output", str(arrays)]) == 0
    names, levels, begun, edges = {}, {}, [], {}
    times = []
    with waves.open("rb") as source:
        for token in vcd.reader.tokenize(source):
            kind = token.kind.name
            if kind == "VAR":
                names[token.var.id_code] = token.var.reference
            elif kind == "CHANGE_TIME":
                times.append(token.time_change)
            elif kind == "CHANGE_SCALAR":
                name, value = names[token.scalar_change.id_code], token.scalar_change.value
                levels[name] = value
                if times == [0] and len(begun) < len(names):
                    begun.append((name, value))
                    continue
                # At each edge of a step: which one, when, and which way the motor turns.
                motor, _, wire = name.rpartition("_")
                if wire == "step":
                    edges.setdefault(motor, []).append((value, times[-1], levels[f"{motor}_dir"]))
    assert begun == [(name, "0") for name in names.values()]
    assert times == sorted(set(times))
    data = np.load(arrays)
    for name in "xyze":
        rises = [int(t) * 625 for t in data[f"{name}_ticks"]]
        ways = ["1" if way > 0 else "0" for way in data[f"{name}_dir"]]
        assert edges[name][::2] == list(zip("1" * len(rises), rises, ways, strict=True))
        falls = [(value, time) for value, time, _ in edges[name][1::2]]
        assert falls == [("0", time + 16 * 625) for time in rises]  # 1 µs


@pytest.mark.parametrize(
    ("clock_hz", "number", "unit"),
    [
        (1_000_000, 100, "ns"),
        (16_000_000, 100, "ps"),
        (20_000_000, 10, "ns"),
        (72_000_000, 1, "ps"),
    ],
)
def test_times_of_a_vcd_are_right_to_half_a_unit_after_hours(tmp_path, clock_hz, number, unit):
    ticks = array("q", [10, 12_345 * clock_hz + 7, 360_000 * clock_hz + 1])
    path = tmp_path / "steps.vcd"
    write_vcd(path, clock_hz, {"x": (ticks, array("b", [1, 1, 1]), 1)})
    lines = path.read_text().splitlines()
    assert lines[0] == f"$timescale {number} {unit} $end"
    units_s = Fraction(number, {"ns": 10**9, "ps": 10**12}[unit])
    rises = [int(lines[i - 1][1:]) for i, line in enumerate(lines) if line == '1"']
    wrong = [r - Fraction(tick, clock_hz) / units_s for r, tick in zip(rises, ticks, strict=True)]
    assert len(wrong) == 3
    assert max(map(abs, wrong)) <= (0.5 if clock_hz == 72_000_000 else 0)


def test_failed_steps_output_leaves_no_partial_file(short, tmp_path):
    assert main(["steps", short, "--output", str(tmp_path / "no" / "x.npz")]) == 4
    assert main(["steps", short, "--output", str(tmp_path / "x.txt")]) == 2
    assert sorted(p.name for p in tmp_path.iterdir()) == ["short.gcode"]


def test_explain_shows_moves_and_steps_of_a_line(short, capsys):
    assert main(["explain", f"{short}:4"]) == 0
    out = capsys.readouterr().out
    assert ":4: G1 X0 Y0" in out
    assert "Planned: a travel move of 11.180 mm" in out
    assert "starts at 1.02 mm/s, reaches 50.00 (at most 50.00), ends at 7.71" in out
    # v² = u² + 2 a s, on both ramps
    assert "speeds up over 0.416 mm in 16.33 ms, cruises 10.357 mm in 207.14 ms, slows" in out
    assert "slows down over 0.407 mm in 14.10 ms" in out
    assert "speed is bound by: feedrate; acceleration 3000 mm/s²" in out
    assert "  x: 800, the first at" in out
    assert "queue_step oid=0 interval=" in out


def test_explain_of_lines_without_a_move(short, capsys):
    assert main(["explain", f"{short}:2"]) == 0
    assert "M106: Sets the speed of fan P" in capsys.readouterr().out
    assert main(["explain", f"{short}:99"]) == 4
    assert "there is no line 99: the file has 5" in capsys.readouterr().err


def test_explain_needs_a_file_that_it_can_read_again(capsys):
    read, write = os.pipe()
    os.write(write, b"G28\nG1 X10\n")
    os.close(write)
    assert main(["explain", f"/dev/fd/{read}:2"]) == 4
    os.close(read)
    out, err = capsys.readouterr()
    assert out == ""
    assert err == f"/dev/fd/{read}: can be read only once. Save it to a file first.\n"


def explained(capsys, path, line, *words):
    assert main(["explain", f"{path}:{line}", *words]) == 0
    return capsys.readouterr().out


LINES = {
    "T0": ["T0: Selects a tool."],
    "G777": ["G777: unknown here, skipped."],
    "G80": ["G80: Ends a canned cycle."],
    "G81 X2 Z1 R2 F60": ["G81: Drills: travels to X Y", "  X2", "  Z1", "  R2", "  F60"],
    "N2 G1 X5 F600*55": [
        "The line has the number 2, which is skipped; its checksum is right.",
        "G1: Moves in a straight line",
        "  X5",
        "  F600",
    ],
    "N4 M104 S100*96": [
        "The line has the number 4, which is skipped; its checksum is right.",
        "M104: Sets the temperature of a hotend",
        "  S100",
    ],
    "(first X3) G1 X20": ["G1: Moves in a straight line", "  X20"],
    "(only X3) ; G1": ["There is no command on this line."],
    "SET_VELOCITY_LIMIT ACCEL=500": ["SET_VELOCITY_LIMIT: Sets limits of speed", "  ACCEL=500"],
    "PRINT_START BED=60": ["PRINT_START: unknown here, skipped.", "  BED=60"],
    "foo": ["FOO: unknown here, skipped."],
    "G91 G1 X5 F600 M106 S3": [
        "G91: Makes positions relative",
        "G1: Moves in a straight line",
        "  X5",
        "  F600",
        "M106: Sets the speed of fan P",
        "  S3",
    ],
    "G90 X3": ["G90: Makes positions absolute.", "A move of the same kind as the last one", "  X3"],
    "Y2 (x) X1": ["A move of the same kind as the last one", "  Y2", "  X1"],
    "S20 M3": ["M3: Switches the laser or spindle on.", "  S20"],
    "M117 hello X3": ["M117: Sends a message", "  hello X3"],
    "M862.3 P": ["M862.3: The command checks", "  P"],
    "G1 X2 T1.5 M400 G4 P5": [
        "G1: Moves in a straight line",
        "  X2",
        "  T1.5",
        "M400: Waits",
        "G4: Waits",
        "  P5",
    ],
}


@pytest.mark.parametrize("line", LINES)
def test_explain_shows_the_commands_of_a_line(capsys, tmp_path, line):
    path = tmp_path / "a.gcode"
    path.write_text(f"G28\n{line}\n")
    rows = explained(capsys, path, 2).split("\n\n")[1].splitlines()
    assert len(rows) == len(LINES[line])
    for row, begins in zip(rows, LINES[line], strict=True):
        assert row == begins if begins.startswith("  ") else row.startswith(begins)


CORNERS = """G28
G91
G1 X5 F600
G1 X5 E1
M400
G1 X5
G4 P100
G1 Y5
G1 E2
G1 E2
G1 E-2
G1 X5 F6000
G1 X5 F600
G1 Y5 F6000
G1 X-0.02 Y0.1
G1 Y20
M400
G1 X0.05
G1 X20
"""
LAW = "junction deviation: v"


@pytest.mark.parametrize(
    ("line", "before", "after"),
    [
        (3, "there is no move before it", "the extruder, or a further axis, whose speed may jump"),
        (4, "turns by 0.0°, at most 5.00 mm/s", "stops there: a command between the moves waits"),
        (6, "stops there: a command between the moves waits", "because it waits."),
        (8, "because it waits.", "one of the moves has no X, Y or Z; the machine stops there."),
        (10, "bound by the slower of the two moves", "for the extruder turns back"),
        (13, "bound by the slower of the two moves; the corner itself does not", "turns by 90.0°"),
        (15, "the path turns by 11.3°, at most 39.30 mm/s", LAW),
        (19, "at 17.32 mm/s: what comes before or after it allows no more", "is no move after it."),
    ],
)
def test_explain_shows_what_limits_a_corner(capsys, tmp_path, line, before, after):
    path = tmp_path / "a.gcode"
    path.write_text(CORNERS)
    corners = [
        part for part in explained(capsys, path, line).split("\n\n") if part.startswith("Junction ")
    ]
    assert before in corners[0]
    assert after in corners[1]
    assert [LAW in corner for corner in corners] == [line == 15] * 2


@pytest.mark.parametrize("bad", ["G1 X300", "M112", "M104 S"])
def test_explain_ignores_errors_after_the_line(capsys, tmp_path, bad):
    path = tmp_path / "a.gcode"
    path.write_text(f"G28\nG1 X5 F600\n{bad}\nG1 X7\n")
    assert "a travel move of 5.000 mm" in explained(capsys, path, 2)
    for line in (3, 4):
        assert main(["explain", f"{path}:{line}"]) in (4, 5)
        assert f"{path}:3: " in capsys.readouterr().err


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_explain_counts_lines_as_the_print_does(capsys, tmp_path, end):
    path = tmp_path / "p.gcode"
    path.write_bytes(end.join(["G28", "G1 X5 F600", "G1 X9", "G1 X999", ""]).encode())
    text = explained(capsys, path, 2)
    assert text.startswith(f"{path}:2: G1 X5 F600\n")
    assert "from X 0.000, Y 0.000, Z 0.000, E 0.000 to X 5.000" in text
    assert "Junction after: the path turns by 0.0°" in text  # line 4 is left out, not line 3


@pytest.mark.parametrize(
    ("command", "output", "what"),
    [
        ("report", "in.vcd", "G-code"),
        ("steps", "in.vcd", "G-code"),
        ("steps", "./link.vcd", "G-code"),
        ("report", "m.toml", "machine file"),
        ("steps", "m.npz", "machine file"),
    ],
)
def test_an_output_never_replaces_what_is_read(
    short, tmp_path, capsys, monkeypatch, command, output, what
):
    monkeypatch.chdir(tmp_path)
    Path(short).rename("in.vcd")
    Path("link.vcd").symlink_to("in.vcd")
    Path("m.toml").write_text(shipped_text("i3"))
    Path("m.npz").symlink_to("m.toml")
    texts = [Path(name).read_bytes() for name in ("in.vcd", "m.toml")]
    assert main([command, "in.vcd", "--machine", "./m.toml", "--output", output]) == 2
    assert capsys.readouterr().err == f"{output}: it is the {what} itself, name another.\n"
    assert [Path(name).read_bytes() for name in ("in.vcd", "m.toml")] == texts
    assert main([command, "in.vcd", "--machine", "./m.toml", "--output", "out.vcd"]) == 0


@pytest.mark.parametrize("output", [".", "/", os.devnull, "folder.npz"])
def test_only_regular_files_are_replaced(short, tmp_path, monkeypatch, capsys, output):
    """Whoever may write to /dev would lose a device otherwise."""
    monkeypatch.chdir(tmp_path)
    Path("folder.npz").mkdir()
    if output.endswith(".npz"):
        assert main(["steps", short, "--output", output]) == 4
    else:
        assert main(["report", short, "--output", output]) == 4
    told = f"{output}: cannot be written: it is no regular file."
    assert capsys.readouterr().err.startswith(told)
    assert Path(os.devnull).is_char_device()
    assert {p.name for p in tmp_path.iterdir()} == {"short.gcode", "folder.npz"}


def test_symbolic_link_stays_and_leads_to_the_new_file(short, tmp_path):
    folder, link = tmp_path / "folder", tmp_path / "link.npz"
    folder.mkdir()
    link.symlink_to("folder/steps.npz")
    for _ in range(2):
        assert main(["steps", short, "--output", str(link)]) == 0
        assert link.is_symlink()
        assert [p.name for p in folder.iterdir()] == ["steps.npz"]
        assert "x_ticks" in np.load(link)
        folder.joinpath("steps.npz").write_text("old")


@pytest.mark.parametrize("sign", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_no_partial_file_stays(short, tmp_path, sign):
    program = f"""
import os, signal, sys
from passo.cli.main import main
from passo.job.batch import vcd
edges = vcd._edges
def stopped(*motor):
    assert any(name.endswith(".part") for name in os.listdir({str(tmp_path)!r}))
    os.kill(os.getpid(), {int(sign)})
    return edges(*motor)
vcd._edges = stopped
sys.argv = ["passo", "steps", {short!r}, "--output", {str(tmp_path / "o.vcd")!r}]
sys.exit(main())
"""
    done = subprocess.run(
        [sys.executable, "-c", program],
        capture_output=True,
        text=True,
        preexec_fn=partial(signal.signal, sign, signal.SIG_DFL),  # not as whoever runs the tests
    )
    assert (done.returncode, done.stderr) == (130, "Interrupted.\n")
    assert [p.name for p in tmp_path.iterdir()] == ["short.gcode"]


def test_a_time_that_is_not_a_number_is_reported(short, capsys):
    assert main(["steps", short, "--output", "o.npz", "--from", "soon"]) == 2
    assert "'soon' is not a time in seconds" in capsys.readouterr().err


@pytest.mark.parametrize("line", [4, 5, 30_002])
def test_explain_takes_no_longer_than_its_line(capsys, tmp_path, monkeypatch, line):
    """Neither what comes behind it is printed, nor what came before it is kept."""
    path, prints, kept = tmp_path / "a.gcode", [], []

    class Watched(Print):
        def __init__(self, *words):
            super().__init__(*words)
            prints.append(self)
            take = self.board.take_commands
            self.board.take_commands = lambda name: kept.append(take(name)) or kept[-1]

    monkeypatch.setattr("passo.learn.explain.Print", Watched)
    moves = "".join(f"G1 X{5 + i % 3} Y{i % 200}\n" for i in range(40_000))
    path.write_text(f"G28\nG1 F6000\n{moves}G29\n")
    assert "  x: 80, the first at" in explained(capsys, path, line)
    (job,) = prints
    read = job.job.results.statistics()["lines"]
    assert line < read < line + 20_000
    assert max(len(commands) for commands in kept) < 60_000  # of 200_000


def test_explain_shows_what_each_board_gets(capsys, tmp_path):
    """A further board has another clock, and its own numbers for its motors."""
    machine, path, output = (tmp_path / name for name in ("m.toml", "a.gcode", "a.npz"))
    tool = '[boards.tool]\nbase = "radds"\ndrift_ppm = 40.0\nstart_s = 3.0\n'
    machine.write_text(shipped_text("i3").replace('socket = "E0"', 'socket = "tool:E1"') + tool)
    path.write_text("G28\nG1 X10 F3000\nG1 X40 E4\nG1 X50\n")
    told = explained(capsys, path, 3, "--machine", str(machine))
    words = ["--machine", str(machine), "--output", str(output)]
    assert main(["steps", str(path), *words]) == 0
    executed = np.load(output)["e_ticks"] / 16e6
    first, last = re.search(r"e: 382, the first at (.+) s, the last at (.+) s", told).groups()
    assert (float(first), float(last)) == pytest.approx((executed[0], executed[-1]), abs=1e-6)
    assert "a tick is 62.5 ns, 23.8 ns on tool." in told
    rows = re.findall(r"tool: e: queue_step oid=(\d+) interval=(\d+) count=(\d+)", told)
    assert {oid for oid, *_ in rows} == {"0"}
    assert rows[0][2] == "1"
    interval = (executed[1] - executed[0]) * 42e6 * (1 + 40e-6)
    assert int(rows[1][1]) == pytest.approx(interval, abs=4)


def test_explain_shows_no_commands_of_a_firmware_that_runs(capsys, tmp_path):
    """Its pins tell only of steps, which are none of its commands."""
    machine, path = tmp_path / "m.toml", tmp_path / "a.gcode"
    machine.write_text(shipped_text("i3").replace("[board]", '[board]\nfirmware = "passo"'))
    path.write_text("G28\nG1 X10 F3000\n")
    told = explained(capsys, path, 2, "--machine", str(machine))
    assert re.search(r"x: 800, the first at \S+ s, the last at \S+ s", told)
    assert "queue_step" not in told
    assert 'with firmware = "virtual" they are.' in told


def test_explain_measures_in_steps_where_the_law_does(capsys, tmp_path):
    machine, path = tmp_path / "m.toml", tmp_path / "a.gcode"
    law = 'junction = "cornering_distance"'
    machine.write_text(shipped_text("i3").replace('junction = "deviation"', law))
    path.write_text("G28\nG1 X10 F6000\nG1 Y10 E1\n")
    told = explained(capsys, path, 3, "--machine", str(machine))
    assert "a print move of 800.000 steps, from" in told
    assert "reaches 8000.00 (at most 8000.00)" in told
    assert "taken at 3098.39 steps/s" in told  # the root of 3000·80·40
    assert " mm/s" not in told


PLAIN = {"ascii": {"PYTHONIOENCODING": "ascii"}, "C": {"LC_ALL": "C", "PYTHONUTF8": "0"}}


@pytest.mark.parametrize("plain", PLAIN)
def test_characters_unknown_to_terminal_are_replaced(short, plain):
    environment = os.environ | {"PYTHONCOERCECLOCALE": "0"} | PLAIN[plain]
    command = [sys.executable, "-m", "passo", "explain", f"{short}:3"]
    run = subprocess.run(command, capture_output=True, env=environment)
    assert (run.returncode, run.stderr) == (0, b"")
    assert b"mm/s\\xb2" in run.stdout


def test_undecodable_file_names_are_shown_readably(tmp_path):
    path = tmp_path / os.fsdecode(b"caf\xc3\xa9 \xff.g")
    path.write_text("G28\nG1 X1 F600\n")
    page = tmp_path / "page.html"
    for words in (["estimate", path], ["report", path, "--output", page]):
        run = subprocess.run([sys.executable, "-m", "passo", *words], capture_output=True)
        assert run.returncode == 0
        if words[0] == "estimate":
            assert "café \\udcff.g" in run.stdout.decode()
    assert r"<title>café \xff.g on i3</title>" in page.read_text(encoding="utf-8")
