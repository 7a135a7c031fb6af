"""Errors reach another process as they are: with their text, problems and exit status."""

from __future__ import annotations

import copy
import importlib.util
import multiprocessing
import pickle
import pkgutil
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

import pytest

import passo
from passo import Machine, catalogue
from passo.board.faults import BoardResetError, BoardSilentError
from passo.board.i2c_sensors.exchanges import ChipError
from passo.board.trinamic.driver import DriverFailure
from passo.catalogue import CATALOGUE, Entry, ExitStatus
from passo.errors import InputError, PassoError, Problem
from passo.hub.link import Refused
from passo.levelling.least_squares import RankError
from passo.web.answers import Fault
from passo.web.client import RequestError

PROBLEMS = (
    Problem("config.value", "m.toml", 3, {"key": "a", "value": [1, 2.5], "limit": "b"}, "Why?"),
    Problem("input.garbage", "p.gcode", 7, {"value": "\u00e4\u65e5"}),
)
FAULT = Fault("card.not-found", "card", "a.g is not there", "Look at the list", {"value": "a.g"})
# Those whose constructors take something else than problems or a text.
MADE: dict[type[BaseException], Callable[[], BaseException]] = {
    BoardResetError: lambda: BoardResetError("tool"),
    BoardSilentError: lambda: BoardSilentError("get_clock (board tool)"),
    ChipError: lambda: ChipError("garbled", "the checksum 0x12 in place of 0x34"),
    DriverFailure: lambda: DriverFailure(PROBLEMS[0]),
    RankError: lambda: RankError(2, 3),
    Refused: lambda: Refused("card.full", "the card is full", "Delete files"),
    RequestError: lambda: RequestError(404, FAULT),
}


def test_code_is_in_one_file_of_the_catalogue() -> None:
    tables: list[dict[str, Entry]] = [
        table
        for found in pkgutil.iter_modules(catalogue.__path__, "passo.catalogue.")
        for table in vars(importlib.import_module(found.name)).values()
        if isinstance(table, dict) and all(isinstance(row, Entry) for row in table.values())
    ]
    assert sorted(code for table in tables for code in table) == sorted(CATALOGUE)


def public_errors() -> Iterator[type[BaseException]]:
    for found in pkgutil.walk_packages(passo.__path__, "passo."):
        spec = importlib.util.find_spec(found.name)
        if spec is None or not (spec.origin or "").endswith(".py") or "__main__" in found.name:
            continue  # the core has no errors of its own; libraries are no modules
        for value in vars(importlib.import_module(found.name)).values():
            if (
                isinstance(value, type)
                and issubclass(value, BaseException)
                and value.__module__ == found.name
                and not value.__name__.startswith("_")
            ):
                yield value


def made(cls: type[BaseException]) -> BaseException:
    if cls in MADE:
        return MADE[cls]()
    return cls(PROBLEMS) if issubclass(cls, PassoError) else cls("a text")


@pytest.mark.parametrize(
    "cls", list(public_errors()), ids=lambda cls: f"{cls.__module__}.{cls.__name__}"
)
def test_error_survives_pickle(cls: type[BaseException]) -> None:
    error: Any = made(cls)
    error.add_note("seen in a pool")
    copies = [pickle.loads(pickle.dumps(error, p)) for p in range(pickle.HIGHEST_PROTOCOL + 1)]
    for same in [*copies, copy.copy(error), copy.deepcopy(error)]:
        assert type(same) is cls
        assert str(same) == str(error)
        assert same.args == error.args
        assert vars(same) == vars(error)
    if issubclass(cls, PassoError):
        assert copies[0].problems == error.problems
        assert copies[0].problems[0].entry is error.problems[0].entry
        assert copies[0].status is error.status


def lines_of(path: str) -> int:
    return Machine.load("i3").print(path).lines


def test_bad_file_leaves_a_process_pool_usable(tmp_path: Path) -> None:
    good, bad = tmp_path / "good.gcode", tmp_path / "bad.gcode"
    good.write_text("G28\nG1 X10 F3000\n")
    bad.write_text("G28\nG1 X9999\n")
    with pytest.raises(InputError) as here:
        lines_of(str(bad))
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
        with pytest.raises(InputError) as there:
            pool.submit(lines_of, str(bad)).result()
        assert pool.submit(lines_of, str(good)).result() == 2
    assert str(there.value) == str(here.value)
    assert there.value.problems == here.value.problems
    assert there.value.status is ExitStatus.BAD_INPUT
