"""Power cuts and lost links in prints with filters on. Usage: bench/faults.py [COUNT]

On an i3, a CoreXY and a delta with shapers on all axes and pressure advance, and on an i3 with
limited jerk as well, prints are cut off at COUNT (200) random instants and continued by M1000, and
lose their link COUNT times. Each of them must end where the undisturbed print without filters ends,
after lost links to the step. Takes some minutes; stops at the first failure.
"""

from __future__ import annotations

import random
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from tests.job.test_filtered_prints import filtered, lose_links
from tests.job.test_power_cut_anywhere import all_resumed, filtered_cuts
from tests.support.disturbed_prints import undisturbed

_MACHINES = (("i3", None), ("corexy", None), ("delta", None), ("i3", 2e5))
_BEFORE = 2  # cuts of each print while it homes and warms up


def main(count: int) -> int:
    """Prints a row for each machine."""
    each = -(-count // len(_MACHINES))
    for kind, jerk_mm_s3 in _MACHINES:
        machine, begun_s = filtered(kind, jerk_mm_s3), time.process_time()
        with tempfile.TemporaryDirectory() as folder:
            cuts = filtered_cuts(machine, f"{kind} {jerk_mm_s3}", each - _BEFORE, Path(folder))
            lines = all_resumed(cuts)
        with tempfile.TemporaryDirectory() as folder:
            card, wanted = undisturbed(Path(folder), kind)
            breaks, prints = 0, 0
            while breaks < each:
                prints += 1
                breaks += lose_links(machine, card, wanted, random.Random(prints))
        name = f"{kind}{', limited jerk' if jerk_mm_s3 else ''}"
        took_s = time.process_time() - begun_s
        print(
            f"{name:18} {len(lines)} power cuts at {len(set(lines))} lines, {breaks} lost links in"
            f" {prints} prints: all ended at their steps, {took_s:.0f} s",
            flush=True,
        )
    return 0


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]) if len(sys.argv) > 1 else 200))
