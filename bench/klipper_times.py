"""Print times beside Klipper's: python bench/klipper_times.py KLIPPER FILE...

KLIPPER is a folder with Klipper's sources and `out/klipper.dict` of a build for a Linux process;
its Python is `--python`. Each file is reduced to its moves, and planned by both programs with equal
limits: 4000 mm/s² until the file sets less, and square corners at 5 mm/s. Prints the seconds of
both for each file.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from passo import config
from passo.config.exporting.klipper import exported
from passo.job.batch.estimate import estimate
from passo.printer.unfit_commands import ALL

_BEGIN_S = 0.25  # Klipper's clock at the first move (BUFFER_TIME_START)
_MOVES = re.compile(
    r"(G[0123]|G9[012]|M8[23]|M204|M22[01]|SET_VELOCITY_LIMIT)\b[^;]*", re.IGNORECASE
)
_HEAD = "SET_KINEMATIC_POSITION X=0 Y=0 Z=0\nG90\nM83\n"
_HEATER = """heater_pin: gpio30
sensor_type: Generic 3950
sensor_pin: analog0
control: watermark
min_temp: 0
max_temp: 300
min_extrude_temp: 0
max_extrude_cross_section: 100000
max_extrude_only_distance: 10000"""


def machine_text() -> str:
    """The shipped machine for a Linux process, with Klipper's corners and a large bed."""
    text = config.shipped_text("linux-test")
    text = text.replace("accel_mm_s2 = 1500.0", "accel_mm_s2 = 4000.0", 2)  # of X and Y
    text = text.replace('"cornering_distance"', '"square_corner"\nsquare_corner_mm_s = 5.0')
    return text.replace("min_mm = 0.0", "min_mm = -400.0").replace(
        "max_mm = 200.0", "max_mm = 400.0"
    )


def printer_cfg(machine: config.MachineConfig) -> str:
    """The same machine for Klipper, with what Klipper needs to start."""
    text = exported(machine).text("")
    text = re.sub(r"\[(fan|virtual_sdcard)\]\n(?:[^\[\n].*\n)*", "", text)
    text = text.replace("serial: /dev/serial/by-id/...", "serial: /tmp/klipper_host_mcu")
    text = text.replace("[extruder]", f"[extruder]\n{_HEATER}")
    for number, axis in enumerate("xyz", 20):
        ends = f"endstop_pin: gpio{number}\nposition_endstop: -400\nhoming_positive_dir: false"
        text = text.replace(f"[stepper_{axis}]", f"[stepper_{axis}]\n{ends}")
    return f"{text}\n[force_move]\nenable_force_move: True\n"


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("klipper", type=Path)
    parser.add_argument("files", nargs="+", type=Path)
    parser.add_argument("--python", default=sys.executable)
    arguments = parser.parse_args()
    klipper = arguments.klipper.resolve()
    machine = config.load_text(machine_text())
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "printer.cfg").write_text(printer_cfg(machine))
        for file in arguments.files:
            lines = file.read_text(encoding="utf-8", errors="replace").splitlines()
            moves = [found[0] for line in lines if (found := _MOVES.match(line.strip()))]
            reduced = folder / "moves.gcode"
            reduced.write_text(_HEAD + "\n".join(moves) + "\n")
            ours = estimate(machine, reduced, skips=ALL._replace(clamp=True)).total_s
            words = [arguments.python, klipper / "klippy/klippy.py", "printer.cfg", "-i", reduced]
            words += ["-d", klipper / "out/klipper.dict", "-o", "serial", "-l", "log"]
            subprocess.run(words, check=True, cwd=folder, capture_output=True)
            times = re.findall(r"\(print time ([\d.]+)s\)", (folder / "log").read_text())
            (folder / "log").unlink()
            theirs = float(times[-1]) - _BEGIN_S
            print(
                f"{file.name}: Klipper {theirs:.3f} s, Passo {ours:.3f} s, {ours - theirs:+.3f} s"
            )


if __name__ == "__main__":
    main()
