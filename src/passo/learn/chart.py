"""Charts as data for a written page."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from passo.learn.series import Series


@dataclass(frozen=True, slots=True)
class Curve:
    """A series with its name in the legend. `colour` is an index of the palette; a `dashed` curve
    is the target of the other curve of the same colour."""

    name: str
    series: Series
    colour: int
    dashed: bool = False

    def data(self) -> dict[str, object]:
        """For `draw/chart.js`."""
        series = self.series.encoded()
        return {"name": self.name, "colour": self.colour, "dashed": self.dashed, "series": series}


@dataclass(frozen=True, slots=True)
class Chart:
    """Curves of one unit over one axis."""

    title: str
    unit: str
    curves: Sequence[Curve]

    def data(self) -> dict[str, object]:
        """For `draw/chart.js`."""
        curves = [curve.data() for curve in self.curves]
        return {"title": self.title, "unit": self.unit, "curves": curves}
