"""The correction that is added to Z: a fit, a mesh or both, which fade out above the first
layers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import ceil
from typing import Protocol

from passo.errors import CommandError
from passo.levelling.areas import Area
from passo.levelling.fits import Fit
from passo.levelling.mesh import Interpolation, Mesh

MAX_CELL_MM = 5.0
"""The spacing of the core's map for a quadric, mm: a curvature of 4e-5/mm is then exact to 0.25
µm."""
REFINED = 4
"""Intervals of the core's map for each interval of a bicubic mesh."""
_TABLE_POINTS = 11
"""Points along each axis of the table of a fit."""


@dataclass(frozen=True, slots=True)
class Fade:
    """The correction applies fully up to Z `start_mm`, and changes linearly until, at Z `end_mm`,
    it is `target_mm` everywhere."""

    start_mm: float
    end_mm: float
    target_mm: float = 0.0

    def factor(self, z: float) -> float:
        """The fraction of the correction at this Z, mm: from 1 down to 0."""
        share = (self.end_mm - z) / (self.end_mm - self.start_mm)
        return min(max(share, 0.0), 1.0)


class HeightMapTarget(Protocol):
    """The part of the core that takes a height map: `bed` of `passo._core.Job`, or `Motion`."""

    def set_height_map(
        self,
        first: tuple[float, float],
        spacing: tuple[float, float],
        heights: Sequence[Sequence[float]],
        fade: tuple[float, float, float] | None = None,
    ) -> None:
        """See the core."""
        ...


@dataclass(frozen=True, slots=True)
class Correction:
    """Z of the machine is Z + height(X, Y, Z)."""

    fit: Fit | None = None
    mesh: Mesh | None = None
    interpolation: Interpolation = "bicubic"
    fade: Fade | None = None

    def plain(self, x: float, y: float) -> float:
        """The correction at the bed, without fade, mm."""
        plane = self.fit.height(x, y) if self.fit else 0.0
        return plane + (self.mesh.height(x, y, self.interpolation) if self.mesh else 0.0)

    def height(self, x: float, y: float, z: float = 0.0) -> float:
        """The correction at a point, mm; `z` is the Z of the program."""
        c = self.plain(x, y)
        if self.fade is None:
            return c
        return self.fade.target_mm + self.fade.factor(z) * (c - self.fade.target_mm)

    def table(self, area: Area) -> Mesh:
        """The heights at the bed, without fade, for reports: at the points of the mesh or, without
        a mesh, at 11 × 11 even points over `area`."""
        if self.mesh is not None and self.fit is None:
            return self.mesh
        if self.mesh is not None:
            xs, ys = self.mesh.xs, self.mesh.ys
        else:
            last = _TABLE_POINTS - 1
            xs, ys = (
                tuple(low + (high - low) * k / last for k in range(last + 1))
                for low, high in ((area[0], area[2]), (area[1], area[3]))
            )
        return Mesh(xs, ys, tuple(tuple(self.plain(x, y) for x in xs) for y in ys))

    def raised(self, mm: float) -> Correction:
        """A copy that is higher by `mm` everywhere."""
        if self.mesh is not None:
            rows = tuple(tuple(round(z + mm, 9) for z in row) for row in self.mesh.heights)
            return replace(self, mesh=replace(self.mesh, heights=rows))
        return self.accumulated(Fit(mm))

    def accumulated(self, fit: Fit) -> Correction:
        """A copy with `fit` added, which was measured while this correction was on, as in
        APrinter's G32."""
        return replace(self, fit=fit if self.fit is None else self.fit + fit)

    def even_map(
        self, area: Area
    ) -> tuple[tuple[float, float], tuple[float, float], list[list[float]]]:
        """The map for the core: first point, spacing and rows of heights, mm. A mesh gives its own
        grid, refined if it is bicubic; a fit alone covers `area`. Outside of its map the core uses
        the height at the edge, so with a fit and a mesh the map covers both."""
        fit, mesh = self.fit, self.mesh
        quadratic = fit is not None and any(fit.coefficients[3:])
        spans = [(area[0], area[2]), (area[1], area[3])]
        if mesh is None:
            counts = [
                ceil((high - low) / MAX_CELL_MM - 1e-9) if quadratic else 1 for low, high in spans
            ]
            steps = [(high - low) / n for (low, high), n in zip(spans, counts, strict=True)]
            firsts = [low for low, _ in spans]
        else:
            parts = REFINED if self.interpolation == "bicubic" else 1
            if quadratic:
                parts *= ceil(max(mesh.spacing) / parts / MAX_CELL_MM)
            firsts: list[float] = []
            steps: list[float] = []
            counts: list[int] = []
            for places, (low, high) in zip((mesh.xs, mesh.ys), spans, strict=True):
                n = (len(places) - 1) * parts
                step = (places[-1] - places[0]) / n
                # Add cells of the mesh's size up to the limits of the fit.
                before = max(ceil((places[0] - low) / step - 1e-9), 0) if fit else 0
                after = max(ceil((high - places[-1]) / step - 1e-9), 0) if fit else 0
                firsts.append(places[0] - before * step)
                steps.append(step)
                counts.append(n + before + after)
        xs, ys = (
            [first + step * k for k in range(n + 1)]
            for first, step, n in zip(firsts, steps, counts, strict=True)
        )
        heights = [[self.plain(x, y) for x in xs] for y in ys]
        return (firsts[0], firsts[1]), (steps[0], steps[1]), heights


def apply(correction: Correction | None, area: Area, core: HeightMapTarget) -> None:
    """Sets the core's height map; None means a flat bed. `area` is the area that the nozzle can
    reach, mm. No motor moves, but the Z of the plan changes. Call it only while no move is queued.
    Raises CommandError if the heights differ by more than the correction can fade."""
    if correction is None:
        core.set_height_map((0.0, 0.0), (1.0, 1.0), [])
        return
    first, spacing, heights = correction.even_map(area)
    fade = correction.fade
    if fade is None:
        core.set_height_map(first, spacing, heights)
        return
    range_mm = max(abs(z - fade.target_mm) for row in heights for z in row)
    if not fade.end_mm - fade.start_mm > range_mm:
        raise CommandError.of("levelling.fade", value=fade.end_mm - fade.start_mm, limit=range_mm)
    core.set_height_map(first, spacing, heights, (fade.start_mm, fade.end_mm, fade.target_mm))
