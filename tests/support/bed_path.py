"""Where the nozzle was above the simulated bed, from the executed steps of a cartesian machine."""

from __future__ import annotations

import numpy as np
from tests.support.scenario import Scenario

from passo.printer.setup.boards import simulated_bed

_END = 1 << 60


class BedPath:
    """Keeps the steps from now on."""

    def __init__(self, scenario: Scenario) -> None:
        self._s = scenario
        self._now = scenario.printer.connection.now
        self._start = scenario.positions()
        for name in "xyz":
            scenario.board.trace_steps(name, self._now, _END)

    def heights(self, below_mm: float) -> np.ndarray:
        """Height of the nozzle above the bed, mm, at each step of X and Y since then with Z of the
        motors below a height."""
        clocks, places = {}, {}
        for name in "xyz":
            raw, directions = self._s.board.take_steps(name, self._now, _END)
            clocks[name] = np.frombuffer(raw, dtype=np.int64)
            steps = np.cumsum(np.frombuffer(directions, dtype=np.int8).astype(np.int64))
            per_mm = self._s.machine.steppers[name].steps_per_unit
            places[name] = self._start[name] + np.concatenate(([0], steps)) / per_mm
        times = np.sort(np.concatenate((clocks["x"], clocks["y"])))
        x, y, z = (places[n][np.searchsorted(clocks[n], times, side="right")] for n in "xyz")
        bed = simulated_bed(self._s.machine).shape
        low = z < below_mm
        surface = np.array([bed.height(a, b) for a, b in zip(x[low], y[low], strict=True)])
        return z[low] - surface
