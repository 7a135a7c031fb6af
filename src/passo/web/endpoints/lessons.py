"""The course: its path, its lessons with experiments and questions, and the calculators."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import Annotated, ParamSpec, TypeVar

from msgspec import Meta, Struct

from passo.errors import CommandError
from passo.learn import course, views
from passo.learn.bilingual import Language
from passo.learn.lesson import Checked
from passo.web.call import Call
from passo.web.operation import operation
from passo.web.roles import Role

_VALUE = ("learn.parameter", "learn.value")
_P = ParamSpec("_P")
_T = TypeVar("_T")
# One thread: however many clients try experiments, the printer shares its interpreter with one.
_WORKER = ThreadPoolExecutor(1, "lessons")


async def _computed(call: Callable[_P, _T], *args: _P.args, **kwargs: _P.kwargs) -> _T:
    """The result of a computation, which does not block the web's event loop."""
    loop = asyncio.get_running_loop()
    return await loop.run_in_executor(_WORKER, partial(call, *args, **kwargs))


class InLanguage(Struct, forbid_unknown_fields=True):
    """The language of the texts."""

    language: Language = "en"


class Trial(InLanguage, forbid_unknown_fields=True):
    """Values of parameters, by name; the others keep their defaults."""

    values: Annotated[dict[str, float | str], Meta(max_length=100)] = {}


class GivenAnswer(InLanguage, forbid_unknown_fields=True, kw_only=True):
    """The answer to a question of a lesson."""

    answer: float


@operation("lessons.list", "GET", "/lessons", Role.VIEWER)
async def lessons(call: Call, query: InLanguage) -> views.CourseView:
    """The path of the course, and the calculators."""
    return await _computed(views.course_view, query.language)


@operation("lessons.get", "GET", "/lessons/{name}", Role.VIEWER, errors=("learn.lesson",))
async def lesson(call: Call, name: str, query: InLanguage) -> views.LessonView:
    """A lesson: its texts with the numbers of its experiment, its questions, and the code that it
    explains."""
    found = course.lesson(name)
    return await _computed(views.lesson_view, found, query.language)


@operation(
    "lessons.run", "POST", "/lessons/{name}/run", Role.VIEWER, errors=("learn.lesson", *_VALUE)
)
async def run_lesson(call: Call, name: str, body: Trial) -> views.OutcomeView:
    """Runs the experiment of a lesson with other values."""
    found = course.lesson(name).experiment
    return await _computed(views.outcome_view, found, body.values, body.language)


@operation(
    "lessons.check",
    "POST",
    "/lessons/{name}/check/{question}",
    Role.VIEWER,
    errors=("learn.lesson", "learn.question"),
)
async def check(
    call: Call, name: str, question: Annotated[int, Meta(ge=0, le=1000)], body: GivenAnswer
) -> Checked:
    """Checks the answer to a question, which is counted from 0. The text explains the right answer,
    or is the hint for the mistake that leads to a wrong one."""
    found = course.lesson(name)
    if question >= len(found.questions):
        limit = len(found.questions)
        raise CommandError.of("learn.question", axis=name, value=question, limit=limit)
    asked = await _computed(found.asked, question)
    return asked.check(body.answer, body.language)


@operation(
    "calculators.get", "GET", "/calculators/{name}", Role.VIEWER, errors=("learn.calculator",)
)
async def calculator(call: Call, name: str, query: InLanguage) -> views.ExperimentView:
    """A calculator with its parameters, and its outcome with their defaults."""
    found = course.calculator(name)
    return await _computed(views.experiment_view, found, query.language)


@operation(
    "calculators.run",
    "POST",
    "/calculators/{name}/run",
    Role.VIEWER,
    errors=("learn.calculator", *_VALUE),
)
async def run_calculator(call: Call, name: str, body: Trial) -> views.OutcomeView:
    """Calculates with other values."""
    found = course.calculator(name)
    return await _computed(views.outcome_view, found, body.values, body.language)
