"""Speed and size: `make bench`. Usage: python bench/run.py [organic.gcode] [--runs N]

Runs whole commands in processes of their own and prints medians of user CPU. Without a file it
takes ../shared/bench/organic.gcode.xz, unpacked first, else the example repeated. With
../shared/bench it compares with Klipper's figures there, carried to this machine by the yardstick
just before and just after: the machine's speed drifts.
"""

from __future__ import annotations

import argparse
import json
import lzma
import os
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[1]
SHARED = ROOT.parent / "shared" / "bench"
MACHINES = ROOT / "bench" / "machines"
PEERS = {"scara": "rotary_delta"}  # the machine that it is compared with, move by move
# User CPU of Klipper's batch mode on organic.gcode with mzv on X and Y and pressure advance (one
# run for CoreXY), and the yardstick's figure of that computer.
KLIPPERS_FILTERED_S = {"cartesian": 35.64, "corexy": 40.92}
KLIPPERS_CAL_S = 0.832
PIPELINE = """
import json, sys
from passo.config import load
from passo.job.batch.policy import Policy
from passo.job.batch.simulated_print import Print
result = Print(load(sys.argv[2]), Policy()).run(sys.argv[1])
print(json.dumps(result.as_dict()))
"""

# The same above waves of 0.1 mm that a mesh of 10 x 10 points has found.
MESH = PIPELINE.replace(
    "result =",
    """
from math import cos, pi, sin
from passo.levelling.areas import Grid
from passo.levelling.correction import Correction, apply
machine = load(sys.argv[2])
axes = machine.axes
area = axes["x"].min_mm, axes["y"].min_mm, axes["x"].max_mm, axes["y"].max_mm
def wave(x, y):
    return 0.1 * sin(2 * pi * x / 120) * cos(2 * pi * y / 160)
above = Print(machine, Policy())
apply(Correction(mesh=Grid(area, (10, 10)).mesh(wave)), area, above.job)
result =""",
).replace("Print(load(sys.argv[2]), Policy()).run", "above.run")


def user_s(words: list[str]) -> tuple[float, str]:
    """User CPU seconds of a command, and what it printed."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    done = subprocess.run(words, capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"{' '.join(words)}\n{done.stderr}")
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before, done.stdout


def yardstick() -> float:
    """CPU seconds of a fixed interpreter workload (the one of Klipper's figures)."""
    base = min(user_s([sys.executable, "-c", "pass"])[0] for _ in range(3))
    wrapped = "def f():\n s=0\n for i in range(12_000_000): s=(s*1103515245+i)&0xffffffff\nf()"
    return statistics.median(user_s([sys.executable, "-c", wrapped])[0] for _ in range(3)) - base


def unpacked(folder: str) -> Path:
    """The file to print."""
    target = Path(folder) / "organic.gcode"
    packed = SHARED / "organic.gcode.xz"
    if packed.exists():
        with lzma.open(packed) as source, target.open("wb") as sink:
            shutil.copyfileobj(source, sink)
        return target
    target.write_bytes(example() * 10)
    return target


def example() -> bytes:
    """The example, moved to the bed of the yardstick's machines, whose middle is 0, 0."""
    packed = (ROOT / "examples" / "demo.gcode.xz").read_bytes()
    return lzma.decompress(packed).replace(b"G28", b"G28\nG92 X125 Y125", 1)


def figures(path: Path, machine: str, runs: int) -> tuple[float, float, dict]:
    """Medians over runs: text → bytes on the wire, whole print; and the last result."""
    wire: list[float] = []
    whole: list[float] = []
    result: dict = {}
    for _ in range(runs):
        seconds, out = user_s([sys.executable, "-c", PIPELINE, str(path), machine])
        result = json.loads(out)
        whole.append(seconds)
        cpu = result["cpu_s"]
        wire.append(sum(cpu[stage] for stage in ("parse", "plan", "steps", "compress", "wire")))
    return statistics.median(wire), statistics.median(whole), result


def densities(path: Path, folder: str) -> None:
    """Prints steps a command of the first 200 000 moves, at the default window of 4 µs: on the
    yardstick's machine, with its limits and with others."""
    head = Path(folder) / "head.gcode"
    moves = 0
    with path.open() as source, head.open("w") as sink:
        for line in source:
            sink.write(line)
            moves += line.startswith(("G0", "G1"))
            if moves == 200_000:
                break
    plain = (MACHINES / "yardstick-cartesian.toml").read_text()
    gain, corner = "least_speed_gain = 0.2", "junction_deviation_mm = 0.00345"
    machine = Path(folder) / "machine.toml"
    for name, text in (
        ("as it is", plain),
        ("least_speed_gain 0", plain.replace(gain, "least_speed_gain = 0.0")),
        ("junction deviation 0.02 mm", plain.replace(corner, "junction_deviation_mm = 0.02")),
    ):
        machine.write_text(text)
        r = json.loads(user_s([sys.executable, "-c", PIPELINE, str(head), str(machine)])[1])
        density = sum(r["steps"].values()) / r["queue_step_commands"]
        print(f"steps a command, {name}: {density:.2f} in {r['move_time_s']:.0f} s")


def mesh(path: Path, machine: str, runs: int) -> None:
    """Prints what a bicubic mesh costs: medians of runs in turn."""
    words = [str(path), machine]
    flat: list[float] = []
    above: list[float] = []
    for _ in range(runs):
        flat.append(user_s([sys.executable, "-c", PIPELINE, *words])[0])
        above.append(user_s([sys.executable, "-c", MESH, *words])[0])
    a, b = statistics.median(flat), statistics.median(above)
    print(f"print above a mesh of 10 x 10 points: {b:.2f} s, {b / a:.2f} of {a:.2f} s without")


def filters(path: Path, folder: str, runs: int) -> None:
    """Prints what filters cost from text to wire: medians of runs in turn with the machine without
    them, and times Klipper's. Its filament does not follow the shapers, so the filament of the
    compared machine does not follow them either; the last row of each machine adds that."""
    filtered = Path(folder) / "filtered.toml"
    for kind in ("cartesian", "corexy", "delta"):
        plain = MACHINES / f"yardstick-{kind}.toml"
        for shaper, shaped in (("mzv", False), ("3hump_ei", False), ("mzv", True)):
            extruder = f"[extruders.e]\nadvance_s = 0.05\nshaped = {str(shaped).lower()}"
            text = plain.read_text().replace("[extruders.e]", extruder)
            shapes = [f'[shaping.{a}]\ntype = "{shaper}"\nfrequency_hz = 50\n' for a in "xy"]
            filtered.write_text("\n".join([text, *shapes]))
            times: list[list[float]] = [[], []]
            before = yardstick()
            for _ in range(runs):
                for found, machine in zip(times, (plain, filtered), strict=True):
                    found.append(figures(path, str(machine), 1)[0])
            cal = (before + yardstick()) / 2
            a, b = map(statistics.median, times)
            what = f"{kind} with {shaper} and advance{', filament shaped' if shaped else ''}"
            peer = KLIPPERS_FILTERED_S.get(kind) if path.name.startswith("organic") else None
            ratio = f", {peer / KLIPPERS_CAL_S * cal / b:.1f} x Klipper" if peer else ""
            print(f"{what}: {b:.2f} s, {b / a:.2f} of {a:.2f} s without{ratio}")


def memory(folder: str, machine: str) -> None:
    """Prints the peak memory of the example, once, ten and forty times in one file."""
    path = Path(folder) / "copies.gcode"
    for copies in (1, 10, 40):
        path.write_bytes(example() * copies)
        r = json.loads(user_s([sys.executable, "-c", PIPELINE, str(path), machine])[1])
        megabytes, most = path.stat().st_size / 1e6, r["process_peak_rss_mb"]
        print(f"peak memory, file of {megabytes:.1f} MB, {r['moves']} moves: {most:.0f} MB")


def main() -> None:
    """Prints the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("file", nargs="?", type=Path)
    parser.add_argument("--runs", type=int, default=3)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        path = arguments.file or unpacked(folder)
        peers = {}
        if (SHARED / "klipper.json").exists():
            peers = json.loads((SHARED / "klipper.json").read_text())
        commit = subprocess.run(
            ["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True, cwd=ROOT
        ).stdout.strip()
        print(f"commit {commit}, {os.cpu_count()} CPUs, {path.name}")
        print(
            f"{'machine':22}{'cal s':>7}{'wire s':>8}{'print s':>8}{'moves/s':>9}"
            f"{'Msteps/s':>9}{'ns/step':>8}{'steps/cmd':>10}{'B/cmd':>7}{'max us':>7}"
            f"{'rms us':>7}{'MB':>5}{'x wire':>8}{'x print':>8}"
        )
        for file in sorted(MACHINES.glob("*.toml")):
            before = yardstick()
            wire, whole, r = figures(path, str(file), arguments.runs)
            cal = (before + yardstick()) / 2
            steps = sum(r["steps"].values())
            kind = file.stem.removeprefix("yardstick-")
            peer = peers.get(f"organic {PEERS.get(kind, kind)}")
            ratios = ["", ""]
            if peer and path.name.startswith("organic"):
                carried = peer["user_s"] / peer["cal_s"] * cal
                ratios = [f"{carried / wire:.1f}", f"{carried / whole:.1f}"]
            print(
                f"{file.stem:22}{cal:7.3f}{wire:8.2f}{whole:8.2f}{r['moves'] / wire:9.0f}"
                f"{steps / wire / 1e6:9.1f}{wire / steps * 1e9:8.1f}"
                f"{steps / r['queue_step_commands']:10.2f}"
                f"{r['wire_bytes'] / r['queue_step_commands']:7.2f}"
                f"{r['step_error_us']['max']:7.2f}{r['step_error_us']['rms']:7.2f}"
                f"{r['process_peak_rss_mb']:5.0f}{ratios[0]:>8}{ratios[1]:>8}"
            )
            stages = {k: f"{v / steps * 1e9:.2f}" for k, v in r["cpu_s"].items() if k != "total"}
            print("   ns a step by stage: " + ", ".join(f"{k} {v}" for k, v in stages.items()))
            if path.name.startswith("organic") and peer and "print_time_s" in peer:
                theirs = peer["print_time_s"]
                print(f"   the moves take {r['move_time_s']:.0f} s, Klipper's {theirs} s")
        machine = str(MACHINES / "yardstick-cartesian.toml")
        passo = [sys.executable, "-m", "passo"]
        estimate = statistics.median(
            user_s([*passo, "estimate", str(path), "--machine", machine])[0]
            for _ in range(arguments.runs)
        )
        moves = r["moves"]
        start = statistics.median(user_s([*passo, "--help"])[0] for _ in range(arguments.runs))
        print(f"passo estimate: {estimate:.2f} s, {moves / estimate / 1e6:.2f} M moves/s")
        print(f"passo --help: {start:.2f} s")
        mesh(path, machine, arguments.runs)
        filters(path, folder, arguments.runs)
        densities(path, folder)
        memory(folder, machine)


if __name__ == "__main__":
    main()
