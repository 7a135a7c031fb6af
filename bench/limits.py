"""Whether prints with all motion filters keep the limits of the machine at each millisecond.

Usage: python bench/limits.py FILE.gcode ... [--lines N]. Prints the beginning of each file on the
yardstick's machines with shapers, pressure advance and a limit of jerk, and a row for each: the
highest speed and acceleration of each part, as a fraction of its limit. An acceleration may exceed
it by the greatest change of speed at one corner, divided by the time of the limit of jerk. Exit
status 1 if more is exceeded, or if a motor ends elsewhere than without filters.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from tests.oracles.limits import beginning, exceeded, filtered, printed  # noqa: E402

from passo.config import load  # noqa: E402


def main() -> int:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", nargs="+", type=Path)
    parser.add_argument("--lines", type=int, default=600)
    arguments = parser.parse_args()
    failed = 0
    with tempfile.TemporaryDirectory() as folder:
        for file in arguments.files:
            path = Path(folder) / "beginning.gcode"
            path.write_text(beginning(file.read_text(errors="replace"), arguments.lines))
            for kind in ("cartesian", "corexy", "delta"):
                plain = load(str(ROOT / "bench" / "machines" / f"yardstick-{kind}.toml"))
                machine = filtered(plain)
                found, counts = printed(machine, path)
                _, wanted = printed(plain, path)
                beyond = exceeded(machine, found)
                shares = ", ".join(
                    f"{name} {p.speed / p.speed_limit:.2f} {p.accel / p.accel_limit:.2f}"
                    for name, p in found.items()
                )
                print(f"{file.name} {kind}: {shares}", flush=True)
                for text in beyond:
                    print(f"  exceeded: {text}")
                if counts != wanted:
                    print(f"  steps {counts}, without filters {wanted}")
                failed += bool(beyond) or counts != wanted
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main())
