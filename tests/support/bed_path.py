"""Where the nozzle was above the simulated bed, from the executed steps."""

from __future__ import annotations

import numpy as np
from tests.support.scenario import Scenario

from passo._core import Geometry
from passo.motion.endstops import motors_of_actuators
from passo.printer.setup.simulated_world import simulated_bed, simulated_geometry

_END = 1 << 60


class BedPath:
    """Keeps the steps from now on."""

    def __init__(self, scenario: Scenario) -> None:
        self._s = scenario
        self._now = scenario.printer.rig.connection.now
        self._start = scenario.positions()
        self._motors = motors_of_actuators(scenario.machine)
        for name in self._motors:
            scenario.board.trace_steps(name, self._now, _END)

    def heights(self, below_mm: float, every: int = 1) -> np.ndarray:
        """Height of the nozzle above the bed, mm, at each step of the first two motors since then,
        or one in `every`, with the nozzle below a height."""
        clocks, places = [], []
        for name in self._motors:
            raw, directions = self._s.board.take_steps(name, self._now, _END)
            clocks.append(np.frombuffer(raw, dtype=np.int64))
            steps = np.cumsum(np.frombuffer(directions, dtype=np.int8).astype(np.int64))
            per_mm = self._s.machine.steppers[name].steps_per_unit
            places.append(self._start[name] + np.concatenate(([0], steps)) / per_mm)
        times = np.sort(np.concatenate(clocks[:2]))[::every]
        found = zip(clocks, places, strict=True)
        q = [at[np.searchsorted(c, times, side="right")] for c, at in found]
        x, y, z = self._nozzle(q)
        bed = simulated_bed(self._s.machine).shape
        low = z < below_mm
        surface = np.array([bed.height(a, b) for a, b in zip(x[low], y[low], strict=True)])
        return z[low] - surface

    def _nozzle(self, q: list[np.ndarray]) -> list[np.ndarray]:
        geometry = simulated_geometry(self._s.machine)
        if geometry.kind == "cartesian":
            return q
        kernel = Geometry(geometry.spec())
        points = [kernel.forward(joints) for joints in zip(*q, strict=True)]
        return list(np.array(points).T)
