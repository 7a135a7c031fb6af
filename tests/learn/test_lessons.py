"""What every lesson and calculator keeps: texts whose numbers are computed, answers that can be
told apart, code that exists."""

from __future__ import annotations

import inspect
import re
from pathlib import Path

import pytest
from tools.references import course as documents

from passo.errors import CommandError
from passo.learn import calculators, lessons
from passo.learn.bilingual import LANGUAGES, Text, places
from passo.learn.course import all_calculators, all_lessons, calculator, hours, lesson
from passo.learn.lesson import Source
from passo.learn.rows import SUBJECTS
from passo.learn.source_place import source_place
from passo.learn.svg import plane_svg
from passo.learn.text_graph import text_graph

ROOT = Path(__file__).parents[2]
LESSONS = {one.name: one for one in all_lessons()}
EXPERIMENTS = {one.experiment.name: one.experiment for one in all_lessons()} | {
    one.name: one for one in all_calculators()
}
# A figure that nobody computes; names such as A4988, M92 and G1 have a letter before it.
DIGITS = re.compile(r"(?<![A-Za-zβ\d.])\d")
CODE = re.compile(r"`[^`]*`")


def texts(one):
    """The texts of a lesson, with the names that they may use."""
    shown = one.shown()
    for text in (one.goal, *one.text, one.printer.text):
        yield text, shown
    for number, question in enumerate(one.questions):
        known = one.asked(number).shown
        hints = [mistake.hint for mistake in question.mistakes]
        options = [text for _, text in question.options]
        for text in (question.ask, question.why, question.hint, *hints, *options):
            yield text, known


@pytest.mark.parametrize("one", LESSONS.values(), ids=LESSONS)
def test_each_number_of_a_lesson_is_computed(one):
    for text, known in texts(one):
        assert sorted(places(text.en)) == sorted(places(text.it)), text.en
        for words in (text.en, text.it):
            assert [name for name in places(words) if name not in known] == [], words
            plain = re.sub(r"\{[\w.]+(:n)?\}", "", CODE.sub("", words))
            assert DIGITS.findall(plain) == [], words


@pytest.mark.parametrize("one", LESSONS.values(), ids=LESSONS)
def test_right_answer_and_each_mistake_are_told_apart(one):
    assert len(one.questions) >= 2
    for number, question in enumerate(one.questions):
        asked = one.asked(number)
        assert question.mistakes
        for language in LANGUAGES:
            right = asked.check(asked.answer, language)
            assert (right.right, right.text) == (True, asked.text(question.why, language))
            for mistake in question.mistakes:
                wrong = asked.check(mistake.value(asked.numbers), language)
                hint = asked.text(mistake.hint, language)
                assert (wrong.right, wrong.text) == (False, hint), (question.ask.en, hint)
            far = asked.check(1e12 + 7, language)
            assert (far.right, far.text) == (False, asked.text(question.hint, language))
        if question.options:
            values = [value for value, _ in question.options]
            assert sum(asked.equal(value, asked.answer) for value in values) == 1
            assert len(question.mistakes) == len(values) - 1


@pytest.mark.parametrize("one", LESSONS.values(), ids=LESSONS)
def test_code_and_documents_of_a_lesson_exist(one):
    place = source_place(one.source)
    assert place.line > 0
    assert one.source.symbol.rpartition(".")[2].rpartition("::")[2] in place.code
    for link in one.links:
        assert bool(link.page) != bool(link.document)
        assert not link.document or (ROOT / link.document).is_file()
    assert one.printer.command or one.printer.page
    assert set(one.rows) <= {subject.number for subject in SUBJECTS}


@pytest.mark.parametrize("one", EXPERIMENTS.values(), ids=EXPERIMENTS)
def test_an_experiment_computes_at_all_its_bounds(one):
    names = [parameter.name for parameter in one.parameters]
    assert list(inspect.signature(one.compute).parameters) == names
    for parameter in one.parameters:
        values = [choice.value for choice in parameter.choices] or [parameter.low, parameter.high]
        assert one.values({})[parameter.name] == parameter.read(str(parameter.default))
        for value in values:
            outcome = one.run({parameter.name: value})
            assert [number.name for number in outcome.numbers] == [
                number.name for number in one.run({}).numbers
            ]
            for graph in outcome.graphs:
                assert all(len(line.x) == len(line.y) > 0 for line in graph.lines)
                text_graph(graph, "it")
            for plane in outcome.planes:
                assert plane_svg(plane, "en").startswith("<svg ")


def test_file_of_a_lesson_has_its_name_and_a_test():
    for package, found in ((lessons, LESSONS), (calculators, {c.name for c in all_calculators()})):
        folder = Path(package.__path__[0])
        names = {path.stem.replace("_", "-") for path in folder.glob("[a-z]*.py")}
        assert names == set(found)
    own = Path(__file__).parent / "lessons"
    tested = {path.stem.removeprefix("test_").replace("_", "-") for path in own.glob("test_*.py")}
    assert LESSONS.keys() - tested == set()


def test_documents_of_the_course_are_up_to_date():
    folder = ROOT / "docs" / "course"
    written = {
        path.relative_to(folder).as_posix(): path.read_text(encoding="utf-8")
        for path in folder.rglob("*.*")
    }
    made = documents.files()
    assert sorted(written) == sorted(made), "make reference"
    assert [name for name in made if written[name] != made[name]] == [], "make reference"


def test_an_hour_holds_whole_lessons_in_order():
    plan = hours()
    assert [one for hour in plan for one in hour] == list(all_lessons())
    assert all(sum(one.minutes for one in hour) <= 60 for hour in plan)


def test_unknown_names_and_values_out_of_bounds_are_refused():
    for call, code in (
        (lambda: lesson("perpetual-motion"), "learn.lesson"),
        (lambda: calculator("perpetual-motion"), "learn.calculator"),
        (lambda: calculator("steps-per-mm").values({"tooth": 16}), "learn.parameter"),
        (lambda: calculator("steps-per-mm").values({"teeth": 1000}), "learn.value"),
        (lambda: calculator("steps-per-mm").values({"teeth": "nan"}), "learn.value"),
        (lambda: calculator("steps-per-mm").values({"drive": "chain"}), "learn.value"),
    ):
        with pytest.raises(CommandError) as raised:
            call()
        assert raised.value.problems[0].code == code


def test_a_symbol_that_is_gone_is_an_error():
    for file, symbol in (
        ("src/passo/config/motion.py", "Stepper.steps_per_parsec"),
        ("core/plan/planner.hpp", "PlannerOfYore"),
    ):
        with pytest.raises(LookupError):
            source_place(Source(file, symbol))


def test_a_text_shows_figures_with_and_without_unit():
    one = LESSONS["steps-per-mm"]
    text = Text("{teeth}: {teeth:n}; {rod.steps_per_mm}", "{teeth}: {teeth:n}; {rod.steps_per_mm}")
    asked = one.asked(0)
    assert asked.text(text, "en") == "16 teeth: 16; 4000 steps/mm"
    assert asked.text(text, "it") == "16 denti: 16; 4000 passi/mm"
