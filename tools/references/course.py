"""The documents of the course: `docs/course/`, made from the lessons."""

from __future__ import annotations

from collections.abc import Iterator

from passo.learn.bilingual import Language, Text, filled, said
from passo.learn.course import all_calculators, all_lessons, hours
from passo.learn.experiment import Experiment, Outcome
from passo.learn.lesson import Chapter, Lesson
from passo.learn.rows import SUBJECTS
from passo.learn.svg import graph_svg, plane_svg

_MADE = "<!-- made from src/passo/learn/lessons: make reference -->\n\n"
_PARAMETER = Text("Parameter", "Parametro")
_VALUE = Text("Value", "Valore")
_RESULT = Text("Result", "Risultato")
_TRY = Text("Try it", "Prova")
_HOW = Text("On the page: *Learn*. In a terminal:", "Nella pagina: *Impara*. In un terminale:")
_QUESTIONS = Text("Predict, then check", "Prevedi, poi verifica")
_ANSWER = Text("Answer", "Risposta")
_PRINTER = Text("On your own printer", "Sulla tua stampante")
_SOURCE = Text("In the source", "Nel sorgente")
_MORE = Text("More", "Altro")
_MINUTES = Text("minutes", "minuti")
_OTHER: dict[Language, Language] = {"en": "it", "it": "en"}
_OTHER_NAME = {"en": "Italiano", "it": "English"}

_START = """\
A student needs Python 3.11 or newer on Linux, and no compiler. A teacher builds the wheel
once, in a checkout of the sources, by `make wheel`. It contains the page. Then, for each student:

    python3 -m venv passo && . passo/bin/activate
    pip install "passo[web] @ file:///FOLDER/OF/THE/passo-WHEEL.whl"
    passo learn

In a terminal, `passo learn` opens the page on a simulated printer. Nothing moves or heats outside
of the computer."""


def files() -> dict[str, str]:
    """The files by their path in `docs/course/`."""
    found = {"README.md": _index()}
    languages: tuple[Language, ...] = ("en", "it")
    for lesson in all_lessons():
        outcome = lesson.experiment.run({})
        for language in languages:
            pictures = dict(_pictures(lesson, outcome, language))
            found |= {f"pictures/{name}": text for name, (_, text) in pictures.items()}
            titles = [(name, title) for name, (title, _) in pictures.items()]
            found[_page(lesson, language)] = _lesson(lesson, outcome, titles, language)
    return found


def _page(lesson: Lesson, language: Language) -> str:
    return f"{language}/{lesson.name}.md"


def _pictures(
    lesson: Lesson, outcome: Outcome, language: Language
) -> Iterator[tuple[str, tuple[str, str]]]:
    """File name, title and text of each picture."""
    made = [(one.title, plane_svg(one, language, file=True)) for one in outcome.planes]
    made += [(one.title, graph_svg(one, language)) for one in outcome.graphs]
    for number, (title, text) in enumerate(made, 1):
        yield f"{lesson.name}-{number}-{language}.svg", (said(title, language), text)


def _lesson(
    lesson: Lesson, outcome: Outcome, pictures: list[tuple[str, str]], language: Language
) -> str:
    shown = lesson.shown()
    other = _OTHER[language]
    parts = [
        f"# {lesson.title.of(language)}",
        f"{filled(lesson.goal, language, shown)} {lesson.minutes} {_MINUTES.of(language)}. ·"
        f" [{_OTHER_NAME[language]}](../{_page(lesson, other)}) ·"
        f" [{'Course' if language == 'en' else 'Corso'}](../README.md)",
        *(filled(text, language, shown) for text in lesson.text),
        *(f"![{title}](../pictures/{name})" for name, title in pictures),
    ]
    for table in outcome.tables:
        parts.append(said(table.title, language))
        parts.append(_table([[said(c, language) for c in r] for r in (table.columns, *table.rows)]))
    parts += [f"## {_TRY.of(language)}", *_experiment(lesson.experiment, outcome, language)]
    parts.append(f"{_HOW.of(language)}")
    parts.append(f"    passo learn {lesson.name}{' --lang it' if language == 'it' else ''}")
    parts.append(f"## {_QUESTIONS.of(language)}")
    parts += [_question(lesson, number, language) for number in range(len(lesson.questions))]
    parts.append(f"## {_PRINTER.of(language)}")
    command = f" `{lesson.printer.command}`" if lesson.printer.command else ""
    parts.append(f"{filled(lesson.printer.text, language, shown)}{command}")
    source = lesson.source
    parts.append(
        f"{_SOURCE.of(language)}: `{source.symbol}`, [{source.file}](../../../{source.file})"
    )
    documents = [link for link in lesson.links if link.document]
    if documents:
        links = [f"[{link.text.of(language)}](../../../{link.document})" for link in documents]
        parts.append(f"{_MORE.of(language)}: {', '.join(links)}")
    return _MADE + "\n\n".join(parts) + "\n"


def _experiment(one: Experiment, outcome: Outcome, language: Language) -> Iterator[str]:
    yield said(one.about, language)
    rows = [[_PARAMETER.of(language), "`--set`", _VALUE.of(language)]]
    values = one.values({})
    for each in one.parameters:
        value = each.shown(values[each.name]).of(language)
        rows.append([said(each.label, language), f"`{each.name}`", value])
    yield _table(rows)
    rows = [[_RESULT.of(language), _VALUE.of(language)]]
    rows += [[said(n.label, language), n.shown.of(language)] for n in outcome.numbers]
    yield _table(rows)


def _question(lesson: Lesson, number: int, language: Language) -> str:
    asked = lesson.asked(number)
    question = asked.question
    options = [f"- {asked.text(text, language)}" for _, text in question.options]
    answer = asked.shown[question.number].of(language)
    why = asked.text(question.why, language)
    lines = [f"{number + 1}. {asked.text(question.ask, language)}", *options]
    text = "\n".join(lines)
    return (
        f"{text}\n\n<details><summary>{_ANSWER.of(language)}</summary>\n\n{answer}. {why}\n\n"
        "</details>"
    )


def _table(rows: list[list[str]]) -> str:
    head, *body = [f"| {' | '.join(row)} |" for row in rows]
    return "\n".join([head, "|" + "---|" * len(rows[0]), *body])


def _index() -> str:
    parts = [
        "# The course: how a printer works, by trying it",
        "Each lesson has a goal, an experiment that runs, and questions to answer before the"
        " experiment shows the result. `passo learn` lists the lessons, `passo learn NAME` shows"
        " one and asks its questions; the page has them under *Learn*. All are in English and"
        " Italian. [Write one more](../how-to/add-a-lesson.md).",
    ]
    parts.append("## Start")
    parts.append(_START)
    for chapter in Chapter:
        found = [one for one in all_lessons() if one.chapter is chapter]
        if found:
            parts.append(f"## {chapter.value.en}")
            rows = [["Lesson", "Minutes", "You learn"]]
            rows += [
                [
                    f"[{one.title.en}]({_page(one, 'en')}) ([it]({_page(one, 'it')}))",
                    str(one.minutes),
                    filled(one.goal, "en", one.shown()),
                ]
                for one in found
            ]
            parts.append(_table(rows))
    parts.append("## A plan for a term")
    parts.append("Lessons of one hour, in order. The rest of the hour is for your own printer.")
    rows = [["Hour", "Lessons"]]
    for number, lessons in enumerate(hours(), 1):
        links = ", ".join(f"[{one.title.en}]({_page(one, 'en')})" for one in lessons)
        rows.append([str(number), links])
    parts.append(_table(rows))
    parts.append("## Calculators")
    parts.append("`passo calculate NAME KEY=VALUE …`, or *Learn* on the page.")
    rows = [["Calculator", "What it finds"]]
    rows += [[f"`{one.name}`", said(one.about, "en")] for one in all_calculators()]
    parts.append(_table(rows))
    parts.append("## What is taught where")
    parts.append(_table([["#", "Subject", "Lessons", "Also"], *_subjects()]))
    return _MADE + "\n\n".join(parts) + "\n"


def _subjects() -> Iterator[list[str]]:
    for subject in SUBJECTS:
        lessons = [
            f"[{one.title.en}]({_page(one, 'en')})"
            for one in all_lessons()
            if subject.number in one.rows
        ]
        name = subject.elsewhere.rpartition("/")[2]
        also = f"[{name}](../../{subject.elsewhere})" if subject.elsewhere else ""
        yield [str(subject.number), subject.title.en, ", ".join(lessons), also]
