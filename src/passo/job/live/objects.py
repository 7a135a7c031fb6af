"""The objects of the file that is being printed, and their cancellation."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from passo.errors import CommandError
from passo.printer.print_objects import objects_of

if TYPE_CHECKING:
    from passo import _core
    from passo.job.live.runner import Runner
    from passo.printer.dispatch import Dispatch
    from passo.printer.live_rig import LiveRig
    from passo.printer.status import PrintObject


class PrintObjects:
    """The objects of one printer's print from a file. They are known after the scan of the file; no
    object is cancelled when a print begins. `watchers` are called with the number of each object
    that a client cancels or restores, and whether it is cancelled."""

    def __init__(self, rig: LiveRig, dispatch: Dispatch, runner: Runner) -> None:
        self._rig, self._dispatch, self._runner = rig, dispatch, runner
        self._known: tuple[PrintObject, ...] = ()
        # the job and the print from which `all` was read
        self._of: tuple[_core.Job, int] | None = None
        self.watchers: list[Callable[[int, bool], None]] = []

    @property
    def all(self) -> tuple[PrintObject, ...]:
        """Each object of the current print, or of the last one, by its number."""
        job = self._rig.job
        version = job.objects.version
        if self._of is None or self._of[0] is not job or self._of[1] != version:
            self._of = job, version
            self._known = objects_of(job)
        return self._known

    @property
    def current(self) -> int | None:
        """The object whose moves are being executed; None between objects, and without a print."""
        if not self._runner.active:
            return None
        job = self._rig.job
        number = job.objects.of_line(job.history.line_at(self._rig.queue.passed))
        return number if number >= 0 else None

    @property
    def planned_to_line(self) -> int:
        """The line up to which moves are planned; a cancellation does not affect these moves."""
        with self._dispatch.file_selected() as job:
            return job.line

    def named(self, name: str) -> int:
        """The number of the object with this name; case does not matter. Raises CommandError."""
        self._require_print()
        numbers = self._rig.job.objects.find(name)
        if not numbers:
            raise CommandError.of("job.no-object", value=name, limit=self._choice())
        if len(numbers) > 1:
            limit = ", ".join(map(str, numbers))
            raise CommandError.of("job.several-objects", value=name, limit=limit)
        return numbers[0]

    def cancel(self, number: int, *, cancelled: bool = True) -> bool:
        """Skips the moves of the object that are not planned yet, or stops skipping. Returns False
        if nothing changes. Raises CommandError."""
        self._require_print()
        if not 0 <= number < len(self.all):
            raise CommandError.of("job.no-object", value=str(number), limit=self._choice())
        if self.all[number].cancelled == cancelled:
            return False
        if self._rig.machine.laser:
            raise CommandError.of("job.objects-and-laser")
        self._rig.job.objects.cancel(number, cancelled)
        for watcher in self.watchers:
            watcher(number, cancelled)
        return True

    def _choice(self) -> str:
        last = len(self.all) - 1
        return "0" if last == 0 else f"0 to {last}"

    def _require_print(self) -> None:
        if not (self._runner.active and self.all):
            raise CommandError.of("job.no-objects")
