"""Prints every file of a folder of real G-code and compares the filament with its index.

Usage: python bench/corpus.py DIR. Writes a table to stdout; exit status 1 if a file fails, if a
motor ends elsewhere than planned, or if the filament differs from `net_e_mm` by more than 0.1 mm
where the file's rules allow the comparison; with M221, from the sum with that flow.
"""

from __future__ import annotations

import csv
import re
import sys
from pathlib import Path

from passo.config import load
from passo.errors import PassoError
from passo.job.batch.policy import Policy
from passo.job.batch.simulated_print import Print

# Which machine a file was sliced for; others go to the first that holds it.
MACHINES = {
    "p01": "mk3s",
    "p07": "mk3s",
    "p08": "mk3s",
    "p11": "mk3s",
    "p09": "multi-material",
    "p10": "dual-extruder",
    "p22": "dual-extruder",
    "p14": "mini",
    "p03": "corexy",
    "p12": "corexy",
    "p23": "i3",
    "p24": "laser",
    "p25": "cnc",
}
OTHER = "ender3"

# Why the filament that comes out is not the sum of the file's E words. With M221 it is the sum of
# what each word makes of the flow in force, and that is what the print is compared with.
FLOW = "M221 S95"
EXCUSES = {
    "p01": FLOW,
    "p07": FLOW,
    "p08": FLOW,
    "p09": f"{FLOW} and M702 C",
    "p11": FLOW,
    "p14": FLOW,
    "p05": "ends retracted by G10",
    "p21": "ends retracted by G10",
}
UNLOADED_MM = {"p09": 100.0}  # by M702 C, near the end of the file
TOLERANCE_MM = 0.1


_WORD = re.compile(r"([A-Z])([-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+))")


def filament_with_flow_mm(path: Path) -> float:
    """The sum of a file's E words, each times the flow that M221 has set before it."""
    total, last, flow, relative = 0.0, 0.0, 1.0, False
    for line in path.read_text().splitlines():
        code, _, rest = line.partition(";")[0].strip().partition(" ")
        words = {letter: float(number) for letter, number in _WORD.findall(rest)}
        if code in ("M82", "M83"):
            relative = code == "M83"
        elif code == "M221":
            flow = words.get("S", 100.0) / 100
        elif code == "G92":
            last = words.get("E", last)
        elif code in ("G0", "G1", "G2", "G3") and "E" in words:
            total += flow * (words["E"] if relative else words["E"] - last)
            last = words["E"]
    return total


def main(folder: Path) -> int:
    """Prints all files of the folder; returns the exit status."""
    index = folder / "index.csv"
    rows = {row["file"]: row for row in csv.DictReader(index.open())} if index.exists() else {}
    failed = 0
    print(f"{'file':32} {'machine':15} {'moves':>7} {'time s':>8} {'E mm':>9} {'index':>9}  result")
    for path in sorted(folder.glob("*.gcode")):
        key = path.name[:3]
        machine = load(MACHINES.get(key, OTHER))
        try:
            result = Print(machine, Policy()).run(path)
        except PassoError as error:
            print(f"{path.name:32} {machine.name:15} FAILED: {error}")
            failed += 1
            continue
        filament = sum(result.filament_mm.values())
        wanted = rows.get(path.name, {}).get("net_e_mm", "")
        verdict = "ok"
        if result.errors:
            verdict = "FAILED: " + "; ".join(result.errors)
        elif wanted and abs(filament - float(wanted)) > TOLERANCE_MM:
            verdict = f"ok, filament: {EXCUSES[key]}" if key in EXCUSES else "FAILED: filament"
            if FLOW in EXCUSES.get(key, ""):
                due = filament_with_flow_mm(path) - UNLOADED_MM.get(key, 0.0)
                if abs(filament - due) > TOLERANCE_MM:
                    verdict = f"FAILED: filament, {due:.1f} with {EXCUSES[key]}"
        failed += verdict.startswith("FAILED")
        print(
            f"{path.name:32} {machine.name:15} {result.moves:7} {result.print_time_s:8.0f}"
            f" {filament:9.1f} {wanted:>9}  {verdict}"
        )
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
