"""The study file: which files, on which machines, under which settings, and what is computed."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal, Self

from pydantic import Field, ValidationError, model_validator

from passo.config.load import machine_file_text, parsed, problems_of
from passo.config.model_findings import model_findings
from passo.config.origins import Origins
from passo.config.types import Model
from passo.errors import ConfigError
from passo.printer.unfit_commands import Skips

What = Literal["estimate", "print", "lab"]


class Range(Model):
    """The values of one key in a Latin hypercube: from `min` to `max`, or the `choices`."""

    min: float | None = None
    """The smallest value."""
    max: float | None = None
    """The largest value."""
    logarithmic: bool = False
    """Whether equal ratios of the value are equally likely, in place of equal differences."""
    whole: bool = False
    """Whether values are rounded to whole numbers."""
    choices: list[Any] = Field(default=[])
    """The allowed values, in place of a range."""

    @model_validator(mode="after")
    def _has_values(self) -> Self:
        low, high = self.min, self.max
        if self.choices:
            if low is not None or high is not None:
                raise ValueError("either choices, or min and max")
        elif low is None or high is None or low > high:
            raise ValueError("min and max, with min at most max, or choices")
        elif self.logarithmic and low <= 0:
            raise ValueError("a min above 0, because the range is logarithmic")
        return self


class Latin(Model):
    """A Latin hypercube: of each key, each of `samples` equal parts of its range has one sample."""

    samples: int = Field(ge=1, le=1_000_000)
    """The number of settings."""
    seed: int = 0
    """The start of the random numbers. The same seed gives the same settings."""
    keys: dict[str, Range]
    """The range of each key of the machine file."""


class Options(Model):
    """What a file may do in place of a failure, like the options of `passo estimate`."""

    out_of_range: Literal["stop", "clamp"] = "stop"
    """Moves beyond the limits of the machine: stop, or go to the limit."""
    missing_tool: Literal["stop", "ignore"] = "stop"
    """Tools that the machine lacks: stop, or continue with the current tool."""
    unknown: Literal["stop", "skip"] = "stop"
    """Unknown commands that may move the machine: stop, or skip them."""
    levelling: Literal["stop", "skip"] = "stop"
    """Bed levelling on a machine without a probe: stop, or skip it."""
    assume_ready: bool = False
    """Whether the machine counts as homed, and its hotends as warm."""

    @property
    def skips(self) -> Skips:
        """The same for the planner."""
        return Skips(
            unknown=self.unknown == "skip",
            levelling=self.levelling == "skip",
            clamp=self.out_of_range == "clamp",
            ignore_tools=self.missing_tool == "ignore",
        )


class Study(Model):
    """A study: each file is combined with each machine and each setting. A setting is one
    combination of the values of `grid`, with one of `settings` and one sample of `latin`."""

    files: list[str] = Field(min_length=1)
    """G-code files, relative to the study file: paths or patterns (`parts/*.gcode`; `**` stands for
    all folders)."""
    machines: list[str] = Field(min_length=1)
    """Shipped machines by name, or machine files, relative to the study file."""
    what: What = "estimate"
    """What is computed: `estimate` plans the file, `print` prints it on the simulated board, `lab`
    prints it and measures ringing, corners and lines."""
    grid: dict[str, list[Any]] = Field(default={})
    """Values of keys of the machine file, by their path in quotes, in all combinations."""
    settings: list[dict[str, Any]] = Field(default=[])
    """Settings one by one: each table has keys of the machine file with their values."""
    latin: Latin | None = None
    """Settings at random that cover ranges of several keys evenly."""
    options: Options = Options()
    """What a file may do in place of a failure."""


def load_study(path: str | os.PathLike[str]) -> Study:
    """The study of a file. Raises ConfigError with every problem, each with its line."""
    text, name = machine_file_text(Path(path)), os.fspath(path)
    return study_of(parsed(text, name), Origins(name, text))


def study_of(data: Mapping[str, Any], origins: Origins) -> Study:
    """The study with these tables. Raises ConfigError with every problem, each with its line."""
    try:
        return Study.model_validate(data)
    except ValidationError as error:
        raise ConfigError(problems_of(model_findings(error, Study), origins)) from None
