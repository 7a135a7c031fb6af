"""Lessons and experiments in one language, for the page and `--json`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from passo.learn.bilingual import Language, Words, filled, said
from passo.learn.course import all_calculators, all_lessons
from passo.learn.experiment import Experiment, Outcome, Value
from passo.learn.lesson import Chapter, Lesson
from passo.learn.pictures import Graph
from passo.learn.source_place import source_place
from passo.learn.svg import plane_svg


@dataclass(frozen=True, slots=True)
class ListedLesson:
    """A lesson of the path; `questions` is their number."""

    name: str
    title: str
    goal: str
    minutes: int
    questions: int


@dataclass(frozen=True, slots=True)
class ListedChapter:
    """A part of the path, with its lessons in order."""

    title: str
    lessons: list[ListedLesson]


@dataclass(frozen=True, slots=True)
class ListedCalculator:
    """A calculator."""

    name: str
    title: str


@dataclass(frozen=True, slots=True)
class CourseView:
    """The path of the course, and the calculators."""

    chapters: list[ListedChapter]
    calculators: list[ListedCalculator]


@dataclass(frozen=True, slots=True)
class ChoiceView:
    """A value of a parameter that has only a few, with its name."""

    value: float | str
    text: str


@dataclass(frozen=True, slots=True)
class ParameterView:
    """A value to change: from `low` to `high` in steps of `step`, or one of `choices` if there are
    some."""

    name: str
    label: str
    unit: str
    default: float | str
    low: float
    high: float
    step: float
    choices: list[ChoiceView]


@dataclass(frozen=True, slots=True)
class NumberView:
    """A result: the figure or the words as a text, and its unit."""

    name: str
    label: str
    text: str
    unit: str


@dataclass(frozen=True, slots=True)
class LineView:
    """A line of a graph: its points, and the index of its colour."""

    name: str
    colour: int
    dashed: bool
    t: list[float]
    v: list[float]


@dataclass(frozen=True, slots=True)
class GraphView:
    """Lines of one unit over one axis, which `across` names. The vertical axis reaches
    `values`."""

    title: str
    across: str
    unit: str
    values: list[float]
    curves: list[LineView]


@dataclass(frozen=True, slots=True)
class PlaneView:
    """A picture to scale, as SVG that has no style of its own."""

    title: str
    svg: str


@dataclass(frozen=True, slots=True)
class TableView:
    """A table with a heading for each column."""

    title: str
    columns: list[str]
    rows: list[list[str]]


@dataclass(frozen=True, slots=True)
class OutcomeView:
    """What follows from the values of the parameters."""

    values: dict[str, float | str]
    numbers: list[NumberView]
    graphs: list[GraphView]
    planes: list[PlaneView]
    tables: list[TableView]


@dataclass(frozen=True, slots=True)
class ExperimentView:
    """An experiment with its parameters, and its outcome with the defaults."""

    name: str
    title: str
    about: str
    parameters: list[ParameterView]
    outcome: OutcomeView


@dataclass(frozen=True, slots=True)
class OptionView:
    """A possible answer of a question: the number to send, and its text."""

    value: float
    text: str


@dataclass(frozen=True, slots=True)
class QuestionView:
    """A question; with `options` the answer is one of them, otherwise a number in `unit`."""

    ask: str
    unit: str
    options: list[OptionView]


@dataclass(frozen=True, slots=True)
class SourceView:
    """The place in the code: `line` is 0, and `code` empty, if this installation lacks the file."""

    file: str
    symbol: str
    line: int
    code: str


@dataclass(frozen=True, slots=True)
class OwnPrinterView:
    """What to do on one's own printer: a command, or a part of the page."""

    text: str
    command: str
    page: str


@dataclass(frozen=True, slots=True)
class LinkView:
    """Further reading: a part of the page, or a document of the repository."""

    text: str
    page: str
    document: str


@dataclass(frozen=True, slots=True)
class LessonView:
    """A lesson. `before` and `after` are the names of its neighbours on the path, or empty."""

    name: str
    chapter: str
    title: str
    goal: str
    minutes: int
    paragraphs: list[str]
    experiment: ExperimentView
    questions: list[QuestionView]
    source: SourceView
    printer: OwnPrinterView
    links: list[LinkView]
    before: str
    after: str


def course_view(language: Language) -> CourseView:
    """The path and the calculators."""
    chapters = [
        ListedChapter(
            chapter.value.of(language),
            [_listed(one, language) for one in all_lessons() if one.chapter is chapter],
        )
        for chapter in Chapter
    ]
    calculators = [
        ListedCalculator(one.name, said(one.title, language)) for one in all_calculators()
    ]
    return CourseView([chapter for chapter in chapters if chapter.lessons], calculators)


def _listed(one: Lesson, language: Language) -> ListedLesson:
    title, goal = one.title.of(language), one.goal.of(language)
    return ListedLesson(one.name, title, goal, one.minutes, len(one.questions))


def lesson_view(one: Lesson, language: Language) -> LessonView:
    """A lesson with the numbers of its experiment."""
    shown = one.shown()
    names = ["", *(other.name for other in all_lessons()), ""]
    place = names.index(one.name)
    code = source_place(one.source)
    asked = [one.asked(i) for i in range(len(one.questions))]
    return LessonView(
        name=one.name,
        chapter=one.chapter.value.of(language),
        title=one.title.of(language),
        goal=filled(one.goal, language, shown),
        minutes=one.minutes,
        paragraphs=[filled(text, language, shown) for text in one.text],
        experiment=experiment_view(one.experiment, language),
        questions=[
            QuestionView(
                each.text(each.question.ask, language),
                said(each.unit, language),
                [
                    OptionView(value, each.text(text, language))
                    for value, text in each.question.options
                ],
            )
            for each in asked
        ],
        source=SourceView(one.source.file, one.source.symbol, code.line, code.code),
        printer=OwnPrinterView(
            filled(one.printer.text, language, shown), one.printer.command, one.printer.page
        ),
        links=[LinkView(link.text.of(language), link.page, link.document) for link in one.links],
        before=names[place - 1],
        after=names[place + 1],
    )


def experiment_view(one: Experiment, language: Language) -> ExperimentView:
    """An experiment with its defaults."""
    parameters = [
        ParameterView(
            name=each.name,
            label=said(each.label, language),
            unit=said(each.unit, language),
            default=each.default,
            low=each.low,
            high=each.high,
            step=each.step,
            choices=[
                ChoiceView(choice.value, each.shown(choice.value).of(language))
                for choice in each.choices
            ],
        )
        for each in one.parameters
    ]
    title, about = said(one.title, language), said(one.about, language)
    return ExperimentView(one.name, title, about, parameters, outcome_view(one, {}, language))


def outcome_view(one: Experiment, given: Mapping[str, Value], language: Language) -> OutcomeView:
    """The outcome of some values. Raises CommandError as `Experiment.values`."""
    values = one.values(given)
    outcome: Outcome = one.compute(**values)

    def row(cells: Sequence[Words]) -> list[str]:
        return [said(cell, language) for cell in cells]

    return OutcomeView(
        values=values,
        numbers=[
            NumberView(
                number.name,
                said(number.label, language),
                said(number.words, language) or number.shown.figure,
                "" if number.words else said(number.unit, language),
            )
            for number in outcome.numbers
        ],
        graphs=[_graph(graph, language) for graph in outcome.graphs],
        planes=[
            PlaneView(said(plane.title, language), plane_svg(plane, language))
            for plane in outcome.planes
        ],
        tables=[
            TableView(said(table.title, language), row(table.columns), [*map(row, table.rows)])
            for table in outcome.tables
        ],
    )


def _graph(graph: Graph, language: Language) -> GraphView:
    curves = [
        LineView(
            said(line.name, language),
            line.colour,
            line.dashed,
            list(line.x),
            list(line.y),
        )
        for line in graph.lines
    ]
    title, across = said(graph.title, language), said(graph.across, language)
    return GraphView(title, across, said(graph.unit, language), list(graph.values), curves)
