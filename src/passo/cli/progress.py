"""The progress bar of a print: on a terminal only."""

from __future__ import annotations

import sys
from types import TracebackType
from typing import TYPE_CHECKING

from passo.learn.labels import duration

if TYPE_CHECKING:
    from passo.job.batch.simulated_print import Progress


class ProgressBar:
    """Shows the fraction of the file, layer, print time, remaining time and temperatures. Shows
    nothing if the output is piped."""

    def __init__(self, *, quiet: bool) -> None:
        self._bar = None
        if quiet or not sys.stderr.isatty():
            return
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn

        self._bar = Progress(
            TextColumn("layer {task.fields[layer]:>4}"),
            BarColumn(),
            TaskProgressColumn(),
            TextColumn("{task.fields[printed]} printed, {task.fields[left]} left"),
            TextColumn("{task.fields[celsius]}"),
            console=Console(stderr=True),
            transient=True,
        )
        self._task = self._bar.add_task(
            "print", total=1.0, layer=0, printed="0 s", left="?", celsius=""
        )

    def __enter__(self) -> ProgressBar:
        """Shows the bar from now on."""
        if self._bar:
            self._bar.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Removes the bar."""
        if self._bar:
            self._bar.stop()

    def show(self, at: Progress) -> None:
        """Updates the bar."""
        if not self._bar:
            return
        left = at.left_s
        self._bar.update(
            self._task,
            completed=at.share,
            layer=at.layer,
            printed=duration(at.print_s),
            left="?" if left is None else duration(left),
            celsius="  ".join(f"{name} {c:.0f} °C" for name, c in at.celsius.items()),
        )
