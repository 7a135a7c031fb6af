"""M500 to M504: settings as commands that restore them."""

from __future__ import annotations

import logging
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from passo.console.aprinter_options import OptionCommands
from passo.errors import CommandError, Problem
from passo.gcode.command import Command
from passo.gcode.parameters import ignored, number
from passo.gcode.registry import Kind, Subject, When, command
from passo.job.settings_store import Override, Setting, Store, commands_of, same, settings_in
from passo.printer.wait_requests import NullReply, Reply, Wait, WaitForMoves

if TYPE_CHECKING:
    from passo.printer.control import Control
    from passo.printer.machine_parts import MachineParts
    from passo.printer.settings import Group

_log = logging.getLogger(__name__)

# Commands of the bed correction, which one message summarises, and the answers to them.
_OF_BED = ("G29", "M420", "SET_BED_FIT", "SET_BED_MESH")
_ANSWERS_OF_BED = ("echo:Bed Leveling ", "echo:Fade Height ")


class _Collected(NullReply):
    """Collects the answers to stored commands: reasons why a value was refused or clamped."""

    def __init__(self, lines: list[str]) -> None:
        self._lines = lines

    def say(self, text: str) -> None:
        """Collects the line."""
        self._lines.append(text)

    def note(self, about: str, text: str, *, again: bool = False) -> None:
        """Collects the line."""
        self._lines.append(f"echo:{text}")

    def fail(self, text: str, problems: Sequence[Problem] = ()) -> None:
        """Collects the reason."""
        self._lines.append(f"echo:A stored setting was refused: {text}")


class SettingsCommands:
    """The settings of one printer: values of the machine file, and values that commands have
    changed. `store` stores the changed ones; None stores nothing."""

    def __init__(
        self,
        control: Control,
        parts: MachineParts,
        store: Store | None,
        options: OptionCommands,
    ) -> None:
        self._state, self._dispatch = control.state, control.dispatch
        self._motion, self._settings = parts.motion, parts.settings
        self._store, self._options = store, options
        self._defaults = list(self._settings.lines())
        self._file = {setting.key: setting.value for setting in settings_in(self._defaults)}
        self._compared: list[str] | None = None  # the settings for which `_unsaved` was computed
        self._unsaved: dict[str, dict[str, str]] = {}
        if store is not None:
            self._state.stores.append(self.store)
            self._state.status_parts.append(lambda status: replace(status, unsaved=self.unsaved()))

    def provenance(self) -> Iterator[tuple[Group, Setting, str | None, str | None, str]]:
        """All active values by their group: the setting, the value of the machine file, the stored
        value (None without one), and the source of the active value: `file`, `stored` or
        `command`."""
        try:
            overrides = (self._store.load() if self._store else None) or []
        except CommandError:
            overrides = []
        held = {override.setting.key: override.setting.value for override in overrides}
        for group in self._settings.groups():
            for setting in settings_in(group.lines):
                file, stored = self._file.get(setting.key), held.get(setting.key)
                if stored is not None and same(stored, setting.value):
                    source = "stored"
                else:
                    source = "file" if same(file, setting.value) else "command"
                yield group, setting, file, stored, source

    def unsaved(self) -> dict[str, dict[str, str]]:
        """The settings that M500 would change in the store, as commands with values, by heading,
        without temporary ones. Empty without a store. Cheap to call, because the store is read
        only after a change."""
        if self._store is None:
            return {}
        lines = list(self._settings.lines())
        if lines != self._compared:
            self._compared, self._unsaved = lines, self._found_unsaved()
        return self._unsaved

    def _found_unsaved(self) -> dict[str, dict[str, str]]:
        found: dict[str, dict[str, str]] = {}
        for group, setting, file, stored, _ in self.provenance():
            kept = file if stored is None else stored
            if not group.temporary and not same(setting.value, kept):
                values = found.setdefault(group.heading, {})
                values[f"{setting.head} {setting.word}"] = setting.value
        return found

    def restore(self, lines: Iterable[str], reply: Reply) -> None:
        """Executes commands of settings. Call it with the motion lock held, at standstill."""
        for line in lines:
            self._dispatch.take_setting(line, reply)

    def load_at_start(self) -> None:
        """Applies the stored values that differ from the machine file's, and reports them. Stored
        values that equal those of the file are removed from the store. Invalid values are reported
        too."""
        try:
            stored = self._store.load() if self._store else None
            if not stored:
                return
            held = self._differing(stored)
            for line in self._take_and_name(held):
                self._state.tell(line)
                _log.info("%s", line.removeprefix("echo:"))
            if held != stored:
                self._needed().save(held)
        except CommandError as error:
            problem = error.problems[0]
            self._state.announce(_log, logging.WARNING, str(error), problem)

    def name_stored(self) -> list[str]:
        """Like `load_at_start`, but returns the messages instead of reporting them, and leaves the
        store unchanged. Raises CommandError."""
        stored = self._needed().load()
        lines = self._take_and_name(self._differing(stored or []))
        return [line.removeprefix("echo:") for line in lines]

    def _differing(self, stored: list[Override]) -> list[Override]:
        return [o for o in stored if not same(self._file.get(o.setting.key), o.setting.value)]

    def _take_and_name(self, held: list[Override]) -> list[str]:
        """Sets these values; returns lines with the values, and with those that they override."""
        lines: list[str] = []
        self.restore(commands_of(override.setting for override in held), _Collected(lines))
        lines = [line for line in lines if not line.startswith(_ANSWERS_OF_BED)]
        now = {setting.key: setting.value for setting in settings_in(self._settings.lines())}
        of_bed = [o for o in held if o.setting.head.split()[0] in _OF_BED]
        if of_bed:
            taken = all(same(now.get(o.setting.key), o.setting.value) for o in of_bed)
            state = "on" if self._motion.correction.on else "off"
            found = f"is as it was, and {state}" if taken else "could not be taken as it is"
            lines.append(f"echo:Stored correction of the bed {found} ({len(of_bed)} values)")
        for override in held:
            if override in of_bed:
                continue
            lines.append(f"echo:{self._named(override, now.get(override.setting.key))}")
        if held:
            lines.append("echo:To go back to the machine file's values: M502, then M500")
        return lines

    def _named(self, override: Override, now: str | None) -> str:
        """A line about a stored value, and the value of the machine file that it overrides; `now`
        is the active value."""
        setting, then = override
        file = self._file.get(setting.key)
        if not same(now, setting.value):
            held = "nothing" if now is None else f"{setting.word}{now}"
            return f"Stored {setting} could not be taken as it is: {held} is in force"
        if file is None:
            return f"Stored {setting} is in force; the machine file has no such value"
        text = f"Stored {setting} overrides {setting.word}{file} of the machine file"
        if then is None or same(then, file):
            return text
        return f"{text}. The file was edited after M500: it had {setting.word}{then}"

    def _changed(self) -> list[Override]:
        """The values that differ from the machine file's."""
        return [
            Override(setting, file)
            for setting in settings_in(self._settings.lines())
            if not same(file := self._file.get(setting.key), setting.value)
        ]

    def _needed(self) -> Store:
        if self._store is None:
            raise CommandError.of("settings.nowhere")
        return self._store

    def store(self) -> int:
        """Stores the values that differ from the machine file's; returns their checksum. Raises
        CommandError."""
        self._compared = None
        return self._needed().save(self._changed())

    @command(
        "M500",
        Subject.SETTINGS,
        When.PLANNED,
        "Stores the settings.",
        kind=Kind.SERVED,
    )
    def _save(self, _: Command, reply: Reply) -> Wait | None:
        crc = self.store()
        changed = [str(override.setting) for override in self._changed()]
        size = sum(len(text) + 1 for text in changed)
        reply.say(f"echo:Settings Stored ({size} bytes; crc {crc})")
        listed = ", ".join(changed) or "nothing, all values are the machine file's"
        _log.info("Settings stored, as changed from the machine file: %s", listed)
        reply.say(f"echo:Stored, as changed from the machine file: {listed}")
        return None

    @command(
        "M501",
        Subject.SETTINGS,
        When.EXCLUSIVE,
        "Loads the stored settings.",
        kind=Kind.SERVED,
    )
    def _load(self, _: Command, reply: Reply) -> Wait | None:
        self._motion.settings.require_scales("M501")
        stored = self._needed().load()
        if stored is None:
            raise CommandError.of("settings.none")
        return WaitForMoves(lambda: self._take("M501", stored, reply))

    @command(
        "M502",
        Subject.SETTINGS,
        When.EXCLUSIVE,
        "Sets all settings to those of the machine file.",
        kind=Kind.SERVED,
    )
    def _reset(self, _: Command, reply: Reply) -> Wait | None:
        self._motion.settings.require_scales("M502")
        return WaitForMoves(lambda: self._take("M502", [], reply))

    def _take(self, code: str, stored: list[Override], reply: Reply) -> None:
        """Applies the machine file's values, then the stored ones."""
        self._motion.settings.require_scales(code)  # a pause may have begun in the meantime
        self.restore(self._defaults, NullReply())
        if code == "M502":
            reply.say("echo:Factory Settings Loaded")
            return
        held = self._differing(stored)
        for line in self._take_and_name(held):
            reply.say(line)
        reply.say(f"echo:Stored settings retrieved ({len(held)} values)")

    @command(
        "M503",
        Subject.SETTINGS,
        When.PLANNED,
        "Reports the settings as commands; S0 without headings.",
        number("S", "0: without headings", default=1, alone=True),
        ignored("C"),
        kind=Kind.QUIET,
    )
    def _report(self, command: Command, reply: Reply) -> Wait | None:
        headings = command.value("S") != 0
        for group in self._settings.groups():
            if headings:
                reply.say(f"; {group.heading}")
            for line in group.lines:
                reply.say(line)
        for line in self._options.pending_lines():
            reply.say(line)
        return None

    @command(
        "M504",
        Subject.SETTINGS,
        When.PLANNED,
        "Checks the stored settings.",
        kind=Kind.QUIET,
    )
    def _check(self, _: Command, reply: Reply) -> Wait | None:
        stored = self._needed().load()
        if stored is None:
            raise CommandError.of("settings.none")
        reply.say(f"echo:Stored settings are sound ({len(stored)} values)")
        return None
