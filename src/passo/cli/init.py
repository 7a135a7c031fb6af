"""`passo init`: makes a machine file from a shipped one and from answers."""

from __future__ import annotations

import argparse
import getpass
import json
import sys
import uuid
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from passo.errors import ConfigError, ExitStatus, InputError, Problem

if TYPE_CHECKING:
    from passo.config import MachineConfig
    from passo.config.toml_lines import Path as KeyPath

_Value = TypeVar("_Value", str, float)
_GUIDE = "\nEnter alone takes the value in brackets. Ctrl-C ends this without a file.\n"
# geometries with an independent travel for each axis
_STRAIGHT = ("cartesian", "corexy", "corexz", "coreyz", "hybrid_corexy", "hybrid_corexz")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the arguments of `passo init`."""
    parser.add_argument(
        "file", metavar="FILE.toml", nargs="?", help="the file to make; default: NAME.toml"
    )


def run(arguments: argparse.Namespace) -> int:
    """Asks questions on the terminal and writes the file. Raises InputError if the file exists or
    cannot be written."""
    from passo import config
    from passo.cli import machines

    machines.run(argparse.Namespace(name=None, json=False))
    print(_GUIDE)
    base = _choice("The machine most like yours", config.shipped_machines(), "i3")
    draft = _Draft(base)
    name = draft.ask("Its name", ("name",), f"my-{base}")
    path = Path(arguments.file or f"{name}.toml")
    if path.exists():
        raise InputError.of("output.exists", str(path))
    draft.put(("uuid",), str(uuid.uuid4()))
    draft.ask("Your name", ("author",), getpass.getuser())
    draft.ask("One line about it", ("description",), "")
    _ask_parts(draft, config.load(base))
    draft.correct_all()
    try:
        path.write_text(draft.text, encoding="utf-8")
    except OSError as error:
        value = error.strerror or str(error)
        raise InputError.of("output.unwritable", str(path), value=value) from None
    print(f"\n{path}: written.")
    left = draft.problems()
    for problem in left:
        print(f"  To correct, line {problem.line}: {problem.sentence}. {problem.hint}")
    print(f"Next: passo {'check' if left else 'serve --machine'} {path}")
    return ExitStatus.DONE


def _ask_parts(draft: _Draft, machine: MachineConfig) -> None:
    from passo import config

    board = _choice("The board", config.shipped_boards(), machine.board.base or "")
    draft.put(("board", "base"), board)
    if port := _answer("Serial port of the board, such as /dev/ttyACM0", "simulated"):
        draft.put(("board", "link"), "serial")
        draft.put(("board", "port"), port)
    if machine.geometry.kind in _STRAIGHT:
        for name in "xyz":
            _ask_travel(draft, machine, name)
    for name, stepper in machine.steppers.items():
        if stepper.steps_per_mm is not None:
            key = ("steppers", name, "steps_per_mm")
            draft.ask(f"Steps per mm of motor {name}", key, stepper.steps_per_mm)
    for name, heater in machine.heaters.items():
        draft.ask(f"Thermistor of {name}, by name or type number", ("heaters", name, "sensor"), "")
        draft.ask(f"Highest temperature of {name}, °C", ("heaters", name, "max_c"), heater.max_c)


def _ask_travel(draft: _Draft, machine: MachineConfig, name: str) -> None:
    axis, homing = machine.axes[name], machine.homing.get(name)
    end = draft.ask(
        f"Highest position of {name.upper()}, mm", ("axes", name, "max_mm"), axis.max_mm
    )
    if axis.home_mm == axis.max_mm:
        draft.put(("axes", name, "home_mm"), end)
    if homing is not None and homing.position == axis.max_mm:
        draft.put(("homing", name, "position"), end)


class _Draft:
    """The text of a machine file that is being made, from a shipped one. Each answer is checked as
    the value of its key; its relation to other keys is checked at the end."""

    def __init__(self, base: str) -> None:
        from passo import config

        lines = config.shipped_text(base).splitlines(keepends=True)
        text = "".join(line for line in lines if not line.startswith("#"))
        self.text = f"# Made by `passo init` from the shipped machine {base}.\n{text}"

    def put(self, path: KeyPath, value: str | float) -> None:
        """Sets a key. Raises ValueError if its place in the text cannot be changed."""
        from passo.config.toml_edit import with_value

        self.text = with_value(self.text, path, json.dumps(value, ensure_ascii=False))

    def ask(self, question: str, path: KeyPath, default: _Value) -> _Value:
        """Asks for the value of a key until the answer is valid, sets it, and returns it. Enter
        selects the default; an empty default leaves the key unchanged."""
        before = self.text
        while True:
            answer = _answer(question, default)
            try:
                value = type(default)(answer) if answer else default
            except ValueError:
                print(f"  {answer!r} is not a number. Write it with a decimal point.")
                continue
            if value == "":
                return value
            self.put(path, value)
            if not (problems := self.problems(path)):
                return value
            print(f"  {problems[0].sentence}. {problems[0].hint}")
            self.text = before

    def problems(self, path: KeyPath = ()) -> list[Problem]:
        """The problems of the text, or only of the key at `path`."""
        from passo import config
        from passo.config.findings import key_text

        try:
            config.load_text(self.text)
        except ConfigError as error:
            return [p for p in error.problems if not path or p.values.get("key") == key_text(path)]
        return []

    def correct_all(self) -> None:
        """Asks once for each key that has a problem."""
        asked = set[str]()
        while problem := next((p for p in self.problems() if p.values["key"] not in asked), None):
            asked.add(problem.values["key"])
            self._correct(problem)

    def _correct(self, problem: Problem) -> None:
        from passo.config.findings import path_of

        print(f"\n{problem.sentence}. {problem.hint}")
        try:
            self.ask("Another value", path_of(problem.values["key"]), "")
        except ValueError:
            print("  Correct this one in the file.")


def _choice(question: str, known: list[str], default: str) -> str:
    from passo.config.findings import did_you_mean

    while True:
        answer = _answer(question, default) or default
        if answer in known:
            return answer
        hint = did_you_mean(answer, known) or f"Known here: {', '.join(known)}"
        print(f"  There is no {answer!r}. {hint}")


def _answer(question: str, default: object) -> str:
    shown = f"{default:g}" if isinstance(default, float) else default
    print(question, f"[{shown}]: " if shown != "" else "(Enter leaves it): ", end="", flush=True)
    answer = sys.stdin.readline()
    if not answer:  # the input has ended
        raise KeyboardInterrupt
    return answer.strip()
