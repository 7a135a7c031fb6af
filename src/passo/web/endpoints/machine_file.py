"""Reads, checks, compares and writes the machine file, and lists the machines that come with
Passo."""

from __future__ import annotations

import asyncio
import logging
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Annotated, Any

from msgspec import Meta, Struct

from passo import config
from passo.catalogue import codes_of
from passo.config.load import Loaded
from passo.config.machine_schema import schema
from passo.config.notes import notes
from passo.config.own_machines import own_path
from passo.errors import ConfigError, PassoError, Problem
from passo.gcode.command import numeral
from passo.job.settings_store import Setting, same
from passo.web.bridge import SettingValue
from passo.web.call import Call
from passo.web.machine import file
from passo.web.machine.keys import KeyChange, KeyValue, key_changes, key_values, setting_of
from passo.web.operation import operation
from passo.web.roles import Role

_log = logging.getLogger(__name__)
_CONFIG_ERRORS = codes_of("config")


class MachineFile(Struct):
    """The text of the machine file. `path` is null if there is no file to change: for a shipped
    machine, or for a machine that a program has made. `machine.apply` needs `sha256`, the SHA-256
    of the text. `own_path` is where `machine.save` writes the user's file of a shipped machine;
    null for other machines, and without a folder for it (`--state`)."""

    path: str | None
    text: str
    sha256: str
    own_path: str | None = None


class MachineText(Struct, forbid_unknown_fields=True):
    """The text of a machine file, in TOML. Relative paths in it, such as those of data dictionaries
    and sensor tables, are relative to the folder of the printer's machine file."""

    text: Annotated[str, Meta(max_length=500_000)]


class NewMachineFile(MachineText, forbid_unknown_fields=True):
    """The text to write. `replaces` is the `sha256` that `machine.file` gave for the text before
    the edit. A file that has changed since then is not overwritten."""

    replaces: str


class MachineProblem(Struct):
    """A problem of a machine file: `line` is 1 if the line is not known; `key` is empty if the text
    is not TOML; `action` is what to do next."""

    code: str
    key: str
    line: int
    message: str
    action: str


class Validation(Struct):
    """The result of a check of a machine file. `questions` are allowed values that are probably
    wrong; `notes` are facts about the machine that its owner should know."""

    ok: bool
    problems: list[MachineProblem]
    questions: list[MachineProblem]
    notes: list[str]


class Difference(Struct):
    """`changes` are the keys whose values differ from those of the running machine; values from
    files that the text names are included. `text` is the difference from the machine file, in the
    format of `diff -u`."""

    changes: list[KeyChange]
    text: str


class Applied(Struct):
    """The effect of writing the machine file. `live` are the changed keys that have taken effect;
    `overridden` those that a stored setting or a command overrides; `restart` those that take
    effect after `machine.restart`. `backup` is the path of a copy of the earlier file."""

    live: list[str]
    overridden: list[str]
    restart: list[str]
    backup: str


class SavedMachine(Struct):
    """The path of the new machine file."""

    path: str


class ShippedMachine(Struct):
    """A machine that comes with Passo."""

    name: str
    description: str
    geometry: str
    size_mm: list[float]
    steppers: list[str]
    board: str


class ShippedFile(Struct):
    """The machine file of a shipped machine. Copy it as a start for your own."""

    name: str
    text: str


@operation("machine.file", "GET", "/machine/file", Role.OPERATOR, errors=_CONFIG_ERRORS)
async def read(call: Call) -> MachineFile:
    """The current machine file, which may differ from the running machine."""
    source, machine = call.bridge.machine_source, call.bridge.machine
    text = await asyncio.to_thread(file.read, source, machine)
    path = file.path_of(source)
    own = own_path(source, call.site.state)
    return MachineFile(_text(path), text, file.digest(text), _text(own))


@operation("machine.keys", "GET", "/machine/keys", Role.VIEWER, errors=_CONFIG_ERRORS)
async def keys(call: Call) -> list[KeyValue]:
    """All keys of the machine file with their values, the source of each value, and the setting
    that overrides it. Secrets are not shown."""
    source, machine = call.bridge.machine_source, call.bridge.machine

    def found() -> list[KeyValue]:
        text = file.read(source, machine)
        loaded = config.load_text(text, source) if file.path_of(source) else machine
        return key_values(loaded, text)

    values = await asyncio.to_thread(found)
    settings = {(s.command, s.word): s for s in await call.bridge.settings()}
    for value in values:
        if setting := settings.get(setting_of(value.key) or ("", "")):
            value.setting = f"{setting.command} {setting.word}"
            value.setting_value, value.setting_source = setting.value, setting.source
    return values


@operation("machine.schema", "GET", "/machine/schema", Role.VIEWER)
async def described(_: Call) -> dict[str, Any]:
    """The JSON schema of the machine file: type, range, default and help of each key, its unit as
    `x-unit`, and, as `x-acts`, whether a change takes effect `live` or after a `restart`."""
    return await asyncio.to_thread(schema)


@operation("machine.validate", "POST", "/machine/validate", Role.ADMIN)
async def validate(call: Call, body: MachineText) -> Validation:
    """Checks a text like `passo check`, and reports all problems at once."""
    try:
        loaded = await _loaded(call, body.text)
    except ConfigError as error:
        return Validation(False, [_problem(p) for p in error.problems], [], [])
    questions = [_problem(question) for question in loaded.questions]
    return Validation(True, [], questions, list(notes(loaded.machine)))


@operation("machine.diff", "POST", "/machine/diff", Role.ADMIN, errors=_CONFIG_ERRORS)
async def diff(call: Call, body: MachineText) -> Difference:
    """Compares a text with the running machine, and with its file."""
    source, machine = call.bridge.machine_source, call.bridge.machine
    loaded = await _loaded(call, body.text)
    before = await asyncio.to_thread(file.read, source, machine)
    changes = key_changes(machine, loaded.machine)
    return Difference(changes, file.difference(before, body.text))


@operation(
    "machine.apply",
    "PUT",
    "/machine/file",
    Role.ADMIN,
    errors=("machine.no-file", "machine.file-changed", "output.unwritable", *_CONFIG_ERRORS),
)
async def apply(call: Call, body: NewMachineFile) -> Applied:
    """Writes the machine file, completely or not at all, if the text has no errors. A copy of the
    earlier file is kept as FILE.toml.bak. Changes that commands can make take effect at once; the
    answer names those that need a restart."""
    source, machine = call.bridge.machine_source, call.bridge.machine
    path = file.path_of(source)
    if path is None:
        raise ConfigError.of("machine.no-file", value=source or machine.name)
    loaded = await _loaded(call, body.text)
    before, backup = await asyncio.to_thread(file.replace, path, body.text, body.replaces)
    _log.info("%s was written by %s", path, call.caller.name)
    applied = Applied([], [], [], str(backup))
    with suppress(ConfigError):  # the previous file may have had errors
        machine = (await _loaded(call, before)).machine
    held = {change.key: change.before for change in key_changes(machine, loaded.machine)}
    for change in key_changes(call.bridge.machine, loaded.machine):
        listed = await _act(call, change, held.get(change.key), applied)
        listed.append(change.key)
    return applied


@operation(
    "machine.save",
    "POST",
    "/machine/own",
    Role.ADMIN,
    errors=("machine.no-folder", "output.unwritable", *_CONFIG_ERRORS),
)
async def save(call: Call, body: MachineText) -> SavedMachine:
    """Saves a text as the user's file in place of the shipped machine that is served, if the text
    has no errors. From the next `machine.restart` on, and at each later start with the same
    `--machine` and `--state`, the printer is that of this file."""
    source = call.bridge.machine_source
    path = own_path(source, call.site.state)
    if path is None:
        raise ConfigError.of("machine.no-folder", value=source or call.bridge.machine.name)
    await asyncio.to_thread(config.load_text_and_question, body.text, str(path))
    await asyncio.to_thread(file.save, path, body.text)
    _log.info("%s was written by %s", path, call.caller.name)
    return SavedMachine(str(path))


@operation(
    "machine.restart",
    "POST",
    "/machine/restart",
    Role.ADMIN,
    errors=("job.printing", "machine.no-restart", *_CONFIG_ERRORS),
)
async def restart(call: Call) -> None:
    """Ends the printer, and restarts it with the current machine file, with heaters off and axes
    not homed. The command RESTART does the same; FIRMWARE_RESTART and M999 do not read the machine
    file. Consoles and this connection are closed; connect again after some seconds. Log-ins stay
    valid if the printer has a folder for them (`--state`)."""
    await call.bridge.restart_program()


@operation("machine.library", "GET", "/machine/library", Role.VIEWER)
async def library(_: Call) -> list[ShippedMachine]:
    """The machines that come with Passo."""
    return await asyncio.to_thread(_shipped)


@operation(
    "machine.shipped",
    "GET",
    "/machine/library/{name}",
    Role.VIEWER,
    errors=("config.unknown-machine",),
)
async def shipped(_: Call, name: str) -> ShippedFile:
    """The file of a machine that comes with Passo."""
    return ShippedFile(name, config.shipped_text(name))


@cache
def _shipped() -> list[ShippedMachine]:
    """The reference data are constant while Passo runs, and take half a second to load."""
    machines = [(name, config.load(name)) for name in config.shipped_machines()]
    return [
        ShippedMachine(
            name,
            machine.description,
            machine.geometry.kind,
            list(machine.size_mm),
            list(machine.steppers),
            machine.board.name,
        )
        for name, machine in machines
    ]


async def _loaded(call: Call, text: str) -> Loaded:
    """The machine that the text describes. Raises ConfigError."""
    return await asyncio.to_thread(file.loaded, call.bridge.machine_source, text)


def _text(path: Path | None) -> str | None:
    return None if path is None else str(path)


def _problem(problem: Problem) -> MachineProblem:
    key = str(problem.values.get("key", ""))
    action = problem.advice
    return MachineProblem(problem.code, key, problem.line or 1, problem.sentence, action)


async def _act(call: Call, change: KeyChange, held: object, applied: Applied) -> list[str]:
    """Applies a change if a command can do it. Returns the list of `applied` to which the change
    belongs. `held` is the earlier value in the file, None if the file has not changed it."""
    at = setting_of(change.key)
    setting = await _setting(call, at) if at and change.acts == "live" else None
    if at is None or setting is None:
        return applied.restart
    value = numeral(change.after)
    if same(setting.value, value):
        return applied.live
    live = isinstance(held, int | float) and same(setting.value, numeral(held))
    if setting.source != "file" and not live:
        return applied.overridden
    try:
        await call.commands(Setting(*at, value).call())
    except PassoError:
        return applied.restart
    taken = await _setting(call, at)
    return applied.live if taken and same(taken.value, value) else applied.restart


async def _setting(call: Call, at: tuple[str, str]) -> SettingValue | None:
    found = (s for s in await call.bridge.settings() if (s.command, s.word) == at)
    return next(found, None)
