"""A lesson: a goal, short paragraphs, an experiment, and questions that are answered before the
experiment shows the result."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum

from passo.learn.bilingual import Language, Shown, Text, Words, filled
from passo.learn.experiment import Experiment, Value


class Chapter(Enum):
    """A part of the course, in the order of the path."""

    MOTION = Text("Motion", "Movimento")
    ELECTRICITY = Text("Electricity", "Elettricità")
    HEAT = Text("Heat", "Calore")
    PRACTICE = Text("Practice", "Pratica")


@dataclass(frozen=True, slots=True)
class Mistake:
    """A usual mistake: the wrong value that it leads to, from the parameters and numbers of the
    question, and the hint for it."""

    value: Callable[[Mapping[str, float]], float]
    hint: Text


@dataclass(frozen=True, slots=True)
class Question:
    """Asks for `number` of the experiment with the values `given`. An answer is right within the
    fraction `tolerance`, or half of the last decimal that the number shows. `why` is shown after
    the right answer, `hint` after a wrong one that is none of the `mistakes`. With `options` (value
    and text) the answer is one of them."""

    ask: Text
    number: str
    mistakes: Sequence[Mistake]
    why: Text
    hint: Text
    given: Mapping[str, Value] = field(default_factory=dict[str, Value])
    tolerance: float = 0.01
    options: Sequence[tuple[float, Text]] = ()


@dataclass(frozen=True, slots=True)
class Source:
    """The place in the code that does what the lesson explains: a file of the repository, and a
    symbol in it, such as `Stepper.steps_per_unit`."""

    file: str
    symbol: str


@dataclass(frozen=True, slots=True)
class OwnPrinter:
    """What to do on one's own printer: a sentence, and a command of the console or of the shell, or
    a page (`calibrate/steps`)."""

    text: Text
    command: str = ""
    page: str = ""


@dataclass(frozen=True, slots=True)
class Link:
    """Further reading or trying: a page of the page (`learn`), or a document (`docs/…`)."""

    text: Text
    page: str = ""
    document: str = ""


@dataclass(frozen=True, slots=True)
class Lesson:
    """A lesson, which one file of `lessons/` holds; `name` is the name of that file with hyphens.
    `rows` are its rows of `rows.py`. Paragraphs, questions and hints have places for parameters and
    numbers of the experiment with its defaults; `{case.name}` is one with the values of a case."""

    name: str
    chapter: Chapter
    place: int
    rows: Sequence[int]
    minutes: int
    title: Text
    goal: Text
    text: Sequence[Text]
    experiment: Experiment
    questions: Sequence[Question]
    source: Source
    printer: OwnPrinter
    cases: Mapping[str, Mapping[str, Value]] = field(default_factory=dict[str, Mapping[str, Value]])
    links: Sequence[Link] = ()

    def shown(self) -> dict[str, Shown]:
        """The values for its texts."""
        found = self.experiment.shown({})
        for case, given in self.cases.items():
            found |= {f"{case}.{name}": one for name, one in self.experiment.shown(given).items()}
        return found

    def asked(self, number: int) -> Asked:
        """A question with its values. Raises IndexError."""
        question = self.questions[number]
        values = self.experiment.values(question.given)
        outcome = self.experiment.compute(**values)
        known = {name: value for name, value in values.items() if isinstance(value, float | int)}
        known |= {one.name: one.value for one in outcome.numbers}
        decimals = next(one.decimals for one in outcome.numbers if one.name == question.number)
        shown = self.shown() | self.experiment.shown(question.given)
        return Asked(question, known, shown, decimals)


@dataclass(frozen=True, slots=True)
class Checked:
    """The result of an answer: whether it is right, and what to read next."""

    right: bool
    text: str


@dataclass(frozen=True, slots=True)
class Asked:
    """A question, with the numbers that it is about."""

    question: Question
    numbers: Mapping[str, float]
    shown: Mapping[str, Shown]
    decimals: int

    @property
    def answer(self) -> float:
        """The right answer."""
        return self.numbers[self.question.number]

    @property
    def unit(self) -> Words:
        """The unit of the answer."""
        return self.shown[self.question.number].unit

    def text(self, words: Text, language: Language) -> str:
        """A text of the question with its values."""
        return filled(words, language, self.shown)

    def equal(self, answer: float, value: float) -> bool:
        """Whether an answer is a value, within the tolerance of the question."""
        tolerance = max(self.question.tolerance * abs(value), 0.5000001 * 10.0**-self.decimals)
        return abs(answer - value) <= tolerance

    def check(self, answer: float, language: Language) -> Checked:
        """Compares an answer with the right one, then with those of the usual mistakes, of which
        the nearest counts."""
        question = self.question
        if self.equal(answer, self.answer):
            return Checked(True, self.text(question.why, language))
        values = [(mistake.value(self.numbers), mistake.hint) for mistake in question.mistakes]
        found = [(abs(answer - value), hint) for value, hint in values if self.equal(answer, value)]
        hint = min(found, key=lambda one: one[0])[1] if found else question.hint
        return Checked(False, self.text(hint, language))
