"""Errors of lessons and calculators."""

from __future__ import annotations

from collections.abc import Mapping

from passo.catalogue.entry import Entry, bad_input

LEARN: Mapping[str, Entry] = {
    "learn.lesson": bad_input(
        "lesson", "there is no lesson {value!r}", "`passo learn` lists the lessons"
    ),
    "learn.calculator": bad_input(
        "calculator", "there is no calculator {value!r}", "`passo calculate` lists the calculators"
    ),
    "learn.parameter": bad_input(
        "calculator", "{axis} has no parameter {value!r}: it has {limit}", "Correct the name"
    ),
    "learn.value": bad_input(
        "calculator", "{axis} cannot be {value!r}: expected {limit}", "Correct the value"
    ),
    "learn.question": bad_input(
        "lesson", "{axis} has no question {value}: it has {limit} from 0 on", "Correct the number"
    ),
}
