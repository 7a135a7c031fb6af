"""The files that a printer can print: on its card, and on this computer."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from passo.card import Card, Entry, Writer, open_card
from passo.card import Reader as CardReader
from passo.card.local import is_local, local_name, open_local
from passo.card.names import fold, split
from passo.errors import CardError
from passo.gcode.program_files import is_program
from passo.job.live.runner import Runner

if TYPE_CHECKING:
    from passo.printer.control import Control

_log = logging.getLogger(__name__)

AUTOSTART = "auto0.g"
_DEEPEST = 8  # maximum depth of directories in a list


class Files:
    """The card of one printer, and the selected file. `path` is the path of the card, or None
    without one; `folder` is the same if the card is a folder. Paths of files are absolute on the
    card, or `file:///…` on this computer."""

    def __init__(self, control: Control, runner: Runner, path: str | None) -> None:
        self._state, self._runner, self._path = control.state, runner, path
        self.folder = None if path is None or not Path(path).is_dir() else Path(path).resolve()
        self._card: Card | None = None
        self._released = False
        self._selected: Entry | None = None
        control.lifetime.at_end(self._leave)

    # -- the card ---------------------------------------------------------------------------------

    @property
    def card(self) -> Card:
        """The mounted card. Raises CardError if there is none, or if it was released."""
        if self._released:
            raise CardError.of("card.absent", value="M22 has released it (M21 mounts it)")
        if self._card is None:
            self.mount()
        assert self._card is not None
        return self._card

    @property
    def mounted(self) -> bool:
        """Whether a card is mounted."""
        return self._card is not None

    def mount(self) -> None:
        """Mounts the card again. A print that has stopped at an invalid line or a failed read of
        the card can still be resumed, if its file is unchanged. Raises CardError."""
        if not self._runner.stands:
            self._runner.release()
        self._leave()
        if self._path is None:
            raise CardError.of("card.absent", value="start with --sd")
        self._card = open_card(self._path)
        self._released = False
        if self._runner.stands:
            self._open_again()

    def release(self) -> None:
        """Releases the card until it is mounted again. Raises CommandError during a print from a
        file."""
        self._runner.release()
        self._leave()
        self._released = True

    def _leave(self) -> None:
        if self._card is not None:
            self._card.close()
            self._card = None

    def _open_again(self) -> None:
        """Opens the file of a stopped print again."""
        runner, before = self._runner, self._selected
        if is_local(runner.path):
            return
        if self.there(runner.path) and before is not None:
            now = self.card.find(runner.path)
            if (now.size, now.modified) == (before.size, before.modified):
                runner.file.exchange(self.card.open(runner.path))
                return
        text = f"{runner.name} was changed on the card or removed; its print is cancelled"
        self._state.announce(_log, logging.WARNING, text)
        runner.release()

    # -- files --------------------------------------------------------------------------------

    def there(self, path: str) -> bool:
        """Whether the card has a file or folder with this path."""
        try:
            self.card.find(path)
        except CardError:
            return False
        return True

    def programs(self) -> Iterator[tuple[str, Entry]]:
        """All G-code files, with the short names of their folders in front. Raises CardError, also
        during the iteration."""
        return self._programs(self.card)

    def _programs(self, card: Card) -> Iterator[tuple[str, Entry]]:
        stack = [("/", "")]
        while stack:
            path, shown = stack.pop()
            inner: list[tuple[str, str]] = []
            for entry in card.list(path):
                if entry.name.startswith("."):
                    continue
                if entry.is_directory:
                    if shown.count("/") < _DEEPEST:
                        inner.append((f"{path}/{entry.name}", f"{shown}{entry.short_name}/"))
                elif is_program(entry.name):
                    yield shown, entry
            stack += reversed(inner)

    def open(self, path: str) -> None:
        """Selects a file to print. Raises CardError or InputError, and CommandError during a print
        from a file."""
        if is_local(path):
            self._runner.select(local_name(path), path, open_local(path))
            return
        entry = self.card.find(path)
        self._runner.select(entry.name, path, self.card.open(path))
        self._selected = entry

    def reader(self, path: str) -> CardReader:
        """Opens a file for reading during a print. Raises CardError, InputError."""
        return open_local(path) if is_local(path) else self.card.open(path)

    def create(self, path: str) -> Writer:
        """Opens a file of the card to write it. Raises CardError."""
        self.let_go(path)
        return self.card.create(path)

    def remove(self, path: str) -> None:
        """Deletes a file of the card. Raises CardError."""
        self.let_go(path)
        self.card.remove(path)

    def let_go(self, path: str) -> None:
        """Deselects the selected file if it is `path` or in the folder `path`, which will change.
        Raises CardError while it is being printed."""
        runner, changed = self._runner, split(path)
        if not runner.path or is_local(runner.path) or not (changed and self.there(path)):
            return
        selected = [*split(runner.path)[:-1], runner.name]
        changed[-1] = self.card.find(path).name
        if [fold(name) for name in changed] != [fold(x) for x in selected[: len(changed)]]:
            return
        if runner.engaged:
            raise CardError.of("job.printing", value=runner.name)
        if runner.over:
            runner.release()

    def autostart(self) -> None:
        """Starts `auto0.g` if it is on the card."""
        if self.starts_itself:
            self.open(AUTOSTART)
            self._runner.start()

    @property
    def starts_itself(self) -> bool:
        """Whether `auto0.g` is on the card."""
        return self.there(AUTOSTART)
