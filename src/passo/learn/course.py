"""The course: its lessons in order, its calculators, and where each subject is taught."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from importlib import import_module
from pkgutil import iter_modules
from types import ModuleType

from passo.errors import CommandError
from passo.learn import calculators, lessons
from passo.learn.experiment import Experiment
from passo.learn.lesson import Chapter, Lesson

_CHAPTERS = tuple(Chapter)
_HOUR_MIN = 60


def _modules(package: ModuleType) -> Iterator[ModuleType]:
    for found in sorted(iter_modules(package.__path__), key=lambda module: module.name):
        yield import_module(f"{package.__name__}.{found.name}")


@cache
def all_lessons() -> tuple[Lesson, ...]:
    """The lessons in the order of the path."""
    found: list[Lesson] = [module.LESSON for module in _modules(lessons)]
    return tuple(sorted(found, key=lambda one: (_CHAPTERS.index(one.chapter), one.place)))


@cache
def all_calculators() -> tuple[Experiment, ...]:
    """The calculators, by name."""
    return tuple(module.CALCULATOR for module in _modules(calculators))


def lesson(name: str) -> Lesson:
    """The lesson of a name. Raises CommandError."""
    for one in all_lessons():
        if one.name == name:
            return one
    raise CommandError.of("learn.lesson", value=name)


def calculator(name: str) -> Experiment:
    """The calculator of a name. Raises CommandError."""
    for one in all_calculators():
        if one.name == name:
            return one
    raise CommandError.of("learn.calculator", value=name)


def hours() -> list[list[Lesson]]:
    """A plan: lessons in order, those of one hour together."""
    plan: list[list[Lesson]] = []
    left_min = 0
    for one in all_lessons():
        if one.minutes > left_min:
            plan.append([])
            left_min = _HOUR_MIN
        plan[-1].append(one)
        left_min -= one.minutes
    return plan
