"""`passo.lab`: experiments of the course for notebooks: numbers with units, and arrays to plot."""

from __future__ import annotations

from array import array
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from passo.learn.bilingual import said
from passo.learn.course import all_calculators, all_lessons
from passo.learn.experiment import Outcome, Value

_LANGUAGE = "en"


class Quantity(float):
    """A number with its unit; it calculates like the number alone."""

    unit: str

    def __new__(cls, value: float, unit: str) -> Quantity:
        """A number with a unit; an empty one for a count."""
        quantity = super().__new__(cls, value)
        quantity.unit = unit
        return quantity

    def __repr__(self) -> str:
        """The number and its unit."""
        return f"{float(self):.10g} {self.unit}".rstrip()


@dataclass(frozen=True, slots=True)
class Curve:
    """A curve of a graph: arrays of doubles, which numpy takes as they are, and the labels of its
    axes with units."""

    x: array[float]
    y: array[float]
    x_label: str
    y_label: str


@dataclass(frozen=True, slots=True)
class Result:
    """What an experiment has computed: numbers by name, and curves by graph and name."""

    numbers: Mapping[str, Quantity]
    curves: Mapping[str, Mapping[str, Curve]]

    def __getitem__(self, name: str) -> Quantity:
        """A number by its name. Raises KeyError."""
        return self.numbers[name]


def experiments() -> list[str]:
    """The names of all experiments: those of lessons, and the calculators."""
    names = {one.name for one in all_calculators()}
    return sorted(names | {one.experiment.name for one in all_lessons()})


def experiment(name: str) -> Callable[..., Result]:
    """The experiment of a lesson or a calculator, as a function of its parameters by name. The
    function raises CommandError for a value outside of its bounds. Raises KeyError for an unknown
    name."""
    known = {one.name: one for one in all_calculators()}
    known |= {one.experiment.name: one.experiment for one in all_lessons()}
    found = known[name]

    def run(**given: Value) -> Result:
        return _result(found.run(given))

    run.__name__ = name.replace("-", "_")
    run.__doc__ = "\n".join(
        f"{each.name}: {said(each.label, _LANGUAGE)}, {each.bounds}" for each in found.parameters
    )
    return run


def _result(outcome: Outcome) -> Result:
    numbers = {one.name: Quantity(one.value, said(one.unit, _LANGUAGE)) for one in outcome.numbers}
    curves = {
        said(graph.title, _LANGUAGE): {
            said(line.name, _LANGUAGE): Curve(
                array("d", line.x),
                array("d", line.y),
                said(graph.across, _LANGUAGE),
                said(graph.unit, _LANGUAGE),
            )
            for line in graph.lines
        }
        for graph in outcome.graphs
    }
    return Result(numbers, curves)
