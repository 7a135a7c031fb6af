"""Lessons and experiments as text for a terminal."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from textwrap import fill
from typing import TYPE_CHECKING

from passo.cli.tables import columns, rows
from passo.learn.bilingual import Text, filled, said
from passo.learn.source_place import source_place
from passo.learn.text_graph import text_graph

if TYPE_CHECKING:
    from passo.learn.bilingual import Language
    from passo.learn.experiment import Experiment, Value
    from passo.learn.lesson import Asked, Lesson

_WIDTH = 88
_GOAL = Text("Goal", "Obiettivo")
_TRY = Text("Try it", "Prova")
_SOURCE = Text("In the source", "Nel sorgente")
_PRINTER = Text("On your own printer", "Sulla tua stampante")
_PAGE = Text("page", "pagina")
_MORE = Text("More", "Altro")
_QUESTION = Text("Question", "Domanda")
_ANSWER = Text("Answer", "Risposta")


def _wrapped(text: str) -> str:
    return fill(text, _WIDTH, break_long_words=False, break_on_hyphens=False)


def outcome_text(experiment: Experiment, given: Mapping[str, Value], language: Language) -> str:
    """Parameters, numbers, tables and curves of an experiment."""
    values = experiment.values(given)
    outcome = experiment.compute(**values)
    pairs = [
        (said(each.label, language), f"{each.name}={_plain(values[each.name])}")
        for each in experiment.parameters
    ]
    results = [(said(one.label, language), one.shown.of(language)) for one in outcome.numbers]
    parts = [rows(pairs), rows(results)]
    for table in outcome.tables:
        cells = [[said(cell, language) for cell in row] for row in (table.columns, *table.rows)]
        parts.append(f"{said(table.title, language)}\n{columns(cells)}")
    parts += [text_graph(graph, language) for graph in outcome.graphs]
    return "\n\n".join(parts)


def _plain(value: Value) -> str:
    return value if isinstance(value, str) else f"{value:g}"


def lesson_text(lesson: Lesson, given: Mapping[str, Value], language: Language) -> Iterator[str]:
    """The parts of a lesson up to its questions."""
    shown = lesson.shown()
    title = lesson.title.of(language)
    yield f"{title}\n{'=' * len(title)}"
    yield _wrapped(f"{_GOAL.of(language)}: {filled(lesson.goal, language, shown)}")
    for paragraph in lesson.text:
        yield _wrapped(filled(paragraph, language, shown))
    names = " ".join(f"--set {each.name}=…" for each in lesson.experiment.parameters)
    yield _wrapped(f"{_TRY.of(language)}: passo learn {lesson.name} {names}")
    yield outcome_text(lesson.experiment, given, language)


def lesson_end(lesson: Lesson, language: Language) -> Iterator[str]:
    """The parts of a lesson after its questions."""
    place = source_place(lesson.source)
    where = f"{lesson.source.file}:{place.line}" if place.line else lesson.source.file
    yield f"{_SOURCE.of(language)}: {where}, {lesson.source.symbol}"
    printer = lesson.printer
    text = f"{_PRINTER.of(language)}: {filled(printer.text, language, lesson.shown())}"
    if printer.command:
        text += f" [{printer.command}]"
    if printer.page:
        text += f" [{_PAGE.of(language)} #/{printer.page}]"
    yield _wrapped(text)
    for link in lesson.links:
        to = link.document or f"{_PAGE.of(language)} #/{link.page}"
        yield f"{_MORE.of(language)}: {link.text.of(language)}, {to}"


def question_text(asked: Asked, number: int, language: Language) -> str:
    """A question, with the numbers of its options."""
    question = asked.question
    lines = [_wrapped(f"{_QUESTION.of(language)} {number}: {asked.text(question.ask, language)}")]
    for value, text in question.options:
        lines.append(f"  {value:g}: {asked.text(text, language)}")
    return "\n".join(lines)


def answers_text(asked: Asked, language: Language) -> str:
    """The right answer of a question, and the wrong ones of usual mistakes with their hints."""
    question = asked.question
    right = asked.shown[question.number].of(language)
    why = asked.text(question.why, language)
    lines = [_wrapped(f"{_ANSWER.of(language)}: {right}. {why}")]
    for mistake in question.mistakes:
        value, hint = mistake.value(asked.numbers), asked.text(mistake.hint, language)
        lines.append(_wrapped(f"  {value:.4g}: {hint}"))
    return "\n".join(lines)
