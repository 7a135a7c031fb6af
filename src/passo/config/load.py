"""Loads machine files: shipped ones by name, others by path."""

from __future__ import annotations

import os
import re
import tomllib
import unicodedata
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path as FilePath
from typing import Any, NamedTuple, cast

from pydantic import ValidationError

from passo.config.board_defaults import (
    put_driver_wires,
    put_originals,
    put_probe_home,
    put_pullups,
)
from passo.config.board_files import Source, put_boards
from passo.config.changed_keys import put_changes
from passo.config.checks import check_all, with_still_axes
from passo.config.findings import Finding, as_written, did_you_mean, key_text, table
from passo.config.gains import question_gains
from passo.config.geometry_kinds import KINDS
from passo.config.heat_checks import check_sensors
from passo.config.home_checks import (
    check_home,
    check_home_sides,
    check_offsets,
    check_own_switches,
    check_park,
    check_scales,
    check_skew,
)
from passo.config.machine import MachineConfig
from passo.config.origins import Origins
from passo.config.predefined_move_checks import check_moves
from passo.config.probing_checks import check_probe
from passo.config.sensor_files import with_sensor_files
from passo.config.sensor_names import put_sensor_names
from passo.config.shaping_checks import check_advance, check_backlash, check_shaping
from passo.config.stalls import check_stalls
from passo.config.toml_lines import Path, line_of
from passo.errors import ConfigError, Problem

_HERE = FilePath(__file__).parent
_SYNTAX_PLACE = re.compile(r"^(.*?)\s*\(at (?:line (\d+), column \d+|end of document)\)$")
_UTF_16_MARKS = (b"\xff\xfe", b"\xfe\xff")
_NOT_ASCII = re.compile(r"[^\x00-\x7f]")
_DECIMAL_COMMA = re.compile(r"(?<![\w.,])\d+,\d+\s*(?=#|$)")


def shipped_machines() -> list[str]:
    """Names of the machines that come with Passo, sorted."""
    return sorted(path.stem for path in (_HERE / "machines").glob("*.toml"))


def shipped_text(name: str) -> str:
    """The text of the machine file of a shipped machine, for users to copy. Raises ConfigError."""
    if name not in shipped_machines():
        hint = did_you_mean(name, shipped_machines())
        raise ConfigError.of("config.unknown-machine", hint=hint, value=name)
    return (_HERE / "machines" / f"{name}.toml").read_text(encoding="utf-8")


def machine_path(name_or_path: str) -> FilePath | None:
    """The path of the machine file that `load` reads; None for the name of a shipped machine."""
    is_path = name_or_path.endswith(".toml") or os.sep in name_or_path
    return FilePath(name_or_path) if is_path else None


class Loaded(NamedTuple):
    """A machine, questions about allowed values of its file that are probably wrong, and the files
    from which it was loaded."""

    machine: MachineConfig
    questions: tuple[Problem, ...]
    origins: Origins


def load(name_or_path: str | os.PathLike[str]) -> MachineConfig:
    """Loads the machine of this name, or from this TOML file.

    A word without a path separator and without the ending .toml is the name of a shipped machine.
    Raises ConfigError with *every* problem of the file, each with its line.
    """
    return load_and_question(name_or_path).machine


def load_and_question(name_or_path: str | os.PathLike[str]) -> Loaded:
    """Like `load`, with a question for each value that is probably wrong, each with its line, and
    with the files from which values come."""
    return load_text_and_question(*text_and_file(name_or_path))


def text_and_file(name_or_path: str | os.PathLike[str]) -> tuple[str, str]:
    """The text that `load` reads, and the path of its file. Raises ConfigError."""
    name = os.fspath(name_or_path)
    path = machine_path(name)
    if path is not None:
        return machine_file_text(path), str(path)
    if name not in shipped_machines() and FilePath(name).exists():
        hint = "A machine file's name ends in .toml"
        raise ConfigError.of("config.unknown-machine", hint=hint, value=name)
    return shipped_text(name), str(_HERE / "machines" / f"{name}.toml")


def machine_file_text(path: FilePath) -> str:
    """The text of a machine file, which is in UTF-8. Raises ConfigError."""
    try:
        raw = path.read_bytes()
    except OSError as error:
        reason = error.strerror or str(error)
        raise ConfigError.of("config.unreadable", str(path), value=reason) from None
    if raw.startswith(_UTF_16_MARKS) or raw[:2].count(0) == 1:
        raise ConfigError.of("config.encoding", str(path), value="it is UTF-16")
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        column = error.start - raw.rfind(b"\n", 0, error.start)
        reason = f"byte 0x{raw[error.start]:02X} at column {column}"
        raise ConfigError.of("config.encoding", str(path), line, value=reason) from None


def load_text(
    text: str, file: str = "<text>", changes: Mapping[str, object] | None = None
) -> MachineConfig:
    """The machine that a TOML text describes; `file` names it in messages. Each of the `changes` is
    a key in the form of messages (`axes.x.speed_mm_s`) with the value that replaces that of the
    file. Raises ConfigError."""
    return load_text_and_question(text, file, changes).machine


def load_text_and_question(
    text: str, file: str = "<text>", changes: Mapping[str, object] | None = None
) -> Loaded:
    """Like `load_text`, with all that `load_and_question` returns."""
    try:
        return _machine(text, file, changes or {})
    except RecursionError:  # in the parser, or in functions that walk through nested tables
        raise ConfigError.of("config.syntax", file, value="it is nested too deeply") from None


def findings_of_text(text: str, file: str = "<text>") -> list[Finding]:
    """The problems of a machine file, without the lines; empty if it is valid. Raises ConfigError
    for a text that is not TOML."""
    return _checked(text, file, {})[1]


def _machine(text: str, file: str, changes: Mapping[str, object]) -> Loaded:
    machine, findings, origins = _checked(text, file, changes)
    if findings or machine is None:
        raise ConfigError(problems_of(findings, origins))
    return Loaded(machine, tuple(problems_of(question_gains(machine), origins)), origins)


def _checked(
    text: str, file: str, changes: Mapping[str, object]
) -> tuple[MachineConfig | None, list[Finding], Origins]:
    """The machine, None if its model is wrong, with all findings. Raises ConfigError for a text
    that is not TOML, and for integers that TOML does not allow."""
    data = parsed(text, file)
    if wrong := [*put_changes(data, changes)]:
        return None, wrong, Origins(file, text)
    folder = FilePath(file).parent
    sources: list[Source] = []
    findings = [*put_boards(data, folder, sources), *put_sensor_names(data)]
    findings += with_sensor_files(data, folder)
    findings += put_originals(data)
    put_pullups(data)
    put_driver_wires(data)
    put_probe_home(data)
    machine = None
    try:
        machine = MachineConfig.model_validate(with_still_axes(data))
    except ValidationError as error:
        from passo.config.model_findings import model_findings

        findings += model_findings(error)
    kind = table(data, "geometry").get("kind")
    model = KINDS.get(kind) if isinstance(kind, str) else None
    if model:
        findings += check_all(data, model)
    else:
        findings += check_all(data, None)
    if machine is not None and not findings:
        machine = machine.facing_its_middle()
        findings += [
            *check_home_sides(machine),
            *check_home(machine),
            *check_offsets(machine),
            *check_own_switches(machine),
            *check_skew(machine),
            *check_stalls(machine),
            *check_park(machine),
            *check_moves(machine),
            *check_scales(machine),
            *check_probe(machine),
            *check_shaping(machine),
            *check_advance(machine),
            *check_backlash(machine),
        ]
        findings += check_sensors(machine)
    return machine, findings, Origins(file, text, tuple(sources))


def parsed(text: str, file: str) -> dict[str, Any]:
    """The content of a TOML text; `file` names it in messages. Raises ConfigError for a text that
    is not TOML, and for integers that TOML does not allow."""
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        place = _SYNTAX_PLACE.match(str(error))
        message, line = (place[1], place[2]) if place else (str(error), None)
        at = int(line) if line else text.rstrip("\n").count("\n") + 1
        message += _odd_character(text.splitlines()[at - 1 : at])
        raise ConfigError.of("config.syntax", file, at, value=message) from None
    except ValueError:  # a number exceeds Python's limit of decimal digits
        reason = "an integer has too many digits"
        raise ConfigError.of("config.syntax", file, value=reason) from None
    if beyond := [*_beyond_64_bits(data)]:
        raise ConfigError(problems_of(beyond, Origins(file, text)))
    return data


def _odd_character(lines: list[str]) -> str:
    """The non-ASCII character in a line that a word processor has inserted for an ASCII one."""
    for line in lines:
        if found := _NOT_ASCII.search(line):
            name = unicodedata.name(found[0], "character").lower()
            return f"; the line has a {name} (U+{ord(found[0]):04X})"
        if found := _DECIMAL_COMMA.search(line):
            return f"; {found[0].strip()} has a decimal comma, write a point"
    return ""


def _beyond_64_bits(value: object, path: Path = ()) -> Iterator[Finding]:
    """Findings for integers of more than 64 bits, which TOML does not allow; later code need not
    check for them."""
    if isinstance(value, dict):
        for key, item in cast("dict[str, object]", value).items():
            yield from _beyond_64_bits(item, (*path, key))
    elif isinstance(value, list):
        for index, item in enumerate(cast("list[object]", value)):
            yield from _beyond_64_bits(item, (*path, index))
    elif isinstance(value, int) and not -(2**63) <= value < 2**63:
        size = f"an integer of {value.bit_length()} bits"
        yield Finding("config.value", path, size, "an integer of at most 64 bits")


def problems_of(findings: Iterable[Finding], origins: Origins) -> list[Problem]:
    """The findings as problems, in the order of lines; one for each path."""
    problems: dict[tuple[object, ...], Problem] = {}
    for finding in findings:
        limit, at = finding.limit, line_of(origins.lines, finding.path)
        if finding.owner:
            nearest = f"{origins.file}:{line_of(origins.lines, finding.owner)}"
            limit += f" {key_text(finding.owner)} ({origins.place(finding.owner) or nearest})"
        missing = finding.code == "config.missing-key"
        value = None if missing else as_written(finding.value)
        values = {"key": finding.key, "value": value, "limit": limit}
        problem = Problem(finding.code, origins.file, at, values, finding.hint)
        problems.setdefault(finding.path, problem)
    return sorted(problems.values(), key=lambda problem: problem.line or 0)
