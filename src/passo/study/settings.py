"""The settings of a study: values of keys of the machine file, by their path."""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping
from itertools import product
from math import exp, log
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from passo.study.study_file import Latin, Range, Study

Setting = Mapping[str, Any]
"""Keys of a machine file by their path, with the values that replace those of the file."""

_DIGITS = 6  # of sampled values: more would be noise in tables


def settings_of(study: Study) -> Iterator[Setting]:
    """All settings of a study, in the order of its rows; one without keys if it names none."""
    grids = [[(key, value) for value in values] for key, values in study.grid.items()]
    samples = list(hypercube(study.latin)) if study.latin else [dict[str, Any]()]
    for pairs in product(*grids):
        for listed in study.settings or [dict[str, Any]()]:
            for sample in samples:
                yield {**dict(pairs), **listed, **sample}


def hypercube(latin: Latin) -> Iterator[dict[str, Any]]:
    """A Latin hypercube: the range of each key has as many equal parts as there are samples, and
    each part has exactly one sample."""
    generator = random.Random(latin.seed)
    columns: dict[str, list[Any]] = {}
    for key, values in latin.keys.items():
        parts = list(range(latin.samples))
        generator.shuffle(parts)
        shares = [(part + generator.random()) / latin.samples for part in parts]
        columns[key] = [_value(values, share) for share in shares]
    for i in range(latin.samples):
        yield {key: column[i] for key, column in columns.items()}


def _value(values: Range, share: float) -> Any:
    """The value at a fraction of the range, 0 to 1."""
    if values.choices:
        return values.choices[min(int(share * len(values.choices)), len(values.choices) - 1)]
    low, high = values.min or 0.0, values.max or 0.0
    if values.logarithmic:
        value = exp(log(low) + share * (log(high) - log(low)))
    else:
        value = low + share * (high - low)
    if values.whole:
        return round(value)
    return min(max(float(f"{value:.{_DIGITS}g}"), low), high)
