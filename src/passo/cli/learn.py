"""`passo learn`: shows the course, and its lessons with experiments and questions."""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from passo.errors import CommandError, ExitStatus

if TYPE_CHECKING:
    from passo.learn.bilingual import Language
    from passo.learn.experiment import Value
    from passo.learn.lesson import Asked, Lesson


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the options of `passo learn`."""
    parser.add_argument(
        "lesson",
        nargs="?",
        metavar="LESSON",
        help="a lesson. Without: list the lessons; in a terminal, also open the page of the course"
        " on a simulated printer",
    )
    parser.add_argument(
        "--page",
        action="store_true",
        help="open the page also if the output is not a terminal",
    )
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="KEY=VALUE",
        help="a parameter of the experiment; may be repeated",
    )
    parser.add_argument("--lang", choices=("en", "it"), default="en", help="default: en")
    parser.add_argument(
        "--json", action="store_true", help="print one JSON object and nothing else"
    )
    parser.add_argument(
        "--answers",
        action="store_true",
        help="for teachers: also print the answers, and the hint for each usual mistake",
    )


def read_values(texts: list[str]) -> dict[str, Value]:
    """The values of `KEY=VALUE`. Raises CommandError."""
    values: dict[str, Value] = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if not equals:
            raise CommandError.of("learn.value", axis=name, value="", limit="KEY=VALUE")
        values[name] = value
    return values


def run(arguments: argparse.Namespace) -> int:
    """Prints a lesson, and asks its questions on a terminal; or prints the course and opens its
    page."""
    from passo.learn.course import all_lessons, lesson

    language: Language = arguments.lang
    given = read_values(arguments.set)
    if arguments.lesson is None:
        if arguments.json:
            print(json.dumps([_as_dict(one, {}, language) for one in all_lessons()]))
        else:
            print(_list(language))
            if arguments.page or sys.stdout.isatty():
                from passo.cli.learn_page import serve_page

                serve_page()
        return ExitStatus.DONE
    chosen = lesson(arguments.lesson)
    if arguments.json:
        print(json.dumps(_as_dict(chosen, given, language)))
        return ExitStatus.DONE
    _show(chosen, given, language, answers=arguments.answers)
    return ExitStatus.DONE


def _list(language: Language) -> str:
    from passo.learn.views import course_view

    lines: list[str] = []
    course = course_view(language)
    width = max(len(one.name) for chapter in course.chapters for one in chapter.lessons)
    for chapter in course.chapters:
        lines += [chapter.title] + [
            f"  {one.name:<{width}}  {one.minutes:>3} min  {one.title}" for one in chapter.lessons
        ]
    return "\n".join(lines)


def _show(lesson: Lesson, given: dict[str, Value], language: Language, *, answers: bool) -> None:
    from passo.cli import lesson_text

    for part in lesson_text.lesson_text(lesson, given, language):
        print(f"{part}\n")
    for number in range(len(lesson.questions)):
        asked = lesson.asked(number)
        print(lesson_text.question_text(asked, number + 1, language))
        if answers:
            print(lesson_text.answers_text(asked, language))
        elif sys.stdin.isatty():
            _ask(asked, language)
        print()
    for part in lesson_text.lesson_end(lesson, language):
        print(part)


def _ask(asked: Asked, language: Language) -> None:
    """Asks until the answer is right, or the line is empty."""
    while True:
        print("> ", end="", flush=True)
        answer = sys.stdin.readline().strip().replace(",", ".")
        if not answer:
            return
        try:
            checked = asked.check(float(answer), language)
        except ValueError:
            continue
        print(("✓ " if checked.right else "✗ ") + checked.text)
        if checked.right:
            return


def _as_dict(lesson: Lesson, given: dict[str, Value], language: Language) -> dict[str, Any]:
    """The lesson as the page has it, with the answers."""
    from passo.learn.views import lesson_view, outcome_view

    found = asdict(lesson_view(lesson, language))
    found["experiment"]["outcome"] = asdict(outcome_view(lesson.experiment, given, language))
    for number, question in enumerate(found["questions"]):
        asked = lesson.asked(number)
        question["answer"] = asked.answer
        question["why"] = asked.text(asked.question.why, language)
        question["mistakes"] = [
            {"value": one.value(asked.numbers), "hint": asked.text(one.hint, language)}
            for one in asked.question.mistakes
        ]
    return found
