"""With all filters on a print keeps its machine's limits, and ends at the steps of the plan."""

from __future__ import annotations

import lzma
from pathlib import Path

import pytest
from tests.oracles.limits import beginning, exceeded, filtered, printed

from passo.config import load

ROOT = Path(__file__).parents[2]
GEAR = ROOT / "tests" / "data" / "gear_arcs.gcode.xz"


@pytest.mark.parametrize("kind", ["cartesian", "corexy", "delta"])
def test_filters_exceed_no_limit_of_the_machine(tmp_path, kind):
    """At each millisecond of a gear's first lines."""
    path = tmp_path / "gear.gcode"
    path.write_text(beginning(lzma.decompress(GEAR.read_bytes()).decode(), 150))
    plain = load(str(ROOT / "bench" / "machines" / f"yardstick-{kind}.toml"))
    machine = filtered(plain)
    found, counts = printed(machine, path)
    assert exceeded(machine, found) == []
    assert found["x"].accel > 0.2 * found["x"].accel_limit
    assert counts == printed(plain, path)[1]
